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
        if !is_within || self.is_empty() {
            return false;
        }
        let distance = point.truncate().length();
        let [least, most] = self.share_at(point.z).between().map(|s| f64::from(self.width) * s);
        distance <= least || distance <= most && distance <= self.radius(point.z)
    }

    pub(super) fn side_of(&self, region: &Region) -> Side {
        let [low, high] = region.corners().map(|corner| corner.z);
        let (base, top) = (f64::from(self.base), f64::from(self.top));
        if self.is_empty() || high < base || low > top {
            return Side::Outside;
        }
        let height = |of: u32| low + (high - low) * f64::from(of) / f64::from(N_SLICES);
        let mut lower = Ring::new(self, height(0));
        let mut sides = (1..=N_SLICES).map(|slice| {
            let upper = Ring::new(self, height(slice));
            let [from, to] = [lower.height, upper.height];
            let [near, far] = distances_from_axis(region, from, to);
            let [least, most] = self.radii_between(&lower, &upper);
            lower = upper;
            // More than what rounding does to powers.
            if near > most * (1.0 + 1e-9) || to < base || from > top {
                Side::Outside
            } else if from >= base && to <= top && far <= least * (1.0 - 1e-9) {
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
        f64::from(self.width) * self.share_at(height).value()
    }

    /// The share of the width to which the solid reaches at a height between its base and top.
    fn share_at(&self, height: f64) -> Share {
        let (base, top) = (f64::from(self.base), f64::from(self.top));
        let (h, peak) = ((height - base) / (top - base), self.peak());
        let (base, power) = if h > peak {
            ((1.0 - h) / (1.0 - peak), self.power_high)
        } else if h < peak {
            (h / peak, self.power_low)
        } else {
            (1.0, 0.0)
        };
        Share { base, power: f64::from(power).max(0.0) }
    }

    /// What the least and the largest radius between two heights are not beyond: the solid widens
    /// to the peak and narrows from there.
    fn radii_between(&self, lower: &Ring, upper: &Ring) -> [f64; 2] {
        let (base, top) = (f64::from(self.base), f64::from(self.top));
        let widest = base + self.peak() * (top - base);
        let has_peak = lower.height <= widest && widest <= upper.height;
        let most = if has_peak { f64::from(self.width) } else { lower.most.max(upper.most) };
        [lower.least.min(upper.least), most]
    }
}

/// A power of a number between 0 and 1, by a power that is not negative.
struct Share {
    base: f64,
    power: f64,
}

impl Share {
    fn value(&self) -> f64 {
        libm::pow(self.base, self.power)
    }

    /// Between what the value lies, which tells of most points on which side they are.
    ///
    /// Bernoulli's inequality, of the number and of its inverse.
    fn between(&self) -> [f64; 2] {
        let Self { base, power } = *self;
        // Written so that nothing is divided by 0.
        let straight = 1.0 + power * (base - 1.0);
        let bent = base / (base + power * (1.0 - base));
        let [least, most] = if power <= 1.0 { [bent, straight] } else { [straight, bent] };
        // More than what rounding does to either.
        let margin = 1e-12 * (1.0 + power);
        // The value of a power of 0 is 1 everywhere, which the second form does not know at 0.
        if base > 0.0 { [least - margin, most + margin] } else { [0.0, 1.0] }
    }
}

/// What the radius of a profile lies between at a height.
struct Ring {
    height: f64,
    /// 0 above the top and below the base.
    least: f64,
    /// That of the nearest height that the solid has: at its very ends a power of 0 has a radius,
    /// beyond them there is none.
    most: f64,
}

impl Ring {
    fn new(profile: &Profile, height: f64) -> Self {
        let nearest = height.clamp(f64::from(profile.base), f64::from(profile.top));
        let [least, most] = profile.share_at(nearest).between();
        let width = f64::from(profile.width);
        let least = if nearest == height { width * least } else { 0.0 };
        Self { height, least, most: width * most }
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
    fn what_a_share_lies_between_holds_it() {
        for power in [0.0, 0.001, 0.3, 0.5, 1.0, 1.5, 4.0, 100.0] {
            for base in [0.0, 1e-300, 1e-9, 0.01, 0.3, 0.5, 0.9, 1.0 - 1e-12, 1.0] {
                let share = Share { base, power };
                let ([least, most], value) = (share.between(), share.value());
                assert!(least <= value && value <= most, "{base}^{power}: {least}, {most}");
            }
        }
        // The willow's: it is told almost everywhere.
        let [least, most] = Share { base: 0.1, power: 0.001 }.between();
        assert!(most - least < 0.01);
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
