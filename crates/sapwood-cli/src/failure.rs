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
    /// Of what there was more than a limit allows, if that is what failed.
    exhausted: Option<&'static str>,
}

impl Failure {
    const INPUT: u8 = 1;
    const USAGE: u8 = 2;
    const OUTPUT: u8 = 3;
    const BUDGET: u8 = 4;
    /// What shells report of a program that an interrupt ended.
    pub(crate) const INTERRUPTED: u8 = 130;

    fn new(code: u8, lines: Vec<String>) -> Self {
        Self { code, lines, exhausted: None }
    }

    /// Arguments that do not fit what they are meant for.
    pub(crate) fn usage(line: String) -> Self {
        Self::new(Self::USAGE, vec![line])
    }

    /// More triangles than are allowed.
    pub(crate) fn too_many(line: String) -> Self {
        Self::new(Self::BUDGET, vec![line])
            .advised("allow more with --max-triangles, or grow fewer --levels")
    }

    /// What was asked for cannot be made.
    pub(crate) fn input(line: String) -> Self {
        Self::new(Self::INPUT, vec![line])
    }

    /// Somebody wanted the program to stop.
    pub(crate) fn interrupted() -> Self {
        Self::new(Self::INTERRUPTED, vec!["interrupted; nothing was written".to_owned()])
    }

    /// Components that cannot be compiled, each with the links that lead to it.
    pub(crate) fn diagnostics(found: &[(Vec<u32>, Diagnostic)]) -> Self {
        let line = |(path, diagnostic): &(Vec<u32>, Diagnostic)| {
            let links: String = path.iter().map(|link| format!("/{link}")).collect();
            format!("{diagnostic} (at {links})")
        };
        Self::new(Self::INPUT, found.iter().map(line).collect())
    }

    /// The same of a model that was read: nothing grows there, so other advice helps.
    pub(crate) fn of_model(self) -> Self {
        let Some(what) = self.exhausted else { return self };
        self.advised(match what {
            "shared parts along one ray" => {
                "draw a model in which fewer instances of nodes and meshes overlap"
            }
            "triangles" => "draw a model of fewer triangles",
            _ => "draw a model of fewer nodes, primitives and instances",
        })
    }

    /// A budget's failure with this advice and no other.
    fn advised(mut self, advice: &str) -> Self {
        for line in &mut self.lines {
            line.truncate(line.find(';').unwrap_or(line.len()));
            line.push_str(&format!("; {advice}; nothing was written"));
        }
        self
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
        Self::new(code, error.all().map(|error| error.line().to_string()).collect())
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
            return Self::new(Self::INPUT, vec![error.to_string()]);
        };
        let line = format!(
            "this takes more than {limit} {what}, the limit, which was met in a component of \
             kind {component}"
        );
        Self { code: Self::BUDGET, lines: vec![line], exhausted: Some(what) }.advised(match what {
            "triangles" => "allow more with --max-triangles, or grow fewer --levels",
            _ => "grow fewer --levels, or lower the species' numbers of branches and leaves",
        })
    }
}

/// Something that cannot be looked at, mostly: arguments are checked before.
impl From<PictureError> for Failure {
    fn from(error: PictureError) -> Self {
        match error {
            PictureError::Interrupted(why) => Self::from(ViewError::Interrupted(why)),
            PictureError::Option { .. } | PictureError::Impostor { .. } => {
                Self::usage(error.to_string())
            }
            _ => Self::new(Self::INPUT, vec![error.to_string()]),
        }
    }
}

impl From<EditError> for Failure {
    fn from(error: EditError) -> Self {
        Self::new(Self::INPUT, vec![error.to_string()])
    }
}

/// Arguments that cannot be understood, or a wish for help, which is granted right here.
impl From<clap::Error> for Failure {
    fn from(error: clap::Error) -> Self {
        let text = error.render().to_string();
        let Some(message) = text.strip_prefix("error: ") else {
            let code = if error.use_stderr() { Self::USAGE } else { 0 };
            return match error.print() {
                Ok(()) => Self::new(code, Vec::new()),
                Err(error) => Self::from(error),
            };
        };
        // One line, without the usage that `--help` shows better.
        let is_about_wrong =
            |line: &&str| !line.starts_with("Usage:") && !line.starts_with("For more information");
        let lines = message.lines().map(str::trim).take_while(is_about_wrong);
        let lines: Vec<_> = lines.filter(|line| !line.is_empty()).collect();
        Self::new(Self::USAGE, vec![format!("{} (try --help)", lines.join(" "))])
    }
}

/// An error of writing to standard output.
impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        // Whoever closed the pipe has read enough, as `head` does.
        if error.kind() == io::ErrorKind::BrokenPipe {
            return Self::new(0, Vec::new());
        }
        Self::new(Self::OUTPUT, vec![format!("standard output: {error}")])
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
    fn advice_fits_what_is_drawn() {
        let check = |what, grown: &str, read: &str| {
            let failure = || {
                let why = Interrupted::Exhausted { what, limit: 7, component: "group" };
                Failure::from(PictureError::Interrupted(why))
            };
            for (failure, advice) in [(failure(), grown), (failure().of_model(), read)] {
                let line = format!(
                    "this takes more than 7 {what}, the limit, which was met in a component of \
                     kind group; {advice}; nothing was written"
                );
                assert_eq!((failure.code, failure.lines), (4, vec![line]));
            }
        };
        let grown = "grow fewer --levels, or lower the species' numbers of branches and leaves";
        check(
            "things in a picture",
            grown,
            "draw a model of fewer nodes, primitives and instances",
        );
        check(
            "shared parts along one ray",
            grown,
            "draw a model in which fewer instances of nodes and meshes overlap",
        );
        check(
            "triangles",
            "allow more with --max-triangles, or grow fewer --levels",
            "draw a model of fewer triangles",
        );
        let other = Failure::usage("a; b".to_owned()).of_model();
        assert_eq!((other.code, other.lines), (2, vec!["a; b".to_owned()]));
    }

    #[test]
    fn a_reader_who_has_enough_is_no_failure() {
        let failure = Failure::from(io::Error::from(io::ErrorKind::BrokenPipe));
        assert_eq!((failure.code, failure.lines.len()), (0, 0));
    }
}
