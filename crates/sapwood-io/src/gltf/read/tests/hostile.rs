//! Files that are not what they should be: each is refused with one line.

use super::*;
use crate::Place;

/// The triangle after some changes is refused with this line.
pub(super) fn check(changes: &[(&str, Value)], expected: &str) {
    let error = changed(changes).map(drop).unwrap_err();
    assert_eq!(error.to_string(), expected);
}

fn check_bytes(bytes: &[u8], expected: &str) {
    let error = read(bytes, None, &ReadLimits::default()).map(drop).unwrap_err();
    assert_eq!(error.to_string(), expected);
}

#[test]
fn what_is_no_gltf_is_refused() {
    let accepted = "(accepted: a binary glTF file, or a glTF text)";
    check_bytes(b"", &format!("no text {accepted}"));
    check_bytes(b"  \n ", &format!("no text {accepted}"));
    check_bytes(b"solid", &format!("begins with the bytes [73, 6f, 6c, 69] {accepted}"));
    check_bytes(b"{", "not valid JSON: EOF while parsing an object");
    check_bytes(b"{\"asset\":{}}", "asset: missing field `version`");
    check_bytes(b"{}", "asset: missing (accepted: a version of glTF)");
    check_bytes(
        b"{\"asset\":{\"version\":\"1.0\"}}",
        "asset.version: \"1.0\" (accepted: versions from 2.0 on)",
    );
    check_bytes(
        b"{\"asset\":{\"version\":\"2.1\",\"minVersion\":\"2.1\"}}",
        "asset.minVersion: \"2.1\" (accepted: version 2.0)",
    );
    check_bytes(b"{\"nodes\":{}}", "not valid JSON: invalid type: map, expected a list");
    check_bytes(b"{\"nodes\":[{}],\"nodes\":[{}]}", "not valid JSON: nodes is there twice");
}

#[test]
fn broken_containers_are_refused() {
    let (document, bin) = triangle();
    let whole = glb(&document, &bin);
    let with = |at: usize, number: u32| {
        let mut bytes = whole.clone();
        bytes[at..at + 4].copy_from_slice(&number.to_le_bytes());
        bytes
    };
    let n = whole.len();
    let text = u32::from_le_bytes(whole[12..16].try_into().unwrap()) as usize;
    check_bytes(b"glTF\x02\0\0\0", "not valid GLB: 8 bytes; the header alone takes 12");
    check_bytes(&with(4, 1), "not valid GLB: version 1; only version 2 is read");
    let told = format!("not valid GLB: its header tells of {} bytes; {n} are there", n + 1);
    check_bytes(&with(8, n as u32 + 1), &told);
    check_bytes(&with(8, 4), &format!("not valid GLB: its header tells of 4 bytes; {n} are there"));
    check_bytes(&with(8, 12), "not valid GLB: no chunk of JSON");
    let there = n - 20;
    let told = format!("not valid GLB: chunk 0 tells of 4294967295 bytes; {there} are there");
    check_bytes(&with(12, u32::MAX), &told);
    check_bytes(&with(16, 7), "not valid GLB: the first chunk is no JSON");
    let told = "not valid GLB: chunk 1 tells of 60 bytes; 44 are there";
    check_bytes(&with(20 + text, 60), told);
    let told = "not valid GLB: byte 3 of the JSON text is not UTF-8";
    check_bytes(&chunks(&[(0x4e4f_534a, b"{\"a\xff\":1}")]), told);
    let told = "not valid JSON: EOF while parsing a value, at line 1, column 8 of the JSON chunk";
    check_bytes(&chunks(&[(0x4e4f_534a, b"{\"a\":")]), told);
    // Truncated anywhere.
    for n in 4..whole.len() {
        let error = read(&whole[..n], None, &ReadLimits::default()).unwrap_err();
        assert!(error.to_string().starts_with("not valid GLB: "), "{n}: {error}");
    }
}

#[test]
fn faults_of_a_text_have_a_line_and_a_column() {
    let limits = ReadLimits::default();
    let place = |text: &[u8]| read(text, None, &limits).unwrap_err().place().unwrap();
    let Place { line, column } = place(b"{\n \"nodes\": [,]}");
    assert_eq!((line, column), (2, 12));
    let Place { line, column } = place(b"{\n \"\xc3\xbc\": \"\xff\"}");
    assert_eq!((line, column), (2, 8));
}

#[test]
fn nesting_ends_in_an_error_and_not_on_the_stack() {
    for open in ["[", "{\"a\":"] {
        let deep = open.repeat(1_000_000);
        for text in [format!("{{\"x\":{deep}"), format!("{{\"nodes\":[{deep}")] {
            let error = read(text.as_bytes(), None, &ReadLimits::default()).unwrap_err();
            assert!(error.to_string().starts_with("not valid JSON: "), "{error}");
        }
    }
    // What nobody asks for may nest.
    let closed = format!("{}{}", "[".repeat(100_000), "]".repeat(100_000));
    let text = format!("{{\"asset\":{{\"version\":\"2.0\",\"extras\":{closed}}}}}");
    let error = read(text.as_bytes(), None, &ReadLimits::default());
    assert!(error.is_ok_and(|model| model.nodes.is_empty()));
}

#[test]
fn lists_without_end_are_refused() {
    let mut text = "{\"asset\":{\"version\":\"2.0\"},\"meshes\":[".to_owned();
    text.push_str(&"{},".repeat(document::MOST_ENTRIES + 1));
    text.push_str("{}]}");
    let told = "not valid JSON: lists of more than 4194304 entries are not read";
    check_bytes(text.as_bytes(), told);
    let names: Vec<String> = (0..2000).map(|i| i.to_string()).collect();
    let told = "extensionsUsed: lists of more than 1024 entries are not read";
    check(&[("/extensionsUsed", json!(names))], told);
}

#[test]
fn long_strings_are_not_repeated() {
    let long = "n".repeat(100_000);
    let told = "nodes[0]: a string of 100000 bytes (accepted: at most 65536)";
    check(&[("/nodes/0/name", json!(long))], told);
    check(&[("/nodes/0/mesh", json!(long))], told);
    check(
        &[("/nodes/0/name", json!(format!("{}\"{long}", "\"\\".repeat(9))))],
        &told.replace("100000", "100038"),
    );
    let told = "not valid JSON: invalid type: string, expected a list";
    check_bytes(format!("{{\"nodes\":\"{long}\"}}").as_bytes(), told);
    // But for data.
    let (mut document, bin) = triangle();
    let data: String = bin.iter().map(|byte| format!("%{byte:02x}")).collect();
    document["buffers"][0] = json!({ "byteLength": 44, "uri": format!("data:,{data}{long}") });
    let text = document.to_string().replace("\"uri\":", "\"uri\" :\n ");
    let model = read(text.as_bytes(), None, &ReadLimits::default()).unwrap();
    assert_eq!(only_mesh(&model).n_triangles(), 1);
}

#[test]
fn a_large_file_is_looked_at_before_it_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    // Files with a hole as large as this take no room, but would take time and memory.
    let check = |beginning: &[u8], expected: &str| {
        std::fs::write(&path, beginning).unwrap();
        std::fs::File::options().write(true).open(&path).unwrap().set_len(1 << 30).unwrap();
        let error = read_gltf(&path, &ReadLimits::default()).unwrap_err();
        assert_eq!(error.to_string(), format!("{}: {expected}", path.display()));
    };
    let told =
        "begins with the bytes [00, 00, 00, 00] (accepted: a binary glTF file, or a glTF text)";
    check(b"", told);
    check(b"{", "the JSON text: 1073741824 bytes; at most 134217728 are read");
    let mut bytes = chunks(&[(0x4e4f_534a, b"{\"asset\":{}}")]);
    check(&bytes, "asset: missing field `version`");
    bytes[12..16].copy_from_slice(&0x4000_0000u32.to_le_bytes());
    check(&bytes, "the JSON text: 1073741824 bytes; at most 134217728 are read");
}

#[test]
fn limits_are_held_before_anything_is_read() {
    let (document, bin) = triangle();
    let bytes = glb(&document, &bin);
    let check = |change: fn(&mut ReadLimits), expected: &str| {
        let mut limits = ReadLimits::default();
        change(&mut limits);
        assert_eq!(read(&bytes, None, &limits).unwrap_err().to_string(), expected);
    };
    check(|limits| limits.nodes = 0, "nodes: 1 nodes; at most 0 are read");
    let at = "meshes[0].primitives[0]";
    // Three vertices are read and three are made.
    let told = format!("{at}: 6 vertices in the meshes of the scene; at most 5 are read");
    check(|limits| limits.vertices = 5, &told);
    let told = format!("{at}: 1 triangles in the meshes of the scene; at most 0 are read");
    check(|limits| limits.triangles = 0, &told);
    let text = bytes.len() - 12 - 16 - 44;
    let told = format!("the JSON text: {text} bytes; at most 9 are read");
    check(|limits| limits.text_bytes = 9, &told);
    let limits = ReadLimits { bytes: 100, ..ReadLimits::default() };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    std::fs::write(&path, &bytes).unwrap();
    let error = read_gltf(&path, &limits).unwrap_err();
    let told = format!("{}: is {} bytes long; at most 100 are read", path.display(), bytes.len());
    assert_eq!(error.to_string(), told);
}

#[test]
fn accessors_must_have_their_bytes() {
    let missing = "(accepted: elements that are there)";
    let check_place = |changes: &[(&str, Value)], expected: &str| {
        check(changes, &format!("accessors[0]: {expected} {missing}"));
    };
    check_place(
        &[("/accessors/0/count", json!(4))],
        "4 elements of 12 bytes, 12 apart, from byte 0 on, in a view of 36",
    );
    check_place(
        &[("/accessors/0/count", json!(u64::MAX))],
        "18446744073709551615 elements of 12 bytes, 12 apart, from byte 0 on, in a view of 36",
    );
    check_place(
        &[("/accessors/0/byteOffset", json!(4))],
        "3 elements of 12 bytes, 12 apart, from byte 4 on, in a view of 36",
    );
    check_place(
        &[("/accessors/0/byteOffset", json!(u64::MAX))],
        "3 elements of 12 bytes, 12 apart, from byte 18446744073709551615 on, in a view of 36",
    );
    check_place(
        &[("/bufferViews/0/byteStride", json!(16))],
        "3 elements of 12 bytes, 16 apart, from byte 0 on, in a view of 36",
    );
    check_place(
        &[("/bufferViews/0/byteStride", json!(u64::MAX / 2))],
        "3 elements of 12 bytes, 9223372036854775807 apart, from byte 0 on, in a view of 36",
    );
    check(
        &[("/bufferViews/0/byteStride", json!(8))],
        "bufferViews[0].byteStride: 8 (accepted: 12 or more, for elements of as many bytes)",
    );
    check(
        &[("/bufferViews/0/byteLength", json!(1000))],
        "bufferViews[0]: 1000 bytes from byte 0 on, of a buffer of 44 (accepted: bytes that the \
         buffer has)",
    );
    check(
        &[("/bufferViews/0/byteOffset", json!(u64::MAX))],
        "bufferViews[0]: 36 bytes from byte 18446744073709551615 on, of a buffer of 44 (accepted: \
         bytes that the buffer has)",
    );
    check(
        &[("/buffers/0/byteLength", json!(48))],
        "buffers[0].byteLength: 48, but 44 bytes are there (accepted: no more than are there)",
    );
    check(
        &[("/bufferViews/1/buffer", json!(1))],
        "bufferViews[1].buffer: buffers[1] is not there (accepted: 0 to 0)",
    );
    check(
        &[("/accessors/0/bufferView", json!(9))],
        "accessors[0].bufferView: bufferViews[9] is not there (accepted: 0 to 1)",
    );
    check(
        &[("/accessors/0/count", json!(-1))],
        "accessors[0].count: invalid value: integer `-1` (accepted: u64)",
    );
    check(
        &[("/accessors/0", json!({ "componentType": 5126, "count": 1u64 << 31, "type": "VEC3" }))],
        "accessors[0]: 2147483648 elements without bytes; at most 1048576 are read",
    );
}

#[test]
fn accessors_must_hold_what_they_are_used_for() {
    let at = "meshes[0].primitives[0].attributes.POSITION";
    let accepted = "(accepted: VEC3 of f32, i8, u8, i16 or u16)";
    let told = format!("{at}: accessors[1] holds SCALAR of u16 {accepted}");
    check(&[("/meshes/0/primitives/0/attributes/POSITION", json!(1))], &told);
    let told = format!("{at}: accessors[0] holds VEC3 of u32 {accepted}");
    check(&[("/accessors/0/componentType", json!(5125))], &told);
    check(
        &[("/accessors/0/componentType", json!(5130))],
        "accessors[0].componentType: 5130 (accepted: 5120 to 5123, 5125 or 5126)",
    );
    let told = format!("{at}: accessors[0] holds \"VEC3\\u{{1b}}[31m and more\" of f32 {accepted}");
    check(&[("/accessors/0/type", json!("VEC3\u{1b}[31m and more"))], &told);
    check(
        &[("/meshes/0/primitives/0/indices", json!(0))],
        "meshes[0].primitives[0].indices: accessors[0] holds VEC3 of f32 (accepted: SCALAR of u8, \
         u16 or u32)",
    );
    check(
        &[("/meshes/0/primitives/0/attributes/NORMAL", json!(7))],
        "meshes[0].primitives[0].attributes.NORMAL: accessors[7] is not there (accepted: 0 to 1)",
    );
    check(
        &[("/meshes/0/primitives/0/mode", json!(7))],
        "meshes[0].primitives[0].mode: 7 (accepted: 0 to 6)",
    );
    check(
        &[("/meshes/0/primitives/0", json!({ "indices": 0 }))],
        "meshes[0].primitives[0]: missing field `attributes`",
    );
    let (mut document, mut bin) = triangle();
    let normals = add(&mut document, &mut bin, (5126, "VEC3", 2), &[0; 24]);
    set(&mut document, "/meshes/0/primitives/0/attributes/NORMAL", json!(normals));
    let told = "meshes[0].primitives[0].attributes.NORMAL: accessors[2] has 2 elements (accepted: \
                3, as many as there are positions)";
    assert_eq!(read_both(&document, &bin).unwrap_err().to_string(), told);
}

#[test]
fn numbers_that_are_none_are_refused() {
    let (document, bin) = triangle();
    for (number, name) in [(f32::NAN, "NaN"), (f32::NEG_INFINITY, "-inf")] {
        let mut bin = bin.clone();
        bin[16..20].copy_from_slice(&number.to_le_bytes());
        let told = format!(
            "meshes[0].primitives[0].attributes.POSITION: element 1 of accessors[0] is [1, {name}, \
             0] (accepted: finite numbers)"
        );
        assert_eq!(read_both(&document, &bin).unwrap_err().to_string(), told);
    }
    let accepted = "(accepted: finite numbers)";
    let far = &[("/nodes/0/translation", json!([1e39, 0, 0]))];
    check(far, &format!("nodes[0]: its place is not finite {accepted}"));
    let chain = &[
        ("/nodes/0", json!({ "scale": [1e30, 1, 1], "children": [1] })),
        ("/nodes/-", json!({ "scale": [1e30, 1, 1], "mesh": 0 })),
    ];
    check(chain, &format!("nodes[1]: it is too large or too far away {accepted}"));
    let large = &[("/nodes/0/scale", json!([3e38, 1, 1])), ("/nodes/0/name", json!("hill"))];
    assert!(changed(large).is_ok());
    let larger = &[
        ("/nodes/0/scale", json!([3e38, 1, 1])),
        ("/nodes/0/translation", json!([3e38, 0, 0])),
        ("/nodes/0/name", json!("hill")),
    ];
    let told = format!("the node \"hill\": its mesh is too large or too far away {accepted}");
    check(larger, &told);
    check(
        &[("/nodes/0/rotation", json!([0, 0, 0, 0]))],
        "nodes[0].rotation: [0.0, 0.0, 0.0, 0.0] is no rotation (accepted: a quaternion of length \
         1)",
    );
    let mut matrix = [1.0; 16];
    matrix[3] = 0.5;
    check(
        &[("/nodes/0/matrix", json!(matrix))],
        "nodes[0].matrix: its last row is [0.5, 1.0, 1.0, 1.0] (accepted: 0, 0, 0, 1)",
    );
    check(
        &[("/nodes/0/translation", json!([1, "up", 0]))],
        "nodes[0].translation[1]: invalid type: string \"up\" (accepted: f32)",
    );
}

#[test]
fn corners_must_be_vertices() {
    let (document, mut bin) = triangle();
    bin[40] = 3;
    let told = "meshes[0].primitives[0].indices: element 2 of accessors[1] is 3 (accepted: numbers \
                of vertices, of which there are 3)";
    assert_eq!(read_both(&document, &bin).unwrap_err().to_string(), told);
}

#[test]
fn sparse_elements_are_checked_too() {
    let (document, bin) = triangle();
    let check = |indices: [u8; 2], count: u64, expected: &str| {
        let (mut document, mut bin) = (document.clone(), bin.clone());
        let places = add(&mut document, &mut bin, (5121, "SCALAR", 2), &indices);
        let values = add(&mut document, &mut bin, (5126, "VEC3", 2), &[0; 24]);
        let sparse = json!({
            "count": count,
            "indices": { "bufferView": places, "componentType": 5121 },
            "values": { "bufferView": values },
        });
        set(&mut document, "/accessors/0/sparse", sparse);
        assert_eq!(read_both(&document, &bin).unwrap_err().to_string(), expected);
    };
    let rising = "(accepted: rising numbers below 3)";
    check([0, 3], 2, &format!("accessors[0].sparse.indices: number 1 is 3 {rising}"));
    check([1, 1], 2, &format!("accessors[0].sparse.indices: number 1 is 1 {rising}"));
    check([0, 1], 4, "accessors[0].sparse.count: 4 (accepted: at most 3)");
    check(
        [0, 1],
        3,
        "accessors[0].sparse.indices: 3 elements of 1 bytes, 1 apart, from byte 0 on, in a view of \
         2 (accepted: elements that are there)",
    );
}

#[test]
fn unknown_extensions_that_are_required_are_named() {
    for name in ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_texture_basisu"] {
        let told = format!("cannot be read without the extension {name}, which is not known");
        check(&[("/extensionsRequired", json!(["KHR_mesh_quantization", name]))], &told);
    }
    check(
        &[
            ("/accessors/0", json!({ "componentType": 5126, "count": 3, "type": "VEC3" })),
            ("/meshes/0/primitives/0/extensions", json!({ "KHR_draco_mesh_compression": {} })),
        ],
        "cannot be read without the extension KHR_draco_mesh_compression, which is not known",
    );
}

#[test]
fn instances_are_counted_and_limited() {
    let (mut document, mut bin) = triangle();
    let places = add(&mut document, &mut bin, (5126, "VEC3", 2), &[0; 24]);
    let scales = add(&mut document, &mut bin, (5126, "VEC3", 3), &[0; 36]);
    let attributes = json!({ "TRANSLATION": places });
    let instancing = json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
    set(&mut document, "/nodes/0/extensions", instancing);
    let at = "nodes[0].extensions.EXT_mesh_gpu_instancing.attributes";
    let limits = ReadLimits { instances: 1, ..ReadLimits::default() };
    let told = format!("{at}: 2 instances in the nodes of the scene; at most 1 are read");
    let error = read(&glb(&document, &bin), None, &limits).unwrap_err();
    assert_eq!(error.to_string(), told);
    let pointer = "/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes/SCALE";
    set(&mut document, pointer, json!(scales));
    let told = format!("{at}: 2 and 3 instances (accepted: as many of each attribute)");
    assert_eq!(read_both(&document, &bin).unwrap_err().to_string(), told);
}

#[test]
fn materials_lights_and_cameras_are_checked() {
    let material =
        |raw: Value| [("/meshes/0/primitives/0/material", json!(0)), ("/materials", json!([raw]))];
    check(
        &material(json!({ "alphaMode": "CUTOUT" })),
        "materials[0].alphaMode: \"CUTOUT\" (accepted: \"OPAQUE\", \"MASK\" or \"BLEND\")",
    );
    check(
        &material(json!({ "emissiveFactor": [1e39, 0, 0] })),
        "materials[0].emissiveFactor: a number out of range (accepted: finite numbers)",
    );
    check(
        &material(json!({ "pbrMetallicRoughness": { "baseColorFactor": [1, 1, 1] } })),
        "materials[0].pbrMetallicRoughness.baseColorFactor: invalid length 3 (accepted: an array \
         of length 4)",
    );
    check(
        &[("/meshes/0/primitives/0/material", json!(4))],
        "meshes[0].primitives[0].material: materials[4] is not there (accepted: none, for there \
         are no materials)",
    );
    let light = |raw: Value| {
        let on = json!({ "KHR_lights_punctual": { "light": 0 } });
        let lights = json!({ "KHR_lights_punctual": { "lights": [raw] } });
        [("/nodes/0/extensions", on), ("/extensions", lights)]
    };
    let at = "extensions.KHR_lights_punctual.lights[0]";
    let accepted = "(accepted: \"directional\", \"point\" or \"spot\")";
    check(&light(json!({ "type": "area" })), &format!("{at}.type: \"area\" {accepted}"));
    let told = format!("{at}: a range of Some(-1.0) m; it must be above 0");
    check(&light(json!({ "type": "point", "range": -1 })), &told);
    let camera = |raw: Value| [("/nodes/0/camera", json!(0)), ("/cameras", json!([raw]))];
    check(
        &camera(json!({ "type": "fisheye" })),
        "cameras[0].type: \"fisheye\" (accepted: \"perspective\" or \"orthographic\")",
    );
    check(
        &camera(json!({ "type": "perspective" })),
        "cameras[0]: no perspective values (accepted: those of its type)",
    );
    check(
        &camera(json!({ "type": "perspective", "perspective": { "yfov": 4, "znear": 1 } })),
        "cameras[0]: a vertical angle of 4; between 0 and pi",
    );
}
