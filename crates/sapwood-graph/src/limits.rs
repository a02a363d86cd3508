//! What limits how much is drawn, by where the eye is: by its distance, or by its direction.

use sapwood_geom::glam::{Affine3, Vec3};

use crate::cross_fade::DrawnParts;
use crate::{Aspects, DrawRange, DrawnPart, Eye, Fading};

/// From where something is looked at, in its own frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vantage {
    /// The [range](Fading::range); 0 from nearby, and where there is none to tell.
    pub range: f32,
    /// Where the eye is; nothing where nobody tells, and in a flat frame.
    pub eye: Option<Vec3>,
}

impl Vantage {
    /// That of an eye in the root's frame, in the frame that `world` leads to the root from.
    pub fn of(world: &Affine3, eye: Option<&Eye>) -> Self {
        let range = Fading::range(world, eye);
        let has_inverse = world.matrix3.determinant() != 0.0;
        let there = eye.filter(|_| has_inverse);
        let there = there.map(|eye| world.inverse().transform_point3(eye.position));
        Self { range, eye: there.filter(|eye| eye.is_finite()) }
    }
}

/// A node that limits what is drawn of what it has below itself.
#[derive(Clone, Copy, Debug)]
pub enum Limiter<'a> {
    /// By the distance.
    Fading(&'a Fading),
    /// By the direction.
    Aspects(&'a Aspects),
}

impl Limiter<'_> {
    /// What is drawn of `n` triangles, instances or lines.
    pub fn drawn(&self, n: u32, vantage: &Vantage) -> DrawRange {
        match self {
            Self::Fading(fading) => fading.drawn(n, vantage.range),
            Self::Aspects(aspects) => aspects.drawn(n, vantage.eye),
        }
    }

    /// What is drawn of `n` triangles or instances, where some pixels may show one part and others
    /// another.
    pub(crate) fn parts(&self, n: u32, vantage: &Vantage) -> DrawnParts {
        match self {
            Self::Fading(_) => DrawnPart::alone(self.drawn(n, vantage)),
            Self::Aspects(aspects) => aspects.parts(n, vantage.eye),
        }
    }

    /// How much larger each instance is drawn.
    pub fn growth(&self, vantage: &Vantage) -> f32 {
        match self {
            Self::Fading(fading) => fading.growth(vantage.range),
            Self::Aspects(_) => 1.0,
        }
    }

    /// What is wrong, in words, over `n` triangles, instances or lines.
    pub fn fault(&self, n: usize) -> Option<String> {
        match self {
            Self::Fading(fading) => fading.fault(n),
            Self::Aspects(aspects) => aspects.fault(n),
        }
    }
}

/// The limiting nodes above the node at hand, for walks through a fragment from its beginning.
#[derive(Debug, Default)]
pub struct LimitsAbove<'a>(Vec<(u32, Limiter<'a>, Vantage)>);

impl<'a> LimitsAbove<'a> {
    /// Goes on to the node at `index`, out of those that end before it.
    pub fn go_on_to(&mut self, index: u32) {
        while self.0.pop_if(|(end, _, _)| *end <= index).is_some() {}
    }

    /// Goes into a node that has everything before `end` below it, looked at from `vantage`.
    pub fn enter(&mut self, end: u32, limiter: Limiter<'a>, vantage: Vantage) {
        self.0.push((end, limiter, vantage));
    }

    /// What is drawn of `n` triangles or instances, where some pixels may show one part and others
    /// another, and how much larger instances are.
    pub fn parts(&self, n: usize) -> (impl Iterator<Item = DrawnPart> + use<>, f32) {
        let (parts, growth) = match self.0.last() {
            None => (DrawnPart::alone(DrawRange { first: 0, end: n as u32 }), 1.0),
            Some((_, limiter, from)) => (limiter.parts(n as u32, from), limiter.growth(from)),
        };
        (parts.into_iter().flatten(), growth)
    }

    /// What is drawn of `n` triangles, instances or lines, and how much larger instances are.
    pub fn drawn(&self, n: usize) -> (DrawRange, f32) {
        match self.0.last() {
            None => (DrawRange { first: 0, end: n as u32 }, 1.0),
            Some((_, limiter, from)) => (limiter.drawn(n as u32, from), limiter.growth(from)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_eye_is_told_in_the_frame_of_what_it_looks_at() {
        let world = Affine3::from_translation(Vec3::X) * Affine3::from_scale(Vec3::splat(2.0));
        let eye = Eye::new(Vec3::new(9.0, 0.0, 0.0));
        let vantage = Vantage::of(&world, Some(&eye));
        assert_eq!((vantage.range, vantage.eye), (4.0, Some(Vec3::X * 4.0)));
        let flat = Affine3::from_scale(Vec3::new(1.0, 0.0, 1.0));
        assert_eq!(Vantage::of(&flat, Some(&eye)), Vantage::default());
        assert_eq!(Vantage::of(&world, None), Vantage::default());
    }
}
