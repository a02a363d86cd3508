//! Snapshots of every built-in species at one seed: short texts with numbers, bounds, a digest of
//! rounded values, and the first stems.
//!
//! After a change that is meant to change trees: `cargo insta review`, or run the tests with
//! `INSTA_UPDATE=always`; read every changed line.

use std::fmt::Write as _;

use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::geom::{Content, Digester};
use sapwood::scene::Scene;

use super::trees::*;

const SEED: u64 = 1;
/// How many stems of each level are listed.
const N_FIRST: usize = 2;

/// Values rounded to 1e-4, so that nothing that no one can see changes the digest.
struct Rounded<'a>(&'a mut Digester);

impl Rounded<'_> {
    fn add(&mut self, x: f32) {
        let whole = (f64::from(x) * 1e4).round() as i64;
        whole.write(self.0);
    }

    fn vector(&mut self, v: Vec3) {
        v.to_array().into_iter().for_each(|x| self.add(x));
    }

    fn transform(&mut self, t: &Affine3) {
        let axes = t.matrix3;
        for v in [axes.x_axis, axes.y_axis, axes.z_axis, t.translation] {
            self.vector(v);
        }
    }
}

fn rounded(x: f32) -> f64 {
    let rounded = (f64::from(x) * 1e4).round() / 1e4;
    if rounded == 0.0 { 0.0 } else { rounded }
}

fn point(v: Vec3) -> String {
    let [x, y, z] = v.to_array().map(rounded);
    format!("({x} {y} {z})")
}

fn text(name: &str) -> Result<String, std::fmt::Error> {
    let species = built_in(name);
    let mut tree = planted_in(Scene::new(), &species, SEED);
    let (parts, list) = (tree.parts(), tree.draw_list());
    let bounds = tree.scene.bounds(tree.view).unwrap().aabb;
    let mut out = String::new();
    writeln!(out, "{}, seed {SEED}", species.name)?;
    for (level, (stems, segments)) in parts.stems.iter().zip(&parts.segments).enumerate() {
        let clones = stems.iter().filter(|stem| stem.clone_of.is_some()).count();
        let (stems, segments) = (stems.len(), segments.len());
        writeln!(out, "level {level}: {stems} stems ({clones} clones), {segments} segments")?;
    }
    let (vertices, triangles) = list.n_vertices_and_triangles();
    writeln!(out, "leaves: {}", parts.leaves.len())?;
    writeln!(out, "drawn: {vertices} vertices, {triangles} triangles")?;
    writeln!(out, "bounds: {} to {}", point(bounds.min), point(bounds.max))?;

    let mut digester = Digester::new();
    let mut values = Rounded(&mut digester);
    for (world, row) in list.placed_rows() {
        values.transform(&world);
        row.mesh.positions.iter().chain(&row.mesh.normals).for_each(|v| values.vector(*v));
        let instances = row.instances.iter().flat_map(|instances| instances.iter());
        instances.for_each(|instance| values.transform(instance));
    }
    writeln!(out, "digest: {:?}", digester.finish())?;

    for (level, stems) in parts.stems.iter().enumerate() {
        for stem in stems.iter().filter(|stem| stem.clone_of.is_none()).take(N_FIRST) {
            let seed = &stem.seed;
            let (at, along) = (point(seed.frame.origin), point(seed.frame.axes.z_axis));
            let (radius, length) = (rounded(seed.radius), rounded(seed.length));
            writeln!(out, "stem of level {level} at {at} along {along}")?;
            writeln!(out, "  radius {radius}, length {length}, offset {}", rounded(seed.offset))?;
        }
    }
    if let Some((_, leaf)) = parts.leaves.first() {
        let (at, along) = (point(leaf.frame.origin), point(leaf.frame.axes.z_axis));
        let (length, width) = (rounded(leaf.length), rounded(leaf.width));
        writeln!(out, "leaf at {at} along {along}\n  length {length}, width {width}")?;
    }
    Ok(out)
}

#[test]
fn species_grow_as_they_did() {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(concat!(env!("CARGO_MANIFEST_DIR"), "/../snapshots"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| {
        for name in sapwood::io::built_in_names() {
            insta::assert_snapshot!(name, text(name).unwrap());
        }
    });
}
