//! A mesh of somebody's own instead of a built-in leaf shape. Where it comes from is left to
//! others.

use std::fmt;
use std::sync::Arc;

use glam::{Affine3, Vec3};
use sapwood_geom::{Mesh, SharedMesh, content};
use sapwood_graph::Material;

/// A mesh that stands for one leaf, whatever it shows: a leaf, a flower, a fruit.
///
/// It is given in any unit, in the frame that glTF files have: the origin is where the stalk ends,
/// +z leads along the leaf, +y is its upper side. Its length is what lies beyond the origin along
/// +z, and is made 1; the other axes keep their proportions.
#[derive(Clone, Debug, PartialEq)]
pub struct LeafMesh {
    unit: SharedMesh,
    material: Option<Arc<Material>>,
    has_uvs: bool,
    reach: Vec3,
}

content!(LeafMesh { unit, material, has_uvs, reach });

/// Why a mesh is no leaf.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LeafMeshFault {
    /// It has no triangles.
    Empty,
    /// It has more than [`LeafMesh::MOST_TRIANGLES`].
    TooMany {
        /// How many there are.
        found: usize,
    },
    /// It has numbers that are none, or triangles between vertices that are not there.
    Unsound(String),
    /// Nothing of it lies beyond the origin along +z.
    NoLength,
    /// It is so much thicker than long that it cannot be made one long.
    TooWide,
}

impl fmt::Display for LeafMeshFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let most = LeafMesh::MOST_TRIANGLES;
        match self {
            Self::Empty => f.write_str("a mesh without triangles (accepted: a leaf of some)"),
            Self::TooMany { found } => {
                write!(f, "a leaf of {found} triangles (accepted: at most {most})")
            }
            Self::Unsound(why) => write!(f, "{why} (accepted: a sound mesh)"),
            Self::NoLength => f.write_str(
                "nothing of the mesh lies beyond its origin along +z (accepted: leaves that begin at \
                 the origin and lead along +z, their upper side toward +y)",
            ),
            Self::TooWide => f.write_str(
                "the mesh is more than 1000 times as wide as it is long along +z (accepted: leaves \
                 that lead along +z)",
            ),
        }
    }
}

impl std::error::Error for LeafMeshFault {}

/// The most by which a leaf may be wider than long.
pub(super) const WIDEST: f32 = 1000.0;

impl LeafMesh {
    /// The most triangles that one leaf may have.
    pub const MOST_TRIANGLES: usize = 1 << 16;

    /// The leaf that `mesh` stands for. It is drawn with `material`, or with what a species says of
    /// its leaves where there is none.
    ///
    /// # Errors
    /// Where the mesh is no leaf.
    pub fn new(mesh: &Mesh, material: Option<Arc<Material>>) -> Result<Self, LeafMeshFault> {
        if mesh.is_empty() {
            return Err(LeafMeshFault::Empty);
        }
        if mesh.n_triangles() > Self::MOST_TRIANGLES {
            return Err(LeafMeshFault::TooMany { found: mesh.n_triangles() });
        }
        if let Some(why) = mesh.unsound() {
            return Err(LeafMeshFault::Unsound(why));
        }
        // Vertices that no triangle uses have no say in how long it is.
        let used = mesh.part(0..mesh.n_triangles() as u32);
        let length = used.bound().aabb.max.z;
        let scale = length.recip();
        if !(length > 0.0 && scale.is_finite()) {
            return Err(LeafMeshFault::NoLength);
        }
        let mut unit = Mesh::default();
        unit.append(&used, &Affine3::from_scale(Vec3::splat(scale)));
        let bound = unit.bound().aabb;
        let mut reach = bound.min.abs().max(bound.max.abs());
        if reach.max_element() > WIDEST {
            return Err(LeafMeshFault::TooWide);
        }
        // What stands for it from afar may be wider.
        reach.x = reach.x.max(point_half_width(&unit, is_closed(&unit)));
        let has_uvs = unit.uvs.iter().any(|uv| *uv != unit.uvs[0]);
        Ok(Self { unit: SharedMesh::new(unit), material, has_uvs, reach })
    }

    /// The mesh, one long.
    pub fn unit(&self) -> &SharedMesh {
        &self.unit
    }

    /// What it is drawn with by itself.
    pub fn material(&self) -> Option<&Arc<Material>> {
        self.material.as_ref()
    }

    /// Whether an image can be laid on it.
    pub fn has_uvs(&self) -> bool {
        self.has_uvs
    }

    /// How far it reaches from the origin along each axis, as does what stands for it from afar.
    pub(crate) fn reach(&self) -> Vec3 {
        self.reach
    }
}

/// Whether a leaf is a body and no sheet.
pub(crate) fn is_closed(mesh: &Mesh) -> bool {
    mesh.n_open_edges() == 0
}

/// Half the width of a triangle one long that covers as much as a mesh from all sides together:
/// whoever looks at a closed body sees a quarter of its surface, and half of a sheet's.
pub(crate) fn point_half_width(mesh: &Mesh, is_closed: bool) -> f32 {
    let area: f32 = mesh
        .indices
        .chunks_exact(3)
        .map(|t| {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| mesh.positions[i as usize]);
            0.5 * (b - a).cross(c - a).length()
        })
        .sum();
    if is_closed { 0.5 * area } else { area }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::weber_penn::LeafShape;
    use crate::weber_penn::geometry::leaf_mesh;

    fn scaled(mesh: &Mesh, scale: Vec3, by: Vec3) -> Mesh {
        let mut scaled = Mesh::default();
        scaled.append(
            mesh,
            &Affine3::from_scale_rotation_translation(scale, glam::Quat::IDENTITY, by),
        );
        scaled
    }

    #[test]
    fn leaves_are_made_one_long_in_their_proportions() {
        let maple = leaf_mesh(LeafShape::Maple5);
        let large = scaled(&maple, Vec3::new(14.0, 7.0, 7.0), Vec3::ZERO);
        let leaf = LeafMesh::new(&large, None).unwrap();
        let bound = leaf.unit().bound().aabb;
        assert!((bound.max.z - 1.0).abs() < 1e-6 && (bound.size().x - 2.0).abs() < 1e-5);
        assert!(leaf.has_uvs() && leaf.reach().x >= 1.0 && leaf.reach().z >= 1.0);
        assert_eq!(leaf.unit().fault(), None);
    }

    #[test]
    fn what_is_no_leaf_is_told() {
        let oval = leaf_mesh(LeafShape::Oval);
        let told = |mesh: &Mesh| LeafMesh::new(mesh, None).unwrap_err().to_string();
        assert!(told(&Mesh::default()).contains("without triangles"));
        let behind = scaled(&oval, Vec3::ONE, -2.0 * Vec3::Z);
        assert!(told(&behind).contains("beyond its origin along +z"));
        let wide = scaled(&oval, Vec3::new(5000.0, 1.0, 1.0), Vec3::ZERO);
        assert!(told(&wide).contains("1000 times"));
        let mut broken = oval.clone();
        broken.positions[1].x = f32::NAN;
        assert!(told(&broken).contains("the position of vertex 1"));
        let mut many = Mesh::default();
        while many.n_triangles() <= LeafMesh::MOST_TRIANGLES {
            let more = if many.is_empty() { oval.clone() } else { many.clone() };
            many.append(&more, &Affine3::IDENTITY);
        }
        assert!(told(&many).contains("at most 65536"), "{}", told(&many));
    }
}
