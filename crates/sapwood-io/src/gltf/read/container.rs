//! The container: what of a file's bytes is the JSON text, and what is the binary chunk.

use super::document::Document;
use crate::{Error, ErrorKind, Place};

const MAGIC: &[u8] = b"glTF";
const JSON: u32 = 0x4e4f_534a;
const BIN: u32 = 0x004e_4942;
const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;

/// The two parts of a file.
pub(super) struct Container<'a> {
    pub(super) text: &'a str,
    pub(super) bin: Option<&'a [u8]>,
    /// Whether the text is the file as a whole, so that places in it are places in the file.
    pub(super) is_text: bool,
    /// How many bytes stand behind the end of a binary file.
    pub(super) n_behind: usize,
}

impl<'a> Container<'a> {
    /// Takes a file apart. Texts longer than `most_text` bytes are refused.
    pub(super) fn of(bytes: &'a [u8], most_text: u64) -> Result<Self, Error> {
        if bytes.starts_with(MAGIC) {
            return Self::binary(bytes, most_text);
        }
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        look_at_beginning(bytes)?;
        if text.trim_ascii_start().is_empty() {
            return Err(stranger("no text".to_owned()));
        }
        Ok(Self { text: utf8(text, most_text, true)?, bin: None, is_text: true, n_behind: 0 })
    }

    fn binary(bytes: &'a [u8], most_text: u64) -> Result<Self, Error> {
        let [Some(version), Some(length)] = [4, 8].map(|at| number(bytes, at)) else {
            return Err(broken(format!("{} bytes; the header alone takes 12", bytes.len())));
        };
        if version != 2 {
            return Err(broken(format!("version {version}; only version 2 is read")));
        }
        let there = bytes.len();
        let length = length as usize;
        if length < HEADER || length > there {
            return Err(broken(format!("its header tells of {length} bytes; {there} are there")));
        }
        let mut text = None;
        let mut bin = None;
        let mut rest = &bytes[HEADER..length];
        for number_of_chunk in 0.. {
            // Fewer bytes than a header takes are padding.
            let (Some(size), Some(kind)) = (number(rest, 0), number(rest, 4)) else { break };
            let inside = &rest[CHUNK_HEADER..];
            let size = size as usize;
            let Some(chunk) = inside.get(..size) else {
                let there = inside.len();
                return Err(broken(format!(
                    "chunk {number_of_chunk} tells of {size} bytes; {there} are there"
                )));
            };
            match (number_of_chunk, kind) {
                (0, JSON) => text = Some(chunk),
                (0, _) => return Err(broken("the first chunk is no JSON".to_owned())),
                (1, BIN) => bin = Some(chunk),
                // The format wants other chunks passed over.
                _ => {}
            }
            rest = &inside[size..];
        }
        let text = text.ok_or_else(|| broken("no chunk of JSON".to_owned()))?;
        let text = utf8(text, most_text, false)?;
        Ok(Self { text, bin, is_text: false, n_behind: there - length })
    }
}

/// How many bytes from the beginning on hold the text of a file that begins like `head`, so that it
/// can be looked at before the rest is read; nothing where that is all of them.
pub(super) fn n_text(head: &[u8], most_text: u64) -> Result<Option<u64>, Error> {
    look_at_beginning(head)?;
    if !head.starts_with(MAGIC) {
        return Ok(None);
    }
    let size = number(head, HEADER).map_or(0, u64::from);
    check_text(size, most_text)?;
    Ok(Some((HEADER + CHUNK_HEADER) as u64 + size))
}

/// Whether the text of a binary file, of which no more than that was read, is sound.
pub(super) fn look_at_text(bytes: &[u8], most_text: u64) -> Result<(), Error> {
    let chunk = bytes.get(HEADER + CHUNK_HEADER..).unwrap_or_default();
    let text = utf8(chunk, most_text, false)?;
    let container = Container { text, bin: None, is_text: false, n_behind: 0 };
    Document::of(&container).map(drop)
}

/// The first bytes tell what is no glTF at all.
fn look_at_beginning(bytes: &[u8]) -> Result<(), Error> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    if bytes.starts_with(MAGIC) || text.first().is_none_or(|first| *first == b'{') {
        return Ok(());
    }
    Err(stranger(format!("begins with the bytes {:02x?}", &bytes[..bytes.len().min(4)])))
}

fn stranger(found: String) -> Error {
    let accepted = "a binary glTF file, or a glTF text".to_owned();
    Error::new(ErrorKind::Invalid { at: String::new(), found, accepted })
}

/// Whether a text may be so long.
pub(super) fn check_text(bytes: u64, most: u64) -> Result<(), Error> {
    if bytes <= most {
        return Ok(());
    }
    let at = "the JSON text".to_owned();
    Err(Error::new(ErrorKind::OverLimit { at, found: bytes, what: "bytes", limit: most }))
}

fn utf8(text: &[u8], most: u64, is_text: bool) -> Result<&str, Error> {
    check_text(text.len() as u64, most)?;
    std::str::from_utf8(text).map_err(|fault| {
        let before = &text[..fault.valid_up_to()];
        if !is_text {
            return broken(format!("byte {} of the JSON text is not UTF-8", before.len()));
        }
        let line_start = before.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
        let line = before.iter().filter(|byte| **byte == b'\n').count() + 1;
        let column = String::from_utf8_lossy(&before[line_start..]).chars().count() + 1;
        Error::new(ErrorKind::NotUtf8).at(Place { line, column })
    })
}

fn number(bytes: &[u8], at: usize) -> Option<u32> {
    let bytes = bytes.get(at..at + 4)?;
    Some(u32::from_le_bytes(bytes.try_into().ok()?))
}

fn broken(message: String) -> Error {
    Error::new(ErrorKind::Syntax { format: "GLB", message })
}
