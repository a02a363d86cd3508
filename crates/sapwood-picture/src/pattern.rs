//! Where in a pixel, a sun or a sky samples are taken.
//!
//! Each pixel has (0, 2)-sequences of its own, one for each use, shuffled and scrambled by bits
//! that follow from the seed, the pixel and the use (T. Kollig, A. Keller: "Efficient
//! Multidimensional Sampling", 2002). The first 2^n samples are spread evenly at all scales.

/// The samples of one pixel.
#[derive(Clone, Copy)]
pub(crate) struct Pattern {
    bits: u32,
    /// The number of samples less one, rounded up so that all its bits are set.
    mask: u32,
}

/// What samples are for; those of one pixel differ by it.
#[derive(Clone, Copy)]
pub(crate) enum Use {
    /// The place in the pixel.
    Pixel,
    /// The point of the sun.
    Sun,
    /// The direction of the sky.
    Sky,
    /// Whether light goes through, and what is half there.
    Chance,
}

impl Pattern {
    pub(crate) fn new(seed: u64, pixel: [u32; 2], n_samples: u32) -> Self {
        let [x, y] = pixel;
        let bits = [seed as u32, (seed >> 32) as u32, x, y].into_iter().fold(0x9e37_79b9, mixed);
        Self { bits, mask: n_samples.next_power_of_two() - 1 }
    }

    /// Two numbers in [0, 1) for a use of sample `index`, on its path after `depth` reflections.
    pub(crate) fn pair(&self, index: u32, purpose: Use, depth: u32) -> [f32; 2] {
        let bits = mixed(self.bits, purpose as u32 + 8 * depth);
        let index = index ^ (bits & self.mask);
        let x = index.reverse_bits() ^ mixed(bits, 1);
        let y = sobol(index) ^ mixed(bits, 2);
        [unit(x), unit(y)]
    }
}

/// The second dimension of Sobol's sequence.
fn sobol(mut index: u32) -> u32 {
    let (mut bits, mut direction) = (0, 1u32 << 31);
    while index != 0 {
        if index & 1 != 0 {
            bits ^= direction;
        }
        index >>= 1;
        direction ^= direction >> 1;
    }
    bits
}

/// Bits that look random and follow from both.
pub(crate) fn mixed(bits: u32, more: u32) -> u32 {
    let mut x = bits.wrapping_mul(0x85eb_ca6b) ^ more.wrapping_mul(0xc2b2_ae35);
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ x >> 16
}

/// A number in [0, 1) of the upper 24 bits.
pub(crate) fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / (1u32 << 24) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixteen_samples_fill_every_grid_of_sixteen_cells() {
        for purpose in [Use::Pixel, Use::Sun, Use::Sky, Use::Chance] {
            let pattern = Pattern::new(7, [31, 5], 16);
            let pairs: Vec<_> = (0..16).map(|i| pattern.pair(i, purpose, 0)).collect();
            for (columns, rows) in [(16, 1), (8, 2), (4, 4), (2, 8), (1, 16)] {
                let mut cells = [false; 16];
                for [x, y] in &pairs {
                    assert!((0.0..1.0).contains(x) && (0.0..1.0).contains(y));
                    let column = (x * columns as f32) as usize;
                    let cell = &mut cells[column * rows + (y * rows as f32) as usize];
                    assert!(!std::mem::replace(cell, true), "{columns} x {rows}");
                }
            }
        }
    }

    #[test]
    fn pixels_uses_depths_and_seeds_differ() {
        let pair = |seed, pixel, purpose, depth| {
            Pattern::new(seed, pixel, 4).pair(0, purpose, depth).map(f32::to_bits)
        };
        let all = [
            pair(0, [0, 0], Use::Pixel, 0),
            pair(1, [0, 0], Use::Pixel, 0),
            pair(0, [1, 0], Use::Pixel, 0),
            pair(0, [0, 1], Use::Pixel, 0),
            pair(0, [0, 0], Use::Sun, 0),
            pair(0, [0, 0], Use::Pixel, 1),
        ];
        for (i, a) in all.iter().enumerate() {
            assert!(all[..i].iter().all(|b| a != b));
        }
    }
}
