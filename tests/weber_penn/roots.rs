//! Roots: stems from the trunk's foot, which nothing else knows of where there are none.

use sapwood::geom::Solid;
use sapwood::geom::glam::Vec3;
use sapwood::graph::{Everything, Order, WeldUnion};
use sapwood::rules::weber_penn::{Species, Stem, keys};
use sapwood::scene::Scene;

use super::trees::*;

fn rooted() -> Species {
    with(&sapling(), &[("roots.count", 5.0), ("roots.length", 0.25), ("roots.seg_splits", 0.3)])
}

/// The stems of roots: those that grow on a trunk and lie below what is above ground.
fn roots(tree: &mut Grown) -> Vec<Stem> {
    let mut stems = tree.parts().stems.swap_remove(1);
    stems.retain(|stem| stem.seed.offset < 0.1);
    stems
}

#[test]
fn a_tree_has_the_roots_that_its_species_asks_for() {
    let (mut plain, mut tree) = (grown(&sapling(), 4), grown(&rooted(), 4));
    assert!(roots(&mut plain).is_empty());
    let found = roots(&mut tree);
    let own = found.iter().filter(|stem| stem.clone_of.is_none());
    assert_eq!((own.count(), found.len() > 5), (5, true), "five, and some split");
    let trunk = tree.parts().stems[0][0].seed;
    for stem in &found {
        let share = stem.seed.length / trunk.length;
        assert!((0.15..=0.35).contains(&share), "{share}");
        assert!((stem.seed.radius - 0.45 * trunk.radius).abs() < 1e-5);
    }
    // The rest of the tree is what it was.
    let digests = |tree: &mut Grown| {
        let parts = tree.parts();
        let above = parts.stems[1].iter().filter(|stem| stem.seed.offset >= 0.1);
        let above: Vec<Vec3> = above.map(|stem| stem.seed.frame.origin).collect();
        (above, parts.leaves.len(), parts.stems[2].len())
    };
    assert_eq!(digests(&mut tree), digests(&mut plain));
    let bound = tree.scene.bounds(tree.view).unwrap().aabb;
    assert!(bound.min.y < -0.2, "they lead down: {}", bound.min.y);
    assert_eq!(fault(&tree.draw_list(), &bound), None);
    assert_eq!(tree.scene.verify(tree.view, 10).unwrap().findings, []);
}

#[test]
fn an_edit_of_roots_grows_nothing_else() {
    let mut tree = grown(&rooted(), 4);
    tree.set(&with(&rooted(), &[("roots.curve", -20.0)]));
    assert_eq!(tree.compiled(), [("attribute", 1), ("roots", 1), ("stem_surface", 1)]);
}

#[test]
fn every_key_of_the_roots_acts() {
    let base = with(&rooted(), &[("roots.split_angle_v", 5.0)]);
    let drawn = |species: &Species| digest(&grown(species, 4).draw_list());
    let before = drawn(&base);
    for key in keys().iter().map(|key| key.name()).filter(|name| name.starts_with("roots.")) {
        let value = match key {
            "roots.count" | "roots.curve_res" => 3.0,
            "roots.taper" | "roots.seg_splits" => 0.6,
            "roots.length" | "roots.radius" => 0.2,
            "roots.length_v" => 0.02,
            "roots.split_angle" => 150.0,
            _ => 12.0,
        };
        assert_ne!(drawn(&with(&base, &[(key, value)])), before, "{key}");
    }
}

#[test]
fn roots_sway_with_nobody_and_are_one_solid_with_the_trunk() {
    let species = with(&rooted(), &[("roots.seg_splits", 0.0)]);
    let mut tree = grown(&species, 4);
    let rest = digest(&tree.draw_list());
    let view = tree.scene.open_view(tree.family, &sapwood::swaying_rules()).unwrap();
    assert_eq!(digest(&tree.scene.draw_list(view, 1_000_000).unwrap()), rest);

    let mut tree = planted_in(Scene::new(), &species, 4);
    let mut weld = WeldUnion::new();
    let Grown { scene, view, .. } = &mut tree;
    scene.traverse(*view, Order::Pre, &Everything, &mut |at| weld.meet(at)).unwrap();
    let list = scene.draw_list(*view, usize::MAX).unwrap();
    let welded = weld.join(&list, 10_000_000, &|_| true).unwrap();
    let found = welded.union.solid.check();
    assert!(found.is_sound() && found.components == 1, "{found}");
    let lowest = |solid: &Solid| solid.positions.iter().map(|p| p.y).fold(f32::MAX, f32::min);
    assert!(lowest(&welded.union.solid) < -0.2);
}
