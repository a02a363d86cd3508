//! The seeds of roots, which the model knows nothing of: stems that grow from the trunk's foot,
//! outward and down.

use std::f32::consts::TAU;

use sapwood_geom::Purpose;

use super::children::{SHORTEST, THINNEST};
use super::curve::helix_radius;
use super::stem::{StemSeed, Stems};
use super::variation::{Draws, greatest_deviation};
use crate::weber_penn::{Crown, Level, RootParams};

// Keys of roots below their trunk's path; children are numbered from 0, clones from 2^63.
const ROOT_KEY: u64 = 1 << 62;

/// The seeds of the roots of trunks, trunk by trunk; stems of other levels and clones have none.
///
/// Roots stand evenly about the trunk's axis and begin on it, half their radius above the foot.
/// They count as stems of level 1. `charge` is told of their number before memory is taken for
/// them.
///
/// # Errors
/// The first refusal of `charge`.
pub fn roots<E>(
    stems: &Stems,
    crown: &Crown,
    params: &RootParams,
    charge: &mut impl FnMut(usize) -> Result<(), E>,
) -> Result<Vec<StemSeed>, E> {
    let is_trunk = |seed: &StemSeed| seed.level == 0;
    let trunks = stems.stems.iter().filter(|stem| stem.clone_of.is_none());
    let mut seeds = Vec::new();
    for trunk in trunks.map(|stem| &stem.seed).filter(|seed| is_trunk(seed)) {
        charge(params.count as usize)?;
        let draws = |purpose| Draws::new(trunk.path, Purpose(purpose), crown.variation);
        let (mut lengths, mut down_angles) = (draws("root length"), draws("root down angle"));
        let mut rotations = draws("root rotation");
        let mut first = draws("root bearing");
        let bearing = if params.count > 0 { first.between(0.0, TAU) } else { 0.0 };
        for number in 0..params.count {
            let share = lengths.around(params.length, params.length_v).max(0.0);
            let (length, radius) = (share * trunk.length, params.radius * trunk.radius);
            let even = TAU * (number as f32 / params.count as f32);
            let angle = bearing + rotations.around(even, params.rotate_v);
            let down = down_angles.around(params.down_angle, params.down_angle_v);
            if !(length > SHORTEST && radius > THINNEST) {
                continue;
            }
            let offset = 0.5 * radius;
            let foot = trunk.frame.at(trunk.frame.origin + offset * trunk.frame.axes.z_axis);
            seeds.push(StemSeed {
                path: trunk.path.child(ROOT_KEY | u64::from(number)),
                level: 1,
                frame: foot.turned_z(angle).turned_x(down),
                length,
                radius,
                free_radius: radius,
                offset,
                parent_length: trunk.length,
                parent_radius: trunk.radius,
                length_child_max: share,
                scale_tree: trunk.scale_tree,
            });
        }
    }
    Ok(seeds)
}

/// How far roots may reach from the foot of their trunk, for one 1 long that is so thick.
pub(crate) fn root_reach(params: &RootParams, crown: &Crown, thickness: f32) -> f32 {
    if params.count == 0 {
        return 0.0;
    }
    let spread = greatest_deviation(crown.variation) * params.length_v.abs();
    let Level { curve_v, curve_res, .. } = params.level;
    // The turns of a helix lead around where it leads.
    let helix = 2.0 * helix_radius(curve_v, 1.0 / curve_res.max(1) as f32);
    (1.0 + helix) * (params.length + spread).max(0.0) + 2.0 * params.radius * thickness
}
