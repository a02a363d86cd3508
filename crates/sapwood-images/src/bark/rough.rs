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

/// Ridges broken into blocks, as an alligator's hide.
pub(super) fn blocky(patch: &Patch) -> Made {
    let sway = patch.noise("blocks.sway", 7.0, 7.0, 3);
    let grain = patch.noise("blocks.grain", 26.0, 20.0, 3);
    let cells = Cells::new(patch.cells(8.0, 6.0), 0.75, &mut patch.stream("blocks.cells"));
    let mut tones = Field::new(patch.size, patch.size);
    let mut heights = Field::new(patch.size, patch.size);
    let [nx, ny] = cells.n().map(|n| n / patch.size as f32);
    let bend = patch.pixels(0.03);
    let size = patch.size as usize;
    for (i, (height, tone)) in heights.values_mut().iter_mut().zip(tones.values_mut()).enumerate() {
        let (x, y) = ((i % size) as f32 + 0.5, (i / size) as f32 + 0.5);
        let (sway, grain) = (sway.values()[i], grain.values()[i]);
        let near = cells.near(Vec2::new((x + bend * sway) * nx, (y - 0.7 * bend * sway) * ny));
        let block = smooth_step(0.03, 0.24, near.border + 0.04 * grain);
        *height = (block * (0.78 + 0.22 * near.mark) + 0.08 * grain).clamp(0.0, 1.0);
        *tone = block * (0.78 + 0.24 * near.mark) + 0.16 * grain + 0.08 * sway;
    }
    Made { heights, tones }
}

/// Flat plates in layers, each higher at its lower end, parted by dark cracks.
pub(super) fn plates(patch: &Patch) -> Made {
    let sway = patch.noise("plates.sway", 6.0, 4.0, 3);
    let grain = patch.noise("plates.grain", 30.0, 22.0, 3);
    let cells = Cells::new(patch.cells(6.0, 4.0), 0.85, &mut patch.stream("plates.cells"));
    let mut tones = Field::new(patch.size, patch.size);
    let mut heights = Field::new(patch.size, patch.size);
    let [nx, ny] = cells.n().map(|n| n / patch.size as f32);
    let bend = patch.pixels(0.035);
    let size = patch.size as usize;
    for (i, (height, tone)) in heights.values_mut().iter_mut().zip(tones.values_mut()).enumerate() {
        let (x, y) = ((i % size) as f32 + 0.5, (i / size) as f32 + 0.5);
        let (sway, grain) = (sway.values()[i], grain.values()[i]);
        let near = cells.near(Vec2::new((x + bend * sway) * nx, (y + bend * grain) * ny));
        let border = near.border + 0.03 * sway;
        let plate = smooth_step(0.015, 0.1, border);
        // Layers: terraces toward the middle, where the outermost scale has not fallen yet.
        let layer = 0.5 * smooth_step(0.16, 0.2, border + 0.06 * grain)
            + 0.5 * smooth_step(0.27, 0.31, border - 0.07 * grain);
        let tilt = (0.5 + 0.5 * near.offset.y).clamp(0.0, 1.0);
        let high = 0.45 + 0.25 * layer + 0.15 * tilt + 0.1 * near.mark;
        *height = (plate * high + 0.05 * grain).clamp(0.0, 1.0);
        *tone = plate * (0.7 + 0.16 * layer + 0.22 * near.mark) + 0.14 * grain;
    }
    Made { heights, tones }
}
