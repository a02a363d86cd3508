//! Rotors and billboards: what turns without anybody compiling.

use sapwood::geom::glam::Vec3;
use sapwood::graph::{Eye, Facing};
use sapwood::scene::{
    Action, Attribute, Billboard, Group, Handle, Rotor, Scene, Time, ViewId, Viewer,
};

use super::super::kinds::*;
use super::errors;

const QUARTER: f32 = std::f32::consts::FRAC_PI_2;

/// Where the +x corner of each triangle of size 1 is, rounded to thousandths.
fn corners(scene: &mut Scene, view: ViewId) -> Vec<[f32; 3]> {
    let list = scene.draw_list(view, 1000).unwrap();
    let rounded = |x: f32| (x * 1000.0).round() / 1000.0 + 0.0;
    let corner = |(world, _): (sapwood::geom::glam::Affine3, _)| {
        world.transform_point3(Vec3::X).to_array().map(rounded)
    };
    list.placed_rows().map(corner).collect()
}

/// How many things happened since the log was taken last: compiled, and visited.
fn happened(scene: &mut Scene) -> [usize; 2] {
    let log = scene.take_log();
    [Action::Compiled, Action::Visited].map(|what| log.iter().filter(|e| e.action == what).count())
}

#[test]
fn a_rotor_turns_and_runs_no_init_at_any_tick() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let rotor = scene.add(Rotor { phase: QUARTER, ..Rotor::new(Vec3::Z * 3.0, QUARTER) });
    scene.add_to(rotor, Plain { size: 1.0 }).unwrap();
    for x in [0, 5] {
        let moved = scene.add_to(root, at(x)).unwrap();
        scene.append(moved, rotor).unwrap();
    }
    scene.add_to(root, Plain { size: 1.0 }).unwrap();
    let view = scene.open_view(root, &rules()).unwrap();
    let mut check = |time: f64, corner: [f32; 2]| {
        scene.set_moving::<Time>(view, time).unwrap();
        let [x, y] = corner;
        assert_eq!(corners(&mut scene, view), [[x, y, 0.0], [5.0 + x, y, 0.0], [1.0, 0.0, 0.0]]);
        let bounds = scene.bounds(view).unwrap().aabb;
        assert!(bounds.min.x <= x + 0.01 && bounds.min.y <= y + 0.01, "{bounds:?}");
        happened(&mut scene)
    };
    check(0.0, [0.0, 1.0]);
    assert_eq!(check(1.0, [-1.0, 0.0]), [0, 1], "one visit serves both places");
    assert_eq!(check(2.0, [0.0, -1.0]), [0, 1]);
    assert_eq!(check(2.0, [0.0, -1.0]), [0, 1]);
    // Whole turns count for nothing, and a clock that is broken turns nothing.
    assert_eq!(check(2003.0, [1.0, 0.0]), [0, 1]);
    assert_eq!(check(f64::NAN, [1.0, 0.0]), [0, 1]);
    assert_eq!(check(-1.0, [1.0, 0.0]), [0, 1]);
}

#[test]
fn what_a_rotor_turns_does_not_read_the_turn() {
    let mut scene = checked_scene();
    let moved = scene.add(at(4));
    let rotor = scene.add_to(moved, Rotor::new(Vec3::Z, 1.0)).unwrap();
    scene.add_to(rotor, Placed).unwrap();
    let view = scene.open_view(moved, &rules()).unwrap();
    scene.bounds(view).unwrap();
    for time in 0..10 {
        scene.set_moving::<Time>(view, f64::from(time)).unwrap();
        assert_eq!(super::sizes(&mut scene, view), [5.0]);
    }
    assert_eq!(compiled(&mut scene, "placed"), 1);
}

#[test]
fn faulty_rotors_and_billboards_are_errors_of_their_own() {
    let nan = f32::NAN;
    let faulty = [
        Rotor::new(Vec3::ZERO, 1.0),
        Rotor::new(Vec3::new(nan, 1.0, 0.0), 1.0),
        Rotor::new(Vec3::X, nan),
        Rotor { phase: f32::INFINITY, ..Rotor::new(Vec3::X, 1.0) },
    ];
    let mut scene = checked_scene();
    let root = scene.add(Group);
    for rotor in faulty {
        let rotor = scene.add_to(root, rotor).unwrap();
        scene.add_to(rotor, Plain { size: 1.0 }).unwrap();
    }
    for axis in [Vec3::ZERO, Vec3::new(0.0, nan, 0.0), Vec3::splat(f32::INFINITY)] {
        let facing = Facing::Axis(axis);
        let billboard = scene.add_to(root, Billboard { facing }).unwrap();
        scene.add_to(billboard, Plain { size: 1.0 }).unwrap();
    }
    scene.add_to(root, Plain { size: 1.0 }).unwrap();
    let view = scene.open_view(root, &rules()).unwrap();
    assert_eq!(corners(&mut scene, view).len(), 1);
    let kinds: Vec<_> = errors(&mut scene, view).into_iter().map(|(kind, _)| kind).collect();
    assert_eq!(kinds, ["rotor", "rotor", "rotor", "rotor", "billboard", "billboard", "billboard"]);
}

/// A board at two places.
fn boards(facing: Facing) -> (Scene, ViewId, Handle<Billboard>) {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let board = scene.add(Billboard { facing });
    scene.add_to(board, Plain { size: 1.0 }).unwrap();
    for x in [0, 10] {
        let moved = scene.add_to(root, at(x)).unwrap();
        scene.append(moved, board).unwrap();
    }
    let view = scene.open_view(root, &rules()).unwrap();
    (scene, view, board)
}

#[test]
fn a_board_turns_to_the_viewer_at_each_of_its_places() {
    let (mut scene, view, _) = boards(Facing::Axis(Vec3::Y * 2.0));
    let check = |scene: &mut Scene, position: Option<Vec3>, expected: [[f32; 3]; 2]| {
        let eye = position.map(Eye::new);
        scene.set_moving::<Viewer>(view, eye).unwrap();
        assert_eq!(corners(scene, view), expected, "from {position:?}");
    };
    let unturned = [[1.0, 0.0, 0.0], [11.0, 0.0, 0.0]];
    assert_eq!(corners(&mut scene, view), unturned);
    scene.take_log();
    let between = Some(Vec3::new(5.0, 3.0, 0.0));
    check(&mut scene, between, [[0.0, 0.0, -1.0], [10.0, 0.0, 1.0]]);
    let on_the_axis = Some(Vec3::new(10.0, 50.0, 0.0));
    check(&mut scene, on_the_axis, [[0.0, 0.0, -1.0], [11.0, 0.0, 0.0]]);
    check(&mut scene, None, unturned);
    assert_eq!(all_compiled(&mut scene), []);
}

#[test]
fn a_board_that_faces_freely_stays_upright() {
    let (mut scene, view, board) = boards(Facing::Eye);
    corners(&mut scene, view);
    let eye = Eye::new(Vec3::new(-10.0, 0.0, 0.0));
    scene.set_moving::<Viewer>(view, Some(eye)).unwrap();
    assert_eq!(corners(&mut scene, view), [[0.0, 0.0, 1.0], [10.0, 0.0, 1.0]]);
    // The bound holds whatever turn it takes.
    let bounds = scene.bounds(view).unwrap().aabb;
    assert!(bounds.min.z <= -1.0 && bounds.max.z >= 1.0, "{bounds:?}");
    assert!(bounds.max.x <= 12.0, "{bounds:?}");
    scene.take_log();
    scene.edit(board, |board| board.facing = Facing::Axis(Vec3::X)).unwrap();
    corners(&mut scene, view);
    assert_eq!(all_compiled(&mut scene), [("billboard", 1)]);
}

#[test]
fn an_empty_board_has_no_bound() {
    let mut scene = checked_scene();
    let root = scene.add(Group);
    let board = scene.add_to(root, Billboard { facing: Facing::Eye }).unwrap();
    let attribute = scene.add_to(board, Attribute::new()).unwrap();
    let view = scene.open_view(root, &rules()).unwrap();
    assert!(scene.bounds(view).unwrap().is_empty());
    let leaf = scene.add_to(attribute, Plain { size: 1.0 }).unwrap();
    assert!(!scene.bounds(view).unwrap().is_empty());
    scene.remove(leaf).unwrap();
    assert!(scene.bounds(view).unwrap().is_empty());
}
