//! From stems to the seeds of the next level (Weber and Penn 1995, sections 4.3 and 4.4).

use std::f32::consts::TAU;

use sapwood_geom::Purpose;

use super::frame::Frame;
use super::placement::{Grouping, Places, Turn, Turns, down_angle, fan_angle, height_ratio};
use super::shape_ratio::shape_ratio;
use super::stem::{Stem, StemSeed, Stems};
use super::variation::Draws;
use crate::weber_penn::Dialect;
use crate::weber_penn::{Crown, Level, TrunkForm};

/// Stems no longer than this, in metres, do not grow.
pub(crate) const SHORTEST: f32 = 1e-5;
/// Stems no thicker than this radius, in metres, do not grow.
pub(crate) const THINNEST: f32 = 1e-6;
/// tree-gen's stems are no thinner than this radius in metres, unless their parents are.
pub(crate) const TREE_GEN_THINNEST: f32 = 0.005;

/// The seeds of the stems that grow on `stems`, in the order of their parents and from base to
/// tip; `child` is the set of parameters of their level.
///
/// `form` is the trunk's form if `stems` are trunks: no child is thicker than the flared radius
/// it grows from. Too short and too thin stems are left out. `charge` is told of every seed
/// before memory is taken for it.
pub fn children<E>(
    stems: &Stems,
    crown: &Crown,
    form: Option<&TrunkForm>,
    child: &Level,
    charge: &mut impl FnMut(usize) -> Result<(), E>,
) -> Result<Vec<StemSeed>, E> {
    children_on(stems, crown, form, child, charge, &mut |_| ())
}

/// As [`children`]; `on` is told for each seed the segment that it grows on, an index into
/// [`Stems::segments`].
///
/// # Errors
/// The first refusal of `charge`.
pub(crate) fn children_on<E>(
    stems: &Stems,
    crown: &Crown,
    form: Option<&TrunkForm>,
    child: &Level,
    charge: &mut impl FnMut(usize) -> Result<(), E>,
    on: &mut impl FnMut(usize),
) -> Result<Vec<StemSeed>, E> {
    let mut seeds = Vec::new();
    let mut turns = Turns::new(stems);
    for (index, stem) in stems.stems.iter().enumerate() {
        let draws = |purpose| Draws::new(stem.seed.path, Purpose(purpose), crown.variation);
        let mut parent = Parent {
            stem,
            crown,
            form,
            child,
            lengths: draws("child length"),
            down_angles: draws("child down angle"),
            rotations: draws("child rotation"),
            key: 0,
        };
        if child.branches < 0 {
            let count = child.branches.unsigned_abs() as usize;
            charge(count)?;
            let tip = stems.frame_at(index, stem.seed.length);
            for i in 0..count {
                let angle =
                    fan_angle(i, count, child.rotate, child.rotate_v, &mut parent.rotations);
                let seed = parent.seed(stem.seed.length, tip.turned_y(angle));
                seed.iter().for_each(|_| on(stem.segment_range().end - 1));
                seeds.extend(seed);
            }
            continue;
        }
        let mut count = n_children(stem, child);
        let grouping = Grouping::new(child.grouping, child.branch_dist);
        let mut turn = turns.start(stems, stem);
        if crown.dialect == Dialect::TreeGen {
            turn = Turn::starting_at(parent.rotations.between(0.0, TAU));
            if stem.seed.level == 0 {
                count *= draws("child count").between(0.9, 1.1);
            }
        }
        let mut places = Places::new(stem, count, grouping, Purpose("child place"));
        for at in stem.segment_range() {
            let segment = &stems.segments[at];
            let (count, slots) = places.on(segment, segment.share);
            if count > 0 {
                charge(count)?;
            }
            for i in 0..count {
                let (offset, step) = places.at(slots, i);
                let angle = turn.next(step, child.rotate, child.rotate_v, &mut parent.rotations);
                let center = stems.center_in(index, segment, offset);
                let seed = parent.seed(offset, segment.frame.at(center).turned_z(angle));
                seed.iter().for_each(|_| on(at));
                seeds.extend(seed);
            }
            turns.note(at, turn);
        }
    }
    Ok(seeds)
}

/// How many children a stem carries if it never splits; no whole number.
pub(crate) fn n_children(stem: &Stem, child: &Level) -> f32 {
    let stems_max = child.branches.max(0) as f32;
    let seed = &stem.seed;
    match seed.level {
        0 => stems_max,
        1 => {
            let whole = seed.parent_length * seed.length_child_max;
            let ratio = if whole > 0.0 { seed.length / whole } else { 0.0 };
            stems_max * (0.2 + 0.8 * ratio)
        }
        _ => stems_max * (1.0 - 0.5 * seed.offset / seed.parent_length),
    }
}

/// A stem that children grow on.
struct Parent<'a> {
    stem: &'a Stem,
    crown: &'a Crown,
    form: Option<&'a TrunkForm>,
    child: &'a Level,
    lengths: Draws,
    down_angles: Draws,
    rotations: Draws,
    // Of the next child's path; those that do not grow count too.
    key: u64,
}

impl Parent<'_> {
    /// The next child, from its frame before the down angle; `None` if it does not grow.
    fn seed(&mut self, offset: f32, frame: Frame) -> Option<StemSeed> {
        let (stem, crown, child) = (self.stem, self.crown, self.child);
        let Level { length, length_v, down_angle: down, down_angle_v: down_v, .. } = *child;
        let key = self.key;
        self.key += 1;
        let length_child_max = self.lengths.around(length, length_v).max(0.0);
        let down = down_angle(down, down_v, stem, offset, crown.dialect, &mut self.down_angles);

        let length_parent = stem.seed.length;
        let length = length_child_max * relative_length(stem, offset, crown);
        let z = offset / length_parent;
        let factor = self.form.filter(|_| stem.seed.level == 0).map_or(1.0, |form| form.factor(z));
        let parent_radius = stem.radius_at(z) * factor;
        let falloff = libm::powf(length / length_parent, crown.ratio_power);
        let free_radius = stem.seed.radius * falloff * child.radius_scale;
        let radius = held_radius(free_radius, parent_radius, crown);
        // Written so that a number that is not one does not grow either.
        let grows = length > SHORTEST && radius > THINNEST;
        grows.then(|| StemSeed {
            path: stem.seed.path.child(key),
            level: stem.seed.level + 1,
            frame: frame.turned_x(down),
            length,
            radius,
            free_radius,
            offset,
            parent_length: length_parent,
            parent_radius,
            length_child_max,
            scale_tree: stem.seed.scale_tree,
        })
    }
}

/// The radius in metres of a stem beyond the trunk that would be so thick if its parent were not
/// thinner.
pub(crate) fn held_radius(free_radius: f32, parent_radius: f32, crown: &Crown) -> f32 {
    let free_radius = match crown.dialect {
        Dialect::TreeGen => free_radius.max(TREE_GEN_THINNEST),
        Dialect::Paper | Dialect::Arbaro => free_radius,
    };
    free_radius.min(parent_radius)
}

/// The length in metres of a child at `offset` whose greatest relative length is 1.
fn relative_length(parent: &Stem, offset: f32, crown: &Crown) -> f32 {
    let length_parent = parent.seed.length;
    if parent.seed.level == 0 {
        let r = height_ratio(parent, offset);
        return length_parent * shape_ratio(crown.shape, r, &crown.pruning, crown.dialect);
    }
    (length_parent - lost_length(crown.dialect) * offset).max(0.0)
}

/// The length that stems beyond the first branches lose for each metre of their offset.
pub(crate) fn lost_length(dialect: Dialect) -> f32 {
    match dialect {
        Dialect::TreeGen => 0.7,
        Dialect::Paper | Dialect::Arbaro => 0.6,
    }
}
