//! A foreign traversal joined with foreign components, neither of which knows the other.
//!
//! `cargo run --example joined` weighs a garden of stone. The crate `weighing` knows no
//! component, the crate `masonry` no traversal (see `examples/foreign`); the handlers below are
//! all that joins them, one in each of the three forms.

use std::error::Error;

use masonry::{Block, Column, Ruin, Solid, Wall};
use sapwood::geom::glam::{Affine3, Vec3};
use sapwood::graph::Handlers;
use sapwood::scene::{Group, Scene, Transform};
use weighing::{Scales, weigh};

/// Kilograms in a cubic metre: of walls, with their mortar, and of columns, without.
const LIMESTONE: f64 = 2300.0;
const GRANITE: f64 = 2700.0;

fn main() -> Result<(), Box<dyn Error>> {
    let mut scene = Scene::new();
    let garden = scene.add(Group);
    let wall = Wall { length: 6.0, height: 1.5 };
    scene.add_to(garden, wall.clone())?;
    scene.add_to(garden, Ruin { of: wall })?;
    // One column in three places, once at twice its size.
    let column = scene.add(Column { height: 3.0, radius: 0.2 });
    for (x, scale) in [(0.0, 1.0), (2.0, 1.0), (4.0, 2.0)] {
        let place =
            Affine3::from_translation(Vec3::X * x) * Affine3::from_scale(Vec3::splat(scale));
        let place = scene.add_to(garden, Transform(place))?;
        scene.append(place, column)?;
    }

    let handlers = Handlers::<Scales>::new()
        // Exact: for whatever has just these data. Serves the wall.
        .on_plan::<Block>(|scales, block, at| scales.put(block.cubic_metres(), LIMESTONE, at))
        // An interface: for whatever a rule offers as that. Serves the column, and the wall if
        // there were no handler for it.
        .on_interface::<dyn Solid>(|scales, solid, at| {
            scales.put(solid.cubic_metres(), GRANITE, at)
        })
        // The fallback of a kind: its owner tells what may stand in. Serves the ruin, as a block.
        .with_fallbacks(&masonry::fallbacks());

    let rules = masonry::rules().over(&sapwood::standard_rules());
    let view = scene.open_view(garden, &rules)?;
    let scales = weigh(&mut scene, view, &handlers)?;
    for (kind, kilograms) in scales.kilograms() {
        println!("{kind:>8} {kilograms:>9.0} kg");
    }
    let total: f64 = scales.kilograms().map(|(_, kilograms)| kilograms).sum();
    println!("{:>8} {total:>9.0} kg", "all");
    Ok(())
}
