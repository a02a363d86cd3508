//! Files are read back with an independent reader and compared with the draw list.

use std::fs;
use std::sync::Arc;

use sapwood_geom::glam::{Affine3, Vec2, Vec3};
use sapwood_geom::{Image, Mesh, Polyline, Shared, SharedMesh};
use sapwood_graph::{
    Alpha, Body, DrawRow, Kind, LineRow, Material, MaterialImages, Named, Occurrence,
};

use super::*;

struct Tree;
struct Stone;

impl Named for Tree {
    const NAME: &'static str = "tree";
}

impl Named for Stone {
    const NAME: &'static str = "a stone";
}

fn quad() -> Mesh {
    Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.3), Vec3::Y],
        normals: vec![Vec3::Z, Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::Z],
        uvs: vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::new(0.0, 0.25)],
        indices: vec![0, 1, 2, 0, 2, 3],
    }
}

fn row(mesh: &SharedMesh, name: &str, instances: Option<Vec<Affine3>>) -> DrawRow {
    DrawRow {
        instances: instances.map(Shared::new),
        ..DrawRow::new(
            Affine3::from_rotation_z(0.3),
            mesh.clone(),
            Arc::new(Material::matte(name, 0.25, 0.5, 0.125)),
        )
    }
}

/// Two trees and a mirrored one with many leaves, and a stone.
fn grove() -> DrawList {
    let (leaf, trunk) = (SharedMesh::new(quad()), SharedMesh::new(quad()));
    let leaf_places = |i: usize| {
        Affine3::from_translation(Vec3::new(i as f32 * 0.1, 1.0, 0.0))
            * Affine3::from_rotation_y(i as f32)
    };
    let leaves = (0..5000).map(leaf_places).collect();
    let rows = vec![row(&trunk, "bark", None), row(&leaf, "leaf", Some(leaves))];
    let places = [
        (0, Affine3::IDENTITY),
        (0, Affine3::from_translation(Vec3::X * 3.0)),
        (1, Affine3::from_rotation_x(-1.5)),
        (0, Affine3::from_scale(Vec3::new(-1.0, 2.0, 1.0))),
    ];
    DrawList {
        bodies: vec![
            Body { rows, ..Body::new(Kind::of::<Tree>()) },
            Body { rows: vec![row(&trunk, "bark", None)], ..Body::new(Kind::of::<Stone>()) },
        ],
        occurrences: places.map(|(body, world)| Occurrence { body, world }).into(),
    }
}

fn lone(body: Body) -> DrawList {
    let occurrences = vec![Occurrence { body: 0, world: Affine3::IDENTITY }];
    DrawList { bodies: vec![body], occurrences }
}

/// The text of the file.
fn text(list: &DrawList) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    write_obj(&path, list).unwrap();
    fs::read_to_string(path).unwrap()
}

fn numbers(text: &str, keyword: &str) -> Vec<Vec<f32>> {
    let lines = text.lines().filter_map(|line| line.strip_prefix(keyword)?.strip_prefix(' '));
    lines.map(|line| line.split(' ').map(|number| number.parse().unwrap()).collect()).collect()
}

/// All corners of all triangles that `list` draws, in the order of the file.
fn corners(list: &DrawList) -> Vec<(Vec3, Vec3, Vec2)> {
    let mut all = Mesh::default();
    for (place, row) in list.placed_rows() {
        match &row.instances {
            None => all.append(&row.mesh, &place),
            Some(instances) => {
                instances.iter().for_each(|instance| all.append(&row.mesh, &(place * *instance)));
            }
        }
    }
    let corner = |i: &u32| {
        let i = *i as usize;
        (all.positions[i], all.normals[i], all.uvs[i])
    };
    all.indices.iter().map(corner).collect()
}

#[test]
fn every_corner_comes_back_as_it_is_drawn() {
    let list = grove();
    let text = text(&list);
    let positions: Vec<Vec3> =
        numbers(&text, "v").iter().map(|v| Vec3::new(v[0], v[1], v[2])).collect();
    let normals: Vec<Vec3> =
        numbers(&text, "vn").iter().map(|v| Vec3::new(v[0], v[1], v[2])).collect();
    let uvs: Vec<Vec2> = numbers(&text, "vt").iter().map(|v| Vec2::new(v[0], v[1])).collect();
    let faces = text.lines().filter_map(|line| line.strip_prefix("f "));
    let mut n_corners = 0;
    let expected = corners(&list);
    for corner in faces.flat_map(|face| face.split(' ')) {
        let i: Vec<usize> = corner.split('/').map(|i| i.parse::<usize>().unwrap() - 1).collect();
        let (position, normal, uv) = expected[n_corners];
        assert_eq!(
            positions[i[0]].to_array().map(f32::to_bits),
            position.to_array().map(f32::to_bits)
        );
        assert_eq!(uvs[i[1]], Vec2::new(uv.x, 1.0 - uv.y));
        assert_eq!(normals[i[2]], normal);
        n_corners += 1;
    }
    assert_eq!(n_corners, expected.len());
    // Texture coordinates are shared by all copies of a mesh, normals by equal corners.
    assert_eq!(uvs.len(), 8);
    assert_eq!(normals.len(), 3 * (4 + 5000 * 2) + 4);
}

#[test]
fn another_reader_finds_objects_and_materials() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("my grove.obj");
    write_obj(&path, &grove()).unwrap();
    assert!(folder.path().join("my_grove.mtl").exists());
    let (models, materials) = tobj::load_obj(&path, &tobj::LoadOptions::default()).unwrap();
    let materials = materials.unwrap();
    let names: Vec<_> = materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(names, ["bark", "leaf"]);
    assert_eq!(materials[0].diffuse, Some([0.25, 0.5, 0.125]));
    assert_eq!(materials[0].unknown_param["Pr"], "1");
    let found: Vec<_> = models
        .iter()
        .map(|model| (model.name.as_str(), model.mesh.material_id, model.mesh.indices.len()))
        .collect();
    let tree = |name| [(name, Some(0), 6), (name, Some(1), 30_000)];
    let expected =
        [&tree("tree")[..], &tree("tree.2"), &[("a_stone", Some(0), 6)], &tree("tree.3")].concat();
    assert_eq!(found, expected);
}

#[test]
fn lines_are_elements() {
    let line = |n: usize| Polyline {
        points: (0..n).map(|i| Vec3::Y * i as f32).collect(),
        radii: vec![0.1; n],
    };
    let lines = Shared::new(vec![line(3), line(1), line(2)]);
    let local = Affine3::from_translation(Vec3::X);
    let body = Body {
        lines: vec![LineRow { local, lines, material: None, range: None }],
        ..Body::new(Kind::of::<Tree>())
    };
    let folder = tempfile::tempdir().unwrap();
    write_obj(folder.path().join("a.obj"), &lone(body)).unwrap();
    let text = fs::read_to_string(folder.path().join("a.obj")).unwrap();
    let body = text.split_once('\n').unwrap().1;
    assert_eq!(
        body,
        "o tree\nv 1 0 0\nv 1 1 0\nv 1 2 0\nl 1 2 3\nv 1 0 0\nv 1 0 0\nv 1 1 0\nl 5 6\n"
    );
    // Nothing has a material, so there is no file of them.
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn images_are_written_beside_and_shared() {
    let image = Image::from_fn(2, 2, |x, y| [x as u8, 100, 200, if y == 0 { 0 } else { 255 }]);
    let bumps = Shared::new(Image::from_fn(1, 1, |_, _| [128, 128, 255, 255]));
    let images = MaterialImages {
        base_color: Some(Shared::new(image.clone())),
        metallic_roughness: Some(Shared::new(image.clone())),
        normal: Some(bumps),
        emissive: Some(Shared::new(image)),
    };
    let material = |name: &str, alpha| Material {
        base_color: [1.0, 1.0, 1.0, 0.5],
        alpha,
        roughness: 0.5,
        images: images.clone(),
        ..Material::matte(name, 0.0, 0.0, 0.0)
    };
    let mesh = SharedMesh::new(quad());
    let painted = |material| DrawRow { material: Arc::new(material), ..row(&mesh, "", None) };
    let rows =
        vec![painted(material("leaf", Alpha::Mask(0.5))), painted(material("leaf", Alpha::Opaque))];
    let folder = tempfile::tempdir().unwrap();
    let list = lone(Body { rows, ..Body::new(Kind::of::<Tree>()) });
    write_obj(folder.path().join("a b.obj"), &list).unwrap();
    let mut names: Vec<_> = fs::read_dir(folder.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let expected = ["a b.obj", "a_b-1.png", "a_b-2.png", "a_b-3.png", "a_b-4.png", "a_b.mtl"];
    assert_eq!(names, expected);
    let text = fs::read_to_string(folder.path().join("a_b.mtl")).unwrap();
    let first = "newmtl leaf\nKd 1 1 1\nNs 225\nPr 0.5\nPm 0\nd 0.5\nillum 2\nmap_Kd a_b-1.png\n\
                 map_d a_b-1.png\nmap_Ke a_b-1.png\nmap_Pr a_b-2.png\nmap_Pm a_b-3.png\n\
                 norm a_b-4.png\nmap_Bump a_b-4.png\n";
    assert!(text.contains(first), "{text}");
    assert!(text.contains("newmtl leaf.2\nKd 1 1 1\nNs 225\nPr 0.5\nPm 0\nd 1\n"), "{text}");
    assert_eq!(text.matches("map_d").count(), 1);
}

#[test]
fn what_the_format_cannot_hold_is_refused_and_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    write_obj(&path, &grove()).unwrap();
    let before = fs::read(&path).unwrap();
    let check = |list: DrawList, expected: &str| {
        let error = write_obj(&path, &list).unwrap_err().to_string();
        assert!(error.contains("a.obj: component 'tree'") && error.ends_with(expected), "{error}");
        assert!(fs::read(&path).unwrap() == before);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    };
    let mut bad = grove();
    bad.occurrences[1].world.translation.y = f32::INFINITY;
    check(bad, "a position is [3, inf, 0]");
    let mut mesh = quad();
    mesh.indices[0] = 4;
    let rows = vec![row(&SharedMesh::new(mesh), "bark", None)];
    check(lone(Body { rows, ..Body::new(Kind::of::<Tree>()) }), "a triangle uses vertex 4 of 4");
    let mut loud = grove();
    loud.bodies[0].rows[0].material = Arc::new(Material::matte("bark", f32::NAN, 0.0, 0.0));
    check(loud, "material 'bark' has a factor of NaN");
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let pool = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
    let list = grove();
    let one = pool(1).install(|| text(&list));
    assert!(one == pool(3).install(|| text(&list)));
    assert_eq!(text(&DrawList::default()).lines().count(), 1);
}
