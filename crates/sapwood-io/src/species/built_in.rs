//! The species that come with the library, by name.

use sapwood_rules::weber_penn::Species;

use super::parse_species;
use crate::spelling::nearest;

macro_rules! built_in {
    ($($name:literal),* $(,)?) => {
        /// Names and texts, in alphabetical order.
        const BUILT_IN: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../../species/", $name, ".toml")))),*];
    };
}

built_in!(
    "agave",
    "apple",
    "balsam_fir",
    "bamboo",
    "banana",
    "baobab",
    "black_tupelo",
    "blue_fescue",
    "box_hedge",
    "ca_black_oak",
    "coconut_palm",
    "common_hazel",
    "common_reed",
    "desert_bush",
    "eastern_cottonwood",
    "english_oak",
    "european_beech",
    "forsythia",
    "italian_cypress",
    "japanese_maple",
    "joshua_tree",
    "lavender",
    "lombardy_poplar",
    "male_fern",
    "norway_spruce",
    "olive",
    "palm",
    "quaking_aspen",
    "saguaro",
    "sassafras",
    "scots_pine",
    "silver_birch",
    "small_pine",
    "sugar_maple",
    "sweet_cherry",
    "umbrella_thorn",
    "weeping_willow",
    "wheat",
);

/// The names of the built-in species, in alphabetical order.
pub fn built_in_names() -> impl ExactSizeIterator<Item = &'static str> {
    BUILT_IN.iter().map(|(name, _)| *name)
}

/// The text of the built-in species file of this name, as it can be saved and changed.
pub fn built_in_text(name: &str) -> Option<&'static str> {
    BUILT_IN.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

/// The built-in species of this name.
pub fn built_in(name: &str) -> Option<Species> {
    let text = built_in_text(name)?;
    Some(parse_species(text, name).expect("a test reads every built-in species"))
}

/// The built-in name that was probably meant by `name`, if any is like it.
///
/// A part of a name counts as much as the whole, so `oak` means `ca_black_oak`; the first in
/// alphabetical order wins among several. Otherwise the name or part spelt most alike is meant.
pub fn suggest(name: &str) -> Option<&'static str> {
    let wanted = name.to_lowercase().replace([' ', '-'], "_");
    let wanted = wanted.trim_matches('_');
    let words = |name: &'static str| name.split('_').chain([name]);
    let has = |test: &dyn Fn(&str) -> bool| built_in_names().find(|name| words(name).any(test));
    if !wanted.is_empty() {
        let found = has(&|word| word == wanted)
            .or_else(|| has(&|word| word.starts_with(wanted)))
            .or_else(|| built_in_names().find(|name| name.contains(wanted)));
        if found.is_some() {
            return found;
        }
    }
    let like = nearest(wanted, built_in_names().flat_map(words))?;
    has(&|word| word == like)
}

#[cfg(test)]
mod tests {
    use sapwood_rules::weber_penn::{CrownShape, Origin};

    use super::*;

    #[test]
    fn every_built_in_species_is_read_and_written_back() {
        assert_eq!(built_in_names().len(), 38);
        assert!(built_in_names().is_sorted());
        for name in built_in_names() {
            let text = built_in_text(name).unwrap();
            let species = parse_species(text, name).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(species.faults(), [], "{name}");
            let written = crate::write_species(&species);
            assert_eq!(parse_species(&written, name).unwrap(), species, "{name}");
        }
        assert!(built_in("yggdrasil").is_none());
    }

    #[test]
    fn the_aspen_has_its_published_values() {
        let aspen = built_in("quaking_aspen").unwrap();
        assert_eq!((aspen.origin, aspen.shape), (Origin::Paper, CrownShape::TendFlame));
        assert_eq!((aspen.base_size, aspen.scale, aspen.scale_v), (0.4, 13.0, 3.0));
        assert_eq!((aspen.levels, aspen.ratio, aspen.ratio_power), (3, 0.015, 1.2));
        assert_eq!((aspen.lobes, aspen.lobe_depth, aspen.flare), (5, 0.07, 0.6));
        assert_eq!((aspen.leaves.count, aspen.leaves.scale), (25, 0.17));
        let [trunk, boughs, twigs, _] = &aspen.level;
        assert_eq!((trunk.curve_res, trunk.curve_v), (3, 20.0));
        assert_eq!((boughs.down_angle, boughs.down_angle_v), (60.0, -50.0));
        assert_eq!((boughs.branches, boughs.curve, boughs.curve_v), (50, -40.0, 50.0));
        assert_eq!((twigs.branches, twigs.length, twigs.curve_v), (30, 0.6, 75.0));
    }

    #[test]
    fn the_tupelo_has_its_published_values() {
        let tupelo = built_in("black_tupelo").unwrap();
        assert_eq!(tupelo.shape, CrownShape::TaperedCylindrical);
        assert_eq!((tupelo.levels, tupelo.scale, tupelo.scale_v), (4, 23.0, 5.0));
        assert_eq!((tupelo.lobes, tupelo.attraction_up), (3, 0.5));
        assert_eq!(tupelo.leaves.count, 6);
        assert_eq!(tupelo.level.each_ref().map(|level| level.branches), [1, 50, 25, 12]);
        assert_eq!(tupelo.level[0].taper, 1.1);
        assert_eq!((tupelo.level[2].curve, tupelo.level[2].curve_v), (-10.0, 150.0));
    }

    #[test]
    fn the_bamboos_trunks_do_not_stand_on_one_spot() {
        let bamboo = built_in("bamboo").unwrap();
        // Where tree-gen strews them.
        let radius = (50.0 / 2.5 * bamboo.scale * bamboo.ratio).sqrt();
        assert_eq!(bamboo.level[0].branches, 50);
        assert!((bamboo.level[0].branch_dist - radius).abs() < 1e-3);
    }

    #[test]
    fn names_are_found_by_their_parts_and_by_their_spelling() {
        let check = |name, expected| assert_eq!(suggest(name), expected, "{name}");
        check("oak", Some("ca_black_oak"));
        check("Oak", Some("ca_black_oak"));
        check("aspen", Some("quaking_aspen"));
        check("quakingaspen", Some("quaking_aspen"));
        check("quaking-aspen", Some("quaking_aspen"));
        check("willlow", Some("weeping_willow"));
        check("birtch", Some("silver_birch"));
        check("black", Some("black_tupelo"));
        check("sasafras", Some("sassafras"));
        check("", None);
        check("-", None);
        check("xylophone", None);
    }
}
