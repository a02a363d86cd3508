//! One aspen from further and further away: what is left of it, and boards with images of it that
//! stand for it in the end, on one sheet.
//!
//! `cargo run --release --example fading [FOLDER]` writes `fading.png`. The tree is compiled once, and
//! its boards once; from one distance to the next nothing runs but the walk. Each picture is enlarged,
//! so that what fades can be seen.

use std::error::Error;
use std::ops::ControlFlow;
use std::path::PathBuf;

use sapwood::geom::glam::{Vec2, Vec3};
use sapwood::graph::{Eye, Lens};
use sapwood::picture::{
    ImpostorOptions, Impostors, Paper, PictureOptions, PlacedCamera, Sheet, Studio,
};
use sapwood::rules::weber_penn::{Seed, Tree};
use sapwood::scene::{Action, HeldImpostor, LevelOfDetail, Scene, Viewer, Viewpoint};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).unwrap_or("target/examples-out".into());
    let folder = PathBuf::from(folder);
    std::fs::create_dir_all(&folder)?;

    let mut scene = Scene::new();
    let family = scene.add(sapwood::io::find_species("quaking_aspen")?.attribute());
    scene.add_to(family, Tree { seed: Seed::Explicit(2) })?;
    let fading = scene.open_view(family, &sapwood::fading_rules())?;
    let middle = scene.bounds(fading)?.aabb.center();

    // The same tree with a level beyond: boards, made of what the view draws for no eye.
    let impostor = Impostors::new(ImpostorOptions::default())
        .of(&mut scene.supply(fading)?, &mut |_| ControlFlow::Continue(()))?;
    let levels = scene.add(LevelOfDetail { hysteresis: 0.1, ..LevelOfDetail::new([400.0]) });
    scene.append(levels, family)?;
    scene.add_to(levels, HeldImpostor { impostor })?;
    let with_boards = scene.open_view(levels, &sapwood::fading_rules())?;
    // Seen from afar, so that it is the boards that are compiled.
    scene.set_held::<Viewpoint>(with_boards, Some(Vec3::Z * 1200.0))?;
    scene.bounds(with_boards)?;
    scene.set_logging(true);

    let ranges = [5.0, 30.0, 60.0, 120.0, 240.0, 600.0, 1200.0].map(|range| (fading, range));
    let pictures: Vec<_> =
        ranges.into_iter().chain([600.0, 1200.0].map(|r| (with_boards, r))).collect();
    let caption = |(view, range): &(_, f32)| {
        format!("{range} m{}", if *view == with_boards { ", boards" } else { "" })
    };
    let captions: Vec<String> = pictures.iter().map(caption).collect();
    let size = [240, 320];
    let sheet = Sheet::new("Quaking aspen, fading", &captions, size, Paper::default());
    let mut sheet = sheet.ok_or("the sheet is too large")?;
    let options = PictureOptions { size, samples: 8, ..PictureOptions::default() };
    let towards = Vec3::new(0.0, 0.1, 1.0).normalize();
    for (number, (view, range)) in (0..).zip(pictures) {
        // The tree fades by where the viewer stands; the camera looks at it through a telescope, and
        // not from within where it is near.
        scene.set_moving::<Viewer>(view, Some(Eye::new(towards * range)))?;
        scene.set_held::<Viewpoint>(view, Some(towards * range))?;
        let list = scene.draw_list(view, 100_000)?;
        let lines: usize = list.placed_lines().map(|(_, row)| row.drawn().len()).sum();
        println!("{range} m: {} triangles, {lines} lines", list.n_vertices_and_triangles().1);

        let away = f32::max(range, 40.0);
        let vertical_angle = 2.0 * Vec2::new(away, 7.5).to_angle();
        let lens = Lens::Perspective { vertical_angle };
        let camera = PlacedCamera::look_at(lens, middle + towards * away, middle)?;
        let mut supply = scene.supply(view)?;
        let picture = Studio::new(&mut supply)
            .picture(&camera, &options, &mut |_| ControlFlow::Continue(()))?;
        sheet.put(number, &picture.image);
    }
    let log = scene.take_log();
    let compiled = log.iter().filter(|event| event.action == Action::Compiled).count();
    let path = folder.join("fading.png");
    sapwood::io::write_png(&path, sheet.image())?;
    println!("{}: {compiled} components compiled on the way", path.display());
    Ok(())
}
