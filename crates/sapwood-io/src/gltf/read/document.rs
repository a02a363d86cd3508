//! The JSON text: its lists, whose entries are parsed when somebody needs them.
//!
//! One pass finds where every entry begins and ends, so that a hostile text costs little more
//! memory than it is long: entries become values one at a time. Each fault is told with its place
//! in the text.

use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

use serde::de::{self, Deserialize, DeserializeSeed, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::value::RawValue;

use super::container::Container;
use super::schema::{Asset, RootExtensions, Text};
use crate::spelling::shortened_to;
use crate::{Error, ErrorKind, Place};

/// The most entries that all lists of a text may have together.
pub(super) const MOST_ENTRIES: usize = 1 << 22;

/// The longest string that is read, but for URIs, in bytes.
const MOST_STRING: usize = 1 << 16;

/// The lists of a document.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum List {
    Accessors,
    BufferViews,
    Buffers,
    Cameras,
    Images,
    Lights,
    Materials,
    Meshes,
    Nodes,
    Samplers,
    Scenes,
    Textures,
    Animations,
    Skins,
}

const LISTS: [(List, &str); 14] = [
    (List::Accessors, "accessors"),
    (List::BufferViews, "bufferViews"),
    (List::Buffers, "buffers"),
    (List::Cameras, "cameras"),
    (List::Images, "images"),
    (List::Lights, "extensions.KHR_lights_punctual.lights"),
    (List::Materials, "materials"),
    (List::Meshes, "meshes"),
    (List::Nodes, "nodes"),
    (List::Samplers, "samplers"),
    (List::Scenes, "scenes"),
    (List::Textures, "textures"),
    (List::Animations, "animations"),
    (List::Skins, "skins"),
];

impl List {
    pub(super) fn name(self) -> &'static str {
        LISTS[self as usize].1
    }

    /// Entry `index`, as messages name it.
    pub(super) fn entry(self, index: usize) -> String {
        format!("{}[{index}]", self.name())
    }
}

/// A text and where its entries are.
#[derive(Default)]
pub(super) struct Document<'a> {
    lists: [Vec<&'a RawValue>; LISTS.len()],
    /// The scene that is shown.
    pub(super) scene: Option<usize>,
    pub(super) extensions_used: Vec<Text<'a>>,
    pub(super) extensions_required: Vec<Text<'a>>,
}

impl<'a> Document<'a> {
    pub(super) fn of(container: &Container<'a>) -> Result<Self, Error> {
        let mut reader = serde_json::Deserializer::from_str(container.text);
        let top = TopVisitor.deserialize(&mut reader).and_then(|top| reader.end().map(|()| top));
        let mut top = top.map_err(|error| syntax(container, &error))?;
        let asset: Asset<'_> = match top.asset {
            Some(asset) => parsed(asset, "asset")?,
            None => return Err(invalid("asset", "missing", "a version of glTF")),
        };
        asset.check()?;
        if let Some(scene) = top.scene {
            top.document.scene = parsed(scene, "scene")?;
        }
        if let Some(names) = top.extensions_used {
            let names: Bounded<Text<'_>, 1024> = parsed(names, "extensionsUsed")?;
            top.document.extensions_used = names.0;
        }
        if let Some(names) = top.extensions_required {
            let names: Bounded<Text<'_>, 1024> = parsed(names, "extensionsRequired")?;
            top.document.extensions_required = names.0;
        }
        if let Some(extensions) = top.extensions {
            let extensions: RootExtensions<'_> = parsed(extensions, "extensions")?;
            if let Some(lights) = extensions.lights {
                top.document.lists[List::Lights as usize] = lights.lights.0;
            }
        }
        Ok(top.document)
    }

    /// How many entries a list has.
    pub(super) fn len(&self, list: List) -> usize {
        self.lists[list as usize].len()
    }

    /// Entry `index` of a list, for something at `user` that refers to it.
    pub(super) fn get<T: Deserialize<'a>>(
        &self,
        list: List,
        index: usize,
        user: impl fmt::Display,
    ) -> Result<T, Error> {
        let entries = &self.lists[list as usize];
        let Some(raw) = entries.get(index) else {
            let (name, n) = (list.name(), entries.len());
            return Err(invalid(user, format!("{name}[{index}] is not there"), below(n, name)));
        };
        parsed(raw, &list.entry(index))
    }
}

/// What references to a list of `n` entries are accepted.
pub(super) fn below(n: usize, name: &str) -> String {
    match n.checked_sub(1) {
        Some(last) => format!("0 to {last}"),
        None => format!("none, for there are no {name}"),
    }
}

/// An error about the value at a place of the text.
pub(super) fn invalid(
    at: impl fmt::Display,
    found: impl Into<String>,
    accepted: impl Into<String>,
) -> Error {
    let (found, accepted) = (found.into(), accepted.into());
    Error::new(ErrorKind::Invalid { at: at.to_string(), found, accepted })
}

/// A value of the text at the place `at`.
pub(super) fn parsed<'a, T: Deserialize<'a>>(raw: &'a RawValue, at: &str) -> Result<T, Error> {
    refuse_long_strings(raw.get(), at)?;
    if let Ok(value) = serde_json::from_str(raw.get()) {
        return Ok(value);
    }
    // Once more, with an eye on the place.
    let mut reader = serde_json::Deserializer::from_str(raw.get());
    serde_path_to_error::deserialize(&mut reader).map_err(|error| {
        let inside = error.path().to_string();
        let at = match inside.as_str() {
            "." => at.to_owned(),
            inside => format!("{at}.{}", shortened_to(200, inside)),
        };
        let message = without_place(error.inner());
        match message.split_once(", expected ") {
            Some((found, accepted)) => invalid(at, found, accepted),
            None => invalid(at, message, ""),
        }
    })
}

/// The parser's messages would repeat a string that stands where none should, however long. Only
/// where the URI stands, which may hold data, there may be a long one.
fn refuse_long_strings(text: &str, at: &str) -> Result<(), Error> {
    if text.len() <= MOST_STRING {
        return Ok(());
    }
    let bytes = text.as_bytes();
    let is_quote = |byte: &u8| *byte == b'"';
    let mut from = 0;
    while let Some(open) = bytes[from..].iter().position(is_quote).map(|quote| from + quote) {
        let mut end = open + 1;
        while bytes.get(end).is_some_and(|byte| !is_quote(byte)) {
            end += if bytes[end] == b'\\' { 2 } else { 1 };
        }
        let length = end - open - 1;
        let before = text[..open].trim_end();
        let is_uri =
            || before.strip_suffix(':').is_some_and(|key| key.trim_end().ends_with("\"uri\""));
        if length > MOST_STRING && !is_uri() {
            let accepted = format!("at most {MOST_STRING}");
            return Err(invalid(at, format!("a string of {length} bytes"), accepted));
        }
        from = (end + 1).min(bytes.len());
    }
    Ok(())
}

fn syntax(container: &Container<'_>, error: &serde_json::Error) -> Error {
    let message = without_place(error);
    let (line, column) = (error.line(), error.column());
    if container.is_text {
        let place = Place { line: line.max(1), column: column.max(1) };
        return Error::new(ErrorKind::Syntax { format: "JSON", message }).at(place);
    }
    let message = format!("{message}, at line {line}, column {column} of the JSON chunk");
    Error::new(ErrorKind::Syntax { format: "JSON", message })
}

/// The parser's message on one line, without the place, which is the error's own matter.
fn without_place(error: &serde_json::Error) -> String {
    let message = error.to_string();
    let place = format!(" at line {} column {}", error.line(), error.column());
    shortened_to(200, message.strip_suffix(&place).unwrap_or(&message))
}

/// A list inside an entry, with no more than `MOST` entries.
#[derive(Debug)]
pub(super) struct Bounded<T, const MOST: usize = MOST_ENTRIES>(pub(super) Vec<T>);

impl<T, const MOST: usize> Default for Bounded<T, MOST> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de, T: Deserialize<'de>, const MOST: usize> Deserialize<'de> for Bounded<T, MOST> {
    fn deserialize<D: de::Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        let mut room = MOST;
        ListSeed { room: &mut room, most: MOST, of: PhantomData }.deserialize(reader).map(Self)
    }
}

/// Reads a list while there is room.
struct ListSeed<'r, T> {
    room: &'r mut usize,
    /// How much room there was.
    most: usize,
    of: PhantomData<T>,
}

impl<'de, T: Deserialize<'de>> DeserializeSeed<'de> for ListSeed<'_, T> {
    type Value = Vec<T>;

    fn deserialize<D: de::Deserializer<'de>>(self, reader: D) -> Result<Vec<T>, D::Error> {
        // Who asks for a sequence is told of a string in full; who asks for anything is handed it.
        reader.deserialize_any(self)
    }
}

impl<'de, T: Deserialize<'de>> Visitor<'de> for ListSeed<'_, T> {
    type Value = Vec<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list")
    }

    /// The standard message would hold the whole string.
    fn visit_str<E: de::Error>(self, _: &str) -> Result<Vec<T>, E> {
        Err(E::custom("invalid type: string, expected a list"))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<Vec<T>, A::Error> {
        let mut list = Vec::new();
        while let Some(entry) = entries.next_element()? {
            let Some(room) = self.room.checked_sub(1) else {
                let message = format!("lists of more than {} entries are not read", self.most);
                return Err(de::Error::custom(message));
            };
            *self.room = room;
            list.push(entry);
        }
        Ok(list)
    }
}

/// The text's outermost object.
#[derive(Default)]
struct Top<'a> {
    document: Document<'a>,
    asset: Option<&'a RawValue>,
    scene: Option<&'a RawValue>,
    extensions: Option<&'a RawValue>,
    extensions_used: Option<&'a RawValue>,
    extensions_required: Option<&'a RawValue>,
}

struct TopVisitor;

impl<'de> DeserializeSeed<'de> for TopVisitor {
    type Value = Top<'de>;

    fn deserialize<D: de::Deserializer<'de>>(self, reader: D) -> Result<Top<'de>, D::Error> {
        reader.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for TopVisitor {
    type Value = Top<'de>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a glTF object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Top<'de>, A::Error> {
        let mut top = Top::default();
        let mut room = MOST_ENTRIES;
        while let Some(key) = map.next_key::<Cow<'de, str>>()? {
            let list = LISTS.iter().find(|(list, name)| *name == key && *list != List::Lights);
            if let Some((list, _)) = list {
                let entries = &mut top.document.lists[*list as usize];
                // Lists may not be empty, so an empty one is none that was there before.
                if !entries.is_empty() {
                    return Err(de::Error::custom(format!("{key} is there twice")));
                }
                *entries = map.next_value_seed(ListSeed {
                    room: &mut room,
                    most: MOST_ENTRIES,
                    of: PhantomData,
                })?;
                continue;
            }
            let place = match &*key {
                "asset" => &mut top.asset,
                "scene" => &mut top.scene,
                "extensions" => &mut top.extensions,
                "extensionsUsed" => &mut top.extensions_used,
                "extensionsRequired" => &mut top.extensions_required,
                _ => {
                    map.next_value::<IgnoredAny>()?;
                    continue;
                }
            };
            if place.replace(map.next_value()?).is_some() {
                return Err(de::Error::custom(format!("{key} is there twice")));
            }
        }
        Ok(top)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_stand_where_they_are_looked_for() {
        for (number, (list, name)) in LISTS.iter().enumerate() {
            assert_eq!((*list as usize, list.name()), (number, *name));
        }
    }
}
