//! Numbers over the unit square that repeat beyond it: what images are made of before they have
//! colours.

use crate::lattice::Lattice;
use sapwood_geom::Stream;

/// A grid of numbers, row by row from the top, that continues where it ends: right of the last
/// column stands the first, below the last row the first.
#[derive(Clone, Debug)]
pub(crate) struct Field {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

impl Field {
    /// A field of zeros.
    pub(crate) fn new(width: u32, height: u32) -> Self {
        let (width, height) = (width as usize, height as usize);
        Self { width, height, values: vec![0.0; width * height] }
    }

    /// Gradient noise of several octaves: `cells` of it across and down in the first, twice as
    /// many and half as strong in each that follows. Values lie about 0, seldom beyond 1.
    pub(crate) fn noise(
        [width, height]: [u32; 2],
        cells: [u32; 2],
        octaves: u32,
        stream: &mut Stream,
    ) -> Self {
        let mut field = Self::new(width, height);
        let (mut cells, mut amplitude) = (cells, 1.0);
        for _ in 0..octaves {
            field.add_noise(cells, amplitude, stream);
            // What is finer than two pixels to the cell would be seen as grain of another kind.
            cells = cells.map(|n| n.saturating_mul(2));
            if cells[0] * 2 > width && cells[1] * 2 > height {
                break;
            }
            amplitude *= 0.5;
        }
        field
    }

    /// Adds one octave of gradient noise, which draws its whole lattice from the stream.
    pub(crate) fn add_noise(&mut self, cells: [u32; 2], amplitude: f32, stream: &mut Stream) {
        let limit = |n: u32, size: usize| n.clamp(1, (size as u32).max(1));
        let cells = [limit(cells[0], self.width), limit(cells[1], self.height)];
        let lattice = Lattice::new(cells, amplitude, stream);
        lattice.add_to(self.width, &mut self.values);
    }

    pub(crate) fn width(&self) -> usize {
        self.width
    }

    pub(crate) fn height(&self) -> usize {
        self.height
    }

    pub(crate) fn values(&self) -> &[f32] {
        &self.values
    }

    pub(crate) fn values_mut(&mut self) -> &mut [f32] {
        &mut self.values
    }

    /// The rows, from the top.
    pub(crate) fn rows(&self) -> std::slice::ChunksExact<'_, f32> {
        self.values.chunks_exact(self.width)
    }

    /// Each value becomes what `change` makes of its column, its row and itself.
    pub(crate) fn update(&mut self, change: impl Fn(usize, usize, f32) -> f32) {
        for (y, row) in self.values.chunks_exact_mut(self.width).enumerate() {
            for (x, value) in row.iter_mut().enumerate() {
                *value = change(x, y, *value);
            }
        }
    }

    /// The value at a place counted in pixels from the middle of the first, between the four
    /// pixels around it.
    pub(crate) fn sample(&self, x: f32, y: f32) -> f32 {
        let (left, top) = (floor(x), floor(y));
        let (fx, fy) = (x - left as f32, y - top as f32);
        let (x0, y0) = (wrap(left, self.width), wrap(top, self.height));
        let x1 = if x0 + 1 == self.width { 0 } else { x0 + 1 };
        let y1 = if y0 + 1 == self.height { 0 } else { y0 + 1 };
        let at = |x: usize, y: usize| self.values[y * self.width + x];
        let upper = mix(at(x0, y0), at(x1, y0), fx);
        mix(upper, mix(at(x0, y1), at(x1, y1), fx), fy)
    }

    /// The field with each place moved by so many pixels as the two others say there.
    pub(crate) fn warped(&self, by: &Field, across: f32, down: f32) -> Self {
        // The same noise moves both ways, read half a tile apart: one lattice less.
        let (half_x, half_y) = (self.width / 2, self.height / 2);
        let mut warped = Self::new(self.width as u32, self.height as u32);
        for (y, row) in warped.values.chunks_exact_mut(self.width).enumerate() {
            let here = &by.values[y * self.width..][..self.width];
            let there = &by.values[(y + half_y) % self.height * self.width..][..self.width];
            let there = there[half_x..].iter().chain(&there[..half_x]);
            for (x, ((value, dx), dy)) in row.iter_mut().zip(here).zip(there).enumerate() {
                *value = self.sample(x as f32 + across * dx, y as f32 + down * dy);
            }
        }
        warped
    }

    /// Visits the pixels of a box around a place, in pixels, with their distances from it.
    /// The box wraps round; no pixel is visited twice.
    pub(crate) fn stamp(
        &mut self,
        center: [f32; 2],
        half: [f32; 2],
        mut change: impl FnMut(f32, f32, &mut f32),
    ) {
        let range = |c: f32, half: f32, n: usize| {
            let half = half.min(n as f32 * 0.5 - 1.0).max(0.0);
            ((c - half).ceil() as i32, (c + half).floor() as i32)
        };
        let (left, right) = range(center[0], half[0], self.width);
        let (top, bottom) = range(center[1], half[1], self.height);
        for y in top..=bottom {
            let row = wrap(y, self.height) * self.width;
            for x in left..=right {
                let column = wrap(x, self.width);
                change(x as f32 - center[0], y as f32 - center[1], &mut self.values[row + column]);
            }
        }
    }
}

/// A place on a ring of `n`, for places that are mostly on it or one round beside it: a division
/// would take longer than everything else that is done for a pixel.
pub(crate) fn wrap(i: i32, n: usize) -> usize {
    let n = n as i32;
    let near = if i < 0 { i + n } else { i };
    let near = if near >= n { near - n } else { near };
    (if (0..n).contains(&near) { near } else { i.rem_euclid(n) }) as usize
}

/// The greatest whole number that is not above `x`; without the call that `f32::floor` is on
/// machines whose oldest model cannot round.
pub(crate) fn floor(x: f32) -> i32 {
    let whole = x as i32;
    whole - i32::from(whole as f32 > x)
}

/// From `a` at 0 to `b` at 1.
pub(crate) fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

/// 0 below `low`, 1 above `high`, smooth between; `high` may be the lesser.
pub(crate) fn smooth_step(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use sapwood_geom::{Purpose, StreamPath};

    use super::*;

    fn stream() -> Stream {
        Stream::new(StreamPath::new(3), Purpose("test"))
    }

    #[test]
    fn noise_has_no_seam() {
        let field = Field::noise([64, 32], [4, 8], 3, &mut stream());
        let step = |a: f32, b: f32| (a - b).abs();
        let mut inside = 0.0f32;
        let mut across = 0.0f32;
        for row in field.rows() {
            inside = row.windows(2).map(|two| step(two[0], two[1])).fold(inside, f32::max);
            across = across.max(step(row[0], row[63]));
        }
        assert!(across <= inside && inside > 0.0, "{across} {inside}");
        let rows: Vec<&[f32]> = field.rows().collect();
        let greatest =
            |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| step(*a, *b)).fold(0.0, f32::max);
        let inside = rows.windows(2).map(|two| greatest(two[0], two[1])).fold(0.0, f32::max);
        assert!(greatest(rows[0], rows[31]) <= inside);
    }

    #[test]
    fn noise_spreads_about_zero() {
        let field = Field::noise([128, 128], [8, 8], 4, &mut stream());
        let n = field.values().len() as f32;
        let mean = field.values().iter().sum::<f32>() / n;
        let variance = field.values().iter().map(|x| (x - mean) * (x - mean)).sum::<f32>() / n;
        assert!(mean.abs() < 0.05 && (0.1..0.5).contains(&variance.sqrt()), "{mean} {variance}");
    }

    #[test]
    fn samples_lie_between_pixels_and_wrap() {
        let mut field = Field::new(4, 2);
        field.update(|x, y, _| x as f32 + 10.0 * y as f32);
        assert_eq!(field.sample(1.0, 1.0), 11.0);
        assert_eq!(field.sample(1.5, 0.5), 6.5);
        assert_eq!(field.sample(-1.0, -1.0), 13.0);
        assert_eq!(field.sample(3.5, 0.0), 1.5);
    }

    #[test]
    fn a_stamp_visits_every_pixel_of_its_box_once() {
        let mut field = Field::new(8, 8);
        field.stamp([0.2, 7.9], [2.5, 100.0], |_, _, value| *value += 1.0);
        assert!(field.values().iter().all(|value| *value <= 1.0));
        let row: Vec<f32> = field.rows().next().unwrap().to_vec();
        assert_eq!(row, [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0]);
    }
}
