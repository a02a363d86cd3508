//! A rule of one's own: aspens of square timber, everything else by the standard rules.
//!
//! `cargo run --example own_rule [FOLDER]` writes `own_rule.glb`.

use std::error::Error;
use std::path::PathBuf;
use std::sync::Arc;

use sapwood::geom::{Cap, Mesh, Ring, Section, SharedMesh, Sweep, SweepOptions};
use sapwood::graph::Material;
use sapwood::rules::weber_penn::{Seed, StemSurface, Tree};
use sapwood::scene::{Context, Group, Rule, RuleError, RuleSet, Scene, Transform};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).unwrap_or("target/examples-out".into());
    let folder = PathBuf::from(folder);
    std::fs::create_dir_all(&folder)?;

    // Two aspens of one species.
    let species = sapwood::io::find_species("quaking_aspen")?;
    let mut scene = Scene::new();
    let family = scene.add(species.attribute());
    let row = scene.add_to(family, Group)?;
    for (seed, x) in [(1, -4.0), (2, 4.0)] {
        let place = scene.add_to(row, Transform::translation(x, 0.0, 0.0))?;
        scene.add_to(place, Tree { seed: Seed::Explicit(seed) })?;
    }

    // A layer over the standard rules replaces one of them: that for the surface of stems.
    let rules = RuleSet::new().with(TimberRule).over(&sapwood::standard_rules());
    let view = scene.open_view(family, &rules)?;
    let list = scene.draw_list(view, 100_000)?;
    let path = folder.join("own_rule.glb");
    sapwood::io::write_glb(&path, &list)?;
    println!("{} meshes: {}", list.bodies.len(), path.display());
    Ok(())
}

/// Compiles stems into beams with four sides.
struct TimberRule;

impl Rule for TimberRule {
    type Component = StemSurface;
    type Data = ();
    const NAME: &'static str = "timber";

    fn init(&self, of: &StemSurface, cx: &mut Context<'_>) -> Result<(), RuleError> {
        let options = SweepOptions { base: Cap::Flat, ..SweepOptions::default() };
        let (square, mut sweep, mut mesh) = (Section::round(4), Sweep::default(), Mesh::default());
        for i in 0..of.stems.stems.len() {
            let segments = of.stems.segments_of(i);
            let foot = segments.first().map(|s| (s.frame.origin, s.radius_foot));
            let ends = segments.iter().map(|s| (s.end(), s.radius_end));
            let rings = foot.into_iter().chain(ends);
            let rings: Vec<_> = rings.map(|(center, radius)| Ring { center, radius }).collect();
            // The budget is asked before memory is taken, so that no species can exhaust it.
            let n_triangles = sweep.lay(&square, &rings, &options);
            cx.reserve_triangles(n_triangles as u64)?;
            sweep.write(&square, &mut mesh);
        }
        if !mesh.is_empty() {
            let oak = Material::matte("timber", 0.45, 0.28, 0.13);
            cx.mesh(SharedMesh::new(mesh), Arc::new(oak));
        }
        Ok(())
    }
}
