//! Fewer triangles for everything that a draw list draws.

use sapwood_geom::Simplify;

use super::DrawList;

impl DrawList {
    /// The list with simpler meshes: see [`Mesh::simplified`]. The list that it was made of, and
    /// the scene behind it, stay as they are. Costs each distinct mesh once.
    ///
    /// The error allowed is measured in each mesh's own frame, before transforms stretch it. To
    /// simplify across meshes, merge them first.
    ///
    /// [`Mesh::simplified`]: sapwood_geom::Mesh::simplified
    pub fn simplified(&self, how: &Simplify) -> Self {
        self.with_meshes(|mesh| mesh.simplified(how).0)
    }
}
