//! `sapwood species convert`: any species that can be read as a species file of ours.

use std::io::Write;
use std::path::Path;

use crate::failure::Failure;

/// Reads `from` and writes it to `to`, whole or not at all.
pub(super) fn run(from: &str, to: &Path, out: &mut dyn Write) -> Result<(), Failure> {
    let is_toml = to.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
    if !is_toml {
        let to = to.display();
        return Err(Failure::usage(format!("{to}: accepted: names that end in .toml")));
    }
    let species = sapwood::io::find_species(from)?;
    // A built-in species is read from no file, whatever lies there under its name.
    if sapwood::io::built_in_text(from).is_none() && is_same_file(Path::new(from), to) {
        let to = to.display();
        return Err(Failure::usage(format!("{to} is the file that is read; name another one")));
    }
    let text = sapwood::io::write_species(&species);
    sapwood::io::write_atomically(to, |file| file.write_all(text.as_bytes()))?;
    super::check::describe(&to.display().to_string(), &species, out)?;
    Ok(())
}

/// Whether both are names of one file that is there.
fn is_same_file(a: &Path, b: &Path) -> bool {
    match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    }
}
