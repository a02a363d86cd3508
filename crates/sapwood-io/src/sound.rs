//! What files cannot hold, whatever their format: meshes with numbers that are none, or with
//! triangles between vertices that are not there.

use sapwood_geom::Mesh;
use sapwood_geom::glam::Vec3;

/// What no file can hold in `mesh`, if anything.
pub(crate) fn check(mesh: &Mesh) -> Result<(), String> {
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
