//! From linear light to the bytes of a picture.

use sapwood_geom::glam::Vec3;

/// Light and coverage of a pixel, summed over its samples. Light counts as far as it is covered.
#[derive(Clone, Copy, Default)]
pub(crate) struct Exposed {
    pub(crate) light: Vec3,
    pub(crate) coverage: f32,
}

/// Steps of the table from linear values to bytes, fine enough for the darkest shades.
const STEPS: usize = 1 << 14;

/// sRGB encoding (IEC 61966-2-1), by table.
pub(crate) struct Encoding(Vec<u8>);

impl Encoding {
    pub(crate) fn new() -> Self {
        let encoded = |i: usize| (255.0 * srgb_of_linear(i as f32 / STEPS as f32)).round() as u8;
        Self((0..=STEPS).map(encoded).collect())
    }

    /// The byte of a linear value; what is brighter than 1 is 1.
    pub(crate) fn byte(&self, linear: f32) -> u8 {
        // What is no number is black.
        self.0[(linear.clamp(0.0, 1.0) * STEPS as f32).round() as usize]
    }

    /// The pixel of samples that were summed up, with straight coverage.
    pub(crate) fn pixel(&self, sum: Exposed, n_samples: u32, exposure: f32) -> [u8; 4] {
        let coverage = (sum.coverage / n_samples as f32).min(1.0);
        if coverage <= 0.0 {
            return [0; 4];
        }
        let [r, g, b] = (sum.light * (exposure / sum.coverage)).to_array();
        let coverage = (255.0 * coverage).round() as u8;
        [self.byte(r), self.byte(g), self.byte(b), coverage]
    }
}

fn srgb_of_linear(linear: f32) -> f32 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * libm::powf(linear, 1.0 / 2.4) - 0.055
    }
}

/// The linear value of a byte that is sRGB-encoded.
pub(crate) fn linear_of_srgb(byte: u8) -> f32 {
    let encoded = f32::from(byte) / 255.0;
    if encoded <= 0.040_45 { encoded / 12.92 } else { libm::powf((encoded + 0.055) / 1.055, 2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_comes_back() {
        let encoding = Encoding::new();
        for byte in 0..=255 {
            assert_eq!(encoding.byte(linear_of_srgb(byte)), byte);
        }
        assert_eq!(encoding.byte(f32::NAN), 0);
        assert_eq!(encoding.byte(9.0), 255);
    }

    #[test]
    fn half_covered_pixels_keep_their_colour() {
        let sum = Exposed { light: Vec3::new(2.0, 0.0, 0.0), coverage: 2.0 };
        assert_eq!(Encoding::new().pixel(sum, 4, 1.0), [255, 0, 0, 128]);
        assert_eq!(Encoding::new().pixel(Exposed::default(), 4, 1.0), [0; 4]);
    }
}
