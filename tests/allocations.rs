//! What must allocate nothing: a forest that sways, from one picture to the next.
//!
//! A program of its own, for it counts what its allocator is asked for.

use std::error::Error;

use sapwood::geom::glam::Vec3;
use sapwood::graph::{Eye, Levels, Poses, Wind};
use sapwood::rules::weber_penn::{Seed, Tree};
use sapwood::scene::{Action, Group, Scene, Time, Transform, ViewId, Viewer, WindSlot};

/// So many aspens of so many individuals, in a square whose front is 20 m away.
fn forest(n_trees: usize, n_individuals: u64) -> Result<(Scene, ViewId), Box<dyn Error>> {
    let mut scene = Scene::new();
    scene.set_logging(true);
    let family = scene.add(sapwood::io::find_species("quaking_aspen")?.attribute());
    let all = scene.add_to(family, Group)?;
    let trees: Vec<_> =
        (0..n_individuals).map(|seed| scene.add(Tree { seed: Seed::Explicit(seed) })).collect();
    let side = (n_trees as f32).sqrt().ceil();
    for i in 0..n_trees {
        let (row, column) = ((i as f32 / side).floor(), i as f32 % side);
        let place = Transform::translation(6.0 * (column - side / 2.0), 0.0, -20.0 - 6.0 * row);
        let place = scene.add_to(all, place)?;
        scene.append(place, trees[i % trees.len()])?;
    }
    let view = scene.open_view(family, &sapwood::swaying_rules())?;
    scene.set_moving::<Viewer>(view, Some(Eye::new(Vec3::Y * 1.7)))?;
    Ok((scene, view))
}

#[test]
fn a_thousand_aspens_sway_for_ten_seconds_and_nothing_is_compiled_or_allocated()
-> Result<(), Box<dyn Error>> {
    let (mut scene, view) = forest(1000, 16)?;
    scene.set_moving::<WindSlot>(view, Wind::new(0.5, 0.25))?;
    scene.set_moving::<Time>(view, 0.0)?;
    let list = scene.draw_list(view, 1_000_000)?;
    let mut poses = Poses::new(&list);
    let first = scene.sway(view, &mut poses)?;
    scene.take_log();

    let mut outcome = Ok(());
    let mut moved = vec![first; 600];
    let counted = allocation_counter::measure(|| {
        for (i, moved) in moved.iter_mut().enumerate() {
            let time = scene.set_moving::<Time>(view, i as f64 / 60.0);
            match time.and_then(|()| scene.sway(view, &mut poses)) {
                Ok(all) => *moved = all,
                Err(error) => outcome = Err(error),
            }
        }
    });
    outcome?;
    assert_eq!(counted.count_total, 0);
    assert!(scene.take_log().iter().all(|event| event.action != Action::Compiled));
    assert!(moved.iter().all(|all| *all == first));

    // The rows in front move as a whole, those behind them without their twigs, and all trees of an
    // individual that are in one of four phases and move alike share a pose.
    let trunks = Levels::NONE.with(0);
    let branches = trunks.with(1);
    let n_of = |levels| (0..1000).filter(|i| poses.levels(*i) == levels).count();
    let [all, some, few] = [branches.with(2), branches, trunks].map(n_of);
    println!("{first:?}: {all} with twigs, {some} with branches, {few} trunks");
    assert_eq!((all + some + few, first.n_occurrences), (1000, 1000));
    assert!(all > 0 && some > all, "{all} {some} {few}");
    let joints_of_one = list.bodies[0].rig.as_ref().map_or(0, |rig| rig.joints.len());
    assert!(first.n_joints < 2 * 4 * 16 * joints_of_one, "{first:?}");
    Ok(())
}
