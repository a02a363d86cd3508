//! Sines, cosines and angles for growing and sweeping, where one is taken for every segment and
//! leaf.
//!
//! They are as accurate as `f32` allows within a few units in the last place, and are made of
//! sums, products and one quotient alone, without branches or tables: so they are inlined into
//! loops, and give the same bits on every machine, one at a time or four. Whoever takes a few of
//! them uses `libm`.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use wide::f32x4;

/// Adding it to a number far below 2^51 leaves the nearest whole number in the lowest bits.
const ROUND: f64 = 1.5 * (1u64 << 52) as f64;

/// The sine and the cosine of an angle in radians, up to a million either way; beyond, the
/// result loses digits.
#[inline]
pub fn sin_cos(angle: f32) -> (f32, f32) {
    let quarters = f64::from(angle) * std::f64::consts::FRAC_2_PI + ROUND;
    let quarter = quarters.to_bits();
    // At most an eighth of a turn either way; in `f64`, for it is a small difference.
    let rest = f64::from(angle) - (quarters - ROUND) * std::f64::consts::FRAC_PI_2;
    let x = rest as f32;
    let square = x * x;
    // Minimax polynomials of Cephes (Moshier 1992).
    let sine =
        x + x * square * (-1.666_665_5e-1 + square * (8.332_161e-3 + square * -1.951_529_6e-4));
    let cosine = 1.0 - 0.5 * square
        + square * square * (4.166_664_6e-2 + square * (-1.388_731_6e-3 + square * 2.443_315_7e-5));
    let is_odd = quarter & 1 != 0;
    let (sine, cosine) = if is_odd { (cosine, sine) } else { (sine, cosine) };
    // The sine changes its sign in the third and fourth quarter, the cosine in the second and
    // third.
    let sign = |bit: u64| ((bit & 2) as u32) << 30;
    (
        f32::from_bits(sine.to_bits() ^ sign(quarter)),
        f32::from_bits(cosine.to_bits() ^ sign(quarter.wrapping_add(1))),
    )
}

/// The angle of the point (`x`, `y`) from the x axis, in [-pi, pi]; 0 at the origin.
#[inline]
pub fn atan2(y: f32, x: f32) -> f32 {
    let (across, along) = (y.abs(), x.abs());
    let (short, long) = if across > along { (along, across) } else { (across, along) };
    // Above an eighth of pi, the angle beyond a quarter of pi.
    let is_steep = short > 0.414_213_57 * long;
    let above = if is_steep { short - long } else { short };
    let below = if is_steep { short + long } else { long };
    // Not `max`, which would hide what is no number.
    let below = if below < f32::MIN_POSITIVE { f32::MIN_POSITIVE } else { below };
    let tangent = above / below;
    let square = tangent * tangent;
    let angle = tangent
        + tangent
            * square
            * (-3.333_295e-1
                + square * (1.997_771_1e-1 + square * (-1.387_768_6e-1 + square * 8.053_745e-2)));
    let angle = if is_steep { angle + FRAC_PI_4 } else { angle };
    let angle = if across > along { FRAC_PI_2 - angle } else { angle };
    let angle = if x < 0.0 { PI - angle } else { angle };
    f32::from_bits(angle.to_bits() | (y.to_bits() & 1 << 31))
}

/// [`sin_cos`] of four angles, with the same bits.
#[inline]
pub fn sin_cos_4(angles: [f32; 4]) -> ([f32; 4], [f32; 4]) {
    let (mut rest, mut odd) = ([0.0; 4], [0.0; 4]);
    let (mut sine_sign, mut cosine_sign) = ([0.0; 4], [0.0; 4]);
    for (i, angle) in angles.into_iter().enumerate() {
        let quarters = f64::from(angle) * std::f64::consts::FRAC_2_PI + ROUND;
        let quarter = quarters.to_bits() as u32;
        rest[i] = (f64::from(angle) - (quarters - ROUND) * std::f64::consts::FRAC_PI_2) as f32;
        odd[i] = f32::from_bits((quarter & 1).wrapping_neg());
        sine_sign[i] = f32::from_bits((quarter & 2) << 30);
        cosine_sign[i] = f32::from_bits((quarter.wrapping_add(1) & 2) << 30);
    }
    let (x, odd) = (f32x4::new(rest), f32x4::new(odd));
    let square = x * x;
    let sine =
        x + x * square * (-1.666_665_5e-1 + square * (8.332_161e-3 + square * -1.951_529_6e-4));
    let cosine = 1.0 - 0.5 * square
        + square * square * (4.166_664_6e-2 + square * (-1.388_731_6e-3 + square * 2.443_315_7e-5));
    let signed = |is_odd, odd: f32x4, even: f32x4, sign| {
        (f32x4::select(is_odd, odd, even) ^ f32x4::new(sign)).to_array()
    };
    (signed(odd, cosine, sine, sine_sign), signed(odd, sine, cosine, cosine_sign))
}

/// [`atan2`] of four points, with the same bits.
#[inline]
pub fn atan2_4(y: [f32; 4], x: [f32; 4]) -> [f32; 4] {
    let (y, x) = (f32x4::new(y), f32x4::new(x));
    let (across, along) = (y.abs(), x.abs());
    let is_across = across.simd_gt(along);
    let (short, long) = (is_across.select(along, across), is_across.select(across, along));
    let is_steep = short.simd_gt(0.414_213_57 * long);
    let above = is_steep.select(short - long, short);
    let below = is_steep.select(short + long, long);
    let least = f32x4::splat(f32::MIN_POSITIVE);
    let below = below.simd_lt(least).select(least, below);
    let tangent = above / below;
    let square = tangent * tangent;
    let angle = tangent
        + tangent
            * square
            * (-3.333_295e-1
                + square * (1.997_771_1e-1 + square * (-1.387_768_6e-1 + square * 8.053_745e-2)));
    let angle = is_steep.select(angle + FRAC_PI_4, angle);
    let angle = is_across.select(FRAC_PI_2 - angle, angle);
    let angle = x.simd_lt(f32x4::ZERO).select(PI - angle, angle);
    (angle | (y & f32x4::splat(-0.0))).to_array()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Angles all over the circle and beyond, with the points where something changes.
    fn angles() -> impl Iterator<Item = f32> {
        let even = (-200_000..=200_000).map(|i| i as f32 * 1e-4);
        let quarters = (-16..=16).map(|i| i as f32 * FRAC_PI_4);
        even.chain(quarters).chain([1e3, -1e5, 1e6, 1e-20, -1e-20])
    }

    #[test]
    fn sines_and_cosines_are_accurate() {
        for angle in angles() {
            let (sine, cosine) = sin_cos(angle);
            let wanted = (libm::sin(f64::from(angle)), libm::cos(f64::from(angle)));
            let off = (f64::from(sine) - wanted.0).abs().max((f64::from(cosine) - wanted.1).abs());
            assert!(off < 1.2e-7, "{angle}: {sine} {cosine}, {wanted:?}");
        }
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
    }

    #[test]
    fn angles_are_accurate_in_every_direction_and_at_every_distance() {
        for angle in angles() {
            for distance in [1e-12, 1.0, 1e9] {
                let (y, x) = (distance * libm::sinf(angle), distance * libm::cosf(angle));
                let wanted = libm::atan2(f64::from(y), f64::from(x));
                let found = f64::from(atan2(y, x));
                assert!((found - wanted).abs() < 3e-7, "{y} {x}: {found}, {wanted}");
            }
        }
    }

    #[test]
    fn axes_have_the_angles_of_the_standard() {
        assert_eq!(atan2(0.0, 0.0), 0.0);
        assert_eq!(atan2(0.0, 2.0), 0.0);
        assert_eq!(atan2(2.0, 0.0), FRAC_PI_2);
        assert_eq!(atan2(-2.0, 0.0), -FRAC_PI_2);
        assert_eq!(atan2(0.0, -1.0), PI);
        assert_eq!(atan2(-0.0, -1.0), -PI);
    }

    #[test]
    fn what_is_no_number_stays_none() {
        assert!(sin_cos(f32::INFINITY).0.is_nan() && sin_cos(f32::NAN).1.is_nan());
        assert!(atan2(f32::NAN, 1.0).is_nan() && atan2(1.0, f32::NAN).is_nan());
    }

    #[test]
    fn four_at_a_time_have_the_bits_of_one() {
        let bits = |numbers: [f32; 4]| numbers.map(f32::to_bits);
        let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.0, 0.0, 1e-40, 1e9, -1e30];
        let all: Vec<f32> = angles().chain(odd).collect();
        for (four, other) in all.chunks_exact(4).zip(all.chunks_exact(4).rev()) {
            let four: [f32; 4] = four.try_into().unwrap();
            let (sines, cosines) = sin_cos_4(four);
            assert_eq!(bits(sines), four.map(|angle| sin_cos(angle).0.to_bits()), "{four:?}");
            assert_eq!(bits(cosines), four.map(|angle| sin_cos(angle).1.to_bits()), "{four:?}");
            let other: [f32; 4] = other.try_into().unwrap();
            let one = |i: usize| atan2(four[i], other[i]).to_bits();
            assert_eq!(bits(atan2_4(four, other)), [0, 1, 2, 3].map(one), "{four:?} {other:?}");
        }
    }
}
