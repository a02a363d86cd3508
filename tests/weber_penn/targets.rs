//! Targets in the world: what a tree turns toward stays where it is when the tree is turned.

use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::rules::weber_penn::{LeafTarget, Seed, Species, Target, Tree};
use sapwood::scene::{Handle, Scene, Transform, ViewId};

use super::trees::*;

struct Placed {
    scene: Scene,
    place: Handle<Transform>,
    view: ViewId,
}

fn placed(species: &Species, place: Affine3) -> Placed {
    let mut scene = checked_scene();
    let family = scene.add(species.attribute());
    let place = scene.add_to(family, Transform(place)).unwrap();
    scene.add_to(place, Tree { seed: Seed::Explicit(1) }).unwrap();
    let view = scene.open_view(family, &sapwood::standard_rules()).unwrap();
    Placed { scene, place, view }
}

fn turned() -> Affine3 {
    let turn = Affine3::from_rotation_y(1.2) * Affine3::from_rotation_x(0.4);
    Affine3::from_translation(Vec3::new(4.0, 1.0, -7.0)) * turn
}

/// A sapling of two levels of limbs, attracted by `target` and with leaves that face
/// `leaf_target`.
fn attracted(target: Target, leaf_target: LeafTarget) -> Species {
    let mut species = with(&sapling(), &[("attraction_up", 2.0), ("leaves.attraction", 0.5)]);
    species.attraction_target = target;
    species.leaves.target = leaf_target;
    species
}

/// A tree at `turned()` with targets in the world grows like an unturned one whose targets are
/// turned the other way.
fn check(target: impl Fn(&Affine3) -> Target, leaf_target: impl Fn(&Affine3) -> LeafTarget) {
    let unturned = Affine3::IDENTITY;
    let mut there = placed(&attracted(target(&unturned), leaf_target(&unturned)), turned());
    let back = turned().inverse();
    let mut here = placed(&attracted(target(&back), leaf_target(&back)), unturned);
    let mut free = placed(&attracted(Target::Up, LeafTarget::Outward), unturned);
    let [there, here, free] =
        [&mut there, &mut here, &mut free].map(|tree| parts(&mut tree.scene, tree.view));
    assert!(here.segments[..2] == free.segments[..2], "attraction begins on level 2");
    assert_eq!(there.segments.len(), 3);
    let mut differs = 0;
    for (level, (there, here)) in there.segments.iter().zip(&here.segments).enumerate() {
        assert_eq!(there.len(), here.len());
        for ((_, a), (_, b)) in there.iter().zip(here) {
            assert!(a.frame.axes.abs_diff_eq(b.frame.axes, 2e-3), "level {level}: {a:?} {b:?}");
            assert!(a.frame.origin.abs_diff_eq(b.frame.origin, 5e-3), "level {level}");
        }
    }
    for ((_, a), (_, b)) in here.segments[2].iter().zip(&free.segments[2]) {
        differs += usize::from(!a.frame.axes.abs_diff_eq(b.frame.axes, 0.05));
    }
    assert!(differs > here.segments[2].len() / 4, "{differs} segments are attracted");
    assert_eq!(there.leaves.len(), here.leaves.len());
    for ((_, a), (_, b)) in there.leaves.iter().zip(&here.leaves) {
        assert!(a.frame.axes.abs_diff_eq(b.frame.axes, 5e-3), "{a:?} {b:?}");
    }
}

#[test]
fn a_direction_in_the_world_does_not_turn_with_the_tree() {
    let direction = Vec3::new(1.0, 0.5, -0.3);
    check(
        |turn| Target::Direction(turn.transform_vector3(direction)),
        |turn| LeafTarget::Direction(turn.transform_vector3(direction)),
    );
}

#[test]
fn a_point_in_the_world_does_not_move_with_the_tree() {
    let point = Vec3::new(30.0, 12.0, -3.0);
    check(
        |turn| Target::Point(turn.transform_point3(point)),
        |turn| LeafTarget::Point(turn.transform_point3(point)),
    );
}

#[test]
fn the_leaves_of_a_tree_face_the_sun() {
    let sun = Vec3::new(500.0, 900.0, -200.0);
    let mut species = attracted(Target::Up, LeafTarget::Point(sun));
    species.leaves.attraction = 1.0;
    let mut tree = placed(&species, turned());
    let parts = parts(&mut tree.scene, tree.view);
    assert!(parts.leaves.len() > 50);
    for (world, leaf) in &parts.leaves {
        let face = world.transform_vector3(leaf.frame.axes.y_axis);
        let to_sun = (sun - world.transform_point3(leaf.frame.origin)).normalize();
        assert!(face.dot(to_sun) > 0.999, "{face} {to_sun}");
    }
}

#[test]
fn a_tree_that_grows_up_does_not_read_where_it_stands() {
    for leaf_target in [LeafTarget::Outward, LeafTarget::Scattered] {
        let mut tree = placed(&attracted(Target::Up, leaf_target), Affine3::IDENTITY);
        compiled(&mut tree.scene, tree.view);
        tree.scene.edit(tree.place, |place| place.0 = turned()).unwrap();
        assert_eq!(compiled(&mut tree.scene, tree.view), [("transform", 1)]);
    }
}

#[test]
fn a_direction_regrows_what_is_attracted_when_the_tree_is_turned_and_nothing_when_it_is_moved() {
    let species = attracted(Target::Direction(Vec3::X), LeafTarget::Outward);
    let mut tree = placed(&species, Affine3::IDENTITY);
    compiled(&mut tree.scene, tree.view);
    let to = Affine3::from_translation(Vec3::new(9.0, 0.0, 2.0));
    tree.scene.edit(tree.place, |place| place.0 = to).unwrap();
    assert_eq!(compiled(&mut tree.scene, tree.view), [("transform", 1), ("tree", 1)]);
    tree.scene.edit(tree.place, |place| place.0 = turned()).unwrap();
    let ran = compiled(&mut tree.scene, tree.view);
    let expected = [
        ("leaf_surface", 6),
        ("leaves", 6),
        ("stem_surface", 6),
        ("transform", 1),
        ("tree", 1),
        ("twigs", 6),
    ];
    assert_eq!(ran, expected, "trunk and limbs are not attracted");
}

#[test]
fn leaves_alone_turn_to_their_own_target() {
    let species = attracted(Target::Up, LeafTarget::Point(Vec3::new(3.0, 80.0, 0.0)));
    let mut tree = placed(&species, Affine3::IDENTITY);
    compiled(&mut tree.scene, tree.view);
    tree.scene.edit(tree.place, |place| place.0 = turned()).unwrap();
    let ran = compiled(&mut tree.scene, tree.view);
    assert_eq!(ran, [("leaf_surface", 6), ("leaves", 6), ("transform", 1), ("tree", 1)]);
}

#[test]
fn a_target_of_a_tree_without_an_extent_is_an_error_until_it_is_scaled_up() {
    let flat = Affine3::from_scale(Vec3::new(1.0, 0.0, 1.0));
    for (target, leaf_target) in [
        (Target::Direction(Vec3::X), LeafTarget::Outward),
        (Target::Point(Vec3::X), LeafTarget::Outward),
        (Target::Up, LeafTarget::Point(Vec3::X)),
    ] {
        let mut tree = placed(&attracted(target, leaf_target), flat);
        tree.scene.bounds(tree.view).unwrap();
        let found = tree.scene.diagnostics(tree.view, 2).unwrap();
        let [(_, error)] = found.as_slice() else { panic!("{found:?}") };
        let text = error.to_string();
        assert!(text.contains("cannot turn toward a target in the world"), "{text}");
        tree.scene.edit(tree.place, |place| place.0 = turned()).unwrap();
        assert!(!tree.scene.bounds(tree.view).unwrap().is_empty());
        assert_eq!(tree.scene.diagnostics(tree.view, 2).unwrap(), []);
    }
    let mut tree = placed(&attracted(Target::Up, LeafTarget::Outward), flat);
    tree.scene.bounds(tree.view).unwrap();
    assert_eq!(tree.scene.diagnostics(tree.view, 2).unwrap(), [], "no target, no error");
}
