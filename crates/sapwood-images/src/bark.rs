//! Bark: what the surfaces of stems look like, by kind. Every image closes round the stem and
//! goes on along it.

mod marked;
mod ringed;
mod rough;

use sapwood_geom::{Content, Digester, Image, Purpose, Shared, Stream, StreamPath, content};
use sapwood_graph::{MaterialImages, Named};
use sapwood_scene::Component;

use crate::color::{self, Encoded};
use crate::field::Field;
use crate::relief::normal_map;
use crate::size;

/// A patch of bark, upright: compiled to its colours and its normals.
#[derive(Clone, Debug, PartialEq)]
pub struct BarkImage {
    /// How it is structured.
    pub kind: BarkKind,
    /// The linear colour of what lies outermost, each number in 0..=1.
    pub color: [f32; 3],
    /// The linear colour of furrows, marks and rings, each number in 0..=1.
    pub deep_color: [f32; 3],
    /// How deep the relief is, as a share of the patch's width, 0 to 0.5.
    pub depth: f32,
    /// How large ridges, plates and marks are against the patch, 0.1 to 10; 1 suits a patch of
    /// half a metre.
    pub scale: f32,
    /// Pixels along each edge, 1 to [`LARGEST_IMAGE`](crate::LARGEST_IMAGE).
    pub size: u32,
    /// What tells the patch from others of its kind.
    pub seed: u64,
}

content!(BarkImage { kind, color, deep_color, depth, scale, size, seed });

impl Named for BarkImage {
    const NAME: &'static str = "bark_image";
}

impl Component for BarkImage {}

/// How bark is structured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BarkKind {
    /// Next to no structure, as on young maples and on twigs.
    Smooth,
    /// Smooth, with long dashes across and peeling bands, as on birches.
    Lenticels,
    /// Smooth, with dark scars like eyes and short dashes, as on aspens.
    Eyed,
    /// Ridges that part and join along the stem, as on oaks.
    #[default]
    Furrowed,
    /// Ridges broken into blocks, as on black tupelos.
    Blocky,
    /// Flat plates in layers, as on pines.
    Plates,
    /// Rings of leaf scars and fibres, as on palms.
    Ringed,
    /// A smooth culm with nodes, as on bamboo.
    Culm,
    /// Fine lines along, as on stalks of grass.
    Stalk,
}

impl BarkKind {
    /// All kinds with their names.
    pub const NAMES: [(&'static str, Self); 9] = [
        ("smooth", Self::Smooth),
        ("lenticels", Self::Lenticels),
        ("eyed", Self::Eyed),
        ("furrowed", Self::Furrowed),
        ("blocky", Self::Blocky),
        ("plates", Self::Plates),
        ("ringed", Self::Ringed),
        ("culm", Self::Culm),
        ("stalk", Self::Stalk),
    ];

    /// How rough the surface is, 0 a mirror and 1 chalk.
    pub fn roughness(self) -> f32 {
        match self {
            Self::Culm => 0.45,
            Self::Stalk => 0.6,
            Self::Smooth | Self::Lenticels | Self::Eyed => 0.75,
            Self::Furrowed | Self::Blocky | Self::Plates | Self::Ringed => 0.95,
        }
    }

    /// What such bark often looks like: its linear outer colour, and that of what lies deep.
    pub fn colors(self) -> [[f32; 3]; 2] {
        match self {
            Self::Smooth => [[0.19, 0.16, 0.13], [0.05, 0.04, 0.03]],
            Self::Lenticels => [[0.72, 0.7, 0.65], [0.03, 0.026, 0.022]],
            Self::Eyed => [[0.6, 0.59, 0.48], [0.03, 0.028, 0.024]],
            Self::Furrowed => [[0.2, 0.15, 0.11], [0.035, 0.025, 0.02]],
            Self::Blocky => [[0.21, 0.18, 0.155], [0.03, 0.025, 0.02]],
            Self::Plates => [[0.26, 0.155, 0.1], [0.04, 0.025, 0.018]],
            Self::Ringed => [[0.28, 0.235, 0.18], [0.06, 0.045, 0.032]],
            Self::Culm => [[0.2, 0.31, 0.07], [0.09, 0.08, 0.035]],
            Self::Stalk => [[0.5, 0.38, 0.14], [0.28, 0.19, 0.06]],
        }
    }

    /// The depth that suits a patch of half a metre, as a share of its width.
    pub fn depth(self) -> f32 {
        match self {
            Self::Stalk => 0.004,
            Self::Smooth | Self::Lenticels | Self::Eyed => 0.006,
            Self::Culm => 0.02,
            Self::Plates => 0.03,
            Self::Ringed => 0.04,
            Self::Furrowed | Self::Blocky => 0.05,
        }
    }
}

impl Content for BarkKind {
    fn write(&self, digester: &mut Digester) {
        (*self as u8).write(digester);
    }
}

impl Default for BarkImage {
    /// Furrowed, 256 pixels square.
    fn default() -> Self {
        Self::new(BarkKind::default())
    }
}

impl BarkImage {
    /// Bark of this kind with its usual colours and depth, 256 pixels square.
    pub fn new(kind: BarkKind) -> Self {
        let [color, deep_color] = kind.colors();
        Self { kind, color, deep_color, depth: kind.depth(), scale: 1.0, size: 256, seed: 0 }
    }

    /// What is wrong with the patch, in words, or nothing.
    pub fn fault(&self) -> Option<String> {
        size::fault("size", self.size)
            .or_else(|| color::fault("color", &self.color))
            .or_else(|| color::fault("deep_color", &self.deep_color))
            .or_else(|| size::number_fault("depth", self.depth, 0.0, 0.5))
            .or_else(|| size::number_fault("scale", self.scale, 0.1, 10.0))
    }

    /// The patch's colours and normals. Costs some 50 ns for each pixel.
    ///
    /// # Panics
    /// Where the patch has a [fault](Self::fault).
    pub fn images(&self) -> MaterialImages {
        if let Some(fault) = self.fault() {
            panic!("{fault}");
        }
        let patch = Patch { size: self.size, scale: self.scale, seed: self.seed };
        let mut made = match self.kind {
            BarkKind::Smooth => marked::smooth(&patch),
            BarkKind::Lenticels => marked::lenticels(&patch),
            BarkKind::Eyed => marked::eyed(&patch),
            BarkKind::Furrowed => rough::furrowed(&patch),
            BarkKind::Blocky => rough::blocky(&patch),
            BarkKind::Plates => rough::plates(&patch),
            BarkKind::Ringed => ringed::ringed(&patch),
            BarkKind::Culm => ringed::culm(&patch),
            BarkKind::Stalk => ringed::stalk(&patch),
        };
        let (deep, color) = (Encoded::of(self.deep_color), Encoded::of(self.color));
        let pixel = |tone: &f32| deep.mix(color, *tone).pixel(u8::MAX);
        let pixels = made.tones.values().iter().map(pixel).collect();
        let base_color = Image { width: self.size, height: self.size, pixels };
        let depth = self.depth;
        made.heights.values_mut().iter_mut().for_each(|height| *height *= depth);
        MaterialImages {
            base_color: Some(Shared::new(base_color)),
            normal: Some(Shared::new(normal_map(&made.heights))),
            ..MaterialImages::default()
        }
    }
}

/// What kinds of bark are made in.
struct Patch {
    size: u32,
    scale: f32,
    seed: u64,
}

impl Patch {
    /// The random numbers for one purpose.
    fn stream(&self, purpose: &'static str) -> Stream {
        Stream::new(StreamPath::new(self.seed), Purpose(purpose))
    }

    /// As many whole cells as come nearest to `n` at scale 1.
    fn n(&self, n: f32) -> u32 {
        (n / self.scale).round().clamp(1.0, 1024.0) as u32
    }

    fn cells(&self, across: f32, down: f32) -> [u32; 2] {
        [self.n(across), self.n(down)]
    }

    fn noise(&self, purpose: &'static str, across: f32, down: f32, octaves: u32) -> Field {
        let size = [self.size; 2];
        Field::noise(size, self.cells(across, down), octaves, &mut self.stream(purpose))
    }

    /// Pixels for each such share of the patch's width.
    fn pixels(&self, share: f32) -> f32 {
        share * self.size as f32
    }
}

/// A patch before it is coloured.
struct Made {
    /// 0 deep to 1 high.
    heights: Field,
    /// 0 for the deep colour, 1 for the outer one; lighter and darker spots reach beyond.
    tones: Field,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made(kind: BarkKind) -> [Shared<Image>; 2] {
        let images = BarkImage { size: 128, ..BarkImage::new(kind) }.images();
        [images.base_color.unwrap(), images.normal.unwrap()]
    }

    /// The mean difference of neighbouring rows and columns where it is greatest, and that
    /// across both seams.
    fn steps(image: &Image) -> [f64; 2] {
        let n = image.width as usize;
        let at = |x: usize, y: usize| image.pixels[y * n + x];
        let apart = |a: [u8; 4], b: [u8; 4]| {
            (0..3).map(|i| f64::from(a[i].abs_diff(b[i]))).sum::<f64>() / (3 * n) as f64
        };
        let columns = |a: usize, b: usize| (0..n).map(|i| apart(at(a, i), at(b, i))).sum::<f64>();
        let rows = |a: usize, b: usize| (0..n).map(|i| apart(at(i, a), at(i, b))).sum::<f64>();
        let inside =
            |step: &dyn Fn(usize, usize) -> f64| (1..n).map(|i| step(i - 1, i)).fold(0.0, f64::max);
        let over = |step: &dyn Fn(usize, usize) -> f64| step(n - 1, 0) - 1.2 * inside(step) - 0.02;
        [inside(&columns), over(&columns).max(over(&rows))]
    }

    #[test]
    fn every_kind_is_sound_differs_and_has_no_seam() {
        let mut seen: Vec<[Shared<Image>; 2]> = Vec::new();
        for (name, kind) in BarkKind::NAMES {
            let images = made(kind);
            for image in &images {
                assert_eq!(image.fault(), None);
                assert!(image.pixels.iter().all(|pixel| pixel[3] == 255));
                let [inside, over] = steps(image);
                assert!(inside > 0.2, "{name} has no structure: {inside}");
                assert!(over < 0.0, "{name}: {over} more at the seam than anywhere inside");
            }
            assert!(seen.iter().all(|other| *other != images), "{name}");
            seen.push(images);
        }
    }

    #[test]
    fn the_same_bark_has_the_same_pixels_and_another_seed_others() {
        let bark = BarkImage { size: 64, ..BarkImage::default() };
        assert_eq!(bark.images(), bark.images());
        assert_ne!(bark.images(), BarkImage { seed: 1, ..bark.clone() }.images());
    }

    #[test]
    fn colors_are_those_asked_for() {
        let pale =
            BarkImage { color: [0.6, 0.6, 0.5], size: 128, ..BarkImage::new(BarkKind::Smooth) };
        let image = pale.images().base_color.unwrap();
        let mean = |channel: usize| {
            let sum: u64 = image.pixels.iter().map(|pixel| u64::from(pixel[channel])).sum();
            sum as f64 / image.pixels.len() as f64
        };
        let wanted = Encoded::of(pale.color).0;
        for (channel, wanted) in wanted.to_array().into_iter().enumerate() {
            assert!((mean(channel) - f64::from(wanted)).abs() < 12.0, "{} {wanted}", mean(channel));
        }
    }

    #[test]
    fn faults_name_field_value_and_range() {
        let check = |bark: BarkImage, told: &str| assert_eq!(bark.fault().as_deref(), Some(told));
        let bark = BarkImage::default();
        assert_eq!(bark.fault(), None);
        check(
            BarkImage { size: 0, ..bark.clone() },
            "size is 0; accepted: a whole number of pixels from 1 to 4096",
        );
        check(
            BarkImage { size: 5000, ..bark.clone() },
            "size is 5000; accepted: a whole number of pixels from 1 to 4096",
        );
        check(
            BarkImage { depth: f32::NAN, ..bark.clone() },
            "depth is NaN; accepted: a number at least 0 and at most 0.5",
        );
        check(
            BarkImage { scale: 0.0, ..bark.clone() },
            "scale is 0; accepted: a number at least 0.1 and at most 10",
        );
        assert!(BarkImage { deep_color: [2.0, 0.0, 0.0], ..bark }.fault().is_some());
    }

    #[test]
    fn the_smallest_images_are_images() {
        for (_, kind) in BarkKind::NAMES {
            for size in [1, 2, 3, 7] {
                for scale in [0.1, 10.0] {
                    let images = BarkImage { size, scale, ..BarkImage::new(kind) }.images();
                    assert_eq!(images.base_color.unwrap().fault(), None);
                }
            }
        }
    }
}
