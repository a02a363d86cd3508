//! What tree-gen's dialect changes: how stems split, what they carry, and how that is grouped.

use std::f32::consts::TAU;

use glam::Vec3;

use super::measure::*;
use super::*;

fn species(levels: u32, change: impl Fn(&mut Species)) -> Species {
    let mut species = Species {
        dialect: Some(Dialect::TreeGen),
        base_size: 0.2,
        ratio: 0.02,
        levels,
        ..Species::default()
    };
    species.leaves.distrib = CrownShape::Cylindrical;
    change(&mut species);
    species
}

fn extended(levels: u32, ext: TreeGenExt, change: impl Fn(&mut Species)) -> Species {
    species(levels, |species| {
        species.ext = Some(ext.clone());
        change(species);
    })
}

fn grown(species: &Species) -> Vec<Tree> {
    (0..60).map(|seed| tree(species, seed)).collect()
}

/// The mean number of tips of what grows from one seed of a level.
fn tips(trees: &[Tree], level: usize) -> f32 {
    let stems = trees.iter().flat_map(|tree| &tree.levels[level].stems);
    let (origins, all) = stems.fold((0, 0), |(origins, all), stem| {
        (origins + usize::from(stem.clone_of.is_none()), all + 1)
    });
    all as f32 / origins as f32
}

#[test]
fn stems_split_once_per_segment_on_average_however_many_there_are() {
    for (splits, res) in [(1.0, 8), (2.0, 6), (3.0, 5)] {
        let species = species(2, |species| {
            species.level[1].seg_splits = splits;
            species.level[1].curve_res = res;
        });
        let (mean, expected) = (tips(&grown(&species), 1), 1.0 + splits * (res - 1) as f32);
        assert!((mean / expected - 1.0).abs() < 0.05, "{mean} for {expected}");
    }
    // Of a fraction, nearly so: who has just split is less likely to, twice over.
    let species = species(2, |species| {
        species.level[1].seg_splits = 0.6;
        species.level[1].curve_res = 10;
    });
    let mean = tips(&grown(&species), 1);
    assert!((mean / 6.4 - 1.0).abs() < 0.1, "{mean}");
}

#[test]
fn a_trunk_splits_above_its_bare_part_only_and_its_base_splits_end_that() {
    let species = species(1, |species| {
        species.base_size = 0.35;
        species.trunk.base_splits = 2;
        species.level[0].curve_res = 6;
        species.level[0].seg_splits = 1.0;
    });
    for tree in grown(&species) {
        // 0.35 of 6 segments end within the third.
        let starts: Vec<u32> = tree.levels[0].stems[1..].iter().map(|stem| stem.start).collect();
        assert_eq!(starts.iter().filter(|start| **start == 3).count(), 2, "{starts:?}");
        assert!(starts.iter().all(|start| *start >= 3), "{starts:?}");
        // The three limbs split at the next end: base splits leave them as likely to.
        assert_eq!(starts.iter().filter(|start| **start == 4).count(), 3, "{starts:?}");
    }
}

#[test]
fn helices_do_not_split() {
    let species = species(1, |species| {
        species.level[0].seg_splits = 2.0;
        species.level[0].curve_v = -30.0;
    });
    assert_eq!(tree(&species, 1).levels[0].stems.len(), 1);
}

#[test]
fn each_side_of_a_split_turns_by_half_the_angle_and_back_by_the_whole() {
    let species = species(1, |species| {
        species.base_size = 0.1;
        species.level[0].curve_res = 5;
        species.level[0].seg_splits = 1.0;
        species.level[0].split_angle = 50.0;
        species.level[0].curve = 30.0;
    });
    let mut spreads = Vec::new();
    for tree in grown(&species) {
        let stems = &tree.levels[0];
        let clone = stems.stems.iter().position(|stem| stem.start == 2).unwrap();
        let declinations = |from: &[Segment]| {
            let angles = from.iter().map(|s| declination(s.frame.axes.z_axis).to_degrees());
            angles.collect::<Vec<_>>()
        };
        // The trunk splits at the end of its second segment, and before that has curved by 6.
        let (whole, half) = (50.0 - 6.0, 22.0);
        assert!((declinations(stems.segments_of(0))[1] - 6.0).abs() < 0.01);
        for at in [2, 0] {
            let segments = if at == 2 { stems.segments_of(0) } else { stems.segments_of(clone) };
            let after = declinations(&segments[at..]);
            assert!((after[0] - 6.0 - half).abs() < 0.01, "{after:?}");
            let splits_again = stems.stems.iter().any(|stem| {
                let of = stem.clone_of.map(|of| of as usize);
                stem.start == 3 && of == Some(if at == 2 { 0 } else { clone })
            });
            if !splits_again {
                let next = after[0] + 6.0 - whole / 4.0;
                assert!((after[1] - next).abs() < 0.01, "{after:?}: not {next}");
            }
        }
        let side = |stem: usize, i: usize| azimuth(stems.segments_of(stem)[i].frame.axes.z_axis);
        spreads.push((side(clone, 0) - side(0, 2)).to_degrees().rem_euclid(360.0));
    }
    // A stem at 6 degrees: 20 + 0.75 (30 + 84 u^2).
    assert!(spreads.iter().all(|spread| (42.49..105.51).contains(spread)), "{spreads:?}");
    let widest = spreads.iter().fold(0.0f32, |a, b| a.max(*b));
    assert!(widest > 95.0, "{widest}");
}

#[test]
fn four_fifths_of_the_children_and_all_leaves_go_on_beyond_a_split() {
    let species = species(3, |species| {
        species.level[1].seg_splits = 1.0;
        species.level[1].curve_res = 8;
        species.level[2].branches = 30;
        species.level[2].seg_splits = 1.0;
        species.level[2].curve_res = 3;
        species.leaves.count = 20;
    });
    let (mut children, mut expected_children, mut leaves, mut expected_leaves) =
        (0.0, 0.0, 0.0, 0.0);
    for tree in grown(&species).iter().take(12) {
        let boughs = &tree.levels[1];
        for stem in &boughs.stems {
            let carried = 30.0 * (0.2 + 0.8 * stem.seed.length / 10.0 / 0.5);
            let start = stem.seed.parent_radius;
            let free = stem.seed.length - start;
            for segment in &boughs.segments[stem.segment_range()] {
                let splits = segment.share.ln() / 0.8f32.ln();
                assert!((splits - splits.round()).abs() < 1e-3, "{}", segment.share);
                let above = segment.offset + segment.length - segment.offset.max(start);
                expected_children += carried * segment.share * above.max(0.0) / free;
            }
        }
        let twigs = &tree.levels[2];
        let origins = twigs.stems.iter().filter(|stem| stem.clone_of.is_none());
        children += origins.count() as f32;
        for stem in &twigs.stems {
            let whole = stem.seed.parent_length * stem.seed.length_child_max;
            let share = (stem.curve_res - stem.start) as f32 / stem.curve_res as f32;
            expected_leaves += 20.0 * stem.seed.length / whole * share;
        }
        leaves += tree.leaves.len() as f32;
    }
    let close = |a: f32, b: f32| assert!((a / b - 1.0).abs() < 0.03, "{a} for {b}");
    close(children, expected_children);
    close(leaves, expected_leaves);
}

#[test]
fn trunks_vary_in_their_number_of_branches_by_a_tenth() {
    let species = species(2, |species| species.level[1].branches = 100);
    let counts: Vec<f32> =
        grown(&species).iter().map(|tree| tree.levels[1].stems.len() as f32).collect();
    assert!(counts.iter().all(|count| (89.5..110.5).contains(count)), "{counts:?}");
    let (low, high) = counts.iter().fold((200f32, 0f32), |(a, b), n| (a.min(*n), b.max(*n)));
    assert!(low < 95.0 && high > 105.0, "{low} {high}");
}

#[test]
fn leaves_follow_the_size_of_the_tree() {
    let species = species(2, |species| {
        species.scale_v = 5.0;
        species.level[1].branches = 20;
        species.leaves.count = 10;
    });
    for tree in grown(&species) {
        let size = tree.levels[0].stems[0].seed.scale_tree / 10.0;
        close(tree.leaves[0].length, 0.2 * size);
        close(tree.leaves[0].width, 0.1 * size);
    }
}

#[test]
fn stems_are_five_millimetres_thick_at_least_unless_their_parents_are_not() {
    let species = species(3, |species| species.ratio_power = 3.0);
    let tree = tree(&species, 1);
    for Stem { seed, .. } in tree.levels[1..].iter().flat_map(|stems| &stems.stems) {
        assert!(seed.radius >= 0.005 || seed.radius == seed.parent_radius, "{seed:?}");
    }
    assert!(tree.levels[2].stems.iter().any(|stem| stem.seed.radius == 0.005));
}

#[test]
fn random_bends_stay_in_a_plane() {
    let species = species(1, |species| {
        species.level[0].curve_v = 90.0;
        species.level[0].curve_res = 6;
    });
    let tree = tree(&species, 1);
    let segments = &tree.levels[0].segments;
    let bends: Vec<f32> = segments
        .windows(2)
        .map(|pair| {
            let (a, b) = (pair[0].frame.axes, pair[1].frame.axes);
            assert!(a.x_axis.abs_diff_eq(b.x_axis, 1e-5));
            a.z_axis.angle_between(b.z_axis).to_degrees()
        })
        .collect();
    assert!(bends.iter().all(|bend| *bend <= 15.01) && bends.iter().any(|bend| *bend > 3.0));
}

#[test]
fn what_pulls_sideways_pulls_trunks_and_first_branches_too() {
    let ext = TreeGenExt { tropism: Some([3.0, 0.0, 5.0]), ..TreeGenExt::default() };
    let tree = tree(&extended(2, ext, |species| species.level[1].curve_res = 4), 1);
    let z = |i: usize| tree.levels[0].segments[i].frame.axes.z_axis;
    assert!((z(1).angle_between(Vec3::Z).to_degrees() - 30.0).abs() < 0.01 && z(1).x > 0.49);
    for pair in tree.levels[1].segments.windows(2).filter(|pair| pair[0].stem == pair[1].stem) {
        let [a, b] = [0, 1].map(|i: usize| pair[i].frame.axes.z_axis);
        assert!((a.angle_between(b).to_degrees() - 30.0 * a.cross(Vec3::X).length()).abs() < 0.05);
    }
}

#[test]
fn several_trunks_face_outward_and_have_sizes_of_their_own() {
    let species = species(1, |species| {
        (species.level[0].branches, species.level[0].branch_dist) = (30, 2.0);
        species.level[0].curve = 60.0;
        species.scale_v = 2.0;
    });
    let trunks = &tree(&species, 1).levels[0];
    let mut lengths = Vec::new();
    for (i, stem) in trunks.stems.iter().enumerate() {
        let lean = last_z(trunks, i).with_z(0.0).normalize();
        assert!(lean.abs_diff_eq(stem.seed.frame.origin.normalize(), 1e-3));
        lengths.push(stem.seed.length);
    }
    assert!(lengths.iter().all(|length| (8.0..=12.0).contains(length)));
    lengths.sort_by(f32::total_cmp);
    assert!(lengths[29] - lengths[0] > 2.0);
}

#[test]
fn first_children_stand_anywhere_round_their_parents() {
    let species = species(1, |_| ());
    let faces: Vec<f32> = grown(&species)
        .iter()
        .map(|tree| azimuth(tree.levels[0].segments[0].frame.axes.x_axis))
        .collect();
    let quarters = |angles: &[f32]| {
        let mut seen = [0; 4];
        angles.iter().for_each(|angle| seen[(angle.rem_euclid(TAU) / TAU * 4.0) as usize % 4] += 1);
        assert!(seen.iter().all(|n| *n >= 5), "{seen:?}");
    };
    quarters(&faces);
    let species = self::species(2, |_| ());
    let turned = |tree: &Tree| {
        let (trunk, first) = (&tree.levels[0], first_z(&tree.levels[1], 0));
        azimuth(trunk.segments[0].frame.axes.transpose() * first)
    };
    quarters(&grown(&species).iter().map(turned).collect::<Vec<_>>());
}

#[test]
fn down_angles_that_follow_the_height_vary_by_a_tenth() {
    let species = species(2, |species| {
        species.level[1].down_angle = 60.0;
        species.level[1].down_angle_v = -30.0;
    });
    let shares: Vec<f32> = grown(&species)
        .iter()
        .flat_map(|tree| {
            let stems = &tree.levels[1];
            let share = |i: usize| {
                let r = (10.0 - stems.stems[i].seed.offset) / 8.0;
                let down = 60.0 - 30.0 * (1.0 - 2.0 * (0.2 + 0.8 * r));
                declination(first_z(stems, i)).to_degrees() / down
            };
            (0..stems.stems.len()).map(share).collect::<Vec<_>>()
        })
        .collect();
    fills(&shares, 1.0, 0.1);
}

fn offsets(tree: &Tree) -> Vec<f32> {
    tree.levels[1].stems.iter().map(|stem| stem.seed.offset).collect()
}

#[test]
fn opposite_branches_stand_at_one_height_and_others_in_between() {
    for dist in [0.5, 1.0] {
        let ext = TreeGenExt { branch_dist: Some([0.0, dist, 0.0, 0.0]), ..TreeGenExt::default() };
        let species = extended(2, ext, |species| species.level[0].curve_res = 1);
        for tree in grown(&species) {
            let offsets = offsets(&tree);
            let slot = 8.0 / offsets.len() as f32;
            for pair in offsets.chunks_exact(2) {
                assert!((pair[1] - pair[0] - (1.0 - dist) * slot).abs() < 1e-4, "{pair:?}");
            }
        }
    }
}

#[test]
fn whorls_stand_at_one_height_evenly_round_the_trunk() {
    let ext = TreeGenExt { branch_dist: Some([0.0, 3.5, 0.0, 0.0]), ..TreeGenExt::default() };
    let species = extended(2, ext, |species| {
        species.level[1].branches = 60;
        species.level[1].rotate = 100.0;
    });
    let (mut total, mut n_whorls) = (0, 0);
    for tree in grown(&species) {
        let (offsets, stems) = (offsets(&tree), &tree.levels[1]);
        let axes = tree.levels[0].segments[0].frame.axes;
        let mut start = 0;
        for whorl in offsets.chunk_by(|a, b| a == b) {
            assert!((4..=5).contains(&whorl.len()), "{offsets:?}");
            let angle = |i: usize| azimuth(axes.transpose() * first_z(stems, start + i));
            for i in 1..whorl.len() {
                close_angle(angle(i) - angle(i - 1), TAU / whorl.len() as f32);
            }
            if start > 0 {
                let before = azimuth(axes.transpose() * first_z(stems, start - 1));
                let last = offsets[..start].chunk_by(|a, b| a == b).last().unwrap().len();
                let first = before - TAU * (last - 1) as f32 / last as f32;
                close_angle(angle(0) - first, 100f32.to_radians());
            }
            start += whorl.len();
            n_whorls += 1;
        }
        total += start;
    }
    assert!((total as f32 / n_whorls as f32 - 4.5).abs() < 0.05);
    assert!((total as f32 / 60.0 - 60.0).abs() < 2.0, "{total}");
}
