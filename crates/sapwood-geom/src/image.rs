//! Raster images, as materials hold them.

use crate::{Content, Digester};

/// An image of 8-bit pixels: red, green, blue and coverage.
///
/// Rows run from the top downwards, as texture coordinates do. Coverage is straight, not
/// multiplied into the colours. Colours are sRGB-encoded where they are looked at, and plain
/// numbers where they steer something, such as roughness or normals.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width * height` pixels, row by row.
    pub pixels: Vec<[u8; 4]>,
}

impl Image {
    /// The image whose pixel in column `x` of row `y` is `pixel(x, y)`.
    pub fn from_fn(width: u32, height: u32, pixel: impl Fn(u32, u32) -> [u8; 4]) -> Self {
        let rows = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let pixels = rows.map(|(x, y)| pixel(x, y)).collect();
        Self { width, height, pixels }
    }

    /// What is wrong with the image, in words, or nothing: there are as many pixels as there
    /// should be, and some.
    pub fn fault(&self) -> Option<String> {
        let Self { width, height, ref pixels } = *self;
        let n = u64::from(width) * u64::from(height);
        (n == 0 || n != pixels.len() as u64)
            .then(|| format!("{} pixels in an image of {width} x {height}", pixels.len()))
    }
}

impl Content for Image {
    fn write(&self, digester: &mut Digester) {
        digester.add(&self.width).add(&self.height).bytes(self.pixels.as_flattened());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_run_along_rows() {
        let image = Image::from_fn(2, 3, |x, y| [x as u8, y as u8, 0, 255]);
        assert_eq!(image.pixels[3], [1, 1, 0, 255]);
        assert_eq!(image.fault(), None);
    }

    #[test]
    fn missing_pixels_are_a_fault() {
        let image = Image { width: 2, height: 2, pixels: vec![[0; 4]; 3] };
        assert_eq!(image.fault().as_deref(), Some("3 pixels in an image of 2 x 2"));
        assert!(Image::from_fn(0, 5, |_, _| [0; 4]).fault().is_some());
    }
}
