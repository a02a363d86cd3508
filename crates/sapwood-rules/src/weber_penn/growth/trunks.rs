//! The seeds of the trunks: the size of the tree, and where its trunks stand (Weber and Penn
//! 1995, sections 4.3 and 4.4; several trunks after Arbaro).

use std::f32::consts::{FRAC_PI_2, TAU};

use glam::Vec3;
use sapwood_geom::{Purpose, StreamPath, sin_cos};

use super::children::{SHORTEST, THINNEST};
use super::frame::Frame;
use super::placement::{Step, Turn};
use super::stem::StemSeed;
use super::variation::{Draws, greatest_deviation};
use crate::weber_penn::{Crown, Dialect, Level};

// The oak's 10 ± 10 could give a tree of no size.
const SMALLEST: f32 = 0.05;

/// The seeds of a tree's trunks; `path` is where the tree's random streams start.
///
/// A single trunk stands at the origin, several are scattered over a disc of radius
/// `level.branch_dist` metres. All share one size of the tree; in tree-gen's dialect each has a
/// size of its own, several face outward, and one faces any way. `charge` is told of the number
/// before memory is taken.
pub fn trunks<E>(
    crown: &Crown,
    level: &Level,
    path: StreamPath,
    charge: &mut impl FnMut(usize) -> Result<(), E>,
) -> Result<Vec<StemSeed>, E> {
    let count = if crown.levels == 0 { 0 } else { level.branches.max(0) as usize };
    charge(count)?;
    let draws = |purpose| Draws::new(path, Purpose(purpose), crown.variation);
    let tree_gen = crown.dialect == Dialect::TreeGen;
    let mut rolls = draws("trunk roll");
    let whole = scale_tree(crown, path);
    let (mut places, mut turn) = (draws("trunk place"), Turn::default());
    let (mut down_angles, mut rotations) = (draws("trunk down angle"), draws("trunk rotation"));
    let (mut lengths, mut radii) = (draws("trunk length"), draws("trunk radius"));
    let mut seeds = Vec::with_capacity(count);
    for key in 0..count {
        let (origin, outward) = if count > 1 {
            let radius = level.branch_dist * places.between(0.0, 1.0).sqrt();
            let bearing = places.between(0.0, TAU);
            let (sin, cos) = sin_cos(bearing);
            // Positive angles about x lead toward -y, a quarter turn behind x.
            (Vec3::new(radius * cos, radius * sin, 0.0), bearing + FRAC_PI_2)
        } else {
            (Vec3::ZERO, 0.0)
        };
        let roll = match tree_gen {
            true if count > 1 => outward,
            true => rolls.between(0.0, TAU),
            false => 0.0,
        };
        let own = tree_gen && count > 1;
        let scale_tree = if own { scale_tree(crown, path.child(key as u64)) } else { whole };
        let angle = roll + turn.next(Step::Next, level.rotate, level.rotate_v, &mut rotations);
        let down = down_angles.around(level.down_angle, level.down_angle_v);
        let length_child_max = lengths.around(level.length, level.length_v).max(0.0);
        let length = length_child_max * scale_tree;
        let scale = radii.around(level.radius_scale, level.radius_scale_v).max(0.0);
        let radius = length * crown.ratio * scale;
        if length > SHORTEST && radius > THINNEST {
            seeds.push(StemSeed {
                path: path.child(key as u64),
                level: 0,
                frame: Frame::IDENTITY.at(origin).turned_z(angle).turned_x(down),
                length,
                radius,
                free_radius: radius,
                offset: 0.0,
                parent_length: 0.0,
                parent_radius: 0.0,
                length_child_max,
                scale_tree,
            });
        }
    }
    Ok(seeds)
}

/// Scale ± ScaleV in metres, drawn once per tree; at least a twentieth of Scale.
pub(crate) fn scale_tree(crown: &Crown, path: StreamPath) -> f32 {
    let mut draws = Draws::new(path, Purpose("scale"), crown.variation);
    draws.around(crown.scale, crown.scale_v).max(SMALLEST * crown.scale)
}

/// The greatest size of a tree in metres that any path gives.
pub(crate) fn scale_limit(crown: &Crown) -> f32 {
    let spread = greatest_deviation(crown.variation) * crown.scale_v.abs();
    (crown.scale + spread).max(SMALLEST * crown.scale).max(0.0)
}
