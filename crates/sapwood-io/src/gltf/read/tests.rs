//! Files made by hand: what is read of them, and how hostile ones are refused.

use serde_json::{Value, json};

use super::*;

mod damage;
mod features;
mod hostile;
mod images;
mod materials;
mod places;
mod round_trip;
mod trees;
mod unfolding;

/// A document with one triangle, and its buffer.
fn triangle() -> (Value, Vec<u8>) {
    let mut bin = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    bin.extend([0, 0, 1, 0, 2, 0, 0, 0]);
    let document = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 6 },
        ],
        "buffers": [{ "byteLength": 44 }],
    });
    (document, bin)
}

fn floats(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// Sets the value at a pointer into the document; its parent must be there.
fn set(document: &mut Value, pointer: &str, value: Value) {
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    match document.pointer_mut(parent).unwrap() {
        Value::Array(list) if key == "-" => list.push(value),
        Value::Array(list) => list[key.parse::<usize>().unwrap()] = value,
        parent => parent[key] = value,
    }
}

/// Adds an accessor over `bytes` of its own behind all others; returns its number.
fn add(
    document: &mut Value,
    bin: &mut Vec<u8>,
    (component, shape, count): (u32, &str, usize),
    bytes: &[u8],
) -> usize {
    let offset = bin.len();
    bin.extend(bytes);
    bin.resize(bin.len().next_multiple_of(4), 0);
    document["buffers"][0]["byteLength"] = json!(bin.len());
    let views = document["bufferViews"].as_array_mut().unwrap();
    views.push(json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }));
    let view = views.len() - 1;
    let accessors = document["accessors"].as_array_mut().unwrap();
    accessors.push(json!({
        "bufferView": view, "componentType": component, "type": shape, "count": count
    }));
    accessors.len() - 1
}

/// The bytes of a binary file.
fn glb(document: &Value, bin: &[u8]) -> Vec<u8> {
    chunks(&[(0x4e4f_534a, document.to_string().as_bytes()), (0x004e_4942, bin)])
}

fn chunks(chunks: &[(u32, &[u8])]) -> Vec<u8> {
    let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, chunk) in chunks {
        let length = chunk.len().next_multiple_of(4);
        bytes.extend((length as u32).to_le_bytes());
        bytes.extend(kind.to_le_bytes());
        bytes.extend(*chunk);
        bytes.resize(bytes.len() + length - chunk.len(), b' ');
    }
    let length = bytes.len() as u32;
    bytes[8..12].copy_from_slice(&length.to_le_bytes());
    bytes
}

fn read_both(document: &Value, bin: &[u8]) -> Result<Model, Error> {
    read(&glb(document, bin), None, &ReadLimits::default())
}

/// The triangle's file after some changes.
fn changed(changes: &[(&str, Value)]) -> Result<Model, Error> {
    let (mut document, bin) = triangle();
    for (pointer, value) in changes {
        set(&mut document, pointer, value.clone());
    }
    read_both(&document, &bin)
}

/// The only part of the first mesh.
fn only_mesh(model: &Model) -> &sapwood_geom::Mesh {
    assert_eq!(model.meshes[0].len(), 1);
    let mesh = &model.meshes[0][0].mesh;
    assert_eq!(mesh.fault(), None);
    mesh
}
