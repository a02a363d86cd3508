//! Smooth normals for everything that a draw list draws.

use super::DrawList;

impl DrawList {
    /// The list with smooth normals: see [`Mesh::with_smooth_normals`]. The list that it was
    /// made of, and the scene behind it, stay as they are. Costs each distinct mesh once.
    ///
    /// Creases are judged in each mesh's own frame, before transforms stretch it.
    ///
    /// [`Mesh::with_smooth_normals`]: sapwood_geom::Mesh::with_smooth_normals
    pub fn with_smooth_normals(&self, crease: f32) -> Self {
        self.with_meshes(|mesh| mesh.with_smooth_normals(crease))
    }
}
