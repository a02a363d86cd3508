//! Leaves of somebody's own: their meshes from glTF and OBJ files, their images from PNG and JPEG
//! files.

use std::path::Path;
use std::sync::Arc;

use sapwood_geom::{Mesh, Shared};
use sapwood_graph::Material;
use sapwood_rules::weber_penn::{LeafMesh, OwnLeafImage};

use crate::obj::{ObjModel, read_obj};
use crate::raster::read_image_of;
use crate::shape::all_triangles;
use crate::{Error, ErrorKind, ReadLimits, read_gltf};

/// The most pixels that a leaf's image may have: 4096 x 4096.
const MOST_PIXELS: u64 = 1 << 24;

/// Reads the mesh of a leaf from the glTF file at `path`, or from the OBJ file where the name ends
/// in `.obj`: everything that the file shows, in its frame. The origin is where the leaf's stalk
/// ends, +z leads along it and +y is its upper side; how long it is does not matter.
///
/// It is drawn with the material that the file has for it, or with what the species says of its
/// leaves where the file has none.
///
/// # Errors
/// Those of [`read_gltf`], and the first line of an OBJ file that is not as the format has it; also
/// when the file shows more than [`LeafMesh::MOST_TRIANGLES`], has several materials, images of
/// more than 2^24 pixels, or what it shows is no leaf.
pub fn read_leaf_mesh(path: impl AsRef<Path>) -> Result<LeafMesh, Error> {
    let path = path.as_ref();
    let most = LeafMesh::MOST_TRIANGLES as u64;
    let limits = ReadLimits {
        bytes: 1 << 28,
        triangles: most,
        vertices: 3 * most,
        pixels: MOST_PIXELS,
        ..ReadLimits::default()
    };
    let in_file = |error: Error| error.in_file(&path.display().to_string());
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("obj")) {
        let ObjModel { mesh, materials } = read_obj(path, &limits)?;
        return leaf_of(&mesh, materials.iter().map(Option::as_ref)).map_err(in_file);
    }
    let model = read_gltf(path, &limits)?;
    let mesh = all_triangles(&model, 3 * most).map_err(in_file)?;
    let shown = model.nodes.iter().filter_map(|node| node.mesh);
    let materials = shown
        .flat_map(|mesh| &model.meshes[mesh])
        .map(|part| part.material.as_ref().filter(|material| !says_nothing(material)));
    leaf_of(&mesh, materials).map_err(in_file)
}

/// The leaf that a mesh is, of parts with these materials.
fn leaf_of<'a>(
    mesh: &Mesh,
    mut materials: impl Iterator<Item = Option<&'a Arc<Material>>>,
) -> Result<LeafMesh, Error> {
    let invalid = |found: String, accepted: &str| {
        let accepted = accepted.to_owned();
        Error::new(ErrorKind::Invalid { at: String::new(), found, accepted })
    };
    let material = materials.next().flatten();
    if materials.any(|other| other != material) {
        let found = "a leaf of several materials".to_owned();
        return Err(invalid(found, "one, which may have an image"));
    }
    LeafMesh::new(mesh, material.cloned()).map_err(|fault| invalid(fault.to_string(), ""))
}

/// Whether a material is what files have that say nothing of one.
fn says_nothing(material: &Material) -> bool {
    let white = [1.0; 4];
    *material == Material { metallic: 1.0, base_color: white, ..Material::matte("", 1.0, 1.0, 1.0) }
}

/// Reads the image of a leaf from the PNG or JPEG file at `path`. Its upper edge is the leaf's tip;
/// pixels that are less than half covered are cut out.
///
/// # Errors
/// Those of [`read_image`](crate::read_image); also when it has more than 2^24 pixels.
pub fn read_leaf_image(path: impl AsRef<Path>) -> Result<OwnLeafImage, Error> {
    let path = path.as_ref();
    let image = OwnLeafImage::new(Shared::new(read_image_of(path, MOST_PIXELS)?));
    if image.is_empty() {
        let found = "all of the image is cut out".to_owned();
        let accepted = "an image with pixels that are at least half covered".to_owned();
        let kind = ErrorKind::Invalid { at: String::new(), found, accepted };
        return Err(Error::new(kind).in_file(&path.display().to_string()));
    }
    Ok(image)
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use sapwood_geom::glam::{Affine3, Vec3};
    use sapwood_geom::{Image, SharedMesh};
    use sapwood_graph::{Body, DrawList, DrawRow, Kind, Named, Occurrence};
    use sapwood_rules::weber_penn::{LeafShape, leaf_mesh};

    use super::*;
    use crate::{read_species, write_glb, write_obj, write_png, write_species};

    struct Drawn;

    impl Named for Drawn {
        const NAME: &'static str = "drawn";
    }

    /// A file with these meshes and materials, and the folder that it is in.
    fn file(parts: &[(Mesh, Material)]) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("leaf.glb");
        let mut body = Body::new(Kind::of::<Drawn>());
        for (mesh, material) in parts {
            body.rows.push(DrawRow::new(
                Affine3::IDENTITY,
                SharedMesh::new(mesh.clone()),
                Arc::new(material.clone()),
            ));
        }
        let occurrence = Occurrence { body: 0, world: Affine3::IDENTITY };
        write_glb(&path, &DrawList { bodies: vec![body], occurrences: vec![occurrence] }).unwrap();
        (folder, path)
    }

    fn maple(scale: f32) -> Mesh {
        let mut mesh = Mesh::default();
        mesh.append(&leaf_mesh(LeafShape::Maple5), &Affine3::from_scale(Vec3::splat(scale)));
        mesh
    }

    #[test]
    fn a_leaf_has_the_mesh_and_the_material_of_its_file() {
        let red = Material::matte("red", 0.5, 0.0, 0.0);
        let (_folder, path) = file(&[(maple(7.0), red.clone())]);
        let leaf = read_leaf_mesh(&path).unwrap();
        assert!((leaf.unit().bound().aabb.max.z - 1.0).abs() < 1e-5);
        assert_eq!(leaf.unit().n_triangles(), leaf_mesh(LeafShape::Maple5).n_triangles());
        assert_eq!(leaf.material().map(|material| &**material), Some(&red));
    }

    #[test]
    fn obj_files_hold_leaves_too() {
        // What is written as OBJ is read as the leaf that it was, with its image.
        let folder = tempfile::tempdir().unwrap();
        // No name is decoded on the way, not even those of materials and images.
        let path = folder.path().join("my%20leaf.OBJ");
        let covered = |x: u32| if x == 0 { 0 } else { 255 };
        let image = Image::from_fn(4, 4, |x, y| [9, 40 * y as u8, 9, covered(x)]);
        let mut red = Material::matte("red", 0.5, 0.25, 0.0);
        (red.roughness, red.alpha) = (0.75, sapwood_graph::Alpha::Mask(0.5));
        red.images.base_color = Some(Shared::new(image));
        let mut body = Body::new(Kind::of::<Drawn>());
        let (mesh, material) = (SharedMesh::new(maple(7.0)), Arc::new(red.clone()));
        let local = Affine3::IDENTITY;
        body.rows.push(DrawRow::new(local, mesh, material));
        let occurrence = Occurrence { body: 0, world: Affine3::IDENTITY };
        let list = DrawList { bodies: vec![body], occurrences: vec![occurrence] };
        write_obj(&path, &list).unwrap();
        let leaf = read_leaf_mesh(&path).unwrap();
        let (_glb, glb) = file(&[(maple(7.0), red.clone())]);
        let same = read_leaf_mesh(glb).unwrap();
        assert_eq!(leaf.unit().n_triangles(), same.unit().n_triangles());
        let both = leaf.unit().indices.iter().zip(&same.unit().indices);
        for (one, other) in both.map(|(one, other)| (*one as usize, *other as usize)) {
            let [one, other] = [(&leaf, one), (&same, other)].map(|(leaf, i)| {
                let mesh = leaf.unit();
                (mesh.positions[i], mesh.normals[i], mesh.uvs[i])
            });
            assert!(one.0.abs_diff_eq(other.0, 1e-6) && one.1.abs_diff_eq(other.1, 1e-5));
            assert!(one.2.abs_diff_eq(other.2, 1e-6));
        }
        let read = leaf.material().unwrap();
        assert_eq!(**read, Material { double_sided: true, ..red });

        let write = |obj: &str, mtl: &str| {
            std::fs::write(folder.path().join("a.obj"), obj).unwrap();
            std::fs::write(folder.path().join("a.mtl"), mtl).unwrap();
            let told = read_leaf_mesh(folder.path().join("a.obj"));
            let folder = format!("{}/", folder.path().display());
            told.map_err(|error| error.to_string().replace(&folder, ""))
        };
        let faces = "mtllib a.mtl\nv 0 0 0\nv 1 0 1\nv 0 0 1\nusemtl one\nf 1 2 3\n";
        let plain = write(faces, "newmtl one\nKd 0.1 0.2 0.3\n").unwrap();
        assert_eq!(plain.material().unwrap().base_color, [0.1, 0.2, 0.3, 1.0]);
        let check = |obj: &str, mtl: &str, told: &str| {
            let error = write(obj, mtl).unwrap_err();
            assert!(error.starts_with("a.obj:") && error.contains(told), "{error}");
        };
        let two = format!("{faces}usemtl two\nf 1 3 2\n");
        check(&two, "newmtl one\nnewmtl two\nKd 0 1 0\n", "several materials");
        check(faces, "newmtl one\nKd 0.5\n", "1:1: mtllib: line 2 of \"a.mtl\" has no colour");
        check(faces, "newmtl one\nmap_Kd no.png\n", "1:1: map_Kd: \"no.png\" cannot be read");
        check(faces, "newmtl one\nmap_Kd a.mtl\n", "1:1: map_Kd \"a.mtl\": ");
        check("v 0 0 0\nv 1 0 0\nv 0 0 -1\nf 1 2 3", "", "beyond its origin along +z");
        check("v 0 0 nan\nv 1 0 0\nv 0 0 1\nf 1 2 3", "", "the position of vertex 0");
        assert_eq!(write("", "").unwrap_err().split(':').next(), Some("a.obj"));
    }

    #[test]
    fn files_that_hold_no_leaf_are_refused_in_one_line() {
        let [red, green] = ["red", "green"].map(|name| Material::matte(name, 0.5, 0.5, 0.0));
        let check = |parts: &[(Mesh, Material)], told: &str| {
            let (_folder, path) = file(parts);
            let error = read_leaf_mesh(&path).unwrap_err().to_string();
            assert!(error.contains(told) && !error.contains('\n'), "{error}");
            assert!(error.contains("leaf.glb"), "{error}");
        };
        check(&[], "without triangles");
        check(&[(maple(1.0), red.clone()), (maple(1.0), green)], "several materials");
        check(&[(maple(-1.0), red)], "beyond its origin along +z");
        let error = read_leaf_mesh("no-such-leaf.glb").unwrap_err().to_string();
        assert!(error.starts_with("no-such-leaf.glb: cannot be read: "), "{error}");
    }

    #[test]
    fn images_that_show_nothing_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("leaf.png");
        let mut image = Image::from_fn(4, 8, |_, _| [9, 99, 9, 0]);
        write_png(&path, &image).unwrap();
        let error = read_leaf_image(&path).unwrap_err().to_string();
        assert!(error.contains("all of the image is cut out"), "{error}");
        image.pixels[3][3] = 255;
        write_png(&path, &image).unwrap();
        assert_eq!(**read_leaf_image(&path).unwrap().image(), image);
    }

    #[test]
    fn species_files_name_files_beside_them() {
        let yellow = Material::matte("pear", 0.7, 0.6, 0.1);
        let (folder, path) = file(&[(maple(3.0), yellow.clone())]);
        let at = |name: &str| folder.path().join(name);
        let mut bare = maple(1.0);
        bare.uvs.fill(sapwood_geom::glam::Vec2::ZERO);
        let (_other, other) = file(&[(bare, yellow.clone())]);
        std::fs::copy(other, at("bare.glb")).unwrap();
        assert!(path.ends_with("leaf.glb"));
        let image = Image::from_fn(4, 8, |x, _| [9, 99, 9, if x == 1 { 255 } else { 0 }]);
        write_png(at("leaf.png"), &image).unwrap();
        std::fs::write(at("no.png"), "no image").unwrap();
        let read = |leaves: &str| {
            let mut text = "name = \"Pear\"\nshape = 2\nscale = 6\nlevels = 1\n".to_owned();
            text.push_str(&format!("ratio = 0.02\n[leaves]\ncount = 9\n{leaves}\n"));
            std::fs::write(at("pear.toml"), text).unwrap();
            read_species(at("pear.toml"))
        };

        let species = read("mesh = \"leaf.glb\"\nscale = 0.1").unwrap();
        let own = species.leaves.mesh.as_ref().unwrap();
        assert_eq!((own.path.as_str(), species.leaves.scale_x), ("leaf.glb", 1.0));
        assert_eq!(own.mesh.material().map(|material| &**material), Some(&yellow));
        std::fs::write(at("again.toml"), write_species(&species)).unwrap();
        assert_eq!(read_species(at("again.toml")).unwrap(), species);

        let species = read("image = \"leaf.png\"\nscale_x = 0.7").unwrap();
        assert_eq!(species.leaves.image.as_ref().map(|own| &**own.image.image()), Some(&image));
        assert_eq!(species.leaves.scale_x, 0.7, "what the file says");

        let fault = |leaves: &str| {
            let error = read(leaves).unwrap_err().to_string();
            let (_, told) = error.split_once("pear.toml:").unwrap();
            told.replace(&folder.path().display().to_string(), "FOLDER")
        };
        let cannot = "8:8: leaves.mesh is \"none.glb\": FOLDER/none.glb: cannot be read: ";
        assert!(fault("mesh = \"none.glb\"").starts_with(cannot));
        assert_eq!(
            fault("image = \"no.png\""),
            "8:9: leaves.image is \"no.png\": FOLDER/no.png: 8 bytes that begin with \
             [6e, 6f, 20, 69] (accepted: a PNG or JPEG image)"
        );
        assert_eq!(
            fault("mesh = \"bare.glb\"\nimage = \"leaf.png\""),
            "9:9: leaves.image is \"leaf.png\": the leaf's mesh has no texture coordinates to lay \
             the image by (accepted: without a mesh, or with one that has them)"
        );
        assert_eq!(
            fault("mesh = 7"),
            "8:8: leaves.mesh takes the path of a .glb, .gltf or .obj file, not the number 7"
        );
    }
}
