//! The binary chunk: vertices and indices as glTF accessors over buffer views.

use gltf_json as json;
use json::Index;
use json::accessor::{ComponentType, GenericComponentType, Type};
use json::buffer::Target;
use json::validation::{Checked::Valid, USize64};
use sapwood_geom::glam::{Vec2, Vec3};
use sapwood_geom::{Aabb, Mesh};

/// The accessors of one primitive.
pub(super) struct Accessors {
    pub(super) positions: Index<json::Accessor>,
    pub(super) normals: Index<json::Accessor>,
    pub(super) uvs: Index<json::Accessor>,
    pub(super) indices: Index<json::Accessor>,
}

/// Bytes that a primitive takes in the binary chunk.
pub(super) fn byte_length(n_vertices: u64, n_indices: u64) -> u64 {
    let index = if fits_short(n_vertices) { 2 } else { 4 };
    n_vertices * 32 + (n_indices * index).next_multiple_of(4)
}

/// Whether 16 bits number the vertices; the largest number is kept free, for it restarts
/// primitives on some devices.
fn fits_short(n_vertices: u64) -> bool {
    n_vertices <= u64::from(u16::MAX)
}

/// The binary chunk while it grows; every view starts at a multiple of four bytes.
#[derive(Default)]
pub(super) struct BufferBuilder {
    bytes: Vec<u8>,
}

impl BufferBuilder {
    /// Adds the vertices and triangles of `mesh`; the error says what glTF does not allow.
    pub(super) fn add(&mut self, root: &mut json::Root, mesh: &Mesh) -> Result<Accessors, String> {
        check(mesh)?;
        let bounds = Aabb::of_points(mesh.positions.iter().copied());
        let extremes = Some((value(bounds.min), value(bounds.max)));
        let positions = self.vectors(root, &mesh.positions, extremes);
        let normals = self.vectors(root, &mesh.normals, None);
        let start = self.bytes.len();
        for Vec2 { x, y } in &mesh.uvs {
            self.float(*x);
            self.float(*y);
        }
        let kind = (ComponentType::F32, Type::Vec2, Target::ArrayBuffer);
        let uvs = self.accessor(root, start, mesh.uvs.len(), kind, None);
        let indices = self.indices(root, mesh);
        Ok(Accessors { positions, normals, uvs, indices })
    }

    fn vectors(
        &mut self,
        root: &mut json::Root,
        vectors: &[Vec3],
        extremes: Option<(json::Value, json::Value)>,
    ) -> Index<json::Accessor> {
        let start = self.bytes.len();
        for Vec3 { x, y, z } in vectors {
            self.float(*x);
            self.float(*y);
            self.float(*z);
        }
        let kind = (ComponentType::F32, Type::Vec3, Target::ArrayBuffer);
        self.accessor(root, start, vectors.len(), kind, extremes)
    }

    fn indices(&mut self, root: &mut json::Root, mesh: &Mesh) -> Index<json::Accessor> {
        let start = self.bytes.len();
        let component = if fits_short(mesh.positions.len() as u64) {
            for index in &mesh.indices {
                self.bytes.extend_from_slice(&(*index as u16).to_le_bytes());
            }
            ComponentType::U16
        } else {
            for index in &mesh.indices {
                self.bytes.extend_from_slice(&index.to_le_bytes());
            }
            ComponentType::U32
        };
        let kind = (component, Type::Scalar, Target::ElementArrayBuffer);
        self.accessor(root, start, mesh.indices.len(), kind, None)
    }

    fn float(&mut self, value: f32) {
        self.bytes.extend_from_slice(&value.to_le_bytes());
    }

    /// A view over everything since `start` and an accessor over the whole view.
    fn accessor(
        &mut self,
        root: &mut json::Root,
        start: usize,
        count: usize,
        (component, type_, target): (ComponentType, Type, Target),
        extremes: Option<(json::Value, json::Value)>,
    ) -> Index<json::Accessor> {
        let view = root.push(json::buffer::View {
            buffer: Index::new(0),
            byte_length: USize64::from(self.bytes.len() - start),
            byte_offset: (start > 0).then(|| USize64::from(start)),
            byte_stride: None,
            name: None,
            target: Some(Valid(target)),
            extensions: None,
            extras: None,
        });
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let (min, max) = extremes.unzip();
        root.push(json::Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: USize64::from(count),
            component_type: Valid(GenericComponentType(component)),
            type_: Valid(type_),
            min,
            max,
            name: None,
            normalized: false,
            sparse: None,
            extensions: None,
            extras: None,
        })
    }

    /// Declares the buffer and hands over its bytes; nothing where it is empty.
    pub(super) fn finish(self, root: &mut json::Root) -> Option<Vec<u8>> {
        if self.bytes.is_empty() {
            return None;
        }
        root.push(json::Buffer {
            byte_length: USize64::from(self.bytes.len()),
            name: None,
            uri: None,
            extensions: None,
            extras: None,
        });
        Some(self.bytes)
    }
}

fn value(vector: Vec3) -> json::Value {
    json::Value::from(vector.to_array().map(f64::from).to_vec())
}

/// What glTF does not allow in `mesh`, if anything.
fn check(mesh: &Mesh) -> Result<(), String> {
    let n = mesh.positions.len();
    if mesh.normals.len() != n || mesh.uvs.len() != n {
        let (normals, uvs) = (mesh.normals.len(), mesh.uvs.len());
        return Err(format!("{n} positions, {normals} normals, {uvs} texture coordinates"));
    }
    if let Some(i) = mesh.positions.iter().position(|position| !position.is_finite()) {
        return Err(format!("the position of vertex {i} is {}", mesh.positions[i]));
    }
    if let Some(i) = mesh.uvs.iter().position(|uv| !uv.is_finite()) {
        return Err(format!("the texture coordinate of vertex {i} is {}", mesh.uvs[i]));
    }
    // Catches NaN too. The validator's own tolerance is about 0.007.
    let unit = |normal: &Vec3| (normal.length_squared() - 1.0).abs() <= 0.01;
    if let Some(i) = mesh.normals.iter().position(|normal| !unit(normal)) {
        return Err(format!("the normal of vertex {i} is {}, not of length 1", mesh.normals[i]));
    }
    match mesh.indices.iter().find(|index| **index as usize >= n) {
        Some(index) => Err(format!("a triangle uses vertex {index} of {n}")),
        None => Ok(()),
    }
}
