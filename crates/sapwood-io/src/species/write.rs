//! Writing: a species as the text of its file.

use std::fmt::Write as _;

use sapwood_rules::weber_penn::{Species, Value, keys};

/// The text of a species file that reads back as `species`.
///
/// Keys stand in the order of the model's table; optional keys that are not set are left out.
pub fn write_species(species: &Species) -> String {
    let mut tables: Vec<(&str, String)> = Vec::new();
    for key in keys() {
        let Some(value) = key.get(species) else { continue };
        let (table, name) = key.name().rsplit_once('.').unwrap_or(("", key.name()));
        let i = tables.iter().position(|(known, _)| *known == table).unwrap_or_else(|| {
            tables.push((table, String::new()));
            tables.len() - 1
        });
        let _ = writeln!(tables[i].1, "{name} = {}", literal(&value));
    }
    // The values at the top of the file must come before the first table.
    tables.sort_by_key(|(table, _)| !table.is_empty());
    let mut text = String::new();
    for (table, lines) in tables {
        if !table.is_empty() {
            let _ = write!(text, "\n[{table}]\n");
        }
        text.push_str(&lines);
    }
    text
}

/// The value in TOML.
fn literal(value: &Value) -> String {
    match value {
        // The shortest digits that read back to the same float, with a point.
        Value::Number(number) => float(*number),
        Value::Whole(number) => number.to_string(),
        Value::Text(text) => quoted(text),
        Value::Texts(texts) => list(texts.iter().map(|text| quoted(text))),
        Value::Numbers(numbers) => list(numbers.iter().copied().map(float)),
        Value::Envelope(written) => quoted(&written.text),
        Value::LeafMesh(written) => quoted(&written.path),
        Value::LeafImage(written) => quoted(&written.path),
        Value::Point(point) => format!("{{ point = {} }}", list(point.iter().copied().map(float))),
    }
}

fn float(number: f32) -> String {
    format!("{number:?}")
}

fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}

fn list(elements: impl Iterator<Item = String>) -> String {
    format!("[{}]", elements.collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use sapwood_rules::weber_penn::{LeafTarget, Target, TreeGenExt, Variation};

    use super::*;
    use crate::parse_species;
    use sapwood_geom::glam::Vec3;

    fn check(species: &Species) {
        let text = write_species(species);
        let back = parse_species(&text, "written").unwrap_or_else(|e| panic!("{e}\n{text}"));
        assert_eq!(&back, species);
    }

    #[test]
    fn what_is_written_reads_back() {
        let mut species = Species { name: "Plain".into(), ..Species::default() };
        check(&species);
        species.name = "Tree \"of\"\n\\Heaven\u{1F333}\t'''\u{7}".into();
        species.notes = vec![String::new(), "two\nlines".into()];
        species.scale = 0.1 + 0.2;
        species.ratio_power = 1e-20;
        species.attraction_up = -99.999;
        species.smooth = Some(0.25);
        species.variation = Variation::Normal;
        species.attraction_target = Target::Direction(Vec3::new(1.0, -0.5, 1e7));
        species.leaves.target = LeafTarget::Point(Vec3::new(0.1, 1e9, -3.0));
        species.ext = Some(TreeGenExt {
            tropism: Some([0.0, 0.1, -2.0]),
            blossom_shape: Some(-1),
            ..TreeGenExt::default()
        });
        check(&species);
    }
}
