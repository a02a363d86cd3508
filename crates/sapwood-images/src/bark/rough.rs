//! Bark that breaks as the stem grows: furrowed ridges, blocks, plates.

use glam::Vec2;

use super::{Made, Patch};
use crate::cells::Cells;
use crate::field::{Field, mix, smooth_step};

/// Ridges that part and join along the stem.
pub(super) fn furrowed(patch: &Patch) -> Made {
    let sway = patch.noise("furrows.sway", 4.0, 3.0, 2);
    // Where stretched noise changes its sign runs a net of long meshes: the furrows.
    let net = patch.noise("furrows.net", 9.0, 2.5, 2).warped(&sway, patch.pixels(0.03), 0.0);
    let cracks = patch.noise("furrows.cracks", 8.0, 18.0, 2);
    let grain = patch.noise("furrows.grain", 40.0, 14.0, 3);
    let mut heights = net;
    heights.update(|x, y, net| {
        let i = y * patch.size as usize + x;
        let ridge = smooth_step(0.015, 0.3, net.abs());
        let crack = smooth_step(0.02, 0.16, cracks.values()[i].abs());
        let grain = grain.values()[i];
        (ridge * mix(0.72, 1.0, crack) + 0.07 * grain).clamp(0.0, 1.0)
    });
    let mut tones = grain;
    tones.update(|x, y, grain| {
        let i = y * patch.size as usize + x;
        let height = heights.values()[i];
        height * (0.94 + 0.1 * sway.values()[i]) + 0.14 * grain
    });
    Made { heights, tones }
}

/// Cells as fields of half the patch's size: how far the border is, a number of each cell's own
/// and how far down in its cell a place is, 0 to 1. Between pixels they are read as they would be
/// at full size, for distances change evenly and the rest jumps at borders only.
struct CellFields {
    border: Field,
    mark: Field,
    down: Field,
}

impl CellFields {
    /// `place` tells for each pixel of the patch which place, in pixels, is looked at.
    fn new(patch: &Patch, cells: &Cells, place: impl Fn(usize, Vec2) -> Vec2) -> Self {
        let size = patch.size as usize;
        let half = patch.size.div_ceil(2);
        let [nx, ny] = cells.n().map(|n| n / patch.size as f32);
        let field = || Field::new(half, half);
        let mut fields = Self { border: field(), mark: field(), down: field() };
        let half = half as usize;
        for i in 0..half * half {
            let (x, y) = (2 * (i % half), 2 * (i / half));
            let at = place(y * size + x, Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
            let near = cells.near(Vec2::new(at.x * nx, at.y * ny));
            fields.border.values_mut()[i] = near.border;
            fields.mark.values_mut()[i] = near.mark;
            fields.down.values_mut()[i] = (0.5 + 0.5 * near.offset.y).clamp(0.0, 1.0);
        }
        fields
    }

    /// Border, mark and how far down, at pixel `x`, `y` of the patch.
    fn at(&self, x: usize, y: usize) -> [f32; 3] {
        let (x, y) = (0.5 * x as f32, 0.5 * y as f32);
        [&self.border, &self.mark, &self.down].map(|field| field.sample(x, y))
    }
}

/// Ridges broken into blocks, as an alligator's hide.
pub(super) fn blocky(patch: &Patch) -> Made {
    let sway = patch.noise("blocks.sway", 7.0, 7.0, 3);
    let grain = patch.noise("blocks.grain", 26.0, 20.0, 3);
    let cells = Cells::new(patch.cells(8.0, 6.0), 0.75, &mut patch.stream("blocks.cells"));
    let bend = patch.pixels(0.03);
    let cells = CellFields::new(patch, &cells, |i, at| {
        at + Vec2::new(1.0, -0.7) * (bend * sway.values()[i])
    });
    let (mut heights, mut tones) = (sway, grain);
    let size = patch.size as usize;
    for (i, (height, tone)) in heights.values_mut().iter_mut().zip(tones.values_mut()).enumerate() {
        let [border, mark, _] = cells.at(i % size, i / size);
        let (sway, grain) = (*height, *tone);
        let block = smooth_step(0.03, 0.24, border + 0.04 * grain);
        *height = (block * (0.78 + 0.22 * mark) + 0.08 * grain).clamp(0.0, 1.0);
        *tone = block * (0.78 + 0.24 * mark) + 0.16 * grain + 0.08 * sway;
    }
    Made { heights, tones }
}

/// Flat plates in layers, each higher at its lower end, parted by dark cracks.
pub(super) fn plates(patch: &Patch) -> Made {
    let sway = patch.noise("plates.sway", 6.0, 4.0, 3);
    let grain = patch.noise("plates.grain", 30.0, 22.0, 3);
    let cells = Cells::new(patch.cells(6.0, 4.0), 0.85, &mut patch.stream("plates.cells"));
    let bend = patch.pixels(0.035);
    let cells = CellFields::new(patch, &cells, |i, at| {
        at + Vec2::new(sway.values()[i], 0.6 * grain.values()[i]) * bend
    });
    let (mut heights, mut tones) = (sway, grain);
    let size = patch.size as usize;
    for (i, (height, tone)) in heights.values_mut().iter_mut().zip(tones.values_mut()).enumerate() {
        let [border, mark, down] = cells.at(i % size, i / size);
        let (sway, grain) = (*height, *tone);
        let border = border + 0.03 * sway;
        let plate = smooth_step(0.015, 0.1, border);
        // Layers: terraces toward the middle, where the outermost scale has not fallen yet.
        let layer = 0.5 * smooth_step(0.16, 0.2, border + 0.06 * grain)
            + 0.5 * smooth_step(0.27, 0.31, border - 0.07 * grain);
        let high = 0.45 + 0.25 * layer + 0.15 * down + 0.1 * mark;
        *height = (plate * high + 0.05 * grain).clamp(0.0, 1.0);
        *tone = plate * (0.7 + 0.16 * layer + 0.22 * mark) + 0.14 * grain;
    }
    Made { heights, tones }
}
