//! Images made ready to be looked up at any size.

use std::sync::Arc;

use sapwood_geom::glam::{Vec2, Vec4};
use sapwood_geom::{Digest, FixedMap, Image, Shared, fixed_state};

use crate::film::{Encoding, linear_of_srgb};

/// An image, and the same at half the size down to one pixel.
pub(crate) struct Texture {
    image: Shared<Image>,
    /// Half, a quarter, and so on.
    smaller: Vec<Image>,
    meaning: Meaning,
    /// The number of every byte in a channel of colour.
    values: [f32; 256],
}

/// What the bytes of an image mean.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Meaning {
    /// Colours, sRGB-encoded.
    Color,
    /// Numbers from 0 to 1.
    Number,
}

/// The textures of images, each made once.
pub(crate) struct Textures(FixedMap<(Digest, Meaning), Arc<Texture>>);

impl Default for Textures {
    fn default() -> Self {
        Self(FixedMap::with_hasher(fixed_state()))
    }
}

impl Textures {
    /// The texture of an image, which must have no fault.
    pub(crate) fn texture(&mut self, image: &Shared<Image>, meaning: Meaning) -> Arc<Texture> {
        let texture = self.0.entry((image.digest(), meaning));
        Arc::clone(texture.or_insert_with(|| Arc::new(Texture::new(image, meaning))))
    }
}

impl Texture {
    /// The image must have no fault.
    pub(crate) fn new(image: &Shared<Image>, meaning: Meaning) -> Self {
        let values = std::array::from_fn(|byte| match meaning {
            Meaning::Color => linear_of_srgb(byte as u8),
            Meaning::Number => byte as f32 / 255.0,
        });
        let encoding = Encoding::new();
        let mut smaller: Vec<Image> = Vec::new();
        loop {
            let last = smaller.last().unwrap_or(image);
            if last.width.max(last.height) == 1 {
                break;
            }
            smaller.push(halved(last, meaning, &values, &encoding));
        }
        Self { image: image.clone(), smaller, meaning, values }
    }

    /// Pixels in all.
    pub(crate) fn n_pixels(&self) -> f32 {
        self.image.width as f32 * self.image.height as f32
    }

    /// The value at a texture coordinate, between the four pixels around it, where about
    /// `footprint` pixels in a row are seen as one.
    ///
    /// Colours of a smaller image count as far as they cover. One of its pixels stands for many,
    /// and at an edge for few that are there: those must not colour what lies further inside.
    pub(crate) fn at(&self, uv: Vec2, footprint: f32) -> Vec4 {
        let level = if footprint > 1.0 { libm::ilogbf(1.5 * footprint).max(0) as usize } else { 0 };
        let level = level.min(self.smaller.len());
        let image = if level == 0 { &*self.image } else { &self.smaller[level - 1] };
        let pixel = |pixel: usize| {
            let [r, g, b, a] = image.pixels[pixel];
            let value = |byte: u8| self.values[usize::from(byte)];
            Vec4::new(value(r), value(g), value(b), f32::from(a) / 255.0)
        };
        let Around { pixels, to_right, to_bottom } = Around::new(image, uv);
        let pixels = pixels.map(pixel);
        let mixed =
            |[a, b, c, d]: [Vec4; 4]| a.lerp(b, to_right).lerp(c.lerp(d, to_right), to_bottom);
        let mean = mixed(pixels);
        let covers_alike = pixels.iter().all(|pixel| pixel.w == pixels[0].w);
        if level == 0 || covers_alike || self.meaning == Meaning::Number {
            return mean;
        }
        // Where none of them covers anything, all count alike.
        let share = |pixel: Vec4| pixel.w + 1e-4;
        let weighted =
            mixed(pixels.map(|pixel| (pixel.truncate() * share(pixel)).extend(share(pixel))));
        (weighted.truncate() / weighted.w).extend(mean.w)
    }

    /// How much is covered at a texture coordinate, seen from near.
    #[inline]
    pub(crate) fn coverage(&self, uv: Vec2) -> f32 {
        let Around { pixels, to_right, to_bottom } = Around::new(&self.image, uv);
        let [a, b, c, d] = pixels.map(|pixel| f32::from(self.image.pixels[pixel][3]));
        let (above, below) = (a + (b - a) * to_right, c + (d - c) * to_right);
        (above + (below - above) * to_bottom) / 255.0
    }
}

/// The four pixels around a texture coordinate: two, and the two below them.
struct Around {
    pixels: [usize; 4],
    /// How far it is from the left ones to the right ones.
    to_right: f32,
    /// How far it is from the upper ones to the lower ones.
    to_bottom: f32,
}

impl Around {
    #[inline]
    fn new(image: &Image, uv: Vec2) -> Self {
        let (left, right, to_right) = beside(uv.x, image.width);
        let (top, bottom, to_bottom) = beside(uv.y, image.height);
        let width = image.width as usize;
        let pixels = [
            top * width + left,
            top * width + right,
            bottom * width + left,
            bottom * width + right,
        ];
        Self { pixels, to_right, to_bottom }
    }
}

/// The pixels of a row of `n` on both sides of a coordinate, and how far it is from the one to the
/// other.
#[inline]
fn beside(coordinate: f32, n: u32) -> (usize, usize, f32) {
    // Only the part behind the point counts, for images repeat. Cutting off is one instruction;
    // what is too large for it has no such part.
    let part = coordinate - coordinate as i32 as f32;
    let part = if part < 0.0 { part + 1.0 } else { part };
    let place = part * n as f32 - 0.5;
    let place = if place < 0.0 { place + n as f32 } else { place };
    let first = (place as u32).min(n - 1);
    let next = if first + 1 == n { 0 } else { first + 1 };
    (first as usize, next as usize, (place - first as f32).clamp(0.0, 1.0))
}

/// The image at half its size; each pixel is the mean of four, as far as they are there. Colours
/// are averaged as light, and count as far as they cover.
fn halved(image: &Image, meaning: Meaning, values: &[f32; 256], encoding: &Encoding) -> Image {
    let (width, height) = ((image.width / 2).max(1), (image.height / 2).max(1));
    Image::from_fn(width, height, |x, y| {
        let mut sums = [0.0; 3];
        let (mut coverage, mut weight) = (0, 0.0);
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let (x, y) = ((2 * x + dx).min(image.width - 1), (2 * y + dy).min(image.height - 1));
            let [r, g, b, a] = image.pixels[(y * image.width + x) as usize];
            let share = match meaning {
                // Pixels that are nearly not there must colour nothing, and count all the same
                // where none is there.
                Meaning::Color => f32::from(a) + 1.0 / 16.0,
                Meaning::Number => 1.0,
            };
            for (sum, byte) in sums.iter_mut().zip([r, g, b]) {
                *sum += share * values[usize::from(byte)];
            }
            coverage += u32::from(a);
            weight += share;
        }
        let [r, g, b] = sums.map(|sum| match meaning {
            Meaning::Color => encoding.byte(sum / weight),
            Meaning::Number => (255.0 * sum / weight).round() as u8,
        });
        [r, g, b, ((coverage + 2) / 4) as u8]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(width: u32, height: u32, pixel: impl Fn(u32, u32) -> [u8; 4]) -> Texture {
        Texture::new(&Shared::new(Image::from_fn(width, height, pixel)), Meaning::Number)
    }

    #[test]
    fn pixels_lie_at_their_middles_and_repeat() {
        let texture = numbers(4, 2, |x, y| [51 * x as u8, 255 * y as u8, 0, 255]);
        let at = |x: f32, y: f32| texture.at(Vec2::new(x, y), 0.0);
        for turn in [-1.0, 0.0, 5.0] {
            assert!((at(0.375 + turn, 0.25).x - 0.2).abs() < 1e-5);
            assert!((at(0.5 + turn, 0.5).x - 0.3).abs() < 1e-5);
            assert_eq!(texture.coverage(Vec2::new(0.1, 1e30)), 1.0);
            assert!(texture.at(Vec2::new(f32::MIN, 3e9), 1e30).is_finite());
            // Between the last and the first.
            assert!((at(turn, 0.25).x - 0.3).abs() < 1e-5);
        }
        assert!((at(0.1, 0.75).y - 1.0).abs() < 1e-5);
    }

    #[test]
    fn from_afar_the_mean_is_seen() {
        let texture = numbers(8, 8, |x, y| [255 * ((x + y) % 2) as u8, 0, 0, 255]);
        assert!((texture.at(Vec2::splat(0.3), 8.0).x - 0.5).abs() < 0.01);
        assert!((texture.at(Vec2::splat(0.3), 1e9).x - 0.5).abs() < 0.01);
        let odd = numbers(5, 1, |_, _| [102, 0, 0, 255]);
        assert!((odd.at(Vec2::splat(0.3), 4.0).x - 0.4).abs() < 0.01);
    }

    fn colors(pixel: impl Fn(u32, u32) -> [u8; 4]) -> Texture {
        Texture::new(&Shared::new(Image::from_fn(2, 1, pixel)), Meaning::Color)
    }

    #[test]
    fn what_is_not_there_colours_nothing() {
        let texture = colors(|x, _| if x == 0 { [200, 0, 0, 255] } else { [0; 4] });
        let mean = texture.at(Vec2::splat(0.3), 2.0);
        assert!((mean.x - linear_of_srgb(200)).abs() < 0.02 && (mean.w - 0.5).abs() < 0.01);
        // Nor does it between the pixels of a smaller image.
        let image = Image::from_fn(4, 2, |x, _| if x < 2 { [200, 0, 0, 255] } else { [0; 4] });
        let texture = Texture::new(&Shared::new(image), Meaning::Color);
        let between = texture.at(Vec2::splat(0.5), 2.0);
        assert!((between.x - linear_of_srgb(200)).abs() < 0.02 && (between.w - 0.5).abs() < 0.01);
        // Numbers are there whatever their image covers.
        let texture = numbers(2, 1, |x, _| if x == 0 { [200, 0, 0, 255] } else { [0; 4] });
        assert!((texture.at(Vec2::splat(0.3), 2.0).x - 100.0 / 255.0).abs() < 0.01);
    }

    #[test]
    fn colours_are_averaged_as_light() {
        let texture = colors(|x, _| if x == 0 { [255; 4] } else { [0, 0, 0, 255] });
        assert!((texture.at(Vec2::splat(0.3), 2.0).x - 0.5).abs() < 0.01);
    }

    #[test]
    fn equal_images_are_made_ready_once() {
        let image = || Shared::new(Image::from_fn(4, 4, |x, y| [x as u8, y as u8, 0, 255]));
        let mut textures = Textures::default();
        let [one, same, other] = [Meaning::Color, Meaning::Color, Meaning::Number]
            .map(|meaning| textures.texture(&image(), meaning));
        assert!(Arc::ptr_eq(&one, &same) && !Arc::ptr_eq(&one, &other));
    }
}
