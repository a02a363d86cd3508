//! Levels of detail: which is shown, what is compiled for it, and where it flips.

use sapwood::geom::glam::Vec3;
use sapwood::scene::{Group, Handle, LevelOfDetail, NodeId, Scene, ViewId, Viewpoint};

use super::super::kinds::*;
use super::{errors, sizes};

/// Levels of sizes 1, 2 and 3.
fn levels(scene: &mut Scene, distances: [f32; 2], hysteresis: f32) -> Handle<LevelOfDetail> {
    let levels = LevelOfDetail { hysteresis, ..LevelOfDetail::new(distances) };
    let levels = scene.add(levels);
    for size in [1.0, 2.0, 3.0] {
        scene.add_to(levels, Plain { size }).unwrap();
    }
    levels
}

fn look_from(scene: &mut Scene, view: ViewId, x: f32) {
    scene.set_held::<Viewpoint>(view, Some(Vec3::X * x)).unwrap();
}

#[test]
fn only_the_level_shown_is_compiled_and_the_others_stay() {
    let mut scene = checked_scene();
    let levels = levels(&mut scene, [10.0, 20.0], 0.0);
    let view = scene.open_view(levels, &rules()).unwrap();
    let check =
        |scene: &mut Scene, x: Option<f32>, shown: &[f32], ran: &[(&'static str, usize)]| {
            scene.set_held::<Viewpoint>(view, x.map(|x| Vec3::X * x)).unwrap();
            assert_eq!(sizes(scene, view), shown, "from {x:?}");
            assert_eq!(all_compiled(scene), ran, "from {x:?}");
        };
    let (whole, one) = (("level_of_detail", 1), ("plain", 1));
    check(&mut scene, None, &[1.0], &[whole, one]);
    check(&mut scene, Some(9.9), &[1.0], &[whole]);
    check(&mut scene, Some(-9.0), &[1.0], &[]);
    check(&mut scene, Some(10.0), &[2.0], &[whole, one]);
    check(&mut scene, Some(20.0), &[3.0], &[whole, one]);
    check(&mut scene, Some(15.0), &[2.0], &[]);
    check(&mut scene, Some(1e30), &[3.0], &[]);
    check(&mut scene, Some(0.0), &[1.0], &[]);
    check(&mut scene, Some(f32::NAN), &[1.0], &[]);
    let last = scene.children(levels).nth(2).unwrap();
    scene.remove(last).unwrap();
    check(&mut scene, Some(30.0), &[], &[whole]);
}

#[test]
fn faulty_levels_are_errors_of_their_own() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let levels = levels(&mut scene, [10.0, 20.0], 0.0);
    scene.append(root, levels).unwrap();
    scene.add_to(root, Plain { size: 9.0 }).unwrap();
    let view = scene.open_view(root, &rules()).unwrap();
    let mut check = |change: fn(&mut LevelOfDetail), is_faulty: bool| {
        let sound = LevelOfDetail::new([10.0, 20.0]);
        scene.edit(levels, |levels| *levels = sound).unwrap();
        scene.edit(levels, change).unwrap();
        let shown: &[f32] = if is_faulty { &[9.0] } else { &[1.0, 9.0] };
        assert_eq!(sizes(&mut scene, view), shown);
        let errors = errors(&mut scene, view);
        assert_eq!(errors.len(), usize::from(is_faulty));
        assert!(errors.iter().all(|(kind, _)| *kind == "level_of_detail"), "{errors:?}");
    };
    check(|_| {}, false);
    check(|levels| levels.distances.swap(0, 1), true);
    check(|levels| levels.distances[0] = f32::NAN, true);
    check(|levels| levels.distances[0] = -1.0, true);
    check(|levels| levels.distances[1] = f32::INFINITY, false);
    check(|levels| levels.hysteresis = f32::NAN, true);
    check(|levels| levels.hysteresis = 1.0, true);
    check(|levels| levels.hysteresis = -0.1, true);
    check(|levels| levels.hysteresis = 0.9, false);
    check(|levels| levels.center.y = f32::NAN, true);
    check(|levels| levels.distances.clear(), false);
}

/// What is shown by levels with hysteresis that were at `shown` before, from this far.
fn flipped(shown: f32, distance: f32) -> f32 {
    let begin = [0.0, 9.0, 18.0][shown as usize - 1];
    let end = [11.0, 22.0, f32::INFINITY][shown as usize - 1];
    if begin <= distance && distance < end {
        return shown;
    }
    1.0 + [10.0, 20.0].iter().filter(|end| **end <= distance).count() as f32
}

/// The places of a walk forth and back over both thresholds.
fn walk() -> impl Iterator<Item = f32> {
    let forth = (0..120).map(|step| step as f32 * 0.25);
    forth.clone().chain(forth.rev()).chain([10.5, 8.0, 10.5, 30.0, 19.0, 17.0, 19.0, 19.0])
}

#[test]
fn levels_with_hysteresis_flip_at_the_right_places() {
    let mut scene = checked_scene();
    let levels = levels(&mut scene, [10.0, 20.0], 0.1);
    let view = scene.open_view(levels, &rules()).unwrap();
    let mut shown = 1.0;
    let mut n_flips = 0;
    for x in walk() {
        look_from(&mut scene, view, x);
        let before = shown;
        shown = flipped(shown, x);
        n_flips += usize::from(before != shown);
        assert_eq!(sizes(&mut scene, view), [shown], "from {x} m, after {before}");
    }
    assert_eq!(n_flips, 6);
    // Without memory the band is that of the distance alone.
    for x in [8.0, 10.5] {
        look_from(&mut scene, view, x);
        assert_eq!(sizes(&mut scene, view), [1.0]);
    }
    let fresh = scene.open_view(levels, &rules()).unwrap();
    look_from(&mut scene, fresh, 10.5);
    assert_eq!(sizes(&mut scene, fresh), [2.0]);
    assert_eq!(sizes(&mut scene, view), [1.0]);
}

#[test]
fn levels_below_two_parents_remember_for_each_of_them() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    // The levels stand in a group, so that there is something between them and their places.
    let shared = scene.add(Group);
    let levels = levels(&mut scene, [10.0, 20.0], 0.1);
    scene.append(shared, levels).unwrap();
    for x in [0, 7] {
        let moved = scene.add_to(root, at(x)).unwrap();
        scene.append(moved, shared).unwrap();
    }
    let view = scene.open_view(root, &rules()).unwrap();
    let mut shown = [1.0, 1.0];
    for (step, x) in walk().chain(walk()).enumerate() {
        look_from(&mut scene, view, x);
        shown = [flipped(shown[0], x), flipped(shown[1], (x - 7.0).abs())];
        assert_eq!(sizes(&mut scene, view), shown, "step {step} from {x} m");
        if step % 17 == 0 {
            scene.evict();
        }
    }
}

#[test]
fn levels_remember_when_other_things_are_edited() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let moved = scene.add_to(root, at(0)).unwrap();
    let levels = levels(&mut scene, [10.0, 20.0], 0.1);
    scene.append(moved, levels).unwrap();
    let view = scene.open_view(root, &rules()).unwrap();
    look_from(&mut scene, view, 5.0);
    assert_eq!(sizes(&mut scene, view), [1.0]);
    look_from(&mut scene, view, 10.5);
    assert_eq!(sizes(&mut scene, view), [1.0]);
    scene.edit(moved, |moved| moved.0.translation.y = 0.5).unwrap();
    assert_eq!(sizes(&mut scene, view), [1.0]);
    scene.add_to(root, Group).unwrap();
    assert_eq!(sizes(&mut scene, view), [1.0]);
    // Another component is another memory's affair: its parameters are new.
    scene.edit(moved, |moved| moved.0.translation.y = 9.0).unwrap();
    assert_eq!(sizes(&mut scene, view), [2.0]);
    scene.edit(moved, |moved| moved.0.translation.y = 0.0).unwrap();
    assert_eq!(sizes(&mut scene, view), [2.0]);
    let edited = scene.edit(levels, |levels| levels.distances = vec![12.0, 20.0]);
    edited.unwrap();
    assert_eq!(sizes(&mut scene, view), [1.0]);
}

#[test]
fn a_diamond_of_levels_forty_deep_costs_what_forty_levels_cost() {
    let mut scene = Scene::new();
    let mut below: NodeId = levels(&mut scene, [10.0, 20.0], 0.1).id();
    for _ in 0..40 {
        let above = scene.add(LevelOfDetail::new([100.0]));
        let group = scene.add_to(above, Group).unwrap();
        scene.append(group, below).unwrap();
        scene.append(group, below).unwrap();
        below = above.id();
    }
    let view = scene.open_view(below, &rules()).unwrap();
    for x in [5.0, 10.5, 15.0, 10.5] {
        look_from(&mut scene, view, x);
        let counts = scene.count(view).unwrap();
        assert_eq!(counts.components_of("plain"), 1 << 40);
        assert!(scene.n_sites() < 2000, "{}", scene.n_sites());
    }
}
