//! Primitives: vertices and triangles, first looked at and counted, later read.

use sapwood_geom::Mesh;
use sapwood_geom::glam::{Affine2, Vec2, Vec3};

use super::accessors::{Elements, INDICES, PAIRS, VECTORS};
use super::buffers::Buffers;
use super::document::invalid;
use super::schema;
use super::warnings::Warnings;
use crate::{Error, ErrorKind};

/// How far from 1 the square of a normal's length may be.
const UNIT: f32 = 1e-3;

/// How vertices become triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Mode {
    Triangles,
    Strip,
    Fan,
}

/// Which texture coordinates a primitive is read with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct UvUse {
    pub(super) set: usize,
    pub(super) transform: Affine2,
}

impl Default for UvUse {
    fn default() -> Self {
        Self { set: 0, transform: Affine2::IDENTITY }
    }
}

/// A primitive that has triangles. Everything that it refers to is there.
pub(super) struct Primitive<'b> {
    at: String,
    positions: Elements<'b>,
    normals: Option<Elements<'b>>,
    indices: Option<Elements<'b>>,
    mode: Mode,
}

impl<'b> Primitive<'b> {
    /// Looks at a primitive; nothing where it has no triangles.
    pub(super) fn of(
        buffers: &'b Buffers<'_>,
        primitive: &schema::Primitive,
        at: &str,
        warnings: &mut Warnings,
    ) -> Result<Option<Self>, Error> {
        let attributes = &primitive.attributes;
        let mode = match primitive.mode.unwrap_or(4) {
            4 => Mode::Triangles,
            5 => Mode::Strip,
            6 => Mode::Fan,
            0..=3 => {
                warnings.add(|| at.to_owned(), "points and lines are left out");
                return Ok(None);
            }
            mode => return Err(invalid(format_args!("{at}.mode"), mode.to_string(), "0 to 6")),
        };
        let Some(positions) = attributes.positions else {
            warnings.add(|| at.to_owned(), "what has no positions is left out");
            return Ok(None);
        };
        let positions =
            Elements::of(buffers, positions, &format!("{at}.attributes.POSITION"), &VECTORS)?;
        if primitive.extensions.draco.is_some() && !positions.has_bytes() {
            let name = "KHR_draco_mesh_compression".to_owned();
            return Err(Error::new(ErrorKind::UnknownExtension { name }));
        }
        let n = positions.len();
        let normals = attributes.normals.map(|index| {
            let user = format!("{at}.attributes.NORMAL");
            same_length(Elements::of(buffers, index, &user, &VECTORS)?, n, &user)
        });
        let indices = primitive
            .indices
            .map(|index| Elements::of(buffers, index, &format!("{at}.indices"), &INDICES));
        if attributes.colors.is_some() {
            warnings.add(|| at.to_owned(), "vertex colours are left out");
        }
        if primitive.targets.is_some() {
            warnings.add(|| at.to_owned(), "morph targets are left out");
        }
        let (normals, indices) = (normals.transpose()?, indices.transpose()?);
        let primitive = Self { at: at.to_owned(), positions, normals, indices, mode };
        if primitive.mode == Mode::Triangles && !primitive.n_corners().is_multiple_of(3) {
            let what = "one or two corners that are no triangle are left out";
            warnings.add(|| at.to_owned(), what);
        }
        Ok((primitive.n_triangles() > 0).then_some(primitive))
    }

    fn n_corners(&self) -> usize {
        self.indices.as_ref().map_or(self.positions.len(), Elements::len)
    }

    /// The most triangles that it may have.
    pub(super) fn n_triangles(&self) -> usize {
        match self.mode {
            Mode::Triangles => self.n_corners() / 3,
            Mode::Strip | Mode::Fan => self.n_corners().saturating_sub(2),
        }
    }

    /// The most vertices that it may need.
    pub(super) fn n_vertices(&self) -> usize {
        let n_read = match self.chooses() {
            true => self.n_corners(),
            false => self.positions.len(),
        };
        match self.normals {
            Some(_) => n_read,
            // Flat triangles share no vertices; the shared ones are needed to make those.
            None => n_read.saturating_add(self.n_triangles().saturating_mul(3)),
        }
    }

    /// Whether vertices that no triangle has are left out: where many primitives each take a few
    /// of the same vertices, nobody should have to read all of them for each. What is sparse is
    /// read as a whole anyhow.
    fn chooses(&self) -> bool {
        let is_sparse = |elements: &Elements<'_>| elements.is_sparse();
        self.n_corners() < self.positions.len()
            && !is_sparse(&self.positions)
            && !self.normals.as_ref().is_some_and(is_sparse)
    }

    /// Reads the vertices and the triangles.
    pub(super) fn read(
        &self,
        buffers: &'b Buffers<'_>,
        attributes: &schema::Attributes,
        uv_use: UvUse,
        warnings: &mut Warnings,
    ) -> Result<Mesh, Error> {
        let at = &self.at;
        let n = self.positions.len();
        let mut indices = self.triangles(n)?;
        let chosen = self.chooses().then(|| renumber(&mut indices));
        let chosen = chosen.as_deref();
        let positions: Vec<Vec3> =
            self.positions.floats(chosen)?.into_iter().map(Vec3::from_array).collect();
        if let Some(i) = positions.iter().position(|position| !position.is_finite()) {
            let number = chosen.map_or(i, |chosen| chosen[i] as usize);
            let found = format!("element {number} of {} is {}", self.positions.at(), positions[i]);
            let user = format_args!("{at}.attributes.POSITION");
            return Err(invalid(user, found, "finite numbers"));
        }
        let user = format!("{at}.attributes.TEXCOORD_{}", uv_use.set);
        let uvs = attributes.uvs(uv_use.set).map(|index| {
            same_length(Elements::of(buffers, index, &user, &PAIRS)?, n, &user)?.floats(chosen)
        });
        let uvs: Option<Vec<Vec2>> = uvs.transpose()?.map(|uvs| {
            let uvs = uvs.into_iter().map(Vec2::from_array);
            match uv_use.transform == Affine2::IDENTITY {
                true => uvs.collect(),
                false => uvs.map(|uv| uv_use.transform.transform_point2(uv)).collect(),
            }
        });
        let mut uvs = uvs.unwrap_or_else(|| vec![Vec2::ZERO; positions.len()]);
        for uv in &mut uvs {
            if !uv.is_finite() {
                *uv = Vec2::ZERO;
                warnings.add(|| user.clone(), "texture coordinates that are no numbers are 0");
            }
        }
        let Some(normals) = &self.normals else {
            return Ok(flat(&positions, &uvs, &indices));
        };
        let normals = normals.floats(chosen)?.into_iter().map(Vec3::from_array).collect();
        let mut mesh = Mesh { positions, normals, uvs, indices };
        mend_normals(&mut mesh, || format!("{at}.attributes.NORMAL"), warnings);
        Ok(mesh)
    }

    /// Three corners for each triangle; all of them are numbers of vertices.
    fn triangles(&self, n_vertices: usize) -> Result<Vec<u32>, Error> {
        let mut corners = match &self.indices {
            Some(indices) => {
                let corners = indices.whole_numbers()?;
                let wrong = corners.iter().position(|index| *index as usize >= n_vertices);
                if let Some(i) = wrong {
                    let found = format!("element {i} of {} is {}", indices.at(), corners[i]);
                    let accepted = format!("numbers of vertices, of which there are {n_vertices}");
                    return Err(invalid(format_args!("{}.indices", self.at), found, accepted));
                }
                corners
            }
            // Their number is limited far below this.
            None => (0..n_vertices as u32).collect(),
        };
        match self.mode {
            Mode::Triangles => {
                corners.truncate(corners.len() / 3 * 3);
                Ok(corners)
            }
            Mode::Strip => Ok(corners
                .windows(3)
                .enumerate()
                .map(|(i, t)| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] })
                .filter(|[a, b, c]| a != b && b != c && c != a)
                .flatten()
                .collect()),
            Mode::Fan => {
                let (first, rim) = corners.split_at(1.min(corners.len()));
                Ok(rim.windows(2).flat_map(|t| [first[0], t[0], t[1]]).collect())
            }
        }
    }
}

/// The vertices that triangles have, in rising order; `indices` become their places there.
fn renumber(indices: &mut [u32]) -> Vec<u32> {
    let mut chosen = indices.to_vec();
    chosen.sort_unstable();
    chosen.dedup();
    for index in indices {
        *index = chosen.partition_point(|vertex| vertex < index) as u32;
    }
    chosen
}

fn same_length<'b>(elements: Elements<'b>, n: usize, user: &str) -> Result<Elements<'b>, Error> {
    if elements.len() == n {
        return Ok(elements);
    }
    let found = format!("{} has {} elements", elements.at(), elements.len());
    Err(invalid(user, found, format!("{n}, as many as there are positions")))
}

/// Triangles that share no vertices, each with the normal that its corners have.
pub(crate) fn flat(positions: &[Vec3], uvs: &[Vec2], indices: &[u32]) -> Mesh {
    let mut mesh = Mesh {
        positions: Vec::with_capacity(indices.len()),
        normals: Vec::with_capacity(indices.len()),
        uvs: Vec::with_capacity(indices.len()),
        indices: (0..indices.len() as u32).collect(),
    };
    for triangle in indices.chunks_exact(3) {
        let corners = [0, 1, 2].map(|i| triangle[i] as usize);
        mesh.positions.extend(corners.map(|corner| positions[corner]));
        mesh.uvs.extend(corners.map(|corner| uvs[corner]));
        mesh.normals.extend([normal_of(corners.map(|corner| positions[corner])); 3]);
    }
    mesh
}

/// The direction from which a triangle is seen counter-clockwise; up where it has none.
fn normal_of([a, b, c]: [Vec3; 3]) -> Vec3 {
    let [a, b, c] = [a.as_dvec3(), b.as_dvec3(), c.as_dvec3()];
    (b - a).cross(c - a).try_normalize().map_or(Vec3::Y, |normal| normal.as_vec3())
}

/// Gives every normal unit length. One without direction becomes that of a triangle at its
/// vertex.
fn mend_normals(mesh: &mut Mesh, at: impl Fn() -> String, warnings: &mut Warnings) {
    let mut lost = 0;
    for normal in &mut mesh.normals {
        let squared = normal.length_squared();
        if (squared - 1.0).abs() <= UNIT {
            continue;
        }
        // In 64 bits no square of a single float is lost.
        *normal = match normal.as_dvec3().try_normalize() {
            Some(unit) => unit.as_vec3(),
            None => {
                lost += 1;
                Vec3::ZERO
            }
        };
    }
    if lost == 0 {
        return;
    }
    warnings.add(at, "normals without direction are made from triangles");
    for triangle in mesh.indices.chunks_exact(3) {
        let corners = [0, 1, 2].map(|i| triangle[i] as usize);
        if corners.iter().any(|corner| mesh.normals[*corner] == Vec3::ZERO) {
            let normal = normal_of(corners.map(|corner| mesh.positions[corner]));
            for corner in corners {
                if mesh.normals[corner] == Vec3::ZERO {
                    mesh.normals[corner] = normal;
                }
            }
        }
    }
    for normal in &mut mesh.normals {
        if *normal == Vec3::ZERO {
            *normal = Vec3::Y;
        }
    }
}
