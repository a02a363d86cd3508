//! Built-in components one by one: each on its own and under sharing, and what ran after edits.

mod connections;
mod fades;
mod heavy;
mod kits;
mod levels;
mod pushes;
mod value_graphs;
mod what_moves;
mod what_shows;

use sapwood::scene::{Scene, ViewId};

/// The sizes of all triangles that a view draws, in order.
fn sizes(scene: &mut Scene, view: ViewId) -> Vec<f32> {
    let list = scene.draw_list(view, 1000).unwrap();
    list.placed_rows().map(|(_, row)| row.mesh.positions[1].x).collect()
}

/// The origins of all meshes that a view draws, in order.
fn places(scene: &mut Scene, view: ViewId) -> Vec<[f32; 3]> {
    let list = scene.draw_list(view, 1000).unwrap();
    list.placed_rows().map(|(world, _)| world.translation.to_array()).collect()
}

/// What could not be compiled: kinds and words.
fn errors(scene: &mut Scene, view: ViewId) -> Vec<(&'static str, String)> {
    let found = scene.diagnostics(view, 100).unwrap();
    found.into_iter().map(|(_, found)| (found.kind.name(), found.message)).collect()
}
