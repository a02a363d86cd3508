//! The solid of revolution that Weber and Penn prune trees by (1995, section 4.6).

use glam::{DVec2, DVec3};

use super::region::Region;
use super::side::Side;
use crate::{Aabb, content};

/// A solid of revolution about the z axis: closed at the bottom and at the top, widest at its
/// peak, with a power curve on either side of that.
///
/// A peak beyond 0 and 1 counts as these, a power below 0 as 0. Nothing is inside where the top
/// is not above the base, where the width is not above 0, or where a value is no number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile {
    /// The height of the bottom in metres.
    pub base: f32,
    /// The height of the top in metres.
    pub top: f32,
    /// The greatest distance from the axis in metres.
    pub width: f32,
    /// Where the solid is widest, 0 at its bottom, 1 at its top.
    pub peak: f32,
    /// The power of the curve below the peak: 1 makes a cone, less is fuller.
    pub power_low: f32,
    /// The power of the curve above the peak.
    pub power_high: f32,
}

content!(Profile { base, top, width, peak, power_low, power_high });

/// Pieces in height that a region is judged by.
const N_SLICES: u32 = 8;

impl Profile {
    /// The distance from the axis, in metres, to which the solid reaches at a height in metres;
    /// 0 above its top and below its base.
    ///
    /// The paper prints 1 - peak in the denominator below the peak; its diagram, with the whole
    /// width at the peak and none at the bottom, needs the peak itself.
    pub fn radius_at(&self, height: f32) -> f32 {
        self.radius(f64::from(height)) as f32
    }

    /// The box around what is inside.
    pub(super) fn aabb(&self) -> Aabb {
        if self.is_empty() {
            return Aabb::EMPTY;
        }
        let (low, high) = (glam::Vec3::splat(-self.width), glam::Vec3::splat(self.width));
        Aabb { min: low.with_z(self.base), max: high.with_z(self.top) }
    }

    pub(super) fn contains(&self, point: DVec3) -> bool {
        let is_within = f64::from(self.base) <= point.z && point.z <= f64::from(self.top);
        is_within && !self.is_empty() && point.truncate().length() <= self.radius(point.z)
    }

    pub(super) fn side_of(&self, region: &Region) -> Side {
        let [low, high] = region.corners().map(|corner| corner.z);
        let (base, top) = (f64::from(self.base), f64::from(self.top));
        if self.is_empty() || high < base || low > top {
            return Side::Outside;
        }
        let mut sides = (0..N_SLICES).map(|slice| {
            let height = |of: u32| low + (high - low) * f64::from(of) / f64::from(N_SLICES);
            let [from, to] = [height(slice), height(slice + 1)];
            let [near, far] = distances_from_axis(region, from, to);
            let [least, most] = self.radii_between(from, to);
            // More than what rounding does to powers.
            if near > most * (1.0 + 1e-9) || to < base || from > top {
                Side::Outside
            } else if far <= least * (1.0 - 1e-9) {
                Side::Inside
            } else {
                Side::Crossing
            }
        });
        let first = sides.next().unwrap_or(Side::Crossing);
        if sides.all(|side| side == first) { first } else { Side::Crossing }
    }

    fn is_empty(&self) -> bool {
        let Self { base, top, width, peak, power_low, power_high } = *self;
        let all = [base, top, width, peak, power_low, power_high];
        !(base < top && width > 0.0 && all.iter().all(|value| value.is_finite()))
    }

    fn peak(&self) -> f64 {
        f64::from(self.peak).clamp(0.0, 1.0)
    }

    fn radius(&self, height: f64) -> f64 {
        let (base, top) = (f64::from(self.base), f64::from(self.top));
        if self.is_empty() || !(base <= height && height <= top) {
            return 0.0;
        }
        let (h, peak) = ((height - base) / (top - base), self.peak());
        let share = if h > peak {
            libm::pow((1.0 - h) / (1.0 - peak), f64::from(self.power_high).max(0.0))
        } else if h < peak {
            libm::pow(h / peak, f64::from(self.power_low).max(0.0))
        } else {
            1.0
        };
        f64::from(self.width) * share
    }

    /// The least and the largest radius at heights between two: it rises to the peak and falls
    /// from there.
    fn radii_between(&self, from: f64, to: f64) -> [f64; 2] {
        let (base, top) = (f64::from(self.base), f64::from(self.top));
        // At the very ends a power of 0 has a radius, beyond them there is none.
        let ends = [from, to].map(|height| self.radius(height));
        let within = [from, to].map(|height| self.radius(height.clamp(base, top)));
        let widest = base + self.peak() * (top - base);
        let has_peak = from <= widest && widest <= to;
        let most = if has_peak { f64::from(self.width) } else { within[0].max(within[1]) };
        [ends[0].min(ends[1]), most]
    }
}

/// The least and the largest distance from the z axis of what a region has between two heights,
/// or a little more.
fn distances_from_axis(region: &Region, from: f64, to: f64) -> [f64; 2] {
    match *region {
        Region::Ball { center, radius } => {
            let away = center.z.clamp(from, to) - center.z;
            let reach = (radius * radius - away * away).max(0.0).sqrt();
            let middle = center.truncate().length();
            [middle - reach, middle + reach]
        }
        Region::Box { min, max } => {
            let (min, max) = (min.truncate(), max.truncate());
            [DVec2::ZERO.clamp(min, max).length(), min.abs().max(max.abs()).length()]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PROFILE: Profile =
        Profile { base: 2.0, top: 12.0, width: 4.0, peak: 0.4, power_low: 0.5, power_high: 2.0 };

    #[test]
    fn the_radius_follows_the_formula() {
        let heights = [1.9, 2.0, 3.0, 6.0, 9.0, 12.0, 12.1];
        let radii = [0.0, 0.0, 2.0, 4.0, 1.0, 0.0, 0.0];
        for (height, radius) in heights.into_iter().zip(radii) {
            assert!((PROFILE.radius_at(height) - radius).abs() < 1e-5, "at {height}");
        }
        let inside = |x: f64, z: f64| PROFILE.contains(DVec3::new(0.6 * x, 0.8 * x, z));
        assert!(inside(1.99, 3.0) && !inside(2.01, 3.0) && !inside(0.0, 1.9));
    }

    #[test]
    fn the_widest_place_may_be_at_an_end() {
        for (peak, wide, narrow) in [(0.0, 2.0, 12.0), (1.0, 12.0, 2.0), (-3.0, 2.0, 12.0)] {
            let profile = Profile { peak, ..PROFILE };
            assert_eq!((profile.radius_at(wide), profile.radius_at(narrow)), (4.0, 0.0));
            let middle = profile.radius_at(7.0);
            assert!(middle > 0.0 && middle < 4.0);
        }
    }

    #[test]
    fn a_power_of_0_makes_a_cylinder() {
        let cylinder = Profile { power_low: 0.0, power_high: -1.0, ..PROFILE };
        for height in [2.0, 5.0, 11.0, 12.0] {
            assert_eq!(cylinder.radius_at(height), 4.0);
        }
        assert_eq!(cylinder.radius_at(12.1), 0.0);
    }

    #[test]
    fn profiles_without_extent_hold_nothing() {
        let flat = Profile { top: 2.0, ..PROFILE };
        let thin = Profile { width: 0.0, ..PROFILE };
        let unknown = Profile { power_low: f32::NAN, ..PROFILE };
        for profile in [flat, thin, unknown] {
            assert!(!profile.contains(DVec3::new(0.0, 0.0, 2.0)) && profile.aabb().is_empty());
        }
    }
}
