//! Picking, what pictures see, and testing every triangle agree.

use sapwood::geom::Ray;
use sapwood::graph::{Material, PickOptions};
use sapwood::picture::Studio;
use sapwood::rules::weber_penn::{Seed, Tree};
use sapwood::scene::{MaterialSlot, Scene};

use crate::core::picking::every_triangle::{Rays, check};

/// Ten thousand rays at a species: picks against every triangle, and pictures against picks.
fn agree_on(species: &str, seed: u64) {
    let species = sapwood::io::built_in(species).unwrap();
    let mut scene = Scene::new();
    let family = scene.add(species.attribute());
    scene.add_to(family, Tree { seed: Seed::Explicit(seed) }).unwrap();
    let view = scene.open_view(family, &sapwood::standard_rules()).unwrap();
    // Picks do not ask whether a leaf's image covers the place.
    let plain = Material { double_sided: true, ..Material::matte("plain", 0.5, 0.5, 0.5) };
    scene.force_held::<MaterialSlot>(view, plain).unwrap();
    let rays = Rays::new(scene.bounds(view).unwrap(), seed).take(10_000);
    let options = PickOptions::default();
    let n_hits = check(&mut scene, view, &rays, &options);
    assert!(n_hits > 1_000, "{n_hits}");

    let picked: Vec<_> = rays.iter().map(|ray| scene.pick(view, ray, &options).unwrap()).collect();
    let mut supply = scene.supply(view).unwrap();
    let mut studio = Studio::new(&mut supply);
    let mut grazing = Vec::new();
    for (ray, picked) in rays.iter().zip(picked) {
        let origin = ray.at(ray.min()).as_vec3();
        let reach = (ray.max() - ray.min()) as f32;
        let sight = studio.sight(origin, ray.direction().as_vec3(), reach).unwrap();
        let distance = sight.map(|sight| f64::from(sight.distance) + ray.min());
        if !is_same(picked.map(|hit| hit.distance), distance) {
            grazing.push((ray, distance));
        }
    }
    // The more leaves there are the more edges: a maple of 38,000 has 36 among 4,457.
    assert!(grazing.len() <= n_hits as usize / 100, "{} of {n_hits}", grazing.len());
    drop(supply);
    // Rounded to `f32`, a ray passes an edge on its other side: so does a ray beside it.
    for (ray, distance) in grazing {
        let (across, up) = ray.direction().as_vec3().any_orthonormal_pair();
        let beside = (0..32).map(|i| {
            let angle = i as f32 * 0.77;
            let aside = across * angle.cos() + up * angle.sin();
            let aside = aside * (1e-6 * (1 + i) as f32 * (1.0 + ray.origin().length() as f32));
            Ray::new(ray.origin().as_vec3() + aside, ray.direction().as_vec3())
                .between(ray.min() as f32, ray.max() as f32)
        });
        let mut picks = beside.map(|ray| scene.pick(view, &ray, &options).unwrap());
        let is_found = picks.any(|hit| is_same(hit.map(|hit| hit.distance), distance));
        assert!(is_found, "{ray:?}: {distance:?}");
    }
}

/// Whether two distances are the same but for rounding.
fn is_same(picked: Option<f32>, seen: Option<f64>) -> bool {
    match (picked, seen) {
        (None, None) => true,
        (Some(picked), Some(seen)) => (f64::from(picked) - seen).abs() < 1e-4 * (1.0 + seen),
        _ => false,
    }
}

#[test]
fn rays_at_a_maple() {
    agree_on("japanese_maple", 1);
}

#[test]
fn rays_at_a_poplar() {
    agree_on("lombardy_poplar", 2);
}

#[test]
fn rays_at_a_palm() {
    agree_on("palm", 3);
}
