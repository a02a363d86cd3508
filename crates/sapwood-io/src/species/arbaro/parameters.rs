//! The parameters of Arbaro's species files, and the keys of a species they stand for.
//!
//! A level's parameters are called by its digit and their own name, as `2Length`; the trunk's
//! `0Scale`, `0ScaleV` and `0BaseSplits` look like those and belong to no level. What values are
//! accepted stands in the model's table of keys.

use sapwood_rules::weber_penn::{self as model, Key};

/// General parameters, in the order in which Arbaro writes them.
const GENERAL: [(&str, &str); 28] = [
    ("Shape", "shape"),
    ("Levels", "levels"),
    ("Scale", "scale"),
    ("ScaleV", "scale_v"),
    ("BaseSize", "base_size"),
    ("Ratio", "ratio"),
    ("RatioPower", "ratio_power"),
    ("Flare", "flare"),
    ("Lobes", "lobes"),
    ("LobeDepth", "lobe_depth"),
    ("Smooth", "smooth"),
    ("Leaves", "leaves.count"),
    ("LeafShape", "leaves.shape"),
    ("LeafScale", "leaves.scale"),
    ("LeafScaleX", "leaves.scale_x"),
    ("LeafQuality", "leaves.quality"),
    ("LeafStemLen", "leaves.stem_len"),
    ("LeafDistrib", "leaves.distrib"),
    ("LeafBend", "leaves.bend"),
    ("AttractionUp", "attraction_up"),
    ("PruneRatio", "pruning.ratio"),
    ("PrunePowerLow", "pruning.power_low"),
    ("PrunePowerHigh", "pruning.power_high"),
    ("PruneWidth", "pruning.width"),
    ("PruneWidthPeak", "pruning.width_peak"),
    ("0Scale", "trunk.scale"),
    ("0ScaleV", "trunk.scale_v"),
    ("0BaseSplits", "trunk.base_splits"),
];

/// Parameters of a level, in the order in which Arbaro writes them.
const OF_A_LEVEL: [(&str, &str); 16] = [
    ("DownAngle", "down_angle"),
    ("DownAngleV", "down_angle_v"),
    ("Rotate", "rotate"),
    ("RotateV", "rotate_v"),
    ("Branches", "branches"),
    ("BranchDist", "branch_dist"),
    ("Length", "length"),
    ("LengthV", "length_v"),
    ("Taper", "taper"),
    ("SegSplits", "seg_splits"),
    ("SplitAngle", "split_angle"),
    ("SplitAngleV", "split_angle_v"),
    ("CurveRes", "curve_res"),
    ("Curve", "curve"),
    ("CurveBack", "curve_back"),
    ("CurveV", "curve_v"),
];

/// Levels that have parameters.
const N_LEVELS: usize = 4;

/// The key that the parameter of this name sets.
pub(super) fn key(name: &str) -> Option<&'static Key> {
    let find = |table: &[(&str, &'static str)], name: &str| {
        table.iter().find(|(known, _)| *known == name).map(|(_, key)| *key)
    };
    if let Some(key) = find(&GENERAL, name) {
        return model::key(key);
    }
    let (digit, name) = name.split_at_checked(1)?;
    let level = digit.parse().ok().filter(|level| *level < N_LEVELS)?;
    model::key(&of_level(level, find(&OF_A_LEVEL, name)?))
}

/// The names of all parameters.
pub(super) fn names() -> impl Iterator<Item = String> {
    let levels = (0..N_LEVELS)
        .flat_map(|level| OF_A_LEVEL.iter().map(move |(name, _)| format!("{level}{name}")));
    GENERAL.iter().map(|(name, _)| (*name).to_owned()).chain(levels)
}

/// The keys of all parameters, in the order in which Arbaro writes them.
pub(super) fn keys() -> impl Iterator<Item = String> {
    let levels =
        (0..N_LEVELS).flat_map(|level| OF_A_LEVEL.iter().map(move |(_, key)| of_level(level, key)));
    GENERAL.iter().map(|(_, key)| (*key).to_owned()).chain(levels)
}

fn of_level(level: usize, key: &str) -> String {
    format!("level.{level}.{key}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_parameter_has_a_key_of_its_own() {
        let mut found: Vec<_> = names().map(|name| super::key(&name).unwrap().name()).collect();
        assert!(found.iter().eq(keys().collect::<Vec<_>>().iter()));
        found.sort_unstable();
        found.dedup();
        assert_eq!(found.len(), 28 + 4 * 16);
    }

    #[test]
    fn parameters_cover_all_keys_but_those_that_arbaro_lacks() {
        let foreign = |name: &str| {
            ["name", "origin", "defaulted", "notes", "dialect", "variation", "attraction_target"]
                .contains(&name)
                || [
                    "z_scale",
                    "z_scale_v",
                    "leaves.attraction",
                    "leaves.target",
                    "pruning.envelope",
                ]
                .contains(&name)
                || ["leaves.outline", "leaves.color", "leaves.vein_color", "leaves.translucency"]
                    .contains(&name)
                || ["leaves.mesh", "leaves.image", "leaves.roundness"].contains(&name)
                || [".leaves", ".sides", ".segments"].iter().any(|key| name.ends_with(key))
                || ["bark.", "ext.", "roots."].iter().any(|table| name.starts_with(table))
        };
        let known: Vec<_> = keys().collect();
        for key in model::keys() {
            assert_ne!(
                foreign(key.name()),
                known.iter().any(|known| known == key.name()),
                "{key:?}"
            );
        }
    }

    #[test]
    fn names_are_told_apart_by_digit_and_case() {
        assert_eq!(key("0Scale").unwrap().name(), "trunk.scale");
        assert_eq!(key("3CurveV").unwrap().name(), "level.3.curve_v");
        for wrong in ["", "4Length", "Length", "1length", "1Scale", "ü", "/Length", "1"] {
            assert!(key(wrong).is_none(), "{wrong}");
        }
    }
}
