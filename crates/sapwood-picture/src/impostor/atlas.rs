//! All images of an impostor side by side: cut so that as much is covered as before, with colours
//! beyond their edges.

use sapwood_geom::Image;
use sapwood_geom::glam::{Vec2, Vec3};

use super::LEAST_COVERAGE;
use crate::PictureError;
use crate::film::{Encoding, linear_of_srgb};

/// Places in each pixel, along each edge, at which coverage is looked at between pixels.
const PLACES: u32 = 4;

/// How often the factor of the coverage is halved on.
const STEPS: u32 = 12;

/// The largest factor of the coverage.
const LARGEST_FACTOR: f32 = 32.0;

/// By how much colours are corrected at most.
const LARGEST_CORRECTION: f32 = 1.5;

/// Pixels along an edge of the image: what graphics hardware takes.
const MOST_PIXELS: u32 = 16_384;

/// Images side by side.
pub(super) struct Atlas {
    cell: [u32; 2],
    /// Cells in a row.
    columns: u32,
    image: Image,
    encoding: Encoding,
}

impl Atlas {
    /// Room for so many cells, about as wide as high.
    ///
    /// # Errors
    /// When the image would have an edge of more than [`MOST_PIXELS`].
    pub(super) fn new(cell: [u32; 2], n_cells: u32) -> Result<Self, PictureError> {
        let [width, height] = cell;
        let area = f64::from(width) * f64::from(height) * f64::from(n_cells);
        let columns = libm::round(libm::sqrt(area) / f64::from(width)) as u32;
        let columns = columns.clamp(1, n_cells.max(1));
        let rows = n_cells.div_ceil(columns);
        let longest = (columns * width).max(rows * height);
        if longest > MOST_PIXELS {
            let (name, accepted) = ("pixels along an edge of all images together", "8 to 16384");
            return Err(PictureError::Impostor { name, value: longest, accepted });
        }
        let image = Image::from_fn(columns * width, rows * height, |_, _| [0; 4]);
        Ok(Self { cell, columns, image, encoding: Encoding::new() })
    }

    fn corner(&self, number: u32) -> [u32; 2] {
        let [width, height] = self.cell;
        [number % self.columns * width, number / self.columns * height]
    }

    /// The texture coordinates of a cell: those of its upper left and its lower right corner.
    pub(super) fn place(&self, number: u32) -> [Vec2; 2] {
        let [x, y] = self.corner(number);
        let [width, height] = self.cell;
        let size = Vec2::new(self.image.width as f32, self.image.height as f32);
        [[x, y], [x + width, y + height]].map(|[x, y]| Vec2::new(x as f32, y as f32) / size)
    }

    /// Puts a picture of the size of a cell into one.
    pub(super) fn put(&mut self, number: u32, picture: &Image) {
        let [left, top] = self.corner(number);
        let finished = Cell::new(picture, &self.encoding).finish();
        let [width, height] = self.cell;
        for y in 0..height {
            for x in 0..width {
                let pixel = finished[(y * width + x) as usize];
                self.image.pixels[((top + y) * self.image.width + left + x) as usize] = pixel;
            }
        }
    }

    pub(super) fn finish(self) -> Image {
        self.image
    }
}

/// One picture, its colours as light.
struct Cell<'a> {
    width: usize,
    height: usize,
    colors: Vec<Vec3>,
    /// From 0 to 1.
    coverage: Vec<f32>,
    encoding: &'a Encoding,
}

impl<'a> Cell<'a> {
    fn new(picture: &Image, encoding: &'a Encoding) -> Self {
        let color = |[r, g, b, _]: &[u8; 4]| Vec3::from([*r, *g, *b].map(linear_of_srgb));
        Self {
            width: picture.width as usize,
            height: picture.height as usize,
            colors: picture.pixels.iter().map(color).collect(),
            coverage: picture.pixels.iter().map(|pixel| f32::from(pixel[3]) / 255.0).collect(),
            encoding,
        }
    }

    fn finish(mut self) -> Vec<[u8; 4]> {
        let before = self.mean_covered();
        self.spread_colors();
        self.keep_coverage();
        self.keep_color(before);
        let bytes = |(color, coverage): (&Vec3, &f32)| {
            let [r, g, b] = color.to_array().map(|channel| self.encoding.byte(channel));
            [r, g, b, (255.0 * coverage).round() as u8]
        };
        self.colors.iter().zip(&self.coverage).map(bytes).collect()
    }

    /// The mean colour of what is covered.
    fn mean_covered(&self) -> Vec3 {
        let sum = |sum: Vec3, (color, share): (&Vec3, &f32)| sum + *color * *share;
        let light = self.colors.iter().zip(&self.coverage).fold(Vec3::ZERO, sum);
        light / self.coverage.iter().sum::<f32>().max(f32::MIN_POSITIVE)
    }

    /// Gives what is not covered the colour of what is near, so that no edge shows another one
    /// where colours are mixed between pixels: the mean of larger and larger squares.
    fn spread_colors(&mut self) {
        let (mut width, mut height) = (self.width, self.height);
        let weighted = |(color, share): (&Vec3, &f32)| color.extend(1.0) * *share;
        let mut levels = vec![self.colors.iter().zip(&self.coverage).map(weighted).collect()];
        let mut sizes = vec![(width, height)];
        while width.max(height) > 1 {
            let (wide, last): (usize, &Vec<_>) = (width, &levels[levels.len() - 1]);
            let high = height;
            (width, height) = (width.div_ceil(2), height.div_ceil(2));
            let mut next = vec![sapwood_geom::glam::Vec4::ZERO; width * height];
            for y in 0..high {
                for x in 0..wide {
                    next[y / 2 * width + x / 2] += last[y * wide + x];
                }
            }
            levels.push(next);
            sizes.push((width, height));
        }
        for y in 0..self.height {
            for x in 0..self.width {
                let here = y * self.width + x;
                if self.coverage[here] > 0.0 {
                    continue;
                }
                let near =
                    levels.iter().zip(&sizes).enumerate().find_map(|(level, (sums, size))| {
                        let sum = sums[(y >> level) * size.0 + (x >> level)];
                        (sum.w > 0.0).then(|| sum.truncate() / sum.w)
                    });
                self.colors[here] = near.unwrap_or(Vec3::ZERO);
            }
        }
    }

    /// Multiplies the coverage, so that as much reaches the least coverage as was covered.
    fn keep_coverage(&mut self) {
        let covered: f32 = self.coverage.iter().sum();
        let original = self.coverage.clone();
        let (mut low, mut high) = (1.0 / LARGEST_FACTOR, LARGEST_FACTOR);
        for _ in 0..STEPS {
            // Between factors as between powers.
            let factor = libm::sqrtf(low * high);
            self.multiply(&original, factor);
            if self.there().1 < covered { low = factor } else { high = factor }
        }
        self.multiply(&original, libm::sqrtf(low * high));
    }

    fn multiply(&mut self, original: &[f32], factor: f32) {
        for (coverage, original) in self.coverage.iter_mut().zip(original) {
            // As the bytes that it will be.
            *coverage = (255.0 * (original * factor).min(1.0)).round() / 255.0;
        }
    }

    /// Multiplies colours, so that what is there has the mean that it had.
    fn keep_color(&mut self, before: Vec3) {
        let (light, n_pixels) = self.there();
        let correction = before * n_pixels / light.max(Vec3::splat(f32::MIN_POSITIVE));
        let correction = correction
            .clamp(Vec3::splat(1.0 / LARGEST_CORRECTION), Vec3::splat(LARGEST_CORRECTION));
        self.colors.iter_mut().for_each(|color| *color *= correction);
    }

    /// The sum of the colours, and the number of pixels, at which the board is there.
    fn there(&self) -> (Vec3, f32) {
        let (mut light, mut n_places) = (Vec3::ZERO, 0u32);
        let step = |place: u32| (place as f32 + 0.5) / PLACES as f32;
        for y in 0..self.height.saturating_sub(1) {
            for x in 0..self.width.saturating_sub(1) {
                let first = y * self.width + x;
                let around = [first, first + 1, first + self.width, first + self.width + 1];
                let coverage = around.map(|pixel| self.coverage[pixel]);
                let most = coverage.into_iter().fold(0.0, f32::max);
                if most < LEAST_COVERAGE {
                    continue;
                }
                let colors = around.map(|pixel| self.colors[pixel]);
                for (row, column) in (0..PLACES).flat_map(|row| (0..PLACES).map(move |c| (row, c)))
                {
                    let (right, down) = (step(column), step(row));
                    let mix = |[a, b, c, d]: [f32; 4]| {
                        let (above, below) = (a + (b - a) * right, c + (d - c) * right);
                        above + (below - above) * down
                    };
                    if mix(coverage) >= LEAST_COVERAGE {
                        n_places += 1;
                        let [a, b, c, d] = colors;
                        light += a.lerp(b, right).lerp(c.lerp(d, right), down);
                    }
                }
            }
        }
        let pixel = 1.0 / (PLACES * PLACES) as f32;
        (light * pixel, n_places as f32 * pixel)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture whose coverage is nowhere half, with red in the middle and green around it.
    fn speckled() -> Image {
        Image::from_fn(64, 48, |x, y| {
            let is_inside = (8..56).contains(&x) && (8..40).contains(&y);
            let speckle = (x * 7919 + y * 104_729) % 97;
            let coverage = if is_inside && speckle < 60 { 20 + speckle as u8 } else { 0 };
            let is_middle = (24..40).contains(&x);
            let color = if is_middle { [200, 10, 10] } else { [10, 120, 10] };
            let [r, g, b] = if coverage > 0 { color } else { [0; 3] };
            [r, g, b, coverage]
        })
    }

    #[test]
    fn as_much_is_there_as_was_covered_and_as_bright() {
        let encoding = Encoding::new();
        let before = Cell::new(&speckled(), &encoding);
        let covered: f32 = before.coverage.iter().sum();
        let (mean, none) = (before.mean_covered(), before.there().1);
        assert_eq!(none, 0.0, "by halves nothing would be there");
        let image = Image { width: 64, height: 48, pixels: before.finish() };
        let after = Cell::new(&image, &encoding);
        let (light, n_there) = after.there();
        assert!((n_there / covered - 1.0).abs() < 0.02, "{n_there} of {covered}");
        let off = (light / n_there - mean).abs() / mean;
        assert!(off.max_element() < 0.02, "{off}");
    }

    #[test]
    fn what_is_not_there_has_the_colour_of_what_is_near() {
        let encoding = Encoding::new();
        let image =
            Image { width: 64, height: 48, pixels: Cell::new(&speckled(), &encoding).finish() };
        let at = |x: usize, y: usize| image.pixels[y * 64 + x];
        let [[r, g, _, corner], [_, _, _, edge]] = [at(0, 0), at(32, 0)];
        assert!(g > r && corner == 0 && edge == 0, "{r} {g}");
    }

    #[test]
    fn cells_lie_side_by_side() {
        let mut atlas = Atlas::new([8, 16], 5).unwrap();
        assert_eq!((atlas.columns, atlas.image.width, atlas.image.height), (3, 24, 32));
        let grey = Image::from_fn(8, 16, |_, _| [90, 90, 90, 255]);
        atlas.put(4, &grey);
        let [first, end] = atlas.place(4);
        assert_eq!((first, end), (Vec2::new(1.0 / 3.0, 0.5), Vec2::new(2.0 / 3.0, 1.0)));
        let image = atlas.finish();
        let n_there = image.pixels.iter().filter(|pixel| pixel[3] > 0).count();
        assert_eq!((n_there, image.pixels[16 * 24 + 8][3] > 0), (128, true));
    }
}
