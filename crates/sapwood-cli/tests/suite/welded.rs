//! Wood welded to one solid, in every file that holds it: closed, however it is read.

use std::fs;
use std::path::Path;

use sapwood::geom::glam::Vec3;
use sapwood::geom::{Mesh, Solid};

use crate::pictures::{SMALL, image};
use crate::program::{command, fails, files, json, says};

/// Triangles given by three positions each.
fn solid(positions: Vec<Vec3>) -> Solid {
    let n = positions.len() as u32;
    Solid::of_mesh(&Mesh { positions, indices: (0..n).collect(), ..Mesh::default() })
}

fn of_glb(path: &Path) -> Solid {
    let model = sapwood::io::read_gltf(path, &Default::default()).expect("the program writes glTF");
    let mut wood = Mesh::default();
    for (node, world) in model.nodes.iter().zip(model.worlds()) {
        if let (Some(mesh), "welded") = (node.mesh, &*node.name) {
            for part in &model.meshes[mesh] {
                wood.append(&part.mesh, &world);
            }
        }
    }
    Solid::of_mesh(&wood)
}

/// The triangles of the object in an OBJ file that is the welded wood.
fn of_obj(text: &str) -> Solid {
    let (mut corners, mut triangles, mut is_wood) = (Vec::new(), Vec::new(), false);
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let numbers: Vec<f32> =
                    words.map(|word| word.parse().expect("positions are numbers")).collect();
                corners.push(Vec3::from_slice(&numbers));
            }
            Some("o") => is_wood = words.next() == Some("welded"),
            Some("f") if is_wood => {
                let index = |word: &str| {
                    let position = word.split('/').next().and_then(|number| number.parse().ok());
                    position.map(|number: usize| number - 1)
                };
                triangles.extend(words.map(|word| index(word).expect("corners are numbers")));
            }
            _ => {}
        }
    }
    solid(triangles.into_iter().map(|corner| corners[corner]).collect())
}

fn of_stl(bytes: &[u8]) -> Solid {
    let four = |at: usize| [0, 1, 2, 3].map(|i| bytes[at + i]);
    let n = u32::from_le_bytes(four(80)) as usize;
    assert_eq!(bytes.len(), 84 + 50 * n);
    let number = |at: usize| f32::from_le_bytes(four(at));
    let corner = |at: usize| Vec3::new(number(at), number(at + 4), number(at + 8));
    let firsts = (0..n).map(|triangle| 84 + 50 * triangle + 12);
    solid(firsts.flat_map(|at| [corner(at), corner(at + 12), corner(at + 24)]).collect())
}

#[test]
fn every_file_of_welded_wood_is_closed() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let line = format!("{SMALL} --weld union -o t.glb -o t.obj -o t.stl -o t.png --json");
    let told = json(&says(at, &line));
    let weld = &told["weld"];
    assert_eq!((&weld["stems"], &weld["components"]), (&51.into(), &1.into()));
    let stl = of_stl(&fs::read(at.join("t.stl")).unwrap());
    let obj = of_obj(&fs::read_to_string(at.join("t.obj")).unwrap());
    for (name, solid) in [("glb", of_glb(&at.join("t.glb"))), ("obj", obj), ("stl", stl.clone())] {
        let report = solid.check();
        assert!(report.is_sound() && report.components == 1, "{name}: {report}");
        assert_eq!(weld["triangles"], solid.triangles.len(), "{name}");
        let volume = weld["volume"].as_f64().unwrap();
        assert!((report.volume / volume - 1.0).abs() < 1e-6, "{name}: {report}");
    }
    // The file says so, too; that of the same tree without a weld does not.
    says(at, "grow quaking_aspen --levels 2 -o open.glb");
    let says_solid = |name: &str| {
        let bytes = fs::read(at.join(name)).unwrap();
        bytes.windows(17).any(|word| word == b"EXT_mesh_manifold")
    };
    assert!(says_solid("t.glb") && !says_solid("open.glb"));
    // The solid stands: z is up.
    let size = Mesh { positions: stl.positions, ..Mesh::default() }.bound().aabb.size();
    assert!(size.z > 2.0 * size.x && size.z > 2.0 * size.y, "{size}");

    // The picture shows a tree that looks like the one of which nothing was welded.
    says(at, &format!("{SMALL} -o plain.png"));
    let (welded, plain) = (image(at, "t.png"), image(at, "plain.png"));
    let n_pixels = (plain.width * plain.height) as usize;
    let n_different = crate::pictures::n_different(&welded, &plain);
    assert!(20 * n_different < n_pixels, "{n_different} of {n_pixels}");
}

#[test]
fn a_solid_needs_a_weld_and_is_told_to_have_no_leaves() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for weld in ["", "--weld stem"] {
        let said = fails(at, &format!("grow palm --levels 1 {weld} -o t.stl"), 2);
        assert!(said.contains("t.stl: STL files hold one solid"), "{said}");
    }
    let table = says(at, "grow palm --levels 1 --weld union -o t.stl");
    assert!(table.contains("t.stl: without leaves, in metres, z up"), "{table}");
    assert_eq!(files(at), ["t.stl"]);
}

#[test]
fn any_number_of_threads_welds_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (name, n_threads) in [("one", "1"), ("four", "4")] {
        let line =
            format!("grow quaking_aspen --levels 2 --weld union -o {name}.stl -o {name}.glb");
        let output = command(at, &line).env("RAYON_NUM_THREADS", n_threads).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{output:?}");
    }
    for ending in ["stl", "glb"] {
        let [one, four] =
            ["one", "four"].map(|name| fs::read(at.join(format!("{name}.{ending}"))).unwrap());
        assert!(one.len() > 10_000 && one == four, "{ending}");
    }
}

#[test]
fn what_a_cut_leaves_is_welded_too() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let cut = "grow quaking_aspen --levels 2 --cut half-space:0,1,0,5 --weld union";
    let told = json(&says(at, &format!("{cut} -o t.stl -o t.glb --json")));
    let stl = of_stl(&fs::read(at.join("t.stl")).unwrap());
    for solid in [&stl, &of_glb(&at.join("t.glb"))] {
        let report = solid.check();
        assert!(report.is_sound() && report.components == 1, "{report}");
        assert_eq!(told["weld"]["triangles"], solid.triangles.len());
    }
    let top = stl.positions.iter().map(|position| position.z).fold(0.0, f32::max);
    assert!((4.5..5.6).contains(&top), "{top}");
}

#[test]
fn welded_stems_are_cut_as_swept_ones_are() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let cut = "grow quaking_aspen --levels 2 --cut half-space:1,0,0,0.3 --json";
    let [swept, welded, separate] =
        [("", "swept"), ("--weld stem", "welded"), ("--detail segments", "separate")].map(
            |(how, name)| json(&says(at, &format!("{cut} {how} -o {name}.glb -o {name}.png"))),
        );
    let number = |told: &serde_json::Value, key: &str| told[key].as_f64().unwrap();
    let share = number(&welded, "triangles") / number(&swept, "triangles");
    assert!((share - 1.0).abs() < 1e-3, "{share}");
    assert!(number(&separate, "vertices") > number(&welded, "vertices"));
    for axis in 0..3 {
        for end in ["min", "max"] {
            let [one, other] =
                [&swept, &welded].map(|told| told["bounds"][end][axis].as_f64().unwrap());
            assert!((one - other).abs() < 1e-3, "{one} {other}");
        }
    }
    // They look alike: the cuts are closed.
    let [one, other] = ["swept.png", "welded.png"].map(|name| image(at, name));
    let n_pixels = (one.width * one.height) as usize;
    let n_different = crate::pictures::n_different(&one, &other);
    assert!(200 * n_different < n_pixels, "{n_different} of {n_pixels}");
}

#[test]
fn cuts_welds_and_details_go_together_or_say_why_not() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for cut in ["", "--cut half-space:0,1,0,3", "--prune sphere:0,3,0,3.2"] {
        for detail in ["full", "draft", "segments", "skeleton"] {
            for weld in ["", "--weld stem", "--weld union"] {
                let line = format!("grow palm --levels 1 {cut} --detail {detail} {weld} -o t.obj");
                let refusal = match (detail, weld) {
                    ("skeleton", "--weld stem" | "--weld union") => {
                        "--weld: surfaces are welded, and --detail skeleton makes none (accepted: "
                    }
                    ("segments", "--weld union") => {
                        "--weld union: the segments of --detail segments are open tubes, which \
                         enclose nothing that could be joined (accepted: "
                    }
                    _ => {
                        let told = json(&says(at, &format!("{line} --json")));
                        let top = told["bounds"]["max"][1].as_f64().unwrap();
                        let held = if cut.is_empty() { 5.0..100.0 } else { 1.0..6.6 };
                        assert!(held.contains(&top), "{line}: {top}");
                        assert_eq!(told["weld"].is_null(), weld != "--weld union", "{line}");
                        continue;
                    }
                };
                let said = fails(at, &line, 2);
                assert!(said.contains(refusal), "{line}: {said}");
            }
        }
    }
}
