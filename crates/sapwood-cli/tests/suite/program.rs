//! The program, run in a folder, and what is expected of every run.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// The program with the words of a line as its arguments.
pub(crate) fn command(folder: &Path, line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sapwood"));
    command.args(line.split_whitespace()).current_dir(folder);
    command
}

pub(crate) fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("the program writes UTF-8")
}

/// The program succeeds and says nothing on standard error; gives its output.
pub(crate) fn says(folder: &Path, line: &str) -> String {
    let output = command(folder, line).output().expect("the program runs");
    assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""), "{line}");
    text(&output.stdout).to_owned()
}

/// The program fails with this code in one line and without output, and no file comes or goes;
/// gives the line.
pub(crate) fn fails(folder: &Path, line: &str, code: i32) -> String {
    fails_as(command(folder, line), folder, line, code)
}

/// Like [`fails`], with 2 s of processor time and, where the system counts it, 384 MiB of
/// addresses: 256 MiB to work with and the rest for the program's own code, its threads and what
/// the allocator sets aside for each. That is more than is ever touched, and less than a bomb takes.
pub(crate) fn fails_in_little(folder: &Path, line: &str, code: i32) -> String {
    if !cfg!(target_os = "linux") {
        return fails(folder, line, code);
    }
    let limited = "ulimit -t 2 && ulimit -v 393216 && exec \"$@\"";
    let mut command = Command::new("sh");
    command
        .args(["-c", limited, "sh", env!("CARGO_BIN_EXE_sapwood")])
        .args(line.split_whitespace())
        .env("RAYON_NUM_THREADS", "2")
        .current_dir(folder);
    fails_as(command, folder, line, code)
}

fn fails_as(mut command: Command, folder: &Path, line: &str, code: i32) -> String {
    let before = files(folder);
    let output: Output = command.output().expect("the program runs");
    let said = text(&output.stderr).to_owned();
    assert_eq!((output.status.code(), text(&output.stdout)), (Some(code), ""), "{line}: {said}");
    assert_eq!(files(folder), before, "{line}");
    assert!(said.starts_with("sapwood: ") && said.lines().count() == 1, "{line}: {said}");
    said
}

/// The names of the files in a folder, in order.
pub(crate) fn files(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("the folder is there");
    let name = |entry: std::io::Result<fs::DirEntry>| {
        entry.expect("the folder can be read").file_name().to_string_lossy().into_owned()
    };
    let mut names: Vec<_> = entries.map(name).collect();
    names.sort();
    names
}

pub(crate) fn json(text: &str) -> serde_json::Value {
    assert_eq!(text.lines().count(), 1, "{text}");
    serde_json::from_str(text).expect("the program writes JSON")
}
