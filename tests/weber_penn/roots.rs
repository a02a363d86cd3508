//! Roots: stems from the trunk's foot, which nothing else knows of where there are none.

use sapwood::geom::glam::Vec3;
use sapwood::geom::{Aabb, Envelope, Solid, Sphere};
use sapwood::graph::{Everything, Order, Prune, WeldUnion};
use sapwood::rules::weber_penn::{RootsSlot, Species, Stem, keys, prune_handlers};
use sapwood::scene::{EnvelopeSlot, Scene};

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

#[test]
fn roots_that_coil_stay_within_what_was_foreseen() {
    for curve_v in [-10.0, -45.0, -85.0] {
        let mut species = with(&rooted(), &[("roots.length", 0.9), ("roots.seg_splits", 0.0)]);
        species.roots.curve_v = curve_v;
        assert_eq!(species.faults(), []);
        for seed in 0..4 {
            let mut tree = planted(&species, seed);
            let bound = tree.scene.bounds(tree.view).unwrap().aabb;
            assert_eq!(fault(&tree.draw_list(), &bound), None, "{curve_v} {seed}");
            assert!(roots(&mut tree).iter().all(|stem| stem.helix_radius > 0.0));
            // Verifying compares everything with what was foreseen of it.
            assert_eq!(tree.scene.verify(tree.view, 10).unwrap().findings, [], "{curve_v} {seed}");
        }
    }
    // A program may say so past the keys of files.
    let mut tree = grown(&rooted(), 1);
    let mut params = sapwood::rules::weber_penn::RootParams::new(&rooted());
    params.level.curve_v = -1.5;
    tree.scene.push::<RootsSlot>(tree.family, params).unwrap();
    assert_eq!(tree.scene.verify(tree.view, 10).unwrap().findings, []);
}

/// The lowest and the furthest point of the roots, and how many there are.
fn extent(tree: &mut Grown) -> (f32, f32, usize) {
    let found = roots(tree);
    let segments = tree.parts().segments.swap_remove(1);
    let (mut lowest, mut furthest) = (0.0f32, 0.0f32);
    for (world, segment) in segments {
        let end = world.transform_point3(segment.end());
        if end.y < 0.2 {
            (lowest, furthest) = (lowest.min(end.y), furthest.max(end.with_y(0.0).length()));
        }
    }
    (lowest, furthest, found.len())
}

#[test]
fn roots_stay_within_an_envelope_that_holds_the_foot() {
    let species = with(&rooted(), &[("roots.seg_splits", 0.0), ("roots.curve_v", 20.0)]);
    let mut tree = grown(&species, 4);
    let whole = extent(&mut tree);
    assert!(whole.1 > 1.0 && whole.2 == 5, "{whole:?}");
    let hold = |tree: &mut Grown, envelope: Option<Envelope>| {
        let set = |a: &mut sapwood::scene::Attribute| a.set::<EnvelopeSlot>(envelope.clone());
        tree.scene.edit(tree.family, set).unwrap();
    };
    // A pot, open above.
    let pot = Aabb { min: Vec3::new(-0.6, -0.5, -0.6), max: Vec3::new(0.6, 40.0, 0.6) };
    let around = Aabb { min: Vec3::new(-40.0, 0.3, -40.0), max: Vec3::new(40.0, 40.0, 40.0) };
    let potted = Envelope::union(vec![Envelope::aabb(pot), Envelope::aabb(around)]);
    hold(&mut tree, Some(potted));
    let held = extent(&mut tree);
    let reach = 0.6 * std::f32::consts::SQRT_2;
    assert!(held.0 >= -0.5 && held.1 <= reach && held.2 == 5, "{held:?} {whole:?}");
    let bound = tree.scene.bounds(tree.view).unwrap().aabb;
    assert_eq!(fault(&tree.draw_list(), &bound), None);
    tree.scene.take_log();
    // Roots that an envelope does not reach are left alone, as trunks are that stand outside of it.
    let crown = Envelope::sphere(Sphere { center: 20.5 * Vec3::Y, radius: 20.0 });
    hold(&mut tree, Some(crown));
    assert_eq!(extent(&mut tree), whole);
    // One that all lies inside of has nothing to say.
    hold(&mut tree, None);
    let free = digest(&tree.draw_list());
    hold(&mut tree, Some(Envelope::sphere(Sphere { center: Vec3::ZERO, radius: 200.0 })));
    assert_eq!(digest(&tree.draw_list()), free);
}

#[test]
fn roots_are_cut_as_other_stems_are() {
    let mut tree = grown(&rooted(), 4);
    let lowest = |list: &sapwood::graph::DrawList| {
        let wood = list.placed_rows().filter(|(_, row)| row.instances.is_none());
        let points = wood.flat_map(|(world, row)| {
            row.mesh.positions.iter().map(|p| world.transform_point3(*p).y).collect::<Vec<_>>()
        });
        points.fold(f32::MAX, f32::min)
    };
    let whole = lowest(&tree.draw_list());
    let prune = Prune::to(Envelope::half_space(Vec3::NEG_Y, 0.1));
    let cut = tree.scene.prune(tree.view, &prune, &prune_handlers(), 1_000_000).unwrap();
    // They end where their middle leaves.
    let depth = lowest(&cut);
    assert!((-0.2..=-0.09).contains(&depth) && whole < -0.3, "{depth} {whole}");
}

#[test]
fn the_outline_tells_of_roots() {
    let outline = |species: &Species| {
        let mut tree = planted(species, 4);
        let text = tree.scene.open_view(tree.family, &sapwood::text_rules()).unwrap();
        tree.scene.outline(text, 100).unwrap()
    };
    let (plain, told) =
        (outline(&sapling()), outline(&with(&rooted(), &[("roots.seg_splits", 0.0)])));
    assert!(!plain.contains("root"), "{plain}");
    let line = told.lines().find(|line| line.contains("roots")).unwrap().trim().to_owned();
    assert!(line.starts_with("5 roots, ") && line.contains(" together, down to "), "{line}");
    // Everything else is told as of the tree without roots.
    let rest: Vec<_> = told.lines().filter(|line| !line.contains("roots")).collect();
    assert_eq!(rest, plain.lines().collect::<Vec<_>>());
}
