//! Every parameter, changed alone, has the effect that its formula predicts.

mod leaves;
mod levels;
mod tree;

use super::measure::*;
use super::*;

/// A tree before and after one parameter changed, and after it over many seeds.
struct Change {
    species: Species,
    before: Tree,
    after: Tree,
    seeds: Vec<Tree>,
}

impl Change {
    fn trunk(&self) -> &Stem {
        &self.after.levels[0].stems[0]
    }
    fn stems(&self, level: usize) -> &[Stem] {
        &self.after.levels[level].stems
    }
    fn branches(&self) -> &[Stem] {
        self.stems(1)
    }
    /// Something of every stem of a level over many seeds must lie within ± spread of a mean,
    /// and fill that interval.
    fn varies(&self, level: usize, mean: f32, spread: f32, of: impl Fn(&Stems, usize) -> f32) {
        let values: Vec<f32> = self
            .seeds
            .iter()
            .map(|tree| &tree.levels[level])
            .flat_map(|stems| (0..stems.stems.len()).map(|i| of(stems, i)).collect::<Vec<_>>())
            .collect();
        fills(&values, mean, spread);
    }
}

fn n_children_of(stem: &Stem, children: &[Stem]) -> usize {
    let child = |key| stem.seed.path.child(key);
    let paths: Vec<_> = (0..1000).map(child).collect();
    children.iter().filter(|c| paths.contains(&c.seed.path)).count()
}

fn check(name: &str, value: f32, checks: fn(&Change)) {
    println!("{name} = {value}");
    let before = plain();
    let mut species = before.clone();
    key(name).expect(name).set(&mut species, &Value::Number(value)).unwrap();
    assert_eq!(species.faults(), [], "{name}");
    let change = Change {
        before: tree(&before, 1),
        after: tree(&species, 1),
        seeds: (0..40).map(|seed| tree(&species, seed)).collect(),
        species,
    };
    for n in 0..level_of(name).min(3) {
        assert_eq!(change.before.levels[n], change.after.levels[n], "level {n} changed too");
    }
    checks(&change);
}

/// The first level that a key may change; 3 for the leaves.
fn level_of(name: &str) -> usize {
    match name.strip_prefix("level.") {
        Some(rest) => rest[..1].parse().unwrap(),
        None if name.starts_with("leaves.") => 3,
        None => 0,
    }
}

type Case = (&'static str, f32, fn(&Change));

fn check_all(cases: &[Case]) {
    for (name, value, checks) in cases {
        check(name, *value, *checks);
    }
}

#[test]
fn parameters_of_the_tree() {
    check_all(tree::TREE);
}

#[test]
fn parameters_of_the_levels() {
    check_all(levels::LEVELS);
}

#[test]
fn parameters_of_the_leaves() {
    check_all(leaves::LEAVES);
}

#[test]
fn parameters_that_do_not_act_on_growth_change_nothing() {
    for (name, value) in [
        ("z_scale", 2.0),
        ("z_scale_v", 1.0),
        ("smooth", 0.7),
        ("lobes", 5.0),
        ("lobe_depth", 0.2),
        ("pruning.width", 0.1),
        ("level.3.length", 0.9),
        ("level.3.curve_res", 7.0),
    ] {
        check(name, value, |c| {
            assert!(c.before.levels == c.after.levels && c.before.leaves == c.after.leaves);
        });
    }
}

#[test]
fn every_key_has_a_test() {
    let tested: Vec<&str> = tree::TREE
        .iter()
        .chain(levels::LEVELS)
        .chain(leaves::LEAVES)
        .map(|(name, ..)| last(name))
        .collect();
    // Roots have a test for each key beside the rules.
    let elsewhere = [
        "name",
        "origin",
        "defaulted",
        "notes",
        "dialect",
        "variation",
        "attraction_target",
        "z_scale",
        "z_scale_v",
        "lobes",
        "lobe_depth",
        "flare",
        "smooth",
        "leaves.shape",
        "leaves.attraction",
        "leaves.target",
        "leaves.outline",
        "leaves.color",
        "leaves.vein_color",
        "leaves.translucency",
        "leaves.mesh",
        "leaves.roundness",
        "leaves.image",
        "leaves",
        "sides",
        "segments",
        "bark.kind",
        "bark.color",
        "bark.deep_color",
        "bark.depth",
        "bark.width",
        "bark.twig_color",
        "pruning.width",
        "pruning.envelope",
        "split_angle",
        "split_angle_v",
        "ext.tree_gen.base_size",
        "ext.tree_gen.bend_v",
        "ext.tree_gen.branch_dist",
        "ext.tree_gen.radius_mod",
        "ext.tree_gen.tropism",
    ];
    let kept =
        ["ext.tree_gen.blossom_rate", "ext.tree_gen.blossom_scale", "ext.tree_gen.blossom_shape"];
    for key in keys() {
        let name = last(key.name());
        assert!(
            tested.contains(&name)
                || elsewhere.contains(&name)
                || kept.contains(&name)
                || name.starts_with("roots."),
            "{name}"
        );
    }
}

/// The name of a key without its level.
fn last(name: &str) -> &str {
    name.strip_prefix("level.").map_or(name, |rest| &rest[2..])
}
