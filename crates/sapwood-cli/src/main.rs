//! The `sapwood` program: arguments in, text and files out.
//!
//! Everything that can be done is done by the library; this program only asks for it and puts
//! the outcome into words and an exit code.

mod accepted;
mod arguments;
mod dump;
mod failure;
mod family;
mod grow;
mod picture;
mod seed;
mod species;
mod tree;
mod watch;

use std::io::{self, IsTerminal as _, Write};
use std::process::ExitCode;

use clap::Parser as _;

use arguments::{Arguments, Command};
use failure::Failure;
use watch::Watch;

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return Failure::from(error).report(),
    };
    // Progress and what is told by --verbose would overwrite each other.
    let shows_progress = arguments.verbose == 0 && io::stderr().is_terminal();
    tracing_subscriber::fmt()
        .with_max_level(arguments.level())
        .with_writer(io::stderr)
        .with_ansi(io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none())
        .without_time()
        .init();
    let mut out = io::BufWriter::new(io::stdout().lock());
    let watch = || Watch::of_process(shows_progress);
    let done = run(arguments.command, watch, &mut out);
    match done.and_then(|()| out.flush().map_err(Failure::from)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

/// Runs a command; one that takes long is given a `watch`.
fn run(
    command: Command,
    watch: impl FnOnce() -> Watch,
    out: &mut dyn Write,
) -> Result<(), Failure> {
    match command {
        Command::Grow(command) => grow::run(&command.with_detail(), &watch(), out),
        Command::Picture(command) => picture::run(&command, &watch(), out),
        Command::Family(command) => family::run(&command, &watch(), out),
        Command::Dump(command) => dump::run(&command, &watch(), out),
        Command::Species(command) => species::run(command, out),
    }
}
