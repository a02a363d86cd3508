//! The union of meshes: what it takes over from them are normals and texture coordinates.

use glam::{DVec3, Vec2, Vec3};

use super::{Solid, Union};
use crate::{FixedMap, Mesh, fixed_state};

/// A union as meshes, one for each of `n_materials` materials. Together these are closed: where two of
/// them meet, both have the very same edges. `meshes` are those whose solids
/// ([`Solid::of_mesh`]) were joined, in this order, and `materials` the number of each one's
/// material.
///
/// Normals and texture coordinates are those of the mesh that a triangle comes from. Meshes must
/// be [sound](Mesh::unsound).
///
/// # Panics
/// Where there is not a material for each mesh, or one has too large a number, or the union is of
/// more meshes.
pub fn dressed(union: &Union, meshes: &[Mesh], materials: &[u32], n_materials: usize) -> Vec<Mesh> {
    assert_eq!(meshes.len(), materials.len(), "each mesh has a material");
    let origins: Vec<Vec<u32>> = meshes.iter().map(|mesh| Solid::with_origins(mesh).1).collect();
    let mut dressed = vec![Dressing::new(); n_materials];
    for (number, (part, triangle)) in union.sources.iter().enumerate() {
        let (mesh, part) = (&meshes[*part as usize], *part as usize);
        let origin = triangle.and_then(|triangle| origins[part].get(triangle as usize));
        let source = origin.map(|origin| Source::new(mesh, *origin));
        dressed[materials[part] as usize].add(&union.solid, number, part as u32, source.as_ref());
    }
    dressed.into_iter().map(|dressing| dressing.mesh).collect()
}

/// A triangle that others were cut from.
struct Source<'a> {
    mesh: &'a Mesh,
    vertices: [usize; 3],
}

impl<'a> Source<'a> {
    fn new(mesh: &'a Mesh, triangle: u32) -> Self {
        let first = 3 * triangle as usize;
        Self { mesh, vertices: [0, 1, 2].map(|i| mesh.indices[first + i] as usize) }
    }

    /// Normal and texture coordinates at a point of the triangle.
    fn at(&self, point: Vec3) -> (Vec3, Vec2) {
        let Self { mesh, vertices } = self;
        if let Some(vertex) = vertices.iter().find(|vertex| mesh.positions[**vertex] == point) {
            return (mesh.normals[*vertex], mesh.uvs[*vertex]);
        }
        let weights = weights(vertices.map(|vertex| mesh.positions[vertex]), point);
        let mixed =
            |of: &dyn Fn(usize) -> Vec3| (0..3).map(|i| of(vertices[i]) * weights[i]).sum::<Vec3>();
        let normal = mixed(&|vertex| mesh.normals[vertex]);
        let uv = mixed(&|vertex| mesh.uvs[vertex].extend(0.0));
        (normal.normalize_or(mesh.normals[vertices[0]]), uv.truncate())
    }
}

/// How much each corner weighs at a point of the triangle; at the nearest one, more or less, where
/// the point lies beside it.
fn weights(corners: [Vec3; 3], point: Vec3) -> [f32; 3] {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let point = point.as_dvec3();
    let normal = (b - a).cross(c - a);
    let area = |from: DVec3, to: DVec3| (from - point).cross(to - point).dot(normal).max(0.0);
    let areas = [area(b, c), area(c, a), area(a, b)];
    let all: f64 = areas.iter().sum();
    if all > 0.0 { areas.map(|area| (area / all) as f32) } else { [1.0, 0.0, 0.0] }
}

/// A mesh that grows.
#[derive(Clone)]
struct Dressing {
    mesh: Mesh,
    /// Vertices by corner, part, and normal and texture coordinates rounded.
    vertices: FixedMap<(u32, u32, [i32; 5]), u32>,
}

impl Dressing {
    fn new() -> Self {
        Self { mesh: Mesh::default(), vertices: FixedMap::with_hasher(fixed_state()) }
    }

    fn add(&mut self, solid: &Solid, triangle: usize, part: u32, source: Option<&Source<'_>>) {
        let corners = solid.corners(triangle);
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let flat = (b - a).cross(c - a).normalize_or(DVec3::Z).as_vec3();
        for (corner, position) in solid.triangles[triangle].into_iter().zip(corners) {
            let (normal, uv) = source.map_or((flat, Vec2::ZERO), |source| source.at(position));
            // What was moved a little may face elsewhere now.
            let normal = if normal.dot(flat) > 0.05 { normal } else { flat };
            let rounded = |x: f32| (x * 2048.0).round() as i32;
            let key = [normal.x, normal.y, normal.z, uv.x, uv.y].map(rounded);
            let mesh = &mut self.mesh;
            let vertex = *self.vertices.entry((corner, part, key)).or_insert_with(|| {
                mesh.positions.push(position);
                mesh.normals.push(normal);
                mesh.uvs.push(uv);
                mesh.positions.len() as u32 - 1
            });
            mesh.indices.push(vertex);
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Affine3;

    use super::*;
    use crate::shapes::sphere;
    use crate::union;

    #[test]
    fn materials_close_each_other_and_keep_their_normals() {
        let mut meshes = vec![sphere(3)];
        for place in [Vec3::X, Vec3::Y] {
            let mut mesh = Mesh::default();
            mesh.append(&sphere(3), &Affine3::from_translation(place));
            meshes.push(mesh);
        }
        let solids: Vec<Solid> = meshes.iter().map(Solid::of_mesh).collect();
        let joined = union(&solids, 100_000, &|_| true).unwrap();
        let dressed = dressed(&joined, &meshes, &[0, 1, 0], 2);
        let mut all = Mesh::default();
        for mesh in &dressed {
            assert_eq!(mesh.fault(), None);
            assert!(mesh.n_open_edges() > 0);
            all.append(mesh, &Affine3::IDENTITY);
        }
        assert_eq!(all.n_open_edges(), 0);
        assert_eq!(all.n_triangles(), joined.solid.triangles.len());
        // The normal of a sphere's point is its direction from the middle.
        let centers = [Vec3::ZERO, Vec3::X, Vec3::Y];
        for (position, normal) in all.positions.iter().zip(&all.normals) {
            let fits = |center: &Vec3| (position - center).normalize().dot(*normal) > 0.99;
            assert!(centers.iter().any(fits), "{position} {normal}");
        }
    }
}
