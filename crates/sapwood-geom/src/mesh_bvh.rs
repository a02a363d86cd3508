//! Where rays meet meshes.
//!
//! The test of a triangle leaves no gap between triangles that share an edge (S. Woop, C.
//! Benthin, I. Wald: "Watertight Ray/Triangle Intersection", JCGT 2013, here in `f64`).

use std::ops::Range;

use glam::{DAffine3, DVec3, Vec3};

use crate::{Aabb, Aim, BoxTree, Mesh, Ray};

/// A tree over a mesh's triangles, so that a ray looks at few of them.
#[derive(Debug)]
pub struct MeshBvh(BoxTree);

/// Which sides of triangles a ray meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// Both.
    Both,
    /// Those that wind counter-clockwise seen from where the ray comes from.
    Front,
}

/// Where a ray meets a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshHit {
    /// Metres along the ray.
    pub distance: f64,
    /// The number of the triangle.
    pub triangle: u32,
    /// How much each corner of the triangle weighs at the hit; together 1.
    pub weights: [f64; 3],
    /// Whether the triangle winds counter-clockwise seen from where the ray comes from.
    pub is_front: bool,
}

impl MeshHit {
    /// Whether this hit goes before another one: it is nearer, or as near on an earlier triangle.
    fn precedes(&self, other: Option<&Self>) -> bool {
        other.is_none_or(|other| (self.distance, self.triangle) < (other.distance, other.triangle))
    }
}

impl MeshBvh {
    /// The tree over all triangles of `mesh`, which must be sound; those with a corner that is
    /// not finite are never met.
    pub fn new(mesh: &Mesh) -> Self {
        let boxes = mesh.indices.chunks_exact(3).map(|triangle| {
            Aabb::of_points(triangle.iter().map(|index| mesh.positions[*index as usize]))
        });
        Self(BoxTree::new(boxes))
    }

    /// The nearest hit within `reach` on the mesh that the tree was made of, both in the mesh's
    /// frame; where several are as near, that on the triangle with the smallest number.
    pub fn closest(&self, mesh: &Mesh, ray: &Ray, reach: f64, sides: Sides) -> Option<MeshHit> {
        self.closest_where(mesh, ray, reach, sides, |_| true)
    }

    /// As [`closest`](Self::closest), on those triangles alone that `counts` is true for.
    pub fn closest_where(
        &self,
        mesh: &Mesh,
        ray: &Ray,
        reach: f64,
        sides: Sides,
        counts: impl Fn(u32) -> bool,
    ) -> Option<MeshHit> {
        let line = Line::new(ray)?;
        let mut closest: Option<MeshHit> = None;
        self.0.along(ray, reach, |triangle| {
            let hit = if counts(triangle) { line.meet(mesh, triangle, None, sides) } else { None };
            if let Some(hit) =
                hit.filter(|hit| hit.distance <= reach && hit.precedes(closest.as_ref()))
            {
                closest = Some(hit);
            }
            closest.map_or(reach, |hit| hit.distance)
        });
        closest
    }
}

/// Where a ray in single precision meets a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshHit32 {
    /// In lengths of the ray's direction.
    pub distance: f32,
    /// The number of the triangle.
    pub triangle: u32,
    /// How much each corner of the triangle weighs at the hit; together 1.
    pub weights: Vec3,
    /// Whether the triangle winds counter-clockwise seen from where the ray comes from.
    pub is_front: bool,
}

/// Triangles as they lie together in the tree.
impl MeshBvh {
    /// Every triangle that may be met, in groups of a few neighbours.
    pub fn groups(&self) -> impl Iterator<Item = &[u32]> {
        self.0.leaves()
    }
}

/// Rays in single precision.
impl MeshBvh {
    /// The nearest hit before `reach` that `accept` agrees to, on the mesh that the tree was made
    /// of; where several are as near, that on the triangle with the smallest number.
    pub fn nearest32(
        &self,
        mesh: &Mesh,
        aim: &Aim,
        reach: f32,
        mut accept: impl FnMut(&MeshHit32) -> bool,
    ) -> Option<MeshHit32> {
        let mut nearest: Option<MeshHit32> = None;
        let mut limit = reach;
        self.0.along32(aim.ray(), reach, |triangle| {
            if let Some(hit) = MeshHit32::on(mesh, aim, triangle)
                && (hit.distance < limit
                    || nearest.is_some_and(|old| (hit.distance, triangle) < (limit, old.triangle)))
                && accept(&hit)
            {
                limit = hit.distance;
                nearest = Some(hit);
            }
            limit
        });
        nearest
    }

    /// Whether there is any hit before `reach` that `accept` agrees to.
    pub fn is_met32(
        &self,
        mesh: &Mesh,
        aim: &Aim,
        reach: f32,
        mut accept: impl FnMut(&MeshHit32) -> bool,
    ) -> bool {
        let mut is_met = false;
        self.0.along32(aim.ray(), reach, |triangle| {
            is_met = is_met
                || MeshHit32::on(mesh, aim, triangle)
                    .is_some_and(|hit| hit.distance < reach && accept(&hit));
            if is_met { -1.0 } else { reach }
        });
        is_met
    }
}

impl MeshHit32 {
    /// Where the ray meets a triangle of a sound mesh. On which side of an edge it passes is asked
    /// of the same two corners on both triangles of the edge, so that nothing slips through
    /// between them.
    #[inline]
    pub fn on(mesh: &Mesh, aim: &Aim, triangle: u32) -> Option<Self> {
        let ray = aim.ray();
        let first = 3 * triangle as usize;
        let corner = |i| mesh.positions[mesh.indices[first + i] as usize] - ray.origin;
        let (a, b, c) = (corner(0), corner(1), corner(2));
        let seen = [a, b, c].map(|corner| aim.beside(corner));
        let area = |from: usize, to: usize| {
            let ([x, y], [other_x, other_y]) = (seen[from], seen[to]);
            x * other_y - other_x * y
        };
        let weights = Vec3::new(area(2, 1), area(0, 2), area(1, 0));
        let is_front = weights.min_element() >= 0.0;
        if !is_front && weights.max_element() > 0.0 {
            return None;
        }
        let whole = weights.element_sum();
        let weights = weights / whole;
        let normal = (b - a).cross(c - a);
        let distance = a.dot(normal) / ray.direction.dot(normal);
        // Thin triangles, seen along their plane, have no distance.
        (distance >= 0.0 && distance.is_finite() && weights.is_finite()).then_some(Self {
            distance,
            triangle,
            weights,
            is_front,
        })
    }
}

/// The nearest hit within `reach` on a mesh after a transform that may flatten it, with the ray
/// in the frame outside; looks at each of `triangles`.
pub fn closest_on_transformed(
    mesh: &Mesh,
    triangles: Range<u32>,
    transform: &DAffine3,
    ray: &Ray,
    reach: f64,
    sides: Sides,
) -> Option<MeshHit> {
    let line = Line::new(ray)?;
    let mut closest: Option<MeshHit> = None;
    for triangle in triangles {
        let hit = line.meet(mesh, triangle, Some(transform), sides);
        if let Some(hit) = hit.filter(|hit| hit.distance <= reach && hit.precedes(closest.as_ref()))
        {
            closest = Some(hit);
        }
    }
    closest
}

/// A ray made ready for many triangles: space is sheared so that it runs along one axis.
struct Line<'a> {
    ray: &'a Ray,
    /// The axes, that of the ray's largest step last.
    axes: [usize; 3],
    shear: DVec3,
}

impl<'a> Line<'a> {
    fn new(ray: &'a Ray) -> Option<Self> {
        let step = ray.direction();
        let z = step.abs().max_position();
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        let shear = DVec3::new(step[axes[0]] / step[z], step[axes[1]] / step[z], 1.0 / step[z]);
        shear.is_finite().then_some(Self { ray, axes, shear })
    }

    /// Where the line meets a triangle within the ray's own limits.
    fn meet(
        &self,
        mesh: &Mesh,
        triangle: u32,
        transform: Option<&DAffine3>,
        sides: Sides,
    ) -> Option<MeshHit> {
        let first = 3 * triangle as usize;
        let corners = [0, 1, 2].map(|i| {
            let corner = mesh.positions[mesh.indices[first + i] as usize].as_dvec3();
            transform.map_or(corner, |transform| transform.transform_point3(corner))
        });
        let [x, y, z] = self.axes;
        let [a, b, c] = corners.map(|corner| {
            let away = corner - self.ray.origin();
            let along = away[z];
            let (x, y) = (away[x] - self.shear.x * along, away[y] - self.shear.y * along);
            DVec3::new(x, y, self.shear.z * along)
        });
        let edges = [c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x];
        let is_outside =
            edges.iter().any(|edge| *edge < 0.0) && edges.iter().any(|edge| *edge > 0.0);
        let whole: f64 = edges.iter().sum();
        if is_outside || whole == 0.0 || !whole.is_finite() {
            return None;
        }
        let weights = edges.map(|edge| edge / whole);
        let distance = weights[0] * a.z + weights[1] * b.z + weights[2] * c.z;
        if !(self.ray.min() <= distance && distance <= self.ray.max()) {
            return None;
        }
        let [a, b, c] = corners;
        let mirrors = transform.is_some_and(|transform| transform.matrix3.determinant() < 0.0);
        let is_front = ((b - a).cross(c - a).dot(self.ray.direction()) < 0.0) != mirrors;
        let is_met = is_front || sides == Sides::Both;
        is_met.then_some(MeshHit { distance, triangle, weights, is_front })
    }
}

#[cfg(test)]
mod tests {
    use glam::{Vec2, Vec3};

    use super::*;
    use crate::Ray32;

    /// A square of `n` by `n` cells in the plane z = 0, from the origin to (1, 1).
    fn square(n: u32) -> Mesh {
        let mut mesh = Mesh::default();
        for i in 0..(n + 1) * (n + 1) {
            let uv = Vec2::new((i % (n + 1)) as f32, (i / (n + 1)) as f32) / n as f32;
            mesh.positions.push(uv.extend(0.0));
            mesh.normals.push(Vec3::Z);
            mesh.uvs.push(uv);
        }
        for cell in 0..n * n {
            let a = cell % n + (cell / n) * (n + 1);
            let c = a + n + 1;
            mesh.indices.extend([a, a + 1, c, a + 1, c + 1, c]);
        }
        mesh
    }

    fn closest(mesh: &Mesh, ray: &Ray) -> Option<MeshHit> {
        let bvh = MeshBvh::new(mesh);
        let hit = bvh.closest(mesh, ray, f64::INFINITY, Sides::Both);
        let slow = closest_on_transformed(
            mesh,
            0..mesh.n_triangles() as u32,
            &DAffine3::IDENTITY,
            ray,
            f64::INFINITY,
            Sides::Both,
        );
        assert_eq!(hit, slow);
        hit
    }

    #[test]
    fn edges_and_corners_have_no_gaps() {
        let mesh = square(8);
        for i in 0..=32 {
            for j in 0..=32 {
                let over = Vec3::new(i as f32 / 32.0, j as f32 / 32.0, 3.0);
                let hit = closest(&mesh, &Ray::new(over, Vec3::NEG_Z)).unwrap();
                assert!((hit.distance - 3.0).abs() < 1e-12 && hit.is_front);
            }
        }
    }

    #[test]
    fn where_triangles_are_as_near_the_first_is_met() {
        let mut mesh = square(1);
        mesh.indices.extend_from_within(..);
        let hit = closest(&mesh, &Ray::new(Vec3::new(0.2, 0.2, 1.0), Vec3::NEG_Z)).unwrap();
        assert_eq!(hit.triangle, 0);
    }

    #[test]
    fn backs_are_met_on_request() {
        let (mesh, ray) = (square(4), Ray::new(Vec3::new(0.3, 0.3, -1.0), Vec3::Z));
        assert!(!closest(&mesh, &ray).unwrap().is_front);
        let bvh = MeshBvh::new(&mesh);
        assert_eq!(bvh.closest(&mesh, &ray, f64::INFINITY, Sides::Front), None);
    }

    #[test]
    fn rays_keep_to_their_limits() {
        let (mesh, ray) = (square(4), Ray::new(Vec3::new(0.3, 0.3, 2.0), Vec3::NEG_Z));
        assert_eq!(closest(&mesh, &ray.between(0.0, 1.9)), None);
        assert_eq!(closest(&mesh, &ray.between(2.1, 9.0)), None);
        assert!(closest(&mesh, &ray.between(2.0, 2.0)).is_some());
        assert_eq!(MeshBvh::new(&mesh).closest(&mesh, &ray, 1.0, Sides::Both), None);
    }

    #[test]
    fn rays_in_single_precision_meet_the_same() {
        let mesh = square(8);
        let bvh = MeshBvh::new(&mesh);
        for i in 0..=32 {
            for j in 0..=32 {
                let over = Vec3::new(i as f32 / 32.0, j as f32 / 32.0, 3.0);
                let slant = Vec3::new(0.3 - over.x, 0.6 - over.y, -3.0);
                for direction in [Vec3::NEG_Z, slant] {
                    let ray = Ray32::new(over, direction);
                    let aim = Aim::new(ray);
                    let hit = bvh.nearest32(&mesh, &aim, f32::INFINITY, |_| true).unwrap();
                    let precise = closest(&mesh, &Ray::new(over, direction)).unwrap();
                    let metres = hit.distance * direction.length();
                    assert!((metres - precise.distance as f32).abs() < 1e-5 && hit.is_front);
                    assert!(bvh.is_met32(&mesh, &aim, 1.1 * hit.distance, |_| true));
                    assert!(!bvh.is_met32(&mesh, &aim, 0.9 * hit.distance, |_| true));
                    assert!(!bvh.is_met32(&mesh, &aim, f32::INFINITY, |_| false));
                    let corners = [0, 1, 2].map(|k| mesh.indices[3 * hit.triangle as usize + k]);
                    let [a, b, c] = corners.map(|corner| mesh.positions[corner as usize]);
                    let weighted = a * hit.weights.x + b * hit.weights.y + c * hit.weights.z;
                    assert!(weighted.distance(ray.at(hit.distance)) < 1e-5);
                }
            }
        }
        let below = Aim::new(Ray32::new(Vec3::new(0.3, 0.3, -1.0), Vec3::Z));
        assert!(!bvh.nearest32(&mesh, &below, 9.0, |_| true).unwrap().is_front);
    }

    #[test]
    fn corners_that_are_no_numbers_are_passed_by() {
        let mut mesh = square(8);
        mesh.positions[3] = Vec3::NAN;
        let hit = closest(&mesh, &Ray::new(Vec3::new(0.9, 0.9, 1.0), Vec3::NEG_Z));
        assert!(hit.is_some());
    }
}
