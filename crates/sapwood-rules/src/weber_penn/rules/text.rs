//! Trees in words: how high and wide, how many stems of which length, and the longest branches.
//!
//! A line of text is a label; those of a tree stand below each other, so that the view can be drawn
//! as well as read.

use glam::{Affine3, Vec2, Vec3};
use sapwood_graph::{Label, grouped};
use sapwood_scene::{Context, Rule, RuleError};

use super::super::slots::SpeciesNameSlot;
use super::super::survey::{Figures, LevelFigures, NamedBranch};
use super::super::{Seed, TreeSurvey};
use super::survey::surveyed;

/// Metres from one line to the next, where they are drawn.
const LINE: f32 = 0.3;

/// Tells of a tree in lines of text.
pub(super) struct TreeTextRule;

impl Rule for TreeTextRule {
    type Component = TreeSurvey;
    type Data = ();
    const NAME: &'static str = "weber_penn.tree_text";

    fn init(&self, tree: &TreeSurvey, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let (figures, linear) = surveyed(tree, cx)?;
        let name = cx.read::<SpeciesNameSlot>();
        let lines = lines(&figures, &name, tree.seed);
        cx.transform(Affine3::from_mat3(linear.inverse()), |cx| {
            for (number, line) in lines.iter().enumerate() {
                let at = Vec3::Y * (-LINE * (number + 1) as f32);
                cx.transform(Affine3::from_translation(at), |cx| {
                    cx.label(Label::new(line, LINE / 2.0));
                });
            }
        });
        Ok(())
    }
}

/// The lines about a tree: its name first, what is part of another thing indented.
fn lines(figures: &Figures, name: &str, seed: Seed) -> Vec<String> {
    let name = if name.is_empty() { "a species without a name" } else { name };
    let seed = match seed {
        Seed::Explicit(seed) => format!("seed {seed}"),
        Seed::Path => "seeded by its path".to_owned(),
        Seed::Position { .. } => "seeded by its place".to_owned(),
    };
    let mut lines = vec![format!("{name}, {seed}")];
    if figures.feet.is_empty() {
        lines.push("without a trunk".to_owned());
        return lines;
    }
    let thick = figures.feet.iter().fold(0.0, |most: f32, (_, radius)| most.max(2.0 * radius));
    lines.push(format!("{} high, {} thick at the foot", metres(figures.height), metres(thick)));
    let crown = &figures.crown;
    lines.push(format!(
        "crown {} wide, from {} up",
        metres(2.0 * crown.disc.radius),
        metres(crown.from.max(0.0))
    ));
    for (number, level) in figures.levels.iter().enumerate() {
        lines.push(of_level(number, level));
        if number == 1 {
            lines.extend(figures.longest.iter().map(|branch| format!("  {}", of_branch(branch))));
        }
    }
    if figures.roots.n_stems > 0 {
        let roots = of_stems(&figures.roots, "root", "roots");
        lines.push(format!("{roots}, down to {}", metres(figures.root_depth)));
    }
    lines.push(match figures.n_leaves {
        0 => "no leaves".to_owned(),
        n => {
            format!("{}, up to {} long", counted(n, "leaf", "leaves"), metres(figures.leaf_length))
        }
    });
    lines
}

fn of_level(number: usize, level: &LevelFigures) -> String {
    format!("level {number}: {}", of_stems(level, "stem", "stems"))
}

fn of_stems(level: &LevelFigures, one: &str, many: &str) -> String {
    let LevelFigures { n_stems, n_clones, shortest, longest, total } = level;
    let n = counted(*n_stems, one, many);
    let clones = match n_clones {
        0 => String::new(),
        n => format!(" ({} by splitting)", grouped(*n)),
    };
    let (shortest, longest) = (metres(*shortest), metres(*longest));
    let lengths = match n_stems {
        1 => format!("{longest} long"),
        _ if shortest == longest => format!("{longest} long each"),
        _ => format!("{shortest} to {longest} long, {} together", metres(*total as f32)),
    };
    format!("{n}{clones}, {lengths}")
}

fn of_branch(branch: &NamedBranch) -> String {
    let NamedBranch { length, height, toward } = branch;
    let (length, height) = (metres(*length), metres(*height));
    format!("{length} long, {height} up, {}", bearing(*toward))
}

/// Where a direction leads on a map, in words; x leads east and z south.
fn bearing(toward: Vec2) -> &'static str {
    const WINDS: [&str; 8] = [
        "eastward",
        "northeastward",
        "northward",
        "northwestward",
        "westward",
        "southwestward",
        "southward",
        "southeastward",
    ];
    if toward == Vec2::ZERO {
        return "straight up or down";
    }
    let eighths = sapwood_geom::atan2(-toward.y, toward.x) / std::f32::consts::FRAC_PI_4;
    WINDS[(eighths.round() as i32).rem_euclid(8) as usize]
}

/// A length in metres, in two or three digits that matter; below a millimetre none does.
pub(super) fn metres(length: f32) -> String {
    let digits = match length.abs() {
        0.0..10.0 => 2,
        10.0..100.0 => 1,
        _ => 0,
    };
    let text = match length.abs() {
        0.0005..0.1 => format!("{length:.3}"),
        _ => format!("{length:.digits$}"),
    };
    let text =
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{} m", if text == "-0" { "0" } else { text })
}

/// A number of things, by one name or the other.
fn counted(n: u64, one: &str, many: &str) -> String {
    format!("{} {}", grouped(n), if n == 1 { one } else { many })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_have_digits_that_matter() {
        let told = [0.0, 0.0123, 0.5, 2.499, 9.0, 12.34, 1234.5, -0.0001].map(metres);
        let expected = ["0 m", "0.012 m", "0.5 m", "2.5 m", "9 m", "12.3 m", "1234 m", "0 m"];
        assert_eq!(told, expected);
    }

    #[test]
    fn north_is_up_on_a_map() {
        let told = [(1.0, 0.0), (0.0, -2.0), (-1.0, 1.1), (0.0, 0.5), (1.0, -0.9), (0.0, 0.0)]
            .map(|(x, z)| bearing(Vec2::new(x, z)));
        let expected = [
            "eastward",
            "northward",
            "southwestward",
            "southward",
            "northeastward",
            "straight up or down",
        ];
        assert_eq!(told, expected);
    }
}
