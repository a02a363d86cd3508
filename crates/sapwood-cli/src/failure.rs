//! What went wrong, as lines for people and an exit code for scripts.

use std::io;
use std::process::ExitCode;

use sapwood::graph::{Diagnostic, Interrupted};
use sapwood::picture::PictureError;
use sapwood::scene::{EditError, ViewError};

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
    const BUDGET: u8 = 4;
    /// What shells report of a program that an interrupt ended.
    pub(crate) const INTERRUPTED: u8 = 130;

    /// Arguments that do not fit what they are meant for.
    pub(crate) fn usage(line: String) -> Self {
        Self { code: Self::USAGE, lines: vec![line] }
    }

    /// Somebody wanted the program to stop.
    pub(crate) fn interrupted() -> Self {
        let line = "interrupted; nothing was written".to_owned();
        Self { code: Self::INTERRUPTED, lines: vec![line] }
    }

    /// Components that cannot be compiled, each with the links that lead to it.
    pub(crate) fn diagnostics(found: &[(Vec<u32>, Diagnostic)]) -> Self {
        let line = |(path, diagnostic): &(Vec<u32>, Diagnostic)| {
            let links: String = path.iter().map(|link| format!("/{link}")).collect();
            format!("{diagnostic} (at {links})")
        };
        Self { code: Self::INPUT, lines: found.iter().map(line).collect() }
    }

    /// Both failures in one, under the exit code of the first.
    pub(crate) fn and(mut self, other: Self) -> Self {
        self.lines.extend(other.lines);
        self
    }

    /// Writes the lines to standard error and gives the exit code.
    pub(crate) fn report(self) -> ExitCode {
        for line in &self.lines {
            eprintln!("sapwood: {line}");
        }
        ExitCode::from(self.code)
    }
}

impl From<sapwood::io::Error> for Failure {
    fn from(error: sapwood::io::Error) -> Self {
        if matches!(error.kind(), sapwood::io::ErrorKind::Stopped) {
            return Self::interrupted();
        }
        let code = if error.is_write() { Self::OUTPUT } else { Self::INPUT };
        Self { code, lines: error.all().map(|error| error.line().to_string()).collect() }
    }
}

/// A budget that ran out, mostly.
impl From<ViewError> for Failure {
    fn from(error: ViewError) -> Self {
        if error == ViewError::Interrupted(Interrupted::Cancelled) {
            return Self::interrupted();
        }
        let ViewError::Interrupted(Interrupted::Exhausted { what, limit, component }) = error
        else {
            return Self { code: Self::INPUT, lines: vec![error.to_string()] };
        };
        let advice = match what {
            "triangles" => "allow more with --max-triangles, or grow fewer --levels",
            _ => "grow fewer --levels, or lower the species' numbers of branches and leaves",
        };
        let line = format!(
            "this takes more than {limit} {what}, the limit, which was met in a component of \
             kind {component}; {advice}; nothing was written"
        );
        Self { code: Self::BUDGET, lines: vec![line] }
    }
}

/// Something that cannot be looked at, mostly: arguments are checked before.
impl From<PictureError> for Failure {
    fn from(error: PictureError) -> Self {
        match error {
            PictureError::Interrupted(why) => Self::from(ViewError::Interrupted(why)),
            PictureError::Option { .. } => Self::usage(error.to_string()),
            _ => Self { code: Self::INPUT, lines: vec![error.to_string()] },
        }
    }
}

impl From<EditError> for Failure {
    fn from(error: EditError) -> Self {
        Self { code: Self::INPUT, lines: vec![error.to_string()] }
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
        let is_about_wrong =
            |line: &&str| !line.starts_with("Usage:") && !line.starts_with("For more information");
        let lines = message.lines().map(str::trim).take_while(is_about_wrong);
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
