//! The text of a file, and where in it things stand.

use std::ops::Range;
use std::path::Path;

use crate::{Error, ErrorKind, Place};

/// The text of a file under its name.
pub(super) struct Source<'a> {
    /// The text without a byte-order mark.
    pub(super) text: &'a str,
    file: &'a str,
    /// From where the paths of further files are taken; the working folder, if there is none.
    pub(super) folder: Option<&'a Path>,
}

impl<'a> Source<'a> {
    /// The text in `bytes`, which must be UTF-8; a byte-order mark in front is skipped.
    pub(super) fn new(bytes: &'a [u8], file: &'a str) -> Result<Self, Error> {
        let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
        match std::str::from_utf8(bytes) {
            Ok(text) => Ok(Self { text, file, folder: None }),
            Err(error) => {
                let (good, _) = bytes.split_at(error.valid_up_to());
                // The part before the fault is UTF-8, by the meaning of `valid_up_to`.
                let text = std::str::from_utf8(good).unwrap_or_default();
                let source = Self { text, file, folder: None };
                Err(source.error(ErrorKind::NotUtf8, Some(text.len())))
            }
        }
    }

    /// The same text; further files that it names are looked for in `folder`.
    pub(super) fn beside(self, folder: Option<&'a Path>) -> Self {
        Self { folder, ..self }
    }

    /// An error of this file, at a byte of its text if there is one to name.
    pub(super) fn error(&self, kind: ErrorKind, offset: Option<usize>) -> Error {
        let error = Error::new(kind).in_file(self.file);
        match offset {
            Some(offset) => error.at(self.place(offset)),
            None => error,
        }
    }

    /// The line and column of a byte.
    pub(super) fn place(&self, offset: usize) -> Place {
        let before = &self.text[..self.text.floor_char_boundary(offset)];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        Place {
            line: 1 + before.bytes().filter(|byte| *byte == b'\n').count(),
            column: 1 + before[line_start..].chars().count(),
        }
    }

    /// The text in `span` on one line, shortened for messages.
    pub(super) fn excerpt(&self, span: Range<usize>) -> String {
        shortened(self.text.get(span).unwrap_or_default())
    }
}

/// `text` on one line and no longer than a message can bear.
pub(super) fn shortened(text: &str) -> String {
    crate::spelling::shortened_to(40, text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_count_lines_and_characters_from_one() {
        let source = Source::new("a\nüb = 1".as_bytes(), "f").unwrap();
        assert_eq!(source.place(0), Place { line: 1, column: 1 });
        assert_eq!(source.place(4), Place { line: 2, column: 2 });
        assert_eq!(source.place(1000), Place { line: 2, column: 7 });
    }

    #[test]
    fn excerpts_are_short_and_on_one_line() {
        let text = format!("[1,\n 2]{}", "x".repeat(100));
        let source = Source::new(text.as_bytes(), "f").unwrap();
        assert_eq!(source.excerpt(0..7), "[1, 2]");
        assert_eq!(source.excerpt(0..100).chars().count(), 43);
    }
}
