//! The parameters of a level of stems.

use std::f32::consts::TAU;

use super::super::measure::*;
use super::*;

pub(super) const LEVELS: &[Case] = &[
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
