//! What a pick tells.

use sapwood_geom::glam::{Vec2, Vec3};

use crate::Kind;

/// What a ray met first. Points and vectors are in the root's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Hit {
    /// Metres from the ray's origin.
    pub distance: f32,
    /// Where the thing was hit.
    pub point: Vec3,
    /// Unit normal of the surface, toward where the ray comes from.
    pub normal: Vec3,
    /// What was hit there.
    pub struck: Struck,
    /// The kind of the component whose plan draws it.
    pub kind: Kind,
    /// The number of the render node in that plan's fragment.
    pub node: u32,
    /// The links from the root to that plan.
    pub path: Vec<u32>,
    /// The part that was hit, where its rule told.
    pub part: Option<PickedPart>,
}

/// A part that was hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PickedPart {
    /// The part's kind.
    pub kind: Kind,
    /// Its row in the plan's parts of that kind.
    pub row: u32,
    /// How many links of the hit's path lead to the plan that has the part.
    pub n_links: u32,
}

impl Hit {
    /// The links from the root to the plan that has the part; to the plan that draws where no
    /// part is known.
    pub fn part_path(&self) -> &[u32] {
        let n_links = self.part.map_or(self.path.len(), |part| part.n_links as usize);
        &self.path[..n_links.min(self.path.len())]
    }
}

/// What of a render node was hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Struck {
    /// A triangle of a mesh.
    Triangle {
        /// The number of the triangle.
        triangle: u32,
        /// The number of the instance, where the mesh is repeated.
        instance: Option<u32>,
        /// How much each corner weighs at the hit; together 1.
        weights: [f32; 3],
        /// Unit normal, interpolated between the corners, toward where the ray comes from.
        shading_normal: Vec3,
        /// The texture coordinate there.
        uv: Vec2,
        /// Whether the front was hit.
        is_front: bool,
    },
    /// A line.
    Line {
        /// The number of the line.
        line: u32,
        /// The number of the stretch between two of its points.
        stretch: u32,
        /// Where on the stretch, from 0 to 1.
        along: f32,
    },
    /// A label.
    Label,
}
