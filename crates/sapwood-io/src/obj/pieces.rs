//! Pieces: a few thousand lines of the file that can be put into words independently of all
//! others, since every number in them is known beforehand.

use sapwood_geom::glam::{Affine3, Vec3};
use sapwood_geom::{Mesh, Polyline};

use super::numbers::{float, whole};

/// Lines of one sort.
pub(super) enum Piece<'a> {
    /// Whatever is no list of numbers.
    Text(String),
    /// Something about copies of a mesh.
    Mesh(MeshPiece<'a>),
    /// Points of polylines, and the polylines.
    Lines { lines: &'a [Polyline], place: Affine3, first: u64 },
}

/// What is written about the copies `copies`, and in each about `items`.
pub(super) struct MeshPiece<'a> {
    pub(super) sort: Sort,
    pub(super) mesh: &'a Mesh,
    /// Normals without those that are there twice.
    pub(super) normals: &'a Normals<'a>,
    pub(super) place: Affine3,
    pub(super) instances: Option<&'a [Affine3]>,
    pub(super) copies: std::ops::Range<usize>,
    pub(super) items: std::ops::Range<usize>,
    pub(super) first: First,
}

/// What is written about a mesh, in this order.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Sort {
    Positions,
    Uvs,
    Normals,
    Triangles,
}

/// The numbers that the first position, texture coordinate and normal of copy 0 have.
#[derive(Clone, Copy)]
pub(super) struct First {
    pub(super) position: u64,
    pub(super) uv: u64,
    pub(super) normal: u64,
}

/// The normals of a mesh that are written for each of its copies.
pub(super) struct Normals<'a> {
    pub(super) distinct: std::borrow::Cow<'a, [Vec3]>,
    /// For each vertex which of them it has; nothing where each has its own.
    of_vertex: Vec<u32>,
}

impl<'a> Normals<'a> {
    /// One normal for each vertex.
    pub(super) fn each(mesh: &'a Mesh) -> Self {
        Self { distinct: mesh.normals.as_slice().into(), of_vertex: Vec::new() }
    }

    /// Each distinct normal once, for small meshes that are written many times.
    pub(super) fn distinct(mesh: &'a Mesh) -> Self {
        let mut distinct: Vec<Vec3> = Vec::new();
        let number = |normal: &Vec3| {
            let known = distinct.iter().position(|known| known == normal);
            known.unwrap_or_else(|| {
                distinct.push(*normal);
                distinct.len() - 1
            }) as u32
        };
        let of_vertex = mesh.normals.iter().map(number).collect();
        Self { distinct: distinct.into(), of_vertex }
    }

    fn of(&self, vertex: u32) -> u64 {
        u64::from(self.of_vertex.get(vertex as usize).copied().unwrap_or(vertex))
    }
}

impl Piece<'_> {
    /// Appends the lines to `text`; the error says what cannot be written.
    pub(super) fn write(&self, text: &mut Vec<u8>) -> Result<(), String> {
        match self {
            Self::Text(line) => text.extend_from_slice(line.as_bytes()),
            Self::Mesh(piece) => {
                for copy in piece.copies.clone() {
                    piece.write_copy(text, copy)?;
                }
            }
            Self::Lines { lines, place, first } => write_lines(text, lines, place, *first)?,
        }
        Ok(())
    }
}

impl MeshPiece<'_> {
    fn write_copy(&self, text: &mut Vec<u8>, copy: usize) -> Result<(), String> {
        let mesh = self.mesh;
        let place = match self.instances {
            None => self.place,
            Some(instances) => self.place * instances[copy],
        };
        let items = self.items.clone();
        match self.sort {
            Sort::Positions => {
                for position in &mesh.positions[items] {
                    write_position(text, place.transform_point3(*position))?;
                }
            }
            Sort::Uvs => {
                for uv in &mesh.uvs[items] {
                    text.extend_from_slice(b"vt");
                    float(text, uv.x);
                    // From the lower edge upwards, other than in meshes.
                    float(text, 1.0 - uv.y);
                    text.push(b'\n');
                }
            }
            Sort::Normals => {
                let to_normal = place.matrix3.inverse().transpose();
                for normal in &self.normals.distinct[items] {
                    // What is flattened has no normals left; any will do.
                    let turned = (to_normal * *normal).normalize_or(*normal);
                    text.extend_from_slice(b"vn");
                    write_vector(text, turned);
                }
            }
            Sort::Triangles => {
                let mirrors = place.matrix3.determinant() < 0.0;
                let before = copy as u64;
                let first = First {
                    position: self.first.position + before * mesh.n_vertices() as u64,
                    uv: self.first.uv,
                    normal: self.first.normal + before * self.normals.distinct.len() as u64,
                };
                for triangle in mesh.indices[3 * items.start..3 * items.end].chunks_exact(3) {
                    text.push(b'f');
                    let [a, b, c] = [triangle[0], triangle[1], triangle[2]];
                    for corner in if mirrors { [a, c, b] } else { [a, b, c] } {
                        text.push(b' ');
                        whole(text, first.position + u64::from(corner));
                        text.push(b'/');
                        whole(text, first.uv + u64::from(corner));
                        text.push(b'/');
                        whole(text, first.normal + self.normals.of(corner));
                    }
                    text.push(b'\n');
                }
            }
        }
        Ok(())
    }
}

fn write_lines(
    text: &mut Vec<u8>,
    lines: &[Polyline],
    place: &Affine3,
    first: u64,
) -> Result<(), String> {
    let mut next = first;
    for line in lines {
        for point in &line.points {
            write_position(text, place.transform_point3(*point))?;
        }
        // A line has two ends.
        if line.points.len() > 1 {
            text.push(b'l');
            for i in 0..line.points.len() as u64 {
                text.push(b' ');
                whole(text, next + i);
            }
            text.push(b'\n');
        }
        next += line.points.len() as u64;
    }
    Ok(())
}

fn write_position(text: &mut Vec<u8>, position: Vec3) -> Result<(), String> {
    if !position.is_finite() {
        return Err(format!("a position is {position}"));
    }
    text.push(b'v');
    write_vector(text, position);
    Ok(())
}

fn write_vector(text: &mut Vec<u8>, vector: Vec3) {
    float(text, vector.x);
    float(text, vector.y);
    float(text, vector.z);
    text.push(b'\n');
}
