//! `grow --wind`: animations in glTF files, a moment in others, and what is refused.

use std::fs;
use std::path::Path;

use crate::program::{fails, files, json, says};

/// The text of a glTF file.
fn gltf(folder: &Path, name: &str) -> serde_json::Value {
    let text = fs::read(folder.join(name)).expect("the file was written");
    serde_json::from_slice(&text).expect("the file is JSON")
}

#[test]
fn gltf_files_hold_a_skin_and_an_animation_of_as_many_seconds() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let line = "grow quaking_aspen --levels 2 --wind 5,2 --seconds 4 --keys 10";
    let told = json(&says(at, &format!("{line} --json -o a.gltf -o a.glb")));
    let wind = &told["wind"];
    assert_eq!((&wind["speed"], &wind["gust"]), (&5.0.into(), &2.0.into()));
    let n_joints = wind["joints"].as_u64().unwrap();
    assert!((100..=255).contains(&n_joints), "{told}");

    let file = gltf(at, "a.gltf");
    assert_eq!(file["skins"][0]["joints"].as_array().unwrap().len() as u64, n_joints + 1);
    assert_eq!(file["animations"].as_array().unwrap().len(), 1);
    let animation = &file["animations"][0];
    assert_eq!(animation["channels"].as_array().unwrap().len() as u64, n_joints);
    let times = &file["accessors"][animation["samplers"][0]["input"].as_u64().unwrap() as usize];
    assert_eq!((&times["count"], &times["max"][0]), (&41.into(), &4.0.into()));
    // At rest it is the tree without wind: the same vertices at the same places.
    says(at, "grow quaking_aspen --levels 2 -o still.gltf");
    let still = gltf(at, "still.gltf");
    assert!(still.get("skins").is_none() && still.get("animations").is_none());
    let positions = |file: &serde_json::Value| {
        let primitive = &file["meshes"][0]["primitives"][0];
        let number = primitive["attributes"]["POSITION"].as_u64().unwrap() as usize;
        file["accessors"][number].clone()
    };
    for key in ["count", "min", "max"] {
        assert_eq!(positions(&file)[key], positions(&still)[key]);
    }

    let few = json(&says(at, &format!("{line} --joints 3 --json -o few.gltf")));
    assert_eq!(few["wind"]["joints"], 3);
    assert_eq!(gltf(at, "few.gltf")["skins"][0]["joints"].as_array().unwrap().len(), 4);
    let table = says(at, "grow quaking_aspen --levels 1 --wind 5,2 -o trunk.glb");
    assert!(table.starts_with("Quaking Aspen, seed 0, in a wind of 5 m/s with gusts of 2\n"));
    assert!(table.lines().any(|line| line.starts_with("rigid joints")), "{table}");
}

#[test]
fn other_files_hold_a_moment() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let obj = |options: &str| {
        says(at, &format!("grow quaking_aspen --levels 1 {options} -o t.obj"));
        fs::read_to_string(at.join("t.obj")).unwrap()
    };
    let (still, calm) = (obj(""), obj("--wind 0,0"));
    let (now, again) = (obj("--wind 8,4"), obj("--wind 8,4 --time 0"));
    let later = obj("--wind 8,4 --time 2.5");
    assert!(still == calm && now == again);
    assert!(still != now && now != later);
    assert_eq!(still.lines().count(), later.lines().count());
    says(at, "grow quaking_aspen --levels 1 --wind 8,4 -o t.png --size 32x32 --samples 1");
    assert!(files(at).contains(&"t.png".to_owned()));
}

#[test]
fn what_cannot_sway_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let check = |options: &str, expected: &str| {
        let said = fails(folder.path(), &format!("grow wheat {options}"), 2);
        assert!(said.contains(expected), "{options}: {said}");
    };
    check("--wind 5 -o a.glb", "accepted: two numbers, each 0 to 30, as in 5,2");
    check("--wind 5,-2 -o a.glb", "accepted: two numbers, each 0 to 30");
    check("--wind 5,2 --seconds 0 -o a.glb", "accepted: 0.5 to 600");
    check("--wind 5,2 --keys 0 -o a.glb", "accepted: whole numbers from 1 to 120");
    check("--seconds 6 -o a.glb", "--wind");
    check("--wind 5,2 -o a.svg", "a.svg holds a skeleton, which does not sway");
    check("--wind 5,2 --detail skeleton -o a.obj", "accepted: --detail full, --detail draft");
    check("--wind 5,2 --weld stem -o a.glb", "cannot be used with");
    check("--wind 5,2 --range 50 -o a.glb", "cannot be used with");
    check("--wind 5,2 --seconds 3 -o a.obj", "accepted: with -o FILE.glb or FILE.gltf");
    check("--wind 5,2 --time 3 -o a.glb", "accepted: with -o FILE.obj or FILE.png");
    check("--wind 5,2 --view map -o a.svg", "--wind");
    check("--wind 5,2 --style skeleton -o a.png", "accepted: another --style");
    assert!(files(folder.path()).is_empty());
}
