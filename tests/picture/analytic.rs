//! Shapes of which it is known where a ray meets them, and how light falls on them.

use sapwood::geom::glam::{Affine3, EulerRot, Mat3, Quat, Vec3};
use sapwood::geom::{Mesh, Purpose, Shared, SharedMesh, Stream, StreamPath};
use sapwood::graph::{Lens, Light, LightShape, Material};
use sapwood::picture::{Background, Ground, PictureOptions, PlacedCamera, Sky, Studio, Sun};
use sapwood::scene::{Group, HeldInstances, Scene, Transform};

use super::scenes::{ball, cuboid, of_meshes, taken};

/// Rays from all around toward somewhere near the origin.
fn rays(n: usize) -> Vec<(Vec3, Vec3)> {
    let mut stream = Stream::new(StreamPath::new(5), Purpose("rays"));
    let mut ball = || loop {
        let point = Vec3::from_array([(); 3].map(|()| 2.0 * stream.unit() - 1.0));
        if (0.1..1.0).contains(&point.length()) {
            return point;
        }
    };
    (0..n)
        .map(|_| {
            let origin = ball().normalize() * 9.0;
            (origin, ball() * 2.0 - origin)
        })
        .collect()
}

/// Where a ray enters the box from -1 to 1, and through which side.
fn enters_cube(origin: Vec3, direction: Vec3) -> Option<(f32, Vec3)> {
    let inverse = direction.recip();
    let (one, other) = ((Vec3::NEG_ONE - origin) * inverse, (Vec3::ONE - origin) * inverse);
    let near = one.min(other);
    let enters = near.max_element();
    let axis = near.max_position();
    let mut side = Vec3::ZERO;
    side[axis] = -direction[axis].signum();
    (one.max(other).min_element() > enters).then_some((enters, side))
}

/// Where a ray enters the unit sphere.
fn enters_ball(origin: Vec3, direction: Vec3) -> Option<f32> {
    let half = origin.dot(direction);
    let square = direction.length_squared();
    let root = half * half - square * (origin.length_squared() - 1.0);
    (root > 0.0).then(|| (-half - root.sqrt()) / square)
}

/// A turn with a scale that differs from axis to axis, mirrors, and a shift.
fn skewed() -> Affine3 {
    let turn = Mat3::from_quat(Quat::from_euler(EulerRot::XYZ, 0.4, -1.1, 0.7));
    let scale = Mat3::from_diagonal(Vec3::new(1.4, -0.3, 0.8));
    Affine3::from_mat3_translation(turn * scale * turn.transpose(), Vec3::new(0.2, -0.1, 0.3))
}

#[test]
fn a_box_is_met_exactly_however_it_is_scaled_and_repeated() {
    for place in [Affine3::IDENTITY, skewed()] {
        let mut scene = Scene::new();
        let root = scene.add(Group);
        let mesh = SharedMesh::new(cuboid(Vec3::NEG_ONE, Vec3::ONE));
        let far = Affine3::from_translation(Vec3::splat(1e3));
        let places = Shared::new(vec![far, place]);
        scene.add_to(root, HeldInstances { mesh, material: None, places }).unwrap();
        let view = scene.open_view(root, &sapwood::standard_rules()).unwrap();
        let mut supply = scene.supply(view).unwrap();
        let mut studio = Studio::new(&mut supply);
        let inverse = place.inverse();
        let mut n_hits = 0;
        for (origin, direction) in rays(4_000) {
            let direction = direction.normalize();
            let local = (inverse.transform_point3(origin), inverse.transform_vector3(direction));
            let wanted = enters_cube(local.0, local.1);
            let sight = studio.sight(origin, direction, f32::INFINITY).unwrap();
            match (wanted, sight) {
                (None, None) => {}
                (Some((distance, side)), Some(sight)) => {
                    n_hits += 1;
                    assert!((sight.distance - distance).abs() < 3e-5, "{sight:?} {distance}");
                    assert!(sight.point.distance(origin + direction * distance) < 5e-5);
                    let normal = (inverse.matrix3.transpose() * side).normalize();
                    assert!(sight.normal.distance(normal) < 1e-4, "{sight:?} {normal}");
                    assert!(sight.shading_normal.distance(normal) < 1e-4, "{sight:?} {normal}");
                }
                // Nobody can tell at an edge.
                (wanted, sight) => {
                    let nearer = enters_cube(local.0 * 0.999, local.1).is_some();
                    let farther = enters_cube(local.0 * 1.001, local.1).is_some();
                    assert!(nearer != farther, "{wanted:?} {sight:?}");
                }
            }
        }
        assert!(n_hits > 500, "{n_hits}");
    }
}

#[test]
fn a_ball_is_met_as_exactly_as_its_triangles_are_fine() {
    let n = 200;
    for place in [Affine3::IDENTITY, skewed()] {
        let (mut scene, view) =
            of_meshes(vec![(ball(n), Material::matte("ball", 0.5, 0.5, 0.5), place)]);
        let mut supply = scene.supply(view).unwrap();
        let mut studio = Studio::new(&mut supply);
        let inverse = place.inverse();
        // How far flat triangles lie below the sphere.
        let cell = std::f32::consts::PI / n as f32;
        let sagging = 0.5 * cell * cell;
        let mut n_hits = 0;
        for (origin, direction) in rays(4_000) {
            let direction = direction.normalize();
            let local = (inverse.transform_point3(origin), inverse.transform_vector3(direction));
            let sight = studio.sight(origin, direction, f32::INFINITY).unwrap();
            let nearest =
                (local.0 - local.1 * (local.0.dot(local.1) / local.1.length_squared())).length();
            if let Some(sight) = sight {
                let met = inverse.transform_point3(sight.point);
                assert!((1.0 - sagging - 1e-5..1.0 + 1e-5).contains(&met.length()), "{met}");
                let distance = enters_ball(local.0, local.1).unwrap_or(sight.distance);
                // Flat against the sphere, what is missing is long.
                let slope = (1.0 - nearest * nearest).max(1e-3).sqrt();
                let stretch = local.1.length();
                let missing = (sight.distance - distance) * stretch;
                assert!(missing.abs() < 1e-4 + 1.5 * sagging / slope, "{missing} {slope}");
                let normal = (inverse.matrix3.transpose() * met).normalize();
                assert!(sight.shading_normal.distance(normal) < 0.02, "{sight:?} {normal}");
                n_hits += 1;
            } else {
                assert!(nearest > 1.0 - 2.0 * sagging, "missed at {nearest} from the middle");
            }
        }
        assert!(n_hits > 500, "{n_hits}");
    }
}

/// Only the sun, from above, one sample.
fn plain() -> PictureOptions {
    PictureOptions {
        size: [32, 32],
        samples: 1,
        sun: Some(Sun { toward: Vec3::Y, radius: 0.0, color: [2.0; 3] }),
        sky: Sky { zenith: [0.0; 3], horizon: [0.0; 3], nadir: [0.0; 3], ..Sky::default() },
        background: Background::Color([0.0; 3]),
        ..PictureOptions::default()
    }
}

/// From above, ten metres wide.
fn from_above() -> PlacedCamera {
    let lens = Lens::Orthographic { height: 10.0 };
    PlacedCamera::look_at(lens, Vec3::Y * 20.0, Vec3::ZERO).unwrap()
}

fn linear(byte: u8) -> f32 {
    let encoded = f32::from(byte) / 255.0;
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// A plate of ten by ten metres at height 0.
fn plate(material: Material) -> (Mesh, Material, Affine3) {
    let mesh = cuboid(Vec3::new(-5.0, -0.1, -5.0), Vec3::new(5.0, 0.0, 5.0));
    (mesh, material, Affine3::IDENTITY)
}

fn middle(options: &PictureOptions, things: Vec<(Mesh, Material, Affine3)>) -> [f32; 3] {
    let (mut scene, view) = of_meshes(things);
    let picture = taken(&mut scene, view, &from_above(), options);
    let [r, g, b, _] = picture.image.pixels[16 * 32 + 16];
    [r, g, b].map(linear)
}

fn assert_near(seen: [f32; 3], wanted: [f32; 3]) {
    for (seen, wanted) in seen.into_iter().zip(wanted) {
        assert!((seen - wanted).abs() < 0.01, "{seen} is not {wanted}");
    }
}

#[test]
fn a_matte_plate_sends_back_its_share_of_what_falls_on_it() {
    let grey = Material::matte("grey", 0.9, 0.5, 0.2);
    // The highlight of the roughest surface, straight on: a 25th of an even spread, over 4.
    let gloss = 2.0 * 0.04 / (4.0 * std::f32::consts::PI);
    let wanted = [0.9, 0.5, 0.2].map(|share: f32| share * 2.0 / std::f32::consts::PI + gloss);
    assert_near(middle(&plain(), vec![plate(grey.clone())]), wanted);
    // As much from a sky that is the same everywhere.
    let mut options = plain();
    options.sun = None;
    let even = [0.6; 3];
    options.sky = Sky { zenith: even, horizon: even, nadir: even, ..options.sky };
    assert_near(middle(&options, vec![plate(grey)]), [0.54, 0.3, 0.12]);
}

#[test]
fn something_above_throws_a_shadow_and_keeps_the_sky_away() {
    let grey = || Material::matte("grey", 0.8, 0.8, 0.8);
    let mut options = plain();
    // From the side, so that the shadow falls where it is seen.
    options.sun = Some(Sun { toward: Vec3::new(1.0, 1.0, 0.0), radius: 0.0, color: [2.0; 3] });
    let lit = middle(&options, vec![plate(grey())]);
    let above = cuboid(Vec3::new(2.0, 2.0, -1.0), Vec3::new(4.0, 2.5, 1.0));
    let shaded = middle(&options, vec![plate(grey()), (above, grey(), Affine3::IDENTITY)]);
    assert!(lit[0] > 0.3, "{lit:?}");
    assert_near(shaded, [0.0; 3]);
    // A corner between two high walls sees less of the sky.
    let even = [0.6; 3];
    let mut options = PictureOptions { sun: None, samples: 64, ..plain() };
    options.sky = Sky { zenith: even, horizon: even, nadir: even, bounce: 0.0, ..Sky::default() };
    let wall = |min: Vec3, max: Vec3| (cuboid(min, max), grey(), Affine3::IDENTITY);
    let wall = wall(Vec3::new(0.5, 0.0, -50.0), Vec3::new(1.0, 9.0, 50.0));
    let open = middle(&options, vec![plate(grey())]);
    let beside = middle(&options, vec![plate(grey()), wall]);
    assert_near(open, [0.48; 3]);
    // From low down the sky gives little: half of all directions are worth more than a third.
    assert!((0.24..0.34).contains(&beside[0]), "{beside:?}");
}

#[test]
fn a_leaf_lets_light_through_by_its_translucency() {
    let leaf = |translucency| Material {
        translucency,
        double_sided: true,
        ..Material::matte("leaf", 0.5, 0.5, 0.5)
    };
    // Lit from below, seen from above.
    let mut options = plain();
    options.sun = Some(Sun { toward: Vec3::NEG_Y, radius: 0.0, color: [2.0; 3] });
    let mut sheet = cuboid(Vec3::new(-5.0, -0.1, -5.0), Vec3::new(5.0, 0.0, 5.0));
    // The upper side alone.
    sheet.indices.retain(|i| sheet.normals[*i as usize] == Vec3::Y);
    let sheet = |translucency| vec![(sheet.clone(), leaf(translucency), Affine3::IDENTITY)];
    assert_near(middle(&options, sheet(0.0)), [0.0; 3]);
    let wanted = 0.4 * 0.5 * 2.0 / std::f32::consts::PI;
    assert_near(middle(&options, sheet(0.4)), [wanted; 3]);
}

#[test]
fn mirrors_show_what_is_before_them_until_the_limit_ends_it() {
    let mirror =
        || Material { metallic: 1.0, roughness: 0.0, ..Material::matte("mirror", 1.0, 1.0, 1.0) };
    let red = Material { emissive: [0.7, 0.0, 0.0], ..Material::matte("red", 0.0, 0.0, 0.0) };
    // Looking at a mirror that leans by 45 degrees, and so at what is beside.
    let lean = Affine3::from_rotation_z(std::f32::consts::FRAC_PI_4);
    let beside = cuboid(Vec3::new(-9.0, -50.0, -50.0), Vec3::new(-8.0, 50.0, 50.0));
    let (mesh, material, _) = plate(mirror());
    let things = || {
        vec![
            (mesh.clone(), material.clone(), lean),
            (beside.clone(), red.clone(), Affine3::IDENTITY),
        ]
    };
    let options = PictureOptions { sun: None, ..plain() };
    assert_near(middle(&options, things()), [0.7, 0.0, 0.0]);
    let options = PictureOptions { most_reflections: 0, ..options };
    assert_near(middle(&options, things()), [0.0; 3]);
}

#[test]
fn lights_of_the_scene_and_the_ground_are_there() {
    let mut scene = Scene::new();
    let root = scene.add(Group);
    let place = scene.add_to(root, Transform(Affine3::from_translation(Vec3::Y * 2.0))).unwrap();
    let shape = LightShape::Point { range: None };
    let light = Light { name: String::new(), color: [1.0, 0.5, 0.0], intensity: 8.0, shape };
    scene.add_to(place, light).unwrap();
    let view = scene.open_view(root, &sapwood::standard_rules()).unwrap();
    let ground = Ground { height: 0.0, color: [0.5; 3] };
    let options = PictureOptions { sun: None, ground: Some(ground), ..plain() };
    let picture = taken(&mut scene, view, &from_above(), &options);
    let [r, g, b, a] = picture.image.pixels[16 * 32 + 16];
    let lit = 2.0 * (0.5 / std::f32::consts::PI + 0.04 / (4.0 * std::f32::consts::PI));
    assert_near([r, g, b].map(linear), [lit, 0.5 * lit, 0.0]);
    assert_eq!(a, 255);
}

#[test]
fn what_is_not_covered_is_transparent_on_request() {
    let options = PictureOptions { background: Background::Transparent, ..plain() };
    let small = cuboid(Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 1.0, 1.0));
    let (mut scene, view) =
        of_meshes(vec![(small, Material::matte("grey", 0.5, 0.5, 0.5), Affine3::IDENTITY)]);
    let picture = taken(&mut scene, view, &from_above(), &options);
    assert_eq!(picture.image.pixels[0], [0; 4]);
    assert_eq!(picture.image.pixels[16 * 32 + 16][3], 255);
}
