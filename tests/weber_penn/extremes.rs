//! Extreme parameters: budgets end growth that multiplies, and whatever a key accepts grows
//! something finite.

use std::time::{Duration, Instant};

use sapwood::graph::Interrupted;
use sapwood::rules::weber_penn::{Accepted, Dialect, Species, Value, keys};
use sapwood::scene::{Budget, Scene, ViewError};

use super::foreseen::{foreseen_of, outside};
use super::trees::*;

#[test]
fn splits_that_multiply_end_at_the_budget() {
    // Each stem alone has 3 to the 7th tips.
    let splits: Vec<_> = (0..4)
        .flat_map(|level| [("seg_splits", 2.0), ("curve_res", 8.0)].map(|key| (level, key)))
        .map(|(level, (key, value))| (format!("level.{level}.{key}"), value))
        .collect();
    let splits: Vec<_> = splits.iter().map(|(key, value)| (key.as_str(), *value)).collect();
    for name in ["quaking_aspen", "black_tupelo", "weeping_willow"] {
        let start = Instant::now();
        let mut tree = planted_in(Scene::new(), &with(&built_in(name), &splits), 1);
        let budget = Budget { parts: 300_000, ..Budget::default() };
        tree.scene.set_budget(tree.view, budget).unwrap();
        let error = tree.scene.bounds(tree.view).unwrap_err();
        let ViewError::Interrupted(Interrupted::Exhausted { what, limit, .. }) = error else {
            panic!("{name}: {error}");
        };
        assert_eq!((what, limit), ("parts", 300_000), "{name}");
        assert!(start.elapsed() < Duration::from_secs(20), "{name}: {:?}", start.elapsed());
        // What is there stays, and the same tree without the splits still grows.
        tree.set(&sapling());
        tree.scene.evict();
        assert!(!tree.scene.bounds(tree.view).unwrap().is_empty());
    }
}

#[test]
fn triangles_end_at_the_budget() {
    let mut tree = planted_in(Scene::new(), &built_in("quaking_aspen"), 1);
    let budget = Budget { triangles: 10_000, ..Budget::default() };
    tree.scene.set_budget(tree.view, budget).unwrap();
    let error = tree.scene.bounds(tree.view).unwrap_err();
    assert!(error.to_string().starts_with("more than 10000 triangles"), "{error}");
    tree.scene.set_budget(tree.view, Budget::default()).unwrap();
    let grown = digest(&tree.draw_list());
    let mut unhindered = planted_in(Scene::new(), &built_in("quaking_aspen"), 1);
    assert_eq!(digest(&unhindered.draw_list()), grown);
}

/// The ends of what a key accepts.
fn ends(accepted: &Accepted) -> Vec<Value> {
    match *accepted {
        Accepted::Number { min, above_min, max, below_max } => {
            let low = if above_min { min + 1e-6 } else { min };
            let high = if below_max { max - 1e-6 } else { max };
            vec![Value::Number(low), Value::Number(high)]
        }
        Accepted::Whole { min, max } => vec![Value::Whole(min), Value::Whole(max)],
        Accepted::Numbers { len, min, max } => {
            [min, max].map(|end| Value::Numbers(vec![end; len])).to_vec()
        }
        Accepted::Text
        | Accepted::Texts
        | Accepted::Names(_)
        | Accepted::LeafShape
        | Accepted::Target
        | Accepted::LeafTarget
        | Accepted::Envelope
        | Accepted::LeafMesh
        | Accepted::LeafImage => Vec::new(),
    }
}

/// Grows a tree and looks whether all of it is sound; a budget may end it.
fn check(species: &Species, what: &str) {
    let mut tree = planted_in(Scene::new(), species, 1);
    let budget = Budget { parts: 100_000, triangles: 1_000_000, ..Budget::default() };
    tree.scene.set_budget(tree.view, budget).unwrap();
    let bound = match tree.scene.bounds(tree.view) {
        Ok(bound) => bound,
        Err(ViewError::Interrupted(Interrupted::Exhausted { .. })) => return,
        Err(error) => panic!("{what}: {error}"),
    };
    assert_eq!(tree.scene.diagnostics(tree.view, 3).unwrap(), [], "{what}");
    assert_eq!(fault(&tree.draw_list(), &bound.aabb), None, "{what}");
    if let Some(foreseen) = foreseen_of(species, 1.0) {
        assert_eq!(outside(&tree.draw_list(), &foreseen), None, "{what}: not in {foreseen:?}");
    }
}

/// Sets each key of a species to the ends of what it accepts.
fn check_all(species: &Species) {
    let dialect = species.effective_dialect();
    for key in keys() {
        for end in ends(&key.accepted(species.origin, dialect)) {
            let mut species = species.clone();
            key.set(&mut species, &end).unwrap();
            check(&species, &format!("{dialect:?}: {} = {end}", key.name()));
        }
    }
}

fn in_dialect(species: &Species, dialect: Dialect) -> Species {
    Species { dialect: Some(dialect), ..species.clone() }
}

#[test]
fn the_ends_of_every_range_grow_something_finite() {
    let forked = [("level.0.seg_splits", 0.4), ("level.0.split_angle", 20.0)];
    let deep = [("levels", 4.0), ("level.3.branches", 2.0), ("trunk.base_splits", 1.0)];
    for species in [sapling(), with(&with(&sapling(), &forked), &deep)] {
        for dialect in [Dialect::Paper, Dialect::Arbaro, Dialect::TreeGen] {
            check_all(&in_dialect(&species, dialect));
        }
    }
}

#[test]
fn the_ends_of_every_range_grow_something_finite_on_a_tree_of_another_kind() {
    for name in ["palm", "wheat"] {
        check_all(&with(&built_in(name), &[("level.0.branches", 2.0), ("level.1.branches", 5.0)]));
    }
    check_all(&with(&built_in("apple"), &[("level.1.branches", 5.0), ("level.2.branches", 4.0)]));
}
