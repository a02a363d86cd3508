//! A picture of every built-in species, all of them on one sheet, and figures of what parameters
//! do, each in the same light.
//!
//! `cargo run --release --example gallery` writes them at full size to `docs/gallery`, where
//! `docs/gallery.md` shows them; with a folder as its argument it writes small ones there.

use std::error::Error;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use sapwood::geom::Image;
use sapwood::geom::glam::Vec3;
use sapwood::graph::Lens;
use sapwood::picture::{Ground, Paper, Picture, PictureOptions, PlacedCamera, Sheet, Studio, Sun};
use sapwood::scene::Viewer;

#[path = "gallery/figures.rs"]
mod figures;

use figures::Figure;

/// How much smaller pictures are on the sheet.
const SMALLER: u32 = 6;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).map(PathBuf::from);
    let (size, samples) = if folder.is_none() { ([360, 448], 32) } else { ([48, 60], 2) };
    let full = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/gallery");
    let folder = folder.unwrap_or_else(full);
    std::fs::create_dir_all(&folder)?;

    let names: Vec<String> = sapwood::io::built_in_names().map(str::to_owned).collect();
    let sheet = Sheet::new("", &names, size.map(|pixels| pixels / SMALLER), Paper::default());
    let mut sheet = sheet.ok_or("a sheet for so many pictures is too large")?;
    for (number, name) in (0..).zip(&names) {
        let image = drawn(&Figure::of_species(name)?, &folder, size, samples)?;
        sheet.put(number, &shrunk(&image));
    }
    let path = folder.join("species.png");
    sapwood::io::write_png(&path, sheet.image())?;
    println!("{}: {} species", path.display(), names.len());
    let figures = figures::of_the_thesis()?.into_iter().chain([figures::beyond_the_paper()?]);
    for figure in figures {
        let [width, height] = size;
        drawn(&figure, &folder, [width * 3 / 2, height * 3 / 4], samples)?;
    }
    Ok(())
}

/// Draws a figure to its file, and gives the picture as it was at first.
fn drawn(
    figure: &Figure,
    folder: &Path,
    size: [u32; 2],
    samples: u32,
) -> Result<Image, Box<dyn Error>> {
    let Picture { image, rays, .. } = picture(figure, size, samples)?;
    let path = folder.join(format!("{}.png", figure.name));
    sapwood::io::write_png(&path, &image)?;
    // Leaves are hard to compress: what takes much room is drawn a little smaller.
    let mut smaller = size;
    while std::fs::metadata(&path)?.len() > 190_000 {
        smaller = smaller.map(|pixels| pixels - pixels / 20);
        sapwood::io::write_png(&path, &picture(figure, smaller, samples)?.image)?;
    }
    println!("{}: {} rays through pixels", path.display(), rays.primary);
    Ok(image)
}

/// Trees on the ground, seen from in front.
fn picture(figure: &Figure, size: [u32; 2], samples: u32) -> Result<Picture, Box<dyn Error>> {
    let (mut scene, row) = figure.planted()?;
    let view = scene.open_view(row, &sapwood::standard_rules())?;

    // What would be below the ground is not seen.
    let mut bounds = scene.bounds(view)?.aabb;
    bounds.min.y = bounds.min.y.max(0.0);
    let lens = Lens::Perspective { vertical_angle: 0.4 };
    let camera = PlacedCamera::fit(&bounds, Vec3::new(0.0, 0.07, 1.0), lens, size, 0.06)?;
    // A bright sun behind whoever looks: crowns are dark by nature.
    let sun = Sun { toward: Vec3::new(-0.5, 0.7, 0.8), color: [4.8, 4.4, 3.9], radius: 0.03 };
    let ground = Ground { height: 0.0, color: [0.19, 0.19, 0.11] };
    let (sun, ground) = (Some(sun), Some(ground));
    let options = PictureOptions { size, samples, sun, ground, ..PictureOptions::default() };
    scene.set_moving::<Viewer>(view, Some(camera.eye()))?;
    let mut supply = scene.supply(view)?;
    let mut go_on = |_: &_| ControlFlow::Continue(());
    Ok(Studio::new(&mut supply).picture(&camera, &options, &mut go_on)?)
}

/// The picture as it stands on the sheet: the mean of a square of pixels each.
fn shrunk(image: &Image) -> Image {
    const N: u32 = SMALLER * SMALLER;
    Image::from_fn(image.width / SMALLER, image.height / SMALLER, |x, y| {
        let row = |i: u32| SMALLER * y + i / SMALLER;
        let at = |i: u32| row(i) * image.width + SMALLER * x + i % SMALLER;
        let mean = |channel: usize| {
            let sum: u32 = (0..N).map(|i| u32::from(image.pixels[at(i) as usize][channel])).sum();
            (sum / N) as u8
        };
        [0, 1, 2, 3].map(mean)
    })
}
