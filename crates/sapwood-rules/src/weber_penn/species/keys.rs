//! The table of keys: what a species file may say, and which values are accepted where.
//!
//! One row per key, in the order in which a file is written. Reading text is left to others: they
//! look a key up by its dotted name, hand it a [`Value`], and report the [`Fault`] at the place
//! they know. A species built in code is checked by [`Species::faults`].
//!
//! Every range has two ends. Where the model sets none, the end lies far beyond any tree: it is
//! there to refuse slips of the pen, not to keep growth small, which is what budgets do.

use std::fmt;

use sapwood_images::{BarkKind, LeafOutline};

use super::accepted::Accepted;
use super::choices::{Dialect, LeafShape, Origin, Variation};
use super::value::{Field, Value};
use super::{Species, TreeGenExt};

/// A value that its key does not accept.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// The dotted name of the key.
    pub key: &'static str,
    /// The value.
    pub value: Value,
    /// What would have been accepted.
    pub accepted: Accepted,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} is {}; accepted: {}", self.key, self.value, self.accepted)
    }
}

impl std::error::Error for Fault {}

/// A key of a species file.
pub struct Key {
    name: &'static str,
    accepted: Accepted,
    // What files of that origin, or species of that dialect, may say instead.
    in_arbaro: Option<Accepted>,
    in_tree_gen: Option<Accepted>,
    get: fn(&Species) -> Option<Value>,
    set: fn(&mut Species, &Value) -> Option<()>,
}

impl Key {
    /// The dotted name, such as `level.2.down_angle`.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// What the key accepts in a species of this origin and dialect.
    pub fn accepted(&self, origin: Origin, dialect: Dialect) -> Accepted {
        let tree_gen = origin == Origin::TreeGen || dialect == Dialect::TreeGen;
        let arbaro = origin == Origin::Arbaro || dialect == Dialect::Arbaro;
        let own = if tree_gen { self.in_tree_gen } else { None };
        own.or(if arbaro { self.in_arbaro } else { None }).unwrap_or(self.accepted)
    }

    /// The value in `species`; `None` where an optional key is absent.
    pub fn get(&self, species: &Species) -> Option<Value> {
        (self.get)(species)
    }

    /// Sets the value in `species`, or says why not.
    ///
    /// Set `origin` and `dialect` before all else, for they decide what other keys accept.
    pub fn set(&self, species: &mut Species, value: &Value) -> Result<(), Fault> {
        let accepted = self.accepted(species.origin, species.effective_dialect());
        if accepted.accepts(value, species.origin) {
            let shape = match (accepted, value) {
                (Accepted::LeafShape, Value::Text(name)) => {
                    LeafShape::from_name(name, species.origin).and_then(|shape| shape.to_value())
                }
                _ => None,
            };
            if (self.set)(species, shape.as_ref().unwrap_or(value)).is_some() {
                return Ok(());
            }
        }
        Err(Fault { key: self.name, value: value.clone(), accepted })
    }
}

impl fmt::Debug for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Key").field(&self.name).finish()
    }
}

/// All keys, in the order in which a file is written.
pub fn keys() -> &'static [Key] {
    KEYS
}

/// The key of this dotted name.
pub fn key(name: &str) -> Option<&'static Key> {
    KEYS.iter().find(|key| key.name == name)
}

impl Species {
    /// The values that their keys do not accept, in the order of the table.
    pub fn faults(&self) -> Vec<Fault> {
        let dialect = self.effective_dialect();
        let fault = |key: &Key| {
            let (value, accepted) = (key.get(self)?, key.accepted(self.origin, dialect));
            let fine = accepted.accepts(&value, self.origin);
            (!fine).then_some(Fault { key: key.name, value, accepted })
        };
        KEYS.iter().filter_map(fault).collect()
    }
}

const ANGLE: Accepted = range(-180.0, 180.0);
const TURN: Accepted = range(-360.0, 360.0);
/// A bend over a whole stem, up to a hundred times round.
const BEND: Accepted = range(-36_000.0, 36_000.0);
const SHARE: Accepted = range(0.0, 1.0);
/// Lengths in metres.
const SIZE: Accepted = above_zero(1_000.0);
const SIZE_V: Accepted = range(0.0, 1_000.0);
/// Factors, and what varies them.
const FACTOR: Accepted = above_zero(100.0);
const FACTOR_V: Accepted = range(0.0, 100.0);
const SIGNED_FACTOR: Accepted = range(-100.0, 100.0);
/// Stems or leaves on one stem; negative: a fan.
const CHILDREN: Accepted = whole_from(-100_000, 100_000);
const TAPER: Accepted = Accepted::Number { min: 0.0, above_min: false, max: 3.0, below_max: true };
/// Linear red, green and blue.
const COLOR: Accepted = list(3, 0.0, 1.0);
const QUALITY: Accepted = above_zero(1.0);

const fn range(min: f32, max: f32) -> Accepted {
    Accepted::Number { min, above_min: false, max, below_max: false }
}

const fn above_zero(max: f32) -> Accepted {
    Accepted::Number { min: 0.0, above_min: true, max, below_max: false }
}

const fn whole_from(min: i64, max: i64) -> Accepted {
    Accepted::Whole { min, max }
}

const fn list(len: usize, min: f32, max: f32) -> Accepted {
    Accepted::Numbers { len, min, max }
}

/// The names of a table of names and what they stand for.
const fn names<T: Copy, const N: usize>(table: [(&'static str, T); N]) -> [&'static str; N] {
    let mut names = [""; N];
    let mut i = 0;
    while i < N {
        names[i] = table[i].0;
        i += 1;
    }
    names
}

static BARKS: [&str; BarkKind::NAMES.len()] = names(BarkKind::NAMES);
static OUTLINES: [&str; LeafOutline::NAMES.len()] = names(LeafOutline::NAMES);

const fn or(wider: Accepted) -> Option<Accepted> {
    Some(wider)
}

macro_rules! row {
    ($name:expr, $accepted:expr, $arbaro:expr, $tree_gen:expr, $($field:tt)+) => {
        Key {
            name: $name,
            accepted: $accepted,
            in_arbaro: $arbaro,
            in_tree_gen: $tree_gen,
            get: |species| species.$($field)+.to_value(),
            set: |species, value| {
                species.$($field)+ = Field::from_value(value)?;
                Some(())
            },
        }
    };
}

macro_rules! ext_row {
    ($name:expr, $accepted:expr, $field:ident) => {
        Key {
            name: $name,
            accepted: $accepted,
            in_arbaro: None,
            in_tree_gen: None,
            get: |species| species.ext.as_ref()?.$field.to_value(),
            set: |species, value| {
                let field = Field::from_value(value)?;
                species.ext.get_or_insert_with(TreeGenExt::default).$field = field;
                Some(())
            },
        }
    };
}

macro_rules! table {
    (
        top: { $($key:literal: $accepted:expr, $arbaro:expr, $tree_gen:expr, ($($field:tt)+);)* }
        level: { $($level_key:literal: $level_accepted:expr, $level_tree_gen:expr, $level_field:ident;)* }
        ext: { $($ext_key:literal: $ext_accepted:expr, $ext_field:ident;)* }
    ) => {
        static KEYS: &[Key] = &[
            $(row!($key, $accepted, $arbaro, $tree_gen, $($field)+),)*
            $(row!(
                concat!("level.0.", $level_key),
                $level_accepted, None, $level_tree_gen,
                level[0].$level_field
            ),)*
            row!("level.0.branch_dist", SIZE_V, None, None, level[0].branch_dist),
            $(row!(
                concat!("level.1.", $level_key),
                $level_accepted, None, $level_tree_gen,
                level[1].$level_field
            ),)*
            row!("level.1.branch_dist", SHARE, None, None, level[1].branch_dist),
            $(row!(
                concat!("level.2.", $level_key),
                $level_accepted, None, $level_tree_gen,
                level[2].$level_field
            ),)*
            row!("level.2.branch_dist", SHARE, None, None, level[2].branch_dist),
            $(row!(
                concat!("level.3.", $level_key),
                $level_accepted, None, $level_tree_gen,
                level[3].$level_field
            ),)*
            row!("level.3.branch_dist", SHARE, None, None, level[3].branch_dist),
            $(ext_row!(concat!("ext.tree_gen.", $ext_key), $ext_accepted, $ext_field),)*
        ];
    };
}

table! {
    top: {
        "name": Accepted::Text, None, None, (name);
        "origin": Accepted::Names(Origin::NAMES), None, None, (origin);
        "defaulted": Accepted::Texts, None, None, (defaulted);
        "notes": Accepted::Texts, None, None, (notes);
        "dialect": Accepted::Names(Dialect::NAMES), None, None, (dialect);
        "variation": Accepted::Names(Variation::NAMES), None, None, (variation);
        "attraction_target": Accepted::Target, None, None, (attraction_target);
        "shape": whole_from(0, 8), None, None, (shape);
        "base_size": SHARE, None, None, (base_size);
        "scale": SIZE, None, None, (scale);
        "scale_v": SIZE_V, None, None, (scale_v);
        "z_scale": range(-1_000.0, 1_000.0), None, None, (z_scale);
        "z_scale_v": range(-1_000.0, 1_000.0), None, None, (z_scale_v);
        "levels": whole_from(1, 9), or(whole_from(0, 9)), None, (levels);
        "ratio": above_zero(10.0), None, None, (ratio);
        "ratio_power": SIGNED_FACTOR, None, None, (ratio_power);
        "lobes": whole_from(0, 1_000), None, None, (lobes);
        "lobe_depth": FACTOR_V, None, None, (lobe_depth);
        "flare": range(-1.0, 100.0), None, None, (flare);
        "attraction_up": SIGNED_FACTOR, None, None, (attraction_up);
        "smooth": SHARE, None, None, (smooth);
        "trunk.scale": FACTOR, None, None, (trunk.scale);
        "trunk.scale_v": FACTOR_V, None, None, (trunk.scale_v);
        "trunk.base_splits": whole_from(0, 100), None, or(whole_from(-100, 100)), (trunk.base_splits);
        "roots.count": whole_from(0, 1_000), None, None, (roots.count);
        "roots.length": FACTOR_V, None, None, (roots.length);
        "roots.length_v": FACTOR_V, None, None, (roots.length_v);
        "roots.radius": FACTOR_V, None, None, (roots.radius);
        "roots.down_angle": ANGLE, None, None, (roots.down_angle);
        "roots.down_angle_v": ANGLE, None, None, (roots.down_angle_v);
        "roots.rotate_v": TURN, None, None, (roots.rotate_v);
        "roots.taper": TAPER, None, None, (roots.taper);
        "roots.seg_splits": FACTOR_V, None, None, (roots.seg_splits);
        "roots.split_angle": range(0.0, 180.0), None, None, (roots.split_angle);
        "roots.split_angle_v": range(0.0, 180.0), None, None, (roots.split_angle_v);
        "roots.curve_res": whole_from(1, 1_000), None, None, (roots.curve_res);
        "roots.curve": BEND, None, None, (roots.curve);
        "roots.curve_v": range(-90.0, 36_000.0), None, None, (roots.curve_v);
        "leaves.count": CHILDREN, None, None, (leaves.count);
        "leaves.shape": Accepted::LeafShape, None, None, (leaves.shape);
        "leaves.mesh": Accepted::LeafMesh, None, None, (leaves.mesh);
        "leaves.image": Accepted::LeafImage, None, None, (leaves.image);
        "leaves.scale": above_zero(100.0), None, None, (leaves.scale);
        "leaves.scale_x": FACTOR, None, None, (leaves.scale_x);
        "leaves.bend": SHARE, None, None, (leaves.bend);
        "leaves.stem_len": SIGNED_FACTOR, None, None, (leaves.stem_len);
        "leaves.distrib": whole_from(0, 8), None, None, (leaves.distrib);
        "leaves.quality": QUALITY, None, None, (leaves.quality);
        "leaves.attraction": SIGNED_FACTOR, None, None, (leaves.attraction);
        "leaves.target": Accepted::LeafTarget, None, None, (leaves.target);
        "leaves.outline": Accepted::Names(&OUTLINES), None, None, (leaves.outline);
        "leaves.color": COLOR, None, None, (leaves.color);
        "leaves.vein_color": COLOR, None, None, (leaves.vein_color);
        "leaves.translucency": SHARE, None, None, (leaves.translucency);
        "leaves.roundness": SHARE, None, None, (leaves.roundness);
        "bark.kind": Accepted::Names(&BARKS), None, None, (bark.kind);
        "bark.color": COLOR, None, None, (bark.color);
        "bark.deep_color": COLOR, None, None, (bark.deep_color);
        "bark.depth": range(0.0, 1.0), None, None, (bark.depth);
        "bark.width": range(0.001, 100.0), None, None, (bark.width);
        "bark.twig_color": COLOR, None, None, (bark.twig_color);
        "pruning.ratio": SHARE, None, None, (pruning.ratio);
        "pruning.width": SHARE, None, None, (pruning.width);
        "pruning.width_peak": SHARE, None, None, (pruning.width_peak);
        "pruning.power_low": FACTOR_V, None, None, (pruning.power_low);
        "pruning.power_high": FACTOR_V, None, None, (pruning.power_high);
        "pruning.envelope": Accepted::Envelope, None, None, (pruning.envelope);
    }
    level: {
        "down_angle": ANGLE, None, down_angle;
        "down_angle_v": ANGLE, None, down_angle_v;
        "rotate": TURN, None, rotate;
        "rotate_v": TURN, None, rotate_v;
        "branches": CHILDREN, None, branches;
        "length": FACTOR_V, None, length;
        "length_v": FACTOR_V, None, length_v;
        "taper": TAPER, None, taper;
        "seg_splits": FACTOR_V, None, seg_splits;
        "split_angle": range(0.0, 180.0), or(ANGLE), split_angle;
        "split_angle_v": range(0.0, 180.0), or(ANGLE), split_angle_v;
        "curve_res": whole_from(1, 1_000), None, curve_res;
        "curve": BEND, None, curve;
        "curve_back": BEND, None, curve_back;
        "curve_v": range(-90.0, 36_000.0), None, curve_v;
        "leaves": CHILDREN, None, leaves;
        "sides": whole_from(3, 256), None, sides;
        "segments": whole_from(1, 1_000), None, segments;
    }
    ext: {
        "base_size": list(4, 0.0, 1.0), base_size;
        "bend_v": list(4, -36_000.0, 36_000.0), bend_v;
        "branch_dist": list(4, 0.0, 1_000.0), branch_dist;
        "radius_mod": list(4, 0.0, 100.0), radius_mod;
        "tropism": list(3, -100.0, 100.0), tropism;
        "blossom_rate": SHARE, blossom_rate;
        "blossom_scale": FACTOR_V, blossom_scale;
        "blossom_shape": whole_from(-1_000, 1_000), blossom_shape;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::weber_penn::{LeafTarget, Target};

    #[test]
    fn keys_are_unique_and_found_by_name() {
        for (i, row) in KEYS.iter().enumerate() {
            assert!(std::ptr::eq(key(row.name).unwrap(), &KEYS[i]), "{} stands twice", row.name);
        }
        assert!(key("level.4.length").is_none());
    }

    #[test]
    fn the_default_species_has_no_faults() {
        assert_eq!(Species::default().faults(), []);
    }

    #[test]
    fn every_key_reads_back_what_it_wrote() {
        let mut from = Species { smooth: Some(0.25), ..Species::default() };
        from.attraction_target = Target::Point(glam::Vec3::X);
        from.leaves.target = LeafTarget::Direction(glam::Vec3::Y);
        from.leaves.shape = LeafShape::Disc(7);
        from.leaves.outline = Some(LeafOutline::Oak);
        from.leaves.color = Some([0.5, 0.25, 0.0]);
        from.bark.kind = Some(BarkKind::Eyed);
        from.bark.width = Some(0.75);
        from.ext = Some(TreeGenExt { tropism: Some([0.0, 0.0, 2.0]), ..TreeGenExt::default() });
        from.level[2].curve_v = -30.0;
        let mut to = Species { scale: 99.0, ..Species::default() };
        for key in keys() {
            if let Some(value) = key.get(&from) {
                key.set(&mut to, &value).unwrap();
            }
        }
        assert_eq!(from, to);
    }

    #[test]
    fn numbers_that_are_not_finite_are_rejected_everywhere() {
        for key in keys() {
            for bad in [f32::NAN, f32::INFINITY, -f32::INFINITY] {
                let mut species = Species::default();
                for value in [
                    Value::Number(bad),
                    Value::Numbers(vec![0.0, bad, 1.0]),
                    Value::Numbers(vec![0.0, bad, 1.0, 0.0]),
                    Value::Point([bad, 0.0, 0.0]),
                ] {
                    assert!(key.set(&mut species, &value).is_err(), "{} = {value}", key.name());
                }
                assert_eq!(species, Species::default());
            }
        }
    }

    #[test]
    fn every_number_is_held_to_its_range() {
        let check = |name: &str, accepted: &[f32], rejected: &[f32]| {
            for (values, fine) in [(accepted, true), (rejected, false)] {
                for value in values {
                    let set =
                        key(name).unwrap().set(&mut Species::default(), &Value::Number(*value));
                    assert_eq!(set.is_ok(), fine, "{name} = {value}");
                }
            }
        };
        check("shape", &[0.0, 8.0], &[-1.0, 9.0, 0.5]);
        check("base_size", &[0.0, 1.0], &[-0.01, 1.01]);
        check("scale", &[0.01, 1e3], &[0.0, -1.0, 1001.0]);
        check("levels", &[1.0, 9.0], &[0.0, 10.0]);
        check("flare", &[-1.0, 10.0], &[-1.01, 101.0]);
        check("lobes", &[0.0, 10.0], &[-1.0, 1001.0, 1e20]);
        check("trunk.base_splits", &[0.0, 3.0], &[-2.0, 101.0]);
        check("leaves.count", &[-20.0, 400.0], &[0.5, 100_001.0, 1e20]);
        check("leaves.quality", &[0.01, 1.0], &[0.0, 1.01]);
        check("leaves.translucency", &[0.0, 1.0], &[-0.1, 1.1]);
        check("bark.width", &[0.001, 2.0], &[0.0, -1.0, 101.0]);
        check("bark.depth", &[0.0, 0.1], &[-0.1, 1.5]);
        check("level.1.taper", &[0.0, 2.999], &[-0.1, 3.0]);
        check("level.2.curve_v", &[-90.0, 500.0], &[-90.1, 36_001.0]);
        check("level.3.curve_res", &[1.0, 1e3], &[0.0, 1001.0]);
        check("level.0.sides", &[3.0, 256.0], &[2.0, 4.5, 257.0]);
        check("level.2.segments", &[1.0, 1e3], &[0.0, 1001.0]);
        check("level.1.seg_splits", &[0.0, 100.0], &[-0.1, 1e30]);
        check("level.0.branch_dist", &[0.0, 5.0], &[-0.1]);
        check("level.1.branch_dist", &[0.0, 1.0], &[1.1]);
        check("level.1.split_angle", &[0.0, 180.0], &[-80.0]);
        check("level.1.down_angle_v", &[-50.0], &[-181.0]);
    }

    #[test]
    fn every_range_has_two_ends() {
        for key in keys() {
            for (origin, dialect) in [
                (Origin::Paper, Dialect::Paper),
                (Origin::Arbaro, Dialect::Arbaro),
                (Origin::TreeGen, Dialect::TreeGen),
            ] {
                let ends = match key.accepted(origin, dialect) {
                    Accepted::Number { min, max, .. } | Accepted::Numbers { min, max, .. } => {
                        [min, max]
                    }
                    Accepted::Whole { min, max } => [min as f32, max as f32],
                    _ => continue,
                };
                let sensible = ends.iter().all(|end| end.abs() <= 1e5) && ends[0] < ends[1];
                assert!(sensible, "{}: {ends:?}", key.name());
            }
        }
    }

    #[test]
    fn species_of_tree_gen_may_split_at_random_and_in_a_plane() {
        let mut species = Species { origin: Origin::TreeGen, ..Species::default() };
        species.trunk.base_splits = -2;
        species.level[1].split_angle = -80.0;
        assert_eq!(species.faults(), []);
        species.origin = Origin::Paper;
        let keys: Vec<_> = species.faults().into_iter().map(|fault| fault.key).collect();
        assert_eq!(keys, ["trunk.base_splits", "level.1.split_angle"]);
        species.dialect = Some(Dialect::TreeGen);
        assert_eq!(species.faults(), []);
    }

    #[test]
    fn a_fault_names_key_value_and_range() {
        let fault = key("level.1.taper").unwrap();
        let fault = fault.set(&mut Species::default(), &Value::Number(3.5)).unwrap_err();
        let text = "level.1.taper is 3.5; accepted: a number at least 0 and below 3";
        assert_eq!(fault.to_string(), text);
    }
}
