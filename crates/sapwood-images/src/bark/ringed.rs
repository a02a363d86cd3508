//! Stems of monocots: rings of leaf scars, culms with nodes, stalks of grass.

use super::{Made, Patch};
use crate::field::{Field, floor, mix, smooth_step};

/// Rings of leaf scars, each overlapping the one above it, and fibres along.
pub(super) fn ringed(patch: &Patch) -> Made {
    let sway = patch.noise("rings.sway", 4.0, 3.0, 3);
    let fibres = patch.noise("rings.fibres", 56.0, 7.0, 3);
    let n = patch.n(7.0) as f32;
    let step = n / patch.size as f32;
    let mut heights = sway;
    let size = patch.size as usize;
    // How far below its ring's upper edge a place is, 0 to 1, before heights overwrite it.
    heights.update(|_, y, sway| {
        // No edge lies along the seam, where nobody could tell it from a fault.
        let down = (y as f32 + 0.5) * step + 0.5 + 0.22 * sway;
        down - floor(down) as f32
    });
    let mut tones = Field::new(patch.size, patch.size);
    tones.update(|x, y, _| {
        let i = y * size + x;
        let (down, fibre) = (heights.values()[i], fibres.values()[i]);
        // Dark under the edge of the scar above, then paler down to its own edge.
        let shade = smooth_step(0.0, 0.16, down);
        let edge = smooth_step(0.8, 0.95, down);
        shade * mix(0.74, 0.98, down) - 0.1 * edge + 0.17 * fibre
    });
    heights.update(|x, y, down| {
        let fibre = fibres.values()[y * size + x];
        let drop = smooth_step(1.0, 0.93, down);
        (drop * (0.3 + 0.6 * down) + 0.09 * fibre).clamp(0.0, 1.0)
    });
    Made { heights, tones }
}

/// A smooth culm: a node across the patch, fine lines between.
pub(super) fn culm(patch: &Patch) -> Made {
    let lines = patch.noise("culm.lines", 80.0, 3.0, 2);
    let clouds = patch.noise("culm.clouds", 3.0, 2.0, 3);
    let n = patch.n(1.0) as f32;
    // From the nearest node, in shares of the patch's height; positive below it.
    let size = patch.size as usize;
    let from_node = |y: usize| {
        let at = (y as f32 + 0.5) / size as f32 * n;
        (at - floor(at) as f32 - 0.5) / n
    };
    let mut heights = lines.clone();
    heights.update(|_, y, line| {
        let from = from_node(y);
        let ridge = smooth_step(0.028, 0.006, from.abs());
        let groove = smooth_step(0.012, 0.003, (from + 0.012).abs());
        0.2 + 0.02 * line + 0.7 * ridge - 0.45 * groove
    });
    let mut tones = clouds;
    tones.update(|x, y, cloud| {
        let from = from_node(y);
        let line = lines.values()[y * size + x];
        // The scar of the sheath is dark, the wax below it pale.
        let scar = smooth_step(0.01, 0.004, (from + 0.012).abs());
        let wax = smooth_step(0.004, 0.02, from) * smooth_step(0.12, 0.03, from);
        0.93 + 0.07 * cloud + 0.05 * line + 0.16 * wax - 0.8 * scar
    });
    Made { heights, tones }
}

/// Fine lines along a stalk.
pub(super) fn stalk(patch: &Patch) -> Made {
    let ribs = patch.noise("stalk.ribs", 26.0, 1.0, 2);
    let clouds = patch.noise("stalk.clouds", 4.0, 3.0, 4);
    let size = patch.size as usize;
    let mut tones = clouds;
    tones.update(|x, y, cloud| 0.92 + 0.12 * cloud + 0.22 * ribs.values()[y * size + x]);
    let mut heights = ribs;
    heights.update(|_, _, rib| 0.5 + 0.5 * rib);
    Made { heights, tones }
}
