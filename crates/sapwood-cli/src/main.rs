//! The `sapwood` program: arguments in, text and files out.
//!
//! Everything that can be done is done by the library; this program only asks for it and puts
//! the outcome into words and an exit code.

mod arguments;
mod failure;
mod grow;
mod species;

use std::io::{self, IsTerminal as _, Write};
use std::process::ExitCode;

use clap::Parser as _;

use arguments::{Arguments, Command};
use failure::Failure;

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return Failure::from(error).report(),
    };
    tracing_subscriber::fmt()
        .with_max_level(arguments.level())
        .with_writer(io::stderr)
        .with_ansi(io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none())
        .without_time()
        .init();
    let mut out = io::BufWriter::new(io::stdout().lock());
    let done = run(arguments.command, &mut out);
    match done.and_then(|()| out.flush().map_err(Failure::from)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

fn run(command: Command, out: &mut dyn Write) -> Result<(), Failure> {
    match command {
        Command::Grow(command) => grow::run(&command, out),
        Command::Species(command) => species::run(command, out),
    }
}
