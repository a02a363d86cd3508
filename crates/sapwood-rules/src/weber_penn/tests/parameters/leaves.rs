//! The parameters of the leaves.

use super::super::measure::*;
use super::*;

pub(super) const LEAVES: &[Case] = &[
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
