//! Every feature that is read, in a file made by hand.

use sapwood_geom::glam::{Quat, Vec2};
use sapwood_graph::{DrawList, Lens, LightShape, Material};
use sapwood_scene::{Scene, Transform, built_in_rules};

use super::materials::{dots, material_of, painted, png};
use super::*;

/// What a model draws.
fn drawn(model: &Model) -> DrawList {
    let mut scene = Scene::new();
    let top = model.add_to(&mut scene);
    let view = scene.open_view(top, &built_in_rules()).unwrap();
    scene.draw_list(view, 10_000).unwrap()
}

/// Where everything that a model draws stands, instances included.
fn places(model: &Model) -> Vec<Affine3> {
    let list = drawn(model);
    let places = list.placed_rows().flat_map(|(world, row)| match &row.instances {
        None => vec![world],
        Some(instances) => instances.iter().map(|instance| world * *instance).collect(),
    });
    places.collect()
}

#[test]
fn a_triangle_without_normals_is_flat() {
    let model = changed(&[]).unwrap();
    assert_eq!(model.warnings, [""; 0]);
    let mesh = only_mesh(&model);
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!((&*mesh.normals, &*mesh.uvs), (&[Vec3::Z; 3][..], &[Vec2::ZERO; 3][..]));
    assert_eq!(mesh.indices, [0, 1, 2]);
    let material = model.meshes[0][0].material.as_ref().unwrap();
    let standard = Material { metallic: 1.0, ..Material::matte("", 1.0, 1.0, 1.0) };
    assert_eq!(**material, standard);
}

#[test]
fn indices_of_all_widths_and_none_are_read() {
    let narrow = [0u8, 1, 2];
    for (code, bytes) in [
        (5121, narrow.to_vec()),
        (5123, narrow.iter().flat_map(|i| u16::from(*i).to_le_bytes()).collect()),
        (5125, narrow.iter().flat_map(|i| u32::from(*i).to_le_bytes()).collect()),
    ] {
        let (mut document, mut bin) = triangle();
        let indices = add(&mut document, &mut bin, (code, "SCALAR", 3), &bytes);
        set(&mut document, "/meshes/0/primitives/0/indices", json!(indices));
        assert_eq!(only_mesh(&read_both(&document, &bin).unwrap()).indices, [0, 1, 2]);
    }
    let model = changed(&[("/meshes/0/primitives/0/indices", Value::Null)]).unwrap();
    assert_eq!(only_mesh(&model).indices, [0, 1, 2]);
}

/// Five points on a zigzag, with normals so that vertices stay shared.
fn zigzag(mode: u32) -> Model {
    let (mut document, mut bin) = triangle();
    let points = [[0., 0.], [1., 0.], [0., 1.], [1., 1.], [0., 2.]];
    let points: Vec<f32> = points.iter().flat_map(|[x, y]| [*x, *y, 0.0]).collect();
    let positions = add(&mut document, &mut bin, (5126, "VEC3", 5), &floats(&points));
    let normals = add(&mut document, &mut bin, (5126, "VEC3", 5), &floats(&[0., 0., 2.].repeat(5)));
    let attributes = json!({ "POSITION": positions, "NORMAL": normals });
    let primitive = json!({ "attributes": attributes, "mode": mode });
    set(&mut document, "/meshes/0/primitives/0", primitive);
    read_both(&document, &bin).unwrap()
}

#[test]
fn strips_and_fans_become_triangles_and_keep_their_sides() {
    let strip = zigzag(5);
    let mesh = only_mesh(&strip);
    assert_eq!(mesh.indices, [0, 1, 2, 2, 1, 3, 2, 3, 4]);
    // Normals got their length.
    assert_eq!(mesh.normals, [Vec3::Z; 5]);
    for triangle in mesh.indices.chunks_exact(3) {
        let [a, b, c] = [0, 1, 2].map(|i| mesh.positions[triangle[i] as usize]);
        assert!((b - a).cross(c - a).z > 0.0);
    }
    assert_eq!(zigzag(6).meshes[0][0].mesh.indices, [0, 1, 2, 0, 2, 3, 0, 3, 4]);
    let list = zigzag(4);
    assert_eq!(only_mesh(&list).indices, [0, 1, 2]);
    let told = "meshes[0].primitives[0]: one or two corners that are no triangle are left out";
    assert_eq!(list.warnings, [told]);
    for mode in 0..4 {
        let lines = zigzag(mode);
        assert!(lines.meshes[0].is_empty() && drawn(&lines).bodies.is_empty());
        assert_eq!(lines.warnings, ["meshes[0].primitives[0]: points and lines are left out"]);
    }
}

#[test]
fn sparse_elements_stand_for_others() {
    let (mut document, mut bin) = triangle();
    let indices = add(&mut document, &mut bin, (5123, "SCALAR", 2), &[1, 0, 2, 0]);
    let moved = floats(&[5.0, 0.0, 0.0, 0.0, 7.0, 0.0]);
    let values = add(&mut document, &mut bin, (5126, "VEC3", 2), &moved);
    let sparse = json!({
        "count": 2,
        "indices": { "bufferView": indices, "componentType": 5123 },
        "values": { "bufferView": values },
    });
    set(&mut document, "/accessors/0/sparse", sparse);
    let expected = [Vec3::ZERO, 5.0 * Vec3::X, 7.0 * Vec3::Y];
    assert_eq!(only_mesh(&read_both(&document, &bin).unwrap()).positions, expected);
    // Also where all others are zero.
    document["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    assert_eq!(only_mesh(&read_both(&document, &bin).unwrap()).positions, expected);
}

#[test]
fn views_may_be_interleaved() {
    let (mut document, mut bin) = triangle();
    let rows = floats(&[0., 0., 0., 0., 0., 1., 1., 0., 0., 0., 0., 1., 0., 1., 0., 0., 0., 1.]);
    let positions = add(&mut document, &mut bin, (5126, "VEC3", 3), &rows);
    document["bufferViews"][positions]["byteStride"] = json!(24);
    let mut normals = document["accessors"][positions].clone();
    normals["byteOffset"] = json!(12);
    set(&mut document, "/accessors/-", normals);
    let attributes = json!({ "POSITION": positions, "NORMAL": positions + 1 });
    set(&mut document, "/meshes/0/primitives/0/attributes", attributes);
    let model = read_both(&document, &bin).unwrap();
    assert_eq!(only_mesh(&model).positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!(only_mesh(&model).normals, [Vec3::Z; 3]);
}

#[test]
fn whole_numbers_are_read_as_they_are_or_as_shares() {
    let (mut document, mut bin) = triangle();
    // KHR_mesh_quantization; each element takes a multiple of four bytes.
    let bytes = [0, 0, 0, 0, 127, 0, 0, 0, 0, 127, 0, 0];
    let positions = add(&mut document, &mut bin, (5120, "VEC3", 3), &bytes);
    document["bufferViews"][positions]["byteStride"] = json!(4);
    let normals = add(&mut document, &mut bin, (5120, "VEC3", 3), &[0, 0, 127, 0].repeat(3));
    document["bufferViews"][normals]["byteStride"] = json!(4);
    document["accessors"][normals]["normalized"] = json!(true);
    let shares: Vec<u8> =
        [0u16, 65535, 13107, 0, 65535, 0].iter().flat_map(|n| n.to_le_bytes()).collect();
    let uvs = add(&mut document, &mut bin, (5123, "VEC2", 3), &shares);
    document["accessors"][uvs]["normalized"] = json!(true);
    let attributes = json!({ "POSITION": positions, "NORMAL": normals, "TEXCOORD_0": uvs });
    set(&mut document, "/meshes/0/primitives/0/attributes", attributes);
    document["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    document["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let model = read_both(&document, &bin).unwrap();
    assert_eq!(model.warnings, [""; 0]);
    let mesh = only_mesh(&model);
    assert_eq!(mesh.positions, [Vec3::ZERO, 127.0 * Vec3::X, 127.0 * Vec3::Y]);
    assert_eq!(mesh.normals, [Vec3::Z; 3]);
    assert_eq!(mesh.uvs, [Vec2::Y, Vec2::new(0.2, 0.0), Vec2::X]);
    document["accessors"][positions]["normalized"] = json!(true);
    let model = read_both(&document, &bin).unwrap();
    assert_eq!(only_mesh(&model).positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
}

#[test]
fn normals_without_direction_are_those_of_triangles() {
    let (mut document, mut bin) = triangle();
    let lost = floats(&[0., 0., 0., f32::NAN, 0., 0., 0., 1., 0.]);
    let normals = add(&mut document, &mut bin, (5126, "VEC3", 3), &lost);
    set(&mut document, "/meshes/0/primitives/0/attributes/NORMAL", json!(normals));
    let nowhere = floats(&[f32::INFINITY, 0., 1., 0., 0., 1.]);
    let uvs = add(&mut document, &mut bin, (5126, "VEC2", 3), &nowhere);
    set(&mut document, "/meshes/0/primitives/0/attributes/TEXCOORD_0", json!(uvs));
    let model = read_both(&document, &bin).unwrap();
    assert_eq!(only_mesh(&model).normals, [Vec3::Z, Vec3::Z, Vec3::Y]);
    assert_eq!(only_mesh(&model).uvs, [Vec2::ZERO, Vec2::X, Vec2::Y]);
    let at = "meshes[0].primitives[0].attributes";
    let told = [
        format!("{at}.TEXCOORD_0: texture coordinates that are no numbers are 0"),
        format!("{at}.NORMAL: normals without direction are made from triangles"),
    ];
    assert_eq!(model.warnings, told);
}

#[test]
fn places_multiply_down_the_tree() {
    let turned = [0.0, 0.0, libm::sinf(0.5), libm::cosf(0.5)];
    let model = changed(&[
        (
            "/nodes/0",
            json!({ "translation": [1, 2, 3], "rotation": turned, "scale": [2, 2, 2],
                    "children": [1, 2], "name": "top" }),
        ),
        (
            "/nodes/-",
            json!({ "matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1], "mesh": 0 }),
        ),
        ("/nodes/-", json!({ "mesh": 0 })),
        ("/nodes/-", json!({ "mesh": 0, "name": "in no scene" })),
    ])
    .unwrap();
    assert_eq!(model.nodes[0].name, "top");
    assert_eq!((model.nodes.len(), &*model.nodes[0].children), (3, &[1, 2][..]));
    let top = Affine3::from_scale_rotation_translation(
        Vec3::splat(2.0),
        Quat::from_array(turned),
        Vec3::new(1.0, 2.0, 3.0),
    );
    let quarter = Affine3::from_rotation_z(std::f32::consts::FRAC_PI_2);
    let inner = Affine3::from_translation(5.0 * Vec3::X) * quarter;
    let found = places(&model);
    assert!(found[0].abs_diff_eq(top * inner, 1e-6), "{found:?}");
    assert_eq!(found[1], top);
}

#[test]
fn a_model_may_stand_in_a_scene_more_than_once() {
    let model = changed(&[
        ("/nodes/0/children", json!([1])),
        ("/nodes/-", json!({ "mesh": 0, "translation": [0, 1, 0] })),
    ])
    .unwrap();
    let mut scene = Scene::new();
    let [first, second] = [(); 2].map(|()| model.add_to(&mut scene));
    let all = scene.add(sapwood_scene::Group);
    scene.append(all, first).unwrap();
    let moved = scene.add_to(all, Transform::translation(5.0, 0.0, 0.0)).unwrap();
    scene.append(moved, first).unwrap();
    scene.append(all, second).unwrap();
    let view = scene.open_view(all, &built_in_rules()).unwrap();
    let list = scene.draw_list(view, 100).unwrap();
    // Two nodes share one mesh, which is a component of its own in each of two models.
    assert_eq!((list.bodies.len(), list.occurrences.len()), (2, 6));
    assert_eq!(scene.bounds(view).unwrap().aabb.max, Vec3::new(6.0, 2.0, 0.0));
    assert!(list.bodies[0].rows[0].mesh.is_same(&list.bodies[1].rows[0].mesh));
}

#[test]
fn instances_stand_where_they_should() {
    let (mut document, mut bin) = triangle();
    let at = floats(&[1., 0., 0., 0., 0., 4.]);
    let at = add(&mut document, &mut bin, (5126, "VEC3", 2), &at);
    let half = 0x7fff_u16.to_le_bytes();
    let turns = [[0; 6].as_slice(), &half, &[0; 2], &half, &[0; 4]].concat();
    let turns = add(&mut document, &mut bin, (5122, "VEC4", 2), &turns);
    document["accessors"][turns]["normalized"] = json!(true);
    let scales =
        add(&mut document, &mut bin, (5126, "VEC3", 2), &floats(&[1., 1., 1., 2., 3., 4.]));
    let attributes = json!({ "TRANSLATION": at, "ROTATION": turns, "SCALE": scales, "_ID": 0 });
    document["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    let node = json!({
        "mesh": 0, "translation": [0, 10, 0],
        "extensions": { "EXT_mesh_gpu_instancing": { "attributes": attributes } },
    });
    set(&mut document, "/nodes/0", node);
    let model = read_both(&document, &bin).unwrap();
    let list = drawn(&model);
    assert_eq!((list.bodies.len(), list.occurrences.len()), (1, 1));
    let found = places(&model);
    let up = Affine3::from_translation(10.0 * Vec3::Y);
    assert!(found[0].abs_diff_eq(up * Affine3::from_translation(Vec3::X), 1e-6));
    let half_turn = Quat::from_xyzw(0.0, 1.0, 0.0, 0.0);
    let scale = Vec3::new(2.0, 3.0, 4.0);
    let second = Affine3::from_scale_rotation_translation(scale, half_turn, 4.0 * Vec3::Z);
    assert!(found[1].abs_diff_eq(up * second, 1e-5), "{:?}", found[1]);
}

#[test]
fn equal_primitives_are_read_once() {
    let model = changed(&[
        (
            "/meshes/-",
            json!({ "primitives": [
            { "attributes": { "POSITION": 0 }, "indices": 1 },
            { "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 },
        ] }),
        ),
        ("/materials", json!([{ "name": "bark" }])),
        ("/scenes/0/nodes", json!([0, 1])),
        ("/nodes/-", json!({ "mesh": 1 })),
    ])
    .unwrap();
    let [first, second] = &*model.meshes else { panic!("two meshes") };
    assert!(first[0].mesh.is_same(&second[0].mesh) && first[0].mesh.is_same(&second[1].mesh));
    assert_eq!(second[1].material.as_ref().unwrap().name, "bark");
}

#[test]
fn lights_and_cameras_are_read() {
    let lights = json!([
        { "type": "directional", "name": "sun", "color": [1, 0.5, 0.25], "intensity": 7 },
        { "type": "point", "range": 9 },
        { "type": "spot", "spot": { "innerConeAngle": 0.25, "outerConeAngle": 0.5 } },
    ]);
    let cameras = json!([
        { "type": "perspective", "name": "eye", "perspective": { "yfov": 0.75, "znear": 0.5 } },
        { "type": "orthographic",
          "orthographic": { "xmag": 3, "ymag": 2, "znear": 0, "zfar": 10 } },
    ]);
    let light = |i: usize| json!({ "KHR_lights_punctual": { "light": i } });
    let model = changed(&[
        ("/cameras", cameras),
        ("/extensions", json!({ "KHR_lights_punctual": { "lights": lights } })),
        ("/extensionsUsed", json!(["KHR_lights_punctual"])),
        ("/nodes/0", json!({ "children": [1, 2, 3], "translation": [0, 1, 0] })),
        ("/nodes/-", json!({ "extensions": light(0), "camera": 0 })),
        ("/nodes/-", json!({ "extensions": light(2), "camera": 1, "translation": [2, 0, 0] })),
        ("/nodes/-", json!({ "extensions": light(1) })),
    ])
    .unwrap();
    assert_eq!(model.warnings, [""; 0]);
    let list = drawn(&model);
    let found: Vec<_> = list.placed_lights().map(|(at, light)| (at.translation, light)).collect();
    assert_eq!(found[0].0, Vec3::Y);
    assert_eq!((&*found[0].1.name, found[0].1.intensity), ("sun", 7.0));
    assert_eq!(found[0].1.color, [1.0, 0.5, 0.25]);
    assert_eq!(found[0].1.shape, LightShape::Directional);
    assert_eq!(found[1].0, Vec3::new(2.0, 1.0, 0.0));
    let spot = LightShape::Spot { range: None, inner: 0.25, outer: 0.5 };
    assert_eq!((found[1].1.shape, found[1].1.intensity), (spot, 1.0));
    assert_eq!(found[2].1.shape, LightShape::Point { range: Some(9.0) });
    let found: Vec<_> = list.placed_cameras().map(|(_, camera)| camera).collect();
    assert_eq!(found[0].lens, Lens::Perspective { vertical_angle: 0.75 });
    assert_eq!((found[0].near, found[0].far, &*found[0].name), (0.5, None, "eye"));
    assert_eq!(found[1].lens, Lens::Orthographic { height: 4.0 });
    assert_eq!(found[1].far, Some(10.0));
}

#[test]
fn what_is_left_out_is_told_once_for_each_kind() {
    let colored = json!({ "attributes": { "POSITION": 0, "COLOR_0": 0 }, "targets": [{}] });
    let model = changed(&[
        ("/meshes/0/primitives", json!([colored, colored, colored])),
        ("/nodes/0/skin", json!(0)),
        ("/animations", json!([{}])),
        ("/extensionsUsed", json!(["KHR_materials_unlit", "KHR_texture_transform"])),
        ("/scene", Value::Null),
    ])
    .unwrap();
    let told = [
        "the extension KHR_materials_unlit is left out",
        "animations are left out",
        "no scene is the one to show; the first one is shown",
        "nodes[0]: skins are left out",
        "meshes[0].primitives[0] and 2 more: vertex colours are left out",
        "meshes[0].primitives[0] and 2 more: morph targets are left out",
    ];
    assert_eq!(model.warnings, told);
    let raw = json!({
        "occlusionTexture": { "index": 0 },
        "normalTexture": { "index": 0, "scale": 0.5 },
        "pbrMetallicRoughness": { "roughnessFactor": 1.5 },
        "emissiveTexture": { "index": 1 },
        "extensions": { "KHR_materials_diffuse_transmission": { "diffuseTransmissionFactor": 1 } },
    });
    let (mut document, bin) = painted(raw, &[png(&dots(0))]);
    document["samplers"] = json!([{ "wrapS": 33071 }]);
    document["textures"] = json!([{ "source": 0, "sampler": 0 }, {}]);
    let model = read_both(&document, &bin).unwrap();
    let told = [
        "textures[0]: images repeat beyond their edges",
        "textures[1]: a texture without a PNG or JPEG image is left out",
        "materials[0]: occlusion images are left out",
        "materials[0]: normals of images are not scaled",
        "materials[0].pbrMetallicRoughness.roughnessFactor: a number is held to its range",
    ];
    assert_eq!(model.warnings, told);
    assert_eq!((material_of(&model).roughness, material_of(&model).translucency), (1.0, 1.0));
}

#[test]
fn files_that_are_not_quite_right_are_read() {
    // Bytes behind the end, a chunk that nobody knows, no scene at all.
    let (mut document, bin) = triangle();
    document.as_object_mut().unwrap().remove("scenes");
    document.as_object_mut().unwrap().remove("scene");
    let text = document.to_string();
    let mut bytes =
        chunks(&[(0x4e4f_534a, text.as_bytes()), (0x004e_4942, &bin), (0x1234_5678, b"more")]);
    bytes.extend([0; 7]);
    let model = read(&bytes, None, &ReadLimits::default()).unwrap();
    assert_eq!(only_mesh(&model).n_triangles(), 1);
    let told = [
        "bytes behind the end that the header tells of are left out",
        "there is no scene; all nodes are shown",
    ];
    assert_eq!(model.warnings, told);
    // A scene with nothing in it, or with nothing to be seen.
    for nodes in [json!([]), json!([{}]), json!([{ "children": [1] }, {}])] {
        let roots: Vec<usize> = (0..nodes.as_array().unwrap().len().min(1)).collect();
        let model = changed(&[("/nodes", nodes), ("/scenes/0", json!({ "nodes": roots }))]);
        assert!(drawn(&model.unwrap()).bodies.is_empty());
    }
}
