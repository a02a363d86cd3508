//! An aspen in the wind: what moves from further and further away, and a file that plays it.
//!
//! `cargo run --release --example wind [FOLDER]` writes `wind.glb`, a loop of six seconds for any
//! viewer. The tree is compiled once; from one moment to the next only its joints turn.

use std::error::Error;
use std::path::PathBuf;

use sapwood::geom::glam::Vec3;
use sapwood::graph::{Eye, Poses, Wind};
use sapwood::io::{FileSet, SwayAnimation};
use sapwood::rules::weber_penn::{Seed, Tree};
use sapwood::scene::{Action, Scene, Time, Viewer, WindSlot};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).unwrap_or("target/examples-out".into());
    let folder = PathBuf::from(folder);
    std::fs::create_dir_all(&folder)?;

    // Under these rules trees are drawn at rest, with joints. The wind, the time and the viewer
    // move: nothing is compiled for them.
    let mut scene = Scene::new();
    let family = scene.add(sapwood::io::find_species("quaking_aspen")?.attribute());
    scene.add_to(family, Tree { seed: Seed::Explicit(2) })?;
    let view = scene.open_view(family, &sapwood::swaying_rules())?;
    let wind = Wind::new(4.0, 2.0);
    scene.set_moving::<WindSlot>(view, wind)?;
    let list = scene.draw_list(view, 100_000)?;
    let mut poses = Poses::new(&list);
    scene.set_logging(true);

    // An engine would hand the poses of each picture to its shaders, beside the meshes and the
    // joints' numbers, which it has from the list once and for all.
    for distance in [10.0, 100.0, 1e3, 1e4, 1e5] {
        scene.set_moving::<Viewer>(view, Some(Eye::new(Vec3::X * distance)))?;
        let mut farthest = 0.0f32;
        let mut n_joints = 0;
        for picture in 0..60 {
            scene.set_moving::<Time>(view, f64::from(picture) / 60.0)?;
            n_joints = scene.sway(view, &mut poses)?.n_joints;
            let top = Vec3::Y * 13.0;
            let moved = poses.of(0).into_iter().flatten().map(|at| at.transform_point3(top));
            farthest = moved.map(|at| at.distance(top)).fold(farthest, f32::max);
        }
        println!(
            "from {distance} m {n_joints} joints turn, and carry things up to {farthest:.2} m"
        );
    }
    let compiled = scene.take_log().iter().filter(|e| e.action == Action::Compiled).count();
    println!("{compiled} components were compiled for 300 pictures");

    // Files hold a loop: everything sways a whole number of times in it.
    let path = folder.join("wind.glb");
    let mut files = FileSet::new();
    let swayed = files.add_swaying_glb(&path, &list, &SwayAnimation::new(wind, 6.0))?;
    files.commit()?;
    println!("{}: {} joints; {} more are rigid", path.display(), swayed.n_joints, swayed.n_rigid);
    Ok(())
}
