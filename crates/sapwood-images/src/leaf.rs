//! Leaves: their outline as coverage, their veins and their colours. The mesh that shows such an
//! image is as coarse as [`LeafOutline::hull`].

mod outline;
mod shapes;
mod veins;

use sapwood_geom::{Image, Purpose, Shared, Stream, StreamPath, content};
use sapwood_graph::{MaterialImages, Named};
use sapwood_scene::Component;

use crate::color::{self, Encoded};
use crate::field::Field;
use crate::size;

pub use shapes::LeafOutline;

/// The upper side of a leaf, its tip at the middle of the upper edge and its base at that of the
/// lower: compiled to colours and coverage.
#[derive(Clone, Debug, PartialEq)]
pub struct LeafImage {
    /// Where the leaf ends.
    pub outline: LeafOutline,
    /// The linear colour between the veins, each number in 0..=1.
    pub color: [f32; 3],
    /// The linear colour of the veins, each number in 0..=1.
    pub vein_color: [f32; 3],
    /// How wide the image is against its length once it lies on a leaf, 0.01 to 2: veins and
    /// teeth keep their proportions, and the image has so many pixels fewer across.
    pub width: f32,
    /// Pixels along the leaf, 1 to [`LARGEST_IMAGE`](crate::LARGEST_IMAGE); across it as many as
    /// the width takes, in powers of two, at least 16.
    pub size: u32,
    /// What tells the leaf from others of its kind.
    pub seed: u64,
}

content!(LeafImage { outline, color, vein_color, width, size, seed });

impl Named for LeafImage {
    const NAME: &'static str = "leaf_image";
}

impl Component for LeafImage {}

impl Default for LeafImage {
    /// Ovate, green, as wide as long, 256 pixels square.
    fn default() -> Self {
        Self {
            outline: LeafOutline::Ovate,
            color: [0.07, 0.17, 0.03],
            vein_color: [0.2, 0.3, 0.09],
            width: 1.0,
            size: 256,
            seed: 0,
        }
    }
}

impl LeafImage {
    /// What is wrong with the leaf, in words, or nothing.
    pub fn fault(&self) -> Option<String> {
        size::fault("size", self.size)
            .or_else(|| color::fault("color", &self.color))
            .or_else(|| color::fault("vein_color", &self.vein_color))
            .or_else(|| size::number_fault("width", self.width, 0.01, 2.0))
    }

    /// Pixels across and along.
    pub fn pixels(&self) -> [u32; 2] {
        let across = (self.size as f32 * self.width) as u32;
        let across = across.next_power_of_two().clamp(16, size::LARGEST_IMAGE);
        [if self.width >= 0.75 { self.size } else { across.min(self.size) }, self.size]
    }

    /// The leaf's colours and coverage; colours go on beyond the outline, so that no fringe shows
    /// where pixels are averaged. Costs some 30 ns for each pixel.
    ///
    /// # Panics
    /// Where the leaf has a [fault](Self::fault).
    pub fn images(&self) -> MaterialImages {
        if let Some(fault) = self.fault() {
            panic!("{fault}");
        }
        let [width, height] = self.pixels();
        let outline = outline::polygons(self.outline, self.width);
        let coverage = outline::coverage(&outline, [width, height]);
        let veins = veins::drawn(self.outline, self.width, [width, height]);
        let stream = |purpose| Stream::new(StreamPath::new(self.seed), Purpose(purpose));
        let cells = [(4.0 * self.width).ceil() as u32 + 1, 5];
        let clouds = Field::noise([width, height], cells, 4, &mut stream("leaf.clouds"));
        let (color, vein) = (Encoded::of(self.color), Encoded::of(self.vein_color));
        let values = clouds.values().iter().zip(veins.values()).zip(&coverage);
        let pixels = values.map(|((cloud, line), covered)| {
            // Between veins the blade bulges and lies darker.
            let shade = 1.0 + 0.16 * cloud + 0.14 * (line - 0.3);
            color.times(shade).mix(vein, 0.75 * line * line).pixel(*covered)
        });
        let image = Image { width, height, pixels: pixels.collect() };
        MaterialImages { base_color: Some(Shared::new(image)), ..MaterialImages::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(outline: LeafOutline, width: f32) -> Shared<Image> {
        let leaf = LeafImage { outline, width, size: 128, ..LeafImage::default() };
        assert_eq!(leaf.fault(), None);
        leaf.images().base_color.unwrap()
    }

    /// Whether a point, from the midrib and from the base, lies in the hull.
    fn is_inside(hull: &[[f32; 2]], across: f32, along: f32) -> bool {
        let right = hull.windows(2).find_map(|ends| {
            let [[x0, y0], [x1, y1]] = [ends[0], ends[1]];
            let t = (along - y0) / (y1 - y0);
            (0.0..=1.0).contains(&t).then_some(x0 + (x1 - x0) * t)
        });
        right.is_some_and(|right| across.abs() <= right)
    }

    #[test]
    fn every_outline_lies_in_its_hull_and_fills_most_of_it() {
        for (name, outline) in LeafOutline::NAMES {
            for width in [1.0, 0.3, 0.05] {
                let image = image(outline, width);
                let hull = outline.hull();
                let (mut inside, mut covered) = (0, 0);
                for (i, pixel) in image.pixels.iter().enumerate() {
                    let x = (i as u32 % image.width) as f32 + 0.5;
                    let y = (i as u32 / image.width) as f32 + 0.5;
                    let across = 2.0 * x / image.width as f32 - 1.0;
                    let along = 1.0 - y / image.height as f32;
                    let is_in = is_inside(hull, across, along);
                    inside += u32::from(is_in);
                    covered += u32::from(pixel[3] >= 128);
                    assert!(is_in || pixel[3] < 128, "{name} {width}: {across} {along}");
                }
                let share = f64::from(covered) / f64::from(inside);
                assert!(share > 0.3, "{name} {width}: {share}");
            }
        }
    }

    #[test]
    fn leaves_begin_at_the_base_and_reach_the_tip() {
        for (name, outline) in LeafOutline::NAMES {
            let image = image(outline, 0.5);
            let row = |y: u32| {
                let row = &image.pixels[(y * image.width) as usize..][..image.width as usize];
                row.iter().any(|pixel| pixel[3] > 0)
            };
            assert!(row(2) && row(image.height - 20), "{name}");
        }
    }

    #[test]
    fn colors_go_on_where_nothing_is_covered() {
        let image = image(LeafOutline::Maple, 1.0);
        let greens = |covered: bool| {
            let chosen = image.pixels.iter().filter(|pixel| (pixel[3] > 127) == covered);
            let greens: Vec<f64> = chosen.map(|pixel| f64::from(pixel[1])).collect();
            greens.iter().sum::<f64>() / greens.len() as f64
        };
        assert!((greens(true) - greens(false)).abs() < 25.0, "{} {}", greens(true), greens(false));
    }

    #[test]
    fn narrow_leaves_have_fewer_pixels() {
        let pixels = |width, size| LeafImage { width, size, ..LeafImage::default() }.pixels();
        assert_eq!(pixels(1.0, 256), [256, 256]);
        assert_eq!(pixels(0.5, 256), [128, 256]);
        assert_eq!(pixels(0.2, 256), [64, 256]);
        assert_eq!(pixels(0.01, 256), [16, 256]);
        assert_eq!(pixels(0.01, 8), [8, 8]);
    }

    #[test]
    fn faults_name_field_value_and_range() {
        let told = |leaf: LeafImage| leaf.fault();
        let leaf = LeafImage::default();
        assert_eq!(told(leaf.clone()), None);
        let size = "size is 0; accepted: a whole number of pixels from 1 to 4096";
        assert_eq!(told(LeafImage { size: 0, ..leaf.clone() }).as_deref(), Some(size));
        let width = "width is 0; accepted: a number at least 0.01 and at most 2";
        assert_eq!(told(LeafImage { width: 0.0, ..leaf }).as_deref(), Some(width));
    }
}
