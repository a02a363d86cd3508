//! The arguments and their help texts.

use clap::{ArgAction, Args, Parser, Subcommand};
use tracing_subscriber::filter::LevelFilter;

const EXIT_CODES: &str = "\
Exit codes:
  0  done
  1  the input is at fault: an unknown species, an error in a file
  2  the arguments are at fault
  3  the output could not be written; an existing file is left as it was
  4  a budget was exceeded, such as the number of triangles";

/// Grows scenes from descriptions.
#[derive(Debug, Parser)]
#[command(name = "sapwood", version, after_help = EXIT_CODES, arg_required_else_help = true)]
pub(crate) struct Arguments {
    /// Tell what is going on, on standard error; twice: in detail
    #[arg(short, long, global = true, action = ArgAction::Count)]
    pub(crate) verbose: u8,
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Built-in species: list them, show one
    Species(SpeciesArguments),
}

#[derive(Args, Debug)]
pub(crate) struct SpeciesArguments {
    #[command(subcommand)]
    pub(crate) command: Option<SpeciesCommand>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum SpeciesCommand {
    /// One line for each built-in species
    List,
    /// The text of a species file, to be saved and changed
    Show {
        /// Name of a built-in species, or a species file to check and print in full
        #[arg(value_name = "NAME|FILE")]
        name: String,
    },
}

impl Arguments {
    /// What is told on standard error.
    pub(crate) fn level(&self) -> LevelFilter {
        match self.verbose {
            0 => LevelFilter::WARN,
            1 => LevelFilter::INFO,
            2 => LevelFilter::DEBUG,
            _ => LevelFilter::TRACE,
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;

    #[test]
    fn the_arguments_are_consistent_and_the_help_tells_exit_codes() {
        Arguments::command().debug_assert();
        let help = Arguments::command().render_long_help().to_string();
        assert!(help.contains("Exit codes:\n  0  done"), "{help}");
    }
}
