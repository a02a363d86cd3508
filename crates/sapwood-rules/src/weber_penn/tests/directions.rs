//! Parameters whose effect shows in whole arrangements: fans, splits, trunks and targets.

use std::f32::consts::TAU;

use glam::Vec3;

use super::measure::*;
use super::*;

#[test]
fn down_angle_and_rotation_of_leaves_are_those_of_the_level_after_the_stems() {
    let mut species = plain();
    species.leaves.bend = 0.0;
    (species.level[3].down_angle, species.level[3].rotate) = (70.0, 50.0);
    let tree = tree(&species, 1);
    let stems = &tree.levels[2];
    for pair in tree.leaves.windows(2).filter(|pair| pair[0].stem == pair[1].stem) {
        let axes = stems.segments_of(pair[0].stem as usize)[0].frame.axes.transpose();
        let (a, b) = (axes * pair[0].frame.axes.z_axis, axes * pair[1].frame.axes.z_axis);
        close_angle(declination(a), 70f32.to_radians());
        close_angle(azimuth(b) - azimuth(a), 50f32.to_radians());
    }
}

#[test]
fn several_trunks_scatter_over_a_disc_and_share_one_size() {
    let mut species = Species { scale_v: 3.0, levels: 1, ..plain() };
    (species.level[0].branches, species.level[0].branch_dist) = (200, 2.0);
    let tree = tree(&species, 1);
    let feet: Vec<Vec3> = tree.levels[0].stems.iter().map(|s| s.seed.frame.origin).collect();
    let far = feet.iter().map(|foot| foot.length()).fold(0.0, f32::max);
    assert!((1.8..=2.0).contains(&far));
    let middle = feet.iter().sum::<Vec3>() / 200.0;
    assert!(middle.length() < 0.25);
    // Evenly over the disc: half of them beyond the radius that halves its area.
    let outside = feet.iter().filter(|foot| foot.length() > 2.0f32.sqrt()).count();
    assert!((80..120).contains(&outside), "{outside}");
    let length = tree.levels[0].stems[0].seed.length;
    assert!(tree.levels[0].stems.iter().all(|stem| stem.seed.length == length));
    // One trunk alone stands in the middle.
    species.level[0].branches = 1;
    let tree = super::tree(&species, 1);
    assert_eq!(tree.levels[0].stems[0].seed.frame.origin, Vec3::ZERO);
}

#[test]
fn negative_leaves_grow_in_a_fan_at_the_tip() {
    let mut species = plain();
    (species.leaves.count, species.leaves.bend) = (-3, 0.0);
    (species.level[3].rotate, species.level[3].down_angle) = (90.0, 20.0);
    let tree = tree(&species, 1);
    let stems = &tree.levels[2];
    assert_eq!(tree.leaves.len(), 3 * stems.stems.len());
    for leaf in &tree.leaves {
        let tip = stems.segments_of(leaf.stem as usize).last().unwrap();
        close(leaf.frame.origin.distance(tip.end()), 0.1);
        let z = tip.frame.axes.transpose() * leaf.frame.axes.z_axis;
        // Turned in the plane of x and z, then down about its own x: y is lost to the latter.
        close(z.y, -20f32.to_radians().sin());
        let side = z.x.atan2(z.z).to_degrees();
        assert!([-30.0, 0.0, 30.0].iter().any(|angle| (side - angle).abs() < 0.05), "{side}");
    }
}

#[test]
fn negative_branches_grow_in_a_fan_at_the_tip() {
    let mut species = Species { levels: 2, ..plain() };
    // A cone's tip has no radius to grow from.
    species.level[0].taper = 0.5;
    (species.level[1].branches, species.level[1].down_angle) = (-4, 0.0);
    let tree = tree(&species, 1);
    let stems = &tree.levels[1];
    assert_eq!(stems.stems.len(), 4);
    let mut angles: Vec<f32> = (0..4)
        .map(|i| {
            let z = first_z(stems, i);
            z.x.atan2(z.z).to_degrees()
        })
        .collect();
    angles.sort_by(f32::total_cmp);
    for (angle, expected) in angles.into_iter().zip([-52.5, -17.5, 17.5, 52.5]) {
        assert!((angle - expected).abs() < 0.01, "{angle}");
    }
    assert!(stems.stems.iter().all(|s| (s.seed.frame.origin - 10.0 * Vec3::Z).length() < 1e-5));
}

#[test]
fn split_angle_leans_both_stems_and_is_taken_back_by_the_tip() {
    let mut species = Species { levels: 1, ..plain() };
    species.trunk.base_splits = 1;
    for (split_angle, split_angle_v) in [(40.0, 0.0), (40.0, 15.0)] {
        (species.level[0].split_angle, species.level[0].split_angle_v) =
            (split_angle, split_angle_v);
        let mut leans = Vec::new();
        for seed in 0..60 {
            let tree = tree(&species, seed);
            let stems = &tree.levels[0];
            assert_eq!(stems.stems.len(), 2);
            for (i, first) in [(0, 1), (1, 0)] {
                // A third of the angle goes back on each of the three segments that remain.
                let lean = declination(stems.segments_of(i)[first].frame.axes.z_axis);
                leans.push(lean.to_degrees() * 1.5);
                assert!(declination(last_z(stems, i)) < 2e-3);
            }
        }
        if split_angle_v == 0.0 {
            assert!(leans.iter().all(|lean| (lean - split_angle).abs() < 0.1));
        } else {
            fills(&leans, split_angle, split_angle_v);
        }
    }
}

#[test]
fn one_clone_turns_its_origin_by_the_spread_and_several_stand_evenly() {
    let mut species = Species { levels: 1, ..plain() };
    species.level[0].split_angle = 40.0;
    let lean = |stems: &Stems, i: usize| {
        azimuth(stems.segments_of(i)[usize::from(i == 0)].frame.axes.z_axis).to_degrees()
    };
    species.trunk.base_splits = 1;
    let spreads: Vec<f32> = (0..400)
        .map(|seed| {
            let tree = tree(&species, seed);
            let stems = &tree.levels[0];
            (lean(stems, 0) - lean(stems, 1) + 540.0).rem_euclid(360.0) - 180.0
        })
        .collect();
    // 20 to 110 degrees to either side of an upright stem.
    let widest = spreads.iter().map(|s| s.abs()).fold(0.0, f32::max);
    let least = spreads.iter().map(|s| s.abs()).fold(f32::MAX, f32::min);
    assert!((105.0..=110.1).contains(&widest) && (19.9..21.0).contains(&least));
    let left = spreads.iter().filter(|s| **s > 0.0).count();
    assert!((160..240).contains(&left), "{left}");

    species.trunk.base_splits = 3;
    let tree = tree(&species, 1);
    for i in 1..4 {
        let apart = (lean(&tree.levels[0], i) - lean(&tree.levels[0], 0)).rem_euclid(360.0);
        assert!((apart - 90.0 * i as f32).abs() < 0.1, "{apart}");
    }
}

#[test]
fn a_stem_that_leans_more_than_the_split_angle_does_not_bend() {
    let mut species = Species { levels: 2, ..plain() };
    (species.level[1].seg_splits, species.level[1].split_angle) = (1.0, 50.0);
    let tree = tree(&species, 1);
    // Branches lean 60 degrees: clones differ by their turn about tree z alone.
    for segment in &tree.levels[1].segments {
        close_angle(declination(segment.frame.axes.z_axis), 60f32.to_radians());
    }
}

#[test]
fn targets_draw_stems_and_leaves() {
    let east = Vec3::new(1.0, 0.0, 0.0);
    let mut species = Species { attraction_up: 0.5, ..plain() };
    species.attraction_target = Target::Direction(east);
    let drawn = tree(&species, 1);
    for pair in drawn.levels[2].segments.windows(2).filter(|pair| pair[0].stem == pair[1].stem) {
        let before = pair[0].frame.axes.z_axis.angle_between(east);
        let after = pair[1].frame.axes.z_axis.angle_between(east);
        close_angle(after, before * (1.0 - 0.5 / 3.0));
    }
    let mut species = plain();
    species.leaves.target = LeafTarget::Direction(east);
    let before = tree(&species, 1);
    species.leaves.attraction = 0.4;
    let after = tree(&species, 1);
    for (a, b) in before.leaves.iter().zip(&after.leaves) {
        let (a, b) = (a.frame.axes.y_axis, b.frame.axes.y_axis);
        close_angle(b.angle_between(east), 0.6 * a.angle_between(east));
    }
    let sun = Vec3::new(100.0, 0.0, 50.0);
    species.leaves.target = LeafTarget::Point(sun);
    species.leaves.attraction = 1.0;
    species.leaves.stem_len = 0.0;
    for leaf in tree(&species, 1).leaves {
        let to_sun = (sun - leaf.frame.origin).normalize();
        assert!(leaf.frame.axes.y_axis.dot(to_sun) > 0.99999);
    }
    species.leaves.target = LeafTarget::Scattered;
    let scattered = tree(&species, 1);
    let n = scattered.leaves.len() as f32;
    let mean = scattered.leaves.iter().map(|leaf| leaf.frame.axes.y_axis).sum::<Vec3>() / n;
    assert!(mean.length() < 0.1, "{mean}");
}

#[test]
fn the_trunks_form_reads_flare_lobes_and_arbaros_scale() {
    let mut species = Species { flare: 0.6, lobes: 5, lobe_depth: 0.1, ..plain() };
    (species.trunk.scale, species.trunk.scale_v) = (1.5, 0.2);
    let form = TrunkForm::new(&species);
    close(form.factor(0.0), 1.594);
    close(form.factor(0.05), 1.08909);
    close(form.factor(0.125), 1.0);
    let lobe = |i: i32| form.lobe_factor(TAU * i as f32 / 1000.0);
    let peaks = (0..1000).filter(|i| lobe(*i) > lobe(i - 1) && lobe(*i) >= lobe(i + 1)).count();
    assert_eq!(peaks, 5);
    close((0..1000).map(lobe).fold(0.0, f32::max), 1.1);

    species.dialect = Some(Dialect::Arbaro);
    close(TrunkForm::new(&species).factor(0.5), 1.5);
    // Children do not inherit it, but may be as thick as the trunk they grow from.
    species.ratio_power = -1.0;
    let tree = tree(&species, 1);
    close(tree.levels[0].stems[0].seed.radius, 0.2);
    for stem in &tree.levels[1].stems {
        close(stem.seed.radius, 1.5 * 0.2 * (1.0 - stem.seed.offset / 10.0));
    }
}
