//! Every parameter, changed alone, has the effect that its formula predicts.

use std::f32::consts::TAU;

use super::measure::*;
use super::*;

/// A tree before and after one parameter changed, and after it over many seeds.
struct Change {
    species: Species,
    before: Tree,
    after: Tree,
    seeds: Vec<Tree>,
}

impl Change {
    fn trunk(&self) -> &Stem {
        &self.after.levels[0].stems[0]
    }
    fn stems(&self, level: usize) -> &[Stem] {
        &self.after.levels[level].stems
    }
    fn branches(&self) -> &[Stem] {
        self.stems(1)
    }
    /// Something of every stem of a level over many seeds must lie within ± spread of a mean,
    /// and fill that interval.
    fn varies(&self, level: usize, mean: f32, spread: f32, of: impl Fn(&Stems, usize) -> f32) {
        let values: Vec<f32> = self
            .seeds
            .iter()
            .map(|tree| &tree.levels[level])
            .flat_map(|stems| (0..stems.stems.len()).map(|i| of(stems, i)).collect::<Vec<_>>())
            .collect();
        fills(&values, mean, spread);
    }
}

fn n_children_of(stem: &Stem, children: &[Stem]) -> usize {
    let child = |key| stem.seed.path.child(key);
    let paths: Vec<_> = (0..1000).map(child).collect();
    children.iter().filter(|c| paths.contains(&c.seed.path)).count()
}

/// Level 1 lengths by the crown's formula, with a shape ratio written out anew.
fn check_shape(change: &Change, ratio: impl Fn(f32) -> f32) {
    let length = change.trunk().seed.length;
    let length_base = change.species.base_size * 10.0;
    assert!(change.branches().len() > 10);
    for stem in change.branches() {
        let r = (length - stem.seed.offset) / (length - length_base);
        close(stem.seed.length, length * 0.4 * ratio(r));
    }
}

fn check(name: &str, value: f32, checks: fn(&Change)) {
    println!("{name} = {value}");
    let before = plain();
    let mut species = before.clone();
    key(name).expect(name).set(&mut species, &Value::Number(value)).unwrap();
    assert_eq!(species.faults(), [], "{name}");
    let change = Change {
        before: tree(&before, 1),
        after: tree(&species, 1),
        seeds: (0..40).map(|seed| tree(&species, seed)).collect(),
        species,
    };
    for n in 0..level_of(name).min(3) {
        assert_eq!(change.before.levels[n], change.after.levels[n], "level {n} changed too");
    }
    checks(&change);
}

/// The first level that a key may change; 3 for the leaves.
fn level_of(name: &str) -> usize {
    match name.strip_prefix("level.") {
        Some(rest) => rest[..1].parse().unwrap(),
        None if name.starts_with("leaves.") => 3,
        None => 0,
    }
}

type Case = (&'static str, f32, fn(&Change));

const TREE: &[Case] = &[
    ("shape", 0.0, |c| check_shape(c, |r| 0.2 + 0.8 * r)),
    ("shape", 1.0, |c| check_shape(c, |r| 0.2 + 0.8 * (r * TAU / 2.0).sin())),
    ("shape", 2.0, |c| check_shape(c, |r| 0.2 + 0.8 * (r * TAU / 4.0).sin())),
    ("shape", 3.0, |c| check_shape(c, |_| 1.0)),
    ("shape", 4.0, |c| check_shape(c, |r| 0.5 + 0.5 * r)),
    ("shape", 5.0, |c| check_shape(c, |r| (r / 0.7).min((1.0 - r) / 0.3))),
    ("shape", 6.0, |c| check_shape(c, |r| 1.0 - 0.8 * r)),
    ("shape", 7.0, |c| check_shape(c, |r| 0.5 + 0.5 * (r / 0.7).min((1.0 - r) / 0.3))),
    ("shape", 8.0, |c| check_shape(c, |r| (r.min(1.0 - r) / 0.5).sqrt())),
    ("base_size", 0.6, |c| {
        check_shape(c, |r| 0.2 + 0.8 * r);
        let lowest = c.branches().iter().map(|s| s.seed.offset).fold(f32::MAX, f32::min);
        assert!((6.0..6.3).contains(&lowest) && c.branches().len() == 20);
    }),
    ("scale", 14.0, |c| close(c.trunk().seed.length, 14.0)),
    ("scale_v", 3.0, |c| c.varies(0, 10.0, 3.0, |s, i| s.stems[i].seed.length)),
    ("levels", 2.0, |c| assert_eq!(c.after.levels.len(), 2)),
    ("levels", 4.0, |c| {
        // Stems of level 2 bear 5 children of level 3 at most.
        assert_eq!(c.after.levels.len(), 4);
        for stem in &c.stems(2)[..20] {
            let expected = 5.0 * (1.0 - 0.5 * stem.seed.offset / stem.seed.parent_length);
            assert!((n_children_of(stem, c.stems(3)) as f32 - expected).abs() <= 1.0);
        }
        let parents = c.stems(2);
        for stem in &c.stems(3)[..20] {
            let parent =
                parents.iter().find(|p| (0..9).any(|k| p.seed.path.child(k) == stem.seed.path));
            let parent = parent.unwrap().seed;
            close(stem.seed.length, 0.5 * (parent.length - 0.6 * stem.seed.offset));
        }
    }),
    ("ratio", 0.03, |c| close(c.trunk().seed.radius, 0.3)),
    ("ratio_power", 2.0, |c| {
        for stem in c.branches() {
            let radius = 0.2 * (stem.seed.length / 10.0).powi(2);
            close(stem.seed.radius, radius.min(stem.seed.parent_radius));
        }
    }),
    ("ratio_power", -1.0, |c| {
        for stem in c.branches() {
            close(stem.seed.radius, stem.seed.parent_radius);
            close(stem.seed.radius, 0.2 * (1.0 - stem.seed.offset / 10.0));
        }
    }),
    ("attraction_up", 0.8, |c| {
        assert_eq!(c.before.levels[1], c.after.levels[1]);
        check_attraction(c, 0.8);
    }),
    ("attraction_up", -2.0, |c| check_attraction(c, -2.0)),
    ("trunk.scale", 1.5, |c| close(c.trunk().seed.radius, 0.3)),
    ("trunk.scale_v", 0.5, |c| c.varies(0, 0.2, 0.1, |s, i| s.stems[i].seed.radius)),
    ("trunk.base_splits", 2.0, |c| {
        let starts: Vec<u32> = c.stems(0).iter().map(|stem| stem.start).collect();
        assert_eq!(starts, [0, 1, 1]);
        assert!(c.stems(0)[1..].iter().all(|stem| stem.clone_of == Some(0)));
        // The three share the children that one had.
        assert!((c.branches().len() as i32 - 20).abs() <= 3);
    }),
    ("pruning.width_peak", 0.3, |c| check_envelope(c)),
    ("pruning.power_low", 2.0, |c| check_envelope(c)),
    ("pruning.power_high", 2.0, |c| check_envelope(c)),
];

const LEVELS: &[Case] = &[
    ("level.0.down_angle", 30.0, |c| {
        close_angle(declination(first_z(&c.after.levels[0], 0)), 30f32.to_radians());
    }),
    ("level.0.down_angle_v", 20.0, |c| {
        c.varies(0, 0.0, 20.0, |s, i| {
            declination(first_z(s, i)).to_degrees() * first_z(s, i).y.signum()
        });
    }),
    ("level.1.down_angle", 80.0, |c| {
        for i in 0..c.branches().len() {
            close_angle(declination(first_z(&c.after.levels[1], i)), 80f32.to_radians());
        }
    }),
    ("level.1.down_angle_v", 20.0, |c| {
        c.varies(1, 60.0, 20.0, |s, i| declination(first_z(s, i)).to_degrees());
    }),
    ("level.1.down_angle_v", -50.0, |c| {
        for (i, stem) in c.branches().iter().enumerate() {
            let r = (10.0 - stem.seed.offset) / 8.0;
            let down = 60.0 - 50.0 * (1.0 - 2.0 * (0.2 + 0.8 * r));
            close_angle(declination(first_z(&c.after.levels[1], i)), down.to_radians());
        }
    }),
    ("level.1.rotate", 100.0, |c| {
        for i in 1..c.branches().len() {
            let stems = &c.after.levels[1];
            let step = azimuth(first_z(stems, i)) - azimuth(first_z(stems, i - 1));
            close_angle(step, 100f32.to_radians());
        }
    }),
    ("level.1.rotate", -120.0, |c| {
        for i in 0..c.branches().len() {
            let side = if i % 2 == 0 { 60f32 } else { -60.0 };
            // Children lean toward -y of the frame that was turned.
            let turned = azimuth(first_z(&c.after.levels[1], i)) + TAU / 4.0;
            close_angle(turned, side.to_radians());
        }
    }),
    ("level.1.rotate_v", 30.0, |c| {
        c.varies(1, 140.0, 30.0, |s, i| {
            let before = if i == 0 { -TAU / 4.0 } else { azimuth(first_z(s, i - 1)) };
            (azimuth(first_z(s, i)) - before).to_degrees().rem_euclid(360.0)
        });
    }),
    ("level.0.rotate", 90.0, |c| {
        close_angle(azimuth(c.after.levels[0].segments[0].frame.axes.x_axis), TAU / 4.0);
    }),
    ("level.0.rotate_v", 40.0, |c| {
        c.varies(0, 0.0, 40.0, |s, i| azimuth(s.segments_of(i)[0].frame.axes.x_axis).to_degrees());
    }),
    ("level.0.branches", 7.0, |c| assert_eq!(c.stems(0).len(), 7)),
    ("level.1.branches", 37.0, |c| assert_eq!(c.branches().len(), 37)),
    ("level.2.branches", 20.0, |c| {
        for stem in c.branches() {
            // length_this / length_parent / length_child_max is the shape ratio again.
            let expected = 20.0 * (0.2 + 0.8 * stem.seed.length / 10.0 / 0.4);
            let count = n_children_of(stem, c.stems(2)) as f32;
            assert!((count - expected).abs() <= 1.0, "{count} for {expected}");
        }
    }),
    ("level.1.branch_dist", 0.0, |c| {
        for stem in c.branches() {
            let feet = [2.0, 2.5, 5.0, 7.5];
            assert!(feet.iter().any(|foot| (stem.seed.offset - foot).abs() < 1e-4));
        }
    }),
    ("level.1.branch_dist", 1.0, |c| {
        // Slots lie in 2..2.5, 2.5..5 and so on, and a place within the middle half of its slot.
        let segments = [(2.0, 0.5), (2.5, 2.5), (5.0, 2.5), (7.5, 2.5)];
        for (foot, free) in segments {
            let inside = |s: &&Stem| (foot..foot + free).contains(&s.seed.offset);
            let count = c.branches().iter().filter(inside).count();
            assert!((count as f32 - 20.0 * free / 8.0).abs() <= 1.0, "{count}");
            for (i, stem) in c.branches().iter().filter(inside).enumerate() {
                let slots = (stem.seed.offset - foot) / (free / count as f32);
                assert!((slots - (i as f32 + 0.5)).abs() <= 0.2501, "{slots}");
            }
        }
    }),
    ("level.0.length", 0.7, |c| close(c.trunk().seed.length, 7.0)),
    ("level.0.length_v", 0.2, |c| c.varies(0, 10.0, 2.0, |s, i| s.stems[i].seed.length)),
    ("level.1.length", 0.3, |c| {
        for (a, b) in c.before.levels[1].stems.iter().zip(c.branches()) {
            close(b.seed.length, 0.75 * a.seed.length);
        }
    }),
    ("level.1.length_v", 0.1, |c| {
        c.varies(1, 0.4, 0.1, |s, i| {
            let seed = s.stems[i].seed;
            seed.length / (10.0 * (0.2 + 0.8 * (10.0 - seed.offset) / 8.0))
        });
    }),
    ("level.2.length", 0.8, |c| {
        for stem in &c.stems(2)[..30] {
            close(stem.seed.length, 0.8 * (stem.seed.parent_length - 0.6 * stem.seed.offset));
        }
    }),
    ("level.0.taper", 0.5, |c| close(c.after.levels[0].segments[3].radius_end, 0.1)),
    ("level.1.taper", 0.0, |c| {
        for segment in &c.after.levels[1].segments {
            assert_eq!(segment.radius_foot, segment.radius_end);
        }
    }),
    ("level.0.taper", 2.2, |c| {
        // A pinch of a fifth every 2 radii of 0.2 from the tip, and a round end.
        let radius = |metres_left: f32| c.trunk().radius_at(1.0 - metres_left / 10.0);
        close(radius(0.0), 0.0);
        close(radius(0.2), 0.2);
        close(radius(0.04), 0.12);
        for k in 1..20 {
            close(radius(0.4 * k as f32), 0.8 * 0.2);
            close(radius(0.4 * k as f32 + 0.2), 0.2);
        }
    }),
    ("level.0.taper", 1.5, |c| {
        close(c.trunk().radius_at(0.8), 0.2 * (1.0 - 0.5 * 0.8));
        close(c.trunk().radius_at(1.0), 0.0);
    }),
    ("level.0.seg_splits", 1.0, |c| assert_eq!(c.stems(0).len(), 8)),
    ("level.0.seg_splits", 2.0, |c| assert_eq!(c.stems(0).len(), 27)),
    ("level.1.seg_splits", 0.5, |c| {
        let tips: usize = c.seeds.iter().map(|tree| tree.levels[1].stems.len()).sum();
        let mean = tips as f32 / 40.0 / 20.0;
        assert!((mean / 1.5f32.powi(3) - 1.0).abs() < 0.05, "{mean}");
    }),
    ("level.0.curve_res", 9.0, |c| assert_eq!(c.after.levels[0].segments.len(), 9)),
    ("level.1.curve", 80.0, |c| {
        let stems = &c.after.levels[1];
        for i in 0..stems.stems.len() {
            let bend = first_z(stems, i).angle_between(last_z(stems, i));
            close_angle(bend, 60f32.to_radians());
            // Positive curves lead down, the way of the down angle.
            close_angle(declination(last_z(stems, i)), 120f32.to_radians());
        }
    }),
    ("level.1.curve_back", -40.0, |c| {
        // Without a curve the first half is straight; the second takes a quarter of -40 / 2.
        let stems = &c.after.levels[1];
        for i in 0..stems.stems.len() {
            let z: Vec<f32> = stems
                .segments_of(i)
                .iter()
                .map(|s| declination(s.frame.axes.z_axis).to_degrees())
                .collect();
            for (z, expected) in z.into_iter().zip([60.0, 60.0, 40.0, 20.0]) {
                assert!((z - expected).abs() < 0.05);
            }
        }
    }),
    ("level.1.curve_v", 80.0, |c| {
        let mut bends = Vec::new();
        for tree in &c.seeds {
            for pair in tree.levels[1].segments.windows(2).filter(|p| p[0].stem == p[1].stem) {
                let (a, b) = (pair[0].frame.axes, pair[1].frame.axes);
                // The tilt's part along local x, which reaches both signs.
                let bend = a.z_axis.angle_between(b.z_axis).to_degrees();
                bends.push(bend * (b.z_axis - a.z_axis).dot(a.x_axis).signum());
            }
        }
        fills(&bends, 0.0, 20.0);
    }),
    ("level.2.curve_v", -30.0, |c| {
        let stems = &c.after.levels[2];
        for (i, stem) in stems.stems.iter().enumerate().take(20) {
            let segment = &stems.segments_of(i)[1];
            let radius = 30f32.to_radians().tan() * segment.length / TAU;
            close(stem.helix_radius, radius);
            let half = segment.offset + 0.5 * segment.length;
            let on_axis = segment.frame.origin + 0.5 * segment.length * segment.frame.axes.z_axis;
            close(stems.center_at(i, half).distance(on_axis), 2.0 * radius);
            for f in [0.1, 0.4, 0.9] {
                let tangent = stems.tangent_at(i, segment.offset + f * segment.length);
                close_angle(tangent.angle_between(segment.frame.axes.z_axis), 30f32.to_radians());
            }
        }
        // Leaves grow on the helix, not on its axis.
        for leaf in &c.after.leaves {
            let length = 0.5 * 0.2;
            let foot = leaf.frame.origin - length * leaf.frame.axes.z_axis;
            let stem = leaf.stem as usize;
            let axis = stems.segments_of(stem)[0].frame;
            let out = foot - axis.origin + stems.stems[stem].helix_radius * axis.axes.x_axis;
            let from_axis = (out - out.dot(axis.axes.z_axis) * axis.axes.z_axis).length();
            close(from_axis, stems.stems[stem].helix_radius);
        }
    }),
];

const LEAVES: &[Case] = &[
    ("leaves.count", 24.0, |c| check_leaf_counts(c, |r| 24.0 * (0.5 + 0.5 * r))),
    ("leaves.distrib", 6.0, |c| check_leaf_counts(c, |r| 10.0 * (1.0 - 0.8 * r))),
    ("leaves.quality", 0.25, |c| {
        check_leaf_counts(c, |r| 2.5 * (0.5 + 0.5 * r));
        close(c.after.leaves[0].length, 0.4);
        close(c.after.leaves[0].width, 0.2);
    }),
    ("leaves.count", -3.0, |c| {
        // Three in a fan of 120 degrees: one along the tip turned down, two at ± 40 degrees.
        let stems = &c.after.levels[2];
        assert_eq!(c.after.leaves.len(), 3 * stems.stems.len());
        for leaf in &c.after.leaves {
            let tip = stems.segments_of(leaf.stem as usize).last().unwrap().end();
            assert!(leaf.frame.origin.distance(tip) < 0.101);
        }
    }),
    ("leaves.scale", 0.3, |c| {
        close(c.after.leaves[0].length, 0.3);
        close(c.after.leaves[0].width, 0.15);
    }),
    ("leaves.scale_x", 0.9, |c| close(c.after.leaves[0].width, 0.18)),
    ("leaves.stem_len", -0.4, |c| {
        for (a, b) in c.before.leaves.iter().zip(&c.after.leaves) {
            assert_eq!(a.frame.axes, b.frame.axes);
            let shift = (-0.4 - 0.5) * 0.2 * a.frame.axes.z_axis;
            assert!((b.frame.origin - a.frame.origin).abs_diff_eq(shift, 1e-5));
        }
    }),
    ("leaves.bend", 0.0, |c| {
        // The tree before has the default bend of 0.3.
        for (a, b) in c.before.leaves.iter().zip(&c.after.leaves) {
            let (bent, plain) = (a.frame.axes.y_axis, b.frame.axes.y_axis);
            close_angle(declination(bent), 0.7 * declination(plain));
        }
    }),
];

fn check_leaf_counts(change: &Change, expected: impl Fn(f32) -> f32) {
    let stems = change.stems(2);
    let mut total = 0.0;
    for (i, stem) in stems.iter().enumerate() {
        let count = change.after.leaves.iter().filter(|leaf| leaf.stem as usize == i).count();
        let expected = expected(stem.seed.offset / stem.seed.parent_length);
        assert!((count as f32 - expected).abs() <= 1.0, "{count} for {expected}");
        total += expected;
    }
    assert!((change.after.leaves.len() as f32 / total - 1.0).abs() < 0.05);
}

/// Each segment of level 2 is its predecessor turned about local x by the paper's curve upward.
fn check_attraction(change: &Change, attraction_up: f32) {
    for pair in change.after.levels[2].segments.windows(2).filter(|p| p[0].stem == p[1].stem) {
        let (a, b) = (pair[0].frame.axes, pair[1].frame.axes);
        let curve_up = attraction_up * declination(a.z_axis) * a.y_axis.z / 3.0;
        let expected = curve_up.cos() * a.z_axis + curve_up.sin() * a.y_axis;
        assert!(b.z_axis.abs_diff_eq(expected, 1e-4));
    }
}

/// Shape 8: lengths follow the envelope's profile. (Under any other shape it is not read.)
fn check_envelope(change: &Change) {
    assert_eq!(change.before.levels, change.after.levels);
    let mut species = change.species.clone();
    species.shape = CrownShape::Envelope;
    let pruning = species.pruning.clone();
    let before = plain();
    let after = tree(&species, 1);
    let change = Change { species, before: tree(&before, 1), after, seeds: Vec::new() };
    let peak = 1.0 - pruning.width_peak;
    check_shape(&change, |q| {
        if q < peak {
            (q / peak).powf(pruning.power_high)
        } else {
            ((1.0 - q) / (1.0 - peak)).powf(pruning.power_low)
        }
    });
}

fn check_all(cases: &[Case]) {
    for (name, value, checks) in cases {
        check(name, *value, *checks);
    }
}

#[test]
fn parameters_of_the_tree() {
    check_all(TREE);
}

#[test]
fn parameters_of_the_levels() {
    check_all(LEVELS);
}

#[test]
fn parameters_of_the_leaves() {
    check_all(LEAVES);
}

#[test]
fn parameters_that_do_not_act_on_growth_change_nothing() {
    for (name, value) in [
        ("z_scale", 2.0),
        ("z_scale_v", 1.0),
        ("smooth", 0.7),
        ("lobes", 5.0),
        ("lobe_depth", 0.2),
        ("pruning.ratio", 0.9),
        ("pruning.width", 0.1),
        ("level.3.length", 0.9),
        ("level.3.curve_res", 7.0),
    ] {
        check(name, value, |c| {
            assert!(c.before.levels == c.after.levels && c.before.leaves == c.after.leaves);
        });
    }
}

#[test]
fn every_key_has_a_test() {
    let tested: Vec<&str> =
        TREE.iter().chain(LEVELS).chain(LEAVES).map(|(name, ..)| last(name)).collect();
    let elsewhere = [
        "name",
        "origin",
        "defaulted",
        "notes",
        "dialect",
        "variation",
        "attraction_target",
        "z_scale",
        "z_scale_v",
        "lobes",
        "lobe_depth",
        "flare",
        "smooth",
        "leaves.shape",
        "leaves.attraction",
        "leaves.target",
        "pruning.ratio",
        "pruning.width",
        "split_angle",
        "split_angle_v",
        "ext.tree_gen.base_size",
        "ext.tree_gen.bend_v",
        "ext.tree_gen.radius_mod",
        "ext.tree_gen.tropism",
    ];
    let kept = [
        "ext.tree_gen.branch_dist",
        "ext.tree_gen.blossom_rate",
        "ext.tree_gen.blossom_scale",
        "ext.tree_gen.blossom_shape",
    ];
    for key in keys() {
        let name = last(key.name());
        assert!(
            tested.contains(&name) || elsewhere.contains(&name) || kept.contains(&name),
            "{name}"
        );
    }
}

/// The name of a key without its level.
fn last(name: &str) -> &str {
    name.strip_prefix("level.").map_or(name, |rest| &rest[2..])
}
