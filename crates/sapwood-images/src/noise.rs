//! Noise as an image: clouds between two colours.

use sapwood_geom::{Image, Purpose, Shared, Stream, StreamPath, content};
use sapwood_graph::Named;
use sapwood_scene::Component;

use crate::color::{self, Encoded};
use crate::field::Field;
use crate::size;

/// The most octaves of noise; more would be finer than the pixels of any image.
const MOST_OCTAVES: u32 = 16;

/// Gradient noise that repeats across and down: compiled to a [`Shared`] [`Image`].
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseImage {
    /// How many clouds stand side by side, across and down, 1 to 4096 each.
    pub cells: [u32; 2],
    /// How often clouds half the size and half as strong are added, counting the first, 1 to 16;
    /// those finer than two pixels are left out.
    pub octaves: u32,
    /// The linear colour where the noise is lowest, each number in 0..=1.
    pub low: [f32; 3],
    /// The linear colour where it is highest, each number in 0..=1.
    pub high: [f32; 3],
    /// Pixels across and down, 1 to [`LARGEST_IMAGE`](crate::LARGEST_IMAGE) each.
    pub size: [u32; 2],
    /// What tells the noise from others of its kind.
    pub seed: u64,
}

content!(NoiseImage { cells, octaves, low, high, size, seed });

impl Named for NoiseImage {
    const NAME: &'static str = "noise_image";
}

impl Component for NoiseImage {}

impl Default for NoiseImage {
    /// From black to white, four clouds each way in four octaves, 256 pixels square.
    fn default() -> Self {
        Self { cells: [4; 2], octaves: 4, low: [0.0; 3], high: [1.0; 3], size: [256; 2], seed: 0 }
    }
}

impl NoiseImage {
    /// What is wrong with the noise, in words, or nothing.
    pub fn fault(&self) -> Option<String> {
        let whole = |field: &str, value: u32, most: u32| {
            let is_fine = (1..=most).contains(&value);
            (!is_fine)
                .then(|| format!("{field} is {value}; accepted: a whole number from 1 to {most}"))
        };
        size::fault_of_both(self.size)
            .or_else(|| whole("cells across", self.cells[0], size::LARGEST_IMAGE))
            .or_else(|| whole("cells down", self.cells[1], size::LARGEST_IMAGE))
            .or_else(|| whole("octaves", self.octaves, MOST_OCTAVES))
            .or_else(|| color::fault("low", &self.low))
            .or_else(|| color::fault("high", &self.high))
    }

    /// The same noise from black to white.
    pub(crate) fn grey(&self) -> Self {
        Self { low: [0.0; 3], high: [1.0; 3], ..self.clone() }
    }

    /// The noise as numbers, most of them between 0 and 1.
    pub(crate) fn shares(&self) -> Field {
        let mut stream = Stream::new(StreamPath::new(self.seed), Purpose("noise"));
        let mut field = Field::noise(self.size, self.cells, self.octaves, &mut stream);
        field.values_mut().iter_mut().for_each(|value| *value = 0.5 + 0.5 * *value);
        field
    }

    /// The image. Costs some 3 ns for each pixel and octave.
    ///
    /// # Panics
    /// Where the noise has a [fault](Self::fault).
    pub fn image(&self) -> Shared<Image> {
        if let Some(fault) = self.fault() {
            panic!("{fault}");
        }
        let (low, high) = (Encoded::of(self.low), Encoded::of(self.high));
        let shares = self.shares();
        let pixel = |share: &f32| low.mix(high, share.clamp(0.0, 1.0)).pixel(u8::MAX);
        let pixels = shares.values().iter().map(pixel).collect();
        Shared::new(Image { width: self.size[0], height: self.size[1], pixels })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_lies_between_both_colors_and_uses_most_of_what_is_between() {
        let noise = NoiseImage { low: [0.0, 0.5, 0.0], size: [128, 64], ..NoiseImage::default() };
        let image = noise.image();
        assert_eq!((image.width, image.height, image.fault()), (128, 64, None));
        let reds: Vec<u8> = image.pixels.iter().map(|pixel| pixel[0]).collect();
        let (least, most) = (reds.iter().min().unwrap(), reds.iter().max().unwrap());
        assert!(*least < 70 && *most > 185, "{least} {most}");
        assert!(image.pixels.iter().all(|pixel| pixel[1] >= 187 && pixel[3] == 255));
    }

    #[test]
    fn more_octaves_are_finer_and_another_seed_is_another_noise() {
        let noise = NoiseImage { octaves: 1, size: [64; 2], ..NoiseImage::default() };
        let steps = |noise: &NoiseImage| -> u32 {
            let image = noise.image();
            let pairs = image.pixels.windows(2);
            pairs.map(|two| u32::from(two[0][0].abs_diff(two[1][0]))).sum()
        };
        assert!(steps(&NoiseImage { octaves: 5, ..noise.clone() }) > 3 * steps(&noise) / 2);
        assert_ne!(noise.image(), NoiseImage { seed: 7, ..noise.clone() }.image());
        assert_eq!(noise.image(), noise.clone().image());
    }

    #[test]
    fn faults_name_field_value_and_range() {
        let told = |noise: NoiseImage| noise.fault().unwrap_or_default();
        let noise = NoiseImage::default;
        assert_eq!(told(noise()), "");
        assert_eq!(
            told(NoiseImage { size: [0, 9], ..noise() }),
            "width is 0; accepted: a whole number of pixels from 1 to 4096"
        );
        assert_eq!(
            told(NoiseImage { octaves: 99, ..noise() }),
            "octaves is 99; accepted: a whole number from 1 to 16"
        );
        assert_eq!(
            told(NoiseImage { cells: [3, 0], ..noise() }),
            "cells down is 0; accepted: a whole number from 1 to 4096"
        );
    }

    #[test]
    fn the_finest_noise_is_still_an_image() {
        let size = [1, 3];
        let noise = NoiseImage { cells: [4096; 2], octaves: 16, size, ..NoiseImage::default() };
        assert_eq!(noise.image().fault(), None);
    }
}
