//! Showing one of several aspects: which, by the direction from which somebody looks.

use sapwood_geom::glam::Vec3;
use sapwood_geom::{Shared, content};

use crate::cross_fade::DrawnParts;
use crate::{CrossFade, DrawRange, DrawnPart};

/// Of what is drawn under a node, only that aspect is drawn whose direction is nearest to the
/// eye's, or where aspects [blend](Self::blends), it and the next one.
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
    /// Whether the nearest and the next fade into each other as the eye goes from the one's
    /// direction to the other's. Lines do not, and picks and what fades with the distance take the
    /// nearest alone. Files have the one with the larger share, of even ones that with the lower
    /// number. Cuts have no eye, and so what is drawn [without one](Self::without_eye).
    pub blends: bool,
}

content!(Aspects { toward, center, without_eye, blends });

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

    /// The aspects that are shown to an eye in the node's frame where they blend, each with the
    /// pixels that it is drawn in; one is shown alone where it is much the nearest, and none that
    /// is seen from behind is blended with it. Shares change steadily as the eye goes round a ring
    /// of directions. They jump at places that are as far from three directions, as there are where
    /// it rises.
    fn blended(&self, eye: Vec3) -> Option<[(u32, CrossFade); 2]> {
        let direction = (eye - self.center).try_normalize()?;
        // The three nearest; directions that are not there are as far as can be.
        let mut near = [(0, 2.0); 3];
        for (number, toward) in (0..).zip(self.toward.iter()) {
            let away = toward.distance(direction);
            if let Some(rank) = near.iter().position(|(_, other)| away < *other) {
                near[rank..].rotate_right(1);
                near[rank] = (number, away);
            }
        }
        let [(one, nearest), (other, next), (_, third)] = near;
        // What is a quarter turn away is seen from its edge, and beyond that from behind.
        let third = third.min(std::f32::consts::SQRT_2);
        if one == other {
            return None;
        }
        // As good as even between two of a ring, and none for what would not be among the two.
        let weight = |away: f32| (third - away) / libm::sqrtf(away.max(f32::MIN_POSITIVE));
        let (weights, lower) = ([weight(nearest), weight(next)], one < other);
        let share = if next < third { weights[0] / (weights[0] + weights[1]) } else { 1.0 };
        // In the order of their numbers, so that pixels stay on their sides where the next becomes
        // the nearest.
        let [first, second] = CrossFade::pair(if lower { share } else { 1.0 - share });
        Some(if lower { [(one, first), (other, second)] } else { [(other, first), (one, second)] })
    }

    /// What is drawn of `n` triangles or instances, and in which pixels, for an eye in the node's
    /// frame.
    pub(crate) fn parts(&self, n: u32, eye: Option<Vec3>) -> DrawnParts {
        let each = n.checked_div(self.toward.len() as u32).unwrap_or(0);
        let Some(blended) = eye.filter(|_| self.blends).and_then(|eye| self.blended(eye)) else {
            return DrawnPart::alone(self.drawn(n, eye));
        };
        let range = |shown: u32| DrawRange { first: shown * each, end: (shown + 1) * each };
        let whole = blended.iter().find(|(_, fade)| fade.share() >= 1.0);
        match whole {
            Some((shown, _)) => DrawnPart::alone(range(*shown)),
            None => blended.map(|(shown, fade)| {
                Some(DrawnPart { range: range(shown), cross_fade: Some(fade) })
            }),
        }
    }

    /// What is drawn of `n` triangles, instances or lines, for an eye in the node's frame, where
    /// only one aspect can be.
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
        let Self { toward, center, without_eye, blends: _ } = self;
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
        Aspects { toward, center: Vec3::Y, without_eye: 3, blends: false }
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
    fn the_nearest_two_fade_into_each_other_steadily() {
        let ring = |n: u32| {
            let angle = move |side: u32| std::f32::consts::TAU * side as f32 / n as f32;
            let toward = (0..n).map(|side| Vec3::new(angle(side).sin(), 0.0, angle(side).cos()));
            let toward = Shared::new(toward.collect());
            Aspects { toward, center: Vec3::ZERO, without_eye: 0, blends: true }
        };
        // How much is shown of each of 16 aspects of two triangles.
        let ring = ring(16);
        let shares = |angle: f32, up: f32| {
            let eye = Vec3::new(angle.sin(), up, angle.cos()) * 40.0;
            let mut shares = [0.0; 16];
            for part in ring.parts(32, Some(eye)).into_iter().flatten() {
                assert_eq!(part.range.len(), 2);
                shares[part.range.first as usize / 2] +=
                    part.cross_fade.map_or(1.0, |fade| fade.share());
            }
            shares
        };
        let n = 16 * 64;
        let mut before = shares(0.0, 0.1);
        for step in 1..=n {
            let place = step as f32 / 64.0;
            let now = shares(place * std::f32::consts::TAU / 16.0, 0.1);
            assert_eq!(now.iter().sum::<f32>(), 1.0);
            let changed = (0..16).map(|i| (now[i] - before[i]).abs()).fold(0.0, f32::max);
            assert!(changed <= 1.0 / 16.0, "at {place}: {changed}");
            let (side, after) = (place as usize % 16, place.fract());
            let even = [1.0 - after, after];
            let off = (0..2).map(|i| (now[(side + i) % 16] - even[i]).abs()).fold(0.0, f32::max);
            assert!(off < 0.09, "at {place}: {now:?}");
            before = now;
        }
        assert_eq!(shares(0.0, 0.0)[0], 1.0);
        // Each pixel stays on its side where the next becomes the nearest.
        let halfway = |by: f32| {
            ring.parts(32, Some(Vec3::new((0.19635f32 + by).sin(), 0.0, (0.19635f32 + by).cos())))
        };
        assert_eq!(halfway(-1e-3), halfway(1e-3));
        // Nothing to blend with, nobody to blend for, or told not to.
        let one = Aspects { toward: Shared::new(vec![Vec3::X]), ..ring.clone() };
        assert_eq!(one.parts(4, Some(Vec3::Y)), DrawnPart::alone(DrawRange { first: 0, end: 4 }));
        assert_eq!(ring.parts(32, None), DrawnPart::alone(DrawRange { first: 0, end: 0 }));
        // Nor with what is seen from behind.
        let [front, back] = [Vec3::new(0.0, 0.6, 0.8), Vec3::NEG_Z];
        let two = Aspects { toward: Shared::new(vec![front, back]), ..ring.clone() };
        let first = DrawnPart::alone(DrawRange { first: 0, end: 2 });
        assert_eq!(two.parts(4, Some(Vec3::new(0.0, 1.0, 0.1))), first);
        assert_ne!(two.parts(4, Some(Vec3::new(0.0, 1.0, -0.4))), first);
        let hard = Aspects { blends: false, ..ring.clone() };
        let parts = hard.parts(32, Some(Vec3::new(0.1, 0.0, 1.0)));
        assert_eq!(parts, DrawnPart::alone(DrawRange { first: 0, end: 2 }));
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
