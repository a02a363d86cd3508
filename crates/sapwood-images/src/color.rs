//! Colours between what is given, linear, and what images hold, sRGB-encoded.
//!
//! Colours are mixed as they are encoded: steps look even then, and a pixel costs no power.

use glam::Vec3;

/// A colour as images hold it, 0 to 255 each, not yet rounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Encoded(pub(crate) Vec3);

impl Encoded {
    /// Encodes a linear colour.
    pub(crate) fn of(linear: [f32; 3]) -> Self {
        Self(Vec3::from_array(linear.map(|x| 255.0 * encode(x))))
    }

    /// From this colour at 0 to another at 1, and beyond.
    pub(crate) fn mix(self, other: Self, t: f32) -> Self {
        Self(self.0 + (other.0 - self.0) * t)
    }

    /// As bright as `factor` says.
    pub(crate) fn times(self, factor: f32) -> Self {
        Self(self.0 * factor)
    }

    /// The pixel, with this coverage.
    pub(crate) fn pixel(self, coverage: u8) -> [u8; 4] {
        // The cast saturates.
        let [red, green, blue] = (self.0 + 0.5).to_array().map(|x| x as u8);
        [red, green, blue, coverage]
    }
}

/// The sRGB code of a linear number, both 0 to 1.
fn encode(linear: f32) -> f32 {
    if linear <= 0.003_130_8 {
        12.92 * linear.max(0.0)
    } else {
        1.055 * libm::powf(linear.min(1.0), 1.0 / 2.4) - 0.055
    }
}

/// Why a colour is none, in words, or nothing.
pub(crate) fn fault(field: &str, color: &[f32; 3]) -> Option<String> {
    let is_fine = color.iter().all(|x| (0.0..=1.0).contains(x));
    (!is_fine).then(|| format!("{field} is {color:?}; accepted: three numbers in 0..=1"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_are_encoded_as_srgb() {
        let check = |linear: f32, code: u8| {
            assert_eq!(Encoded::of([linear; 3]).pixel(255), [code, code, code, 255]);
        };
        check(0.0, 0);
        check(0.001, 3);
        check(0.214_041_14, 128);
        check(1.0, 255);
    }

    #[test]
    fn faults_name_the_field() {
        assert_eq!(fault("color", &[0.0, 0.5, 1.0]), None);
        let told = "color is [0.0, 1.5, 1.0]; accepted: three numbers in 0..=1";
        assert_eq!(fault("color", &[0.0, 1.5, 1.0]).as_deref(), Some(told));
        assert!(fault("color", &[f32::NAN, 0.0, 0.0]).is_some());
    }
}
