//! Five trees of one family: one species above them, five seeds, one file.
//!
//! `cargo run --example tree_family [FOLDER]` writes `tree_family.glb` and, for each tree, a text
//! that tells all that it was compiled to.

use std::error::Error;
use std::path::PathBuf;

use sapwood::rules::weber_penn::{Seed, Tree};
use sapwood::scene::{Action, Group, Scene, Transform};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).unwrap_or("target/examples-out".into());
    let folder = PathBuf::from(folder);
    std::fs::create_dir_all(&folder)?;

    // The family: the species is set once, above a row of five individuals.
    let species = sapwood::io::find_species("quaking_aspen")?;
    let mut scene = Scene::new();
    let family = scene.add(species.attribute());
    let row = scene.add_to(family, Group)?;
    let mut places = Vec::new();
    for i in 0..5u8 {
        let place = scene.add_to(row, Transform::translation(9.0 * f32::from(i), 0.0, 0.0))?;
        scene.add_to(place, Tree { seed: Seed::Explicit(i.into()) })?;
        places.push(place);
    }

    // All of it as one file.
    let rules = sapwood::standard_rules();
    let view = scene.open_view(family, &rules)?;
    let list = scene.draw_list(view, 100_000)?;
    let (vertices, triangles) = list.n_vertices_and_triangles();
    let path = folder.join("tree_family.glb");
    sapwood::io::write_glb(&path, &list)?;
    println!("{}: {vertices} vertices, {triangles} triangles", path.display());

    // Each tree by itself, as text. It stands in the row and under a second attribute that says
    // the same, so what the row was compiled to serves here too; only that attribute is new.
    scene.set_logging(true);
    for (i, place) in places.into_iter().enumerate() {
        let alone = scene.add(species.attribute());
        scene.append(alone, place)?;
        let view = scene.open_view(alone, &rules)?;
        let text = scene.dump(view, 10_000)?;
        let path = folder.join(format!("tree_family_{i}.txt"));
        std::fs::write(&path, &text)?;

        let height = scene.bounds(view)?.aabb.max.y;
        let counts = scene.count(view)?;
        let (stems, leaves) = (counts.parts_of("stem"), counts.parts_of("leaf"));
        let events = scene.take_log();
        let compiled = events.iter().filter(|event| event.action == Action::Compiled).count();
        println!(
            "{}: {} lines; {height:.1} m high, {stems} stems, {leaves} leaves; {compiled} compiled",
            path.display(),
            text.lines().count()
        );
        if i == 0 {
            text.lines().take(12).for_each(|line| println!("    {line}"));
        }
    }
    Ok(())
}
