//! The rims of holes: by how much the winding number may change between two places without a
//! triangle between them.
//!
//! A closed surface goes around places a whole number of times, which changes at triangles only.
//! With holes it changes everywhere; its gradient is that of the magnetic field of a current
//! along the rims (law of Biot and Savart), so it is limited by their length and distance.

use std::f64::consts::PI;

use glam::Vec3;

use super::region::Region;
use crate::{Aabb, BoxTree, FixedMap, fixed_state};

/// From so many times its size on, a group of edges counts as one.
const FAR: f64 = 2.0;

/// The edges at which triangles end with nothing beyond.
#[derive(Debug)]
pub(super) struct Rims {
    tree: BoxTree,
    /// The box of each edge, and its length times how many triangles are missing there.
    edges: Vec<(Aabb, f64)>,
    /// The length of all edges in a box.
    lengths: Vec<f64>,
}

impl Rims {
    /// The rims of triangles, given by the numbers of their corners among `positions`.
    pub(super) fn new(positions: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let mut uses: FixedMap<(u32, u32), i32> = FixedMap::with_hasher(fixed_state());
        for &[a, b, c] in triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *uses.entry((from.min(to), from.max(to))).or_default() +=
                    (to > from) as i32 - (to < from) as i32;
            }
        }
        let mut open: Vec<_> = uses.into_iter().filter(|(_, times)| *times != 0).collect();
        open.sort_unstable();
        let edges: Vec<_> = open
            .into_iter()
            .map(|((from, to), times)| {
                let ends = [from, to].map(|i| positions[i as usize]);
                let length = ends[0].as_dvec3().distance(ends[1].as_dvec3());
                (Aabb::of_points(ends), length * f64::from(times.unsigned_abs()))
            })
            .collect();
        let tree = BoxTree::new(edges.iter().map(|(aabb, _)| *aabb));
        let lengths = tree.summaries(0.0, |items, below| {
            let own: f64 = items.iter().map(|item| edges[*item as usize].1).sum();
            own + below.iter().sum::<f64>()
        });
        Self { tree, edges, lengths }
    }

    /// Whether there is no rim.
    pub(super) fn is_empty(&self) -> bool {
        self.edges.is_empty()
    }

    /// An upper limit of how much the winding number of any point in a region without triangles
    /// differs from that of the region's middle.
    pub(super) fn change(&self, region: &Region) -> f64 {
        let (center, radius) = (region.center(), region.radius());
        let distance = |aabb: &Aabb| {
            let (min, max) = (aabb.min.as_dvec3(), aabb.max.as_dvec3());
            (center.clamp(min, max).distance(center) - radius).max(0.0)
        };
        let field = |length: f64, distance: f64| length / (4.0 * PI * distance * distance);
        let (mut near, mut far) = (0.0, 0.0);
        let go = |place: usize, aabb: &Aabb| {
            let distance = distance(aabb);
            let is_far = distance > FAR * f64::from(aabb.size().length());
            if is_far {
                far += field(self.lengths[place], distance);
            }
            !is_far
        };
        self.tree.descend(go, |item| {
            let (aabb, length) = &self.edges[item as usize];
            if *length > 0.0 {
                near += field(*length, distance(aabb));
            }
        });
        radius * (near + far)
    }
}

/// Corners that are one: for each position the number of the first one that is not farther away
/// in any axis than `tolerance`, or than twice that where both fall into one cell of a grid.
pub(super) fn joined(positions: &[Vec3], tolerance: f64) -> Vec<u32> {
    let mut cells: FixedMap<[i64; 3], u32> = FixedMap::with_hasher(fixed_state());
    let size = 2.0 * tolerance;
    let mut first_near = |number: usize| {
        let place = positions[number].as_dvec3() / size;
        let floor = place.floor();
        // What is within the tolerance lies in this cell, or beyond the sides that are near.
        let toward = (place - floor).to_array().map(|part| if part < 0.5 { -1 } else { 1 });
        let own = floor.to_array().map(|at| at as i64);
        for corner in 0..8 {
            let cell = [0, 1, 2].map(|axis| own[axis] + toward[axis] * (corner >> axis & 1));
            if let Some(other) = cells.get(&cell) {
                let away = (positions[*other as usize].as_dvec3() / size - place).abs();
                if cell == own || away.max_element() <= 0.5 {
                    return *other;
                }
            }
        }
        cells.insert(own, number as u32);
        number as u32
    };
    (0..positions.len()).map(&mut first_near).collect()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn corners_join_across_the_borders_of_cells() {
        let places = [Vec3::ZERO, Vec3::splat(-1e-4), Vec3::splat(1.0), Vec3::splat(1.0005)];
        assert_eq!(joined(&places, 2e-4), [0, 0, 2, 3]);
    }

    #[test]
    fn a_closed_surface_has_no_rim_and_the_field_of_a_hole_fades() {
        let sphere = crate::shapes::sphere(3);
        let mut triangles: Vec<[u32; 3]> =
            sphere.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
        assert!(Rims::new(&sphere.positions, &triangles).is_empty());
        triangles.pop();
        let rims = Rims::new(&sphere.positions, &triangles);
        assert_eq!(rims.edges.len(), 3);
        let ball = |z: f64| Region::Ball { center: DVec3::new(0.0, 0.0, z), radius: 0.1 };
        let changes = [0.0, 5.0, 10.0].map(|z| rims.change(&ball(z)));
        assert!(changes[0] > changes[1] && changes[1] > 3.0 * changes[2] && changes[2] > 0.0);
    }
}
