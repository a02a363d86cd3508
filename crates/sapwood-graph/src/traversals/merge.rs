//! Merging by material: few large meshes instead of many small ones.

use std::fmt;
use std::sync::Arc;

use sapwood_geom::glam::Affine3;
use sapwood_geom::{Digest, FixedMap, Mesh, SharedMesh, fixed_state};

use super::{Body, CameraRow, DrawList, DrawRow, LabelRow, LightRow, LineRow, Occurrence};
use crate::{Kind, Material, Named};

/// What is merged with what.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Merge {
    /// What one body draws with one material; bodies and repeated meshes stay shared.
    Bodies,
    /// Everything drawn with one material, wherever it stands, every instance written out.
    All {
        /// How many triangles may be written.
        max_triangles: u64,
    },
}

/// The kind of the body that holds everything once all is merged.
struct Merged;

impl Named for Merged {
    const NAME: &'static str = "merged";
}

/// Merging would write more triangles than the caller allows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TooManyTriangles {
    /// How many triangles were allowed.
    pub limit: u64,
    /// How many there would be.
    pub needed: u64,
}

impl fmt::Display for TooManyTriangles {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "merging would write {} triangles, more than {}", self.needed, self.limit)
    }
}

impl std::error::Error for TooManyTriangles {}

impl DrawList {
    /// The list with meshes of equal materials merged. The list that it was made of, and the
    /// scene behind it, stay as they are.
    ///
    /// Merged meshes come first in a body, in the order in which their materials were first
    /// met; triangles keep their order, and face outwards under mirrored transforms too.
    ///
    /// # Errors
    /// When more triangles would be written than allowed.
    pub fn merged_by_material(&self, merge: Merge) -> Result<Self, TooManyTriangles> {
        let list = self.as_drawn();
        match merge {
            Merge::Bodies => {
                let bodies = list.bodies.iter().map(merged_body).collect();
                Ok(Self { bodies, occurrences: list.occurrences.clone() })
            }
            Merge::All { max_triangles } => {
                let (_, needed) = self.n_vertices_and_triangles();
                if needed > max_triangles {
                    return Err(TooManyTriangles { limit: max_triangles, needed });
                }
                Ok(list.all_merged())
            }
        }
    }

    fn all_merged(&self) -> Self {
        let mut body = Body::new(Kind::of::<Merged>());
        let mut merging = Merging::new();
        for Occurrence { body: number, world } in &self.occurrences {
            let Body { kind: _, rows, lines, lights, cameras, labels, rig: _, is_solid: _ } =
                &self.bodies[*number as usize];
            for row in rows {
                merging.add(row, &(*world * row.local));
            }
            let placed = |local: Affine3| *world * local;
            let lines = lines.iter().map(|row| LineRow { local: placed(row.local), ..row.clone() });
            body.lines.extend(lines);
            let lights =
                lights.iter().map(|row| LightRow { local: placed(row.local), ..row.clone() });
            body.lights.extend(lights);
            let cameras =
                cameras.iter().map(|row| CameraRow { local: placed(row.local), ..row.clone() });
            body.cameras.extend(cameras);
            let labels =
                labels.iter().map(|row| LabelRow { local: placed(row.local), ..row.clone() });
            body.labels.extend(labels);
        }
        body.rows = merging.finish();
        let occurrence = Occurrence { body: 0, world: Affine3::IDENTITY };
        Self { bodies: vec![body], occurrences: vec![occurrence] }
    }
}

/// A body whose single meshes are merged; repeated ones stay as they are.
fn merged_body(body: &Body) -> Body {
    let mut merging = Merging::new();
    let (repeated, single): (Vec<_>, Vec<_>) =
        body.rows.iter().partition(|row| row.instances.is_some());
    for row in single {
        merging.add(row, &row.local);
    }
    let mut rows = merging.finish();
    rows.extend(repeated.into_iter().cloned());
    Body { rows, ..body.clone() }
}

/// Meshes that grow, one for each material.
struct Merging {
    rows: Vec<(Arc<Material>, Vec<Mesh>)>,
    by_material: FixedMap<Digest, usize>,
}

impl Merging {
    fn new() -> Self {
        Self { rows: Vec::new(), by_material: FixedMap::with_hasher(fixed_state()) }
    }

    /// Adds what a row draws, after `transform`.
    fn add(&mut self, row: &DrawRow, transform: &Affine3) {
        let number = *self.by_material.entry(Digest::of(&row.material)).or_insert_with(|| {
            self.rows.push((Arc::clone(&row.material), vec![Mesh::default()]));
            self.rows.len() - 1
        });
        let meshes = &mut self.rows[number].1;
        let once = [Affine3::IDENTITY];
        for instance in row.instances.as_ref().map_or(&once[..], |instances| instances) {
            let n = row.mesh.n_vertices();
            // A 32-bit index numbers so many vertices and no more.
            if meshes.last().is_none_or(|mesh| mesh.n_vertices() + n > u32::MAX as usize) {
                meshes.push(Mesh::default());
            }
            if let Some(mesh) = meshes.last_mut() {
                mesh.append(&row.mesh, &(*transform * *instance));
            }
        }
    }

    fn finish(self) -> Vec<DrawRow> {
        let rows = self.rows.into_iter().flat_map(|(material, meshes)| {
            meshes.into_iter().map(move |mesh| {
                DrawRow::new(Affine3::IDENTITY, SharedMesh::new(mesh), Arc::clone(&material))
            })
        });
        rows.filter(|row| !row.mesh.is_empty()).collect()
    }
}

#[cfg(test)]
mod tests {
    use sapwood_geom::Shared;
    use sapwood_geom::glam::{Vec2, Vec3};

    use super::*;

    fn triangle() -> SharedMesh {
        SharedMesh::new(Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            normals: vec![Vec3::Z; 3],
            uvs: vec![Vec2::ZERO; 3],
            indices: vec![0, 1, 2],
        })
    }

    fn row(name: &str, local: Affine3, instances: Option<Vec<Affine3>>) -> DrawRow {
        let material = Arc::new(Material::matte(name, 0.5, 0.5, 0.5));
        let instances = instances.map(Shared::new);
        DrawRow { instances, ..DrawRow::new(local, triangle(), material) }
    }

    /// Two occurrences of a body of two materials, one of them mirrored; five triangles each.
    fn list() -> DrawList {
        let mut body = Body::new(Kind::of::<Merged>());
        let at = |x: f32| Affine3::from_translation(Vec3::X * x);
        let mirrored = Affine3::from_scale(Vec3::new(-1.0, 2.0, 1.0));
        body.rows = vec![
            row("bark", at(0.0), None),
            row("leaf", at(1.0), Some(vec![at(0.0), mirrored])),
            row("bark", at(2.0) * mirrored, None),
            row("leaf", at(3.0), None),
        ];
        let occurrences = [at(0.0), Affine3::from_scale(Vec3::new(1.0, 1.0, -1.0))]
            .map(|world| Occurrence { body: 0, world });
        DrawList { bodies: vec![body], occurrences: occurrences.into() }
    }

    /// The middle and twice the area vector of every triangle, after all transforms, rounded and
    /// in no order; area vectors point outwards.
    fn triangles(list: &DrawList) -> Vec<[i64; 6]> {
        let mut all = Vec::new();
        for (world, row) in list.placed_rows() {
            let once = [Affine3::IDENTITY];
            for instance in row.instances.as_ref().map_or(&once[..], |instances| instances) {
                let mut mesh = Mesh::default();
                mesh.append(&row.mesh, &(world * *instance));
                for t in mesh.indices.chunks_exact(3) {
                    let [a, b, c] = [t[0], t[1], t[2]].map(|i| mesh.positions[i as usize]);
                    let outwards = (b - a).cross(c - a);
                    assert!(outwards.dot(mesh.normals[t[0] as usize]) > 0.0);
                    let numbers = [a + b + c, outwards].map(|v| v.to_array());
                    let mut rounded = [0; 6];
                    for (to, from) in rounded.iter_mut().zip(numbers.as_flattened()) {
                        *to = (f64::from(*from) * 1e4).round() as i64;
                    }
                    all.push(rounded);
                }
            }
        }
        all.sort_unstable();
        all
    }

    #[test]
    fn merging_keeps_every_triangle_and_its_front() {
        let list = list();
        let bodies = list.merged_by_material(Merge::Bodies).unwrap();
        assert_eq!(triangles(&bodies), triangles(&list));
        let rows: Vec<_> = bodies.bodies[0]
            .rows
            .iter()
            .map(|row| (&*row.material.name, row.mesh.n_triangles()))
            .collect();
        assert_eq!(rows, [("bark", 2), ("leaf", 1), ("leaf", 1)]);
        let all = list.merged_by_material(Merge::All { max_triangles: 10 }).unwrap();
        assert_eq!(triangles(&all), triangles(&list));
        assert_eq!((all.bodies.len(), all.bodies[0].rows.len()), (1, 2));
        assert_eq!(all.n_vertices_and_triangles(), (30, 10));
        assert_eq!(list.bodies[0].rows.len(), 4, "the list that was merged stays as it is");
    }

    #[test]
    fn merging_keeps_to_its_limit() {
        let refused = list().merged_by_material(Merge::All { max_triangles: 9 });
        assert_eq!(refused.unwrap_err(), TooManyTriangles { limit: 9, needed: 10 });
    }
}
