//! Rays in single precision, for pictures: many, each of which may err by a rounding.
//!
//! Who must not err takes [`Ray`](crate::Ray) instead.

use glam::{Affine3, Vec3};

use crate::{Aabb, Sphere};

/// A half-line whose distances count lengths of its direction, so that they stay what they are
/// in whatever frame the ray is seen from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray32 {
    /// Where it starts.
    pub origin: Vec3,
    /// Where it goes; need not have unit length.
    pub direction: Vec3,
}

impl Ray32 {
    /// The half-line from `origin` along `direction`.
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction }
    }

    /// One over each coordinate of the direction.
    #[inline]
    pub(crate) fn inverse(&self) -> Vec3 {
        // A large number in place of infinity, for zero times infinity is no number.
        let inverse = |x: f32| {
            let inverse = 1.0 / x;
            if inverse.is_finite() { inverse } else { f32::MAX.copysign(x) }
        };
        let [x, y, z] = self.direction.to_array().map(inverse);
        Vec3::new(x, y, z)
    }

    /// The point at a distance.
    pub fn at(&self, distance: f32) -> Vec3 {
        self.origin + self.direction * distance
    }

    /// The same ray seen from the frame that `transform` leads to; distances stay.
    pub fn transformed(&self, transform: &Affine3) -> Self {
        let origin = transform.transform_point3(self.origin);
        Self::new(origin, transform.transform_vector3(self.direction))
    }

    /// The distance from which on the ray is inside a box, 0 where it starts there; nothing where
    /// it misses the box.
    pub fn enters(&self, aabb: &Aabb) -> Option<f32> {
        if aabb.is_empty() {
            return None;
        }
        let Aabb { min, max } = *aabb;
        // Plain comparisons, one instruction each.
        let smaller = |a: f32, b: f32| if a < b { a } else { b };
        let larger = |a: f32, b: f32| if a > b { a } else { b };
        let inverse = self.inverse();
        let one = (min - self.origin) * inverse;
        let other = (max - self.origin) * inverse;
        let enters = larger(smaller(one.x, other.x), smaller(one.y, other.y));
        let enters = larger(enters, larger(smaller(one.z, other.z), 0.0));
        let leaves = smaller(larger(one.x, other.x), larger(one.y, other.y));
        let leaves = smaller(leaves, larger(one.z, other.z));
        (leaves >= enters).then_some(enters)
    }

    /// The distance from which on the ray is inside a sphere, 0 where it starts there; nothing
    /// where it misses the sphere.
    pub fn enters_sphere(&self, sphere: &Sphere) -> Option<f32> {
        if sphere.is_empty() {
            return None;
        }
        let away = self.origin - sphere.center;
        let square = self.direction.length_squared();
        let nearest = -away.dot(self.direction) / square;
        let room = sphere.radius * sphere.radius;
        if away.length_squared() <= room {
            return Some(0.0);
        }
        // Taken at the nearest point, where numbers are as small as the sphere. From far away the
        // origin is rounded all the same, so the sphere counts as a little larger.
        let missed = (away + self.direction * nearest).length_squared();
        let slack = 1e-6 * away.abs().max_element();
        let room = room + slack * (2.0 * sphere.radius + slack);
        (missed <= room && nearest > 0.0)
            .then(|| (nearest - libm::sqrtf((room - missed) / square)).max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_are_entered_from_outside_and_inside() {
        let cube = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        let ray = |origin: Vec3, direction| Ray32::new(origin, direction).enters(&cube);
        assert_eq!(ray(Vec3::new(-2.0, 0.5, 0.5), Vec3::X * 4.0), Some(0.5));
        assert_eq!(ray(Vec3::splat(0.5), Vec3::Y), Some(0.0));
        assert_eq!(ray(Vec3::new(2.0, 0.5, 0.5), Vec3::X), None);
        // Along a face, where a difference of zero meets a step of zero.
        assert_eq!(ray(Vec3::new(0.0, 0.5, -1.0), Vec3::Z), Some(1.0));
        assert_eq!(Ray32::new(Vec3::ZERO, Vec3::X).enters(&Aabb::EMPTY), None);
    }

    #[test]
    fn spheres_are_entered_from_outside_and_inside() {
        let ball = Sphere { center: Vec3::new(5.0, 0.0, 0.0), radius: 1.0 };
        let ray = |origin: Vec3, direction| Ray32::new(origin, direction).enters_sphere(&ball);
        assert!((ray(Vec3::ZERO, Vec3::X * 2.0).unwrap() - 2.0).abs() < 1e-4);
        assert_eq!(ray(Vec3::new(5.5, 0.0, 0.0), Vec3::Y), Some(0.0));
        assert_eq!(ray(Vec3::ZERO, Vec3::NEG_X), None);
        assert_eq!(ray(Vec3::new(0.0, 2.0, 0.0), Vec3::X), None);
        assert_eq!(Ray32::new(Vec3::ZERO, Vec3::X).enters_sphere(&Sphere::EMPTY), None);
    }

    #[test]
    fn small_spheres_far_away_are_entered() {
        for i in 0..1_000 {
            let angle = i as f32 * 0.61;
            let far = Vec3::new(angle.cos(), 0.3, angle.sin()).normalize();
            for (distance, radius) in [(1e3, 0.5), (1e4, 0.5), (3e4, 5.0)] {
                let center = far * distance;
                let aside = far.any_orthonormal_vector() * (0.8 * radius);
                let ray = Ray32::new(Vec3::ZERO, (center + aside).normalize());
                let enters = ray.enters_sphere(&Sphere { center, radius }).unwrap();
                assert!((enters - distance).abs() <= 1.01 * radius + 1e-6 * distance);
            }
        }
    }
}
