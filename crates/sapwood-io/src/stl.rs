//! Binary STL: triangles alone, as programs for 3D printers take them. Colours, normals of vertices,
//! texture coordinates and repeated things have no place in such a file; a crate writes the bytes.

use std::path::Path;

use sapwood_geom::Solid;
use sapwood_geom::glam::Vec3;
use stl_io::{Triangle, Vector};

use crate::{Error, ErrorKind, FileSet};

/// Writes a solid as binary STL to the file at `path`, whole or not at all.
///
/// In metres, z up: the format has no units, and most programs take its numbers for millimetres,
/// so that a tree shows a thousand times as small until it is scaled. Coordinates keep every bit
/// (those of y change their sign), so that what was closed and free of crossings stays so.
///
/// # Errors
/// When a triangle has a corner that is not there or not finite, and those of
/// [`write_atomically`](crate::write_atomically).
pub fn write_stl(path: impl AsRef<Path>, solid: &Solid) -> Result<(), Error> {
    let mut files = FileSet::new();
    files.add_stl(path, solid)?;
    files.commit()
}

/// STL.
impl FileSet {
    /// Adds what [`write_stl`] writes.
    ///
    /// # Errors
    /// Those of [`write_stl`].
    pub fn add_stl(&mut self, path: impl AsRef<Path>, solid: &Solid) -> Result<(), Error> {
        let path = path.as_ref();
        if let Some(reason) = fault(solid) {
            let kind = ErrorKind::Unwritable { component: "solid".to_owned(), reason };
            return Err(Error::new(kind).in_file(&path.display().to_string()));
        }
        let triangles = (0..solid.triangles.len()).map(|number| triangle(solid.corners(number)));
        self.write(path, |out| stl_io::write_stl(&mut &mut *out, triangles))
    }
}

fn fault(solid: &Solid) -> Option<String> {
    if u32::try_from(solid.triangles.len()).is_err() {
        return Some("there are more than 4,294,967,295 triangles".to_owned());
    }
    if let Some(corner) = solid.positions.iter().position(|position| !position.is_finite()) {
        return Some(format!("the corner {corner} is {}", solid.positions[corner]));
    }
    let n = solid.positions.len();
    let is_there = |corner: &&u32| **corner as usize >= n;
    let missing = solid.triangles.iter().flatten().find(is_there)?;
    Some(format!("a triangle has the corner {missing}, and there are {n}"))
}

fn triangle(corners: [Vec3; 3]) -> Triangle {
    // From y up to z up.
    let [a, b, c] = corners.map(|p| Vec3::new(p.x, -p.z, p.y) + 0.0);
    let (ab, ac) = ((b - a).as_dvec3(), (c - a).as_dvec3());
    let normal = ab.cross(ac).normalize_or_zero().as_vec3();
    Triangle {
        normal: Vector(normal.to_array()),
        vertices: [a, b, c].map(|p| Vector(p.to_array())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> Solid {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        Solid { positions, triangles: vec![[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]] }
    }

    #[test]
    fn what_is_written_is_read_back_with_z_up() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("solid.stl");
        write_stl(&path, &tetrahedron()).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        assert_eq!(bytes.len(), 84 + 4 * 50);
        let read = stl_io::read_stl(&mut std::io::Cursor::new(bytes)).unwrap();
        read.validate().unwrap();
        let vertices: Vec<[f32; 3]> = read.vertices.iter().map(|vertex| vertex.0).collect();
        for expected in [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]] {
            assert!(vertices.contains(&expected), "{expected:?} {vertices:?}");
        }
        // The first triangle lies in the plane z = 0 of the solid and faces along -z, so +y here.
        assert_eq!(read.faces[0].normal.0, [0.0, 1.0, 0.0]);
    }

    #[test]
    fn what_no_file_can_hold_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("solid.stl");
        let mut solid = tetrahedron();
        solid.triangles[2][1] = 4;
        let told = write_stl(&path, &solid).unwrap_err().to_string();
        assert!(told.contains("has the corner 4, and there are 4"), "{told}");
        let mut solid = tetrahedron();
        solid.positions[1].y = f32::NAN;
        let told = write_stl(&path, &solid).unwrap_err().to_string();
        assert!(told.contains("the corner 1 is"), "{told}");
        assert!(!path.exists());
    }
}
