//! Leaves on the stems of the last level (Weber and Penn 1995, sections 4.5 and 4.9).

use std::f32::consts::TAU;

use glam::Affine3;
use sapwood_geom::Purpose;

use super::frame::Frame;
use super::leaf_turns::{LeafTurns, Unturned};
use super::placement::{Grouping, Places, Turn, Turns, down_angle, fan_angle};
use super::shape_ratio::shape_ratio;
use super::stem::{Leaf, Stem, Stems};
use super::variation::Draws;
use crate::weber_penn::{Crown, Dialect, LeafParams, LeafTarget};

/// Where leaves sit on their stems, whatever their length, width and petiole: one row for each
/// leaf, in the order of their stems and from base to tip.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LeafPlaces {
    /// The frame of each leaf where its petiole begins: z along the leaf, y its upper normal. Axes
    /// are as long as leaves of the tree are, compared with those of its species: 1 but in
    /// tree-gen's dialect.
    pub places: Vec<Affine3>,
    /// The stem it grows on, an index into [`Stems::stems`].
    pub stems: Vec<u32>,
}

/// The leaves of `stems`: [`leaf_places`] with everything that makes leaves long and wide.
///
/// `target` stands in tree space. `charge` is told of every leaf before memory is taken for it.
pub fn leaves<E>(
    stems: &Stems,
    crown: &Crown,
    params: &LeafParams,
    target: &LeafTarget,
    charge: &mut impl FnMut(usize) -> Result<(), E>,
) -> Result<Vec<Leaf>, E> {
    let LeafPlaces { places, stems: on } = leaf_places(stems, crown, params, target, charge)?;
    Ok(leaves_at(&places, &on, stems, crown, params))
}

/// The leaves at the places of [`LeafPlaces`].
pub(crate) fn leaves_at(
    places: &[Affine3],
    on: &[u32],
    stems: &Stems,
    crown: &Crown,
    params: &LeafParams,
) -> Vec<Leaf> {
    let (length, width, petiole) = (params.length(), params.width(), params.petiole());
    let leaf = |(place, stem): (&Affine3, &u32)| {
        let size = relative_size(stems.stems[*stem as usize].seed.scale_tree, crown);
        let axes = place.matrix3 * size.recip();
        let origin = place.translation + petiole * size * axes.z_axis;
        let (length, width) = (length * size, width * size);
        Leaf { frame: Frame { origin, axes }, length, width, stem: *stem }
    };
    places.iter().zip(on).map(leaf).collect()
}

/// Where the leaves of `stems` sit.
///
/// Of the parameters, [those of growth](LeafParams::of_growth) act. `target` stands in tree space.
/// `charge` is told of every leaf before memory is taken for it.
pub fn leaf_places<E>(
    stems: &Stems,
    crown: &Crown,
    params: &LeafParams,
    target: &LeafTarget,
    charge: &mut impl FnMut(usize) -> Result<(), E>,
) -> Result<LeafPlaces, E> {
    let likely = likely_number(stems, crown, params);
    let mut leaves =
        LeafPlaces { places: Vec::with_capacity(likely), stems: Vec::with_capacity(likely) };
    let mut turns = Turns::new(stems);
    let tree_gen = crown.dialect == Dialect::TreeGen;
    let grouping = Grouping::new(params.grouping, 1.0);
    let is_scattered = matches!(target, LeafTarget::Scattered);
    let mut unturned = LeafTurns::new(params, target);
    for (index, stem) in stems.stems.iter().enumerate() {
        let size = relative_size(stem.seed.scale_tree, crown);
        let draws = |purpose| Draws::new(stem.seed.path, Purpose(purpose), crown.variation);
        let mut rotations = draws("leaf rotation");
        let mut down_angles = draws("leaf down angle");
        let mut rolls = draws("leaf roll");
        let mut add = |offset, frame: Frame, round: f32, leaves: &mut LeafPlaces| {
            let LeafParams { down_angle: down, down_angle_v: down_v, .. } = *params;
            let down = down_angle(down, down_v, stem, offset, crown.dialect, &mut down_angles);
            let roll = if is_scattered { rolls.between(0.0, TAU) } else { 0.0 };
            leaves.stems.push(index as u32);
            unturned.add(Unturned { frame, round, down, roll, size }, &mut leaves.places);
        };
        if params.count < 0 {
            let count = params.count.unsigned_abs() as usize;
            charge(count)?;
            let tip = stems.frame_at(index, stem.seed.length);
            for i in 0..count {
                let angle = fan_angle(i, count, params.rotate, params.rotate_v, &mut rotations);
                add(stem.seed.length, tip.turned_y(angle), 0.0, &mut leaves);
            }
            continue;
        }
        let count = n_leaves(stem, crown, params);
        let mut places = Places::new(stem, count, grouping, Purpose("leaf place"));
        let mut turn = turns.start(stems, stem);
        if tree_gen {
            turn = Turn::starting_at(rotations.between(0.0, TAU));
        }
        for at in stem.segment_range() {
            let segment = &stems.segments[at];
            // tree-gen's clones have no fewer leaves.
            let share = if tree_gen { 1.0 } else { segment.share };
            let (count, slots) = places.on(segment, share);
            if count > 0 {
                charge(count)?;
                leaves.places.reserve(count);
                leaves.stems.reserve(count);
            }
            for i in 0..count {
                let (offset, step) = places.at(slots, i);
                let angle = turn.next(step, params.rotate, params.rotate_v, &mut rotations);
                let center = stems.center_in(index, segment, offset);
                add(offset, segment.frame.at(center), angle, &mut leaves);
            }
            turns.note(at, turn);
        }
    }
    unturned.finish(&mut leaves.places);
    Ok(leaves)
}

/// The size of a tree relative to its species' own, which leaves follow in tree-gen's dialect.
pub(crate) fn relative_size(scale_tree: f32, crown: &Crown) -> f32 {
    if crown.dialect == Dialect::TreeGen && crown.scale > 0.0 {
        scale_tree / crown.scale
    } else {
        1.0
    }
}

/// About how many leaves there will be; few enough that nobody need be told before memory is
/// taken for them.
fn likely_number(stems: &Stems, crown: &Crown, params: &LeafParams) -> usize {
    let Some(first) = stems.stems.first() else { return 0 };
    let each = if params.count < 0 {
        params.count.unsigned_abs() as f32
    } else {
        n_leaves(first, crown, params) + 0.5
    };
    ((each * stems.stems.len() as f32) as usize).min(1 << 14)
}

/// How many leaves a stem carries if it never splits; no whole number.
///
/// In tree-gen's dialect there are more on larger trees, and on stems that are longer than others
/// of their level.
pub(crate) fn n_leaves(stem: &Stem, crown: &Crown, params: &LeafParams) -> f32 {
    let seed = &stem.seed;
    // A trunk has no parent; its leaves count in full.
    let r = if seed.parent_length > 0.0 { seed.offset / seed.parent_length } else { 1.0 };
    let ratio = shape_ratio(params.distrib, r.clamp(0.0, 1.0), &crown.pruning, crown.dialect);
    let whole = seed.parent_length * seed.length_child_max;
    let relative = match crown.dialect {
        Dialect::TreeGen if whole > 0.0 => {
            seed.length / whole * relative_size(seed.scale_tree, crown)
        }
        Dialect::TreeGen | Dialect::Paper | Dialect::Arbaro => 1.0,
    };
    params.count.max(0) as f32 * ratio * relative * params.quality
}
