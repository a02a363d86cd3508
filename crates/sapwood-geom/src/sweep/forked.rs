//! Walls that leave a fork: inner points, and the triangles from them to the next ring.

use glam::Vec3;

use super::write::Forking;
use super::{Laid, Sweep};
use crate::{Mesh, Section};

/// How one tube stands on a fork.
pub(super) struct Inward<'a> {
    parted: &'a Forking<'a>,
    sides: u32,
    /// The first vertex of the ring itself.
    ring: u32,
    /// For each inner side, in order, its two vertices.
    ends: Vec<[u32; 2]>,
    /// The first vertex that was added.
    first: u32,
    /// For each vertex that was added, which of the different points in order it stands on.
    points: Vec<u32>,
}

impl Forking<'_> {
    /// Whether the tube begins at vertices that are there, instead of with its own row `row`.
    pub(super) fn starts(&self, row: u32, sweep: &Sweep) -> bool {
        self.vertices.is_some() && sweep.rows.get(self.ring) == Some(&row)
    }
}

impl Sweep {
    /// Adds the vertices of a tube's inner sides at a fork: they are not the ring's own, for the
    /// walls are creased there.
    pub(super) fn turn_inward<'a>(
        &self,
        section: &Section,
        laid: &Laid,
        parted: &'a Forking<'a>,
        ring: u32,
        mesh: &mut Mesh,
    ) -> Inward<'a> {
        let sides = section.n_sides();
        let foot = parted.fork.foot(parted.tube);
        let (px, py) = (laid.x * laid.radius, laid.tangent.cross(laid.x) * laid.radius);
        let first = mesh.positions.len() as u32;
        let mut points = Vec::with_capacity(foot.points.len() + 1);
        let mut add = |point: u32, place: u32, number: u32| {
            let p = parted.fork.point(section, point);
            mesh.positions.push(laid.center + px * p.x + py * p.y);
            mesh.normals.push(Vec3::ZERO);
            mesh.uvs.push(self.uv_at(section, laid, place));
            points.push(number);
            first + points.len() as u32 - 1
        };
        let mut number = 0;
        let mut at = add(foot.points[0], foot.first, number);
        let mut ends = Vec::with_capacity(foot.points.len() - 1);
        for (i, step) in (0..).zip(foot.points.windows(2)) {
            let place = (foot.first + i) % sides;
            if place == 0 && i > 0 {
                // The texture begins anew.
                at = add(step[0], 0, number);
            }
            let from = at;
            if step[1] != step[0] {
                number += 1;
                at = add(step[1], place + 1, number);
            }
            ends.push([from, at]);
        }
        Inward { parted, sides, ring, ends, first, points }
    }
}

impl Inward<'_> {
    /// Writes the triangles to the ring, or the point, whose vertices begin at `next`, and the
    /// normals of the inner sides: those of the triangles, weighed by area.
    pub(super) fn write_walls(self, next: u32, is_point: bool, mesh: &mut Mesh) {
        let Self { parted, sides, ring, ends, first, points } = self;
        let foot = parted.fork.foot(parted.tube);
        let mut sums = vec![Vec3::ZERO; points.len()];
        for side in 0..sides {
            let inner = ((side + sides - foot.first) % sides) as usize;
            let ends = ends.get(inner);
            let [a, b] = ends.copied().unwrap_or([ring + side, ring + side + 1]);
            let up = next + side;
            let below = (a != b).then_some([a, b, up]);
            let above = (!is_point).then_some([b, up + 1, up]);
            for corners in [below, above].into_iter().flatten() {
                mesh.indices.extend(corners);
                if ends.is_none() {
                    continue;
                }
                let [p, q, r] = corners.map(|i| mesh.positions[i as usize]);
                let face = (q - p).cross(r - p);
                for corner in corners {
                    // The next ring's vertices come after those at the fork.
                    let added = corner.checked_sub(first).map(|i| i as usize);
                    if let Some(point) = added.and_then(|i| points.get(i)) {
                        sums[*point as usize] += face;
                    }
                }
            }
        }
        for (i, point) in points.iter().enumerate() {
            let normal = sums[*point as usize].normalize_or(Vec3::Z);
            mesh.normals[first as usize + i] = normal;
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;
    use crate::{Cap, Fork, Ring, SweepOptions};

    /// A tube from a foot of some radius, and another that leaves it at its second ring.
    fn forked(foot: f32, tip: f32) -> Mesh {
        let section = Section::round(7);
        let ring = |x, z, radius| Ring { center: Vec3::new(x, 0.0, z), radius };
        let trunk = [ring(0.0, 0.0, foot), ring(0.0, 1.0, 0.2), ring(-0.5, 2.0, tip)];
        let options = SweepOptions { base: Cap::Flat, ..SweepOptions::default() };
        let fork = Fork::new(&section, &[Vec2::NEG_X, Vec2::X]).unwrap();
        let (mut mesh, mut vertices) = (Mesh::default(), Vec::new());
        let mut sweep = Sweep::default();
        let mut n = sweep.lay(&section, &trunk, &options);
        let start = sweep.start_at(1).unwrap();
        let mut forking = Forking { ring: 1, fork: &fork, tube: 0, vertices: None };
        sweep.write_forking(&section, &[forking], &mut mesh, &mut vertices);
        let clone = [trunk[1], ring(0.6, 2.0, tip)];
        n += sweep.lay(&section, &clone, &SweepOptions { start, ..SweepOptions::default() });
        forking = Forking { ring: 0, fork: &fork, tube: 1, vertices: Some(vertices[0]) };
        sweep.write_forking(&section, &[forking], &mut mesh, &mut vertices);
        assert_eq!(vertices[0], vertices[1]);
        assert_eq!(mesh.n_triangles(), n - fork.n_narrow(0) - fork.n_narrow(1));
        mesh
    }

    #[test]
    fn forked_tubes_are_closed() {
        for (foot, tip) in [(0.2, 0.1), (0.2, 0.0), (0.0, 0.1), (0.0, 0.0)] {
            let mesh = forked(foot, tip);
            assert_eq!((mesh.fault(), mesh.n_open_edges()), (None, 0), "{foot} {tip}");
            for t in mesh.indices.chunks_exact(3) {
                let [a, b, c] = [t[0], t[1], t[2]].map(|i| mesh.positions[i as usize]);
                let face = (b - a).cross(c - a);
                assert!(t.iter().all(|i| face.dot(mesh.normals[*i as usize]) > 0.0));
            }
        }
    }
}
