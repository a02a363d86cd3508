//! How far trees reach, foreseen from their parameters: every tree of a species lies inside, and
//! not too deep inside.

use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::geom::{Aabb, Bound};
use sapwood::graph::{DrawList, Inside, Order};
use sapwood::rules::weber_penn::{
    Crown, LeafParams, Level, RootParams, Seed, Species, TrunkForm, foreseen,
};
use sapwood::scene::Scene;

use super::species::all;
use super::trees::*;

/// What is foreseen of a species, y up like the tree; `share` of the leaves are drawn.
pub(super) fn foreseen_of(species: &Species, share: f32) -> Option<Bound> {
    let (crown, levels) = (Crown::new(species), Level::all(species));
    let leaves = LeafParams::new(species).thinned(share);
    let (form, roots) = (TrunkForm::new(species), RootParams::new(species));
    let bound = foreseen(&crown, levels.each_ref(), &form, &leaves, &roots)?;
    let upright = Affine3::from_cols(Vec3::X, Vec3::NEG_Z, Vec3::Y, Vec3::ZERO);
    Some(bound.transformed(&upright))
}

/// A point that is drawn and does not lie in both the box and the sphere.
pub(super) fn outside(list: &DrawList, bound: &Bound) -> Option<Vec3> {
    let slack = 1e-4 * (1.0 + bound.sphere.radius);
    let Aabb { min, max } = bound.aabb;
    let is_outside = |point: &Vec3| {
        point.cmplt(min - slack).any()
            || point.cmpgt(max + slack).any()
            || point.distance(bound.sphere.center) > bound.sphere.radius + slack
    };
    points(list).find(is_outside)
}

fn points(list: &DrawList) -> impl Iterator<Item = Vec3> + '_ {
    list.placed_rows().flat_map(|(world, row)| {
        let transforms = match &row.instances {
            Some(instances) => instances.iter().map(|instance| world * *instance).collect(),
            None => vec![world],
        };
        let at_each =
            move |at: Affine3| row.mesh.positions.iter().map(move |p| at.transform_point3(*p));
        transforms.into_iter().flat_map(at_each)
    })
}

/// Grows trees with 20 seeds, and tells how many times the foreseen sphere is as wide as those
/// about some of them: at the least and at the most.
fn ratios(species: &Species, name: &str) -> [f32; 2] {
    let foreseen = foreseen_of(species, 1.0).unwrap();
    let mut tree = planted_in(Scene::new(), species, 0);
    let [mut least, mut most] = [f32::INFINITY, 0.0f32];
    for seed in 0..20 {
        tree.scene.edit(tree.tree, |tree| tree.seed = Seed::Explicit(seed)).unwrap();
        let Aabb { min, max } = tree.scene.bounds(tree.view).unwrap().aabb;
        let (all, center) = (foreseen.aabb, 0.5 * (min + max));
        assert!(all.contains(min) && all.contains(max), "{name} {seed}: not in {foreseen:?}");
        if seed % 5 == 0 {
            // The scene's sphere is wider than need be.
            let list = tree.draw_list();
            assert_eq!(outside(&list, &foreseen), None, "{name} {seed}: not in {foreseen:?}");
            let radius = points(&list).map(|point| point.distance(center)).fold(0.0, f32::max);
            let ratio = foreseen.sphere.radius / radius;
            (least, most) = (least.min(ratio), most.max(ratio));
        }
    }
    let report = tree.scene.verify(tree.view, 10).unwrap();
    let faults = report.findings.iter().filter(|finding| finding.message.contains("foreseen"));
    assert_eq!(faults.count(), 0, "{name}: {report:?}");
    println!("{name:24} {least:5.2} {most:5.2}");
    [least, most]
}

#[test]
fn every_species_lies_inside_what_is_foreseen() {
    for (name, species) in all() {
        // Sizes that vary much make trees much smaller than what is foreseen of all of them, and
        // so do envelopes, of which the bound knows nothing.
        let [least, _] = ratios(&species, name);
        let widest = if species.pruning.ratio > 0.0 { 3.0 } else { 2.5 };
        assert!(least < widest, "{name}: {least} times as wide");
    }
    let Some(folder) = std::env::var_os("SAPWOOD_ARBARO_DIR").filter(|name| !name.is_empty())
    else {
        return;
    };
    let paths = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    for path in paths.filter(|path| path.extension().is_some_and(|end| end == "xml")) {
        ratios(&sapwood::io::read_species(&path).unwrap(), &path.display().to_string());
    }
}

#[test]
fn a_tree_is_not_compiled_for_who_looks_past_it() {
    let mut tree = planted(&built_in("quaking_aspen"), 1);
    let beside = Vec3::new(30.0, 5.0, 0.0);
    let far = Inside(Aabb { min: beside, max: beside + 1.0 });
    tree.scene.traverse(tree.view, Order::Pre, &far, &mut |_| ()).unwrap();
    let log = tree.scene.take_log();
    assert!(log.iter().all(|event| event.kind.name() != "branch"), "{log:?}");
    let near = Inside(Aabb { min: Vec3::ZERO, max: Vec3::ONE });
    tree.scene.traverse(tree.view, Order::Pre, &near, &mut |_| ()).unwrap();
    let log = tree.scene.take_log();
    assert!(log.iter().any(|event| event.kind.name() == "branch"), "{log:?}");
}

#[test]
fn several_trunks_lie_inside_what_is_foreseen() {
    let many = [("level.0.branches", 5.0), ("level.0.branch_dist", 4.0), ("level.0.length_v", 0.5)];
    for name in ["palm", "quaking_aspen", "bamboo"] {
        ratios(&with(&built_in(name), &many), name);
    }
}

#[test]
fn trees_of_tree_gen_lie_inside_what_is_foreseen_however_they_split_and_are_pulled() {
    let bent = [
        ("level.0.curve", 120.0),
        ("level.0.curve_back", -150.0),
        ("level.0.split_angle", 30.0),
        ("level.0.seg_splits", 1.0),
        ("level.1.seg_splits", 0.5),
        ("level.2.branches", 5.0),
    ];
    let in_plane = [("level.0.split_angle", -60.0), ("level.0.split_angle_v", 20.0)];
    // Stems that would be thinner than they may be.
    let thin = [("ratio_power", 4.0), ("scale", 0.2), ("scale_v", 0.1)];
    for name in ["japanese_maple", "apple", "bamboo"] {
        let mut species = with(&built_in(name), &bent);
        for change in [&[][..], &in_plane, &thin] {
            species = with(&species, change);
            let ext = species.ext.as_mut().unwrap();
            (ext.tropism, ext.branch_dist) = (Some([1.0, -0.5, 1.0]), Some([0.0, 3.0, 1.0, 0.5]));
            ratios(&species, name);
        }
    }
}
