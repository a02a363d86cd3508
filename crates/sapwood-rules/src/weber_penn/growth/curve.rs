//! Curvature from segment to segment: curve, back curve and random bend (Weber and Penn 1995,
//! section 4.1).

use std::f32::consts::{PI, TAU};

use super::frame::Frame;
use super::variation::Draws;
use crate::weber_penn::{Dialect, Level};

// At 90 degrees a helix would not climb at all and its radius be infinite.
const STEEPEST_HELIX: f32 = 89.0 * PI / 180.0;

/// The turns of one level's stems, per segment and in radians.
pub(crate) struct Curvature {
    first_half: f32,
    second_half: f32,
    // Segments before this one belong to the first half (Arbaro's rule for odd numbers).
    half: u32,
    tilt: f32,
    // tree-gen's random bend turns about local x alone.
    in_plane: bool,
    sideways: f32,
}

impl Curvature {
    pub(crate) fn new(level: &Level, dialect: Dialect) -> Self {
        let n_curve_res = level.curve_res as f32;
        let (first_half, second_half) = if level.curve_back == 0.0 {
            (level.curve / n_curve_res, level.curve / n_curve_res)
        } else {
            (level.curve / (n_curve_res / 2.0), level.curve_back / (n_curve_res / 2.0))
        };
        Self {
            first_half,
            second_half,
            half: level.curve_res.div_ceil(2),
            tilt: level.curve_v.max(0.0) / n_curve_res,
            in_plane: dialect == Dialect::TreeGen,
            sideways: level.bend_v / n_curve_res,
        }
    }

    /// The frame of segment `s` (1 or more), from that of the segment before it.
    ///
    /// `correction` is what a split left to turn about local x. The random bend tilts the stem
    /// toward a random bearing, as in Arbaro; the paper does not give its axis. In tree-gen it
    /// turns about local x, and a sideways bend of its own about local y.
    pub(crate) fn turned(
        &self,
        frame: Frame,
        s: u32,
        correction: f32,
        tilts: &mut Draws,
        sideways: &mut Draws,
    ) -> Frame {
        let curve = if s < self.half { self.first_half } else { self.second_half };
        let mut frame = frame;
        if curve + correction != 0.0 {
            frame = frame.turned_x(curve + correction);
        }
        if self.tilt != 0.0 {
            let angle = tilts.around(0.0, self.tilt);
            frame = match self.in_plane {
                true => frame.turned_x(angle),
                false => frame.tilted(angle, tilts.between(0.0, TAU)),
            };
        }
        if self.sideways != 0.0 {
            frame = frame.turned_y(sideways.around(0.0, self.sideways));
        }
        frame
    }
}

/// The radius of the helix that a negative nCurveV makes of a stem, one turn per segment; 0 for
/// other stems. The paper gives the declination |nCurveV| alone, the construction is Arbaro's.
pub(crate) fn helix_radius(curve_v: f32, segment_length: f32) -> f32 {
    if curve_v >= 0.0 {
        return 0.0;
    }
    libm::tanf((-curve_v).min(STEEPEST_HELIX)) * segment_length / TAU
}
