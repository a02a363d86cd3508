//! `sapwood species check`: which species can be read, and what is wrong with the others.

use std::io::{self, Write};

use sapwood::rules::weber_penn::Species;

use crate::failure::Failure;

/// Reads all of them, tells of the good ones and fails with what is wrong with the others.
pub(super) fn run(names: &[String], out: &mut dyn Write) -> Result<(), Failure> {
    let mut failure: Option<Failure> = None;
    for name in names {
        match sapwood::io::find_species(name) {
            Ok(species) => describe(name, &species, out)?,
            Err(error) => {
                let error = Failure::from(error);
                failure = Some(match failure {
                    Some(before) => before.and(error),
                    None => error,
                });
            }
        }
    }
    failure.map_or(Ok(()), Err)
}

/// One line for the species, and one for each of its notes.
pub(super) fn describe(name: &str, species: &Species, out: &mut dyn Write) -> io::Result<()> {
    let (dialect, levels) = (species.effective_dialect().name(), species.levels);
    let s = if levels == 1 { "" } else { "s" };
    writeln!(out, "{name}: {}, dialect {dialect}, {levels} level{s} of stems", species.name)?;
    for note in &species.notes {
        writeln!(out, "{name}: note: {note}")?;
    }
    Ok(())
}
