//! Seeds: drawn, told, written to files, and used again.

use crate::program::{fails, json, says};

const SMALL: &str = "grow wheat --levels 1";

#[test]
fn a_seed_that_nobody_chose_is_told_written_and_reusable() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let told = says(at, &format!("{SMALL} --seed random -o a.glb -o a.gltf -o a.obj --json"));
    let seed = json(&told)["seed"].as_u64().expect("a seed is a number");
    let read = |name: &str| std::fs::read(at.join(name)).unwrap();
    let obj = String::from_utf8(read("a.obj")).unwrap();
    let lines: Vec<&str> = obj.lines().skip(1).take(2).collect();
    assert_eq!(lines, ["# species: Wheat", &format!("# seed: {seed}")]);
    let gltf: serde_json::Value = serde_json::from_slice(&read("a.gltf")).unwrap();
    assert_eq!(gltf["asset"]["extras"]["seed"], seed.to_string());
    let note = format!("\"extras\":{{\"species\":\"Wheat\",\"seed\":\"{seed}\"}}");
    let glb = read("a.glb");
    assert!(glb.windows(note.len()).any(|window| window == note.as_bytes()), "{note}");

    let told = says(at, &format!("{SMALL} --seed {seed} -o b.glb"));
    assert!(told.starts_with(&format!("Wheat, seed {seed}\n")), "{told}");
    assert!(read("b.glb") == glb);
    let another = json(&says(at, &format!("{SMALL} --seed random --json")));
    let third = json(&says(at, &format!("{SMALL} --seed random --json")));
    assert!(another["seed"] != seed || third["seed"] != seed);
    fails(at, &format!("{SMALL} --seed any"), 2);
}

#[test]
fn files_of_a_tree_at_a_place_say_where() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    says(at, &format!("{SMALL} --at 1,0,-2.5 -o a.obj"));
    let obj = std::fs::read_to_string(at.join("a.obj")).unwrap();
    assert_eq!(obj.lines().nth(2), Some("# at: 1,0,-2.5"));
}
