//! What the documentation says of species files: every key once, in the table of its section, with
//! the values that the reader accepts and the default that it takes.

use sapwood::rules::weber_penn::{Accepted, Dialect, Origin, Species, Value, key, keys};

const TEXT: &str = include_str!("../../docs/species-files.md");

/// A key, and the other cells of its row, without marks.
struct Row {
    section: String,
    key: String,
    accepted: String,
    default: Option<String>,
}

/// The rows of all tables, one for each key.
fn rows(text: &str) -> Vec<Row> {
    let (mut rows, mut section) = (Vec::new(), None);
    for line in text.lines() {
        let Some(cells) = line.strip_prefix("| ").and_then(|line| line.strip_suffix(" |")) else {
            if !line.starts_with("|---") {
                section = None;
            }
            continue;
        };
        let cells: Vec<&str> = cells.split(" | ").collect();
        let Some(section) = &section else {
            // The first line of a table: its section, or that of keys in none.
            let name = cells[0].trim_matches('`').trim_matches(['[', ']']);
            section = Some(if name == "key" { String::new() } else { format!("{name}.") });
            continue;
        };
        let plain = |cell: &str| cell.replace('`', "");
        for key in cells[0].split(", ") {
            rows.push(Row {
                section: section.clone(),
                key: plain(key),
                accepted: plain(cells[2]),
                default: cells.get(3).map(|cell| plain(cell)),
            });
        }
    }
    rows
}

/// Accepted values in the words of the documentation.
fn words(accepted: &Accepted) -> String {
    match *accepted {
        Accepted::Number { min, above_min, max, below_max } => {
            let low = if above_min { format!("above {min}") } else { min.to_string() };
            let high = match (above_min, below_max) {
                (_, true) => format!("up to below {max}"),
                (true, false) => format!("up to {max}"),
                (false, false) => format!("to {max}"),
            };
            format!("{low} {high}")
        }
        Accepted::Whole { min, max } => format!("whole, {min} to {max}"),
        Accepted::Numbers { len, min, max } => format!("{len} numbers, each {min} to {max}"),
        Accepted::Names(names) => {
            names.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ")
        }
        _ => accepted.to_string().replace("the name of a leaf shape: ", ""),
    }
}

/// What is documented of a key: what all species accept, and what those of one program do.
fn documented(name: &str) -> String {
    let of = |name: &str, origin, dialect| words(&key(name).unwrap().accepted(origin, dialect));
    let paper = of(name, Origin::Paper, Dialect::Paper);
    let mut text = paper.clone();
    let others = [
        ("Arbaro's", of(name, Origin::Arbaro, Dialect::Arbaro)),
        ("tree-gen's", of(name, Origin::TreeGen, Dialect::TreeGen)),
    ];
    for (whose, other) in others.into_iter().filter(|(_, other)| *other != paper) {
        text.push_str(&format!("; {whose} {other}"));
    }
    text
}

#[test]
fn every_key_of_a_species_file_is_documented_with_what_it_accepts() {
    let rows = rows(TEXT);
    let mut faults = Vec::new();
    for key in keys() {
        let (table, name) = key.name().rsplit_once('.').unwrap_or(("", key.name()));
        let section = match table {
            "" => String::new(),
            "level.0" | "level.1" | "level.2" | "level.3" => "level.N.".to_owned(),
            table => format!("{table}."),
        };
        let found: Vec<&Row> =
            rows.iter().filter(|row| row.section == section && row.key == name).collect();
        let [row] = found[..] else {
            faults.push(format!("{} stands in {} rows of [{table}]", key.name(), found.len()));
            continue;
        };
        let mut expected = documented(key.name());
        if section == "level.N." {
            expected = documented(&format!("level.1.{name}"));
            let trunk = documented(&format!("level.0.{name}"));
            if trunk != expected {
                expected.push_str(&format!("; the trunk's {trunk}"));
            }
            // The others are alike.
            for level in [2, 3] {
                let alike = documented(&format!("level.{level}.{name}"));
                assert_eq!(alike, documented(&format!("level.1.{name}")));
            }
        }
        if row.accepted != expected {
            faults.push(format!("{}: {:?}, not {expected:?}", key.name(), row.accepted));
        }
        if let Some(default) = &row.default {
            let own = key.get(&Species::default()).map(|value| value.to_string());
            if own.as_ref() != Some(default) {
                faults.push(format!("{}: {default} by default, not {own:?}", key.name()));
            }
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
    for Row { section, key: name, .. } in &rows {
        let known = key(&format!("{}{name}", section.replace('N', "1")));
        assert!(known.is_some(), "there is no key {section}{name}");
    }
    assert!(rows.iter().filter(|row| row.default.is_some()).count() >= 14);
}

#[test]
fn documented_ranges_are_those_that_the_reader_holds_to() {
    // The words and the errors come from one table: a value at each end, and one beyond.
    let check = |name: &str, text: &str, fine: &[f32], refused: &[f32]| {
        assert_eq!(documented(name), text);
        for (values, is_fine) in [(fine, true), (refused, false)] {
            for value in values {
                let set = key(name).unwrap().set(&mut Species::default(), &Value::Number(*value));
                assert_eq!(set.is_ok(), is_fine, "{name} = {value}");
            }
        }
    };
    check("scale", "above 0 up to 1000", &[0.01, 1000.0], &[0.0, 1000.1]);
    check("level.2.taper", "0 up to below 3", &[0.0, 2.99], &[-0.1, 3.0]);
    check("level.1.curve_v", "-90 to 36000", &[-90.0, 36_000.0], &[-90.1, 36_001.0]);
    check("roots.curve_v", "-90 to 36000", &[-90.0, 36_000.0], &[-90.1, 36_001.0]);
    check("lobes", "whole, 0 to 1000", &[0.0, 1000.0], &[-1.0, 0.5, 1001.0]);
    let text = "whole, 0 to 100; tree-gen's whole, -100 to 100";
    check("trunk.base_splits", text, &[0.0, 100.0], &[-1.0, 101.0]);
}
