//! Reading the XML species files of Arbaro, a program that grows trees by the same model.
//!
//! Such a file is an element `arbaro` around one `species` with a name, around a `param` for each
//! parameter, with its name and value. Parameters that a file leaves out have Arbaro's defaults,
//! which are the model's too; their keys are noted as defaulted. The species gets Arbaro's origin
//! and thereby its dialect.
//!
//! Arbaro itself passes over a good deal in silence. Here a second species, a parameter given
//! twice and whatever has no place in such a file are errors; what is read otherwise than it is
//! written becomes one of the species' notes. Document types, and with them entities and external
//! files, are refused.

mod outline;
mod parameters;

use roxmltree::{Attribute, Document, Node, ParsingOptions, TextPos};
use sapwood_geom::{FixedMap, fixed_state};
use sapwood_rules::weber_penn::{Accepted, Key, LeafShape, Origin, Species, Value};

use self::outline::BreaksOff;
use super::found::Found;
use super::source::{Source, shortened};
use crate::spelling::nearest;
use crate::spelling::shortened_to;
use crate::{Error, ErrorKind};

/// The paper's keys that Arbaro dropped.
const DROPPED: [&str; 2] = ["z_scale", "z_scale_v"];
/// Smooth where a file does not give it.
const SMOOTH: f32 = 0.5;
/// Leaf shapes that Arbaro knows, besides discs of a given number of triangles.
const LEAF_SHAPES: [&str; 5] = ["0", "disc", "square", "sphere", "palm"];
/// The outline points of a disc beyond its triangles.
const DISC_POINTS: u32 = 2;
/// The most triangles of a disc.
const MOST_TRIANGLES: u32 = 998;

/// The species in `source`, or all that is wrong with it.
pub(super) fn species(source: &Source<'_>) -> Result<Species, Error> {
    let breaks_off =
        outline::outline(source.text).map_err(|(kind, offset)| source.error(kind, Some(offset)))?;
    let options = ParsingOptions { allow_dtd: false, ..ParsingOptions::default() };
    let document = Document::parse_with_options(source.text, options)
        .map_err(|error| syntax(source, &error, breaks_off))?;
    let smooth = Some(SMOOTH);
    let species = Species { origin: Origin::Arbaro, smooth, ..Species::default() };
    let given = FixedMap::with_hasher(fixed_state());
    let mut reader = Reader { errors: Found::new(source), species, given };
    reader.document(&document);
    let keys = DROPPED.into_iter().map(str::to_owned).chain(parameters::keys());
    reader.species.defaulted =
        keys.filter(|key| !reader.given.contains_key(key.as_str())).collect();
    reader.errors.or(reader.species)
}

struct Reader<'a> {
    errors: Found<'a>,
    species: Species,
    /// The keys that parameters have set or tried to, with the byte where each name stands.
    given: FixedMap<&'static str, usize>,
}

impl Reader<'_> {
    fn document(&mut self, document: &Document<'_>) {
        let Some(arbaro) = self.only(document.root(), "the file", "arbaro") else { return };
        self.foreign_attributes(arbaro, &[]);
        let Some(species) = self.only(arbaro, "<arbaro>", "species") else { return };
        self.foreign_attributes(species, &["name"]);
        if let Some(name) = self.attribute(species, "name") {
            self.species.name = name.value().to_owned();
        }
        for child in self.children(species, "<species>", "<param>") {
            if child.has_tag_name("param") {
                self.parameter(child);
            } else {
                self.unexpected(child, "<species>", "<param>");
            }
        }
    }

    /// The one child element of this name; others are errors, and so is its absence.
    fn only<'d>(
        &mut self,
        parent: Node<'d, 'd>,
        within: &str,
        name: &'static str,
    ) -> Option<Node<'d, 'd>> {
        let (mut only, mut strangers) = (None, 0);
        for child in self.children(parent, within, &element(name)) {
            if !child.has_tag_name(name) {
                strangers += 1;
                self.unexpected(child, within, &element(name));
            } else if only.is_none() {
                only = Some(child);
            } else {
                let found = format!("second {}", element(name));
                let accepted = format!("one {}", element(name));
                self.add_unexpected(child, found, within, accepted);
            }
        }
        // Whoever misspelt it is told so already.
        if only.is_none() && strangers == 0 {
            let (what, within) = (element(name), within.to_owned());
            let place = if parent.is_root() { parent.range().end } else { parent.range().start };
            self.errors.add(ErrorKind::Missing { what, within }, Some(place..place));
        }
        only
    }

    /// The child elements; text between them is an error.
    fn children<'d>(
        &mut self,
        parent: Node<'d, 'd>,
        within: &str,
        accepted: &str,
    ) -> Vec<Node<'d, 'd>> {
        let mut elements = Vec::new();
        for child in parent.children() {
            if self.errors.is_enough() {
                break;
            }
            if child.is_element() {
                elements.push(child);
            } else if let Some(text) = child.text().filter(|_| child.is_text()) {
                let trimmed = text.trim_start();
                if !trimmed.is_empty() {
                    let start = child.range().start + (text.len() - trimmed.len());
                    let found = format!("text \"{}\"", shortened(text));
                    let (within, accepted) = (within.to_owned(), accepted.to_owned());
                    let kind = ErrorKind::Unexpected { found, within, accepted };
                    self.errors.add(kind, Some(start..start));
                }
            }
        }
        elements
    }

    fn unexpected(&mut self, node: Node<'_, '_>, within: &str, accepted: &str) {
        let found = element(node.tag_name().name());
        self.add_unexpected(node, found, within, accepted.to_owned());
    }

    fn add_unexpected(
        &mut self,
        node: Node<'_, '_>,
        found: String,
        within: &str,
        accepted: String,
    ) {
        let kind = ErrorKind::Unexpected { found, within: within.to_owned(), accepted };
        self.errors.add(kind, Some(node.range()));
    }

    /// The attribute of this name, or an error at the element.
    fn attribute<'d>(&mut self, node: Node<'d, 'd>, name: &str) -> Option<Attribute<'d, 'd>> {
        let found = node.attributes().find(|attribute| attribute.name() == name);
        if found.is_none() {
            let what = format!("attribute '{name}'");
            let within = element(node.tag_name().name());
            self.errors.add(ErrorKind::Missing { what, within }, Some(node.range()));
        }
        found
    }

    /// Notes the attributes that nothing is known of.
    fn foreign_attributes(&mut self, node: Node<'_, '_>, known: &[&str]) {
        for attribute in node.attributes().filter(|found| !known.contains(&found.name())) {
            let name = shortened(attribute.name());
            let within = element(node.tag_name().name());
            self.species.notes.push(format!("Attribute '{name}' of {within} was passed over."));
        }
    }

    fn parameter(&mut self, node: Node<'_, '_>) {
        if self.errors.is_enough() {
            return;
        }
        self.foreign_attributes(node, &["name", "value"]);
        for child in self.children(node, "<param>", "nothing") {
            self.unexpected(child, "<param>", "nothing");
        }
        let (name, value) = (self.attribute(node, "name"), self.attribute(node, "value"));
        let Some(name) = name else { return };
        let (place, name) = (name.range_value(), name.value());
        let Some(key) = parameters::key(name) else {
            let suggestion = like(name);
            let name = shortened(name);
            self.errors.add(ErrorKind::UnknownParameter { name, suggestion }, Some(place));
            return;
        };
        if let Some(first) = self.given.get(key.name()) {
            let first = self.errors.source.place(*first);
            let name = name.to_owned();
            self.errors.add(ErrorKind::Repeated { name, first }, Some(place));
            return;
        }
        self.given.insert(key.name(), place.start);
        if let Some(value) = value {
            self.value(name, key, value);
        }
    }

    fn value(&mut self, parameter: &str, key: &Key, attribute: Attribute<'_, '_>) {
        let (text, place) = (attribute.value().trim(), attribute.range_value());
        let accepted = key.accepted(self.species.origin, self.species.effective_dialect());
        let value = match accepted {
            Accepted::LeafShape => Some(self.leaf_shape(text)),
            _ => number(text),
        };
        let parameter = parameter.to_owned();
        let kind = match value {
            None => ErrorKind::WrongType {
                key: parameter,
                expected: accepted.to_string(),
                found: format!("the text \"{}\"", shortened(text)),
            },
            Some(value) => match key.set(&mut self.species, &value) {
                Ok(()) => return,
                Err(fault) => ErrorKind::OutOfRange {
                    key: parameter,
                    value: shortened(text),
                    accepted: fault.accepted.to_string(),
                },
            },
        };
        self.errors.add(kind, Some(place));
    }

    /// The name of the shape in species of ours. What Arbaro does not know it draws as a disc.
    fn leaf_shape(&mut self, text: &str) -> Value {
        if LEAF_SHAPES.contains(&text) {
            return Value::Text(text.to_owned());
        }
        let triangles = text.strip_prefix("disc").and_then(|number| number.parse::<u32>().ok());
        if let Some(triangles) = triangles.filter(|n| (1..=MOST_TRIANGLES).contains(n)) {
            return Value::Text(LeafShape::Disc(triangles + DISC_POINTS).name().into_owned());
        }
        let meant = nearest(text, LEAF_SHAPES.into_iter().skip(1));
        let meant = meant.map(|name| format!("; did you mean \"{name}\"?"));
        self.species.notes.push(format!(
            "LeafShape \"{}\" was read as \"disc\", as any that Arbaro does not know{}",
            shortened(text),
            meant.as_deref().unwrap_or(".")
        ));
        Value::Text("disc".to_owned())
    }
}

/// The number that `text` says; it may lie outside every range or be no number in the end.
fn number(text: &str) -> Option<Value> {
    // Straight to the precision that is kept, so that no number is rounded twice.
    let whole = text.parse().map(Value::Whole);
    whole.or_else(|_| text.parse().map(Value::Number)).ok()
}

/// The parameter that was probably meant.
fn like(name: &str) -> Option<String> {
    // The parameters of another level lie as near as those of the same; deeper levels take the
    // parameters of the last.
    let digit = name.chars().next().filter(char::is_ascii_digit).map(|digit| digit.min('3'));
    let names: Vec<_> = parameters::names().collect();
    let of_level = names.iter().filter(|known| known.chars().next() == digit);
    nearest(name, of_level.map(String::as_str))
        .or_else(|| nearest(name, names.iter().map(String::as_str)))
        .map(str::to_owned)
}

/// A name as a tag.
fn element(name: &str) -> String {
    format!("<{}>", shortened(name))
}

/// The parser's error in our words.
fn syntax(source: &Source<'_>, error: &roxmltree::Error, breaks_off: Option<BreaksOff>) -> Error {
    use roxmltree::Error as Xml;

    let (pos, end) = (error.pos(), source.text.len());
    let offset = match error {
        Xml::NoRootNode | Xml::UnclosedRootNode | Xml::UnexpectedEndOfStream => end,
        _ => offset_of(source.text, pos),
    };
    if let Some(BreaksOff { part, .. }) = breaks_off.filter(|off| offset >= off.from) {
        let (what, line) = (outline::part(&source.text[part..]), source.place(part).line);
        let message = format!("the file ends inside {what}, which begins in line {line}");
        return source.error(ErrorKind::Syntax { format: "XML", message }, Some(end));
    }
    let found = || match source.text[offset..].chars().next() {
        Some(c) => format!("'{c}'"),
        None => "the end of the file".to_owned(),
    };
    let message = match error {
        Xml::NoRootNode => {
            let (what, within) = (element("arbaro"), "the file".to_owned());
            return source.error(ErrorKind::Missing { what, within }, Some(end));
        }
        Xml::DtdDetected => return source.error(ErrorKind::DocumentType, Some(offset)),
        Xml::InvalidChar(b'"' | b'\'', ..) => {
            format!("expected the closing quote, not {}", found())
        }
        Xml::InvalidChar(expected, ..) => {
            format!("expected '{}', not {}", char::from(*expected), found())
        }
        Xml::InvalidChar2(expected, ..) => format!("expected {expected}, not {}", found()),
        Xml::UnexpectedCloseTag(expected, actual, _) => {
            format!("expected </{}>, not </{}>", shortened(expected), shortened(actual))
        }
        Xml::UnknownToken(_) => format!("unexpected {}", found()),
        _ => error.to_string().replace(&format!(" at {pos}"), ""),
    };
    let message = shortened_to(200, &message);
    source.error(ErrorKind::Syntax { format: "XML", message }, Some(offset))
}

/// The byte at a line and column of `text`.
fn offset_of(text: &str, pos: TextPos) -> usize {
    let lines = text.split_inclusive('\n');
    let line: usize = lines.clone().take(pos.row as usize - 1).map(str::len).sum();
    let columns = text[line..].char_indices();
    columns.map(|(i, _)| line + i).nth(pos.col as usize - 1).unwrap_or(text.len())
}

#[cfg(test)]
mod tests;
