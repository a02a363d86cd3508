//! Splits into clones: how many, and where each goes (Weber and Penn 1995, section 4.2).

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use sapwood_geom::{Purpose, StreamPath};

use super::frame::Frame;
use super::variation::{Diffusion, Draws};
use crate::weber_penn::Dialect;
use crate::weber_penn::{Crown, Level};

/// The factor in the printed formula of the spread, which gives 42.5 degrees for a horizontal
/// stem and 110 for an upright one; the paper's prose, with 50 and 140, would have 1.
const SPREAD_FACTOR: f32 = 0.75;

/// Decides and makes the splits of one stem.
pub(crate) struct Splits<'a> {
    level: &'a Level,
    // tree-gen's negative split angle: all stay in one plane, and nothing bends back.
    planar: bool,
    may_split: bool,
    counts: Diffusion,
    base_splits: usize,
    angles: Draws,
    spreads: Draws,
}

impl<'a> Splits<'a> {
    /// The splits of the stem at `path`; `origin` is false for a clone.
    pub(crate) fn new(
        crown: &Crown,
        level: &'a Level,
        stem: u8,
        path: StreamPath,
        origin: bool,
    ) -> Self {
        let draws = |purpose| Draws::new(path, Purpose(purpose), crown.variation);
        let trunk = stem == 0 && origin;
        let error = if level.seg_splits == 0.0 || trunk {
            0.0
        } else {
            draws("split count").between(-0.5, 0.5)
        };
        let base_splits = match level.base_splits {
            _ if !trunk => 0,
            n if n < 0 && crown.dialect == Dialect::TreeGen => {
                draws("base splits").up_to(n.unsigned_abs()) as usize
            }
            n => n.max(0) as usize,
        };
        Self {
            level,
            planar: level.split_angle < 0.0 && crown.dialect == Dialect::TreeGen,
            may_split: level.seg_splits > 0.0 || base_splits > 0,
            counts: Diffusion::new(error),
            base_splits,
            angles: draws("split angle"),
            spreads: draws("split spread"),
        }
    }

    /// How many clones leave the end of segment `s`, which is not the last.
    pub(crate) fn count(&mut self, s: u32) -> usize {
        if !self.may_split {
            0
        } else if s == 0 && self.base_splits > 0 {
            self.base_splits
        } else {
            self.counts.whole(self.level.seg_splits)
        }
    }

    /// The directions after a split into `clones` clones, from the frame at its place: the
    /// `i`th is that of the original (0) or of a clone, with the correction that each of the
    /// `remaining` segments takes about local x. Call it in the order of `i`.
    pub(crate) fn direction(
        &mut self,
        frame: Frame,
        i: usize,
        clones: usize,
        remaining: u32,
    ) -> (Frame, f32) {
        let split_angle = self.angles.around(self.level.split_angle, self.level.split_angle_v);
        if self.planar {
            // From half the angle on one side to half on the other.
            let share = 0.5 - i as f32 / clones as f32;
            return (frame.turned_y(split_angle * share), 0.0);
        }
        let declination = frame.declination();
        let angle = (split_angle - declination).max(0.0);
        let spread = if clones > 1 {
            TAU * i as f32 / (clones + 1) as f32
        } else if i == 0 {
            let sign = self.spreads.sign();
            let u = self.spreads.between(0.0, 1.0);
            sign * spread(declination, u)
        } else {
            0.0
        };
        let turned = if angle > 0.0 { frame.turned_x(angle) } else { frame };
        let turned = if spread != 0.0 { turned.turned_about_tree_z(spread) } else { turned };
        (turned, -angle / remaining as f32)
    }
}

/// How far the original turns about tree z when one clone leaves it; `u` in 0..1.
fn spread(declination: f32, u: f32) -> f32 {
    const DEGREE: f32 = PI / 180.0;
    20.0 * DEGREE + SPREAD_FACTOR * (30.0 * DEGREE + (declination - FRAC_PI_2).abs()) * u * u
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spread_is_the_printed_one() {
        let degrees = |declination: f32, u| spread(declination.to_radians(), u).to_degrees();
        assert!((degrees(90.0, 0.0) - 20.0).abs() < 1e-4);
        assert!((degrees(90.0, 1.0) - 42.5).abs() < 1e-4);
        assert!((degrees(0.0, 1.0) - 110.0).abs() < 1e-4);
        assert!((degrees(180.0, 1.0) - 110.0).abs() < 1e-4);
    }
}
