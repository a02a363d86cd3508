//! Lines, as rays meet them.

use sapwood_geom::glam::{Affine3, Vec3};
use sapwood_geom::{Aabb, Ray32};

use crate::camera::{Gaze, PixelWidth};

/// How wide lines are at least, seen by a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LineWidth {
    eye: Vec3,
    /// Of half a line.
    half: PixelWidth,
}

impl LineWidth {
    /// Lines of so many pixels.
    pub(crate) fn new(gaze: &Gaze, pixels: f32) -> Self {
        let PixelWidth { base, slope } = gaze.width;
        let half = PixelWidth { base: 0.5 * pixels * base, slope: 0.5 * pixels * slope };
        Self { eye: gaze.eye(), half }
    }

    /// Lines that are as thick as they say.
    pub(crate) fn none() -> Self {
        Self { eye: Vec3::ZERO, half: PixelWidth { base: 0.0, slope: 0.0 } }
    }

    /// The least radius of a line at a point, both in a frame that `world` leads to the root's
    /// from.
    fn at(&self, point: Vec3, world: &Affine3) -> f32 {
        let metres = self.half.at(world.transform_point3(point).distance(self.eye));
        let m = &world.matrix3;
        let longest = m.x_axis.length().max(m.y_axis.length()).max(m.z_axis.length());
        if longest > 0.0 { metres / longest } else { metres }
    }
}

/// A straight piece of a line: a rod whose radius goes evenly from one end to the other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LinePiece {
    ends: [Vec3; 2],
    radii: [f32; 2],
    /// The number of their look, where they have one.
    pub(crate) look: Option<u32>,
}

/// Where a ray meets a rod.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RodHit {
    pub(crate) distance: f32,
    /// Away from the rod's axis, unit length.
    pub(crate) normal: Vec3,
}

impl LinePiece {
    pub(super) fn new(
        ends: [Vec3; 2],
        radii: [f32; 2],
        look: Option<u32>,
        width: &LineWidth,
        outside: &Affine3,
    ) -> Self {
        let radius = |i: usize| radii[i].max(width.at(ends[i], outside));
        Self { ends, radii: [radius(0), radius(1)], look }
    }

    pub(super) fn aabb(&self) -> Aabb {
        let radius = self.radii[0].max(self.radii[1]);
        let Aabb { min, max } = Aabb::of_points(self.ends);
        Aabb { min: min - radius, max: max + radius }
    }

    /// Where a ray meets the rod, taken as straight where the ray comes nearest to its axis.
    pub(crate) fn meet(&self, ray: &Ray32) -> Option<RodHit> {
        let [start, end] = self.ends;
        let (axis, step) = (end - start, ray.direction);
        let away = ray.origin - start;
        // The nearest points of both lines; the one on the axis kept between the ends.
        let (aa, ab, bb) = (axis.length_squared(), axis.dot(step), step.length_squared());
        let (ac, bc) = (axis.dot(away), step.dot(away));
        let whole = aa * bb - ab * ab;
        let along = if whole > 1e-12 * aa * bb { (ac * bb - bc * ab) / whole } else { 0.0 };
        let along = along.clamp(0.0, 1.0);
        let nearest = (along * ab - bc) / bb;
        let radius = self.radii[0] + (self.radii[1] - self.radii[0]) * along;
        let point = start + axis * along;
        let missed = ray.at(nearest) - point;
        let room = radius * radius - missed.length_squared();
        if room < 0.0 {
            return None;
        }
        // Across the rod, the ray goes into it by so much more the flatter they meet.
        let slant = if aa > 0.0 { (whole / (aa * bb)).max(0.01) } else { 1.0 };
        let distance = nearest - libm::sqrtf(room / (bb * slant));
        if distance < 0.0 {
            return None;
        }
        let out = ray.at(distance) - point;
        let normal = if aa > 0.0 { out - axis * (out.dot(axis) / aa) } else { out };
        Some(RodHit { distance, normal: normal.normalize_or(-step.normalize_or_zero()) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rod() -> LinePiece {
        LinePiece { ends: [Vec3::ZERO, Vec3::Y * 2.0], radii: [0.5, 0.25], look: None }
    }

    #[test]
    fn a_rod_is_met_on_its_skin() {
        let hit = rod().meet(&Ray32::new(Vec3::new(3.0, 0.0, 0.0), Vec3::NEG_X)).unwrap();
        assert!((hit.distance - 2.5).abs() < 1e-5 && hit.normal == Vec3::X);
        let hit = rod().meet(&Ray32::new(Vec3::new(3.0, 2.0, 0.0), Vec3::NEG_X * 2.0)).unwrap();
        assert!((hit.distance - 1.375).abs() < 1e-5);
        assert!(rod().meet(&Ray32::new(Vec3::new(3.0, 1.0, 0.4), Vec3::NEG_X)).is_none());
        assert!(rod().meet(&Ray32::new(Vec3::new(3.0, 1.0, 0.0), Vec3::X)).is_none());
        assert!(rod().meet(&Ray32::new(Vec3::new(3.0, 3.0, 0.0), Vec3::NEG_X)).is_none());
    }

    #[test]
    fn its_box_holds_it() {
        let Aabb { min, max } = rod().aabb();
        assert_eq!((min, max), (Vec3::splat(-0.5), Vec3::new(0.5, 2.5, 0.5)));
    }
}
