//! What keeps triangles from bounding a body.

use std::fmt;

use super::Solid;
use crate::{FixedMap, fixed_state};

/// Faults of a [`Solid`], counted. All are 0 where it is closed, oriented and without crossings.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolidReport {
    /// Edges that bound one triangle only.
    pub boundary_edges: usize,
    /// Edges that bound more than two triangles, or two of opposite orientation.
    pub non_manifold_edges: usize,
    /// Corners around which triangles form more than one fan, or that no triangle has.
    pub non_manifold_vertices: usize,
    /// Triangles with a corner twice, or lower over their longest edge than a millionth of it.
    pub degenerate_triangles: usize,
    /// Pairs of triangles that cross or touch where they share nothing.
    pub crossings: usize,
    /// How many pieces hang together: no fault.
    pub components: usize,
    /// What is enclosed, in cubic metres; a fault where it is not above 0.
    pub volume: f64,
}

impl SolidReport {
    /// Whether nothing is wrong: the triangles bound a body.
    pub fn is_sound(&self) -> bool {
        self.boundary_edges == 0
            && self.non_manifold_edges == 0
            && self.non_manifold_vertices == 0
            && self.degenerate_triangles == 0
            && self.crossings == 0
            && self.volume > 0.0
    }
}

impl Solid {
    /// Looks for everything that is wrong; costs O(n log n). All triangles must use corners
    /// that are there and finite.
    pub fn check(&self) -> SolidReport {
        SolidReport { crossings: self.crossings(usize::MAX).len(), ..self.check_edges() }
    }

    /// As [`check`](Self::check), but does not look for crossings; costs O(n).
    pub(crate) fn check_edges(&self) -> SolidReport {
        let mut report = SolidReport {
            degenerate_triangles: (0..self.triangles.len())
                .filter(|triangle| self.is_degenerate(*triangle))
                .count(),
            volume: self.volume(),
            ..SolidReport::default()
        };
        // Of each edge how many triangles go along it upwards and downwards.
        let mut ways: FixedMap<[u32; 2], [u32; 2]> = FixedMap::with_hasher(fixed_state());
        for [a, b, c] in &self.triangles {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let way = ways.entry([*from.min(to), *from.max(to)]).or_default();
                way[usize::from(from > to)] += 1;
            }
        }
        for way in ways.values() {
            match way {
                [1, 1] => {}
                [1, 0] | [0, 1] => report.boundary_edges += 1,
                _ => report.non_manifold_edges += 1,
            }
        }
        report.non_manifold_vertices = self.n_odd_corners();
        report.components = self.n_components();
        report
    }

    /// Whether a triangle is too thin to have a normal.
    pub(crate) fn is_degenerate(&self, triangle: usize) -> bool {
        let [a, b, c] = self.corners(triangle).map(|corner| corner.as_dvec3());
        let longest =
            (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        let [i, j, k] = self.triangles[triangle];
        i == j || j == k || k == i || (b - a).cross(c - a).length() <= 1e-6 * longest
    }

    /// The corners whose triangles do not form one fan that closes or ends at two borders.
    fn n_odd_corners(&self) -> usize {
        let mut fans: Vec<Vec<[u32; 2]>> = vec![Vec::new(); self.positions.len()];
        for [a, b, c] in self.triangles.iter().copied() {
            for (corner, from, to) in [(a, b, c), (b, c, a), (c, a, b)] {
                fans[corner as usize].push([from, to]);
            }
        }
        fans.iter_mut().map(|fan| usize::from(!is_one_fan(fan))).sum()
    }

    fn n_components(&self) -> usize {
        let mut roots = self.components();
        roots.sort_unstable();
        roots.dedup();
        roots.len()
    }

    /// For each triangle the number of a corner, which is the same for all that hang together.
    pub fn components(&self) -> Vec<u32> {
        let mut groups = Groups((0..self.positions.len() as u32).collect());
        for [a, b, c] in &self.triangles {
            groups.join(*a, *b);
            groups.join(*b, *c);
        }
        self.triangles.iter().map(|t| groups.root(t[0])).collect()
    }
}

/// Whether the edges opposite to a corner form one chain, which may be closed.
fn is_one_fan(edges: &mut [[u32; 2]]) -> bool {
    let n = edges.len();
    if n == 0 {
        return false;
    }
    // Where the chain begins: at an edge that none leads to, or anywhere.
    let first = (0..n).find(|i| edges.iter().all(|edge| edge[1] != edges[*i][0])).unwrap_or(0);
    edges.swap(0, first);
    for i in 1..n {
        let Some(next) = (i..n).find(|j| edges[*j][0] == edges[i - 1][1]) else { return false };
        edges.swap(i, next);
    }
    true
}

/// Numbers in groups: each points to another of its group, the first to itself.
struct Groups(Vec<u32>);

impl Groups {
    fn root(&mut self, mut number: u32) -> u32 {
        while self.0[number as usize] != number {
            let above = self.0[number as usize];
            self.0[number as usize] = self.0[above as usize];
            number = above;
        }
        number
    }

    fn join(&mut self, one: u32, other: u32) {
        let (one, other) = (self.root(one), self.root(other));
        self.0[one.max(other) as usize] = one.min(other);
    }
}

impl fmt::Display for SolidReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { boundary_edges, non_manifold_edges, non_manifold_vertices, .. } = self;
        let Self { degenerate_triangles, crossings, components, volume, .. } = self;
        write!(
            f,
            "{boundary_edges} boundary edges, {non_manifold_edges} non-manifold edges, \
             {non_manifold_vertices} non-manifold vertices, {degenerate_triangles} degenerate \
             triangles, {crossings} crossings, {components} components, {volume} m3"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mesh;
    use crate::shapes::sphere;
    use glam::{Affine3, Vec3};

    fn check(solid: &Solid, expected: [usize; 6]) {
        let SolidReport { boundary_edges, non_manifold_edges, non_manifold_vertices, .. } =
            solid.check();
        let SolidReport { degenerate_triangles, crossings, components, .. } = solid.check();
        let found = [
            boundary_edges,
            non_manifold_edges,
            non_manifold_vertices,
            degenerate_triangles,
            crossings,
            components,
        ];
        assert_eq!(found, expected);
    }

    fn spheres(at: &[Vec3]) -> Solid {
        let mut mesh = Mesh::default();
        for place in at {
            mesh.append(&sphere(2), &Affine3::from_translation(*place));
        }
        Solid::of_mesh(&mesh)
    }

    #[test]
    fn a_sphere_is_sound_and_its_faults_are_found() {
        let sound = spheres(&[Vec3::ZERO]);
        check(&sound, [0, 0, 0, 0, 0, 1]);
        assert!(sound.check().is_sound());
        assert!((sound.volume() - 4.0).abs() < 0.2, "{}", sound.volume());

        let mut open = sound.clone();
        open.triangles.pop();
        check(&open, [3, 0, 0, 0, 0, 1]);
        let mut twisted = sound.clone();
        twisted.triangles[0].swap(0, 1);
        assert_eq!(twisted.check().non_manifold_edges, 3);
        let mut inside_out = sound.clone();
        inside_out.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
        check(&inside_out, [0, 0, 0, 0, 0, 1]);
        assert!(!inside_out.check().is_sound());
        let mut flat = sound;
        let [a, b, c] = flat.triangles[7].map(|corner| corner as usize);
        flat.positions[a] = 0.5 * (flat.positions[b] + flat.positions[c]);
        assert!(flat.check().degenerate_triangles > 0);
    }

    #[test]
    fn bodies_that_overlap_or_touch_are_told_apart_from_others() {
        check(&spheres(&[Vec3::ZERO, 9.0 * Vec3::X]), [0, 0, 0, 0, 0, 2]);
        assert!(spheres(&[Vec3::ZERO, Vec3::X]).check().crossings > 20);
        // Two bodies with one corner in common.
        let mut touching = spheres(&[Vec3::ZERO, 9.0 * Vec3::X]);
        let farthest = |from: Vec3, solid: &Solid| {
            let far = |corner: &usize| solid.positions[*corner].distance(from);
            (0..solid.positions.len()).max_by(|a, b| far(a).total_cmp(&far(b))).unwrap() as u32
        };
        let (left, right) = (-99.0 * Vec3::X, 99.0 * Vec3::X);
        let (a, b) = (farthest(left, &touching), farthest(right, &touching));
        touching.positions[b as usize] = Vec3::new(4.5, 0.0, 0.0);
        for corner in touching.triangles.iter_mut().flatten() {
            if *corner == a {
                *corner = b;
            }
        }
        // The corner that nobody has any more is odd too.
        assert_eq!(touching.check().non_manifold_vertices, 2);
    }
}
