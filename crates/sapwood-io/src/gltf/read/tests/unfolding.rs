//! Files that ask for far more memory than they are long, and honest ones that look like them.

use super::*;
use crate::ErrorKind;

const F32: u32 = 5126;

/// Gives the document one mesh of `n` primitives, made by their numbers.
fn with_primitives(
    document: &mut Value,
    n: usize,
    mut primitive: impl FnMut(&mut Value, usize) -> Value,
) {
    let primitives: Vec<Value> = (0..n).map(|i| primitive(document, i)).collect();
    document["meshes"] = json!([{ "primitives": primitives }]);
}

fn push(document: &mut Value, list: &str, entry: Value) -> usize {
    let entries = document[list].as_array_mut().unwrap();
    entries.push(entry);
    entries.len() - 1
}

/// The file is refused at this place, with what it would have taken up to there.
fn check_bomb(document: &Value, bin: &[u8], place: &str) {
    let bytes = glb(document, bin);
    assert!(bytes.len() < 1 << 20, "{}", bytes.len());
    let error = read(&bytes, None, &ReadLimits::default()).map(drop).unwrap_err();
    let ErrorKind::Unfolds { at, bytes: found, limit, n_read } = error.kind() else {
        panic!("{error}");
    };
    assert_eq!((at.as_str(), *n_read), (place, bytes.len() as u64));
    assert_eq!(*limit, 32 * n_read + (1 << 26));
    assert!((*limit + 1..3 * limit).contains(found), "{found} {limit}");
    let told = format!(
        "{at}: meshes and instances take {found} bytes of memory; at most {limit} are given to \
         {n_read} bytes of files"
    );
    assert_eq!(error.to_string(), told);
}

#[test]
fn accessors_over_the_same_bytes_are_counted_each() {
    let (mut document, mut bin) = triangle();
    let n = 10_000;
    add(&mut document, &mut bin, (F32, "VEC3", n), &vec![0; 12 * n]);
    let view = document["bufferViews"].as_array().unwrap().len() - 1;
    with_primitives(&mut document, 500, |document, i| {
        let accessor = json!({
            "bufferView": view, "byteOffset": 4 * i, "componentType": F32, "type": "VEC3",
            "count": n - 200,
        });
        json!({ "attributes": { "POSITION": push(document, "accessors", accessor) } })
    });
    // Each takes 32 bytes for each of 9,800 vertices and of three for each of 3,266 triangles, and 12
    // for each of these.
    check_bomb(&document, &bin, "meshes[0].primitives[109]");
}

#[test]
fn zeros_without_bytes_are_counted() {
    let zeros = |count: u32| json!({ "componentType": F32, "type": "VEC3", "count": count });
    let (mut document, bin) = triangle();
    with_primitives(&mut document, 50, |document, _| {
        let position = push(document, "accessors", zeros(1 << 20));
        json!({ "attributes": { "POSITION": position, "NORMAL": position } })
    });
    check_bomb(&document, &bin, "meshes[0].primitives[1]");

    let (mut document, bin) = triangle();
    let nodes: Vec<Value> = (0..50)
        .map(|_| {
            let attributes =
                json!({ "TRANSLATION": push(&mut document, "accessors", zeros(1 << 20)) });
            let instancing = json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
            json!({ "mesh": 0, "extensions": instancing })
        })
        .collect();
    document["scenes"][0]["nodes"] = (0..nodes.len()).collect();
    document["nodes"] = json!(nodes);
    let place = "nodes[1].extensions.EXT_mesh_gpu_instancing.attributes";
    check_bomb(&document, &bin, place);
}

#[test]
fn what_unfolds_by_its_materials_is_counted_as_it_is_read() {
    let (mut document, mut bin) = triangle();
    let n = 9_999;
    let positions = add(&mut document, &mut bin, (F32, "VEC3", n), &vec![0; 12 * n]);
    let png = crate::png::png_bytes(
        &sapwood_geom::Image::from_fn(1, 1, |_, _| [9; 4]),
        crate::png::Packing::Fast,
    )
    .unwrap();
    add(&mut document, &mut bin, (5121, "SCALAR", png.len()), &png);
    let view = document["bufferViews"].as_array().unwrap().len() - 1;
    document["images"] = json!([{ "bufferView": view }]);
    document["textures"] = json!([{ "source": 0 }]);
    document["materials"] = json!([]);
    with_primitives(&mut document, 500, |document, i| {
        let transform = json!({ "KHR_texture_transform": { "rotation": i } });
        let texture = json!({ "index": 0, "extensions": transform });
        let material = json!({ "pbrMetallicRoughness": { "baseColorTexture": texture } });
        let material = push(document, "materials", material);
        json!({ "attributes": { "POSITION": positions, "TEXCOORD_0": 0 }, "material": material })
    });
    let uvs = add(&mut document, &mut bin, (F32, "VEC2", n), &vec![0; 8 * n]);
    for i in 0..500 {
        let pointer = format!("/meshes/0/primitives/{i}/attributes/TEXCOORD_0");
        set(&mut document, &pointer, json!(uvs));
    }
    check_bomb(&document, &bin, "meshes[0].primitives[112]");
}

#[test]
fn parts_are_counted_at_each_node() {
    let (mut document, bin) = triangle();
    let primitive = document["meshes"][0]["primitives"][0].clone();
    with_primitives(&mut document, 1100, |_, _| primitive.clone());
    document["nodes"] = (0..1000).map(|_| json!({ "mesh": 0 })).collect();
    document["scenes"][0]["nodes"] = (0..1000).collect();
    let error = read_both(&document, &bin).map(drop).unwrap_err();
    let told = "nodes: 1100000 parts of meshes at all nodes of the scene; at most 1048576 are read";
    assert_eq!(error.to_string(), told);
    let limits = ReadLimits { shown: 1_100_000, ..ReadLimits::default() };
    assert!(read(&glb(&document, &bin), None, &limits).is_ok());
}

#[test]
fn vertices_that_many_primitives_share_are_taken_by_those_that_have_them() {
    let (mut document, mut bin) = triangle();
    let n: u16 = 60_000;
    let points = (0..n).flat_map(|i| [f32::from(i), f32::from(i % 7), 1.0]);
    let points = floats(&points.collect::<Vec<_>>());
    let positions = add(&mut document, &mut bin, (F32, "VEC3", usize::from(n)), &points);
    let up = floats(&[0.0, 0.0, 1.0].repeat(usize::from(n)));
    let normals = add(&mut document, &mut bin, (F32, "VEC3", usize::from(n)), &up);
    let n_parts: u16 = 1000;
    for with_normals in [true, false] {
        let mut document = document.clone();
        let mut bin = bin.clone();
        with_primitives(&mut document, usize::from(n_parts), |document, i| {
            // Backwards, and with one vertex twice.
            let first = i as u16 * 60;
            let corners = [first + 9, first + 4, first, first + 4, first + 9, first + 20];
            let corners: Vec<u8> = corners.iter().flat_map(|i| i.to_le_bytes()).collect();
            let indices = add(document, &mut bin, (5123, "SCALAR", 6), &corners);
            let mut attributes = json!({ "POSITION": positions });
            if with_normals {
                attributes["NORMAL"] = json!(normals);
            }
            json!({ "attributes": attributes, "indices": indices })
        });
        let model = read_both(&document, &bin).unwrap();
        assert_eq!(model.meshes[0].len(), usize::from(n_parts));
        for (part, i) in model.meshes[0].iter().zip(0..) {
            let mesh = &part.mesh;
            assert_eq!(mesh.fault(), None);
            let xs: Vec<f32> =
                mesh.indices.iter().map(|index| mesh.positions[*index as usize].x).collect();
            let first = f32::from(i * 60u16);
            assert_eq!(xs, [9.0, 4.0, 0.0, 4.0, 9.0, 20.0].map(|x| first + x));
            assert_eq!(mesh.positions.len(), if with_normals { 4 } else { 6 });
        }
    }
}

#[test]
fn instances_that_nodes_share_are_read_once() {
    let (mut document, mut bin) = triangle();
    let places = add(&mut document, &mut bin, (F32, "VEC3", 2), &[0; 24]);
    let instancing =
        json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": places } } });
    document["nodes"] = (0..2).map(|_| json!({ "mesh": 0, "extensions": instancing })).collect();
    document["scenes"][0]["nodes"] = json!([0, 1]);
    let model = read_both(&document, &bin).unwrap();
    let [a, b] = [0, 1].map(|node| model.nodes[node].instances.clone().unwrap());
    assert_eq!((a.as_ptr(), a.len()), (b.as_ptr(), 2));
}
