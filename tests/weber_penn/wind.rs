//! Trees that sway in the wind: at rest they are the trees that never heard of it, bounds hold
//! them, and only what can be seen moves.

use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::graph::{DrawList, Eye, Levels, Moved, Poses, Wind};
use sapwood::rules::weber_penn::{Seed, Species, SwayParams, SwaySlot, Tree};
use sapwood::scene::{Action, Group, Scene, Time, Transform, ViewId, Viewer, WindSlot};

use super::trees::*;

fn swaying(species: &Species, seed: u64) -> Grown {
    let mut grown = grown(species, seed);
    grown.view = grown.scene.open_view(grown.family, &sapwood::swaying_rules()).unwrap();
    grown.scene.bounds(grown.view).unwrap();
    grown.scene.take_log();
    grown
}

fn sway(grown: &mut Grown, poses: &mut Poses, wind: Wind, time: f64) -> Moved {
    let Grown { scene, view, .. } = grown;
    scene.set_moving::<WindSlot>(*view, wind).unwrap();
    scene.set_moving::<Time>(*view, time).unwrap();
    scene.sway(*view, poses).unwrap()
}

fn look_from(grown: &mut Grown, view: ViewId, distance: f32) {
    let eye = Eye::new(Vec3::new(distance, 6.0, 0.0));
    grown.scene.set_moving::<Viewer>(view, Some(eye)).unwrap();
}

/// All places of vertices and leaves, in the root's frame.
fn places(list: &DrawList) -> Vec<Vec3> {
    let mut places = Vec::new();
    for (world, row) in list.placed_rows() {
        match &row.instances {
            Some(instances) => places.extend(instances.iter().map(|i| (world * *i).translation)),
            None => places.extend(row.mesh.positions.iter().map(|p| world.transform_point3(*p))),
        }
    }
    places
}

/// How far anything is from where it is at rest.
fn farthest(rest: &DrawList, swayed: &DrawList) -> f32 {
    let both = places(rest).into_iter().zip(places(swayed));
    both.map(|(rest, swayed)| rest.distance(swayed)).fold(0.0, f32::max)
}

#[test]
fn at_rest_every_species_is_the_tree_that_never_heard_of_wind() {
    for name in sapwood::io::built_in_names() {
        let mut tree = grown(&built_in(name), 7);
        let plain = tree.draw_list();
        let mut tree = swaying(&built_in(name), 7);
        let list = tree.draw_list();
        assert_eq!(digest(&list), digest(&plain), "{name}");
        let rows = &list.bodies[0].rows;
        assert!(rows.iter().all(|row| row.follows.is_some() && row.range.is_none()), "{name}");
        let rig = list.bodies[0].rig.as_ref().unwrap();
        assert_eq!(rig.fault(), None, "{name}");
        assert!(plain.bodies.iter().all(|body| body.rig.is_none()), "{name}");

        let mut poses = Poses::new(&list);
        assert_eq!(sway(&mut tree, &mut poses, Wind::default(), 3.0), Moved::default(), "{name}");
        assert_eq!(digest(&poses.posed(&list)), digest(&plain), "{name}");
        sway(&mut tree, &mut poses, Wind::new(4.0, 2.0), 3.0);
        assert!(farthest(&list, &poses.posed(&list)) > 1e-3, "{name}");
        let report = tree.scene.verify(tree.view, 10).unwrap();
        assert_eq!(report.findings, [], "{name}");
    }
}

#[test]
fn bounds_hold_the_swaying_tree_in_any_wind() {
    for name in ["quaking_aspen", "weeping_willow", "palm", "wheat", "black_tupelo"] {
        let mut tree = swaying(&with(&built_in(name), &[("leaves.quality", 0.1)]), 3);
        let bound = tree.scene.bounds(tree.view).unwrap().aabb;
        let list = tree.draw_list();
        let mut poses = Poses::new(&list);
        for (wind, time) in [(5.0, 1.0), (20.0, 2.5), (100.0, 77.7), (100.0, 1e7)] {
            sway(&mut tree, &mut poses, Wind::new(wind, wind), time);
            assert_eq!(fault(&poses.posed(&list), &bound), None, "{name} {wind} {time}");
        }
    }
}

#[test]
fn what_hangs_together_stays_together() {
    let mut tree = swaying(&built_in("quaking_aspen"), 1);
    let list = tree.draw_list();
    let mut poses = Poses::new(&list);
    sway(&mut tree, &mut poses, Wind::new(10.0, 0.0), 2.0);
    let swayed = poses.posed(&list);
    assert!(farthest(&list, &swayed) > 0.5);
    let mut longest = 0.0f32;
    for ((_, rest), (_, swayed)) in list.placed_rows().zip(swayed.placed_rows()) {
        if rest.instances.is_some() {
            continue;
        }
        for side in rest.mesh.indices.chunks_exact(3).flat_map(|t| [[t[0], t[1]], [t[1], t[2]]]) {
            let length = |positions: &[Vec3]| {
                positions[side[0] as usize].distance(positions[side[1] as usize])
            };
            let (before, after) = (length(&rest.mesh.positions), length(&swayed.mesh.positions));
            // A ring does not lean with the one before it: by as much as it is wide, times the
            // turn.
            longest = longest.max(after - before);
        }
    }
    assert!(longest < 0.08, "{longest}");
    // Leaves are moved, not bent.
    for ((_, rest), (_, swayed)) in list.placed_rows().zip(swayed.placed_rows()) {
        let (Some(rest), Some(swayed)) = (&rest.instances, &swayed.instances) else { continue };
        for (rest, swayed) in rest.iter().zip(swayed.iter()) {
            let size = |place: &Affine3| place.matrix3.determinant();
            assert!((size(rest) - size(swayed)).abs() < 1e-4 * size(rest).abs());
        }
    }
}

#[test]
fn leaves_stay_at_their_stems() {
    let mut tree = swaying(&sapling(), 2);
    let list = tree.draw_list();
    let mut poses = Poses::new(&list);
    sway(&mut tree, &mut poses, Wind::new(10.0, 5.0), 4.0);
    let swayed = poses.posed(&list);
    let wood = |list: &DrawList| -> Vec<Vec3> {
        let rows = list.placed_rows().filter(|(_, row)| row.instances.is_none());
        rows.flat_map(|(world, row)| {
            row.mesh.positions.iter().map(move |p| world.transform_point3(*p)).collect::<Vec<_>>()
        })
        .collect()
    };
    let leaves = |list: &DrawList| -> Vec<Vec3> {
        let rows =
            list.placed_rows().filter_map(|(world, row)| Some((world, row.instances.clone()?)));
        rows.flat_map(|(world, places)| {
            places.iter().map(|place| (world * *place).translation).collect::<Vec<_>>()
        })
        .collect()
    };
    let (rest_wood, moved_wood) = (wood(&list), wood(&swayed));
    let mut moved_most = 0.0f32;
    for (rest, moved) in leaves(&list).into_iter().zip(leaves(&swayed)).step_by(3) {
        // The vertex that is nearest at rest is about as near when both have moved.
        let near = rest_wood.iter().enumerate();
        let (nearest, _) =
            near.min_by(|(_, a), (_, b)| a.distance(rest).total_cmp(&b.distance(rest))).unwrap();
        let (before, after) =
            (rest_wood[nearest].distance(rest), moved_wood[nearest].distance(moved));
        assert!((before - after).abs() < 0.03 + 0.2 * before, "{rest}: {before} {after}");
        moved_most = moved_most.max(rest.distance(moved));
    }
    assert!(moved_most > 0.5, "{moved_most}");
}

#[test]
fn only_levels_whose_sway_is_seen_move_and_nothing_is_compiled() {
    let mut tree = swaying(&built_in("quaking_aspen"), 1);
    let view = tree.view;
    let list = tree.draw_list();
    let mut poses = Poses::new(&list);
    let mut n_levels = Vec::new();
    for distance in [10.0, 50.0, 200.0, 500.0, 2e3, 1e4, 1e6] {
        look_from(&mut tree, view, distance);
        let moved = sway(&mut tree, &mut poses, Wind::new(1.0, 0.5), 3.0);
        let levels = poses.levels(0);
        assert_eq!((moved.levels, moved.n_occurrences), (levels, usize::from(!levels.is_empty())));
        n_levels.push((0..3).filter(|level| levels.contains(*level)).count());
        // What stands still would have moved by less than half a pixel.
        let left = poses.posed(&list);
        let mut all = Poses::new(&list);
        all.update(Wind::new(1.0, 0.5), 3.0, None);
        let off = farthest(&left, &all.posed(&list));
        let pixel = distance * (1.0 / Eye::REFERENCE_ROWS).to_radians();
        assert!(off < 0.5 * pixel * 3.0, "{distance} m: {off}, {pixel}");
    }
    assert_eq!((n_levels[0], n_levels[6]), (3, 0), "{n_levels:?}");
    assert!(n_levels.windows(2).all(|n| n[0] >= n[1]), "{n_levels:?}");
    assert!(tree.scene.take_log().iter().all(|event| event.action != Action::Compiled));
}

#[test]
fn individuals_share_a_pose_and_others_have_their_own() {
    let mut scene = checked_scene();
    let family = scene.add(sapling().attribute());
    let all = scene.add_to(family, Group).unwrap();
    let [one, other] = [1, 2].map(|seed| scene.add(Tree { seed: Seed::Explicit(seed) }));
    for (x, tree) in [(0.0, one), (30.0, other), (60.0, one), (800.0, one)] {
        let place = scene.add_to(all, Transform::translation(x, 0.0, 0.0)).unwrap();
        scene.append(place, tree).unwrap();
    }
    let view = scene.open_view(family, &sapwood::swaying_rules()).unwrap();
    scene.set_moving::<WindSlot>(view, Wind::new(3.0, 0.0)).unwrap();
    scene.set_moving::<Viewer>(view, Some(Eye::new(Vec3::X * 30.0))).unwrap();
    let list = scene.draw_list(view, 1000).unwrap();
    assert_eq!((list.bodies.len(), list.occurrences.len()), (2, 4));
    let mut poses = Poses::new(&list).in_phases(1);
    let moved = scene.sway(view, &mut poses).unwrap();
    let [near, other, again, far] = [0, 1, 2, 3].map(|i| poses.of(i).unwrap());
    assert_eq!(near.as_ptr(), again.as_ptr());
    assert_ne!(near, other);
    // From afar fewer levels of it move.
    assert!(poses.levels(0).contains(2) && !poses.levels(3).contains(2));
    assert_eq!((far.len(), moved.n_occurrences), (near.len(), 4));
    let posed = poses.posed(&list);
    let bodies: Vec<u32> = posed.occurrences.iter().map(|occurrence| occurrence.body).collect();
    assert_eq!((bodies, posed.bodies.len()), (vec![0, 1, 0, 2], 3));
}

/// Equal trees in rows, so far from each other along x and along z.
fn rows_of_equal_trees(step: (f32, f32)) -> DrawList {
    let mut scene = Scene::new();
    let family = scene.add(sapling().attribute());
    let all = scene.add_to(family, Group).unwrap();
    let tree = scene.add(Tree { seed: Seed::Explicit(1) });
    for i in 0..SIDE * SIDE {
        let (x, z) = ((i % SIDE) as f32, (i / SIDE) as f32);
        let place = Transform::translation(step.0 * x, 0.0, step.1 * z);
        let place = scene.add_to(all, place).unwrap();
        scene.append(place, tree).unwrap();
    }
    let view = scene.open_view(family, &sapwood::swaying_rules()).unwrap();
    scene.draw_list(view, 10_000).unwrap()
}

const SIDE: usize = 10;

#[test]
fn equal_trees_side_by_side_are_mostly_in_different_phases() {
    let wind = Wind::new(3.0, 0.0);
    for step in [(1.0, 1.0), (4.0, 4.0), (6.0, 6.0), (4.0, 7.0), (8.0, 12.5)] {
        let list = rows_of_equal_trees(step);
        let mut poses = Poses::new(&list);
        let moved = poses.update(wind, 5.0, None);
        // The first stands at the origin, where the rig says itself what is when.
        let rig = list.bodies[0].rig.as_ref().unwrap();
        let mut alone = Vec::new();
        rig.pose(wind, 5.0, Levels::ALL, &mut alone);
        assert_eq!(poses.of(0).unwrap(), alone);
        let phase = |i: usize| poses.of(i).unwrap().as_ptr();
        let is_first = |i: &usize| i % SIDE < SIDE - 1;
        let beside = (0..SIDE * SIDE).filter(is_first).map(|i| (i, i + 1));
        let behind = (SIDE..SIDE * SIDE).map(|i| (i - SIDE, i));
        // Of 90 pairs a quarter, more or less.
        for pairs in [beside.collect::<Vec<_>>(), behind.collect()] {
            let n_alike = pairs.iter().filter(|(a, b)| phase(*a) == phase(*b)).count();
            assert!((8..=38).contains(&n_alike), "{step:?}: {n_alike} of {}", pairs.len());
        }
        let mut phases: Vec<_> = (0..SIDE * SIDE).map(phase).collect();
        phases.sort_unstable();
        phases.dedup();
        assert_eq!((phases.len(), poses.posed(&list).bodies.len()), (4, 4));
        let mut one = Poses::new(&list).in_phases(0);
        assert_eq!(one.update(wind, 5.0, None).n_joints * 4, moved.n_joints);
        assert_eq!(one.posed(&list).bodies.len(), 1);
    }
}

#[test]
fn how_trees_sway_is_a_slot_that_compiles_no_geometry_of_trees_at_rest() {
    let mut tree = swaying(&sapling(), 1);
    let slow = SwayParams { time_scale: 1.0, ..SwayParams::default() };
    tree.scene.edit(tree.family, |family| family.set::<SwaySlot>(slow)).unwrap();
    let list = tree.draw_list();
    let mut poses = Poses::new(&list);
    sway(&mut tree, &mut poses, Wind::new(5.0, 0.0), 0.0);
    let start = poses.of(0).unwrap().to_vec();
    sway(&mut tree, &mut poses, Wind::new(5.0, 0.0), 1.0);
    let turned = poses.of(0).unwrap().iter().zip(&start);
    assert!(turned.map(|(a, b)| a.translation.distance(b.translation)).fold(0.0, f32::max) < 0.05);

    let mut plain = grown(&sapling(), 1);
    plain.scene.edit(plain.family, |family| family.set::<SwaySlot>(slow)).unwrap();
    assert!(plain.compiled().iter().all(|(kind, _)| *kind == "attribute"));
}
