//! What envelopes are asked about: a ball or a box, in `f64`, for it is taken into other frames.

use glam::{DAffine3, DVec3};

use crate::{Aabb, Sphere};

/// All points in a ball or in a box; none is empty.
#[derive(Clone, Copy, Debug)]
pub(super) enum Region {
    Ball { center: DVec3, radius: f64 },
    Box { min: DVec3, max: DVec3 },
}

/// By how much of its largest coordinate a region is grown, for whoever asks has rounded to `f32`.
const SLACK: f64 = 4.0 * f32::EPSILON as f64;

impl Region {
    /// All points in a sphere that is not empty.
    pub(super) fn of_sphere(sphere: &Sphere) -> Self {
        let (center, radius) = (sphere.center.as_dvec3(), f64::from(sphere.radius));
        let slack = SLACK * (center.abs().max_element() + radius);
        Self::Ball { center, radius: radius + slack }
    }

    /// All points in a box that is not empty.
    pub(super) fn of_box(aabb: &Aabb) -> Self {
        let (min, max) = (aabb.min.as_dvec3(), aabb.max.as_dvec3());
        let slack = DVec3::splat(SLACK * min.abs().max(max.abs()).max_element());
        Self::Box { min: min - slack, max: max + slack }
    }

    /// A region around this one's points after `transform`.
    pub(super) fn transformed(&self, transform: &DAffine3) -> Self {
        let [x, y, z] = transform.matrix3.to_cols_array_2d().map(DVec3::from);
        match *self {
            Self::Ball { center, radius } => {
                let center = transform.transform_point3(center);
                // The largest stretch is the square root of the largest eigenvalue of the products
                // of the axes: no row's sum is less, and neither is the trace.
                let axes = [x, y, z];
                let row = |a: &DVec3| axes.iter().map(|b| a.dot(*b).abs()).sum::<f64>();
                let trace: f64 = axes.iter().map(|a| a.length_squared()).sum();
                let square = axes.iter().map(row).fold(0.0, f64::max).min(trace);
                Self::Ball { center, radius: radius * square.sqrt() * (1.0 + 1e-8) }
            }
            Self::Box { min, max } => {
                let center = transform.transform_point3((min + max) * 0.5);
                let half = (max - min) * 0.5;
                let reach = x.abs() * half.x + y.abs() * half.y + z.abs() * half.z;
                Self::Box { min: center - reach, max: center + reach }
            }
        }
    }

    /// The middle.
    pub(super) fn center(&self) -> DVec3 {
        match *self {
            Self::Ball { center, .. } => center,
            Self::Box { min, max } => (min + max) * 0.5,
        }
    }

    /// How far the farthest point is from the middle.
    pub(super) fn radius(&self) -> f64 {
        match *self {
            Self::Ball { radius, .. } => radius,
            Self::Box { min, max } => (max - min).length() * 0.5,
        }
    }

    /// The corners of the box around the region.
    pub(super) fn corners(&self) -> [DVec3; 2] {
        match *self {
            Self::Ball { center, radius } => [center - radius, center + radius],
            Self::Box { min, max } => [min, max],
        }
    }

    /// The least and the largest dot product of a point with `normal`.
    pub(super) fn along(&self, normal: DVec3) -> [f64; 2] {
        let middle = self.center().dot(normal);
        let reach = match *self {
            Self::Ball { radius, .. } => normal.length() * radius,
            Self::Box { min, max } => ((max - min) * 0.5).dot(normal.abs()),
        };
        [middle - reach, middle + reach]
    }

    /// The least and the largest distance of a point from `from`.
    pub(super) fn distances(&self, from: DVec3) -> [f64; 2] {
        match *self {
            Self::Ball { center, radius } => {
                let middle = center.distance(from);
                [(middle - radius).max(0.0), middle + radius]
            }
            Self::Box { min, max } => {
                let far = (from - min).abs().max((from - max).abs());
                [from.clamp(min, max).distance(from), far.length()]
            }
        }
    }

    /// Whether the region may share a point with a box.
    pub(super) fn meets(&self, min: DVec3, max: DVec3) -> bool {
        match *self {
            Self::Ball { center, radius } => {
                center.clamp(min, max).distance_squared(center) <= radius * radius
            }
            Self::Box { min: low, max: high } => low.cmple(max).all() && high.cmpge(min).all(),
        }
    }
}
