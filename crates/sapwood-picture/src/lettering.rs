//! Lines of text on a picture, in the bitmap font of the crate `noto-sans-mono-bitmap`.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};
use sapwood_geom::Image;

/// How large letters are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Lettering {
    height: RasterHeight,
    weight: FontWeight,
}

impl Lettering {
    /// The lettering that suits pictures of this many pixels in width.
    pub(crate) fn small(width: u32) -> Self {
        let height = match width {
            0..400 => RasterHeight::Size16,
            400..600 => RasterHeight::Size20,
            600..900 => RasterHeight::Size24,
            _ => RasterHeight::Size32,
        };
        Self { height, weight: FontWeight::Regular }
    }

    /// The next larger one, in bold.
    pub(crate) fn heading(self) -> Self {
        let height = match self.height {
            RasterHeight::Size16 => RasterHeight::Size20,
            RasterHeight::Size20 => RasterHeight::Size24,
            RasterHeight::Size24 | RasterHeight::Size32 => RasterHeight::Size32,
        };
        Self { height, weight: FontWeight::Bold }
    }

    /// Pixels from one line to the next.
    pub(crate) fn height(self) -> u32 {
        self.height.val() as u32
    }

    /// Pixels that a line of text takes.
    pub(crate) fn width(self, text: &str) -> u32 {
        let letter = get_raster_width(self.weight, self.height) as u32;
        letter.saturating_mul(text.chars().count().try_into().unwrap_or(u32::MAX))
    }

    /// Writes a line whose upper left corner is at `left`, `top`, in the opaque colour `ink`.
    /// What is not on the picture is left out; letters that the font has not are question marks.
    pub(crate) fn write(self, text: &str, left: u32, top: u32, ink: [u8; 3], on: &mut Image) {
        let step = get_raster_width(self.weight, self.height) as u32;
        for (number, letter) in (0..).zip(text.chars()) {
            let raster = |letter| get_raster(letter, self.weight, self.height);
            let Some(letter) = raster(letter).or_else(|| raster('?')) else { continue };
            for (y, row) in (top..on.height).zip(letter.rows()) {
                let first = left.saturating_add(step.saturating_mul(number));
                for (x, coverage) in (first..on.width).zip(row) {
                    let pixel = &mut on.pixels[y as usize * on.width as usize + x as usize];
                    *pixel = inked(*pixel, ink, *coverage);
                }
            }
        }
    }
}

/// A pixel under ink of some coverage.
fn inked(pixel: [u8; 4], ink: [u8; 3], coverage: u8) -> [u8; 4] {
    let (over, under) = (u32::from(coverage), u32::from(pixel[3]));
    // In 255ths of 255ths.
    let kept = under * (255 - over);
    let total = over * 255 + kept;
    if total == 0 {
        return pixel;
    }
    let mut mixed = [0; 4];
    for (channel, (ink, old)) in mixed.iter_mut().zip(ink.into_iter().zip(pixel)) {
        let sum = u32::from(ink) * over * 255 + u32::from(old) * kept;
        *channel = ((sum + total / 2) / total) as u8;
    }
    mixed[3] = ((total + 127) / 255) as u8;
    mixed
}

#[cfg(test)]
mod tests {
    use super::*;

    fn blank(width: u32, height: u32) -> Image {
        Image::from_fn(width, height, |_, _| [255; 4])
    }

    #[test]
    fn letters_keep_to_their_place() {
        let lettering = Lettering::small(100);
        let (width, height) = (lettering.width("seed 7"), lettering.height());
        let mut image = blank(width + 20, height + 10);
        lettering.write("seed 7", 10, 5, [0; 3], &mut image);
        let mut n_dark = 0;
        for (i, pixel) in image.pixels.iter().enumerate() {
            let (x, y) = (i as u32 % image.width, i as u32 / image.width);
            let is_inside = (10..10 + width).contains(&x) && (5..5 + height).contains(&y);
            assert!(is_inside || *pixel == [255; 4], "{x} {y}");
            n_dark += u32::from(pixel[0] < 128);
        }
        assert!((60..width * height / 2).contains(&n_dark), "{n_dark}");
    }

    #[test]
    fn unknown_letters_are_question_marks_and_too_long_lines_end_at_the_edge() {
        let lettering = Lettering::small(100);
        let written = |text: &str| {
            let mut image = blank(20, 10);
            lettering.write(text, 3, 0, [9, 8, 7], &mut image);
            image
        };
        assert_eq!(written("\u{4e2d}"), written("?"));
        assert_ne!(written("\u{e9}"), written("?"));
        assert_ne!(written("wwwwww"), blank(20, 10));
        lettering.write("w", u32::MAX, u32::MAX, [0; 3], &mut blank(1, 1));
    }

    #[test]
    fn ink_covers_what_was_not_covered() {
        assert_eq!(inked([0; 4], [10, 20, 30], 0), [0; 4]);
        assert_eq!(inked([0; 4], [10, 20, 30], 128), [10, 20, 30, 128]);
        assert_eq!(inked([200, 0, 0, 255], [0, 100, 0], 255), [0, 100, 0, 255]);
        assert_eq!(inked([200, 0, 0, 255], [0, 100, 0], 51), [160, 20, 0, 255]);
    }
}
