//! What the dialects of Arbaro and tree-gen, and normal variation, change.

use glam::Vec3;

use super::*;

fn plain() -> Species {
    let mut species = Species { base_size: 0.2, ratio: 0.02, ..Default::default() };
    species.level[1].curve_res = 4;
    species.leaves.count = 8;
    species
}

fn in_dialect(dialect: Dialect, change: impl Fn(&mut Species)) -> Tree {
    let mut species = Species { dialect: Some(dialect), ..plain() };
    change(&mut species);
    tree(&species, 1)
}

fn declination(z: Vec3) -> f32 {
    z.z.clamp(-1.0, 1.0).acos().to_degrees()
}

#[test]
fn arbaros_cone_is_plain_r_in_lengths_and_in_negative_down_angles() {
    let tree = in_dialect(Dialect::Arbaro, |species| species.level[1].down_angle_v = -50.0);
    for (i, stem) in tree.levels[1].stems.iter().enumerate() {
        let r = (10.0 - stem.seed.offset) / 8.0;
        assert!((stem.seed.length - 10.0 * 0.5 * r).abs() < 1e-4);
        let z = tree.levels[1].segments_of(i)[0].frame.axes.z_axis;
        assert!((declination(z) - (30.0 - 50.0 * (1.0 - 2.0 * r)).abs()).abs() < 0.1);
    }
}

#[test]
fn tree_gen_shortens_deeper_levels_by_seven_tenths_of_the_offset() {
    let tree = in_dialect(Dialect::TreeGen, |_| ());
    for stem in &tree.levels[2].stems {
        let expected = 0.5 * (stem.seed.parent_length - 0.7 * stem.seed.offset);
        assert!((stem.seed.length - expected).abs() < 1e-4);
    }
}

#[test]
fn tree_gens_negative_base_splits_are_a_random_number_up_to_their_size() {
    let mut species = Species { dialect: Some(Dialect::TreeGen), levels: 1, ..plain() };
    species.trunk.base_splits = -3;
    let mut seen = [0; 4];
    (0..200).for_each(|seed| seen[tree(&species, seed).levels[0].stems.len() - 1] += 1);
    assert!(seen.iter().all(|n| (30..70).contains(n)), "{seen:?}");
}

#[test]
fn tree_gens_negative_split_angle_splits_in_a_plane() {
    let tree = in_dialect(Dialect::TreeGen, |species| {
        species.levels = 1;
        species.trunk.base_splits = 1;
        species.level[0].split_angle = -80.0;
    });
    let stems = &tree.levels[0];
    let (a, b) = (stems.segments_of(0)[1].frame.axes, stems.segments_of(1)[0].frame.axes);
    assert!((a.z_axis.angle_between(b.z_axis).to_degrees() - 80.0).abs() < 0.01);
    assert!((declination(a.z_axis) - 40.0).abs() < 0.01 && a.y_axis.abs_diff_eq(b.y_axis, 1e-6));
    // Nothing bends back.
    let last = stems.segments.last().unwrap().frame.axes.z_axis;
    assert!((declination(last) - 40.0).abs() < 0.01);
}

#[test]
fn tree_gens_extra_keys_act_in_its_dialect_only() {
    let ext = TreeGenExt {
        base_size: Some([0.2, 0.4, 0.0, 0.0]),
        bend_v: Some([0.0, 60.0, 0.0, 0.0]),
        radius_mod: Some([1.5, 0.5, 1.0, 1.0]),
        tropism: Some([0.0, 0.0, 2.0]),
        ..TreeGenExt::default()
    };
    let with = |dialect, ext: Option<TreeGenExt>| {
        in_dialect(dialect, move |species| {
            species.ext = ext.clone();
            species.ratio_power = 2.0;
            species.level[2].curve_res = 3;
        })
    };
    let (plain, tree) = (with(Dialect::TreeGen, None), with(Dialect::TreeGen, Some(ext.clone())));
    assert_eq!(with(Dialect::Paper, None).levels, with(Dialect::Paper, Some(ext)).levels);

    let radius = |tree: &Tree, n: usize| tree.levels[n].stems[0].seed.radius;
    assert!((radius(&tree, 0) / radius(&plain, 0) - 1.5).abs() < 1e-5);
    assert!((radius(&tree, 1) / radius(&plain, 1) - 0.75).abs() < 1e-5);
    for stem in &tree.levels[2].stems {
        assert!(stem.seed.offset >= 0.4 * stem.seed.parent_length - 1e-5);
    }
    let mut widest: f32 = 0.0;
    for pair in tree.levels[1].segments.windows(2).filter(|pair| pair[0].stem == pair[1].stem) {
        let (a, b) = (pair[0].frame.axes, pair[1].frame.axes);
        assert!(a.y_axis.abs_diff_eq(b.y_axis, 1e-5));
        widest = widest.max(a.z_axis.angle_between(b.z_axis).to_degrees());
    }
    assert!((13.0..=15.01).contains(&widest), "{widest}");
    for pair in tree.levels[2].segments.windows(2).filter(|pair| pair[0].stem == pair[1].stem) {
        let (a, b) = (pair[0].frame.axes.z_axis, pair[1].frame.axes.z_axis);
        let turned = 20.0 * a.cross(Vec3::Z).length();
        assert!((declination(a) - declination(b) - turned).abs() < 0.05);
    }
}

#[test]
fn normal_variation_goes_beyond_the_interval_and_keeps_its_variance() {
    let lengths = |variation| -> Vec<f32> {
        let mut species = Species { variation, levels: 1, scale_v: 2.0, ..plain() };
        species.ratio = 0.01;
        (0..600).map(|seed| tree(&species, seed).levels[0].stems[0].seed.length).collect()
    };
    let variance = |values: &[f32]| {
        let mean = values.iter().sum::<f32>() / values.len() as f32;
        assert!((mean - 10.0).abs() < 0.2);
        values.iter().map(|x| (x - mean) * (x - mean)).sum::<f32>() / values.len() as f32
    };
    let (uniform, normal) = (lengths(Variation::Uniform), lengths(Variation::Normal));
    assert!(uniform.iter().all(|x| (8.0..=12.0).contains(x)));
    assert!(normal.iter().any(|x| !(8.0..=12.0).contains(x)));
    assert!((variance(&uniform) / (4.0 / 3.0) - 1.0).abs() < 0.15);
    assert!((variance(&normal) / (4.0 / 3.0) - 1.0).abs() < 0.2);
}

#[test]
fn a_tree_is_never_smaller_than_a_twentieth_of_its_scale() {
    let species = Species { levels: 1, scale_v: 10.0, ..plain() };
    let least = (0..300)
        .map(|seed| tree(&species, seed).levels[0].stems[0].seed.length)
        .fold(f32::MAX, f32::min);
    assert_eq!(least, 0.5);
}
