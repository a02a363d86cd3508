//! Nodes: that they are trees, and how deep these may be.

use super::hostile::check;
use super::*;

#[test]
fn nodes_must_be_trees() {
    check(
        &[("/nodes/0/children", json!([0]))],
        "nodes: a ring of 1 nodes: nodes[0] > nodes[0] (accepted: trees)",
    );
    let mut ring: Vec<Value> = (0..9).map(|i| json!({ "children": [i + 2] })).collect();
    ring.push(json!({ "children": [1] }));
    let nodes: Vec<Value> = std::iter::once(json!({ "mesh": 0 })).chain(ring).collect();
    check(
        &[("/nodes", json!(nodes))],
        "nodes: a ring of 10 nodes: nodes[1] > nodes[2] > nodes[3] > nodes[4] > ... (accepted: \
         trees)",
    );
    check(
        &[("/nodes", json!([{ "children": [1, 2] }, { "children": [2] }, {}]))],
        "nodes[1].children[0]: nodes[2] is a child of nodes[0] already (accepted: nodes without \
         another parent)",
    );
    check(
        &[("/nodes/0/children", json!([5]))],
        "nodes[0].children[0]: nodes[5] is not there (accepted: 0 to 0)",
    );
    check(
        &[("/nodes", json!([{}, { "children": [0] }]))],
        "scenes[0].nodes[0]: nodes[0] is a child of nodes[1] (accepted: nodes without a parent)",
    );
    check(
        &[("/scenes/0/nodes", json!([0, 0]))],
        "scenes[0].nodes[1]: nodes[0] is there twice (accepted: each node once)",
    );
    check(
        &[("/scenes/0/nodes", json!([2]))],
        "scenes[0].nodes[0]: nodes[2] is not there (accepted: 0 to 0)",
    );
    check(&[("/scene", json!(3))], "scene: scenes[3] is not there (accepted: 0 to 0)");
    check(
        &[("/nodes/0/mesh", json!(1))],
        "nodes[0].mesh: meshes[1] is not there (accepted: 0 to 0)",
    );
    check(
        &[("/nodes/0/camera", json!(0))],
        "nodes[0].camera: cameras[0] is not there (accepted: none, for there are no cameras)",
    );
}

#[test]
fn a_chain_of_a_hundred_thousand_nodes_is_read_and_placed() {
    const N: usize = 100_000;
    let (mut document, bin) = triangle();
    let mut nodes: Vec<Value> =
        (0..N - 1).map(|i| json!({ "children": [i + 1], "translation": [0, 0.001, 0] })).collect();
    nodes.push(json!({ "mesh": 0 }));
    document["nodes"] = json!(nodes);
    let bytes = glb(&document, &bin);
    drop((document, nodes));
    let model = read(&bytes, None, &ReadLimits::default()).unwrap();
    assert_eq!(model.nodes.len(), N);
    let mut scene = sapwood_scene::Scene::new();
    let top = model.add_to(&mut scene);
    let view = scene.open_view(top, &sapwood_scene::built_in_rules()).unwrap();
    let top = scene.bounds(view).unwrap().aabb.max.y;
    assert!((top - 101.0).abs() < 0.1, "{top}");
    // A ring of as many is an error.
    let (mut document, bin) = triangle();
    document["nodes"] = (0..N).map(|i| json!({ "children": [(i + 1) % N] })).collect();
    let error = read_both(&document, &bin).unwrap_err().to_string();
    assert!(error.starts_with("nodes: a ring of 100000 nodes: nodes[0] > nodes[1] > "), "{error}");
}
