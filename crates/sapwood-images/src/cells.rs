//! Cellular noise: points scattered one to a cell of a grid that closes round, and how far each
//! pixel is from the nearest two.

use glam::Vec2;
use sapwood_geom::Stream;

use crate::field::{floor, wrap};

/// Points one to a cell, scattered from its middle.
pub(crate) struct Cells {
    n: [usize; 2],
    points: Vec<CellPoint>,
}

#[derive(Clone, Copy)]
struct CellPoint {
    /// In cells, from the cell's low corner.
    at: Vec2,
    /// Evenly between 0 and 1.
    mark: f32,
}

/// What cellular noise tells of a place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near {
    /// How far the border to the next cell is, in cells; 0 on the border.
    pub(crate) border: f32,
    /// A random number of the cell's own, 0 to 1.
    pub(crate) mark: f32,
    /// From the cell's point to the place, in cells.
    pub(crate) offset: Vec2,
}

impl Cells {
    /// `jitter` is how far points stray from the middles: 0 a grid, 1 anywhere in their cells.
    pub(crate) fn new(n: [u32; 2], jitter: f32, stream: &mut Stream) -> Self {
        // Three each way, so that the nine cells around a place are nine different ones.
        let n = n.map(|n| n.max(3) as usize);
        let point = |_| CellPoint {
            at: Vec2::new(stream.around(0.5, 0.5 * jitter), stream.around(0.5, 0.5 * jitter)),
            mark: stream.unit(),
        };
        let points = (0..n[0] * n[1]).map(point).collect();
        Self { n, points }
    }

    /// The grid's columns and rows.
    pub(crate) fn n(&self) -> [f32; 2] {
        self.n.map(|n| n as f32)
    }

    /// Looks at a place, in cells; every other row is shifted by half a cell, as bricks are.
    pub(crate) fn near(&self, place: Vec2) -> Near {
        let [nx, ny] = self.n;
        let row = floor(place.y);
        // The nine points around the place: offsets, squared distances, marks.
        let (mut dx, mut dy, mut mark) = ([0.0f32; 9], [0.0f32; 9], [0.0f32; 9]);
        for k in 0..3 {
            let j = row - 1 + k as i32;
            let wrapped = wrap(j, ny);
            // Only an even number of rows can alternate all the way round.
            let shift = if ny % 2 == 0 && wrapped % 2 == 1 { 0.5 } else { 0.0 };
            let column = floor(place.x - shift) - 1;
            let line = &self.points[wrapped * nx..][..nx];
            let from = place - Vec2::new(column as f32 + shift, j as f32);
            let mut i = wrap(column, nx);
            for step in 0..3 {
                let point = &line[i];
                i = if i + 1 == nx { 0 } else { i + 1 };
                dx[3 * k + step] = from.x - step as f32 - point.at.x;
                dy[3 * k + step] = from.y - point.at.y;
                mark[3 * k + step] = point.mark;
            }
        }
        let distance: [f32; 9] = std::array::from_fn(|i| dx[i] * dx[i] + dy[i] * dy[i]);
        let (mut first, mut second) = (f32::MAX, f32::MAX);
        for d in distance {
            second = second.min(first.max(d));
            first = first.min(d);
        }
        let place_of = |wanted: f32| distance.iter().position(|d| *d == wanted).unwrap_or(0);
        let (a, b) = (place_of(first), place_of(second));
        let offset = Vec2::new(dx[a], dy[a]);
        // The border is the perpendicular between both points.
        let between = offset - Vec2::new(dx[b], dy[b]);
        let border = 0.5 * (second - first) / between.length().max(1e-6);
        Near { border, mark: mark[a], offset }
    }
}

#[cfg(test)]
mod tests {
    use sapwood_geom::{Purpose, StreamPath};

    use super::*;

    #[test]
    fn cells_repeat_beyond_the_tile() {
        let mut stream = Stream::new(StreamPath::new(1), Purpose("test"));
        for n in [[3, 4], [5, 7]] {
            let cells = Cells::new(n, 0.8, &mut stream);
            for i in 0..50 {
                let place = Vec2::new(0.37 * i as f32 % n[0] as f32, 0.61 * i as f32 % n[1] as f32);
                let there = cells.near(place + Vec2::new(n[0] as f32, -(n[1] as f32)));
                let here = cells.near(place);
                assert!((here.border - there.border).abs() < 1e-4 && here.mark == there.mark);
                assert!(here.border >= 0.0);
            }
        }
    }
}
