//! Gradient noise on a lattice that closes round both ways, written over a whole grid at once.
//!
//! The noise crates tile by walking a torus in four dimensions, which takes sines and four times
//! the corners for each pixel. A lattice that is as long as the tile needs neither; taken row by
//! row its inner loop is a handful of products.

use std::f32::consts::{FRAC_1_SQRT_2, SQRT_2};

use glam::Vec2;
use sapwood_geom::Stream;

/// Sixteen directions evenly round: gradients need no more, and no sine.
const DIRECTIONS: [[f32; 2]; 4] = [
    [1.0, 0.0],
    [0.923_879_5, 0.382_683_43],
    [FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [0.382_683_43, 0.923_879_5],
];

/// Perlin's gradient noise reaches 1 / sqrt 2 in two dimensions.
const TO_UNIT: f32 = SQRT_2;

/// One octave of noise.
pub(crate) struct Lattice {
    cells: [usize; 2],
    /// A gradient for each corner, row by row.
    gradients: Vec<Vec2>,
}

/// Where a column or a row of pixels lies in the lattice.
#[derive(Clone, Copy)]
struct Place {
    /// From the cell's low side to the pixel's middle, in cells.
    from: f32,
    /// How much the cell's high side counts there.
    weight: f32,
}

/// The places of `n` pixels over `cells` cells, with the cell of each.
fn places(n: usize, cells: usize) -> impl Iterator<Item = (usize, Place)> {
    let step = cells as f32 / n as f32;
    (0..n).map(move |i| {
        let at = (i as f32 + 0.5) * step;
        let cell = (at as usize).min(cells - 1);
        let from = at - cell as f32;
        let weight = from * from * from * (from * (from * 6.0 - 15.0) + 10.0);
        (cell, Place { from, weight })
    })
}

impl Lattice {
    pub(crate) fn new(cells: [u32; 2], amplitude: f32, stream: &mut Stream) -> Self {
        let cells = cells.map(|n| n as usize);
        let scale = amplitude * TO_UNIT;
        let direction = |bits: u64| {
            let [x, y] = DIRECTIONS[(bits & 3) as usize];
            let along = Vec2::new(x, y) * scale;
            // A quarter turn for each of the next two bits' four values.
            match bits >> 2 & 3 {
                0 => along,
                1 => along.perp(),
                2 => -along,
                _ => -along.perp(),
            }
        };
        // Sixteen corners from each draw.
        let n = cells[0] * cells[1];
        let mut gradients = Vec::with_capacity(n);
        while gradients.len() < n {
            let bits = stream.bits();
            let more = (n - gradients.len()).min(16);
            gradients.extend((0..more).map(|i| direction(bits >> (4 * i))));
        }
        Self { cells, gradients }
    }

    /// Adds the noise to rows of `width` values.
    pub(crate) fn add_to(&self, width: usize, values: &mut [f32]) {
        let [nx, ny] = self.cells;
        // Columns of one cell are a run, over which the inner loop has no table to look into.
        let mut runs = vec![0usize; nx];
        let columns: Vec<Place> = places(width, nx)
            .map(|(cell, place)| {
                runs[cell] += 1;
                place
            })
            .collect();
        // Between two rows of corners the noise is, along each column of corners, a slope across
        // and an offset; the last repeats the first.
        let mut lines = vec![(0.0f32, 0.0f32); nx + 1];
        let rows = places(values.len() / width, ny);
        for (row, (cell, place)) in values.chunks_exact_mut(width).zip(rows) {
            let upper = &self.gradients[cell * nx..][..nx];
            let lower = &self.gradients[(cell + 1) % ny * nx..][..nx];
            for ((line, a), b) in lines.iter_mut().zip(upper).zip(lower) {
                let slope = a.x + (b.x - a.x) * place.weight;
                let (from_a, from_b) = (a.y * place.from, b.y * (place.from - 1.0));
                *line = (slope, from_a + (from_b - from_a) * place.weight);
            }
            lines[nx] = lines[0];
            let mut done = 0;
            for (n, two) in runs.iter().zip(lines.windows(2)) {
                let (a, b) = (two[0], two[1]);
                let run = done..done + n;
                done += n;
                for (value, column) in row[run.clone()].iter_mut().zip(&columns[run]) {
                    let from_a = a.0 * column.from + a.1;
                    let from_b = b.0 * (column.from - 1.0) + b.1;
                    *value += from_a + (from_b - from_a) * column.weight;
                }
            }
        }
    }
}
