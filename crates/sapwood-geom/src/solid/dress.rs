//! The union of meshes: what it takes over from them are normals and texture coordinates.

use glam::{DVec3, Vec2, Vec3};

use super::{Solid, Union};
use crate::{FixedMap, Mesh, fixed_state};

/// A union as meshes, one for each of `n_materials` materials. Together these are closed: where two of
/// them meet, both have the very same edges. `part` gives the meshes whose solids
/// ([`Solid::of_mesh`]) were joined, by their numbers, and is asked for few at a time; `materials` has
/// the number of each one's material.
///
/// Normals and texture coordinates are those of the mesh that a triangle comes from. Meshes must
/// be [sound](Mesh::unsound).
///
/// # Panics
/// Where there is not a material for each part of the union, or one has too large a number.
pub fn dressed(
    union: &Union,
    part: &dyn Fn(u32) -> Mesh,
    materials: &[u32],
    n_materials: usize,
) -> Vec<Mesh> {
    let mut dressed = vec![Dressing::new(); n_materials];
    let mut last: Option<(u32, Mesh, Vec<u32>)> = None;
    // Triangles of one part lie together.
    for (number, (of, triangle)) in union.sources.iter().enumerate() {
        let is_other = |last: &mut (u32, Mesh, Vec<u32>)| last.0 != *of;
        if last.take_if(is_other).is_some() || last.is_none() {
            let mesh = part(*of);
            let origins = Solid::with_origins(&mesh).1;
            last = Some((*of, mesh, origins));
        }
        let source = last.as_ref().and_then(|(_, mesh, origins)| {
            Some(Source::new(mesh, *origins.get((*triangle)? as usize)?))
        });
        let dressing = &mut dressed[materials[*of as usize] as usize];
        dressing.add(&union.solid, number, *of, source.as_ref());
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
        let dressed = dressed(&joined, &|part| meshes[part as usize].clone(), &[0, 1, 0], 2);
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
