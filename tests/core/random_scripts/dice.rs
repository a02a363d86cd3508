//! The random choices of a script.

use sapwood::geom::glam::{Affine3, Mat3, Vec3};
use sapwood::geom::{Purpose, Stream, StreamPath};
use sapwood::graph::{Eye, Facing};
use sapwood::scene::{PushMode, Style};

use super::kinds::{LimitedBy, Variant};
use super::what::{Push, Pushes, Turning, What};

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
            yarn_factor: self.chance(85).then(|| 1 + self.below(2) as u32),
        }
    }

    pub(super) fn mode(&mut self) -> PushMode {
        let modes = [PushMode::Normal, PushMode::Force, PushMode::Protect, PushMode::Inherit];
        let place = self.below(10);
        modes[place.saturating_sub(5).min(3)]
    }

    /// A push of a value, or of what the value sub-graph answers.
    pub(super) fn push<T>(&mut self, value: impl FnOnce(&mut Self) -> T) -> Push<T> {
        let mode = self.mode();
        let held = (!self.chance(25)).then(|| value(self));
        Push { mode, held }
    }

    /// A push in so many of a hundred cases.
    fn push_in<T>(
        &mut self,
        percent: usize,
        value: impl FnOnce(&mut Self) -> T,
    ) -> Option<Push<T>> {
        self.chance(percent).then(|| self.push(value))
    }

    pub(super) fn path(&mut self) -> StreamPath {
        StreamPath::new(self.below(4) as u64)
    }

    pub(super) fn style(&mut self) -> Style {
        self.pick(&[Style::Solid, Style::Solid, Style::Wire, Style::Skeleton])
    }

    pub(super) fn look(&mut self) -> u8 {
        self.below(4) as u8
    }

    fn attribute(&mut self) -> What {
        What::Attribute(Pushes {
            size: self.push_in(45, Self::size),
            tag: self.push_in(40, Self::tag),
            path: self.push_in(25, Self::path),
            place: self.push_in(15, Self::transform),
            style: self.push_in(20, Self::style),
            look: self.push_in(20, Self::look),
        })
    }

    fn choice(&mut self) -> Option<usize> {
        (!self.chance(10)).then(|| self.below(3))
    }

    /// Where one level gives way to the next.
    fn distances(&mut self) -> [f32; 2] {
        let first = 2.0 + self.below(12) as f32;
        [first, first + self.below(16) as f32]
    }

    fn turning(&mut self) -> Turning {
        let axes = [Vec3::X, Vec3::Y, -2.0 * Vec3::Z, Vec3::new(1.0, 1.0, 0.5)];
        let axis = if self.chance(3) { Vec3::ZERO } else { self.pick(&axes) };
        let velocity = if self.chance(3) { f32::NAN } else { self.below(8) as f32 / 4.0 - 1.0 };
        Turning { axis, velocity, phase: self.below(3) as f32 }
    }

    fn facing(&mut self) -> Facing {
        let axes = [Vec3::Y, Vec3::X, Vec3::new(1.0, 2.0, 0.5), Vec3::ZERO];
        let place = self.below(20);
        let axis = axes[place.saturating_sub(16)];
        if place < 10 { Facing::Eye } else { Facing::Axis(axis) }
    }

    /// A point that is on no grid of whole numbers.
    pub(super) fn point(&mut self) -> Vec3 {
        let mut whole = || self.below(41) as f32 - 20.0;
        Vec3::new(whole() + 0.37, whole() + 0.61, whole() + 0.23)
    }

    pub(super) fn viewpoint(&mut self) -> Option<Vec3> {
        (!self.chance(15)).then(|| self.point())
    }

    pub(super) fn eye(&mut self) -> Option<Eye> {
        (!self.chance(15)).then(|| Eye::new(self.point() * 3.0))
    }

    /// A number that must be above zero, and is not always.
    fn positive(&mut self) -> f32 {
        match self.below(20) {
            0 => -1.0,
            1 => f32::NAN,
            other => other as f32 / 4.0,
        }
    }

    pub(super) fn what(&mut self) -> What {
        match self.below(34) {
            0..=4 => What::Group,
            5..=9 => What::Transform(self.transform()),
            10..=13 => self.attribute(),
            14 => What::Switch(self.chance(70)),
            15 | 16 => What::Selector(self.choice()),
            17 | 18 => What::Levels(self.distances()),
            19 => What::Rotor(self.turning()),
            20 => What::Billboard(self.facing()),
            21 => What::Porch(self.tag()),
            22 => What::Spinner(self.below(4) as f32),
            _ => self.leaf(),
        }
    }

    fn leaf(&mut self) -> What {
        match self.below(20) {
            0 | 1 => What::Placed,
            2 | 3 => What::Sized,
            4 => What::Tagged,
            5 => What::Keyed,
            6 => What::Gridded,
            7 => What::Sided,
            8 => What::Chooser,
            9 => What::Nest(self.below(4) as u32),
            10 => What::Fragile(self.below(4) as u32),
            11..=13 => self.held(),
            14 => match self.below(3) {
                0 => What::Light(self.positive()),
                1 => What::Camera(self.positive()),
                _ => What::Label(self.positive()),
            },
            15 => What::Woven(self.below(4) as u32),
            16 | 17 => self.limited(),
            _ => What::Plain(self.size()),
        }
    }

    fn limited(&mut self) -> What {
        let by = self.pick(&[LimitedBy::Distance, LimitedBy::Side]);
        What::Limited { size: self.size(), by }
    }

    fn held(&mut self) -> What {
        What::Held { size: self.size(), look: self.chance(50).then(|| self.look()) }
    }

    /// Other parameters for a node of the same kind.
    pub(super) fn changed(&mut self, what: What) -> What {
        match what {
            What::Transform(_) => What::Transform(self.transform()),
            What::Attribute(_) => self.attribute(),
            What::Switch(on) => What::Switch(!on),
            What::Selector(_) => What::Selector(self.choice()),
            What::Levels(_) => What::Levels(self.distances()),
            What::Rotor(_) => What::Rotor(self.turning()),
            What::Billboard(_) => What::Billboard(self.facing()),
            What::Kit(_) => What::Kit(self.tag()),
            What::Held { .. } => self.held(),
            What::Light(_) => What::Light(self.positive()),
            What::Camera(_) => What::Camera(self.positive()),
            What::Label(_) => What::Label(self.positive()),
            What::Porch(_) => What::Porch(self.tag()),
            What::Spinner(_) => What::Spinner(self.below(4) as f32),
            What::Plain(_) => What::Plain(self.size()),
            What::Limited { .. } => self.limited(),
            What::Nest(_) => What::Nest(self.below(4) as u32),
            What::Fragile(_) => What::Fragile(self.below(4) as u32),
            What::Woven(_) => What::Woven(self.below(4) as u32),
            same => same,
        }
    }
}
