//! Meshes that enclose something.

use std::f64::consts::PI;
use std::fmt;

use glam::{DVec3, Vec3};

use super::region::Region;
use super::rim::{Rims, joined};
use super::side::Side;
use super::triangle::Triangle;
use super::winding::Winding;
use crate::{Aabb, Bound, BoxTree, Content, Digester, Mesh, Shared};

/// A mesh that encloses something: a point is inside where the surface goes around it more than
/// half a time.
///
/// Small holes, cracks, doubled shells and shells that overlap are no trouble (generalized winding
/// numbers: A. Jacobson, L. Kavan, O. Sorkine, 2013). Nothing beyond the box around the mesh is
/// inside. Cheap to clone; equal where positions and triangles are.
#[derive(Clone, PartialEq)]
pub struct ClosedMesh(Shared<Solid>);

struct Solid {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    bound: Bound,
    winding: Winding,
    rims: Rims,
}

/// Why a mesh encloses nothing.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum NotClosed {
    /// It has no triangle with an area.
    Empty,
    /// It is broken; the text tells how, as [`Mesh::unsound`] does.
    Unsound(String),
    /// Its triangles face inwards: `share` of its surface has what it encloses in front.
    InsideOut {
        /// From 0 to 1.
        share: f64,
    },
    /// Only `share` of its surface has something enclosed behind it;
    /// [`ClosedMesh::LEAST_SHARE`] is needed.
    Open {
        /// From 0 to 1.
        share: f64,
    },
}

impl fmt::Display for NotClosed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |share: &f64| 100.0 * share;
        match self {
            Self::Empty => f.write_str("the mesh has no surface"),
            Self::Unsound(fault) => f.write_str(fault),
            Self::InsideOut { share } => write!(
                f,
                "{:.0} % of the mesh's surface face what it encloses: it is inside out",
                percent(share)
            ),
            Self::Open { share } => write!(
                f,
                "{:.0} % of the mesh's surface have something enclosed behind them, fewer than \
                 {:.0} %: it is far from closed",
                percent(share),
                percent(&ClosedMesh::LEAST_SHARE)
            ),
        }
    }
}

impl std::error::Error for NotClosed {}

/// Corners are one up to this part of the mesh's diagonal.
const TOLERANCE: f64 = 5e-6;

/// Places on the surface that are looked at to see whether it is closed.
const N_PLACES: u32 = 1024;

/// How much a winding number may be wrong: groups of triangles far away count by approximation.
const DOUBT: f64 = 0.08;

impl ClosedMesh {
    /// The share of its surface behind which a mesh must enclose something.
    pub const LEAST_SHARE: f64 = 0.9;

    /// What `mesh` encloses; its triangles wind counter-clockwise seen from outside. Costs
    /// O(n log n).
    ///
    /// # Errors
    /// When the mesh has no surface, is broken, is inside out or is far from closed. This is
    /// judged by the mean of the winding numbers on both sides of about a thousand places strewn
    /// evenly over the surface: 0.5 where it is closed, 0 on an open sheet; 0.25 passes.
    pub fn new(mesh: &Mesh) -> Result<Self, NotClosed> {
        if let Some(fault) = mesh.unsound() {
            return Err(NotClosed::Unsound(fault));
        }
        let bound = Bound::of_points(mesh.indices.iter().map(|i| mesh.positions[*i as usize]));
        let diagonal = f64::from(bound.aabb.size().length());
        if !(diagonal > 0.0 && diagonal.is_finite()) {
            return Err(NotClosed::Empty);
        }
        let joined = joined(&mesh.positions, TOLERANCE * diagonal);
        let corner = |index: u32| joined[index as usize];
        let triangles: Vec<[u32; 3]> =
            mesh.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]].map(corner)).collect();
        let positions = &mesh.positions;
        let at = |number: u32| triangle(positions, &triangles, number);
        let boxes = (0..triangles.len() as u32).map(|number| {
            Aabb::of_points(triangles[number as usize].map(|index| positions[index as usize]))
        });
        let winding = Winding::new(BoxTree::new(boxes), at);
        let rims = Rims::new(positions, &triangles);
        let positions = positions.clone();
        let solid = Solid { positions, triangles, bound, winding, rims };
        solid.check()?;
        Ok(Self(Shared::new(solid)))
    }

    /// The bound of everything inside.
    pub fn bound(&self) -> &Bound {
        &self.0.bound
    }

    /// Number of triangles.
    pub fn n_triangles(&self) -> usize {
        self.0.triangles.len()
    }

    /// Whether every edge of a triangle is continued by another one.
    pub fn is_watertight(&self) -> bool {
        self.0.rims.is_empty()
    }

    /// How often the surface goes around `point`: 1 inside, 0 outside, another whole number where
    /// shells overlap, something between near holes.
    pub fn winding_number(&self, point: Vec3) -> f64 {
        self.0.winding_number(point.as_dvec3())
    }

    pub(super) fn contains(&self, point: DVec3) -> bool {
        let Bound { aabb, .. } = self.0.bound;
        let is_near = aabb.min.as_dvec3().cmple(point).all();
        let is_near = is_near && aabb.max.as_dvec3().cmpge(point).all();
        is_near && self.0.winding_number(point) > 0.5
    }

    pub(super) fn side_of(&self, region: &Region) -> Side {
        let Bound { aabb, .. } = self.0.bound;
        if !region.meets(aabb.min.as_dvec3(), aabb.max.as_dvec3()) {
            return Side::Outside;
        }
        if self.0.touches(region) {
            return Side::Crossing;
        }
        let number = self.0.winding_number(region.center());
        if self.is_watertight() {
            return if number > 0.5 { Side::Inside } else { Side::Outside };
        }
        let change = self.0.rims.change(region) + DOUBT;
        // A region that leaves the box around the mesh is not inside, whatever its number.
        let [min, max] = region.corners();
        let is_within =
            aabb.min.as_dvec3().cmple(min).all() && aabb.max.as_dvec3().cmpge(max).all();
        if number - change > 0.5 && is_within {
            Side::Inside
        } else if number + change < 0.5 {
            Side::Outside
        } else {
            Side::Crossing
        }
    }
}

/// The triangle with a number.
fn triangle(positions: &[Vec3], triangles: &[[u32; 3]], number: u32) -> Triangle {
    Triangle(triangles[number as usize].map(|index| positions[index as usize].as_dvec3()))
}

impl Solid {
    fn triangle(&self, number: u32) -> Triangle {
        triangle(&self.positions, &self.triangles, number)
    }

    fn winding_number(&self, point: DVec3) -> f64 {
        self.winding.at(point, |number| self.triangle(number))
    }

    /// Whether a triangle may share a point with a region.
    fn touches(&self, region: &Region) -> bool {
        let touches = std::cell::Cell::new(false);
        let go = |_, aabb: &Aabb| {
            !touches.get() && region.meets(aabb.min.as_dvec3(), aabb.max.as_dvec3())
        };
        self.winding.tree().descend(go, |number| {
            if touches.get() {
                return;
            }
            let triangle = self.triangle(number);
            let [a, b, c] = triangle.0;
            let meets = match *region {
                Region::Ball { center, radius } => {
                    triangle.distance_squared(center) <= radius * radius
                }
                Region::Box { .. } => region.meets(a.min(b).min(c), a.max(b).max(c)),
            };
            touches.set(meets);
        });
        touches.get()
    }

    /// Tells what is wrong where the surface does not enclose anything.
    fn check(&self) -> Result<(), NotClosed> {
        let numbers = 0..self.triangles.len() as u32;
        let area = |number| self.triangle(number).area_vector().length();
        let whole: f64 = numbers.clone().map(area).sum();
        if !(whole > 0.0 && whole.is_finite()) {
            return Err(NotClosed::Empty);
        }
        let (mut done, mut n_places, mut n_behind, mut n_before) = (0.0, 0, 0, 0);
        for number in numbers {
            done += area(number);
            let n = (done / whole * f64::from(N_PLACES)) as u32;
            let n_here = n - n_places;
            if n_here == 0 {
                continue;
            }
            n_places = n;
            let triangle = self.triangle(number);
            let middle = triangle.middle();
            // Without the triangle itself: the mean of both its sides.
            let own = triangle.solid_angle(middle) / (4.0 * PI);
            let mean = self.winding_number(middle) - own;
            n_behind += if mean >= 0.25 { n_here } else { 0 };
            n_before += if mean <= -0.25 { n_here } else { 0 };
        }
        let share = |n| f64::from(n) / f64::from(n_places.max(1));
        if share(n_behind) >= ClosedMesh::LEAST_SHARE {
            Ok(())
        } else if n_before > n_behind && share(n_before) >= 0.5 {
            Err(NotClosed::InsideOut { share: share(n_before) })
        } else {
            Err(NotClosed::Open { share: share(n_behind) })
        }
    }
}

impl Content for ClosedMesh {
    fn write(&self, digester: &mut Digester) {
        self.0.write(digester);
    }
}

impl Content for Solid {
    fn write(&self, digester: &mut Digester) {
        // Everything else follows from these.
        let Self { positions, triangles, bound: _, winding: _, rims: _ } = self;
        digester.add(positions).add(triangles);
    }
}

impl fmt::Debug for ClosedMesh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Bound { aabb, .. } = self.0.bound;
        write!(f, "a closed mesh of {} triangles in {aabb:?}", self.n_triangles())
    }
}
