//! Veins as a field: 1 on the midrib, less on finer veins, 0 between them.

use glam::Vec2;

use super::LeafOutline;
use super::shapes::Veins;
use crate::field::Field;

/// The veins of a leaf; `width` is the image's width against its length.
pub(super) fn drawn(outline: LeafOutline, width: f32, [columns, rows]: [u32; 2]) -> Field {
    let mut lines = Lines { field: Field::new(columns, rows), width };
    match outline.veins() {
        Veins::Pinnate { pairs, rise } => lines.pinnate(pairs, rise),
        Veins::Palmate { foot, tips } => lines.palmate(Vec2::from_array(foot), tips),
        Veins::Parallel { n } => lines.parallel(n),
    }
    lines.field
}

/// Places are across -1 to 1 and along 0 to 1, thickness is a share of the leaf's length.
struct Lines {
    field: Field,
    width: f32,
}

impl Lines {
    fn pinnate(&mut self, pairs: u32, rise: f32) {
        self.vein(Vec2::ZERO, Vec2::new(0.0, 1.0), 0.0, 0.014, 1.0);
        for side in [1.0, -1.0] {
            for pair in 0..pairs {
                // Left and right alternate a little.
                let shift = if side > 0.0 { 0.0 } else { 0.3 };
                let from = 0.05 + 0.85 * (pair as f32 + shift) / pairs as f32;
                let foot = Vec2::new(0.0, from);
                let tip = Vec2::new(side, from + rise * (1.2 - 0.4 * from));
                self.vein(foot, tip, -0.22 * rise, 0.007, 0.7);
                for branch in 1..4 {
                    let start = foot + (tip - foot) * (0.25 * branch as f32);
                    let end = start + Vec2::new(0.12 * side, rise * 0.75);
                    self.vein(start, end, -0.1 * rise, 0.004, 0.35);
                }
            }
        }
    }

    fn palmate(&mut self, foot: Vec2, tips: &[[f32; 2]]) {
        self.vein(Vec2::ZERO, foot, 0.0, 0.014, 1.0);
        for tip in tips.iter().copied().map(Vec2::from_array) {
            for side in [1.0, -1.0] {
                if tip.x == 0.0 && side < 0.0 {
                    continue;
                }
                let tip = Vec2::new(side * tip.x, tip.y);
                self.vein(foot, tip, 0.0, 0.011, 1.0);
                // Side veins off each main vein, square enough to it to reach the margin.
                let along = tip - foot;
                let off = Vec2::new(-along.y / self.width, along.x * self.width) * 0.5;
                for branch in 1..6 {
                    let share = branch as f32 / 6.0;
                    for way in [2.0, -2.0] {
                        let start = foot + along * share;
                        let reach = 0.34 * (1.0 - 0.6 * share);
                        let end = start + along * 0.14 + off * (way * reach);
                        self.vein(start, end, 0.0, 0.005, 0.5);
                    }
                }
            }
        }
    }

    fn parallel(&mut self, n: u32) {
        self.vein(Vec2::ZERO, Vec2::new(0.0, 1.0), 0.0, 0.1 * self.width, 1.0);
        for line in 1..n {
            let across = line as f32 / n as f32;
            for side in [across, -across] {
                let thick = 0.03 * self.width;
                self.vein(Vec2::new(side, 0.0), Vec2::new(side, 1.0), 0.0, thick, 0.35);
            }
        }
    }

    /// Draws a vein that thins out toward its tip and bends along by `bend` at its middle.
    fn vein(&mut self, foot: Vec2, tip: Vec2, bend: f32, thick: f32, strength: f32) {
        const STEPS: usize = 6;
        let at = |i: usize| {
            let t = i as f32 / STEPS as f32;
            foot + (tip - foot) * t + Vec2::new(0.0, 4.0 * bend * t * (1.0 - t))
        };
        let steps = if bend == 0.0 { 1 } else { STEPS };
        for i in 0..steps {
            let (from, to) = (at(i * STEPS / steps), at((i + 1) * STEPS / steps));
            let share = |i: usize| 1.0 - 0.75 * (i as f32 / steps as f32);
            self.stroke(from, to, [thick * share(i), thick * share(i + 1)], strength);
        }
    }

    /// Draws a straight stroke with soft sides; where strokes meet the stronger one counts.
    fn stroke(&mut self, from: Vec2, to: Vec2, thick: [f32; 2], strength: f32) {
        let (columns, rows) = (self.field.width(), self.field.height());
        // Pixels, and metres that are alike both ways: lengths of the leaf.
        let scale = Vec2::new(0.5 * self.width, 1.0);
        let (a, b) = (from * scale, to * scale);
        let along = b - a;
        let square = along.length_squared().max(1e-12);
        // A pixel at least, so that veins show on small images.
        let pixel = 1.0 / rows as f32;
        let thick = thick.map(|thick| thick.max(0.8 * pixel));
        let reach = thick[0].max(thick[1]);
        let (low, high) = (a.min(b) - reach, a.max(b) + reach);
        let column = |x: f32| (x / self.width + 0.5) * columns as f32;
        let row = |y: f32| (1.0 - y) * rows as f32;
        let range = |from: f32, to: f32, n: usize| {
            from.floor().clamp(0.0, n as f32) as usize..to.ceil().clamp(0.0, n as f32) as usize
        };
        let xs = range(column(low.x), column(high.x), columns);
        for y in range(row(high.y), row(low.y), rows) {
            let py = 1.0 - (y as f32 + 0.5) / rows as f32;
            let line = &mut self.field.values_mut()[y * columns..][..columns];
            for (x, value) in line.iter_mut().enumerate().take(xs.end).skip(xs.start) {
                let px = ((x as f32 + 0.5) / columns as f32 - 0.5) * self.width;
                let place = Vec2::new(px, py);
                let t = ((place - a).dot(along) / square).clamp(0.0, 1.0);
                let thick = thick[0] + (thick[1] - thick[0]) * t;
                let away = (place - a - along * t).length() / thick;
                if away < 1.0 {
                    let soft = 1.0 - away * away;
                    *value = value.max(strength * soft);
                }
            }
        }
    }
}
