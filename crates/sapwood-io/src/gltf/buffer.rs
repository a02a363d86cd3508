//! The binary chunk: vertices and indices as glTF accessors over buffer views.

use gltf_json as json;
use json::Index;
use json::accessor::{ComponentType, GenericComponentType, Type};
use json::buffer::Target;
use json::validation::{Checked::Valid, USize64};
use sapwood_geom::Aabb;
use sapwood_geom::glam::{Vec2, Vec3};

use super::sway::Skeleton;
use crate::parts::Part;
use crate::sound;

/// The accessors of one primitive.
pub(super) struct Accessors {
    pub(super) positions: Index<json::Accessor>,
    pub(super) normals: Index<json::Accessor>,
    pub(super) uvs: Index<json::Accessor>,
    pub(super) indices: Index<json::Accessor>,
}

/// Bytes that a part takes in the binary chunk.
pub(super) fn byte_length(part: &Part<'_>) -> u64 {
    let (n_vertices, n_indices) = part.size();
    n_vertices * 32 + (n_indices * index_size(n_vertices)).next_multiple_of(4)
}

/// Bytes that the joints of a part's vertices take.
pub(super) fn joints_length(part: &Part<'_>, skeleton: &Skeleton<'_>) -> u64 {
    part.size().0 * (4 * skeleton.number_size() as u64 + 4)
}

/// Two bytes where 16 bits number the vertices, else four; the largest number is kept free, for
/// it restarts primitives on some devices.
fn index_size(n_vertices: u64) -> u64 {
    if n_vertices <= u64::from(u16::MAX) { 2 } else { 4 }
}

/// The binary chunk while it is filled; every view starts at a multiple of four bytes.
#[derive(Default)]
pub(super) struct BufferBuilder {
    bytes: Vec<u8>,
    /// Where the next part goes.
    next: usize,
}

impl BufferBuilder {
    /// A chunk of this many bytes, the sum of all parts and images.
    pub(super) fn new(bytes: u64) -> Self {
        Self { bytes: vec![0; bytes as usize], next: 0 }
    }

    /// Adds the vertices and triangles of `part`; the error says what glTF does not allow.
    pub(super) fn add(
        &mut self,
        root: &mut json::Root,
        part: &Part<'_>,
    ) -> Result<Accessors, String> {
        if !part.is_triangles() {
            return Err("a mesh has indices that are no triangle".to_owned());
        }
        let (n_vertices, n_indices) = part.size();
        let index_size = index_size(n_vertices) as usize;
        let (n_vertices, n_indices) = (n_vertices as usize, n_indices as usize);
        let mut bounds = Aabb::EMPTY;

        let start = self.next;
        self.next += byte_length(part) as usize;
        let (positions, rest) = self.bytes[start..self.next].split_at_mut(n_vertices * 12);
        let (normals, rest) = rest.split_at_mut(n_vertices * 12);
        let (uvs, indices) = rest.split_at_mut(n_vertices * 8);
        let (mut vertex, mut index) = (0, 0);
        part.each_mesh(|mesh| {
            sound::check(mesh)?;
            bounds = mesh.positions.iter().fold(bounds, |bounds, point| bounds.with_point(*point));
            write_floats(&mut positions[vertex * 12..], &mesh.positions, Vec3::to_array);
            write_floats(&mut normals[vertex * 12..], &mesh.normals, Vec3::to_array);
            write_floats(&mut uvs[vertex * 8..], &mesh.uvs, Vec2::to_array);
            let places = indices[index * index_size..].chunks_exact_mut(index_size);
            for (place, i) in places.zip(&mesh.indices) {
                // The lower half of a number that fits is the number.
                place.copy_from_slice(&(vertex as u32 + i).to_le_bytes()[..index_size]);
            }
            vertex += mesh.positions.len();
            index += mesh.indices.len();
            Ok::<_, String>(())
        })?;

        let vectors = (ComponentType::F32, Type::Vec3, Some(Target::ArrayBuffer));
        let pairs = (ComponentType::F32, Type::Vec2, Some(Target::ArrayBuffer));
        let numbers = if index_size == 2 { ComponentType::U16 } else { ComponentType::U32 };
        let numbers = (numbers, Type::Scalar, Some(Target::ElementArrayBuffer));
        let mut at = start;
        let mut next = |count, size, kind| {
            let accessor = accessor(root, at, count, size, kind);
            at += count * size;
            accessor
        };
        let accessors = Accessors {
            positions: next(n_vertices, 12, vectors),
            normals: next(n_vertices, 12, vectors),
            uvs: next(n_vertices, 8, pairs),
            indices: next(n_indices, index_size, numbers),
        };
        let positions = &mut root.accessors[accessors.positions.value()];
        (positions.min, positions.max) = (Some(value(bounds.min)), Some(value(bounds.max)));
        Ok(accessors)
    }

    /// Adds for each vertex of `part` the joint that it follows, wholly.
    pub(super) fn add_joints(
        &mut self,
        root: &mut json::Root,
        part: &Part<'_>,
        skeleton: &Skeleton<'_>,
    ) -> (Index<json::Accessor>, Index<json::Accessor>) {
        let (n, size) = (part.size().0 as usize, skeleton.number_size());
        let start = self.next;
        self.next += joints_length(part, skeleton) as usize;
        let (joints, weights) = self.bytes[start..self.next].split_at_mut(4 * size * n);
        let mut places = joints.chunks_exact_mut(4 * size);
        part.each_vertex(|row, i| {
            let number = skeleton.number(row.follows.as_ref(), i).to_le_bytes();
            if let Some(place) = places.next() {
                place[..size].copy_from_slice(&number[..size]);
            }
        });
        weights.chunks_exact_mut(4).for_each(|weights| weights[0] = u8::MAX);
        let component = if size == 1 { ComponentType::U8 } else { ComponentType::U16 };
        let kind = (component, Type::Vec4, Some(Target::ArrayBuffer));
        let joints = accessor(root, start, n, 4 * size, kind);
        let kind = (ComponentType::U8, Type::Vec4, Some(Target::ArrayBuffer));
        let weights = accessor(root, start + 4 * size * n, n, 4, kind);
        root.accessors[weights.value()].normalized = true;
        (joints, weights)
    }

    /// Adds numbers that are no vertices, `N` to an element.
    pub(super) fn add_floats<const N: usize>(
        &mut self,
        root: &mut json::Root,
        type_: Type,
        floats: &[[f32; N]],
    ) -> Index<json::Accessor> {
        let start = self.next;
        self.next += size_of_val(floats);
        write_floats(&mut self.bytes[start..self.next], floats, |element| *element);
        accessor(root, start, floats.len(), 4 * N, (ComponentType::F32, type_, None))
    }

    /// Adds the bytes of an image, whose view is declared already.
    pub(super) fn add_image(&mut self, bytes: &[u8]) {
        self.bytes[self.next..self.next + bytes.len()].copy_from_slice(bytes);
        self.next += bytes.len().next_multiple_of(4);
    }

    /// Declares the buffer and hands over its bytes; nothing where it is empty.
    pub(super) fn finish(self, root: &mut json::Root) -> Option<Vec<u8>> {
        debug_assert_eq!(self.next, self.bytes.len());
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

fn write_floats<T, const N: usize>(bytes: &mut [u8], vectors: &[T], to_array: fn(&T) -> [f32; N]) {
    for (place, vector) in bytes.chunks_exact_mut(N * 4).zip(vectors) {
        place.copy_from_slice(to_array(vector).map(f32::to_le_bytes).as_flattened());
    }
}

/// A view of `count` elements of `size` bytes from `start`, and an accessor over all of it.
fn accessor(
    root: &mut json::Root,
    start: usize,
    count: usize,
    size: usize,
    (component, type_, target): (ComponentType, Type, Option<Target>),
) -> Index<json::Accessor> {
    let view = root.push(json::buffer::View {
        buffer: Index::new(0),
        byte_length: USize64::from(count * size),
        byte_offset: (start > 0).then(|| USize64::from(start)),
        byte_stride: None,
        name: None,
        target: target.map(Valid),
        extensions: None,
        extras: None,
    });
    root.push(json::Accessor {
        buffer_view: Some(view),
        byte_offset: None,
        count: USize64::from(count),
        component_type: Valid(GenericComponentType(component)),
        type_: Valid(type_),
        min: None,
        max: None,
        name: None,
        normalized: false,
        sparse: None,
        extensions: None,
        extras: None,
    })
}

fn value(vector: Vec3) -> json::Value {
    json::Value::from(vector.to_array().map(f64::from).to_vec())
}
