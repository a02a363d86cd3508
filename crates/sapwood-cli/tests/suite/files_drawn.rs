//! Pictures of files: that they look as what was written, and how broken and hostile ones fail.

use std::fs;
use std::path::Path;

use serde_json::{Value, json as value};

use crate::pictures::{SMALL, image, n_different};
use crate::program::{fails, fails_in_little, json, says};

#[test]
fn files_are_drawn_as_they_were_grown() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    says(at, &format!("{SMALL} -o t.png -o t.glb -o t.gltf"));
    let grown = image(at, "t.png");
    for file in ["t.glb", "t.gltf"] {
        let options = "--samples 1 --size 48x64";
        let told = json(&says(at, &format!("picture {file} {options} -o read.png --json")));
        let n = n_different(&grown, &image(at, "read.png"));
        assert!(n < 48 * 64 / 50, "{file}: {n} pixels");
        assert_eq!((&told["file"], &told["warnings"]), (&file.into(), &serde_json::json!([])));
        assert!(told["triangles"].as_u64().unwrap() > 1000);
        assert_eq!(told["outputs"][0]["path"], "read.png");
        assert_eq!(told["picture"]["rays"]["primary"], 48 * 64);
    }
    let said = says(at, "picture t.glb --turntable 2 --size 9x9 --samples 1 -o a.png");
    assert!(said.contains("2 pictures of 9x9 with 1 samples"), "{said}");
    assert!(at.join("a-001.png").exists());
}

/// A model with one texture, `image`, and its buffer, `model.bin`.
fn write_textured(folder: &Path, name: &str, image: &str) {
    let positions = [0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let bytes: Vec<u8> = positions.iter().flat_map(|x| x.to_le_bytes()).collect();
    fs::write(folder.join("model.bin"), bytes).expect("the folder is there");
    let document = serde_json::json!({
        "asset": { "version": "2.0" },
        "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{
            "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "material": 0,
        }] }],
        "materials": [{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }],
        "textures": [{ "source": 0 }], "images": [{ "uri": image }],
        "buffers": [{ "uri": "model.bin", "byteLength": 36 }],
        "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                "min": [0, 0, 0], "max": [1, 1, 0] },
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC2" },
        ],
    });
    fs::write(folder.join(name), document.to_string()).expect("the folder is there");
}

#[test]
fn nothing_that_a_model_reads_is_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    says(at, &format!("{SMALL} -o bark.png"));
    write_textured(at, "model.gltf", "bark.png");
    fs::copy(at.join("model.gltf"), at.join("model.png")).unwrap();
    let bark = fs::read(at.join("bark.png")).unwrap();
    let small = "--size 9x9 --samples 1";
    let said = fails(at, &format!("picture model.gltf {small} -o bark.png"), 2);
    assert!(said.contains("bark.png is read for the file that is drawn; name another"), "{said}");
    let said = fails(at, &format!("picture model.png {small} -o ./model.png"), 2);
    assert!(said.contains("model.png is the file that is drawn; name another one"), "{said}");
    fs::rename(at.join("bark.png"), at.join("bark-001.png")).unwrap();
    write_textured(at, "model.gltf", "bark-001.png");
    let said = fails(at, &format!("picture model.gltf {small} --turntable 3 -o bark.png"), 2);
    assert!(said.contains("bark-001.png is read for the file that is drawn"), "{said}");
    assert_eq!(fs::read(at.join("bark-001.png")).unwrap(), bark);
    says(at, &format!("picture model.gltf {small} -o bark.png"));
}

/// Writes the document of a model whose only buffer is `model.bin`.
fn write_model(folder: &Path, name: &str, mut document: Value, bin: &[u8]) {
    fs::write(folder.join("model.bin"), bin).expect("the folder is there");
    document["asset"] = value!({ "version": "2.0" });
    document["scene"] = value!(0);
    document["buffers"] = value!([{ "uri": "model.bin", "byteLength": bin.len() }]);
    fs::write(folder.join(name), document.to_string()).expect("the folder is there");
}

#[test]
fn small_files_that_unfold_to_a_lot_fail_in_little() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let bin = vec![0; 120_000];
    let views = value!([{ "buffer": 0, "byteLength": bin.len() }]);
    let one = value!([{ "nodes": [0] }]);
    let zeros = value!({ "componentType": 5126, "count": 1 << 20, "type": "VEC3" });
    let primitives = |n: usize| -> Vec<Value> {
        (0..n).map(|i| value!({ "attributes": { "POSITION": i } })).collect()
    };
    let over_one_view: Vec<Value> = (0..1000)
        .map(|i| {
            value!({ "bufferView": 0, "byteOffset": 4 * i, "componentType": 5126, "count": 9600,
                "type": "VEC3" })
        })
        .collect();
    let meshes = |n: usize| value!([{ "primitives": primitives(n) }]);
    let overlapping = value!({ "scenes": one, "nodes": [{ "mesh": 0 }], "bufferViews": views,
        "accessors": over_one_view, "meshes": meshes(1000) });
    write_model(at, "overlapping.gltf", overlapping, &bin);
    let all_zero = value!({ "scenes": one, "nodes": [{ "mesh": 0 }], "meshes": meshes(1000),
        "accessors": vec![zeros.clone(); 1000] });
    write_model(at, "zeros.gltf", all_zero, &bin);
    let small = value!({ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" });
    let instancing = |i: usize| {
        let attributes = value!({ "attributes": { "TRANSLATION": i } });
        value!({ "mesh": 0, "extensions": { "EXT_mesh_gpu_instancing": attributes } })
    };
    let mut accessors = vec![zeros; 8];
    accessors[0] = small.clone();
    let instances = value!({ "scenes": [{ "nodes": [0, 1, 2] }], "bufferViews": views,
        "nodes": [instancing(1), instancing(2), instancing(3)], "meshes": meshes(1),
        "accessors": accessors });
    write_model(at, "instances.gltf", instances.clone(), &bin);
    let mut repeated = instances;
    repeated["nodes"] = value!([instancing(1)]);
    repeated["scenes"] = one;
    repeated["meshes"] = value!([{ "primitives": vec![primitives(1)[0].clone(); 1000] }]);
    write_model(at, "repeated.gltf", repeated, &bin);
    let shown = value!({ "scenes": [{ "nodes": (0..1000).collect::<Vec<_>>() }],
        "bufferViews": views, "nodes": vec![value!({ "mesh": 0 }); 1000], "accessors": [small],
        "meshes": [{ "primitives": vec![primitives(1)[0].clone(); 1000] }] });
    write_model(at, "shown.gltf", shown, &bin);
    for (file, expected) in [
        ("overlapping.gltf", "]: meshes and instances take 7"),
        ("zeros.gltf", "meshes[0].primitives[0]: meshes and instances take 7"),
        ("instances.gltf", "nodes[1].extensions.EXT_mesh_gpu_instancing.attributes: meshes and"),
        ("repeated.gltf", "1048576000 instances in the nodes of the scene; at most 2097152"),
        ("shown.gltf", "1000000 parts of meshes at all nodes of the scene; at most 262144"),
    ] {
        let said = fails_in_little(at, &format!("picture {file} --size 64x64 -o t.png"), 1);
        assert!(said.contains(expected), "{file}: {said}");
    }
}

#[test]
fn files_are_looked_at_through_their_cameras() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let corners = [-1.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.0];
    let bin: Vec<u8> = corners.iter().flat_map(|x| x.to_le_bytes()).collect();
    let document = value!({
        "scenes": [{ "nodes": [0, 1, 3] }],
        "nodes": [
            { "mesh": 0 },
            { "name": "pole", "translation": [0, 1, 0], "children": [2] },
            { "camera": 0, "translation": [0, 0, 5] },
            { "name": "above", "camera": 1, "translation": [0, 9, 0],
                "rotation": [-0.707_106_77, 0, 0, 0.707_106_77] },
        ],
        "cameras": [
            { "name": "front", "type": "perspective", "perspective": { "yfov": 0.6, "znear": 0.1 } },
            { "type": "orthographic",
                "orthographic": { "xmag": 2, "ymag": 2, "znear": 0.1, "zfar": 100 } },
        ],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }],
        "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
    });
    write_model(at, "model.gltf", document, &bin);
    let small = "--size 40x40 --samples 4 --transparent -o";
    says(at, &format!("picture model.gltf --camera front {small} front.png"));
    let degrees = 0.6_f32.to_degrees();
    let by_hand = format!("--eye 0,1,5 --target 0,1,0 --fov {degrees}");
    says(at, &format!("picture model.gltf {by_hand} {small} by-hand.png"));
    assert_eq!(n_different(&image(at, "front.png"), &image(at, "by-hand.png")), 0);
    assert!(image(at, "front.png").pixels.iter().any(|pixel| pixel[3] == 255));
    says(at, &format!("picture model.gltf --camera 0 {small} number.png"));
    assert_eq!(image(at, "number.png"), image(at, "front.png"));
    // From straight above, the triangle is a line at most.
    says(at, &format!("picture model.gltf --camera above {small} above.png"));
    let n_seen = image(at, "above.png").pixels.iter().filter(|pixel| pixel[3] > 0).count();
    assert!(n_seen <= 40, "{n_seen}");
    says(at, &format!("picture model.gltf --camera 0 --turntable 2 {small} turn.png"));
    assert_eq!(image(at, "turn-000.png"), image(at, "front.png"));

    let said = fails(at, "picture model.gltf --camera back -o t.png", 2);
    let told = "--camera back: the file has no such camera (accepted: 0 \"front\", 1 \"above\")";
    assert!(said.contains(told), "{said}");
    for other in ["--eye 1,2,3", "--from 1,0,0", "--fov 40", "--orthographic"] {
        let said = fails(at, &format!("picture model.gltf --camera 0 {other} -o t.png"), 2);
        assert!(said.contains("cannot be used with"), "{said}");
    }
    says(at, "grow palm --detail draft -o palm.glb");
    let said = fails(at, "picture palm.glb --camera 0 -o t.png", 2);
    assert!(said.contains("--camera 0: there are no cameras in the file"), "{said}");
}

#[test]
fn broken_files_are_one_line_each() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    says(at, "grow palm --detail draft -o good.glb");
    let good = fs::read(at.join("good.glb")).unwrap();
    fs::write(at.join("cut.glb"), &good[..good.len() / 2]).unwrap();
    fs::write(at.join("zero.glb"), []).unwrap();
    fs::write(at.join("noise.gltf"), "{]").unwrap();
    fs::write(at.join("empty.gltf"), r#"{"asset":{"version":"2.0"}}"#).unwrap();
    let outside = r#"{"asset":{"version":"2.0"},"buffers":[{"uri":"../x.bin","byteLength":4}],
        "bufferViews":[{"buffer":0,"byteLength":4}],"images":[{"uri":"../../etc/passwd"}],
        "textures":[{"source":0}],"materials":[{"pbrMetallicRoughness":{"baseColorTexture":
        {"index":0}}}],"accessors":[{"bufferView":0,"componentType":5126,"count":1000000000,
        "type":"VEC3","min":[0,0,0],"max":[1,1,1]}],"meshes":[{"primitives":[{"attributes":
        {"POSITION":0},"material":0}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0}"#;
    fs::write(at.join("outside.gltf"), outside).unwrap();
    let ring = r#"{"asset":{"version":"2.0"},"nodes":[{"children":[1]},{"children":[0]}],
        "scenes":[{"nodes":[0]}],"scene":0}"#;
    fs::write(at.join("ring.gltf"), ring).unwrap();
    // The header of a grey PNG of 16000 x 16000 pixels, with as many bytes behind it as such a file
    // needs, and with too few.
    let mut bomb = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\x3e\x80\0\0\x3e\x80\x08\0\0\0\0".to_vec();
    bomb.extend([0x64, 0x15, 0x80, 0x02]);
    fs::write(at.join("thin.png"), &bomb).unwrap();
    bomb.resize(300_000, 0);
    fs::write(at.join("bomb.png"), &bomb).unwrap();
    write_textured(at, "thin.gltf", "thin.png");
    write_textured(at, "bomb.gltf", "bomb.png");
    for (file, expected) in [
        ("thin.gltf", "images[0]: not valid PNG: 33 bytes cannot hold 16000 x 16000 pixels"),
        ("bomb.gltf", "256000000 pixels in all images of the scene; at most 33554432 are read"),
        ("missing.glb", "missing.glb"),
        ("cut.glb", "cut.glb"),
        ("zero.glb", "zero.glb"),
        ("noise.gltf", "noise.gltf"),
        ("outside.gltf", "outside.gltf"),
        ("ring.gltf", "ring.gltf"),
        (".", "."),
        ("empty.gltf", "there is nothing to see"),
    ] {
        let said = fails_in_little(at, &format!("picture {file} --size 64x64 -o t.png"), 1);
        assert!(said.contains(expected), "{file}: {said}");
    }
    let said = fails(at, "picture good.glb -o no/t.png", 3);
    assert!(said.contains("no/t.png: cannot be written: there is no folder"), "{said}");
    let said = fails(at, "picture good.glb", 2);
    assert!(said.contains("--output <FILE>"), "{said}");
    let said = fails(at, "picture good.glb -o t.jpg", 2);
    assert!(said.contains("accepted: names that end in .png"), "{said}");
    fs::copy(at.join("good.glb"), at.join("good.png")).unwrap();
    let said = fails(at, "picture good.png -o good.png", 2);
    assert!(said.contains("good.png is the file that is drawn"), "{said}");
    assert_eq!(fs::read(at.join("good.png")).unwrap(), good);
}
