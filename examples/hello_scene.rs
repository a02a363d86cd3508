//! A first scene: a gate of stones that all share one mesh, looked at, changed, looked at again.
//!
//! `cargo run --example hello_scene [FOLDER]` writes `hello_scene.glb`.

use std::error::Error;
use std::path::PathBuf;

use sapwood::geom::glam::{Affine3, Quat, Vec3};
use sapwood::geom::{Cap, Mesh, Ring, Section, Sweep, SweepOptions};
use sapwood::graph::Material;
use sapwood::scene::{Action, Group, HeldGeometry, Scene, Transform};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).unwrap_or("target/examples-out".into());
    let folder = PathBuf::from(folder);
    std::fs::create_dir_all(&folder)?;

    // What is there: one group, one stone, and a transform for each place where it stands.
    let mut scene = Scene::new();
    let gate = scene.add(Group);
    let granite = Material::matte("granite", 0.35, 0.34, 0.33);
    let stone = scene.add(HeldGeometry::new(stone(), granite));
    for x in [-1.2, 1.2] {
        let place = scene.add_to(gate, Transform::translation(x, 0.9, 0.0))?;
        scene.append(place, stone)?;
    }
    let lintel = scene.add_to(gate, Transform(lying(2.6)))?;
    scene.append(lintel, stone)?;

    // How it looks: a view compiles what a traversal reaches.
    scene.set_logging(true);
    let view = scene.open_view(gate, &sapwood::standard_rules())?;
    println!("The gate is {:.2} m wide, high and deep.\n", scene.bounds(view)?.aabb.size());
    println!("As text:\n{}", scene.dump(view, 20)?);
    tell_compiled(&mut scene, "at first");

    // The stone stands at three places and was compiled once. After an edit, only what the
    // edit concerns is compiled again.
    scene.edit(lintel, |place| *place = Transform(lying(2.1)))?;
    println!("\nAfter the edit it is {:.2} m high.", scene.bounds(view)?.aabb.size().y);
    tell_compiled(&mut scene, "after the edit");

    // Gates can stand in other gates, but an edge that would close a cycle is refused.
    let gates = scene.add(Group);
    scene.append(gates, gate)?;
    if let Err(refusal) = scene.append(gate, gates) {
        println!("\nRefused: {refusal}.");
    }

    let path = folder.join("hello_scene.glb");
    sapwood::io::write_glb(&path, &scene.draw_list(view, 1_000)?)?;
    println!("\nWritten to {}", path.display());
    Ok(())
}

/// The transform that lays a stone across, `height` metres up.
fn lying(height: f32) -> Affine3 {
    let turn = Quat::from_rotation_z(std::f32::consts::FRAC_PI_2);
    let longer = Vec3::new(1.0, 1.8, 1.0);
    Affine3::from_scale_rotation_translation(longer, turn, Vec3::new(0.0, height, 0.0))
}

fn tell_compiled(scene: &mut Scene, when: &str) {
    let events = scene.take_log();
    let compiled = events.iter().filter(|event| event.action == Action::Compiled);
    let kinds: Vec<_> = compiled.map(|event| event.kind.name()).collect();
    println!("Compiled {when}: {}", kinds.join(", "));
}

/// A round stone standing on its end, about the origin.
fn stone() -> Mesh {
    let rings = [Vec3::Y * -0.9, Vec3::Y * 0.9].map(|center| Ring { center, radius: 0.3 });
    let (section, mut sweep, mut mesh) = (Section::round(24), Sweep::default(), Mesh::default());
    sweep.lay(&section, &rings, &SweepOptions { base: Cap::Flat, ..SweepOptions::default() });
    sweep.write(&section, &mut mesh);
    mesh
}
