//! `docs/architecture.md` against the manifests and the folder listing.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(path: impl AsRef<Path>) -> String {
    let path = root().join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The rows of the table below a heading of the document, as cells.
fn table(heading: &str) -> Vec<Vec<String>> {
    let text = read("docs/architecture.md");
    let section = text.split(heading).nth(1).unwrap_or_else(|| panic!("no {heading}"));
    let rows = section.lines().skip_while(|line| !line.starts_with("|---"));
    let rows = rows.skip(1).take_while(|line| line.starts_with('|'));
    rows.map(|row| row.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect())
        .collect()
}

/// What stands between backquotes.
fn quoted(cell: &str) -> Vec<String> {
    cell.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

/// The crates of the workspace, each with the crates of the workspace that it depends on.
fn manifests() -> BTreeMap<String, Vec<String>> {
    let workspace: toml::Table = read("Cargo.toml").parse().unwrap();
    let members = workspace["workspace"]["members"].as_array().unwrap();
    let folders = members.iter().map(|member| member.as_str().unwrap());
    let crates = folders.map(|folder| {
        let manifest: toml::Table = read(format!("{folder}/Cargo.toml")).parse().unwrap();
        let name = manifest["package"]["name"].as_str().unwrap().to_owned();
        let tables = ["dependencies", "dev-dependencies", "build-dependencies"];
        let used = tables.iter().filter_map(|table| manifest.get(*table)?.as_table());
        let used = used.flat_map(|table| table.keys().cloned());
        // A crate may name itself in its own tests and benches.
        let used = used.filter(|used| used.starts_with("sapwood") && *used != name);
        let mut used: Vec<String> = used.collect();
        used.sort();
        used.dedup();
        (name, used)
    });
    crates.collect()
}

#[test]
fn the_crate_table_names_every_crate_and_nobody_uses_more_than_it_says() {
    let table: BTreeMap<String, Vec<String>> =
        table("## Crates").iter().map(|row| (quoted(&row[0]).remove(0), quoted(&row[2]))).collect();
    let manifests = manifests();
    assert_eq!(
        table.keys().collect::<Vec<_>>(),
        manifests.keys().collect::<Vec<_>>(),
        "crates in the table and in the workspace"
    );
    for (name, used) in manifests {
        for used in used {
            assert!(table[&name].contains(&used), "{name} uses {used}; the table does not say so");
        }
    }
}

#[test]
fn every_compile_step_has_a_file() {
    for row in table("# Architecture") {
        let step = quoted(&row[0]).remove(0);
        let path = format!("crates/sapwood-scene/src/compile/{step}.rs");
        assert!(root().join(&path).exists(), "{path}");
    }
}

#[test]
fn every_file_of_the_compiler_is_named() {
    let named = quoted(&read("docs/architecture.md"));
    for entry in std::fs::read_dir(root().join("crates/sapwood-scene/src/compile")).unwrap() {
        let file = entry.unwrap().file_name().into_string().unwrap();
        let Some(step) = file.strip_suffix(".rs").filter(|step| *step != "mod") else { continue };
        assert!(named.iter().any(|name| name == step || *name == file), "{file} is not named");
    }
}
