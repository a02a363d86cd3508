//! What there can be no picture of.

use std::ops::ControlFlow;

use sapwood::geom::Aabb;
use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::graph::{Interrupted, Material};
use sapwood::picture::{PictureError, PictureOptions, PlacedCamera, Studio};
use sapwood::scene::{Budget, Group, Scene};

use super::scenes::{LENS, ball, camera, cuboid, of_meshes, taken, try_taken};

fn small() -> PictureOptions {
    PictureOptions { size: [20, 20], samples: 1, ..PictureOptions::default() }
}

#[test]
fn options_and_cameras_are_checked_before_anything_is_compiled() {
    let grey = Material::matte("grey", 0.5, 0.5, 0.5);
    let (mut scene, view) = of_meshes(vec![(ball(8), grey, Affine3::IDENTITY)]);
    let fitted = camera(&mut scene, view, [20, 20]);
    let mut supply = scene.supply(view).unwrap();
    let wrong = PictureOptions { size: [0, 20], ..small() };
    let error = try_taken(&mut supply, &fitted, &wrong).unwrap_err().to_string();
    assert!(error.contains("0x20") && error.contains("accepted"), "{error}");
    let mut nowhere = fitted.clone();
    nowhere.world.translation = Vec3::NAN;
    let error = try_taken(&mut supply, &nowhere, &small()).unwrap_err();
    assert!(matches!(error, PictureError::Camera(_)), "{error}");
}

#[test]
fn a_scene_without_extent_has_nothing_to_fit() {
    let mut scene = Scene::new();
    let root = scene.add(Group);
    let view = scene.open_view(root, &sapwood::standard_rules()).unwrap();
    let bounds = scene.bounds(view).unwrap().aabb;
    let from = PlacedCamera::THREE_QUARTER;
    let error = PlacedCamera::fit(&bounds, from, LENS, [9, 9], 0.08).unwrap_err();
    assert_eq!(error, PictureError::Empty);
    // Who says where to look sees the sky.
    let camera = PlacedCamera::look_at(LENS, Vec3::Z, Vec3::ZERO).unwrap();
    let picture = taken(&mut scene, view, &camera, &small());
    let [r, _, b, _] = picture.image.pixels[0];
    assert!(b > r && r > 100, "{r} {b}");
    let flat = Aabb { min: Vec3::ZERO, max: Vec3::ZERO };
    assert!(PlacedCamera::fit(&flat, from, LENS, [9, 9], 0.08).is_ok());
}

#[test]
fn whoever_follows_the_progress_may_stop_it() {
    let grey = Material::matte("grey", 0.5, 0.5, 0.5);
    let (mut scene, view) = of_meshes(vec![(ball(8), grey, Affine3::IDENTITY)]);
    let camera = camera(&mut scene, view, [20, 20]);
    let mut supply = scene.supply(view).unwrap();
    let mut studio = Studio::new(&mut supply);
    let stopped = studio.picture(&camera, &small(), &mut |_| ControlFlow::Break(()));
    assert_eq!(stopped.unwrap_err(), PictureError::Interrupted(Interrupted::Cancelled));
    assert!(studio.picture(&camera, &small(), &mut |_| ControlFlow::Continue(())).is_ok());
}

#[test]
fn a_budget_that_runs_out_says_so() {
    let species = sapwood::io::built_in("quaking_aspen").unwrap();
    let mut scene = Scene::new();
    let family = scene.add(species.attribute());
    let seed = sapwood::rules::weber_penn::Seed::Explicit(1);
    scene.add_to(family, sapwood::rules::weber_penn::Tree { seed }).unwrap();
    let view = scene.open_view(family, &sapwood::standard_rules()).unwrap();
    scene.set_budget(view, Budget { triangles: 1_000, ..Budget::default() }).unwrap();
    let camera = PlacedCamera::look_at(LENS, Vec3::new(0.0, 8.0, 30.0), Vec3::Y * 6.0).unwrap();
    let error = try_taken(&mut scene.supply(view).unwrap(), &camera, &small()).unwrap_err();
    assert!(error.to_string().contains("more than 1000 triangles"), "{error}");
}

#[test]
fn flat_and_broken_frames_harm_nobody() {
    let red = || Material { double_sided: true, ..Material::matte("red", 0.9, 0.0, 0.0) };
    let cube = || cuboid(Vec3::NEG_ONE, Vec3::ONE);
    let flat = Affine3::from_scale(Vec3::new(1.0, 1.0, 0.0));
    let mut nowhere = Affine3::IDENTITY;
    nowhere.translation = Vec3::NAN;
    let (mut scene, view) = of_meshes(vec![(cube(), red(), flat), (cube(), red(), nowhere)]);
    let camera = PlacedCamera::look_at(LENS, Vec3::Z * 9.0, Vec3::ZERO).unwrap();
    let picture = taken(&mut scene, view, &camera, &small());
    let [r, g, _, a] = picture.image.pixels[10 * 20 + 10];
    assert!(r > 3 * g && a == 255, "{r} {g} {a}");
}
