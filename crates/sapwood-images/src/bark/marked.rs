//! Smooth bark, and smooth bark with marks: dashes across the stem, scars like eyes.

use super::{Made, Patch};
use crate::field::{Field, smooth_step};

/// Next to no structure: clouds, faint lines along, few short dashes.
pub(super) fn smooth(patch: &Patch) -> Made {
    let clouds = patch.noise("smooth.clouds", 4.0, 3.0, 4);
    let lines = patch.noise("smooth.lines", 48.0, 6.0, 2);
    let mut heights = lines.clone();
    heights.update(|_, _, line| 0.6 + 0.3 * line);
    let mut tones = clouds;
    tones.update(|x, y, cloud| {
        0.98 + 0.13 * cloud + 0.08 * lines.values()[y * patch.size as usize + x]
    });
    let dashes = Dashes { n: 60.0, half: [0.004, 0.014], thick: 0.0025, dark: 0.22, raised: 0.25 };
    dashes.scatter(patch, "smooth.dashes", &mut heights, &mut tones);
    Made { heights, tones }
}

/// Long dashes across, and bands where the outer layer has peeled.
pub(super) fn lenticels(patch: &Patch) -> Made {
    let clouds = patch.noise("lenticels.clouds", 3.0, 5.0, 4);
    // Bands across the stem: far wider than high.
    let bands = patch.noise("lenticels.bands", 1.0, 9.0, 3);
    let grain = patch.noise("lenticels.grain", 14.0, 60.0, 2);
    let mut heights = Field::new(patch.size, patch.size);
    let mut tones = clouds;
    let size = patch.size as usize;
    heights.update(|x, y, _| {
        let i = y * size + x;
        0.5 + 0.3 * smooth_step(0.22, 0.3, bands.values()[i]) + 0.1 * grain.values()[i]
    });
    tones.update(|x, y, cloud| {
        let i = y * size + x;
        // A peeled band lies darker, with the curled edge of the layer above it in shade.
        let band = bands.values()[i];
        let peeled = smooth_step(0.22, 0.27, band);
        let edge = smooth_step(0.16, 0.22, band) * (1.0 - peeled);
        0.98 + 0.08 * cloud + 0.06 * grain.values()[i] - 0.14 * peeled - 0.2 * edge
    });
    let short = Dashes { n: 90.0, half: [0.008, 0.04], thick: 0.003, dark: 0.6, raised: 0.3 };
    short.scatter(patch, "lenticels.short", &mut heights, &mut tones);
    let long = Dashes { n: 10.0, half: [0.04, 0.14], thick: 0.006, dark: 0.85, raised: 0.4 };
    long.scatter(patch, "lenticels.long", &mut heights, &mut tones);
    Eyes { n: 3.0, half: 0.07, flat: 0.75 }.scatter(
        patch,
        "lenticels.eyes",
        &mut heights,
        &mut tones,
    );
    Made { heights, tones }
}

/// Scars like eyes where branches were shed, between short dashes.
pub(super) fn eyed(patch: &Patch) -> Made {
    let clouds = patch.noise("eyed.clouds", 4.0, 4.0, 4);
    let grain = patch.noise("eyed.grain", 30.0, 44.0, 2);
    let mut heights = grain.clone();
    heights.update(|_, _, grain| 0.5 + 0.15 * grain);
    let mut tones = clouds;
    tones.update(|x, y, cloud| {
        0.97 + 0.1 * cloud + 0.05 * grain.values()[y * patch.size as usize + x]
    });
    let dashes = Dashes { n: 90.0, half: [0.003, 0.016], thick: 0.0028, dark: 0.5, raised: 0.3 };
    dashes.scatter(patch, "eyed.dashes", &mut heights, &mut tones);
    let cracks = Dashes { n: 9.0, half: [0.03, 0.11], thick: 0.004, dark: 0.45, raised: -0.2 };
    cracks.scatter(patch, "eyed.cracks", &mut heights, &mut tones);
    Eyes { n: 4.0, half: 0.065, flat: 0.45 }.scatter(patch, "eyed.eyes", &mut heights, &mut tones);
    Made { heights, tones }
}

/// Dashes across the stem, lengths as shares of the patch's width at scale 1.
struct Dashes {
    /// How many on the patch at scale 1.
    n: f32,
    /// The least and greatest half length.
    half: [f32; 2],
    /// Half their height.
    thick: f32,
    /// How much they darken.
    dark: f32,
    /// How much they stand out.
    raised: f32,
}

/// As many marks as fit where `n` fit at scale 1.
fn number(patch: &Patch, n: f32) -> u32 {
    (n / (patch.scale * patch.scale)).round().clamp(0.0, 20_000.0) as u32
}

impl Dashes {
    fn scatter(
        &self,
        patch: &Patch,
        purpose: &'static str,
        heights: &mut Field,
        tones: &mut Field,
    ) {
        let mut stream = patch.stream(purpose);
        for _ in 0..number(patch, self.n) {
            let size = patch.size as f32;
            let center = [stream.between(0.0, size), stream.between(0.0, size)];
            let short = stream.unit();
            let half = self.half[0] + (self.half[1] - self.half[0]) * short * short;
            let half = patch.pixels(half * patch.scale);
            let thick = patch.pixels(self.thick * patch.scale) * stream.between(0.6, 1.4);
            let thick = thick.max(0.7);
            let bend = stream.around(0.0, 0.12);
            let strength = stream.between(0.55, 1.0);
            // Thinner toward both ends, with a soft rim of a pixel.
            let cover = |dx: f32, dy: f32| {
                let along = (dx / half).abs();
                let at = dy - bend * dx * along;
                let thick = thick * (1.0 - along * along).max(0.0).sqrt();
                (thick - at.abs() + 0.5).clamp(0.0, 1.0) * strength
            };
            let box_half = [half, thick + 0.12 * half + 1.0];
            tones.stamp(center, box_half, |dx, dy, tone| {
                *tone -= self.dark * cover(dx, dy) * tone.max(0.0);
            });
            heights.stamp(center, box_half, |dx, dy, height| {
                *height += self.raised * cover(dx, dy);
            });
        }
    }
}

/// Scars like eyes: a dark, ragged almond under a brow.
struct Eyes {
    /// How many on the patch at scale 1.
    n: f32,
    /// Half their width, as a share of the patch's width at scale 1.
    half: f32,
    /// Half their height against half their width.
    flat: f32,
}

impl Eyes {
    fn scatter(
        &self,
        patch: &Patch,
        purpose: &'static str,
        heights: &mut Field,
        tones: &mut Field,
    ) {
        let ragged = patch.noise("eyes.ragged", 24.0, 24.0, 3);
        let mut stream = patch.stream(purpose);
        let n = number(patch, self.n);
        let first = stream.unit();
        for i in 0..n {
            let size = patch.size as f32;
            // Spread evenly down the patch, so that no two overlap.
            let row = (i as f32 + stream.around(0.5, 0.35)) / n as f32;
            let column = first + 0.618 * i as f32 + stream.around(0.0, 0.12);
            let center = [column.fract() * size, row * size];
            let half = patch.pixels(self.half * patch.scale) * stream.between(0.45, 1.25);
            let flat = self.flat * stream.between(0.8, 1.25);
            let (lean, lift) = (stream.around(0.0, 0.3), stream.between(0.25, 0.5));
            if half < 1.0 {
                continue;
            }
            // In units of the half width, the almond between two arcs.
            let dark = |dx: f32, dy: f32| {
                let rag = ragged.sample(center[0] + dx, center[1] + dy);
                let (x, y) = (dx / half + 0.1 * rag, dy / half + lean * dx / half);
                let lid = flat * (1.0 - 0.85 * x * x) + 0.1 * rag;
                let almond = smooth_step(0.12, -0.1, y.abs() - lid);
                let arch = lift * x * x - flat - 0.28;
                let thick = 0.1 * (1.0 - 0.4 * x * x) + 0.06 * rag;
                let brow = smooth_step(thick, 0.0, (y - arch).abs());
                almond.max(0.6 * brow * smooth_step(1.5, 0.8, x.abs())) * (0.9 + 0.25 * rag)
            };
            let box_half = [1.6 * half, 1.3 * half];
            tones.stamp(center, box_half, |dx, dy, tone| *tone *= 1.0 - dark(dx, dy).min(1.0));
            heights.stamp(center, box_half, |dx, dy, height| *height += 0.8 * dark(dx, dy));
        }
    }
}
