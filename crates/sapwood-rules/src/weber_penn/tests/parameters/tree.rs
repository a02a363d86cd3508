//! The parameters of the whole tree: its crown, its trunk, its envelope.

use std::f32::consts::TAU;

use super::super::measure::*;
use super::*;

pub(super) const TREE: &[Case] = &[
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
    ("pruning.ratio", 0.9, |c| {
        assert_eq!(c.before.levels[0], c.after.levels[0]);
        let shares = c.branches().iter().map(|stem| {
            let whole =
                c.before.levels[1].stems.iter().find(|whole| whole.seed.path == stem.seed.path);
            stem.seed.length / whole.unwrap().seed.length
        });
        let shares: Vec<f32> = shares.collect();
        // What is given up keeps the tenth that the ratio leaves it.
        assert_eq!(shares.len(), c.before.levels[1].stems.len());
        assert!(shares.iter().all(|share| (0.0999..=1.0).contains(share)), "{shares:?}");
        assert!(shares.iter().any(|share| *share < 0.99), "{shares:?}");
    }),
    ("pruning.width_peak", 0.3, |c| check_envelope(c)),
    ("pruning.power_low", 2.0, |c| check_envelope(c)),
    ("pruning.power_high", 2.0, |c| check_envelope(c)),
];

/// Each segment of level 2 is its predecessor turned about local x by the paper's curve upward.
fn check_attraction(change: &Change, attraction_up: f32) {
    for pair in change.after.levels[2].segments.windows(2).filter(|p| p[0].stem == p[1].stem) {
        let (a, b) = (pair[0].frame.axes, pair[1].frame.axes);
        let curve_up = attraction_up * declination(a.z_axis) * a.y_axis.z / 3.0;
        let expected = curve_up.cos() * a.z_axis + curve_up.sin() * a.y_axis;
        assert!(b.z_axis.abs_diff_eq(expected, 1e-4));
    }
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
