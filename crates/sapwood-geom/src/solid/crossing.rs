//! Whether two triangles cross, decided exactly.
//!
//! Coordinates are in single precision, so that `f64` holds them as they are; signs of volumes and
//! areas come from the crate `robust`, which tells them exactly. There is no tolerance anywhere.

use glam::Vec3;
use robust::{Coord, Coord3D, orient2d, orient3d};

use super::Solid;
use crate::{Aabb, BoxTree};

impl Solid {
    /// The pairs of triangles that cross or touch where they share nothing, in ascending order,
    /// the smaller number first; `limit` ends the search soon after so many.
    ///
    /// Triangles that share a corner or an edge may meet there and nowhere else.
    pub fn crossings(&self, limit: usize) -> Vec<[u32; 2]> {
        let boxes: Vec<Aabb> = self.boxes().collect();
        let tree = BoxTree::new(boxes.iter().copied());
        let mut found = Vec::new();
        for (one, aabb) in boxes.iter().enumerate() {
            let first = found.len();
            tree.within(aabb, |other| {
                if one < other as usize
                    && aabb.intersects(&boxes[other as usize])
                    && self.do_cross(one, other as usize)
                {
                    found.push([one as u32, other]);
                }
            });
            found[first..].sort_unstable();
            if found.len() >= limit {
                break;
            }
        }
        found
    }

    /// Whether two triangles meet anywhere but in the corners that they share and the edge
    /// between those.
    pub(crate) fn do_cross(&self, one: usize, other: usize) -> bool {
        let (a, b) = (self.triangles[one], self.triangles[other]);
        let n_shared = a.iter().filter(|corner| b.contains(corner)).count();
        let (p, q) = (self.corners(one), self.corners(other));
        match n_shared {
            0 => {
                if is_surely_beside(p, q) || is_surely_beside(q, p) {
                    return false;
                }
                let reaches =
                    |p: [Vec3; 3], q: [Vec3; 3]| edges(q).into_iter().any(|edge| meets(edge, p));
                reaches(p, q) || reaches(q, p)
            }
            1 => {
                let opposite = |corners: [u32; 3], of: [u32; 3]| {
                    let i = (0..3).find(|i| of.contains(&corners[*i])).unwrap_or(0);
                    [corners[(i + 1) % 3], corners[(i + 2) % 3]]
                        .map(|corner| self.positions[corner as usize])
                };
                let (far, other_far) = (opposite(a, b), opposite(b, a));
                !is_surely_beside(p, other_far)
                    && !is_surely_beside(q, far)
                    && (meets(far, q) || meets(other_far, p))
            }
            2 => {
                // They fold onto each other only in one plane, on one side of their edge.
                let apex = |corners: [u32; 3], of: [u32; 3]| {
                    let apex = corners.into_iter().find(|corner| !of.contains(corner));
                    apex.map(|corner| self.positions[corner as usize])
                };
                let (Some(over), Some(under)) = (apex(a, b), apex(b, a)) else { return true };
                let mut edge = a.into_iter().filter(|corner| b.contains(corner));
                let (Some(from), Some(to)) = (edge.next(), edge.next()) else { return true };
                let [from, to] = [from, to].map(|corner| self.positions[corner as usize]);
                if side([from, to, over], under) != 0.0 {
                    return false;
                }
                match flat_axis([from, to, over]) {
                    Some(axis) => {
                        let turn = |point| turn(axis, from, to, point);
                        turn(over) * turn(under) >= 0.0
                    }
                    None => true,
                }
            }
            _ => true,
        }
    }
}

fn edges([a, b, c]: [Vec3; 3]) -> [[Vec3; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// Whether points lie on one side of the plane of a triangle, and not in it, farther away than any
/// error of rounding; most pairs are told apart by this alone.
fn is_surely_beside<const N: usize>(triangle: [Vec3; 3], points: [Vec3; N]) -> bool {
    let [a, b, c] = triangle.map(Vec3::as_dvec3);
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac);
    // Differences are exact to 2^-53, products and sums of what follows to some times that.
    let size = ab.abs().max_element() * ac.abs().max_element();
    let offsets = points.map(|point| {
        let from = point.as_dvec3() - a;
        (normal.dot(from), 1e-14 * size * from.abs().max_element())
    });
    offsets.iter().all(|(offset, error)| offset > error)
        || offsets.iter().all(|(offset, error)| *offset < -error)
}

/// Whether the segment and the triangle, both with their borders, have a point in common.
fn meets([from, to]: [Vec3; 2], triangle: [Vec3; 3]) -> bool {
    let (start, end) = (side(triangle, from), side(triangle, to));
    if start * end > 0.0 {
        return false;
    }
    if start == 0.0 && end == 0.0 {
        return meets_in_plane([from, to], triangle);
    }
    let [a, b, c] = triangle;
    let turns = [side([from, to, a], b), side([from, to, b], c), side([from, to, c], a)];
    turns.iter().all(|turn| *turn >= 0.0) || turns.iter().all(|turn| *turn <= 0.0)
}

/// As [`meets`] for a segment in the triangle's plane. A triangle without area counts as met.
fn meets_in_plane([from, to]: [Vec3; 2], triangle: [Vec3; 3]) -> bool {
    let Some(axis) = flat_axis(triangle) else { return true };
    let turn = |a, b, c| turn(axis, a, b, c);
    let is_inside = |point| {
        let turns = edges(triangle).map(|[a, b]| turn(a, b, point));
        turns.iter().all(|turn| *turn >= 0.0) || turns.iter().all(|turn| *turn <= 0.0)
    };
    if is_inside(from) || is_inside(to) {
        return true;
    }
    // Both ends are outside, so the segment meets an edge in its inside or goes through a corner,
    // and then it separates the corners.
    edges(triangle).into_iter().any(|[a, b]| {
        turn(from, to, a) * turn(from, to, b) <= 0.0
            && turn(a, b, from) * turn(a, b, to) <= 0.0
            && (turn(from, to, a) != 0.0 || turn(from, to, b) != 0.0)
    })
}

/// Along which axis the triangle is not seen as a line; nothing where it is one.
fn flat_axis([a, b, c]: [Vec3; 3]) -> Option<usize> {
    (0..3).find(|axis| turn(*axis, a, b, c) != 0.0)
}

/// Which way three points turn, seen along an axis: above 0 counter-clockwise, 0 not at all.
fn turn(axis: usize, a: Vec3, b: Vec3, c: Vec3) -> f64 {
    let flat = |p: Vec3| {
        let p = p.as_dvec3().to_array();
        Coord { x: p[(axis + 1) % 3], y: p[(axis + 2) % 3] }
    };
    sign(orient2d(flat(a), flat(b), flat(c)))
}

/// On which side of the plane through three points a fourth lies; 0 in the plane.
fn side([a, b, c]: [Vec3; 3], point: Vec3) -> f64 {
    let exact = |p: Vec3| {
        let [x, y, z] = p.as_dvec3().to_array();
        Coord3D { x, y, z }
    };
    sign(orient3d(exact(a), exact(b), exact(c), exact(point)))
}

/// -1, 0 or 1, so that products do not underflow.
fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether two triangles cross, both ways round; equal corners are shared.
    fn cross(one: [[f32; 3]; 3], other: [[f32; 3]; 3]) -> bool {
        let mut solid = Solid::default();
        for triangle in [one, other] {
            let corners = triangle.map(|corner| {
                let position = Vec3::from_array(corner);
                let known = solid.positions.iter().position(|p| *p == position);
                known.unwrap_or_else(|| {
                    solid.positions.push(position);
                    solid.positions.len() - 1
                }) as u32
            });
            solid.triangles.push(corners);
        }
        let found = solid.do_cross(0, 1);
        assert_eq!(found, solid.do_cross(1, 0));
        assert_eq!(solid.crossings(9).len(), usize::from(found));
        found
    }

    const FLAT: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    #[test]
    fn triangles_that_share_nothing() {
        let upright = |x: f32, y: f32, z: f32| [[x, y, z], [x, y, z + 2.0], [x, y + 9.0, z]];
        assert!(cross(FLAT, upright(1.0, 1.0, -1.0)));
        assert!(cross(FLAT, upright(1.0, -1.0, -1.0)));
        assert!(!cross(FLAT, upright(5.0, 1.0, -1.0)));
        assert!(!cross(FLAT, upright(1.0, 1.0, 1e-30)), "as near as it can be");
        assert!(cross(FLAT, upright(1.0, 1.0, 0.0)), "touching in its inside");
        assert!(cross(FLAT, [[4.0, 0.0, -1.0], [4.0, 0.0, 1.0], [5.0, 0.0, 0.0]]));
        // In one plane: apart, over one another, one inside the other.
        assert!(!cross(FLAT, FLAT.map(|[x, y, z]| [4.1 - x, 4.0 - y, z])));
        assert!(cross(FLAT, FLAT.map(|[x, y, z]| [x + 1.0, y + 1.0, z])));
        assert!(cross(FLAT, FLAT.map(|[x, y, z]| [0.1 * x + 1.0, 0.1 * y + 1.0, z])));
    }

    #[test]
    fn triangles_that_share_a_corner() {
        let at = |b, c| cross(FLAT, [[0.0; 3], b, c]);
        assert!(!at([-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]));
        assert!(!at([1.0, 1.0, 1.0], [1.0, 1.0, 2.0]));
        assert!(at([1.0, 1.0, -1.0], [1.0, 1.0, 1.0]), "goes through");
        assert!(at([1.0, 1.0, 0.0], [1.0, 1.0, 1.0]), "lies on it");
        assert!(at([9.0, 9.0, -1.0], [9.0, 9.0, 1.0]), "goes through all of it");
        assert!(at([2.0, 0.0, 0.0], [0.0, -1.0, 0.0]), "along an edge of it");
        assert!(at([1.0, 2.0, 0.0], [-1.0, 2.0, 0.0]), "in its plane");
    }

    #[test]
    fn triangles_that_share_an_edge() {
        let at = |apex| cross(FLAT, [[4.0, 0.0, 0.0], [0.0, 0.0, 0.0], apex]);
        assert!(!at([1.0, 1.0, 1e-30]));
        assert!(!at([1.0, -1.0, 0.0]));
        assert!(at([1.0, 9.0, 0.0]), "folded back");
        assert!(at([1.0, 0.0, 0.0]), "without area");
    }
}
