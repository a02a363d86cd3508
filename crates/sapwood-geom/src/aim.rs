//! Rays in single precision, made ready to be tested against many triangles.

use glam::Vec3;

use crate::Ray32;

/// A ray with the axis that it mostly goes along, and how far it goes along the other two
/// meanwhile (S. Woop, C. Benthin, I. Wald: "Watertight Ray/Triangle Intersection", 2013).
///
/// Points are looked at along the ray, which is then a point itself. Where they lie beside it is as
/// exact as the numbers that they are told by, however far away the ray begins: products of
/// numbers as large as that distance, whose differences would be rounded to more than a small
/// triangle, are never formed.
#[derive(Clone, Copy, Debug)]
pub struct Aim {
    ray: Ray32,
    /// The two axes across, so that they stand counter-clockwise to whoever looks back along the
    /// ray, and the one along.
    axes: [usize; 3],
    shear: [f32; 2],
}

impl Aim {
    /// Makes a ray ready.
    #[inline]
    pub fn new(ray: Ray32) -> Self {
        let [x, y, z] = ray.direction.abs().to_array();
        let along = if x > y && x > z { 0 } else { 1 + usize::from(z >= y) };
        let (next, last) = ((along + 1) % 3, (along + 2) % 3);
        let step = ray.direction;
        let [right, up] = if step[along] < 0.0 { [last, next] } else { [next, last] };
        let shear = [step[right] / step[along], step[up] / step[along]];
        Self { ray, axes: [right, up, along], shear }
    }

    /// The ray.
    #[inline]
    pub fn ray(&self) -> &Ray32 {
        &self.ray
    }

    /// The two axes across and the one along, and by how much points move along the first two with
    /// each metre along the third.
    #[inline]
    pub(crate) fn axes(&self) -> ([usize; 3], [f32; 2]) {
        (self.axes, self.shear)
    }

    /// Where a point that is told from the ray's origin lies beside the ray.
    #[inline]
    pub(crate) fn beside(&self, point: Vec3) -> [f32; 2] {
        let ([right, up, along], [x, y]) = (self.axes, self.shear);
        [point[right] - x * point[along], point[up] - y * point[along]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mesh, MeshHit32, TrianglePack};

    #[test]
    fn what_lies_on_the_ray_is_seen_as_a_point() {
        for direction in [Vec3::new(0.2, -0.5, 0.9), Vec3::new(-3.0, 1.0, 2.0), Vec3::NEG_Y] {
            let aim = Aim::new(Ray32::new(Vec3::ONE, direction));
            let [x, y] = aim.beside(direction * 4.0);
            assert!(x.abs().max(y.abs()) < 1e-5, "{direction}: {x} {y}");
        }
    }

    #[test]
    fn narrow_triangles_are_met_from_far_away_where_they_are() {
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::new(0.08, 0.0, 0.0), Vec3::new(0.04, 0.01, 0.0)],
            indices: vec![0, 1, 2],
            ..Mesh::default()
        };
        let pack = TrianglePack::of(&mesh, &[0]).next().unwrap();
        let mut n_wrong = 0;
        for i in 0..400 {
            let turn = i as f32 * 0.618;
            let toward = Vec3::new(turn.sin(), 0.4 * turn.cos(), 1.0).normalize();
            // Every other one passes by.
            let inside = i % 2 == 0;
            let at = Vec3::new(0.04, if inside { 0.004 } else { 0.014 }, 0.0);
            let aim = Aim::new(Ray32::new(at + toward * 1000.0, -toward));
            let hit = MeshHit32::on(&mesh, &aim, 0);
            assert_eq!(pack.on_the_way(&aim).count(), usize::from(hit.is_some()));
            n_wrong += u32::from(hit.is_some() != inside);
            assert!(hit.is_none_or(|hit| hit.is_front && (hit.distance - 1000.0).abs() < 0.01));
        }
        assert_eq!(n_wrong, 0);
    }
}
