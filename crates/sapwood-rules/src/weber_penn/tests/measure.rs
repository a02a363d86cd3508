//! A plain species, and what tests measure on trees.

use std::f32::consts::TAU;

use glam::Vec3;

use super::*;

/// A tree without any variation: straight stems, even angles.
pub(super) fn plain() -> Species {
    let mut species =
        Species { base_size: 0.2, ratio: 0.02, ratio_power: 1.2, ..Default::default() };
    species.level[0].curve_res = 4;
    species.level[1] = LevelSpec {
        down_angle: 60.0,
        rotate: 140.0,
        branches: 20,
        length: 0.4,
        curve_res: 4,
        ..species.level[1].clone()
    };
    species.level[2] = LevelSpec {
        down_angle: 45.0,
        rotate: 140.0,
        branches: 10,
        length: 0.5,
        curve_res: 3,
        ..species.level[2].clone()
    };
    species.leaves.count = 10;
    species
}

pub(super) fn fills(values: &[f32], mean: f32, spread: f32) {
    assert!(values.len() >= 30);
    let (low, high) = values.iter().fold((f32::MAX, f32::MIN), |(l, h), x| (l.min(*x), h.max(*x)));
    let slack = 1e-3 * (mean.abs() + spread);
    assert!(low >= mean - spread - slack && high <= mean + spread + slack, "{low}..{high}");
    assert!(low < mean - 0.8 * spread && high > mean + 0.8 * spread, "{low}..{high}");
    let average = values.iter().sum::<f32>() / values.len() as f32;
    assert!((average - mean).abs() < 0.25 * spread, "{average}");
}

#[track_caller]
pub(super) fn close(a: f32, b: f32) {
    assert!((a - b).abs() <= 2e-4 * (1.0 + a.abs().max(b.abs())), "{a} is not {b}");
}

#[track_caller]
pub(super) fn close_angle(a: f32, b: f32) {
    let difference = a - b;
    let wrapped = difference - TAU * (difference / TAU).round();
    assert!(wrapped.abs() < 2e-3, "{} degrees are not {}", a.to_degrees(), b.to_degrees());
}

pub(super) fn first_z(stems: &Stems, stem: usize) -> Vec3 {
    stems.segments_of(stem)[0].frame.axes.z_axis
}

pub(super) fn last_z(stems: &Stems, stem: usize) -> Vec3 {
    stems.segments_of(stem).last().unwrap().frame.axes.z_axis
}

pub(super) fn declination(z: Vec3) -> f32 {
    z.z.clamp(-1.0, 1.0).acos()
}

pub(super) fn azimuth(v: Vec3) -> f32 {
    v.y.atan2(v.x)
}
