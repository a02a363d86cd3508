//! Reading: TOML values into a species, every fault with its place and what was meant.
//!
//! Which keys there are and what they accept stands in the model's table; this file knows only
//! which of them must be given.

use std::ops::Range;

use sapwood_rules::weber_penn::{
    self as model, Accepted, Key, LeafShape, Species, Value, WrittenEnvelope, WrittenImage,
    WrittenMesh,
};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::found::{Found, MOST_ERRORS};
use super::source::{Source, shortened};
use crate::spelling::nearest;
use crate::{Error, ErrorKind, Shape, read_leaf_image, read_leaf_mesh};

/// Keys without which nothing says what tree is meant.
const REQUIRED: [&str; 5] = ["name", "shape", "scale", "levels", "ratio"];
/// Keys that every level of branches must give besides.
const REQUIRED_OF_BRANCHES: [&str; 2] = ["branches", "length"];

/// The species in `source`, or all that is wrong with it.
pub(super) fn species(source: &Source<'_>) -> Result<Species, Error> {
    let (document, syntax) = DeTable::parse_recoverable(source.text);
    let mut errors = Found::new(source);
    for error in syntax.iter().take(MOST_ERRORS) {
        let message = match error.message() {
            "recursion limit" => "nested too deeply".to_owned(),
            message => message.to_owned(),
        };
        errors.add(ErrorKind::Syntax { format: "TOML", message }, error.span());
    }
    let mut reader = Reader { errors, species: Species::default(), given: Vec::new() };
    // What stands behind a syntax error may be misread; faults there would mislead.
    if reader.errors.is_empty() {
        reader.document(document.get_ref());
        reader.required(document.get_ref());
    }
    reader.errors.or(reader.species)
}

struct Reader<'a> {
    errors: Found<'a>,
    species: Species,
    given: Vec<&'static str>,
}

impl Reader<'_> {
    fn document(&mut self, document: &DeTable<'_>) {
        // What other keys accept depends on these two.
        for name in ["origin", "dialect"] {
            if let (Some(key), Some(value)) = (model::key(name), document.get(name)) {
                self.value(key, value);
            }
        }
        self.table("", document);
        // Whoever names a shape wants trees held by it.
        let is_given = |key: &str| self.given.contains(&key);
        if is_given("pruning.envelope") && !is_given("pruning.ratio") {
            self.species.pruning.ratio = 1.0;
        }
        if self.species.leaves.has_own_proportions() && !is_given("leaves.scale_x") {
            self.species.leaves.scale_x = 1.0;
        }
        if let Some(fault) = self.species.leaves.image_fault() {
            let leaves = document.get("leaves").and_then(|value| value.get_ref().as_table());
            let image = leaves.and_then(|leaves| leaves.get("image"));
            let text = image.and_then(|image| image.get_ref().as_str()).unwrap_or_default();
            let kind = unread("leaves.image", text, fault.to_owned());
            self.errors.add(kind, image.map(Spanned::span));
        }
    }

    fn table(&mut self, table: &str, entries: &DeTable<'_>) {
        for (key, value) in entries {
            if self.errors.is_enough() {
                return;
            }
            let dotted = match table {
                "" => key.get_ref().to_string(),
                table => format!("{table}.{}", key.get_ref()),
            };
            if dotted == "origin" || dotted == "dialect" {
                continue;
            }
            // A quoted key may hold a point of its own, which makes it no other key's equal.
            let plain = !key.get_ref().contains('.');
            if let Some(key) = model::key(&dotted).filter(|_| plain) {
                self.value(key, value);
            } else if plain && is_table(&dotted) {
                match value.get_ref() {
                    DeValue::Table(entries) => self.table(&dotted, entries),
                    other => self.wrong_type(&dotted, "a table", other, value.span()),
                }
            } else if matches!(value.get_ref(), DeValue::Table(_)) && key_like(&dotted).is_none() {
                let suggestion = table_like(&dotted);
                self.errors.add(
                    ErrorKind::UnknownTable { table: shortened(&dotted), suggestion },
                    Some(key.span()),
                );
            } else {
                let suggestion = key_like(&dotted).filter(|_| plain);
                let (key, span) = (shortened(key.get_ref()), key.span());
                let table = table.to_owned();
                self.errors.add(ErrorKind::UnknownKey { key, table, suggestion }, Some(span));
            }
        }
    }

    fn value(&mut self, key: &'static Key, value: &Spanned<DeValue<'_>>) {
        self.given.push(key.name());
        let accepted = key.accepted(self.species.origin, self.species.effective_dialect());
        let Some(read) = self.converted(key.name(), accepted, value) else { return };
        let Err(fault) = key.set(&mut self.species, &read) else { return };
        let (key, shown) = (key.name().to_owned(), self.errors.source.excerpt(value.span()));
        let kind = match (&fault.accepted, read) {
            (Accepted::Names(names), Value::Text(name)) => unknown_name(key, name, &fault, names),
            (Accepted::LeafShape, Value::Text(name)) => {
                let names: Vec<_> = LeafShape::NAMES.iter().map(|(name, _)| *name).collect();
                unknown_name(key, name, &fault, &names)
            }
            (Accepted::Target, Value::Text(name)) => unknown_name(key, name, &fault, &["up"]),
            (Accepted::LeafTarget, Value::Text(name)) => {
                unknown_name(key, name, &fault, &["outward", "scattered"])
            }
            _ => ErrorKind::OutOfRange { key, value: shown, accepted: fault.accepted.to_string() },
        };
        self.errors.add(kind, Some(value.span()));
    }

    /// The TOML value as the model knows it; nothing, after an error, where its type is wrong.
    fn converted(
        &mut self,
        key: &str,
        accepted: Accepted,
        value: &Spanned<DeValue<'_>>,
    ) -> Option<Value> {
        let fits = match (accepted, value.get_ref()) {
            (
                Accepted::Number { .. } | Accepted::Whole { .. },
                DeValue::Integer(_) | DeValue::Float(_),
            ) => return self.number(key, accepted, value),
            (
                Accepted::Text
                | Accepted::Names(_)
                | Accepted::LeafShape
                | Accepted::Target
                | Accepted::LeafTarget,
                DeValue::String(text),
            ) => return Some(Value::Text(text.to_string())),
            (
                Accepted::Envelope | Accepted::LeafMesh | Accepted::LeafImage,
                DeValue::String(text),
            ) => return self.named_file(key, accepted, text, value),
            (Accepted::Texts, DeValue::Array(_)) => return self.texts(key, value),
            (
                Accepted::Numbers { .. } | Accepted::Target | Accepted::LeafTarget,
                DeValue::Array(_),
            ) => return self.numbers(key, value).map(Value::Numbers),
            (Accepted::Target | Accepted::LeafTarget, DeValue::Table(table)) => {
                table.get("point").filter(|_| table.len() == 1)
            }
            _ => None,
        };
        match fits {
            Some(point) => {
                let numbers = self.numbers(&format!("{key}.point"), point)?;
                // Any other length is refused as a list of numbers that is no direction.
                let point = <[f32; 3]>::try_from(numbers.as_slice()).map(Value::Point);
                Some(point.unwrap_or(Value::Numbers(Vec::new())))
            }
            None => {
                self.wrong_type(key, &accepted.to_string(), value.get_ref(), value.span());
                None
            }
        }
    }

    fn number(
        &mut self,
        key: &str,
        accepted: Accepted,
        value: &Spanned<DeValue<'_>>,
    ) -> Option<Value> {
        let read = match value.get_ref() {
            DeValue::Integer(whole) => {
                i64::from_str_radix(whole.as_str(), whole.radix()).ok().map(Value::Whole)
            }
            // Straight to the precision that is kept, so that no number is rounded twice.
            DeValue::Float(float) => float.as_str().parse().ok().map(Value::Number),
            _ => None,
        };
        if read.is_none() {
            self.errors.add(
                ErrorKind::OutOfRange {
                    key: key.to_owned(),
                    value: self.errors.source.excerpt(value.span()),
                    accepted: accepted.to_string(),
                },
                Some(value.span()),
            );
        }
        read
    }

    fn numbers(&mut self, key: &str, value: &Spanned<DeValue<'_>>) -> Option<Vec<f32>> {
        let DeValue::Array(elements) = value.get_ref() else {
            self.wrong_type(key, "a list of numbers", value.get_ref(), value.span());
            return None;
        };
        let mut numbers = Vec::with_capacity(elements.len());
        for element in elements.iter() {
            match element.get_ref() {
                DeValue::Integer(whole) => {
                    let whole = i64::from_str_radix(whole.as_str(), whole.radix());
                    numbers.push(whole.map_or(f32::INFINITY, |whole| whole as f32));
                }
                DeValue::Float(float) => {
                    numbers.push(float.as_str().parse().unwrap_or(f32::INFINITY));
                }
                other => {
                    self.wrong_type(key, "a list of numbers", other, element.span());
                    return None;
                }
            }
        }
        Some(numbers)
    }

    fn texts(&mut self, key: &str, value: &Spanned<DeValue<'_>>) -> Option<Value> {
        let elements = value.get_ref().as_array()?;
        let mut texts = Vec::with_capacity(elements.len());
        for element in elements.iter() {
            match element.get_ref() {
                DeValue::String(text) => texts.push(text.to_string()),
                other => {
                    self.wrong_type(key, "a list of texts", other, element.span());
                    return None;
                }
            }
        }
        Some(Value::Texts(texts))
    }

    /// The shape that the words stand for, or what is in the file that they name, which is looked
    /// for beside this one.
    fn named_file(
        &mut self,
        key: &str,
        accepted: Accepted,
        text: &str,
        value: &Spanned<DeValue<'_>>,
    ) -> Option<Value> {
        let folder = self.errors.source.folder;
        let path = || folder.map_or_else(|| text.into(), |folder| folder.join(text));
        let named = || text.to_owned();
        let read = match accepted {
            Accepted::LeafMesh => read_leaf_mesh(path())
                .map(|mesh| Value::LeafMesh(WrittenMesh { path: named(), mesh })),
            Accepted::LeafImage => read_leaf_image(path())
                .map(|image| Value::LeafImage(WrittenImage { path: named(), image })),
            _ => match text.parse::<Shape>() {
                Ok(shape) => shape
                    .envelope(folder)
                    .map(|envelope| Value::Envelope(WrittenEnvelope { text: named(), envelope })),
                Err(fault) => {
                    self.errors.add(unread(key, text, fault.to_string()), Some(value.span()));
                    return None;
                }
            },
        };
        let fault = match read {
            Ok(read) => return Some(read),
            Err(error) => error.to_string(),
        };
        self.errors.add(unread(key, text, fault), Some(value.span()));
        None
    }

    fn wrong_type(&mut self, key: &str, expected: &str, found: &DeValue<'_>, span: Range<usize>) {
        let found = match found {
            DeValue::String(_) => format!("the text {}", self.errors.source.excerpt(span.clone())),
            DeValue::Integer(_) | DeValue::Float(_) => {
                format!("the number {}", self.errors.source.excerpt(span.clone()))
            }
            DeValue::Boolean(truth) => truth.to_string(),
            DeValue::Datetime(_) => "a date or time".to_owned(),
            DeValue::Array(_) => "a list".to_owned(),
            DeValue::Table(_) => "a table".to_owned(),
        };
        let (key, expected) = (key.to_owned(), expected.to_owned());
        self.errors.add(ErrorKind::WrongType { key, expected, found }, Some(span));
    }

    /// Notes the keys that must be given and are not, at the table they belong to.
    fn required(&mut self, document: &DeTable<'_>) {
        let mut missing = |table: &str, name: &str, span: Option<Range<usize>>| {
            let dotted = if table.is_empty() { name.into() } else { format!("{table}.{name}") };
            if !self.given.contains(&dotted.as_str()) {
                let (key, table) = (name.to_owned(), table.to_owned());
                self.errors.add(ErrorKind::MissingKey { key, table }, span);
            }
        };
        for name in REQUIRED {
            missing("", name, None);
        }
        if !self.given.contains(&"levels") {
            return;
        }
        let levels = document.get("level").and_then(|value| value.get_ref().as_table());
        for level in 1..self.species.levels.min(4) {
            let number = level.to_string();
            let span = levels
                .and_then(|levels| levels.get_key_value(number.as_str()))
                .map(|(key, _)| key.span());
            for name in REQUIRED_OF_BRANCHES {
                missing(&format!("level.{level}"), name, span.clone());
            }
        }
    }
}

/// The error about words that stand for nothing that can be read.
fn unread(key: &str, text: &str, fault: String) -> ErrorKind {
    ErrorKind::UnreadShape { key: key.to_owned(), text: shortened(text), fault }
}

fn unknown_name(key: String, value: String, fault: &model::Fault, names: &[&str]) -> ErrorKind {
    let suggestion = nearest(&value, names.iter().copied()).map(str::to_owned);
    let value = shortened(&value);
    ErrorKind::UnknownName { key, value, accepted: fault.accepted.to_string(), suggestion }
}

/// The dotted name in two: its table and its last part.
fn split(dotted: &str) -> (&str, &str) {
    dotted.rsplit_once('.').unwrap_or(("", dotted))
}

fn is_table(dotted: &str) -> bool {
    model::keys()
        .iter()
        .any(|key| key.name().strip_prefix(dotted).is_some_and(|rest| rest.starts_with('.')))
}

/// The key that was probably meant: the most similar of the same table, or else the same name
/// in another table, dotted.
fn key_like(dotted: &str) -> Option<String> {
    let (table, word) = split(dotted);
    let siblings = model::keys().iter().map(|key| split(key.name()));
    let siblings = siblings.filter(|(of, _)| *of == table).map(|(_, name)| name);
    nearest(word, siblings).map(str::to_owned).or_else(|| {
        let same = model::keys().iter().find(|key| split(key.name()).1 == word);
        same.map(|key| key.name().to_owned())
    })
}

/// The table that was probably meant.
fn table_like(dotted: &str) -> Option<String> {
    let (parent, word) = split(dotted);
    if parent == "level" && word.parse::<u64>().is_ok_and(|level| level > 3) {
        // Deeper levels take the parameters of the last.
        return Some("level.3".to_owned());
    }
    let tables = model::keys().iter().map(|key| split(key.name()).0).filter(|t| !t.is_empty());
    nearest(dotted, tables.chain(["level", "ext"])).map(str::to_owned)
}

#[cfg(test)]
mod tests;
