//! Showing one of several aspects: which, by the direction from which somebody looks.

use sapwood_geom::glam::Vec3;
use sapwood_geom::{Shared, content};

use crate::DrawRange;

/// Of what is drawn under a node, only that aspect is drawn whose direction is nearest to the
/// eye's.
///
/// Aspects are what a mesh's triangles, the instances or the lines are divided into, each as many:
/// first those of the first aspect, then those of the second.
#[derive(Clone, Debug, PartialEq)]
pub struct Aspects {
    /// For each aspect, the direction that it is to be seen from, with unit length.
    pub toward: Shared<Vec<Vec3>>,
    /// Where directions are measured from.
    pub center: Vec3,
    /// How many of them, from the first one on, are drawn where nobody tells the eye, at most all.
    pub without_eye: u32,
}

content!(Aspects { toward, center, without_eye });

impl Aspects {
    /// The aspect that is shown to an eye in the node's frame, the first of those as near; nothing
    /// for an eye at the center, and where there are none.
    pub fn nearest(&self, eye: Vec3) -> Option<u32> {
        let direction = (eye - self.center).try_normalize()?;
        let mut nearest: Option<(u32, f32)> = None;
        for (number, toward) in (0..).zip(self.toward.iter()) {
            let cosine = toward.dot(direction);
            if nearest.is_none_or(|(_, best)| cosine > best) {
                nearest = Some((number, cosine));
            }
        }
        nearest.map(|(number, _)| number)
    }

    /// What is drawn of `n` triangles, instances or lines, for an eye in the node's frame.
    pub fn drawn(&self, n: u32, eye: Option<Vec3>) -> DrawRange {
        let n_aspects = self.toward.len() as u32;
        let each = n.checked_div(n_aspects).unwrap_or(0);
        match eye.and_then(|eye| self.nearest(eye)) {
            Some(shown) => DrawRange { first: shown * each, end: (shown + 1) * each },
            None => DrawRange { first: 0, end: self.without_eye.min(n_aspects) * each },
        }
    }

    /// What is wrong, in words, over `n` triangles, instances or lines.
    pub fn fault(&self, n: usize) -> Option<String> {
        let Self { toward, center, without_eye } = self;
        if let Some(toward) = toward.iter().find(|toward| !toward.is_normalized()) {
            return Some(format!("has an aspect seen from {toward}, which is no unit vector"));
        }
        if !center.is_finite() {
            return Some(format!("measures directions from {center}"));
        }
        if *without_eye as usize > toward.len() {
            return Some(format!("shows {without_eye} of {} aspects", toward.len()));
        }
        let is_even = n.checked_rem(toward.len()) == Some(0);
        (!is_even).then(|| format!("has {n} things to divide into {} aspects", toward.len()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sides() -> Aspects {
        let toward = Shared::new(vec![Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z]);
        Aspects { toward, center: Vec3::Y, without_eye: 3 }
    }

    #[test]
    fn the_nearest_aspect_is_drawn() {
        let drawn = |eye: Option<Vec3>| sides().drawn(8, eye).numbers();
        assert_eq!(drawn(Some(Vec3::new(-9.0, 40.0, 8.0))), 2..4);
        assert_eq!(drawn(Some(Vec3::new(8.0, 1.0, -9.0))), 6..8);
        // Of those as near, the first.
        assert_eq!(drawn(Some(Vec3::new(0.0, 9.0, 0.0))), 0..2);
        // From where there is no direction, as without an eye.
        assert_eq!([drawn(None), drawn(Some(Vec3::Y))], [0..6, 0..6]);
        let none = Aspects { toward: Shared::new(Vec::new()), ..sides() };
        assert!(none.drawn(8, Some(Vec3::X)).is_empty());
    }

    #[test]
    fn faults_are_told() {
        assert_eq!(sides().fault(8), None);
        let fault = |change: fn(&mut Aspects), n| {
            let mut aspects = sides();
            change(&mut aspects);
            aspects.fault(n).unwrap_or_default()
        };
        assert_eq!(fault(|_| (), 9), "has 9 things to divide into 4 aspects");
        assert_eq!(fault(|a| a.without_eye = 5, 8), "shows 5 of 4 aspects");
        assert!(fault(|a| a.center.x = f32::NAN, 8).starts_with("measures directions from"));
        let flat = |a: &mut Aspects| a.toward = Shared::new(vec![Vec3::ZERO; 4]);
        assert!(fault(flat, 8).contains("no unit vector"));
        let none = |a: &mut Aspects| (a.toward, a.without_eye) = (Shared::new(Vec::new()), 0);
        assert_eq!(fault(none, 8), "has 8 things to divide into 0 aspects");
    }
}
