//! Indexed triangle meshes.

use std::ops::{Deref, Range};
use std::sync::OnceLock;

use glam::{Affine3, Vec2, Vec3};

use crate::{Bound, Content, Digester, FixedMap, MeshBvh, Shared, fixed_state};

/// An indexed triangle mesh with a normal and a texture coordinate for every vertex.
///
/// Triangles wind counter-clockwise seen from outside; normals have unit length. Texture
/// coordinates follow glTF: `v` grows downwards in the image.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions in metres.
    pub positions: Vec<Vec3>,
    /// Unit normals, one for each position.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, one for each position.
    pub uvs: Vec<Vec2>,
    /// Three vertex numbers for each triangle.
    pub indices: Vec<u32>,
}

impl Mesh {
    /// Number of triangles.
    pub fn n_triangles(&self) -> usize {
        self.indices.len() / 3
    }

    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        self.positions.len()
    }

    /// Whether the mesh has no triangle.
    pub fn is_empty(&self) -> bool {
        self.indices.is_empty()
    }

    /// The bound of all positions; costs one pass over them.
    pub fn bound(&self) -> Bound {
        Bound::of_points(self.positions.iter().copied())
    }

    /// Adds the triangles of `other` after `transform`.
    ///
    /// Normals are turned by the inverse transpose; where the transform mirrors, the winding is
    /// turned round too.
    ///
    /// # Panics
    /// Where the vertices together exceed what a 32-bit index can number.
    pub fn append(&mut self, other: &Mesh, transform: &Affine3) {
        let first = u32::try_from(self.positions.len() + other.positions.len())
            .map(|_| self.positions.len() as u32)
            .expect("a mesh has fewer than 2^32 vertices");
        let to_normal = transform.matrix3.inverse().transpose();
        self.positions.extend(other.positions.iter().map(|p| transform.transform_point3(*p)));
        self.normals.extend(other.normals.iter().map(|n| (to_normal * *n).normalize_or(*n)));
        self.uvs.extend_from_slice(&other.uvs);
        let mirrors = transform.matrix3.determinant() < 0.0;
        for triangle in other.indices.chunks_exact(3) {
            let [a, b, c] = [triangle[0] + first, triangle[1] + first, triangle[2] + first];
            self.indices.extend(if mirrors { [a, c, b] } else { [a, b, c] });
        }
    }

    /// Some of the triangles, in their order, with the vertices that they need.
    ///
    /// # Panics
    /// Where an index has no vertex, or there are fewer triangles.
    pub fn part(&self, triangles: Range<u32>) -> Self {
        let indices = &self.indices[3 * triangles.start as usize..3 * triangles.end as usize];
        let mut is_used = vec![false; self.n_vertices()];
        indices.iter().for_each(|index| is_used[*index as usize] = true);
        let mut part = Self::default();
        let mut numbers = vec![0; self.n_vertices()];
        for vertex in (0..self.n_vertices()).filter(|vertex| is_used[*vertex]) {
            numbers[vertex] = part.positions.len() as u32;
            part.positions.push(self.positions[vertex]);
            part.normals.push(self.normals[vertex]);
            part.uvs.push(self.uvs[vertex]);
        }
        part.indices = indices.iter().map(|index| numbers[*index as usize]).collect();
        part
    }

    /// Why nobody could draw or pick the mesh, in words, or nothing where it is sound: lengths
    /// agree, indices come in threes and are in range, and everything is finite.
    pub fn unsound(&self) -> Option<String> {
        let n = self.positions.len();
        // Nearly every mesh is sound, which one look at everything finds out; only then is it
        // asked where the fault lies.
        let highest = self.indices.iter().fold(0, |highest: u32, index| highest.max(*index));
        let are_finite = |vectors: &[Vec3]| {
            // What is not finite leaves no zero when it is multiplied with zero.
            let sum = vectors.iter().fold(Vec3::ZERO, |sum, v| sum + *v * 0.0);
            sum == Vec3::ZERO
        };
        if self.normals.len() == n
            && self.uvs.len() == n
            && self.indices.len().is_multiple_of(3)
            && (self.indices.is_empty() || (highest as usize) < n)
            && are_finite(&self.positions)
            && are_finite(&self.normals)
            && self.uvs.iter().fold(Vec2::ZERO, |sum, uv| sum + *uv * 0.0) == Vec2::ZERO
        {
            return None;
        }
        if self.normals.len() != n || self.uvs.len() != n {
            return Some(format!(
                "{n} positions, {} normals, {} texture coordinates",
                self.normals.len(),
                self.uvs.len()
            ));
        }
        if !self.indices.len().is_multiple_of(3) {
            return Some("a mesh has indices that are no triangle".to_owned());
        }
        if let Some(index) = self.indices.iter().find(|index| **index as usize >= n) {
            return Some(format!("a triangle uses vertex {index} of {n}"));
        }
        if let Some(i) = self.positions.iter().position(|position| !position.is_finite()) {
            return Some(format!("the position of vertex {i} is {}", self.positions[i]));
        }
        if let Some(i) = self.normals.iter().position(|normal| !normal.is_finite()) {
            return Some(format!("the normal of vertex {i} is {}", self.normals[i]));
        }
        let i = self.uvs.iter().position(|uv| !uv.is_finite())?;
        Some(format!("the texture coordinate of vertex {i} is {}", self.uvs[i]))
    }

    /// The first fault found, in words, or nothing: the mesh is [sound](Self::unsound), normals
    /// have unit length and no triangle is degenerate.
    ///
    /// A triangle is degenerate when two of its corners are the same vertex or its height over
    /// its longest edge is below a millionth of that edge.
    pub fn fault(&self) -> Option<String> {
        if let Some(fault) = self.unsound() {
            return Some(fault);
        }
        let is_unit = |normal: &Vec3| (normal.length() - 1.0).abs() <= 1e-3;
        if let Some(i) = self.normals.iter().position(|normal| !is_unit(normal)) {
            let normal = self.normals[i];
            return Some(format!("the normal of vertex {i} is {normal}, not of length 1"));
        }
        self.indices.chunks_exact(3).enumerate().find_map(|(number, t)| {
            self.is_degenerate([t[0], t[1], t[2]]).then(|| {
                let [a, b, c] = [t[0], t[1], t[2]].map(|i| self.positions[i as usize]);
                format!("triangle {number} is degenerate: {a} {b} {c}")
            })
        })
    }

    /// Whether a triangle between these vertices is too thin to have a normal.
    pub(crate) fn is_degenerate(&self, corners: [u32; 3]) -> bool {
        let [a, b, c] = corners.map(|i| self.positions[i as usize]);
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        let doubled_area = (b - a).cross(c - a).length();
        doubled_area <= 1e-6 * longest * longest
    }

    /// Gives triangles, from index `first` on, a vertex with their own normal where a corner's is
    /// more than 90 degrees off it. `copied` is told for each, in their order, of which vertex it is a
    /// copy.
    pub(crate) fn keep_own_normals(&mut self, first: usize, mut copied: impl FnMut(u32)) {
        for first in (first..self.indices.len()).step_by(3) {
            let corners = [0, 1, 2].map(|i| self.indices[first + i] as usize);
            let [p, q, r] = corners.map(|i| self.positions[i]);
            let Some(face) = (q - p).cross(r - p).try_normalize() else { continue };
            for (i, corner) in corners.into_iter().enumerate() {
                // A little more than nothing, for the sign to be sure.
                if self.normals[corner].dot(face) <= 1e-4 {
                    self.indices[first + i] = self.positions.len() as u32;
                    self.positions.push(self.positions[corner]);
                    self.uvs.push(self.uvs[corner]);
                    self.normals.push(face);
                    copied(corner as u32);
                }
            }
        }
    }

    /// How many edges bound one triangle only. Corners with equal positions count as one, so
    /// that seams of texture coordinates and of normals are no borders. Not a fault in itself:
    /// leaves are open. The mesh must be sound.
    pub fn n_open_edges(&self) -> usize {
        let mut points: FixedMap<[u32; 3], u32> = FixedMap::with_hasher(fixed_state());
        let mut point = |index: u32| {
            let bits = (self.positions[index as usize] + 0.0).to_array().map(f32::to_bits);
            let next = points.len() as u32;
            *points.entry(bits).or_insert(next)
        };
        let mut edges: FixedMap<(u32, u32), u32> = FixedMap::with_hasher(fixed_state());
        for t in self.indices.chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(&mut point);
            for (one, other) in [(a, b), (b, c), (c, a)] {
                *edges.entry((one.min(other), one.max(other))).or_default() += 1;
            }
        }
        edges.values().filter(|n| **n == 1).count()
    }
}

impl Content for Mesh {
    fn write(&self, digester: &mut Digester) {
        self.positions.write(digester);
        self.normals.write(digester);
        self.uvs.write(digester);
        self.indices.write(digester);
    }
}

/// A finished mesh that many places share, with its bound taken once.
#[derive(Clone, Debug, PartialEq)]
pub struct SharedMesh(Shared<Bounded>);

#[derive(Debug)]
struct Bounded {
    mesh: Mesh,
    bound: Bound,
    /// Found out when somebody asks for the first time.
    unsound: OnceLock<Option<String>>,
    /// Made when a ray comes by for the first time.
    bvh: OnceLock<MeshBvh>,
}

impl Content for Bounded {
    fn write(&self, digester: &mut Digester) {
        self.mesh.write(digester);
    }
}

impl SharedMesh {
    /// Shares a finished mesh; costs one pass over its positions.
    pub fn new(mesh: Mesh) -> Self {
        let bound = mesh.bound();
        let (unsound, bvh) = (OnceLock::new(), OnceLock::new());
        Self(Shared::new(Bounded { mesh, bound, unsound, bvh }))
    }

    /// The bound of all positions.
    pub fn bound(&self) -> &Bound {
        &self.0.bound
    }

    /// As [`Mesh::unsound`]; the first call finds it out.
    pub fn unsound(&self) -> Option<&str> {
        self.0.unsound.get_or_init(|| self.0.mesh.unsound()).as_deref()
    }

    /// The tree of the mesh's triangles, which must be sound; the first call makes it.
    pub fn bvh(&self) -> &MeshBvh {
        self.0.bvh.get_or_init(|| MeshBvh::new(&self.0.mesh))
    }

    /// Whether both are one and the same allocation; equal content may still lie in two.
    pub fn is_same(&self, other: &Self) -> bool {
        self.0.is_same(&other.0)
    }
}

impl Deref for SharedMesh {
    type Target = Mesh;

    fn deref(&self) -> &Mesh {
        &self.0.mesh
    }
}

impl Content for SharedMesh {
    fn write(&self, digester: &mut Digester) {
        self.0.write(digester);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle() -> Mesh {
        Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            normals: vec![Vec3::Z; 3],
            uvs: vec![Vec2::ZERO, Vec2::X, Vec2::Y],
            indices: vec![0, 1, 2],
        }
    }

    #[test]
    fn a_mirrored_triangle_keeps_facing_its_normal() {
        let mut mesh = Mesh::default();
        mesh.append(&triangle(), &Affine3::from_scale(Vec3::new(-1.0, 1.0, 1.0)));
        let [a, b, c] = [0, 1, 2].map(|i| mesh.positions[mesh.indices[i] as usize]);
        assert!((b - a).cross(c - a).dot(mesh.normals[0]) > 0.0);
        assert_eq!(mesh.fault(), None);
    }

    #[test]
    fn parts_of_a_mesh_have_their_own_vertices_alone() {
        let mut mesh = Mesh::default();
        for x in 0..3 {
            mesh.append(&triangle(), &Affine3::from_translation(Vec3::X * x as f32));
        }
        mesh.indices.extend([0, 4, 8]);
        let (part, one) = (mesh.part(1..2), mesh.part(3..4));
        assert_eq!((part.n_vertices(), &*part.indices), (3, &[0, 1, 2][..]));
        assert_eq!(part.positions, mesh.positions[3..6]);
        assert_eq!([0, 1, 2].map(|i| one.positions[i]), [0, 4, 8].map(|i| mesh.positions[i]));
        assert_eq!(mesh.part(0..0), Mesh::default());
    }

    #[test]
    fn faults_are_named() {
        let mut mesh = triangle();
        mesh.indices[2] = 3;
        assert_eq!(mesh.fault().as_deref(), Some("a triangle uses vertex 3 of 3"));
        let mut mesh = triangle();
        mesh.positions[2] = Vec3::new(2.0, 0.0, 0.0);
        assert!(mesh.fault().is_some_and(|fault| fault.contains("degenerate")));
        let mut mesh = triangle();
        mesh.normals[1] = Vec3::NAN;
        assert!(mesh.fault().is_some_and(|fault| fault.starts_with("the normal of vertex 1")));
    }

    #[test]
    fn a_mesh_with_faults_that_harm_nobody_is_sound() {
        let mut mesh = triangle();
        mesh.positions[2] = Vec3::new(2.0, 0.0, 0.0);
        mesh.normals[1] = Vec3::ZERO;
        assert_eq!(mesh.unsound(), None);
        mesh.normals[1] = Vec3::INFINITY;
        assert!(mesh.unsound().is_some_and(|fault| fault.starts_with("the normal of vertex 1")));
        mesh.normals.pop();
        let fault = mesh.unsound();
        assert_eq!(SharedMesh::new(mesh).unsound(), fault.as_deref());
        assert_eq!(fault.as_deref(), Some("3 positions, 2 normals, 3 texture coordinates"));
    }
}
