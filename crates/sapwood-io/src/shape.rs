//! Shapes in words: what trees are held inside of, or cut by.
//!
//! Options of programs and species files share these words. What a shape does is left to others.

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use sapwood_geom::glam::{Affine3, Vec3};
use sapwood_geom::{Aabb, ClosedMesh, Envelope, Mesh, Sphere};

use crate::{Error, ErrorKind, Model, ReadLimits, read_gltf};

/// What words there are, for help texts and errors.
pub const SHAPES: &str = "sphere:X,Y,Z,R, box:X0,Y0,Z0,X1,Y1,Z1, half-space:NX,NY,NZ,D, \
     mesh:FILE.glb or outside:SHAPE, in metres, y up";

/// A solid in words, in metres, y up; the file that it may name is not read yet.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// As it was given.
    text: String,
    form: Form,
    is_outside: bool,
}

#[derive(Clone, Debug, PartialEq)]
enum Form {
    Solid(Envelope),
    Mesh(PathBuf),
}

/// Words that are no shape: what is wrong with them, and what is accepted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShapeFault(String);

impl fmt::Display for ShapeFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for ShapeFault {}

impl Shape {
    /// The solid; reads the file of a mesh, whose path is taken from `folder` if there is one.
    ///
    /// # Errors
    /// When the file cannot be read, or its triangles enclose nothing.
    pub fn envelope(&self, folder: Option<&Path>) -> Result<Envelope, Error> {
        let envelope = match &self.form {
            Form::Solid(envelope) => envelope.clone(),
            Form::Mesh(path) => {
                let path = folder.map_or_else(|| path.clone(), |folder| folder.join(path));
                let model = read_gltf(&path, &ReadLimits::default())?;
                let in_file = |error: Error| error.in_file(&path.display().to_string());
                let triangles = all_triangles(&model, MOST).map_err(in_file)?;
                let mesh = ClosedMesh::new(&triangles).map_err(|fault| {
                    in_file(Error::new(ErrorKind::NoSolid { fault: fault.to_string() }))
                })?;
                Envelope::mesh(mesh)
            }
        };
        Ok(if self.is_outside { envelope.complement() } else { envelope })
    }

    /// What is inside all of several shapes; nothing where there is no shape.
    ///
    /// # Errors
    /// As [`envelope`](Self::envelope).
    pub fn all(shapes: &[Self], folder: Option<&Path>) -> Result<Option<Envelope>, Error> {
        Ok(match shapes {
            [] => None,
            [shape] => Some(shape.envelope(folder)?),
            shapes => {
                let all: Result<Vec<_>, _> =
                    shapes.iter().map(|shape| shape.envelope(folder)).collect();
                Some(Envelope::intersection(all?))
            }
        })
    }
}

/// The shape as it was given.
impl fmt::Display for Shape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl FromStr for Shape {
    type Err = ShapeFault;

    fn from_str(text: &str) -> Result<Self, ShapeFault> {
        let fault = |why: String| Err(ShapeFault(why));
        let (mut rest, mut is_outside) = (text, false);
        while let Some(inner) = rest.strip_prefix("outside:") {
            (rest, is_outside) = (inner, !is_outside);
        }
        let Some((name, values)) = rest.split_once(':') else {
            return fault(format!("'{rest}' is no shape (accepted: {SHAPES})"));
        };
        let form = match name {
            "sphere" => {
                let [x, y, z, radius] = numbers(values, "sphere:X,Y,Z,R")?;
                if radius <= 0.0 {
                    return fault(format!("a sphere of radius {radius} (accepted: above 0)"));
                }
                Form::Solid(Envelope::sphere(Sphere { center: Vec3::new(x, y, z), radius }))
            }
            "box" => {
                let [x0, y0, z0, x1, y1, z1] = numbers(values, "box:X0,Y0,Z0,X1,Y1,Z1")?;
                // Any two opposite corners.
                let corners = [Vec3::new(x0, y0, z0), Vec3::new(x1, y1, z1)];
                Form::Solid(Envelope::aabb(Aabb::of_points(corners)))
            }
            "half-space" => {
                let [x, y, z, offset] = numbers(values, "half-space:NX,NY,NZ,D")?;
                let normal = Vec3::new(x, y, z);
                if normal == Vec3::ZERO {
                    return fault(
                        "a half-space's normal of length 0 (accepted: the direction that leads \
                         out of it)"
                            .to_owned(),
                    );
                }
                Form::Solid(Envelope::half_space(normal, offset))
            }
            "mesh" => {
                let path = PathBuf::from(values);
                let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
                if !ending.is_some_and(|ending| ending == "glb" || ending == "gltf") {
                    return fault(format!("mesh:{values} (accepted: mesh:FILE.glb or FILE.gltf)"));
                }
                Form::Mesh(path)
            }
            _ => return fault(format!("'{name}' is no shape (accepted: {SHAPES})")),
        };
        Ok(Self { text: text.to_owned(), form, is_outside })
    }
}

/// Exactly so many finite numbers between commas; `form` tells what they are.
fn numbers<const N: usize>(text: &str, form: &str) -> Result<[f32; N], ShapeFault> {
    let numbers: Vec<f32> = text
        .split(',')
        .map(|number| match number.trim().parse::<f32>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(ShapeFault(format!("'{number}' is not a number (accepted: {form})"))),
        })
        .collect::<Result<_, _>>()?;
    let n = numbers.len();
    numbers
        .try_into()
        .map_err(|_| ShapeFault(format!("{n} numbers where {N} are needed (accepted: {form})")))
}

/// The most triangles and vertices, every copy counted, that a mesh may have to hold trees: some
/// hundreds of megabytes with the hierarchy over them.
const MOST: u64 = 1 << 22;

/// Everything that a model shows, as one mesh in the frame of the file; refused where it has more
/// than `most` triangles or vertices.
pub(crate) fn all_triangles(model: &Model, most: u64) -> Result<Mesh, Error> {
    let [mut n_triangles, mut n_vertices] = [0u64; 2];
    for node in &model.nodes {
        let n_copies = node.instances.as_ref().map_or(1, |instances| instances.len()) as u64;
        for part in node.mesh.iter().flat_map(|mesh| &model.meshes[*mesh]) {
            n_triangles += n_copies * part.mesh.n_triangles() as u64;
            n_vertices += n_copies * part.mesh.n_vertices() as u64;
        }
    }
    for (found, what) in [(n_triangles, "triangles"), (n_vertices, "vertices")] {
        if found > most {
            let at = "all that the nodes show".to_owned();
            return Err(Error::new(ErrorKind::OverLimit { at, found, what, limit: most }));
        }
    }
    let mut all = Mesh::default();
    let once = [Affine3::IDENTITY];
    for (node, world) in model.nodes.iter().zip(model.worlds()) {
        let instances = node.instances.as_ref().map_or(&once[..], |instances| instances);
        for part in node.mesh.iter().flat_map(|mesh| &model.meshes[*mesh]) {
            for instance in instances {
                all.append(&part.mesh, &(world * *instance));
            }
        }
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Shape {
        text.parse().unwrap_or_else(|fault| panic!("{text}: {fault}"))
    }

    #[test]
    fn shapes_are_what_they_say() {
        let inside = |text: &str, x: f32, y: f32, z: f32| {
            parsed(text).envelope(None).unwrap().contains(Vec3::new(x, y, z))
        };
        for (text, within, beyond) in [
            ("sphere:0,3,0,2", [0.0, 4.9, 0.0], [0.0, 5.1, 0.0]),
            ("box:1,0,-1,-1,2,1", [0.9, 1.9, -0.9], [1.1, 1.0, 0.0]),
            ("half-space:0,2,0,4", [9.0, 1.9, 0.0], [9.0, 2.1, 0.0]),
            ("half-space: -1, 0, 0, -1", [1.1, 0.0, 0.0], [0.9, 0.0, 0.0]),
        ] {
            let ([x, y, z], [u, v, w]) = (within, beyond);
            assert!(inside(text, x, y, z) && !inside(text, u, v, w), "{text}");
            let outside = format!("outside:{text}");
            assert!(!inside(&outside, x, y, z) && inside(&outside, u, v, w), "{outside}");
            assert_eq!(parsed(&outside).to_string(), outside);
        }
    }

    #[test]
    fn several_shapes_intersect() {
        let all = |shapes: &[&str]| {
            let shapes: Vec<_> = shapes.iter().map(|shape| parsed(shape)).collect();
            Shape::all(&shapes, None).unwrap()
        };
        assert!(all(&[]).is_none());
        let lens = all(&["sphere:0,0,0,2", "outside:sphere:1,0,0,2"]).unwrap();
        assert!(lens.contains(Vec3::X * -1.5) && !lens.contains(Vec3::X * 0.5));
    }

    #[test]
    fn wrong_shapes_are_told_with_what_is_accepted() {
        for (text, told) in [
            ("ball", "'ball' is no shape (accepted: sphere:X,Y,Z,R"),
            ("outside:ball:1", "'ball' is no shape"),
            ("sphere:1,2,3", "3 numbers where 4 are needed (accepted: sphere:X,Y,Z,R)"),
            ("sphere:1,2,3,x", "'x' is not a number (accepted: sphere:X,Y,Z,R)"),
            ("sphere:1,2,3,inf", "'inf' is not a number"),
            ("sphere:0,0,0,0", "a sphere of radius 0 (accepted: above 0)"),
            ("half-space:0,0,0,1", "normal of length 0"),
            ("mesh:hull.obj", "mesh:hull.obj (accepted: mesh:FILE.glb or FILE.gltf)"),
        ] {
            let fault = text.parse::<Shape>().unwrap_err().to_string();
            assert!(fault.contains(told), "{text}: {fault}");
        }
    }

    #[test]
    fn a_mesh_is_read_when_it_is_needed() {
        let failure = parsed("mesh:no-such-file.glb").envelope(None).unwrap_err();
        assert!(failure.to_string().contains("no-such-file.glb"));
    }
}
