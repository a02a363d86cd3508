//! Species in TOML: one table per file, keys and accepted values by the model's table of keys.
//! Files of Arbaro, which are XML, are read as well.
//!
//! Angles are degrees and lengths metres in these files. What the keys mean is the model's
//! matter; this module reads, checks and writes them.

mod arbaro;
mod built_in;
mod found;
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

/// The species that `name` stands for: a built-in one, or else the file at that path.
///
/// A built-in name wins over a file of the same name; `./name` is always a file.
///
/// # Errors
/// When there is neither, with a suggestion, and those of [`read_species`].
pub fn find_species(name: &str) -> Result<Species, Error> {
    if let Some(species) = built_in(name) {
        return Ok(species);
    }
    let path = Path::new(name);
    // What looks like a path gets the error of a path.
    let like_a_path = path.components().count() > 1 || path.extension().is_some();
    if like_a_path || path.exists() {
        return read_species(path);
    }
    let suggestion = suggest(name).map(str::to_owned);
    Err(Error::new(ErrorKind::UnknownSpecies { name: name.to_owned(), suggestion }))
}

/// Reads the species file at `path`, TOML or Arbaro's XML.
///
/// A text that begins with `<` is XML, and so is every file whose name ends in `.xml`.
///
/// # Errors
/// When the file cannot be read or is longer than 1 MiB, and those of [`parse_species`].
pub fn read_species(path: impl AsRef<Path>) -> Result<Species, Error> {
    let path = path.as_ref();
    let file = path.display().to_string();
    let text = read_text(path).map_err(|error| error.in_file(&file))?;
    let ending = path.extension().unwrap_or_default();
    parse(&text, &file, path.parent(), ending.eq_ignore_ascii_case("xml"))
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
/// In TOML `name`, `shape`, `scale`, `levels` and `ratio` must be given, and `branches` and
/// `length` for every level of branches; all else has defaults. A text that begins with `<` is a
/// species file of Arbaro, where only the name must be given: the species has Arbaro's origin and
/// thereby its dialect, and `defaulted` lists the keys that the file leaves to their defaults.
///
/// # Errors
/// When the text is no TOML or XML, has unknown keys, lacks one, or has a value that its key does
/// not accept; in XML also a document type, a parameter given twice and whatever has no place in
/// Arbaro's files. All errors of the text are found in one go, up to 20; see [`Error::all`].
pub fn parse_species(text: &str, file_name: &str) -> Result<Species, Error> {
    parse(text.as_bytes(), file_name, None, false)
}

fn parse(text: &[u8], file: &str, folder: Option<&Path>, is_xml: bool) -> Result<Species, Error> {
    let bytes = text.len() as u64;
    if bytes > LONGEST {
        let error = Error::new(ErrorKind::TooLong { bytes, limit: LONGEST });
        return Err(error.in_file(file));
    }
    let source = source::Source::new(text, file)?.beside(folder);
    // No TOML begins like this.
    if is_xml || source.text.trim_start().starts_with('<') {
        arbaro::species(&source)
    } else {
        read::species(&source)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn species_are_found_by_name_or_path_or_suggested() {
        assert_eq!(find_species("wheat").unwrap().name, "Wheat");
        let error = |name| find_species(name).unwrap_err().to_string();
        assert_eq!(
            error("oak"),
            "no built-in species and no file is called 'oak'; did you mean 'ca_black_oak'?"
        );
        assert_eq!(error("zebra"), "no built-in species and no file is called 'zebra'");
        assert!(error("no/oak").starts_with("no/oak: cannot be read: "));
        assert!(error("oak.toml").starts_with("oak.toml: cannot be read: "));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("wheat");
        std::fs::write(&path, built_in_text("apple").unwrap()).unwrap();
        assert_eq!(find_species(path.to_str().unwrap()).unwrap().name, "Apple");
    }
}
