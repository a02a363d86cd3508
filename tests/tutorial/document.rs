//! `docs/writing-rules.md` against the files of its steps.

use std::path::Path;

fn read(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The steps of the document in order, each with its file and the code that it prints.
fn steps(document: &str) -> Vec<(&str, String)> {
    let sections = document.split("\n## ").skip(1).enumerate();
    let steps = sections.map(|(i, section)| {
        let heading = section.lines().next().unwrap();
        assert!(heading.starts_with(&format!("Step {}: ", i + 1)), "{heading}");
        let file = heading.split('`').nth(1).unwrap();
        let blocks = section.split("\n```rust\n").skip(1);
        let blocks: Vec<&str> = blocks.map(|block| block.split("```").next().unwrap()).collect();
        (file, blocks.join("\n"))
    });
    steps.collect()
}

/// The text of a file behind what it is for and its imports.
fn body(file: &str) -> String {
    let text = read(&format!("tests/tutorial/{file}"));
    let items = text.split("\n\n").skip_while(|item| {
        ["//!", "use std::", "use sapwood::", "use super::"].iter().any(|top| item.starts_with(top))
    });
    items.collect::<Vec<_>>().join("\n\n")
}

#[test]
fn the_document_prints_every_step_whole() {
    let document = read("docs/writing-rules.md");
    let steps = steps(&document);
    assert_eq!(steps.len(), 7);
    for (file, printed) in steps {
        let text = body(file);
        let differing = text.lines().zip(printed.lines()).find(|(text, printed)| text != printed);
        assert_eq!(differing, None, "{file}");
        assert_eq!(text.len(), printed.len(), "{file}");
    }
}
