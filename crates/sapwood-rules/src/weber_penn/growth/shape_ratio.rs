//! ShapeRatio: how long branches are by their place in the crown (Weber and Penn 1995, section
//! 4.3), including the profile of the pruning envelope (section 4.6).

use std::f32::consts::{FRAC_PI_2, PI};

use crate::weber_penn::PruningParams;
use crate::weber_penn::{CrownShape, Dialect};

/// ShapeRatio(shape, r) for r in 0..1: 0 at the top of the crown and 1 at its bottom for
/// branches, the other way round for leaves.
///
/// In Arbaro's dialect shape 0 is plain r instead of 0.2 + 0.8 r.
pub(crate) fn shape_ratio(
    shape: CrownShape,
    r: f32,
    pruning: &PruningParams,
    dialect: Dialect,
) -> f32 {
    match shape {
        CrownShape::Conical => conical(r, dialect),
        CrownShape::Spherical => 0.2 + 0.8 * libm::sinf(PI * r),
        CrownShape::Hemispherical => 0.2 + 0.8 * libm::sinf(FRAC_PI_2 * r),
        CrownShape::Cylindrical => 1.0,
        CrownShape::TaperedCylindrical => 0.5 + 0.5 * r,
        CrownShape::Flame => flame(r),
        CrownShape::InverseConical => 1.0 - 0.8 * r,
        CrownShape::TendFlame => 0.5 + 0.5 * flame(r),
        CrownShape::Envelope => envelope_ratio(r, pruning),
    }
}

/// ShapeRatio(0, r), which negative DownAngleV reads too.
pub(crate) fn conical(r: f32, dialect: Dialect) -> f32 {
    match dialect {
        Dialect::Arbaro => r,
        Dialect::Paper | Dialect::TreeGen => 0.2 + 0.8 * r,
    }
}

fn flame(r: f32) -> f32 {
    if r <= 0.7 { r / 0.7 } else { (1.0 - r) / 0.3 }
}

/// The envelope's radius at `q` (0 at its top, 1 at its bottom), relative to its widest; 0
/// outside.
///
/// The paper prints 1 - PruneWidthPeak in the denominator below the peak; its diagram, with 1 at
/// the peak and 0 at the bottom, needs PruneWidthPeak.
pub(crate) fn envelope_ratio(q: f32, pruning: &PruningParams) -> f32 {
    let peak = 1.0 - pruning.width_peak;
    if !(0.0..=1.0).contains(&q) {
        0.0
    } else if q < peak {
        libm::powf(q / peak, pruning.power_high)
    } else if peak < 1.0 {
        libm::powf((1.0 - q) / (1.0 - peak), pruning.power_low)
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use CrownShape as C;

    const ENVELOPE: PruningParams = PruningParams {
        ratio: 0.0,
        width: 0.5,
        width_peak: 0.6,
        power_low: 0.5,
        power_high: 2.0,
        envelope: None,
    };

    #[test]
    fn shapes_follow_the_check_table() {
        let shapes = [
            C::Conical,
            C::Spherical,
            C::Hemispherical,
            C::Cylindrical,
            C::TaperedCylindrical,
            C::Flame,
            C::InverseConical,
            C::TendFlame,
        ];
        let rows = [
            (0.0, [0.2, 0.2, 0.2, 1.0, 0.5, 0.0, 1.0, 0.5]),
            (0.25, [0.4, 0.7657, 0.5061, 1.0, 0.625, 0.3571, 0.8, 0.6786]),
            (0.5, [0.6, 1.0, 0.7657, 1.0, 0.75, 0.7143, 0.6, 0.8571]),
            (0.7, [0.76, 0.8472, 0.9128, 1.0, 0.85, 1.0, 0.44, 1.0]),
            (0.9, [0.92, 0.4472, 0.9902, 1.0, 0.95, 0.3333, 0.28, 0.6667]),
            (1.0, [1.0, 0.2, 1.0, 1.0, 1.0, 0.0, 0.2, 0.5]),
        ];
        for (r, values) in rows {
            for (shape, expected) in shapes.into_iter().zip(values) {
                let ratio = shape_ratio(shape, r, &ENVELOPE, Dialect::Paper);
                assert!((ratio - expected).abs() < 1e-4, "{shape:?} at {r}: {ratio}");
            }
        }
    }

    #[test]
    fn arbaros_cone_is_plain_r() {
        assert_eq!(shape_ratio(C::Conical, 0.3, &ENVELOPE, Dialect::Arbaro), 0.3);
        assert_eq!(conical(0.3, Dialect::TreeGen), conical(0.3, Dialect::Paper));
    }

    #[test]
    fn the_envelope_is_continuous_at_its_peak_and_closed_at_its_ends() {
        let at = |q| shape_ratio(C::Envelope, q, &ENVELOPE, Dialect::Paper);
        assert_eq!((at(0.0), at(1.0), at(-0.1), at(1.1)), (0.0, 0.0, 0.0, 0.0));
        assert!((at(0.2) - 0.25).abs() < 1e-6 && (at(0.3999) - 1.0).abs() < 1e-3);
        assert_eq!(at(0.4), 1.0);
        assert!((at(0.85) - 0.5).abs() < 1e-6);
        for width_peak in [0.0, 1.0] {
            let pruning = PruningParams { width_peak, ..ENVELOPE };
            for q in [0.0, 0.5, 1.0] {
                assert!((0.0..=1.0).contains(&envelope_ratio(q, &pruning)));
            }
        }
    }
}
