//! The random choices of a script.

use sapwood::geom::glam::{Affine3, Mat3, Vec3};
use sapwood::geom::{Purpose, Stream, StreamPath};

use super::kinds::Variant;
use super::mirror::What;

pub(super) struct Dice(Stream);

impl Dice {
    pub(super) fn new(seed: u64) -> Self {
        Self(Stream::new(StreamPath::new(seed), Purpose("script")))
    }

    pub(super) fn below(&mut self, n: usize) -> usize {
        ((u128::from(self.0.bits()) * n as u128) >> 64) as usize
    }

    pub(super) fn chance(&mut self, percent: usize) -> bool {
        self.below(100) < percent
    }

    pub(super) fn pick<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }

    /// A number between `low` and `high` whose logarithm is evenly distributed.
    pub(super) fn log_even(&mut self, low: f32, high: f32) -> usize {
        (low.ln() + (high / low).ln() * self.0.unit()).exp().round() as usize
    }

    /// A move by whole metres, at times with a quarter turn or a reflection: all products are
    /// exact, in whatever order they are taken.
    pub(super) fn transform(&mut self) -> Affine3 {
        let mut whole = || self.below(17) as f32 - 8.0;
        let translation = Vec3::new(whole(), whole(), whole());
        let matrix3 = match self.below(8) {
            0 => Mat3::from_cols(Vec3::Y, -Vec3::X, Vec3::Z),
            1 => Mat3::from_cols(Vec3::Z, Vec3::Y, -Vec3::X),
            2 => Mat3::from_cols(-Vec3::X, Vec3::Y, Vec3::Z),
            _ => Mat3::IDENTITY,
        };
        let translation = if self.chance(2) { Vec3::INFINITY } else { translation };
        Affine3 { matrix3, translation }
    }

    pub(super) fn size(&mut self) -> f32 {
        1.0 + self.below(8) as f32 / 2.0
    }

    pub(super) fn tag(&mut self) -> u32 {
        self.below(40) as u32
    }

    pub(super) fn variant(&mut self) -> Variant {
        Variant {
            plain_factor: 1 + self.below(3) as u32,
            placed_is_flat: self.chance(30),
            has_tagged: self.chance(80),
        }
    }

    fn attribute(&mut self) -> What {
        let size = self.chance(50).then(|| self.size());
        let tag = self.chance(40).then(|| self.tag());
        let seed = self.chance(25).then(|| self.below(4) as u64);
        What::Attribute { size, tag, seed }
    }

    pub(super) fn what(&mut self) -> What {
        match self.below(24) {
            0..=4 => What::Group,
            5..=8 => What::Transform(self.transform()),
            9..=11 => self.attribute(),
            12 => What::Switch(self.chance(70)),
            13 => What::Porch(self.tag()),
            14 => What::Spinner(self.below(4) as f32),
            _ => self.leaf(),
        }
    }

    fn leaf(&mut self) -> What {
        match self.below(10) {
            0 | 1 => What::Placed,
            2 => What::Sized,
            3 => What::Tagged,
            4 => What::Keyed,
            5 => What::Gridded,
            6 => What::Chooser,
            7 => What::Nest(self.below(4) as u32),
            8 => What::Fragile(self.below(4) as u32),
            _ => What::Plain(self.size()),
        }
    }

    /// Other parameters for a node of the same kind.
    pub(super) fn changed(&mut self, what: What) -> What {
        match what {
            What::Transform(_) => What::Transform(self.transform()),
            What::Attribute { .. } => self.attribute(),
            What::Switch(on) => What::Switch(!on),
            What::Porch(_) => What::Porch(self.tag()),
            What::Spinner(_) => What::Spinner(self.below(4) as f32),
            What::Plain(_) => What::Plain(self.size()),
            What::Nest(_) => What::Nest(self.below(4) as u32),
            What::Fragile(_) => What::Fragile(self.below(4) as u32),
            same => same,
        }
    }
}
