//! Gathering: the draw rows of one body, by material.

use std::sync::Arc;

use sapwood_geom::Mesh;
use sapwood_geom::glam::Affine3;
use sapwood_graph::{Body, DrawRow, Material};

/// Rows of one body with equal materials.
pub(crate) struct Part<'a> {
    pub(crate) material: &'a Arc<Material>,
    pub(crate) rows: Vec<&'a DrawRow>,
}

/// The rows of `body` that have triangles, by material, in the order of the rows.
pub(crate) fn parts(body: &Body) -> Vec<Part<'_>> {
    let mut parts: Vec<Part<'_>> = Vec::new();
    for row in &body.rows {
        if row.mesh.is_empty() || n_copies(row) == 0 {
            continue;
        }
        let equal = |part: &&mut Part<'_>| {
            Arc::ptr_eq(part.material, &row.material) || *part.material == row.material
        };
        match parts.iter_mut().find(equal) {
            Some(part) => part.rows.push(row),
            None => parts.push(Part { material: &row.material, rows: vec![row] }),
        }
    }
    parts
}

/// How often a row repeats its mesh.
pub(crate) fn n_copies(row: &DrawRow) -> usize {
    row.instances.as_ref().map_or(1, |instances| instances.len())
}

impl Part<'_> {
    /// Hands over, for each vertex in the order of [`each_mesh`](Self::each_mesh), its row and its
    /// number there, or that of its instance.
    pub(crate) fn each_vertex(&self, mut take: impl FnMut(&DrawRow, usize)) {
        for row in &self.rows {
            let n = row.mesh.n_vertices();
            match &row.instances {
                None => (0..n).for_each(|vertex| take(row, vertex)),
                Some(instances) => {
                    for instance in 0..instances.len() {
                        (0..n).for_each(|_| take(row, instance));
                    }
                }
            }
        }
    }

    /// Number of vertices and of indices, every instance counted.
    pub(crate) fn size(&self) -> (u64, u64) {
        self.rows.iter().fold((0, 0), |(vertices, indices), row| {
            let n = n_copies(row) as u64;
            (
                vertices + n * row.mesh.positions.len() as u64,
                indices + n * row.mesh.indices.len() as u64,
            )
        })
    }

    /// Whether every row's indices come in threes.
    pub(crate) fn is_triangles(&self) -> bool {
        self.rows.iter().all(|row| row.mesh.indices.len().is_multiple_of(3))
    }

    /// Hands every mesh of the part to `take`, in the body's frame, one after the other.
    ///
    /// A mesh that is not moved keeps every bit. No more than one mesh is copied at a time.
    pub(crate) fn each_mesh<E>(
        &self,
        mut take: impl FnMut(&Mesh) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut moved = Mesh::default();
        let mut place = |mesh: &Mesh, transform: &Affine3| {
            if *transform == Affine3::IDENTITY {
                return take(mesh);
            }
            moved.positions.clear();
            moved.normals.clear();
            moved.uvs.clear();
            moved.indices.clear();
            moved.append(mesh, transform);
            take(&moved)
        };
        for row in &self.rows {
            match &row.instances {
                None => place(&row.mesh, &row.local)?,
                Some(instances) => {
                    for instance in instances.iter() {
                        place(&row.mesh, &(row.local * *instance))?;
                    }
                }
            }
        }
        Ok(())
    }
}
