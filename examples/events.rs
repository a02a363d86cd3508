//! Events without a window: a script of picks and drags tends a small grove.
//!
//! `cargo run --example events [FOLDER]` tells what each event met and writes `events.glb`.

use std::error::Error;
use std::path::PathBuf;

use sapwood::geom::glam::Vec3;
use sapwood::geom::{Cap, Mesh, Ray, Ring, Section, Sweep, SweepOptions};
use sapwood::graph::{Material, PickOptions};
use sapwood::rules::weber_penn::{LeafParams, LeavesSlot, Seed, Tree};
use sapwood::scene::{Attribute, Group, HeldGeometry, Scene, Switch, Transform, ViewId};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).unwrap_or("target/examples-out".into());
    let folder = PathBuf::from(folder);
    std::fs::create_dir_all(&folder)?;

    // Three aspens, each behind a switch on a mound of earth.
    let species = sapwood::io::find_species("quaking_aspen")?;
    let mut scene = Scene::new();
    let grove = scene.add(Group);
    let mound = HeldGeometry::new(mound(), Material::matte("earth", 0.2, 0.13, 0.07));
    let mound = scene.add(mound);
    for (seed, x) in [(1, -8.0), (2, 0.0), (3, 8.0)] {
        let place = scene.add_to(grove, Transform::translation(x, 0.0, 0.0))?;
        let plot = scene.add_to(place, Group)?;
        scene.append(plot, mound)?;
        let shown = scene.add_to(plot, Switch { on: true })?;
        let family = scene.add_to(shown, species.attribute())?;
        scene.add_to(family, Tree { seed: Seed::Explicit(seed) })?;
    }
    let view = scene.open_view(grove, &sapwood::standard_rules())?;

    // What a mouse would do: from where to where, and the metres dragged upwards.
    let picks = [(-8.0, 0.0), (0.0, 0.0), (-8.0, 0.0), (8.0, 0.4), (30.0, 0.0)];
    for (x, up) in picks {
        let ray = Ray::new(Vec3::new(x, 0.3, 20.0), -Vec3::Z);
        println!("at {x:>4} m, {up} m up: {}", event(&mut scene, view, &ray, up)?);
    }
    let path = folder.join("events.glb");
    sapwood::io::write_glb(&path, &scene.draw_list(view, 1_000_000)?)?;
    println!("{}", path.display());
    Ok(())
}

/// A click fells the tree on the mound, or lets it grow again; a drag makes its leaves larger.
fn event(scene: &mut Scene, view: ViewId, ray: &Ray, up: f32) -> Result<String, Box<dyn Error>> {
    let Some(hit) = scene.pick(view, ray, &PickOptions::default())? else {
        return Ok("nothing".into());
    };
    // The mound is shared: which plot was meant, the path of the occurrence tells.
    let plot = scene.nearest::<Group>(view, &hit.path)?.ok_or("everything stands on a plot")?;
    let shown = scene.children(plot).find_map(|child| scene.handle::<Switch>(child));
    let shown = shown.ok_or("each plot has a switch")?;
    if up == 0.0 {
        let on = scene.edit(shown, |switch| {
            switch.on = !switch.on;
            switch.on
        })?;
        let word = if on { "grows" } else { "is felled" };
        return Ok(format!("a tree {word}, by its {} {:.1} m off", hit.kind, hit.distance));
    }
    let family = scene.children(shown).find_map(|child| scene.handle::<Attribute>(child));
    let family = family.ok_or("each tree has its species above it")?;
    let leaves = scene.get(family).and_then(|slots| slots.get::<LeavesSlot>());
    let mut leaves = LeafParams::clone(&*leaves.ok_or("each species has leaves")?);
    leaves.scale *= 1.0 + up;
    scene.push::<LeavesSlot>(family, leaves)?;
    Ok(format!("leaves are {:.0} % larger", up * 100.0))
}

/// A flat cone of earth, half a metre high.
fn mound() -> Mesh {
    let ring = |y, radius| Ring { center: Vec3::Y * y, radius };
    let options = SweepOptions { base: Cap::Flat, ..SweepOptions::default() };
    let (section, mut sweep, mut mesh) = (Section::round(16), Sweep::default(), Mesh::default());
    sweep.lay(&section, &[ring(0.0, 1.5), ring(0.5, 0.6)], &options);
    sweep.write(&section, &mut mesh);
    mesh
}
