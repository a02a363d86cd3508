//! Facts about whole trees: the worked aspen, splits that multiply, determinism, special values.

use glam::Vec3;

use super::*;

/// An aspen without variation whose trunk has one child, at the offset of the row.
fn aspen_child(offset: f32) -> (Stems, Option<StemSeed>, Species) {
    let mut aspen = species::aspen();
    aspen.scale_v = 0.0;
    for level in &mut aspen.level {
        level.curve_v = 0.0;
    }
    let (crown, levels) = (Crown::new(&aspen), Level::all(&aspen));
    let Ok(seeds) = trunks(&crown, &levels[0], StreamPath::new(1), &mut free);
    let Ok(trunk) = grow(&seeds, &crown, &levels[0], &Target::Up, &mut free);
    let form = TrunkForm::new(&aspen);
    // One of very many children lies close enough to the place asked for.
    let many = Level { branches: 400_000, ..levels[1].clone() };
    let Ok(children) = children(&trunk, &crown, Some(&form), &many, &mut free);
    let near = |seed: &&StemSeed| (seed.offset - offset).abs() < 1e-4;
    (trunk, children.iter().find(near).copied(), aspen)
}

#[test]
fn the_worked_aspen_agrees_row_by_row() {
    let rows = [
        (5.2001, 1.95, 0.02001, 0.117, 110.0, 18.0),
        (6.5, 3.0333, 0.03401, 0.0975, 96.667, 24.667),
        (9.1, 3.3429, 0.03822, 0.0585, 70.0, 26.571),
        (11.0, 2.6643, 0.02911, 0.03, 50.513, 22.396),
    ];
    for (offset, length, radius, cap, down, count) in rows {
        let (trunk, child, aspen) = aspen_child(offset);
        let root = trunk.stems[0].seed;
        assert_eq!((root.length, root.scale_tree), (13.0, 13.0));
        assert!((root.radius - 0.195).abs() < 1e-6);
        let form = TrunkForm::new(&aspen);
        assert!((root.radius * form.factor(0.0) - 0.195 * 1.594).abs() < 1e-6);
        assert!((trunk.stems[0].length_base - 5.2).abs() < 1e-6);
        let child = child.unwrap();
        assert!((child.length - length).abs() < 2e-3, "{child:?}");
        assert!((child.radius - radius).abs() < 2e-5, "{child:?}");
        assert!((child.parent_radius - cap).abs() < 2e-5, "{child:?}");
        assert!((child.frame.declination().to_degrees() - down).abs() < 2e-2, "{child:?}");
        let (crown, level_1, level_2) =
            (Crown::new(&aspen), Level::new(&aspen, 1), Level::new(&aspen, 2));
        let Ok(branch) = grow(&[child], &crown, &level_1, &Target::Up, &mut free);
        let expected = super::super::growth::n_children(&branch.stems[0], &level_2);
        assert!((expected - count).abs() < 1e-2, "{expected}");
    }
    // At the very tip the trunk has no radius left.
    let (.., aspen) = aspen_child(13.0);
    let fan = Level { branches: -1, ..Level::new(&aspen, 1) };
    let (trunk, ..) = aspen_child(13.0);
    let Ok(none) = children(&trunk, &Crown::new(&aspen), None, &fan, &mut free);
    assert_eq!(none, []);
}

#[test]
fn whole_numbers_of_splits_give_the_papers_numbers_of_tips() {
    let mut species = Species { levels: 1, ..Species::default() };
    for (k, curve_res, tips) in [(2.0, 5, 81), (1.0, 3, 4), (3.0, 4, 64), (2.0, 1, 1)] {
        (species.level[0].seg_splits, species.level[0].curve_res) = (k, curve_res);
        let tree = tree(&species, 5);
        let stems = &tree.levels[0];
        assert_eq!(stems.stems.len(), tips);
        for (i, stem) in stems.stems.iter().enumerate() {
            // Every one reaches the tip, and a clone stands where it split off.
            let segments = stems.segments_of(i);
            assert_eq!(segments.last().unwrap().z_end, 1.0);
            assert!(segments.iter().all(|segment| segment.stem as usize == i));
            let Some(origin) = stem.clone_of else { continue };
            assert!((origin as usize) < i);
            let z = stem.z_start();
            let split = stems.stems[origin as usize];
            let on = &stems.segments_of(origin as usize)[(stem.start - 1 - split.start) as usize];
            assert_eq!((on.z_end, on.end()), (z, segments[0].frame.origin));
        }
        // The shares of all that stand at one height make one stem.
        let tips = stems.segments.iter().filter(|segment| segment.z_end == 1.0);
        assert!((tips.map(|segment| segment.share).sum::<f32>() - 1.0).abs() < 1e-4);
    }
}

#[test]
fn growth_ends_where_the_caller_says_so() {
    let mut species = species::aspen();
    (species.level[0].seg_splits, species.level[0].curve_res) = (5.0, 1_000);
    let mut left = 100_000usize;
    let mut charge = |n: usize| left.checked_sub(n).map(|rest| left = rest).ok_or("too many");
    assert_eq!(charged(&species, 1, &mut charge).err(), Some("too many"));
    // Far beyond what files may say, for a species can be built in code.
    type Set = fn(&mut Species);
    let beyond: [(&str, Set); 8] = [
        ("trunks", |species| species.level[0].branches = i32::MAX),
        ("branches", |species| species.level[1].branches = i32::MAX),
        ("a fan", |species| species.level[1].branches = i32::MIN),
        ("segments", |species| species.level[2].curve_res = u32::MAX),
        ("leaves", |species| species.leaves.count = i32::MAX),
        ("a fan of leaves", |species| species.leaves.count = i32::MIN),
        ("splits", |species| species.level[1].seg_splits = 1e30),
        ("splits at the base", |species| species.trunk.base_splits = i32::MAX),
    ];
    for (name, set) in beyond {
        let mut species = species::aspen();
        set(&mut species);
        let mut left = 1_000_000usize;
        let mut charge = |n: usize| left.checked_sub(n).map(|rest| left = rest).ok_or("too many");
        assert_eq!(charged(&species, 1, &mut charge).err(), Some("too many"), "{name}");
    }
}

#[test]
fn the_same_seed_gives_the_same_tree_and_another_seed_another() {
    for species in species::all() {
        let (a, b, c) = (tree(&species, 3), tree(&species, 3), tree(&species, 4));
        assert!(a.levels == b.levels && a.leaves == b.leaves);
        assert!(a.levels != c.levels);
    }
}

#[test]
fn stems_grow_alike_alone_and_in_company() {
    let willow = species::willow();
    let (crown, levels) = (Crown::new(&willow), Level::all(&willow));
    let Ok(seeds) = trunks(&crown, &levels[0], StreamPath::new(1), &mut free);
    let Ok(trunk) = grow(&seeds, &crown, &levels[0], &Target::Up, &mut free);
    let Ok(seeds) = children(&trunk, &crown, None, &levels[1], &mut free);
    let Ok(together) = grow(&seeds, &crown, &levels[1], &Target::Up, &mut free);
    let mut at = 0;
    for seed in &seeds {
        let Ok(alone) = grow(&[*seed], &crown, &levels[1], &Target::Up, &mut free);
        for (i, stem) in alone.stems.iter().enumerate() {
            assert_eq!(stem.seed, together.stems[at + i].seed);
            let (a, b) = (alone.segments_of(i), together.segments_of(at + i));
            assert!(a.iter().zip(b).all(|(a, b)| a.frame == b.frame && a.share == b.share));
        }
        at += alone.stems.len();
    }
}

#[test]
fn a_shorter_stem_keeps_its_draws() {
    let tupelo = species::tupelo();
    let (crown, levels) = (Crown::new(&tupelo), Level::all(&tupelo));
    let Ok(seeds) = trunks(&crown, &levels[0], StreamPath::new(1), &mut free);
    let shorter = StemSeed { length: 0.5 * seeds[0].length, ..seeds[0] };
    let Ok(whole) = grow(&seeds, &crown, &levels[0], &Target::Up, &mut free);
    let Ok(half) = grow(&[shorter], &crown, &levels[0], &Target::Up, &mut free);
    for (a, b) in whole.segments.iter().zip(&half.segments) {
        assert_eq!(a.frame.axes, b.frame.axes);
    }
}

#[test]
fn an_edit_of_a_level_or_of_the_leaves_reaches_no_other_values() {
    let (before, mut after) = (species::tupelo(), species::tupelo());
    after.leaves.scale = 0.5;
    after.leaves.target = LeafTarget::Scattered;
    assert_eq!(Crown::new(&before), Crown::new(&after));
    assert_eq!(Level::all(&before), Level::all(&after));
    assert_eq!(TrunkForm::new(&before), TrunkForm::new(&after));
    assert_ne!(LeafParams::new(&before), LeafParams::new(&after));
    let mut after = species::tupelo();
    after.level[2].curve_v = 1.0;
    assert_eq!(LeafParams::new(&before), LeafParams::new(&after));
    assert_eq!(Crown::new(&before), Crown::new(&after));
    let differ: Vec<bool> =
        Level::all(&before).iter().zip(&Level::all(&after)).map(|(a, b)| a != b).collect();
    assert_eq!(differ, [false, false, true, false]);
    let (a, b) = (tree(&before, 9), tree(&after, 9));
    assert!(a.levels[..2] == b.levels[..2] && a.levels[2] != b.levels[2]);
}

#[test]
fn nothing_grows_inside_its_parent_or_on_the_bare_trunk() {
    for species in species::all() {
        let tree = tree(&species, 2);
        for (n, stems) in tree.levels.iter().enumerate().skip(1) {
            for stem in &stems.stems {
                let seed = stem.seed;
                assert!(seed.offset <= seed.parent_length * 1.000_01);
                if n == 1 {
                    let bare = species.base_size * seed.scale_tree;
                    assert!(seed.offset >= bare - 1e-4);
                }
                assert!(seed.radius <= seed.parent_radius);
            }
        }
        // Leaves keep outside the parent of the stem they grow on.
        let last = tree.levels.last().unwrap();
        if species.leaves.count > 0 {
            for leaf in &tree.leaves {
                let stem = &last.stems[leaf.stem as usize];
                let petiole = species.leaves.stem_len * leaf.length;
                let foot = leaf.frame.origin - petiole * leaf.frame.axes.z_axis;
                let seed = stem.seed;
                if stem.curve_res == 1 {
                    let offset = (foot - seed.frame.origin).length();
                    assert!(offset >= seed.parent_radius * 0.999 - 1e-6);
                }
            }
        }
    }
}

fn finite(tree: &Tree) -> bool {
    let frame = |frame: &Frame| frame.origin.is_finite() && frame.axes.is_finite();
    let segments = tree.levels.iter().flat_map(|stems| &stems.segments);
    let right = |axes: glam::Mat3| (axes.determinant() - 1.0).abs() < 1e-3;
    let mut segments = segments.map(|s| {
        frame(&s.frame)
            && right(s.frame.axes)
            && s.radius_foot.is_finite()
            && s.radius_end >= 0.0
            && s.length > 0.0
    });
    let mut leaves = tree.leaves.iter().map(|leaf| {
        frame(&leaf.frame) && right(leaf.frame.axes) && leaf.length > 0.0 && leaf.width.is_finite()
    });
    segments.all(|fine| fine) && leaves.all(|fine| fine)
}

#[test]
fn special_values_never_give_numbers_that_are_none() {
    let cases = [
        ("base_size", [0.0, 1.0]),
        ("scale", [1e-3, 1e3]),
        ("ratio", [1e-6, 10.0]),
        ("ratio_power", [-30.0, 30.0]),
        ("flare", [-1.0, 100.0]),
        ("attraction_up", [-50.0, 50.0]),
        ("shape", [5.0, 8.0]),
        ("pruning.width_peak", [0.0, 1.0]),
        ("leaves.bend", [0.0, 1.0]),
        ("leaves.quality", [1e-3, 1.0]),
        ("leaves.count", [-7.0, 0.0]),
        ("level.0.length", [0.0, 0.01]),
        ("level.0.curve", [-3600.0, 3600.0]),
        ("level.0.curve_v", [-90.0, 7200.0]),
        ("level.1.length", [0.0, 30.0]),
        ("level.1.length_v", [0.5, 5.0]),
        ("level.1.taper", [0.0, 2.99]),
        ("level.1.curve_v", [-90.0, 720.0]),
        ("level.1.curve_res", [1.0, 50.0]),
        ("level.1.down_angle", [-180.0, 180.0]),
        ("level.1.down_angle_v", [-180.0, 180.0]),
        ("level.1.rotate", [-360.0, 360.0]),
        ("level.1.branches", [-3.0, 0.0]),
        ("level.1.branch_dist", [0.0, 1.0]),
        ("level.1.split_angle", [0.0, 180.0]),
        ("level.0.taper", [1.0, 2.0]),
    ];
    for species in species::all().into_iter().filter(|species| species.name != "Weeping Willow") {
        for dialect in [Dialect::Paper, Dialect::Arbaro, Dialect::TreeGen] {
            for (name, values) in cases {
                for value in values {
                    let mut species = Species { dialect: Some(dialect), ..species.clone() };
                    // One level less keeps the test quick.
                    species.levels = species.levels.min(3);
                    species.level[2].branches = 4;
                    key(name).unwrap().set(&mut species, &Value::Number(value)).unwrap();
                    assert!(finite(&tree(&species, 1)), "{}: {name} = {value}", species.name);
                }
            }
        }
    }
    assert!(finite(&tree(&species::willow(), 1)));
    let mut aspen = species::aspen();
    for target in [Vec3::Z, -Vec3::Z, Vec3::X * 1e-12, Vec3::splat(1e15)] {
        aspen.attraction_up = 3.0;
        aspen.attraction_target = Target::Direction(target);
        aspen.leaves.target = LeafTarget::Point(target);
        aspen.leaves.attraction = -2.0;
        assert!(finite(&tree(&aspen, 1)));
        aspen.attraction_target = Target::Point(target);
        assert!(finite(&tree(&aspen, 1)));
    }
}
