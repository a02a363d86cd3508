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

/// tree-gen's share of the children that a stem and its clones go on with after a split.
const CARRIED_ON: f32 = 0.8;

/// Decides and makes the splits of one stem.
///
/// tree-gen's stems split with a probability that begins at 1 and is divided among a stem and its
/// clones at each split, so that their number grows with the number of segments and not by powers;
/// and what leaves a split shares its angle and its spread evenly.
pub(crate) struct Splits<'a> {
    level: &'a Level,
    tree_gen: bool,
    // tree-gen's negative split angle: all stay in one plane, and nothing bends back.
    planar: bool,
    may_split: bool,
    // tree-gen's clone probability; 1 elsewhere.
    probability: f32,
    chances: Draws,
    counts: Diffusion,
    base_splits: usize,
    // At whose end the base splits are, and the first at whose end others are.
    base: u32,
    first: u32,
    angles: Draws,
    spreads: Draws,
    // What the directions of one split of tree-gen share.
    angle: f32,
    spread: f32,
}

impl<'a> Splits<'a> {
    /// The splits of the stem at `path`; `origin` is false for a clone, and `probability` is 1 for
    /// all that are none.
    pub(crate) fn new(
        crown: &Crown,
        level: &'a Level,
        stem: u8,
        path: StreamPath,
        origin: bool,
        probability: f32,
    ) -> Self {
        let tree_gen = crown.dialect == Dialect::TreeGen;
        let draws = |purpose| Draws::new(path, Purpose(purpose), crown.variation);
        let trunk = stem == 0 && origin;
        let error = if level.seg_splits == 0.0 || trunk {
            0.0
        } else {
            draws("split count").between(-0.5, 0.5)
        };
        let base_splits = match level.base_splits {
            _ if !trunk => 0,
            n if n < 0 && tree_gen => draws("base splits").up_to(n.unsigned_abs()) as usize,
            n => n.max(0) as usize,
        };
        // tree-gen's trunk splits from the first segment above its bare part on.
        let bare = if stem == 0 && tree_gen {
            libm::ceilf(crown.base_size * level.curve_res as f32) as u32
        } else {
            0
        };
        // tree-gen's helices do not split.
        let is_helix = tree_gen && level.curve_v < 0.0;
        Self {
            level,
            tree_gen,
            planar: level.split_angle < 0.0 && tree_gen,
            may_split: (level.seg_splits > 0.0 || base_splits > 0) && !is_helix,
            probability,
            chances: draws("split chance"),
            counts: Diffusion::new(error),
            base_splits,
            base: bare.saturating_sub(1),
            first: bare,
            angles: draws("split angle"),
            spreads: draws("split spread"),
            angle: 0.0,
            spread: 0.0,
        }
    }

    /// The clone probability from here on, of the stem and of the clones that have just left it.
    pub(crate) fn probability(&self) -> f32 {
        self.probability
    }

    /// How many clones leave the end of segment `s`, which is not the last.
    pub(crate) fn count(&mut self, s: u32) -> usize {
        if !self.may_split {
            0
        } else if self.is_base(s) {
            self.base_splits
        } else if s < self.first
            || self.probability < 1.0 && self.chances.between(0.0, 1.0) >= self.probability
        {
            0
        } else {
            let clones = self.counts.whole(self.level.seg_splits);
            if self.tree_gen {
                self.probability /= (clones + 1) as f32;
            }
            clones
        }
    }

    fn is_base(&self, s: u32) -> bool {
        s == self.base && self.base_splits > 0
    }

    /// The share of its children that each goes on with after a split into `clones` clones at the
    /// end of segment `s`, from the share before.
    pub(crate) fn shared(&self, share: f32, s: u32, clones: usize) -> f32 {
        match self.tree_gen {
            true if self.is_base(s) => share,
            true => CARRIED_ON * share,
            false => share / (clones + 1) as f32,
        }
    }

    /// The directions after a split into `clones` clones at the end of segment `s`, from the frame
    /// there: the `i`th is that of the original (0) or of a clone, with the correction that
    /// each of the segments that remain takes about local x, `correction` being the one before.
    /// Call it in the order of `i`.
    pub(crate) fn direction(
        &mut self,
        frame: Frame,
        s: u32,
        i: usize,
        clones: usize,
        correction: f32,
    ) -> (Frame, f32) {
        if self.tree_gen {
            return self.shared_direction(frame, s, i, clones);
        }
        let remaining = self.level.curve_res - s - 1;
        let split_angle = self.angles.around(self.level.split_angle, self.level.split_angle_v);
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
        // What an earlier split still owes is owed after this one as well.
        (turned, correction - angle / remaining as f32)
    }

    /// The same in tree-gen: each is turned by half the angle, from half the spread on one side to
    /// half on the other, and the whole angle is undone in place of what was owed before.
    fn shared_direction(&mut self, frame: Frame, s: u32, i: usize, clones: usize) -> (Frame, f32) {
        let Level { split_angle, split_angle_v, curve_res, .. } = *self.level;
        if i == 0 {
            self.angle = self.angles.around(split_angle, split_angle_v);
            if !self.planar {
                let declination = frame.declination();
                self.angle = (self.angle - declination).max(0.0);
                let u = self.spreads.between(0.0, 1.0);
                self.spread = tree_gen_spread(declination, u);
            }
        }
        if self.planar {
            return (frame.turned_y(self.angle * fan_share(i, clones)), 0.0);
        }
        let spread = match self.is_base(s) {
            true if i == 0 => 0.0,
            // Evenly round the trunk.
            true => {
                let even = TAU * i as f32 / (clones + 1) as f32;
                self.spreads.around(even, split_angle_v)
            }
            false => self.spread * fan_share(i, clones),
        };
        let turned = frame.turned_x(0.5 * self.angle).turned_about_tree_z(spread);
        (turned, -self.angle / (curve_res - s) as f32)
    }
}

/// Where the original (0) and its clones lie in a fan: from 0.5 to -0.5, the original in the
/// middle or next to it.
fn fan_share(i: usize, clones: usize) -> f32 {
    let original = clones.div_ceil(2);
    let place = match i {
        0 => original,
        i if i <= original => i - 1,
        i => i,
    };
    0.5 - place as f32 / clones as f32
}

/// How far the original turns about tree z when one clone leaves it; `u` in 0..1.
fn spread(declination: f32, u: f32) -> f32 {
    const DEGREE: f32 = PI / 180.0;
    20.0 * DEGREE + SPREAD_FACTOR * (30.0 * DEGREE + (declination - FRAC_PI_2).abs()) * u * u
}

/// The angle about tree z between the sides of a split of tree-gen, where `u` acts inside the
/// bracket: 42.5 to 110 degrees for an upright stem, always 42.5 for a level one.
fn tree_gen_spread(declination: f32, u: f32) -> f32 {
    const DEGREE: f32 = PI / 180.0;
    20.0 * DEGREE + SPREAD_FACTOR * (30.0 * DEGREE + (declination - FRAC_PI_2).abs() * u * u)
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

    #[test]
    fn tree_gens_spread_is_never_less_than_that_of_a_level_stem() {
        let degrees =
            |declination: f32, u| tree_gen_spread(declination.to_radians(), u).to_degrees();
        for u in [0.0, 0.5, 1.0] {
            assert!((degrees(90.0, u) - 42.5).abs() < 1e-4);
        }
        assert!((degrees(0.0, 0.0) - 42.5).abs() < 1e-4);
        assert!((degrees(0.0, 1.0) - 110.0).abs() < 1e-4);
    }

    #[test]
    fn a_fan_is_even_with_the_original_in_its_middle() {
        let fan = |clones| (0..=clones).map(|i| fan_share(i, clones)).collect::<Vec<_>>();
        assert_eq!(fan(1), [-0.5, 0.5]);
        assert_eq!(fan(2), [0.0, 0.5, -0.5]);
        assert_eq!(fan(4), [0.0, 0.5, 0.25, -0.25, -0.5]);
    }
}
