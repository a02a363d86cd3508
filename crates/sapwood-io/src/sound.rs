//! What files cannot hold, whatever their format: meshes with numbers that are none, or with
//! triangles between vertices that are not there.

use sapwood_geom::Mesh;
use sapwood_geom::glam::Vec3;

/// What no file can hold in `mesh`, if anything.
pub(crate) fn check(mesh: &Mesh) -> Result<(), String> {
    if let Some(why) = mesh.unsound() {
        return Err(why);
    }
    // The validator's own tolerance is about 0.007.
    let unit = |normal: &Vec3| (normal.length_squared() - 1.0).abs() <= 0.01;
    match mesh.normals.iter().position(|normal| !unit(normal)) {
        Some(i) => Err(format!("the normal of vertex {i} is {}, not of length 1", mesh.normals[i])),
        None => Ok(()),
    }
}
