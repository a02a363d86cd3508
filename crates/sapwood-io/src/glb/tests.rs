//! Files are read back with an independent reader and compared with the draw list.

use std::sync::Arc;

use sapwood_geom::glam::{Affine3, Vec2, Vec3};
use sapwood_geom::{Mesh, Shared, SharedMesh};
use sapwood_graph::{Body, DrawRow, Kind, Named, Occurrence};

use super::*;

struct Tree;
struct Stone;

impl Named for Tree {
    const NAME: &'static str = "tree";
}

impl Named for Stone {
    const NAME: &'static str = "stone";
}

fn quad() -> Mesh {
    Mesh {
        positions: vec![Vec3::new(-0.0, 0.1, 0.0), Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y],
        normals: vec![Vec3::Z; 4],
        uvs: vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y],
        indices: vec![0, 1, 2, 0, 2, 3],
    }
}

fn material(name: &str) -> Arc<Material> {
    Arc::new(Material {
        base_color: [0.25, 0.5, 0.75, 1.0],
        roughness: 0.9,
        double_sided: name == "leaf",
        ..Material::matte(name, 0.0, 0.0, 0.0)
    })
}

fn row(mesh: Mesh, name: &str) -> DrawRow {
    DrawRow {
        local: Affine3::IDENTITY,
        mesh: SharedMesh::new(mesh),
        material: material(name),
        instances: None,
    }
}

fn with_instances(instances: Vec<Affine3>) -> DrawRow {
    DrawRow { instances: Some(Shared::new(instances)), ..row(quad(), "leaf") }
}

fn body<T: Named>(rows: Vec<DrawRow>) -> Body {
    Body { rows, ..Body::new(Kind::of::<T>()) }
}

/// One tree at the origin.
fn lone(row: DrawRow) -> DrawList {
    DrawList {
        bodies: vec![body::<Tree>(vec![row])],
        occurrences: vec![Occurrence { body: 0, world: Affine3::IDENTITY }],
    }
}

/// A tree and its copy, a mirrored and a sheared one, a stone, and something without triangles.
fn grove() -> DrawList {
    let shear = Affine3::from_scale(Vec3::new(2.0, 1.0, 1.0)) * Affine3::from_rotation_z(0.5);
    let leaves = (0..5).map(|i| Affine3::from_translation(Vec3::Y * i as f32)).collect();
    let places = [
        (0, Affine3::IDENTITY),
        (0, Affine3::from_translation(Vec3::X * 3.0)),
        (0, Affine3::from_scale(Vec3::new(-1.0, 1.0, 1.0))),
        (0, shear),
        (2, Affine3::from_rotation_x(-1.5)),
        (1, Affine3::IDENTITY),
    ];
    DrawList {
        bodies: vec![
            body::<Tree>(vec![row(quad(), "bark"), with_instances(leaves)]),
            body::<Tree>(vec![row(Mesh::default(), "bark")]),
            body::<Stone>(vec![row(quad(), "bark")]),
        ],
        occurrences: places.map(|(body, world)| Occurrence { body, world }).into(),
    }
}

struct Reread {
    document: gltf::Document,
    bin: Vec<u8>,
}

fn reread(list: &DrawList) -> Reread {
    let bytes = glb_bytes(list).unwrap();
    let gltf = gltf::Gltf::from_slice(&bytes).unwrap();
    Reread { document: gltf.document, bin: gltf.blob.unwrap_or_default() }
}

impl Reread {
    /// Positions and indices of one primitive.
    fn primitive(&self, mesh: usize, primitive: usize) -> (Vec<[f32; 3]>, Vec<u32>) {
        let mesh = self.document.meshes().nth(mesh).unwrap();
        let primitive = mesh.primitives().nth(primitive).unwrap();
        let reader = primitive.reader(|_| Some(&self.bin));
        (
            reader.read_positions().unwrap().collect(),
            reader.read_indices().unwrap().into_u32().collect(),
        )
    }
}

#[test]
fn what_is_shared_is_written_once() {
    let reread = reread(&grove());
    assert_eq!(reread.document.meshes().count(), 2);
    assert_eq!(reread.document.materials().count(), 2);
    let top: Vec<_> = reread.document.default_scene().unwrap().nodes().collect();
    let names: Vec<_> = top.iter().map(|node| node.name().unwrap()).collect();
    assert_eq!(names, ["tree", "tree", "tree", "tree", "stone"]);
    let meshes: Vec<_> = top.iter().map(|node| node.mesh().map(|mesh| mesh.index())).collect();
    assert_eq!(meshes, [Some(0), Some(0), Some(0), None, Some(1)]);
    // Shear takes two nodes, the inner one with the mesh.
    assert_eq!(top[3].children().next().unwrap().mesh().unwrap().index(), 0);
    // Four accessors for each of three primitives.
    assert_eq!(reread.document.accessors().count(), 12);
}

#[test]
fn positions_come_back_bit_for_bit() {
    let reread = reread(&grove());
    let (positions, indices) = reread.primitive(0, 0);
    let bits = |p: [f32; 3]| p.map(f32::to_bits);
    let expected: Vec<_> = quad().positions.iter().map(|p| bits(p.to_array())).collect();
    assert_eq!(positions.into_iter().map(bits).collect::<Vec<_>>(), expected);
    assert_eq!(indices, quad().indices);
    let (leaves, indices) = reread.primitive(0, 1);
    assert_eq!((leaves.len(), indices.len()), (20, 30));
    assert_eq!(leaves[4 * 3 + 1], [1.0, 3.0, 0.0]);
    assert_eq!(indices[6 * 3], 12);
}

#[test]
fn bytes_are_the_same_every_time() {
    assert_eq!(glb_bytes(&grove()).unwrap(), glb_bytes(&grove()).unwrap());
}

#[test]
fn mirrored_instances_face_their_normals() {
    let mirrored = Affine3::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    let reread = reread(&lone(with_instances(vec![mirrored])));
    let (positions, indices) = reread.primitive(0, 0);
    let [a, b, c] = [0, 1, 2].map(|i| Vec3::from_array(positions[indices[i] as usize]));
    assert!((b - a).cross(c - a).z > 0.0);
}

#[test]
fn indices_are_as_wide_as_they_must_be() {
    let points = |n: usize| Mesh {
        positions: vec![Vec3::X; n],
        normals: vec![Vec3::Z; n],
        uvs: vec![Vec2::ZERO; n],
        indices: vec![0, 1, n as u32 - 1],
    };
    for (n, size) in [(65_535, 2), (65_536, 4)] {
        let reread = reread(&lone(row(points(n), "bark")));
        let indices = reread.document.accessors().last().unwrap();
        assert_eq!(indices.data_type().size(), size);
        assert_eq!(reread.primitive(0, 0).1[2], n as u32 - 1);
    }
}

#[test]
fn nothing_gives_a_valid_file() {
    for empty in
        [DrawList::default(), lone(row(Mesh::default(), "bark")), lone(with_instances(Vec::new()))]
    {
        let reread = reread(&empty);
        assert_eq!(reread.document.meshes().count(), 0);
        assert_eq!(reread.document.nodes().count(), 0);
        assert_eq!(reread.document.buffers().count(), 0);
    }
}

#[test]
fn what_gltf_does_not_allow_is_refused_by_name() {
    let check = |mesh: Mesh, expected: &str| {
        let error = glb_bytes(&lone(row(mesh, "bark"))).unwrap_err();
        assert_eq!(error.to_string(), format!("component 'tree' cannot be written: {expected}"));
    };
    let mut mesh = quad();
    mesh.positions[2].y = f32::NAN;
    check(mesh, "the position of vertex 2 is [1, NaN, 0]");
    let mut mesh = quad();
    mesh.normals[1] = Vec3::ZERO;
    check(mesh, "the normal of vertex 1 is [0, 0, 0], not of length 1");
    let mut mesh = quad();
    mesh.indices[5] = 4;
    check(mesh, "a triangle uses vertex 4 of 4");
    let mut mesh = quad();
    mesh.indices.pop();
    check(mesh, "a mesh has indices that are no triangle");
    let mut mesh = quad();
    mesh.uvs.pop();
    check(mesh, "4 positions, 4 normals, 3 texture coordinates");

    let mut lost = lone(row(quad(), "bark"));
    lost.occurrences[0].world.translation.x = f32::INFINITY;
    assert!(glb_bytes(&lost).unwrap_err().to_string().contains("place is not finite"));
    let mut loud = lone(row(quad(), "bark"));
    loud.bodies[0].rows[0].material =
        Arc::new(Material { roughness: 2.0, ..(*material("bark")).clone() });
    let error = glb_bytes(&loud).unwrap_err().to_string();
    assert!(error.contains("material 'bark' has a factor of 2 (accepted: 0 to 1)"), "{error}");
    loud.bodies[0].rows.clear();
    glb_bytes(&loud).unwrap();
}

#[test]
fn more_than_four_gibibytes_are_refused_before_they_are_built() {
    let n = 1 << 20;
    let big = Mesh {
        positions: vec![Vec3::X; n],
        normals: vec![Vec3::Z; n],
        uvs: vec![Vec2::ZERO; n],
        indices: vec![0, 1, 2],
    };
    let mut list = lone(row(big, "leaf"));
    list.bodies[0].rows[0].instances = Some(Shared::new(vec![Affine3::IDENTITY; 200]));
    let error = glb_bytes(&list).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::TooLarge { .. }), "{error}");
}

#[test]
fn a_refused_list_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tree.glb");
    write_glb(&path, &grove()).unwrap();
    let before = std::fs::read(&path).unwrap();
    assert_eq!(before, glb_bytes(&grove()).unwrap());
    let mut bad = grove();
    bad.occurrences[1].world.translation.x = f32::NAN;
    let error = write_glb(&path, &bad).unwrap_err();
    assert!(error.to_string().contains("tree.glb: component 'tree'"), "{error}");
    assert_eq!(std::fs::read(&path).unwrap(), before);
}
