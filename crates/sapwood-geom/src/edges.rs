//! The edges of a mesh, as lines.

use std::collections::BTreeSet;

use crate::{Mesh, Polyline};

impl Mesh {
    /// Every edge of the triangles once, strung together into lines without thickness.
    ///
    /// Vertices count by their number: where a mesh has two vertices at one point, as along the
    /// seams of texture coordinates, it has two edges there. Costs O(n log n).
    pub fn edges(&self) -> Vec<Polyline> {
        let triangles = self.indices.chunks_exact(3);
        let sides = triangles.flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]);
        let mut sides: Vec<[u32; 2]> = sides.map(|[a, b]| [a.min(b), a.max(b)]).collect();
        sides.sort_unstable();
        sides.dedup();
        let mut ways = Ways::new(self.n_vertices(), &sides);
        let mut lines = Vec::new();
        for start in 0..self.n_vertices() as u32 {
            while let Some(first) = ways.take(start) {
                let mut trail = vec![start, first];
                while let Some(next) = trail.last().and_then(|at| ways.take(*at)) {
                    trail.push(next);
                }
                let points = trail.iter().map(|vertex| self.positions[*vertex as usize]);
                lines.push(Polyline { points: points.collect(), radii: vec![0.0; trail.len()] });
            }
        }
        lines
    }
}

/// The ways from each vertex to others that were not gone yet.
struct Ways(Vec<BTreeSet<u32>>);

impl Ways {
    fn new(n_vertices: usize, sides: &[[u32; 2]]) -> Self {
        let mut ways = vec![BTreeSet::new(); n_vertices];
        for &[a, b] in sides.iter().filter(|[a, b]| a != b) {
            ways[a as usize].insert(b);
            ways[b as usize].insert(a);
        }
        Self(ways)
    }

    /// Goes the first way from a vertex that is left, and tells where it leads.
    fn take(&mut self, from: u32) -> Option<u32> {
        let to = self.0[from as usize].pop_first()?;
        self.0[to as usize].remove(&from);
        Some(to)
    }
}

#[cfg(test)]
mod tests {
    use glam::{Vec2, Vec3};

    use super::*;

    #[test]
    fn each_edge_is_there_once() {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let square = Mesh {
            positions: corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec(),
            normals: vec![Vec3::Z; 4],
            uvs: vec![Vec2::ZERO; 4],
            indices: vec![0, 1, 2, 0, 2, 3],
        };
        let lines = square.edges();
        let n_edges: usize = lines.iter().map(|line| line.points.len() - 1).sum();
        assert_eq!(n_edges, 5);
        let length: f32 = lines
            .iter()
            .flat_map(|line| line.points.windows(2).map(|pair| pair[0].distance(pair[1])))
            .sum();
        assert!((length - 4.0 - std::f32::consts::SQRT_2).abs() < 1e-6, "{length}");
        assert!(lines.iter().all(|line| line.radii.len() == line.points.len()));
    }

    #[test]
    fn nothing_has_no_edges() {
        assert!(Mesh::default().edges().is_empty());
    }
}
