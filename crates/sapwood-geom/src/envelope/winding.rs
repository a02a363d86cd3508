//! Winding numbers through a hierarchy: how often a surface goes around a point.
//!
//! Nearby triangles count by their exact solid angle, groups of triangles far away by their dipole
//! and its first moment (G. Barill, N. G. Dickson, R. Schmidt, D. I. W. Levin, A. Jacobson: "Fast
//! winding numbers for soups and clouds", 2018).

use std::f64::consts::PI;

use glam::DVec3;

use super::triangle::Triangle;
use crate::BoxTree;

/// A group counts as far away from this multiple of its radius on.
const FAR: f64 = 3.0;

/// Triangles from afar.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Dipole {
    area: f64,
    /// The middle, weighted by area.
    middle: DVec3,
    /// No corner is farther from the middle.
    radius: f64,
    /// The sum of the area vectors.
    normal: DVec3,
    /// The symmetric part of the sum of (place - middle) times area vector: xx, yy, zz.
    straight: DVec3,
    /// The same, doubled: yz, zx, xy.
    crossed: DVec3,
}

impl Dipole {
    fn of_triangle(triangle: &Triangle) -> Self {
        let (normal, middle) = (triangle.area_vector(), triangle.middle());
        let away = triangle.0.map(|corner| corner.distance(middle));
        let radius = away.into_iter().fold(0.0, f64::max);
        let (area, zero) = (normal.length(), DVec3::ZERO);
        Self { area, middle, radius, normal, straight: zero, crossed: zero }
    }

    fn of_group(group: &[Self]) -> Self {
        let area: f64 = group.iter().map(|one| one.area).sum();
        let weighted: DVec3 = group.iter().map(|one| one.middle * one.area).sum();
        let middle = if area > 0.0 {
            weighted / area
        } else {
            group.first().map_or(DVec3::ZERO, |one| one.middle)
        };
        let mut all = Self { area, middle, ..Self::default() };
        for one in group {
            let away = one.middle - middle;
            all.radius = all.radius.max(away.length() + one.radius);
            all.normal += one.normal;
            all.straight += one.straight + away * one.normal;
            let (a, n) = (away, one.normal);
            let crossed =
                DVec3::new(a.y * n.z + a.z * n.y, a.z * n.x + a.x * n.z, a.x * n.y + a.y * n.x);
            all.crossed += one.crossed + crossed;
        }
        all
    }

    /// The solid angle in steradians, from far away.
    fn solid_angle(&self, eye: DVec3) -> f64 {
        let to = self.middle - eye;
        let square = to.length_squared();
        let cube = square * square.sqrt();
        let along = DVec3::new(to.y * to.z, to.z * to.x, to.x * to.y);
        let squared = self.straight.dot(to * to) + self.crossed.dot(along);
        (to.dot(self.normal) + self.straight.element_sum() - 3.0 * squared / square) / cube
    }
}

/// The winding numbers of triangles.
#[derive(Debug)]
pub(super) struct Winding {
    tree: BoxTree,
    dipoles: Vec<Dipole>,
}

impl Winding {
    /// Winding numbers of triangles that `tree` holds by their numbers.
    pub(super) fn new(tree: BoxTree, triangle: impl Fn(u32) -> Triangle) -> Self {
        let dipoles = tree.summaries(Dipole::default(), |items, below| {
            if items.is_empty() {
                // Empty places of the tree would draw the radius towards the origin.
                let filled = below.iter().filter(|one| **one != Dipole::default());
                return Dipole::of_group(&filled.copied().collect::<Vec<_>>());
            }
            let single: Vec<_> =
                items.iter().map(|item| Dipole::of_triangle(&triangle(*item))).collect();
            Dipole::of_group(&single)
        });
        Self { tree, dipoles }
    }

    pub(super) fn tree(&self) -> &BoxTree {
        &self.tree
    }

    /// How often the triangles go around `point`: 1 inside a closed surface, 0 outside.
    pub(super) fn at(&self, point: DVec3, triangle: impl Fn(u32) -> Triangle) -> f64 {
        let (mut near, mut far) = (0.0, 0.0);
        let go = |place: usize, _: &crate::Aabb| {
            let dipole = &self.dipoles[place];
            let reach = FAR * dipole.radius;
            let is_far = dipole.middle.distance_squared(point) > reach * reach;
            if is_far {
                far += dipole.solid_angle(point);
            }
            !is_far
        };
        self.tree.descend(go, |item| near += triangle(item).solid_angle(point));
        (near + far) / (4.0 * PI)
    }
}
