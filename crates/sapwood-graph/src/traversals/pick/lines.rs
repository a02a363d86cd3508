//! Where a ray passes lines, and labels.

use sapwood_geom::glam::{Affine3, DVec3};
use sapwood_geom::{Polyline, Ray};

use crate::{DrawRange, Label};

/// Where a ray passes a line.
pub(super) struct Passed {
    pub(super) distance: f64,
    pub(super) line: u32,
    pub(super) stretch: u32,
    /// Where on the stretch, from 0 to 1.
    pub(super) along: f64,
    /// The point on the line.
    pub(super) point: DVec3,
    /// From one end of the stretch to the other.
    pub(super) stretch_along: DVec3,
}

/// The line that the ray, in the root's frame, first passes at `by` metres or less.
pub(super) fn pass_lines(
    ray: &Ray,
    lines: &[Polyline],
    drawn: DrawRange,
    world: &Affine3,
    by: f64,
    reach: f64,
) -> Option<Passed> {
    let mut first: Option<Passed> = None;
    for (line, points) in (drawn.first as usize..).zip(drawn.of(lines)) {
        let point = |i: usize| world.transform_point3(points.points[i]).as_dvec3();
        // A line of one point is a stretch of no length.
        let n_stretches = points.points.len().saturating_sub(1).max(points.points.len().min(1));
        for stretch in 0..n_stretches {
            let ends = [point(stretch), point((stretch + 1).min(points.points.len() - 1))];
            let Some((distance, along)) = nearest(ray, ends) else { continue };
            let limit = first.as_ref().map_or(reach, |first| first.distance);
            let is_first = distance < limit || first.is_none() && distance == limit;
            let point = ends[0].lerp(ends[1], along);
            if is_first && point.distance(ray.at(distance)) <= by {
                let (line, stretch) = (line as u32, stretch as u32);
                let stretch_along = ends[1] - ends[0];
                first = Some(Passed { distance, line, stretch, along, point, stretch_along });
            }
        }
    }
    first
}

/// Where ray and stretch are nearest to each other: the distance along the ray, and the place
/// on the stretch from 0 to 1.
fn nearest(ray: &Ray, [foot, end]: [DVec3; 2]) -> Option<(f64, f64)> {
    let (step, stretch) = (ray.direction(), end - foot);
    let away = ray.origin() - foot;
    let (a, b, c) = (step.length_squared(), step.dot(stretch), stretch.length_squared());
    let (d, e) = (step.dot(away), stretch.dot(away));
    let clamp = |distance: f64| distance.max(ray.min()).min(ray.max());
    let spread = a * c - b * b;
    let mut distance =
        if spread > 1e-12 * a * c { clamp((b * e - c * d) / spread) } else { ray.min() };
    let mut along = 0.0;
    // Each in turn as near as it can be to the other: twice does, for both are straight.
    for _ in 0..2 {
        along = if c > 0.0 { ((e + b * distance) / c).clamp(0.0, 1.0) } else { 0.0 };
        distance = clamp((b * along - d) / a);
    }
    (distance.is_finite() && along.is_finite()).then_some((distance, along))
}

/// Where the ray, in the label's frame, meets the rectangle that holds the text.
pub(super) fn meet_label(ray: &Ray, label: &Label) -> Option<f64> {
    let bound = label.bound();
    let distance = -ray.origin().z / ray.direction().z;
    let point = ray.at(distance).truncate();
    let (min, max) = (bound.aabb.min.as_dvec3().truncate(), bound.aabb.max.as_dvec3().truncate());
    let is_inside = min.cmple(point).all() && point.cmple(max).all();
    (is_inside && ray.min() <= distance && distance <= ray.max()).then_some(distance)
}

#[cfg(test)]
mod tests {
    use sapwood_geom::glam::Vec3;

    use super::*;

    fn passed(points: &[Vec3], by: f64) -> Option<(f64, u32, f64)> {
        let line = Polyline { points: points.to_vec(), radii: vec![0.0; points.len()] };
        let ray = Ray::new(Vec3::new(0.0, 0.0, 5.0), Vec3::NEG_Z);
        let all = DrawRange { first: 0, end: 1 };
        let passed = pass_lines(&ray, &[line], all, &Affine3::IDENTITY, by, f64::INFINITY)?;
        Some((passed.distance, passed.stretch, passed.along))
    }

    #[test]
    fn lines_are_passed_where_they_are_nearest() {
        let across =
            [Vec3::new(-1.0, 0.1, 0.0), Vec3::new(1.0, 0.1, 0.0), Vec3::new(1.0, 3.0, 0.0)];
        let (distance, stretch, along) = passed(&across, 0.2).unwrap();
        assert!((distance - 5.0).abs() < 1e-6 && stretch == 0 && (along - 0.5).abs() < 1e-6);
        assert_eq!(passed(&across, 0.05), None);
    }

    #[test]
    fn points_and_lines_along_the_ray_are_passed_too() {
        assert_eq!(passed(&[Vec3::ZERO], 0.1), Some((5.0, 0, 0.0)));
        assert_eq!(passed(&[], 0.1), None);
        let along = [Vec3::new(0.01, 0.0, -9.0), Vec3::new(0.01, 0.0, 2.0)];
        assert!(passed(&along, 0.1).is_some());
    }
}
