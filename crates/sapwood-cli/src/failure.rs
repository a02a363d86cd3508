//! What went wrong, as lines for people and an exit code for scripts.

use std::io;
use std::process::ExitCode;

/// A failed command.
#[derive(Debug)]
pub(crate) struct Failure {
    code: u8,
    lines: Vec<String>,
}

impl Failure {
    const INPUT: u8 = 1;
    const USAGE: u8 = 2;
    const OUTPUT: u8 = 3;

    /// Writes the lines to standard error and gives the exit code.
    pub(crate) fn report(self) -> ExitCode {
        for line in &self.lines {
            eprintln!("sapwood: {line}");
        }
        ExitCode::from(self.code)
    }
}

impl From<sapwood_io::Error> for Failure {
    fn from(error: sapwood_io::Error) -> Self {
        let code = if error.is_write() { Self::OUTPUT } else { Self::INPUT };
        Self { code, lines: error.all().map(|error| error.line().to_string()).collect() }
    }
}

/// Arguments that cannot be understood, or a wish for help, which is granted right here.
impl From<clap::Error> for Failure {
    fn from(error: clap::Error) -> Self {
        let text = error.render().to_string();
        let Some(message) = text.strip_prefix("error: ") else {
            let code = if error.use_stderr() { Self::USAGE } else { 0 };
            return match error.print() {
                Ok(()) => Self { code, lines: Vec::new() },
                Err(error) => Self::from(error),
            };
        };
        // One line, without the usage that `--help` shows better.
        let lines = message.lines().map(str::trim).take_while(|line| !line.starts_with("Usage:"));
        let lines: Vec<_> = lines.filter(|line| !line.is_empty()).collect();
        Self { code: Self::USAGE, lines: vec![format!("{} (try --help)", lines.join(" "))] }
    }
}

/// An error of writing to standard output.
impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        // Whoever closed the pipe has read enough, as `head` does.
        if error.kind() == io::ErrorKind::BrokenPipe {
            return Self { code: 0, lines: Vec::new() };
        }
        Self { code: Self::OUTPUT, lines: vec![format!("standard output: {error}")] }
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser as _;

    use super::*;
    use crate::arguments::Arguments;

    #[test]
    fn wrong_arguments_are_one_line_and_exit_with_2() {
        let check = |arguments: &[&str], expected: &str| {
            let arguments = [&["sapwood"], arguments].concat();
            let failure = Failure::from(Arguments::try_parse_from(arguments).unwrap_err());
            assert_eq!((failure.code, failure.lines), (2, vec![expected.to_owned()]));
        };
        check(
            &["species", "shwo"],
            "unrecognized subcommand 'shwo' tip: a similar subcommand exists: 'show' (try --help)",
        );
        check(
            &["species", "show"],
            "the following required arguments were not provided: <NAME|FILE> (try --help)",
        );
    }

    #[test]
    fn a_reader_who_has_enough_is_no_failure() {
        let failure = Failure::from(io::Error::from(io::ErrorKind::BrokenPipe));
        assert_eq!((failure.code, failure.lines.len()), (0, 0));
    }
}
