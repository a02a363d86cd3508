//! Species in TOML: one table per file, keys and accepted values by the model's table of keys.
//!
//! Angles are degrees and lengths metres in these files. What the keys mean is the model's
//! matter; this module reads, checks and writes them.

mod built_in;
mod read;
mod source;
mod write;

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use sapwood_rules::weber_penn::Species;

use crate::{Error, ErrorKind};

pub use built_in::{built_in, built_in_names, built_in_text, suggest};
pub use write::write_species;

/// The longest species file that is read; a thousand times the usual.
const LONGEST: u64 = 1 << 20;

/// Reads the species file at `path`.
///
/// # Errors
/// When the file cannot be read or is longer than 1 MiB, and those of [`parse_species`].
pub fn read_species(path: impl AsRef<Path>) -> Result<Species, Error> {
    let path = path.as_ref();
    let file = path.display().to_string();
    let text = read_text(path).map_err(|error| error.in_file(&file))?;
    parse(&text, &file)
}

fn read_text(path: &Path) -> Result<Vec<u8>, Error> {
    let cannot = |cause| Error::read(path, cause);
    let file = File::open(path).map_err(cannot)?;
    let about = file.metadata().map_err(cannot)?;
    if about.is_dir() {
        return Err(cannot(std::io::ErrorKind::IsADirectory.into()));
    }
    if about.len() > LONGEST {
        return Err(Error::new(ErrorKind::TooLong { bytes: about.len(), limit: LONGEST }));
    }
    // A pipe has no length beforehand, and a file may grow meanwhile.
    let mut text = Vec::new();
    file.take(LONGEST + 1).read_to_end(&mut text).map_err(cannot)?;
    Ok(text)
}

/// Reads a species from the text of its file; `file_name` serves error messages alone.
///
/// `name`, `shape`, `scale`, `levels` and `ratio` must be given, and `branches` and `length` for
/// every level of branches; all else has defaults.
///
/// # Errors
/// When the text is no TOML, has unknown keys, lacks one, or has a value that its key does not
/// accept. All errors of the text are found in one go, up to 20; see [`Error::all`].
pub fn parse_species(text: &str, file_name: &str) -> Result<Species, Error> {
    parse(text.as_bytes(), file_name)
}

fn parse(text: &[u8], file: &str) -> Result<Species, Error> {
    let bytes = text.len() as u64;
    if bytes > LONGEST {
        let error = Error::new(ErrorKind::TooLong { bytes, limit: LONGEST });
        return Err(error.in_file(file));
    }
    let source = source::Source::new(text, file)?;
    read::species(&source)
}
