//! How a ray is seen from a frame, and the interest in what it may meet.

use std::cell::Cell;

use sapwood_geom::glam::Affine3;
use sapwood_geom::{Aabb, Bound, Ray};

use super::{Hit, PickOptions};
use crate::{Approach, Interest};

/// A ray as it is seen from a frame.
#[derive(Clone, Copy)]
pub(super) struct Sight {
    /// The ray in the root's frame.
    pub(super) outside: Ray,
    pub(super) world: Affine3,
    /// The ray in this frame; nothing where the frame is flat, so that nobody can be inside it.
    pub(super) inside: Option<Ray>,
}

/// The volume of a frame's unit cube over that of a cube with the same edges, below which the
/// frame counts as flat: `f32` tells no more.
const FLAT: f64 = 1e-6;

impl Sight {
    pub(super) fn new(ray: &Ray, world: &Affine3) -> Self {
        let frame = world.as_daffine3();
        let axes = frame.matrix3;
        let cube = axes.x_axis.length() * axes.y_axis.length() * axes.z_axis.length();
        let is_flat = axes.determinant().abs() <= FLAT * cube || !frame.is_finite();
        let inside = (!is_flat).then(|| ray.transformed(&frame.inverse()));
        Self { outside: *ray, world: *world, inside }
    }

    /// The distance before which nothing inside `bound`, in this frame, can be met by a ray
    /// that may pass by at `by` metres; nothing where it misses the bound.
    pub(super) fn enters(&self, bound: &Bound, by: f32) -> Option<f64> {
        match &self.inside {
            Some(ray) if by == 0.0 => ray.enters(bound),
            _ => self.outside.enters(&grown(bound.transformed(&self.world), by)),
        }
    }
}

fn grown(mut bound: Bound, by: f32) -> Bound {
    if by > 0.0 && !bound.is_empty() {
        let Aabb { min, max } = bound.aabb;
        bound.aabb = Aabb { min: min - by, max: max + by };
        bound.sphere.radius += by;
    }
    bound
}

impl PickOptions {
    /// How many metres the ray may pass by.
    pub(super) fn by(&self) -> f32 {
        self.line_radius.unwrap_or(0.0).max(0.0)
    }
}

/// The interest in what a ray may meet.
///
/// Children whose bound is unknown are gone into, so that their bound becomes known.
pub struct AlongRay {
    by: f32,
    /// Siblings are seen from the same frame.
    sight: Cell<Sight>,
}

impl AlongRay {
    /// The interest in what `ray`, in the root's frame, may meet before the hit known so far.
    pub fn new(ray: &Ray, options: &PickOptions, known: Option<&Hit>) -> Self {
        let reach = known.map_or(ray.max(), |hit| just_behind(hit.distance));
        let sight = Sight::new(&ray.up_to(reach), &Affine3::IDENTITY);
        Self { by: options.by(), sight: Cell::new(sight) }
    }
}

/// A little farther than a hit, whose distance is rounded and may lie behind the ray's origin.
fn just_behind(distance: f32) -> f64 {
    let distance = f64::from(distance);
    distance + 1e-6 * distance.abs() + f64::from(f32::MIN_POSITIVE)
}

impl Interest for AlongRay {
    type State = ();

    fn start(&self) {}

    fn enter(&self, (): &(), child: &Approach<'_>) -> Option<()> {
        let Some(bound) = child.bound else { return Some(()) };
        let mut sight = self.sight.get();
        if sight.world != *child.world {
            sight = Sight::new(&sight.outside, child.world);
            self.sight.set(sight);
        }
        sight.enters(bound, self.by).map(|_| ())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_as_near_as_a_hit_at_a_negative_distance_stays_in_reach() {
        for distance in [-5.0f32, -1e-30, 0.0, 1e-30, 5.0] {
            assert!(just_behind(distance) > f64::from(distance), "{distance}");
        }
    }
}
