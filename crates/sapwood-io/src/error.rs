//! The one error type of this crate: what is wrong, where, and what was probably meant.
//!
//! Messages are for the person who wrote the file; programs read [`Error::kind`].

use std::fmt;
use std::io;
use std::path::Path;

/// What a reader or a writer of files could not do.
pub struct Error(Box<Inner>);

struct Inner {
    file: Option<String>,
    place: Option<Place>,
    kind: ErrorKind,
    further: Vec<Error>,
}

/// A place in a text file; both numbers start at 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The line.
    pub line: usize,
    /// The column, in characters.
    pub column: usize,
}

/// What went wrong; new variants may come.
#[derive(Debug)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The file could not be opened or read.
    Read {
        /// What the operating system said.
        cause: io::Error,
    },
    /// The file is longer than any file of its kind needs to be.
    TooLong {
        /// Its length in bytes.
        bytes: u64,
        /// The longest that is read.
        limit: u64,
    },
    /// The text is not UTF-8.
    NotUtf8,
    /// The text is not written in its format.
    Syntax {
        /// The format: `"TOML"`, `"XML"`, `"JSON"`, `"GLB"`, `"OBJ"`, `"PNG"` or `"JPEG"`.
        format: &'static str,
        /// What the parser met and what it expected.
        message: String,
    },
    /// A model whose triangles enclose nothing.
    NoSolid {
        /// What is wrong with them.
        fault: String,
    },
    /// A value that stands for no shape or file, or for one that cannot be read.
    UnreadShape {
        /// The dotted key.
        key: String,
        /// The words.
        text: String,
        /// What is wrong with them.
        fault: String,
    },
    /// XML with a document type declaration; entities and external files are never followed.
    DocumentType,
    /// XML whose elements are nested deeper than any file of its kind needs.
    TooDeep {
        /// The deepest nesting that is read.
        limit: usize,
    },
    /// XML with something where its kind of file has no place for it.
    Unexpected {
        /// What was found.
        found: String,
        /// The element around it, or `the file`.
        within: String,
        /// What may stand there.
        accepted: String,
    },
    /// XML without something that its kind of file needs.
    Missing {
        /// The element or attribute.
        what: String,
        /// The element that should have it, or `the file`.
        within: String,
    },
    /// A parameter that Arbaro does not have.
    UnknownParameter {
        /// The name as written.
        name: String,
        /// The parameter that is spelt most like it.
        suggestion: Option<String>,
    },
    /// A parameter that was given before in the same file.
    Repeated {
        /// The name.
        name: String,
        /// Where it was given first.
        first: Place,
    },
    /// A key that the format does not have.
    UnknownKey {
        /// The key as written.
        key: String,
        /// The dotted name of its table; empty for the top of the file.
        table: String,
        /// The accepted key that is spelt most like it.
        suggestion: Option<String>,
    },
    /// A table that the format does not have.
    UnknownTable {
        /// The dotted name as written.
        table: String,
        /// The accepted table that is spelt most like it.
        suggestion: Option<String>,
    },
    /// A key that must be given and is not.
    MissingKey {
        /// The key.
        key: String,
        /// The dotted name of the table it belongs to; empty for the top of the file.
        table: String,
    },
    /// A value of another type than the key takes.
    WrongType {
        /// The dotted key.
        key: String,
        /// What the key takes.
        expected: String,
        /// What was found.
        found: String,
    },
    /// A number that the key does not accept.
    OutOfRange {
        /// The dotted key.
        key: String,
        /// The value as written.
        value: String,
        /// The accepted values.
        accepted: String,
    },
    /// A name that the key does not accept.
    UnknownName {
        /// The dotted key.
        key: String,
        /// The name as written.
        value: String,
        /// The accepted names.
        accepted: String,
        /// The accepted name that is spelt most like it.
        suggestion: Option<String>,
    },
    /// Neither a built-in species nor a file has this name.
    UnknownSpecies {
        /// The name.
        name: String,
        /// The built-in species that was probably meant.
        suggestion: Option<String>,
    },
    /// Something in a model, or in a file that it refers to, that is not as its format has it.
    Invalid {
        /// Where, by names and numbers that start at 0: `meshes[3].primitives[0].mode`. Empty
        /// where it is the file as a whole.
        at: String,
        /// What was found.
        found: String,
        /// What is read there; empty where `found` says that already.
        accepted: String,
    },
    /// More of something than the reader was told to read.
    OverLimit {
        /// What would be over the limit, as in [`Invalid`](Self::Invalid).
        at: String,
        /// How much there is.
        found: u64,
        /// Of what.
        what: &'static str,
        /// The most that is read.
        limit: u64,
    },
    /// A model whose meshes and instances take far more memory than its files are long.
    Unfolds {
        /// Where that shows, as in [`Invalid`](Self::Invalid).
        at: String,
        /// The bytes that they would take.
        bytes: u64,
        /// The most that files of this length may take.
        limit: u64,
        /// How many bytes were read.
        n_read: u64,
    },
    /// A model that cannot be read without an extension of glTF that is not known here.
    UnknownExtension {
        /// Its name.
        name: String,
    },
    /// The file could not be written; what stood there before still does.
    Write {
        /// What the operating system said.
        cause: io::Error,
    },
    /// Whoever watched the writing wanted it to end; what stood there before still does.
    Stopped,
    /// Something that a file of this format cannot hold.
    Unwritable {
        /// The component that draws it.
        component: String,
        /// What is wrong with it.
        reason: String,
    },
    /// An image that no file can hold.
    UnwritableImage {
        /// What is wrong with it.
        reason: String,
    },
    /// The output would be larger than its format allows.
    TooLarge {
        /// The bytes it would take.
        bytes: u64,
        /// The most that the format allows.
        limit: u64,
    },
}

impl Error {
    pub(crate) fn new(kind: ErrorKind) -> Self {
        Self(Box::new(Inner { file: None, place: None, kind, further: Vec::new() }))
    }

    pub(crate) fn in_file(mut self, file: &str) -> Self {
        self.0.file = Some(file.to_owned());
        self
    }

    pub(crate) fn at(mut self, place: Place) -> Self {
        self.0.place = Some(place);
        self
    }

    /// The first of `errors`, with the others attached; nothing where there is none.
    pub(crate) fn first_of(errors: Vec<Self>) -> Option<Self> {
        let mut errors = errors.into_iter();
        let mut first = errors.next()?;
        first.0.further = errors.collect();
        Some(first)
    }

    /// An error of reading the file at `path`.
    pub(crate) fn read(path: &Path, cause: io::Error) -> Self {
        Self::new(ErrorKind::Read { cause }).in_file(&path.display().to_string())
    }

    /// An error of writing the file at `path`.
    pub(crate) fn write(path: &Path, cause: io::Error) -> Self {
        Self::new(ErrorKind::Write { cause }).in_file(&path.display().to_string())
    }

    /// What went wrong.
    pub fn kind(&self) -> &ErrorKind {
        &self.0.kind
    }

    /// The file, by the name that the caller gave it.
    pub fn file(&self) -> Option<&str> {
        self.0.file.as_deref()
    }

    /// The place in the file, where the error has one.
    pub fn place(&self) -> Option<Place> {
        self.0.place
    }

    /// Whether the error is about output that could not be written, rather than about input.
    pub fn is_write(&self) -> bool {
        matches!(
            self.0.kind,
            ErrorKind::Write { .. }
                | ErrorKind::Stopped
                | ErrorKind::Unwritable { .. }
                | ErrorKind::UnwritableImage { .. }
                | ErrorKind::TooLarge { .. }
        )
    }

    /// This error and all others that were found in the same file, in the order of the file.
    pub fn all(&self) -> impl Iterator<Item = &Error> {
        std::iter::once(self).chain(&self.0.further)
    }

    /// The message of this error alone, on one line.
    pub fn line(&self) -> impl fmt::Display + '_ {
        Line(self)
    }
}

/// One error without those that were found besides.
struct Line<'a>(&'a Error);

impl fmt::Display for Line<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let inner = &self.0.0;
        if let Some(file) = &inner.file {
            write!(f, "{file}:")?;
            if let Some(place) = inner.place {
                write!(f, "{}:{}:", place.line, place.column)?;
            }
            f.write_str(" ")?;
        }
        inner.kind.fmt(f)
    }
}

/// Writes the first error's line, and how many more there are.
impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Line(self).fmt(f)?;
        match self.0.further.len() {
            0 => Ok(()),
            1 => f.write_str("\nand one more error in this file"),
            n => write!(f, "\nand {n} more errors in this file"),
        }
    }
}

impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Error(\"")?;
        fmt::Display::fmt(self, f)?;
        f.write_str("\")")
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &self.0.kind {
            ErrorKind::Read { cause } | ErrorKind::Write { cause } => Some(cause),
            _ => None,
        }
    }
}

impl fmt::Display for ErrorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Read { cause } => write!(f, "cannot be read: {cause}"),
            Self::TooLong { bytes, limit } => {
                write!(f, "is {bytes} bytes long; at most {limit} are read")
            }
            Self::NotUtf8 => f.write_str("not a UTF-8 text from here on"),
            Self::Syntax { format, message } => write!(f, "not valid {format}: {message}"),
            Self::DocumentType => f.write_str(
                "a document type declaration is refused; entities and external files are not read",
            ),
            Self::TooDeep { limit } => write!(f, "elements are nested more than {limit} deep"),
            Self::UnreadShape { key, text, fault } => {
                write!(f, "{key} is {text:?}: {fault}")
            }
            Self::NoSolid { fault } => write!(f, "{fault} (accepted: a closed surface)"),
            Self::Unexpected { found, within, accepted } => {
                write!(f, "unexpected {found} in {within} (accepted: {accepted})")
            }
            Self::Missing { what, within } => write!(f, "missing {what} in {within}"),
            Self::UnknownParameter { name, suggestion } => {
                write!(f, "unknown parameter '{name}'{}", Meant(suggestion, "'", "'"))
            }
            Self::Repeated { name, first } => {
                let Place { line, column } = first;
                write!(f, "{name} was given before, at line {line}, column {column}")
            }
            Self::UnknownKey { key, table, suggestion } => {
                write!(f, "unknown key '{key}'{}{}", In(table), Meant(suggestion, "'", "'"))
            }
            Self::UnknownTable { table, suggestion } => {
                write!(f, "unknown table [{table}]{}", Meant(suggestion, "[", "]"))
            }
            Self::MissingKey { key, table } => write!(f, "missing key '{key}'{}", In(table)),
            Self::WrongType { key, expected, found } => {
                write!(f, "{key} takes {expected}, not {found}")
            }
            Self::OutOfRange { key, value, accepted } => {
                write!(f, "{key} = {value} is out of range (accepted: {accepted})")
            }
            Self::UnknownName { key, value, accepted, suggestion } => {
                let meant = Meant(suggestion, "\"", "\"");
                write!(f, "{key} = \"{value}\" is not known (accepted: {accepted}){meant}")
            }
            Self::UnknownSpecies { name, suggestion } => {
                let meant = Meant(suggestion, "'", "'");
                write!(f, "no built-in species and no file is called '{name}'{meant}")
            }
            Self::Invalid { at, found, accepted } => {
                f.write_str(at)?;
                f.write_str(if at.is_empty() { "" } else { ": " })?;
                f.write_str(found)?;
                if accepted.is_empty() { Ok(()) } else { write!(f, " (accepted: {accepted})") }
            }
            Self::OverLimit { at, found, what, limit } => {
                write!(f, "{at}: {found} {what}; at most {limit} are read")
            }
            Self::Unfolds { at, bytes, limit, n_read } => write!(
                f,
                "{at}: meshes and instances take {bytes} bytes of memory; at most {limit} are \
                 given to {n_read} bytes of files"
            ),
            Self::UnknownExtension { name } => {
                write!(f, "cannot be read without the extension {name}, which is not known")
            }
            Self::Write { cause } => write!(f, "cannot be written: {cause}"),
            Self::Stopped => f.write_str("not written: stopped before the end"),
            Self::Unwritable { component, reason } => {
                write!(f, "component '{component}' cannot be written: {reason}")
            }
            Self::UnwritableImage { reason } => write!(f, "the image cannot be written: {reason}"),
            Self::TooLarge { bytes, limit } => {
                write!(f, "would take {bytes} bytes; the format ends at {limit}")
            }
        }
    }
}

/// ` in [table]`, or ` at the top of the file`.
struct In<'a>(&'a str);

impl fmt::Display for In<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            f.write_str(" at the top of the file")
        } else {
            write!(f, " in [{}]", self.0)
        }
    }
}

/// `; did you mean ...?` between the given quotes, or nothing.
struct Meant<'a>(&'a Option<String>, &'a str, &'a str);

impl fmt::Display for Meant<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Some(meant) => write!(f, "; did you mean {}{meant}{}?", self.1, self.2),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_names_file_place_value_and_range() {
        let error = Error::new(ErrorKind::OutOfRange {
            key: "level.1.taper".into(),
            value: "3.5".into(),
            accepted: "0 <= taper < 3".into(),
        })
        .in_file("aspen.toml")
        .at(Place { line: 12, column: 9 });
        assert_eq!(
            error.to_string(),
            "aspen.toml:12:9: level.1.taper = 3.5 is out of range (accepted: 0 <= taper < 3)"
        );
    }

    #[test]
    fn further_errors_are_counted_in_the_message_and_kept() {
        let missing =
            || Error::new(ErrorKind::MissingKey { key: "shape".into(), table: String::new() });
        let error = Error::first_of(vec![missing(), missing(), missing()]).unwrap();
        assert_eq!(
            error.to_string(),
            "missing key 'shape' at the top of the file\nand 2 more errors in this file"
        );
        assert_eq!(error.all().count(), 3);
        assert!(Error::first_of(Vec::new()).is_none());
    }
}
