//! Rays, and whether they meet bounds.

use glam::{DAffine3, DVec3, Vec3};

use crate::{Aabb, Bound};

/// A half-line, or a piece of one.
///
/// In `f64`, for a ray is taken into frames that lie far from where it starts. Its distances are
/// metres where it was made; after [`transformed`](Self::transformed) they still are, whatever
/// the transform's scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    origin: DVec3,
    direction: DVec3,
    min: f64,
    max: f64,
}

/// By how much a box is grown against rounding, relative to its largest coordinate.
const SLACK: f64 = 1e-5;

impl Ray {
    /// The half-line from `origin` in a direction that need not have unit length.
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        let direction = direction.as_dvec3();
        // Dividing makes a direction of no length, or of no number, one that meets nothing.
        let direction = direction / direction.length();
        Self { origin: origin.as_dvec3(), direction, min: 0.0, max: f64::INFINITY }
    }

    /// The piece of the ray between two distances in metres.
    pub fn between(self, min: f32, max: f32) -> Self {
        Self { min: f64::from(min), max: f64::from(max), ..self }
    }

    /// The piece of the ray up to a distance, no longer than it was.
    pub fn up_to(self, max: f64) -> Self {
        Self { max: self.max.min(max), ..self }
    }

    /// Whether there is such a ray: its origin and direction are finite numbers, the direction
    /// has a length, and the distances are in order.
    pub fn is_sound(&self) -> bool {
        let has_direction = self.direction.is_finite() && self.direction != DVec3::ZERO;
        self.origin.is_finite() && has_direction && self.min <= self.max
    }

    /// Where it starts.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// How far a metre leads; of unit length where the ray was made.
    pub fn direction(&self) -> DVec3 {
        self.direction
    }

    /// The distance before which nothing is met.
    pub fn min(&self) -> f64 {
        self.min
    }

    /// The distance beyond which nothing is met.
    pub fn max(&self) -> f64 {
        self.max
    }

    /// The point at a distance.
    pub fn at(&self, distance: f64) -> DVec3 {
        self.origin + self.direction * distance
    }

    /// The ray in the frame that `transform` leads to.
    pub fn transformed(&self, transform: &DAffine3) -> Self {
        let origin = transform.transform_point3(self.origin);
        let direction = transform.transform_vector3(self.direction);
        Self { origin, direction, ..*self }
    }

    /// The distances at which the ray enters and leaves a box, within its own limits; nothing
    /// where it misses the box by more than rounding.
    pub fn through(&self, aabb: &Aabb) -> Option<[f64; 2]> {
        let slack = SLACK * f64::from(aabb.min.abs().max(aabb.max.abs()).max_element());
        let (least, most) = (aabb.min.as_dvec3() - slack, aabb.max.as_dvec3() + slack);
        let (mut enters, mut leaves) = (self.min, self.max);
        for axis in 0..3 {
            let (origin, step) = (self.origin[axis], self.direction[axis]);
            let ends = [least[axis] - origin, most[axis] - origin];
            if step == 0.0 {
                if ends[0] > 0.0 || ends[1] < 0.0 {
                    return None;
                }
                continue;
            }
            let ends = ends.map(|end| end / step);
            enters = enters.max(ends[0].min(ends[1]));
            leaves = leaves.min(ends[0].max(ends[1]));
        }
        (enters <= leaves && !aabb.is_empty()).then_some([enters, leaves])
    }

    /// The distance before which nothing inside `bound` can be met; nothing where the ray
    /// misses its box or its sphere.
    pub fn enters(&self, bound: &Bound) -> Option<f64> {
        let [enters, _] = self.through(&bound.aabb)?;
        let sphere = &bound.sphere;
        let away = sphere.center.as_dvec3() - self.origin;
        // The point of the whole line that is nearest to the middle.
        let nearest = away.dot(self.direction) / self.direction.length_squared();
        let gap = (away - self.direction * nearest).length_squared();
        let slack = SLACK * f64::from(sphere.center.abs().max_element() + sphere.radius);
        let radius = f64::from(sphere.radius) + slack;
        (gap <= radius * radius).then_some(enters)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_box() -> Bound {
        Bound::of_box(Aabb { min: Vec3::splat(-1.0), max: Vec3::ONE })
    }

    #[test]
    fn a_ray_enters_and_leaves_a_box() {
        let ray = Ray::new(Vec3::new(-5.0, 0.0, 0.0), Vec3::X * 10.0);
        let [enters, leaves] = ray.through(&unit_box().aabb).unwrap();
        assert!((enters - 4.0).abs() < 1e-4 && (leaves - 6.0).abs() < 1e-4, "{enters} {leaves}");
        assert_eq!(ray.between(0.0, 3.0).through(&unit_box().aabb), None);
        assert_eq!(ray.between(7.0, 9.0).through(&unit_box().aabb), None);
        assert_eq!(Ray::new(Vec3::new(-5.0, 1.1, 0.0), Vec3::X).through(&unit_box().aabb), None);
        assert_eq!(ray.through(&Aabb::EMPTY), None);
    }

    #[test]
    fn distances_stay_metres_in_other_frames() {
        let ray = Ray::new(Vec3::new(0.0, 0.0, 5.0), Vec3::NEG_Z);
        let frame = DAffine3::from_scale(DVec3::splat(0.01));
        let small = ray.transformed(&frame);
        assert_eq!(small.at(5.0), DVec3::ZERO);
    }

    #[test]
    fn a_sphere_cuts_the_corners_of_the_box() {
        let mut ball = unit_box();
        ball.sphere.radius = 1.0;
        let ray = Ray::new(Vec3::new(-5.0, 0.9, 0.9), Vec3::X);
        assert!(ray.enters(&unit_box()).is_some());
        assert_eq!(ray.enters(&ball), None);
    }

    #[test]
    fn rays_without_direction_are_not_sound() {
        assert!(!Ray::new(Vec3::ZERO, Vec3::ZERO).is_sound());
        assert!(!Ray::new(Vec3::ZERO, Vec3::NAN).is_sound());
        assert!(!Ray::new(Vec3::NAN, Vec3::X).is_sound());
        assert!(!Ray::new(Vec3::ZERO, Vec3::X).between(2.0, 1.0).is_sound());
        assert!(!Ray::new(Vec3::ZERO, Vec3::X).between(f32::NAN, 1.0).is_sound());
        assert!(Ray::new(Vec3::ZERO, Vec3::X * 1e-30).is_sound());
    }
}
