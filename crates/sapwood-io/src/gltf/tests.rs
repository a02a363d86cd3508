//! Files are read back with an independent reader and compared with the draw list.

use std::sync::Arc;

use sapwood_geom::glam::{Affine3, Vec2, Vec3};
use sapwood_geom::{Image, Mesh, Shared, SharedMesh};
use sapwood_graph::{
    Alpha, Anchor, Body, Camera, CameraRow, DrawRow, Kind, Label, LabelRow, Lens, Light, LightRow,
    LightShape, Material, Named, Occurrence,
};

use gltf_json as json;

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
    DrawRow::new(Affine3::IDENTITY, SharedMesh::new(mesh), material(name))
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

fn leaf_material() -> Material {
    let leaf = Image::from_fn(4, 4, |x, y| [10 * x as u8, 10 * y as u8, 0, 60 * x as u8]);
    let bumps = Image::from_fn(2, 2, |x, _| [128, 128 + x as u8, 255, 255]);
    let mut material = Material {
        alpha: Alpha::Mask(0.5),
        emissive: [0.0, 0.5, 4.0],
        ..Material::matte("leaf", 1.0, 1.0, 1.0)
    };
    material.images.base_color = Some(Shared::new(leaf.clone()));
    // Equal content in another place.
    material.images.emissive = Some(Shared::new(leaf));
    material.images.normal = Some(Shared::new(bumps.clone()));
    material.images.metallic_roughness = Some(Shared::new(bumps));
    material
}

/// A row of this material.
fn painted(material: Material) -> DrawRow {
    DrawRow { material: Arc::new(material), ..row(quad(), "leaf") }
}

#[test]
fn images_are_embedded_once() {
    let mut list = lone(painted(leaf_material()));
    let second = Material { name: "second".into(), alpha: Alpha::Blend, ..leaf_material() };
    list.bodies[0].rows.push(painted(second));
    let reread = reread(&list);
    let document = &reread.document;
    assert_eq!((document.images().count(), document.textures().count()), (2, 2));
    assert_eq!(document.materials().count(), 2);
    for (image, width) in document.images().zip([2, 4]) {
        let gltf::image::Source::View { view, mime_type } = image.source() else {
            panic!("an image outside the buffer")
        };
        assert_eq!((mime_type, view.offset() % 4), ("image/png", 0));
        let bytes = &reread.bin[view.offset()..view.offset() + view.length()];
        let read = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        assert_eq!(read.info().width, width);
    }
    let leaf = document.materials().next().unwrap();
    assert_eq!(leaf.alpha_mode(), gltf::material::AlphaMode::Mask);
    assert_eq!(leaf.alpha_cutoff(), Some(0.5));
    assert_eq!(leaf.emissive_factor(), [0.0, 0.125, 1.0]);
    assert_eq!(leaf.emissive_strength(), Some(4.0));
    let color = leaf.pbr_metallic_roughness().base_color_texture().unwrap();
    assert_eq!(color.texture().index(), leaf.emissive_texture().unwrap().texture().index());
    let blend = document.materials().nth(1).unwrap();
    assert_eq!(blend.alpha_mode(), gltf::material::AlphaMode::Blend);
    assert_eq!(document.extensions_used().collect::<Vec<_>>(), ["KHR_materials_emissive_strength"]);
    assert_eq!(glb_bytes(&list).unwrap(), glb_bytes(&list).unwrap());
}

#[test]
fn what_comes_through_a_leaf_has_the_colour_of_the_leaf() {
    let leaf =
        Material { translucency: 0.25, base_color: [0.5, 0.75, 0.25, 1.0], ..leaf_material() };
    let plain = Material { translucency: 0.5, ..Material::matte("paper", 1.0, 1.0, 1.0) };
    let mut list = lone(painted(leaf));
    list.bodies[0].rows.push(painted(plain));
    let bytes = glb_bytes(&list).unwrap();
    let root = json::Root::from_slice(&Glb::from_slice(&bytes).unwrap().json).unwrap();
    let name = "KHR_materials_diffuse_transmission";
    assert!(root.extensions_used.iter().any(|used| used == name));
    let of = |i: usize| &root.materials[i].extensions.as_ref().unwrap().others[name];
    assert_eq!(
        of(0).to_string(),
        "{\"diffuseTransmissionColorFactor\":[0.5,0.75,0.25],\
         \"diffuseTransmissionColorTexture\":{\"index\":1},\"diffuseTransmissionFactor\":0.25}"
    );
    assert_eq!(
        of(1).to_string(),
        "{\"diffuseTransmissionColorFactor\":[1.0,1.0,1.0],\"diffuseTransmissionFactor\":0.5}"
    );
    let color = root.materials[0].pbr_metallic_roughness.base_color_texture.as_ref().unwrap();
    assert_eq!(color.index.value(), 1);
}

#[test]
fn materials_with_impossible_numbers_are_refused() {
    let check = |material: Material, expected: &str| {
        let error = glb_bytes(&lone(painted(material))).unwrap_err().to_string();
        assert!(error.ends_with(expected), "{error}");
    };
    let good = Material::matte("good", 1.0, 1.0, 1.0);
    check(
        Material { alpha: Alpha::Mask(f32::NAN), ..good.clone() },
        "material 'good' has a least coverage of NaN (accepted: 0 to 1)",
    );
    check(
        Material { emissive: [0.0, -1.0, 0.0], ..good.clone() },
        "has an emission of -1 (accepted: 0 or more)",
    );
    check(
        Material { translucency: 1.5, ..good.clone() },
        "material 'good' has a translucency of 1.5 (accepted: 0 to 1)",
    );
    let mut bad = good;
    let image = Image { width: 2, height: 2, pixels: Vec::new() };
    bad.images.normal = Some(Shared::new(image));
    check(bad, "has 0 pixels in an image of 2 x 2");
}

/// A body with a light of each shape, both cameras and a text.
fn stage() -> Body {
    let light = |name: &str, shape| LightRow {
        local: Affine3::from_rotation_x(1.0) * Affine3::from_scale(Vec3::splat(3.0)),
        light: Light { name: name.into(), color: [1.0, 0.5, 0.25], intensity: 7.0, shape },
    };
    let camera = |name: &str, lens, far| CameraRow {
        local: Affine3::from_translation(Vec3::Z),
        camera: Camera { name: name.into(), lens, near: 0.5, far },
    };
    let label = Label {
        anchor: Anchor::Middle,
        color: [0.25, 0.5, 1.0, 0.5],
        ..Label::new("13 m \"tall\"", 0.1)
    };
    Body {
        lights: vec![
            light("sun", LightShape::Directional),
            light("lamp", LightShape::Point { range: Some(9.0) }),
            light("torch", LightShape::Spot { range: None, inner: 0.25, outer: 0.5 }),
        ],
        cameras: vec![
            camera("eye", Lens::Perspective { vertical_angle: 0.75 }, None),
            camera("plan", Lens::Orthographic { height: 4.0 }, Some(10.0)),
        ],
        labels: vec![LabelRow { local: Affine3::from_scale(Vec3::splat(2.0)), label }],
        ..Body::new(Kind::of::<Stone>())
    }
}

#[test]
fn lights_cameras_and_texts_are_nodes() {
    let world = |x| Affine3::from_translation(Vec3::X * x);
    let list = DrawList {
        bodies: vec![stage()],
        occurrences: [0.0, 5.0].map(|x| Occurrence { body: 0, world: world(x) }).into(),
    };
    let reread = reread(&list);
    let document = &reread.document;
    assert!(reread.bin.is_empty());
    let lights: Vec<_> = document.lights().unwrap().collect();
    assert_eq!(lights.len(), 3);
    assert_eq!(
        (lights[0].name(), lights[0].color(), lights[0].intensity()),
        (Some("sun"), [1.0, 0.5, 0.25], 7.0)
    );
    use gltf::khr_lights_punctual::Kind::{Directional, Point, Spot};
    assert!(matches!(lights[0].kind(), Directional));
    assert!(matches!(lights[1].kind(), Point) && lights[1].range() == Some(9.0));
    assert!(matches!(lights[2].kind(), Spot { inner_cone_angle: 0.25, outer_cone_angle: 0.5 }));
    let cameras: Vec<_> = document.cameras().collect();
    let cameras: Vec<_> = cameras.iter().map(|camera| camera.projection()).collect();
    let [gltf::camera::Projection::Perspective(eye), gltf::camera::Projection::Orthographic(plan)] =
        cameras.as_slice()
    else {
        panic!("other cameras")
    };
    assert_eq!((eye.yfov(), eye.znear(), eye.zfar()), (0.75, 0.5, None));
    assert_eq!((plan.xmag(), plan.ymag(), plan.zfar()), (2.0, 2.0, 10.0));
    let nodes: Vec<_> = document.default_scene().unwrap().nodes().collect();
    let names: Vec<_> = nodes.iter().map(|node| node.name().unwrap()).collect();
    let text = "13 m \"tall\"";
    assert_eq!(names[..6], ["sun", "lamp", "torch", "eye", "plan", text]);
    assert_eq!(nodes.len(), 12);
    assert_eq!(nodes[6].light().unwrap().index(), 0);
    let (at, turn, scale) = nodes[6].transform().decomposed();
    assert_eq!((at, scale), ([5.0, 0.0, 0.0], [1.0; 3]));
    assert!((turn[0] - libm::sinf(0.5)).abs() < 1e-6, "{turn:?}");
    assert_eq!(nodes[5].transform().decomposed().2, [2.0; 3]);
    let extras = nodes[5].extras().as_ref().unwrap().get();
    assert_eq!(
        extras,
        r#"{"text":"13 m \"tall\"","height":0.1,"anchor":"middle","color":[0.25,0.5,1,0.5]}"#
    );
}

#[test]
fn impossible_lights_cameras_and_texts_are_refused() {
    let check = |change: fn(&mut Body), expected: &str| {
        let mut body = stage();
        change(&mut body);
        let occurrences = vec![Occurrence { body: 0, world: Affine3::IDENTITY }];
        let error = glb_bytes(&DrawList { bodies: vec![body], occurrences }).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    };
    check(|body| body.lights[1].light.intensity = -1.0, "'stone' cannot be written: light 'lamp'");
    check(|body| body.cameras[1].camera.far = None, "camera 'plan' has an orthographic camera");
    check(|body| body.labels[0].label.color[3] = 2.0, "has colour [0.25, 0.5, 1.0, 2.0]");
    check(|body| body.lights[0].local.translation.x = f32::NAN, "its place is not finite");
}

#[test]
fn a_pair_holds_what_one_file_holds() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("my tree\u{fc}.gltf");
    write_gltf(&path, &grove()).unwrap();
    let text = std::fs::read(&path).unwrap();
    let pair = gltf::Gltf::from_slice(&text).unwrap();
    let buffer = pair.document.buffers().next().unwrap();
    let gltf::buffer::Source::Uri(uri) = buffer.source() else { panic!("no file") };
    assert_eq!(uri, "my%20tree%C3%BC.bin");
    let bin = std::fs::read(folder.path().join("my tree\u{fc}.bin")).unwrap();
    let one = reread(&grove());
    assert_eq!((buffer.length(), &bin), (bin.len(), &one.bin));
    assert_eq!(pair.document.nodes().count(), one.document.nodes().count());
    // A refused list changes neither file.
    let mut bad = grove();
    bad.occurrences[1].world.translation.x = f32::NAN;
    write_gltf(&path, &bad).unwrap_err();
    assert_eq!(std::fs::read(&path).unwrap(), text);
    // Without anything to put into it there is no second file.
    write_gltf(folder.path().join("empty.gltf"), &DrawList::default()).unwrap();
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3);
}

#[test]
fn half_a_pair_is_never_added() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("tree.gltf")).unwrap();
    let mut files = FileSet::new();
    files.add_gltf(folder.path().join("tree.gltf"), &grove()).unwrap_err();
    assert_eq!(files.written().count(), 0);
    files.commit().unwrap();
    assert!(!folder.path().join("tree.bin").exists());
}
