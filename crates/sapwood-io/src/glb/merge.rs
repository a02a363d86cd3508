//! Gathering: the draw rows of one body, by material.

use std::sync::Arc;

use sapwood_geom::Mesh;
use sapwood_geom::glam::Affine3;
use sapwood_graph::{Body, DrawRow, Material};

use super::buffer;

/// What becomes one primitive: rows of one body with equal materials.
pub(super) struct Part<'a> {
    pub(super) material: &'a Arc<Material>,
    rows: Vec<&'a DrawRow>,
}

/// The rows of `body` that have triangles, by material, in the order of the rows.
pub(super) fn parts(body: &Body) -> Vec<Part<'_>> {
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

fn n_copies(row: &DrawRow) -> usize {
    row.instances.as_ref().map_or(1, |instances| instances.len())
}

impl Part<'_> {
    /// Bytes that the part takes in the binary chunk.
    pub(super) fn byte_length(&self) -> u64 {
        let (vertices, indices) = self.size();
        buffer::byte_length(vertices, indices)
    }

    /// Number of vertices and of indices.
    fn size(&self) -> (u64, u64) {
        self.rows.iter().fold((0, 0), |(vertices, indices), row| {
            let n = n_copies(row) as u64;
            (
                vertices + n * row.mesh.positions.len() as u64,
                indices + n * row.mesh.indices.len() as u64,
            )
        })
    }

    /// All rows as one mesh in the body's frame.
    pub(super) fn merged(&self) -> Mesh {
        let (vertices, indices) = self.size();
        let mut merged = Mesh {
            positions: Vec::with_capacity(vertices as usize),
            normals: Vec::with_capacity(vertices as usize),
            uvs: Vec::with_capacity(vertices as usize),
            indices: Vec::with_capacity(indices as usize),
        };
        for row in &self.rows {
            match &row.instances {
                None => append(&mut merged, &row.mesh, &row.local),
                Some(instances) => {
                    for instance in instances.iter() {
                        append(&mut merged, &row.mesh, &(row.local * *instance));
                    }
                }
            }
        }
        merged
    }
}

/// Appends `mesh`; where nothing is transformed every bit is kept.
fn append(merged: &mut Mesh, mesh: &Mesh, transform: &Affine3) {
    if *transform != Affine3::IDENTITY {
        return merged.append(mesh, transform);
    }
    let first = merged.positions.len() as u32;
    merged.positions.extend_from_slice(&mesh.positions);
    merged.normals.extend_from_slice(&mesh.normals);
    merged.uvs.extend_from_slice(&mesh.uvs);
    merged.indices.extend(mesh.indices.iter().map(|index| index + first));
}
