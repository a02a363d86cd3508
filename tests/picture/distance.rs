//! What is seen from far away, or stands far from the origin, looks as it does nearby.

use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::graph::Lens;
use sapwood::picture::{Background, PictureOptions, PlacedCamera};
use sapwood::rules::weber_penn::{Seed, Tree};
use sapwood::scene::{Scene, Transform};

use super::scenes::taken;

/// How much of a picture is covered, in pixels, and the mean of what is, as bytes.
fn covered(scene: &mut Scene, at: Vec3, away: f32) -> (f32, f32) {
    // Its fronds are finer than what rounding would move rays by, if it grew with the distance.
    let species = sapwood::io::find_species("palm").unwrap();
    let place = scene.add(Transform(Affine3::from_translation(at)));
    let palms = scene.add_to(place, species.attribute()).unwrap();
    scene.add_to(palms, Tree { seed: Seed::Explicit(1) }).unwrap();
    let view = scene.open_view(place, &sapwood::standard_rules()).unwrap();
    let target = scene.bounds(view).unwrap().aabb.center();
    let lens = Lens::Orthographic { height: 24.0 };
    // Not along an axis. The side in the shade, which light would come through.
    let eye = target + Vec3::new(0.9, 0.1, -0.5).normalize() * away;
    let camera = PlacedCamera::look_at(lens, eye, target).unwrap();
    let background = Background::Transparent;
    let options =
        PictureOptions { size: [160; 2], samples: 8, background, ..PictureOptions::default() };
    let image = taken(scene, view, &camera, &options).image;
    let (mut n, mut light) = (0.0, 0.0);
    for [r, g, b, a] in image.pixels {
        let share = f32::from(a) / 255.0;
        n += share;
        light += share * [r, g, b].map(f32::from).iter().sum::<f32>() / 3.0;
    }
    (n, light / n)
}

#[test]
fn a_palm_is_as_bright_and_as_dense_from_anywhere() {
    let mut scene = Scene::new();
    let near = covered(&mut scene, Vec3::ZERO, 30.0);
    assert!(near.0 > 500.0, "{near:?}");
    for (at, away, most) in [
        (Vec3::ZERO, 600.0, 0.01),
        (Vec3::ZERO, 3000.0, 0.01),
        (Vec3::new(600.0, 0.0, -300.0), 30.0, 0.02),
        (Vec3::new(600.0, 0.0, -300.0), 600.0, 0.02),
    ] {
        let seen = covered(&mut scene, at, away);
        let off = |a: f32, b: f32| (a / b - 1.0).abs();
        let (covered, light) = (off(seen.0, near.0), off(seen.1, near.1));
        assert!(covered < 0.01 && light < most, "at {at} from {away} m: {covered} {light}");
    }
}
