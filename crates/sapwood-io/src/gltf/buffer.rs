//! The binary chunk: vertices and indices as glTF accessors over buffer views.

use gltf_json as json;
use json::Index;
use json::accessor::{ComponentType, GenericComponentType, Type};
use json::buffer::Target;
use json::validation::{Checked::Valid, USize64};
use sapwood_geom::glam::{Vec2, Vec3};
use sapwood_geom::{Aabb, Mesh};

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
    n_vertices * VERTEX as u64 + (n_indices * index_size(n_vertices)).next_multiple_of(4)
}

/// Bytes that the joints of a part's vertices take.
pub(super) fn joints_length(part: &Part<'_>, skeleton: &Skeleton<'_>) -> u64 {
    part.size().0 * (4 * skeleton.number_size() as u64 + 4)
}

/// Two bytes where 16 bits number the vertices, else four; the largest number is kept free, for
/// it restarts primitives on some devices.
pub(super) fn index_size(n_vertices: u64) -> u64 {
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

        let start = self.next;
        self.next += byte_length(part) as usize;
        let (vertices, indices) = self.bytes[start..self.next].split_at_mut(n_vertices * VERTEX);
        let (mut vertices, mut index) = (Vertices::new(vertices, n_vertices), 0);
        part.each_mesh(|mesh| {
            let places = indices[index * index_size..].chunks_exact_mut(index_size);
            write_numbers(places, vertices.n as u32, &mesh.indices);
            index += mesh.indices.len();
            vertices.write(mesh)
        })?;
        let bounds = vertices.bounds;
        let [positions, normals, uvs] = vertex_accessors(root, start, n_vertices, &bounds);
        let kind = (component(index_size), Type::Scalar, Some(Target::ElementArrayBuffer));
        let start = start + n_vertices * VERTEX;
        let indices = accessor(root, start, n_indices, index_size, kind);
        Ok(Accessors { positions, normals, uvs, indices })
    }

    /// Adds the vertices of several parts, `n` of them, as the same three accessors.
    pub(super) fn add_vertices(
        &mut self,
        root: &mut json::Root,
        parts: &[Part<'_>],
        n: usize,
    ) -> Result<[Index<json::Accessor>; 3], String> {
        let start = self.next;
        self.next += n * VERTEX;
        let mut vertices = Vertices::new(&mut self.bytes[start..self.next], n);
        parts.iter().try_for_each(|part| part.each_mesh(|mesh| vertices.write(mesh)))?;
        let bounds = vertices.bounds;
        Ok(vertex_accessors(root, start, n, &bounds))
    }

    /// Adds whole numbers of `size` bytes, 2 or 4; for triangles where `target` says so.
    pub(super) fn add_numbers(
        &mut self,
        root: &mut json::Root,
        size: usize,
        target: Option<Target>,
        numbers: &[u32],
    ) -> Index<json::Accessor> {
        let start = self.next;
        self.next += (numbers.len() * size).next_multiple_of(4);
        write_numbers(self.bytes[start..self.next].chunks_exact_mut(size), 0, numbers);
        accessor(root, start, numbers.len(), size, (component(size), Type::Scalar, target))
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

/// Bytes of a vertex: position, normal and texture coordinates.
pub(super) const VERTEX: usize = 32;

/// Vertices while they are written: all positions, all normals, all texture coordinates.
struct Vertices<'a> {
    positions: &'a mut [u8],
    normals: &'a mut [u8],
    uvs: &'a mut [u8],
    /// How many are written.
    n: usize,
    bounds: Aabb,
}

impl<'a> Vertices<'a> {
    /// Room for `n` of them.
    fn new(bytes: &'a mut [u8], n: usize) -> Self {
        let (positions, rest) = bytes.split_at_mut(n * 12);
        let (normals, uvs) = rest.split_at_mut(n * 12);
        Self { positions, normals, uvs, n: 0, bounds: Aabb::EMPTY }
    }

    fn write(&mut self, mesh: &Mesh) -> Result<(), String> {
        sound::check(mesh)?;
        let points = mesh.positions.iter();
        self.bounds = points.fold(self.bounds, |bounds, point| bounds.with_point(*point));
        write_floats(&mut self.positions[self.n * 12..], &mesh.positions, Vec3::to_array);
        write_floats(&mut self.normals[self.n * 12..], &mesh.normals, Vec3::to_array);
        write_floats(&mut self.uvs[self.n * 8..], &mesh.uvs, Vec2::to_array);
        self.n += mesh.positions.len();
        Ok(())
    }
}

/// The accessors of `n` vertices from `start`.
fn vertex_accessors(
    root: &mut json::Root,
    start: usize,
    n: usize,
    bounds: &Aabb,
) -> [Index<json::Accessor>; 3] {
    let vectors = (ComponentType::F32, Type::Vec3, Some(Target::ArrayBuffer));
    let pairs = (ComponentType::F32, Type::Vec2, Some(Target::ArrayBuffer));
    let accessors = [
        accessor(root, start, n, 12, vectors),
        accessor(root, start + 12 * n, n, 12, vectors),
        accessor(root, start + 24 * n, n, 8, pairs),
    ];
    let positions = &mut root.accessors[accessors[0].value()];
    (positions.min, positions.max) = (Some(value(bounds.min)), Some(value(bounds.max)));
    accessors
}

/// The type of whole numbers of so many bytes, 2 or 4.
fn component(size: usize) -> ComponentType {
    if size == 2 { ComponentType::U16 } else { ComponentType::U32 }
}

/// Writes `first` and each of the numbers; the lower half of a number that fits is the number.
fn write_numbers<'a>(places: impl Iterator<Item = &'a mut [u8]>, first: u32, numbers: &[u32]) {
    for (place, number) in places.zip(numbers) {
        let n = place.len();
        place.copy_from_slice(&(first + number).to_le_bytes()[..n]);
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
