//! `sapwood species`: what is built in, and what is in a species file.

mod check;
mod convert;

use std::io::Write;

use crate::arguments::{SpeciesArguments, SpeciesCommand};
use crate::failure::Failure;

/// Runs the command; without one, lists.
pub(crate) fn run(arguments: SpeciesArguments, out: &mut dyn Write) -> Result<(), Failure> {
    match arguments.command.unwrap_or(SpeciesCommand::List) {
        SpeciesCommand::List => list(out),
        SpeciesCommand::Show { name } => show(&name, out),
        SpeciesCommand::Check { names } => check::run(&names, out),
        SpeciesCommand::Convert { from, to } => convert::run(&from, &to, out),
    }
}

fn list(out: &mut dyn Write) -> Result<(), Failure> {
    for name in sapwood::io::built_in_names() {
        let species = sapwood::io::find_species(name)?;
        let size = match (species.scale, species.scale_v) {
            (scale, 0.0) => format!("{scale} m"),
            (scale, variation) => format!("{scale} +- {variation} m"),
        };
        let (levels, origin) = (species.levels, species.origin.name());
        writeln!(out, "{name:20} {:20} {size:>12}  {levels} levels  {origin}", species.name)?;
    }
    Ok(())
}

/// A built-in species as its file stands, with its comments; any other in the order of the keys.
fn show(name: &str, out: &mut dyn Write) -> Result<(), Failure> {
    match sapwood::io::built_in_text(name) {
        Some(text) => out.write_all(text.as_bytes())?,
        None => {
            let species = sapwood::io::find_species(name)?;
            out.write_all(sapwood::io::write_species(&species).as_bytes())?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use clap::Parser as _;

    use super::*;
    use crate::arguments::Arguments;
    use crate::watch::Watch;

    fn sapwood(arguments: &[&str]) -> Result<String, Failure> {
        let arguments = Arguments::try_parse_from([&["sapwood"], arguments].concat()).unwrap();
        let mut out = Vec::new();
        crate::run(arguments.command, Watch::default, &mut out)?;
        Ok(String::from_utf8(out).unwrap())
    }

    #[test]
    fn all_species_are_listed() {
        let listed = sapwood(&["species", "list"]).unwrap();
        assert_eq!(listed.lines().count(), 38);
        let aspen = listed.lines().find(|line| line.starts_with("quaking_aspen")).unwrap();
        assert!(aspen.contains("Quaking Aspen") && aspen.contains("13 +- 3 m"), "{aspen}");
        assert_eq!(sapwood(&["species"]).unwrap(), listed);
    }

    #[test]
    fn a_species_is_shown_so_that_it_can_be_read_again() {
        for name in sapwood::io::built_in_names() {
            let text = sapwood(&["species", "show", name]).unwrap();
            let species = sapwood::io::parse_species(&text, "shown").unwrap();
            assert_eq!(species, sapwood::io::find_species(name).unwrap());
        }
    }

    #[test]
    fn an_unknown_species_is_an_error_with_a_suggestion() {
        let failure = sapwood(&["species", "show", "oak"]).unwrap_err();
        let shown = format!("{failure:?}");
        assert!(shown.contains("code: 1") && shown.contains("ca_black_oak"), "{shown}");
    }
}
