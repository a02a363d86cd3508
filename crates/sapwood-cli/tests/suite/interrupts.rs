//! Interrupts: whenever they come, all files are there or none, and nothing else.

#![cfg(unix)]

use std::fs;
use std::io::{BufRead as _, BufReader};
use std::process::{Command, Stdio};

use crate::program::{self, files, says, text};

#[test]
fn an_interrupt_leaves_nothing_half_done() {
    check_interrupts("kill -INT $!");
}

#[test]
fn a_second_interrupt_leaves_no_temporary_files() {
    check_interrupts("kill -INT $!; sleep 0.002; kill -INT $! 2>&-");
}

#[test]
fn a_request_to_terminate_leaves_nothing_half_done() {
    check_interrupts("kill -TERM $!");
}

/// Interrupts at many moments: each time all files are there or none, and nothing else.
fn check_interrupts(interrupt: &str) {
    let images = ["t-1.png", "t-2.png", "t-3.png", "t-4.png", "t-5.png"];
    let whole = [&images[..], &["t.bin", "t.glb", "t.gltf", "t.mtl", "t.obj"]].concat();
    let mut codes = Vec::new();
    for wait in (0..12).map(|step| 0.01 + 0.02 * f64::from(step)) {
        let folder = tempfile::tempdir().expect("the system has a folder for temporary files");
        let line = format!(
            "'{}' grow silver_birch -o t.glb -o t.gltf -o t.obj & sleep {wait}; \
             {interrupt}; wait $!",
            env!("CARGO_BIN_EXE_sapwood")
        );
        let output = Command::new("sh").args(["-c", &line]).current_dir(folder.path()).output();
        let output = output.expect("the program starts");
        let (code, said) =
            (output.status.code().expect("the program ends by itself"), text(&output.stderr));
        let found = files(folder.path());
        match code {
            0 => assert_eq!(found, whole),
            130 => {
                assert!(found.is_empty(), "after {wait} s: {found:?}");
                assert!(said.is_empty() || said.contains("interrupted; nothing"), "{said}");
            }
            // Before the program could say what it makes of interrupts.
            _ => assert!(wait < 0.1 && found.is_empty(), "after {wait} s: {code} {said}"),
        }
        codes.push(code);
    }
    assert!(codes.contains(&130), "{codes:?}");
}

#[test]
fn an_interrupt_or_a_request_to_terminate_leaves_no_picture() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    says(at, "grow palm -o palm.glb");
    for (signal, command) in [
        ("INT", "grow quaking_aspen -o old.png -o new.svg --turntable 3 -o other.png"),
        ("INT", "picture palm.glb -o old.png"),
        ("TERM", "picture palm.glb -o old.png"),
        ("INT", "family quaking_aspen -n 20 --size 600x600 -o old.png"),
    ] {
        fs::write(at.join("old.png"), "old").unwrap();
        let before = files(at);
        // More rays than come back in any time that somebody waits for, and told when they start.
        let mut child = program::command(at, &format!("-v {command} --samples 4096"))
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program runs");
        let mut lines = BufReader::new(child.stderr.take().expect("it is piped")).lines();
        let mut next = || lines.next().map(|line| line.expect("the program writes UTF-8"));
        while !next().expect("it is told that rays start").contains("drawing") {}
        let kill = format!("kill -{signal} {}", child.id());
        assert!(Command::new("sh").args(["-c", &kill]).status().unwrap().success());
        let rest: Vec<String> = std::iter::from_fn(next).collect();
        assert_eq!(child.wait().unwrap().code(), Some(130), "{command}: {rest:?}");
        let last = "sapwood: interrupted; nothing was written";
        assert_eq!(rest.last().map(String::as_str), Some(last), "{command}: {rest:?}");
        assert_eq!(files(at), before, "{command}");
        assert_eq!(fs::read(at.join("old.png")).unwrap(), b"old");
    }
}
