//! Solids: closed surfaces without texture coordinates or normals, as a slicer or a physics engine
//! takes them, and what is wrong with those that are none.

#[cfg(feature = "union")]
mod boolean;
mod check;
mod crossing;
#[cfg(feature = "union")]
mod dress;
#[cfg(feature = "union")]
mod mend;
#[cfg(feature = "union")]
mod plan;
#[cfg(feature = "union")]
mod table;
#[cfg(feature = "union")]
mod union;

pub use check::SolidReport;
#[cfg(feature = "union")]
pub use dress::dressed;
#[cfg(feature = "union")]
pub use mend::Mended;
#[cfg(feature = "union")]
pub use union::{Member, Union, UnionError, UnionStep, UnionWork, Unions, union};

use glam::{DVec3, Vec3};

use crate::{Aabb, FixedMap, Mesh, fixed_state};

/// Triangles between shared corners that bound a body. They wind counter-clockwise seen from
/// outside.
///
/// Nothing keeps a value from being no solid at all: [`check`](Self::check) tells.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solid {
    /// Corners, in metres.
    pub positions: Vec<Vec3>,
    /// Three numbers of corners for each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl Solid {
    /// The surface of a mesh, which must be [sound](Mesh::unsound): vertices at one position
    /// become one corner, and triangles that have a corner twice then are left out.
    pub fn of_mesh(mesh: &Mesh) -> Self {
        Self::with_origins(mesh).0
    }

    /// As [`of_mesh`](Self::of_mesh), with the number that each triangle has in the mesh.
    pub(crate) fn with_origins(mesh: &Mesh) -> (Self, Vec<u32>) {
        let mut solid = Self::default();
        let mut corners: FixedMap<[u32; 3], u32> = FixedMap::with_hasher(fixed_state());
        let mut number_at = |position: Vec3| {
            *corners.entry(position.to_array().map(f32::to_bits)).or_insert_with(|| {
                solid.positions.push(position);
                solid.positions.len() as u32 - 1
            })
        };
        // Both zeros are one.
        let numbers: Vec<u32> = mesh.positions.iter().map(|p| number_at(*p + 0.0)).collect();
        let mut origins = Vec::with_capacity(mesh.n_triangles());
        for (origin, t) in mesh.indices.chunks_exact(3).enumerate() {
            let [a, b, c] = [t[0], t[1], t[2]].map(|index| numbers[index as usize]);
            if a != b && b != c && c != a {
                solid.triangles.push([a, b, c]);
                origins.push(origin as u32);
            }
        }
        (solid, origins)
    }

    /// Whether there is no triangle.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// The corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|corner| self.positions[corner as usize])
    }

    /// What is enclosed, in cubic metres; below zero where the solid is inside out.
    pub fn volume(&self) -> f64 {
        let from = self.positions.first().map_or(DVec3::ZERO, |first| first.as_dvec3());
        let six = (0..self.triangles.len()).map(|triangle| {
            let [a, b, c] = self.corners(triangle).map(|corner| corner.as_dvec3() - from);
            a.dot(b.cross(c))
        });
        six.sum::<f64>() / 6.0
    }

    /// The boxes of all triangles.
    pub(crate) fn boxes(&self) -> impl Iterator<Item = Aabb> {
        (0..self.triangles.len()).map(|triangle| Aabb::of_points(self.corners(triangle)))
    }
}
