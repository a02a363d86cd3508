//! One aspen from further and further away: what is left of it, on one sheet.
//!
//! `cargo run --release --example fading [FOLDER]` writes `fading.png`. The tree is compiled once; from
//! one distance to the next nothing runs but the walk. Each picture is enlarged, so that what fades
//! can be seen.

use std::error::Error;
use std::ops::ControlFlow;
use std::path::PathBuf;

use sapwood::geom::glam::{Vec2, Vec3};
use sapwood::graph::{Eye, Lens};
use sapwood::picture::{Paper, PictureOptions, PlacedCamera, Sheet, Studio, Sun};
use sapwood::rules::weber_penn::{Seed, Tree};
use sapwood::scene::{Action, Scene, Viewer};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).unwrap_or("target/examples-out".into());
    let folder = PathBuf::from(folder);
    std::fs::create_dir_all(&folder)?;

    let mut scene = Scene::new();
    let family = scene.add(sapwood::io::find_species("quaking_aspen")?.attribute());
    scene.add_to(family, Tree { seed: Seed::Explicit(2) })?;
    let view = scene.open_view(family, &sapwood::fading_rules())?;
    let middle = scene.bounds(view)?.aabb.center();
    scene.set_logging(true);

    let ranges = [5.0, 30.0, 60.0, 120.0, 240.0, 600.0, 1200.0];
    let captions: Vec<String> = ranges.iter().map(|range| format!("{range} m")).collect();
    let size = [240, 320];
    let sheet = Sheet::new("Quaking aspen, fading", &captions, size, Paper::default());
    let mut sheet = sheet.ok_or("the sheet is too large")?;
    let options = PictureOptions {
        size,
        samples: 8,
        sun: Some(Sun::default()),
        line_color: [0.1, 0.08, 0.06],
        ..PictureOptions::default()
    };
    let towards = Vec3::new(0.0, 0.1, 1.0).normalize();
    for (number, range) in (0..).zip(ranges) {
        // The tree fades by where the viewer stands; the camera looks at it through a telescope, and
        // not from within where it is near.
        scene.set_moving::<Viewer>(view, Some(Eye::new(towards * range)))?;
        let list = scene.draw_list(view, 100_000)?;
        let lines: usize = list.placed_lines().map(|(_, row)| row.drawn().len()).sum();
        println!("{range} m: {} triangles, {lines} lines", list.n_vertices_and_triangles().1);

        let away = f32::max(range, 40.0);
        let angle = 2.0 * Vec2::new(away, 7.5).to_angle();
        let camera =
            PlacedCamera::look_at(lens(angle.to_degrees()), middle + towards * away, middle)?;
        let mut supply = scene.supply(view)?;
        let mut studio = Studio::new(&mut supply);
        let picture = studio.picture(&camera, &options, &mut |_| ControlFlow::Continue(()))?;
        sheet.put(number, &picture.image);
    }
    let events = scene.take_log();
    let compiled = events.iter().filter(|event| event.action == Action::Compiled).count();
    let path = folder.join("fading.png");
    sapwood::io::write_png(&path, sheet.image())?;
    println!("{}: {compiled} components compiled on the way", path.display());
    Ok(())
}

fn lens(degrees: f32) -> Lens {
    Lens::Perspective { vertical_angle: degrees.to_radians() }
}
