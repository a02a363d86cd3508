//! Leaves of one's own, by options.

use std::path::Path;

use sapwood::geom::{Image, Mesh};
use sapwood::graph::Material;
use sapwood::rules::weber_penn::{LeafShape, leaf_mesh};
use sapwood::scene::{HeldGeometry, Scene};

use crate::program::{command, fails, json, says, text};

fn write(path: &Path, mesh: Mesh) {
    let mut scene = Scene::new();
    let held = scene.add(HeldGeometry::new(mesh, Material::matte("pear", 0.7, 0.6, 0.1)));
    let view = scene.open_view(held, &sapwood::standard_rules()).expect("the mesh is there");
    let list = scene.draw_list(view, 10).expect("nobody interrupts");
    match path.extension().is_some_and(|ending| ending == "obj") {
        true => sapwood::io::write_obj(path, &list),
        false => sapwood::io::write_glb(path, &list),
    }
    .expect("the folder can be written");
}

#[test]
fn leaves_are_drawn_as_a_file_shows_them() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(&at.join("pear.glb"), leaf_mesh(LeafShape::Sphere));
    let image = Image::from_fn(8, 8, |x, _| [30, 120, 20, if x > 2 { 255 } else { 0 }]);
    sapwood::io::write_png(at.join("leaf.png"), &image).unwrap();
    let line =
        "grow quaking_aspen --levels 2 --json -o tree.glb -o tree.png --size 40x40 --samples 1";
    let counts = |options: &str| {
        let told = json(&says(at, &format!("{line} {options}")));
        [&told["leaves"], &told["triangles"]].map(|n| n.as_u64().unwrap())
    };
    let [n_leaves, wood] = counts("--leaf-image leaf.png");
    let wood = wood - 2 * n_leaves;
    let [pears, triangles] = counts("--leaf-mesh pear.glb");
    assert_eq!((pears, triangles), (n_leaves, wood + 20 * n_leaves));
    write(&at.join("pear.obj"), leaf_mesh(LeafShape::Sphere));
    assert_eq!(counts("--leaf-mesh pear.obj"), [n_leaves, triangles]);
    let both = counts("--leaf-mesh pear.glb --leaf-image leaf.png");
    assert_eq!(both, [n_leaves, triangles]);
    for options in ["--range 90", "--wind 5,2", "--weld stem", "--detail draft"] {
        counts(&format!("--leaf-mesh pear.glb {options}"));
    }
    let tree = sapwood::io::read_gltf(at.join("tree.glb"), &Default::default()).unwrap();
    let parts = tree.meshes.iter().flatten();
    let mut names = parts.filter_map(|part| part.material.as_ref()).map(|m| m.name.as_str());
    assert!(names.any(|name| name == "pear"));
}

#[test]
fn files_that_are_no_leaves_are_told_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("no.glb"), "glTF?").unwrap();
    std::fs::write(at.join("no.obj"), "v 0 0 0\nv 0 0 1\nf 1 2 3\n").unwrap();
    let said = fails(at, "grow palm --leaf-mesh no.obj", 1);
    assert!(said.contains("no.obj:3:1: not valid OBJ: the corner '3'"), "{said}");
    let mut behind = leaf_mesh(LeafShape::Sphere);
    behind.positions.iter_mut().for_each(|position| position.z -= 2.0);
    write(&at.join("behind.glb"), behind);
    let mut bare = leaf_mesh(LeafShape::Sphere);
    let first = bare.uvs[0];
    bare.uvs.fill(first);
    write(&at.join("bare.glb"), bare);
    sapwood::io::write_png(at.join("leaf.png"), &Image::from_fn(2, 2, |_, _| [9; 4])).unwrap();
    let check = |options: &str, code: i32, told: &str| {
        let said = fails(at, &format!("grow wheat -o tree.glb {options}"), code);
        assert!(said.contains(told), "{said}");
    };
    check("--leaf-mesh none.glb", 1, "none.glb: cannot be read: ");
    check("--leaf-mesh no.glb", 1, "no.glb: ");
    check("--leaf-mesh behind.glb", 1, "beyond its origin along +z");
    check("--leaf-image leaf.png", 1, "all of the image is cut out");
    std::fs::remove_file(at.join("leaf.png")).unwrap();
    sapwood::io::write_png(at.join("leaf.png"), &Image::from_fn(2, 2, |_, _| [255; 4])).unwrap();
    check("--leaf-mesh bare.glb --leaf-image leaf.png", 2, "no texture coordinates");
    let output = command(at, "grow wheat --leaf-mesh").output().unwrap();
    assert!(text(&output.stderr).contains("--leaf-mesh <FILE>"));
}
