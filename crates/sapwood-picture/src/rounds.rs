//! Rounds: tiles of pixels side by side; then what rays wait for is filled, and the pixels that
//! waited are tried again.

use std::ops::ControlFlow;

use rayon::prelude::*;
use sapwood_geom::Image;
use sapwood_graph::{Interrupted, Provide};

use crate::camera::Gaze;
use crate::film::Encoding;
use crate::shade::Shader;
use crate::trace::MOST_CLUSTERS;
use crate::world::World;
use crate::{Picture, PictureError, PictureOptions, Progress, RayCounts};

/// Pixels along the edge of a tile.
const TILE: u32 = 16;

/// Tiles between two calls of the progress, at most.
const BATCH: usize = 128;

/// Rays from the camera between two calls of the progress, as long as no thread is idle for it.
const BATCH_RAYS: u64 = 1 << 17;

/// Pixels that are not finished.
struct Tile {
    pixels: Vec<[u32; 2]>,
}

/// What became of a tile.
struct Outcome {
    finished: Vec<([u32; 2], [u8; 4])>,
    /// Pixels whose rays wait.
    rest: Tile,
    waits: Vec<u32>,
    rays: RayCounts,
    is_too_much: bool,
}

/// Takes a picture.
pub(crate) fn picture(
    provide: &mut dyn Provide,
    world: &mut World,
    gaze: &Gaze,
    options: &PictureOptions,
    progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Result<Picture, PictureError> {
    let [width, height] = options.size;
    let n_pixels = u64::from(width) * u64::from(height);
    let n_filled_before = world.n_filled;
    let mut image = Image { width, height, pixels: vec![[0; 4]; n_pixels as usize] };
    let mut rays = RayCounts::default();
    let encoding = Encoding::new();
    let mut tiles = tiles(options.size);
    let mut n_done = 0;
    while !tiles.is_empty() {
        let mut waits = Vec::new();
        let mut rest = Vec::new();
        for batch in tiles.chunks(batch_size(options.samples)) {
            let n_filled = world.n_filled - n_filled_before;
            if progress(&Progress { n_done, n_pixels, n_filled }).is_break() {
                return Err(Interrupted::Cancelled.into());
            }
            let shared = &*world;
            let outcomes: Vec<Outcome> = batch
                .par_iter()
                .map(|tile| traced(tile, shared, gaze, options, &encoding))
                .collect();
            for outcome in outcomes {
                if outcome.is_too_much {
                    return Err(too_much(provide).into());
                }
                for ([x, y], pixel) in &outcome.finished {
                    image.pixels[(y * width + x) as usize] = *pixel;
                }
                n_done += outcome.finished.len() as u64;
                waits.extend(outcome.waits);
                rays += outcome.rays;
                rest.extend((!outcome.rest.pixels.is_empty()).then_some(outcome.rest));
            }
        }
        waits.sort_unstable();
        waits.dedup();
        if !waits.is_empty() {
            world.fill(provide, &waits)?;
        }
        tiles = rest;
    }
    let n_filled = world.n_filled - n_filled_before;
    // Whoever follows learns of the end, and can no longer stop it.
    let _ = progress(&Progress { n_done, n_pixels, n_filled });
    Ok(Picture { image, rays, n_filled })
}

/// A ray goes through more than it may.
pub(crate) fn too_much(provide: &dyn Provide) -> Interrupted {
    Interrupted::Exhausted {
        what: "shared parts along one ray",
        limit: u64::from(MOST_CLUSTERS),
        component: provide.plan(provide.root().1).kind.name(),
    }
}

/// Tiles between two calls of the progress. Many samples take long, and whoever wants to stop does
/// not want to wait.
fn batch_size(samples: u32) -> usize {
    let tile = u64::from(TILE * TILE) * u64::from(samples);
    let busy = 2 * rayon::current_num_threads();
    ((BATCH_RAYS / tile) as usize).clamp(busy.min(BATCH), BATCH)
}

/// The tiles of a picture, row by row.
fn tiles([width, height]: [u32; 2]) -> Vec<Tile> {
    let corners = (0..height.div_ceil(TILE))
        .flat_map(|row| (0..width.div_ceil(TILE)).map(move |column| (column * TILE, row * TILE)));
    let tile = |(left, top): (u32, u32)| {
        let rows = top..(top + TILE).min(height);
        let pixels =
            rows.flat_map(|y| (left..(left + TILE).min(width)).map(move |x| [x, y])).collect();
        Tile { pixels }
    };
    corners.map(tile).collect()
}

fn traced(
    tile: &Tile,
    world: &World,
    gaze: &Gaze,
    options: &PictureOptions,
    encoding: &Encoding,
) -> Outcome {
    let rays = RayCounts::default();
    let mut shader = Shader { world, options, gaze, rays, waits: Vec::new(), is_too_much: false };
    let (mut finished, mut rest) = (Vec::with_capacity(tile.pixels.len()), Vec::new());
    for pixel in &tile.pixels {
        match shader.pixel(*pixel) {
            Some(sum) => {
                finished.push((*pixel, encoding.pixel(sum, options.samples, options.exposure)));
            }
            None => rest.push(*pixel),
        }
    }
    let Shader { rays, mut waits, is_too_much, .. } = shader;
    waits.sort_unstable();
    waits.dedup();
    Outcome { finished, rest: Tile { pixels: rest }, waits, rays, is_too_much }
}

impl std::ops::AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        self.primary += other.primary;
        self.shadow += other.shadow;
        self.sky += other.sky;
        self.reflected += other.reflected;
    }
}
