//! Four triangles side by side, so that a ray meets or misses them in one go.

use glam::{Affine3, Vec3};
use wide::f32x4;

use crate::{Aabb, Aim, Mesh};

/// Triangles that a pack holds.
const WIDTH: usize = 4;

/// Up to four triangles of a mesh.
///
/// A pack only tells which of them a ray may meet; [`MeshHit32::on`](crate::MeshHit32::on) tells
/// where. Both reckon alike, so that a pack leaves out nothing that is met.
#[derive(Clone, Copy, Debug)]
pub struct TrianglePack {
    /// The coordinates of the first corners, of the second and of the third; no numbers where a
    /// triangle is missing.
    corners: [[f32x4; 3]; 3],
    /// The triangles' numbers on the mesh.
    triangles: [u32; WIDTH],
}

impl TrianglePack {
    /// Triangles of a sound mesh by their numbers, four to a pack.
    pub fn of<'a>(
        mesh: &'a Mesh,
        triangles: &'a [u32],
    ) -> impl ExactSizeIterator<Item = Self> + 'a {
        triangles.chunks(WIDTH).map(|some| {
            let mut corners = [[[f32::NAN; WIDTH]; 3]; 3];
            let mut numbers = [u32::MAX; WIDTH];
            for (lane, triangle) in some.iter().enumerate() {
                numbers[lane] = *triangle;
                for (corner, coordinates) in corners.iter_mut().enumerate() {
                    let index = mesh.indices[3 * *triangle as usize + corner];
                    let position = mesh.positions[index as usize];
                    for (axis, lanes) in coordinates.iter_mut().enumerate() {
                        lanes[lane] = position[axis];
                    }
                }
            }
            let corners = corners.map(|coordinates| coordinates.map(f32x4::new));
            Self { corners, triangles: numbers }
        })
    }

    /// The numbers of those triangles that the ray's line goes through, in their order.
    #[inline]
    pub fn on_the_way(&self, aim: &Aim) -> impl Iterator<Item = u32> + '_ {
        let origin = aim.ray().origin;
        let ([right, up, along], [shear_x, shear_y]) = aim.axes();
        // In the order in which `MeshHit32::on` reckons.
        let [a, b, c] = self.corners.map(|corner| {
            let [x, y, z] =
                [right, up, along].map(|axis| corner[axis] - f32x4::splat(origin[axis]));
            [x - f32x4::splat(shear_x) * z, y - f32x4::splat(shear_y) * z]
        });
        let area = |[x, y]: [f32x4; 2], [other_x, other_y]: [f32x4; 2]| x * other_y - other_x * y;
        let weights = [area(c, b), area(a, c), area(b, a)];
        let least = weights[0].fast_min(weights[1]).fast_min(weights[2]);
        let largest = weights[0].fast_max(weights[1]).fast_max(weights[2]);
        let mut is_met = (least.simd_ge(f32x4::ZERO) | largest.simd_le(f32x4::ZERO)).to_bitmask();
        std::iter::from_fn(move || {
            let lane = is_met.trailing_zeros() as usize;
            let triangle = *self.triangles.get(lane)?;
            is_met &= is_met - 1;
            Some(triangle)
        })
        // A missing one is never met, but may look so where the ray itself is no number.
        .filter(|triangle| *triangle != u32::MAX)
    }

    /// The box around all after a transform.
    pub fn aabb(&self, transform: &Affine3) -> Aabb {
        let mut aabb = Aabb::EMPTY;
        for coordinates in &self.corners {
            let [x, y, z] = coordinates.map(f32x4::to_array);
            for lane in (0..WIDTH).filter(|lane| self.triangles[*lane] != u32::MAX) {
                let corner = Vec3::new(x[lane], y[lane], z[lane]);
                aabb = aabb.union(Aabb::of_points([transform.transform_point3(corner)]));
            }
        }
        aabb
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MeshHit32, Ray32};

    /// A fan of `n` triangles around the z axis, each with its own tilt.
    fn fan(n: u32) -> Mesh {
        let mut mesh = Mesh::default();
        for i in 0..n {
            let at = |step: u32, z: f32| {
                let (y, x) = libm::sincosf(step as f32 * 6.0 / n as f32);
                Vec3::new(x, y, z)
            };
            let tilt = 0.1 * i as f32;
            mesh.positions.extend([Vec3::Z * tilt, at(i, 0.0), at(i + 1, tilt)]);
            mesh.indices.extend([3 * i, 3 * i + 1, 3 * i + 2]);
        }
        mesh
    }

    #[test]
    fn packs_leave_out_nothing_that_is_met() {
        let mesh = fan(7);
        let triangles: Vec<u32> = (0..7).collect();
        let packs: Vec<_> = TrianglePack::of(&mesh, &triangles).collect();
        assert_eq!(packs.len(), 2);
        let mut n_met = 0;
        for i in 0..400 {
            let over = Vec3::new((i % 20) as f32 / 10.0 - 1.0, (i / 20) as f32 / 10.0 - 1.0, 2.0);
            let aim = Aim::new(Ray32::new(over, Vec3::new(0.1, -0.2, -1.0)));
            let on_the_way: Vec<u32> =
                packs.iter().flat_map(|pack| pack.on_the_way(&aim)).collect();
            for triangle in &triangles {
                if MeshHit32::on(&mesh, &aim, *triangle).is_some() {
                    n_met += 1;
                    assert!(on_the_way.contains(triangle));
                }
            }
            let missed = on_the_way.iter().filter(|n| MeshHit32::on(&mesh, &aim, **n).is_none());
            assert_eq!(missed.count(), 0);
        }
        assert!(n_met > 200, "{n_met}");
    }

    #[test]
    fn corners_on_the_ray_and_rays_that_are_none_are_no_trouble() {
        let mesh = fan(3);
        let pack = TrianglePack::of(&mesh, &[0, 1, 2]).next().unwrap();
        let down = |x: f32| Aim::new(Ray32::new(Vec3::new(x, 0.0, 3.0), Vec3::NEG_Z));
        assert_eq!(pack.on_the_way(&down(0.0)).collect::<Vec<_>>(), [0, 1, 2]);
        assert_eq!(pack.on_the_way(&down(f32::NAN)).count(), 0);
        let nowhere = Aim::new(Ray32::new(Vec3::ZERO, Vec3::ZERO));
        assert_eq!(pack.on_the_way(&nowhere).count(), 0);
    }

    #[test]
    fn the_box_holds_all_triangles_and_no_others() {
        let mesh = fan(5);
        let packs: Vec<_> = TrianglePack::of(&mesh, &[0, 1, 2, 3, 4]).collect();
        let moved = Affine3::from_translation(Vec3::X * 4.0);
        let last = Aabb::of_points(mesh.positions[12..].iter().map(|p| *p + Vec3::X * 4.0));
        assert_eq!(packs[1].aabb(&moved), last);
    }
}
