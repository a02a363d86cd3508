//! How like its tree a billboard is, for every built-in species.
//!
//! From 600 m, level, from 8 sides, through a telescope: by how many percent the covered pixels and
//! the mean colour's worst channel differ from the tree's at most. *112 rows* and *20 rows*: so
//! high is the larger of the tree's extents in the picture; 20 rows are what 14 m have there in a
//! picture of 1000 rows that shows 60 degrees. *even*: boards and trees in white light from all
//! sides, boards taken by `ImpostorLight::Even`.
//!
//! *A degree on*: what changes in a picture of 20 rows when boards are seen from a degree further
//! round, at most: the same two, and how much of what is covered is so before or after alone
//! (*moved*). Beside it what moves when the tree itself is seen from a degree further, and from
//! 22.5, as far as boards are apart: so much would move at once where one took the place of the
//! next.
//!
//! Names of species after `--` take these alone; a number is the seed, else 1.

use std::f32::consts::TAU;
use std::ops::ControlFlow;

use sapwood::geom::Image;
use sapwood::geom::glam::{Vec2, Vec3};
use sapwood::graph::Lens;
use sapwood::picture::{
    Background, ImpostorLight, ImpostorOptions, Impostors, PictureOptions, PlacedCamera, Sky,
    Studio,
};
use sapwood::rules::weber_penn::{Seed, Tree};
use sapwood::scene::{HeldImpostor, Scene, ViewId, Viewer};

/// Metres from the eye to the tree.
const AWAY: f32 = 600.0;

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let seed = wanted.iter().find_map(|word| word.parse().ok()).unwrap_or(1);
    let names: Vec<&String> = wanted.iter().filter(|word| word.parse::<u64>().is_err()).collect();
    println!(
        "| species | 112 rows: covered, colour | 20 rows | even, 112 rows | even, 20 rows | \
         a degree on: covered, colour, moved | the tree: moved, by 22.5° |"
    );
    for name in sapwood::io::built_in_names() {
        if names.is_empty() || names.iter().any(|wanted| **wanted == *name) {
            println!("| `{name}` | {} |", row(name, seed));
        }
    }
}

/// A view of something, as pictures see it.
struct Shown {
    scene: Scene,
    view: ViewId,
    center: Vec3,
    /// The larger of its extents.
    metres: f32,
}

/// What is seen of it.
struct Seen {
    image: Image,
    covered: f64,
    color: [f64; 3],
}

fn row(name: &str, seed: u64) -> String {
    let species = sapwood::io::find_species(name).expect("the species is built in");
    let mut scene = Scene::new();
    let family = scene.add(species.attribute());
    let tree = Tree { seed: Seed::Explicit(seed) };
    scene.add_to(family, tree).expect("an attribute has no other child");
    let view = scene.open_view(family, &sapwood::standard_rules()).expect("the family is there");
    let aabb = scene.bounds(view).expect("nobody interrupts").aabb;
    let (center, metres) = (aabb.center(), aabb.size().max_element());
    let mut tree = Shown { scene, view, center, metres };
    let light = ImpostorOptions::default().light;
    let mut baked = tree.board(light);
    let mut even = tree.board(ImpostorLight::Even);
    let sides: Vec<f32> = (0..8).map(|side| (TAU / 8.0 + 0.02) * side as f32).collect();
    let mut cells = Vec::new();
    for (board, light) in [(&mut baked, light), (&mut even, ImpostorLight::Even)] {
        for rows in [112, 20] {
            let differences = sides
                .iter()
                .map(|side| board.seen(*side, rows, light).differs(&tree.seen(*side, rows, light)));
            let [covered, color, _] = differences.fold([0.0; 3], larger);
            cells.push(format!("{covered:.1} %, {color:.1} %"));
        }
    }
    let degrees = (0..=90).map(|degree| baked.seen(TAU / 360.0 * degree as f32, 20, light));
    let degrees: Vec<Seen> = degrees.collect();
    let changes = degrees.windows(2).map(|pair| pair[1].differs(&pair[0]));
    let [covered, color, moved] = changes.fold([0.0; 3], larger);
    cells.push(format!("{covered:.1} %, {color:.1} %, {moved:.1} %"));
    let [one, board] = [TAU / 360.0, TAU / 16.0].map(|by| {
        let differences = sides
            .iter()
            .map(|side| tree.seen(*side + by, 20, light).differs(&tree.seen(*side, 20, light)));
        differences.fold([0.0; 3], larger)[2]
    });
    cells.push(format!("{one:.1} %, {board:.1} %"));
    cells.join(" | ")
}

fn larger(one: [f64; 3], other: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| one[i].max(other[i]))
}

impl Shown {
    /// Boards that stand for it.
    fn board(&mut self, light: ImpostorLight) -> Self {
        let options = ImpostorOptions { light, ..ImpostorOptions::default() };
        let mut supply = self.scene.supply(self.view).expect("the view is open");
        let made = Impostors::new(options).of(&mut supply, &mut |_| ControlFlow::Continue(()));
        let mut scene = Scene::new();
        let held = scene.add(HeldImpostor { impostor: made.expect("there is something to see") });
        let view = scene.open_view(held, &sapwood::standard_rules()).expect("it is there");
        Self { scene, view, center: self.center, metres: self.metres }
    }

    /// What is seen of it from a side, in this light, so many rows high.
    fn seen(&mut self, side: f32, rows: u32, light: ImpostorLight) -> Seen {
        let (sine, cosine) = side.sin_cos();
        let eye = self.center + AWAY * Vec3::new(sine, 0.0, cosine);
        let size = [rows * 8 / 7, rows * 8 / 7];
        let reach = 0.5 * self.metres * size[0] as f32 / rows as f32;
        let vertical_angle = 2.0 * Vec2::new(AWAY, reach).to_angle();
        let lens = Lens::Perspective { vertical_angle };
        let camera = PlacedCamera::look_at(lens, eye, self.center).expect("it is far away");
        let samples = if rows < 64 { 128 } else { 8 };
        let options = PictureOptions { size, samples, ..PictureOptions::default() };
        let options = PictureOptions { background: Background::Transparent, ..options };
        let options = match light {
            ImpostorLight::Baked { sun, sky } => PictureOptions { sun, sky, ..options },
            ImpostorLight::Even => {
                PictureOptions { sun: None, sky: Sky::even([1.0; 3]), ..options }
            }
        };
        self.scene.set_moving::<Viewer>(self.view, Some(camera.eye())).expect("it is a view");
        let mut supply = self.scene.supply(self.view).expect("the view is open");
        let taken =
            Studio::new(&mut supply).picture(&camera, &options, &mut |_| ControlFlow::Continue(()));
        Seen::new(taken.expect("nobody interrupts").image)
    }
}

impl Seen {
    fn new(image: Image) -> Self {
        let linear = |byte: u8| {
            let encoded = f64::from(byte) / 255.0;
            if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
        };
        let (mut covered, mut light) = (0.0, [0.0; 3]);
        for [r, g, b, a] in &image.pixels {
            let share = f64::from(*a) / 255.0;
            covered += share;
            light.iter_mut().zip([r, g, b]).for_each(|(sum, byte)| *sum += share * linear(*byte));
        }
        Self { image, covered, color: light.map(|sum| sum / covered) }
    }

    /// By how many percent the covered pixels, and the worst channel of the mean colour, differ
    /// from another's, and how many percent of what is covered lies elsewhere.
    fn differs(&self, from: &Self) -> [f64; 3] {
        let off = |a: f64, b: f64| 100.0 * (a / b - 1.0).abs();
        let color = (0..3).map(|i| off(self.color[i], from.color[i])).fold(0.0, f64::max);
        let pixels = self.image.pixels.iter().zip(&from.image.pixels);
        let elsewhere: f64 = pixels.map(|(one, other)| f64::from(one[3].abs_diff(other[3]))).sum();
        let moved = 100.0 * elsewhere / 255.0 / (self.covered + from.covered);
        [off(self.covered, from.covered), color, moved]
    }
}
