//! Output files: which there are, that they come together or not at all, and what is told of them.

use std::fs;
use std::process::Command;

use crate::program::{fails, files, json, says, text};

#[test]
fn every_format_is_written_from_one_tree() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let table = says(at, "grow quaking_aspen -o t.glb -o t.gltf -o t.obj -o t.svg");
    // Images of bark and leaves lie beside the OBJ file and inside the others.
    let (images, others): (Vec<_>, Vec<_>) =
        files(at).into_iter().partition(|name| name.ends_with(".png"));
    assert_eq!(others, ["t.bin", "t.glb", "t.gltf", "t.mtl", "t.obj", "t.svg"]);
    assert!(images.contains(&"t-1.png".to_owned()), "{images:?}");
    let steps = |name: &str| table.lines().filter(|line| line.starts_with(name)).count();
    // One compilation for each rule set, however many files.
    assert_eq!((steps("compile  "), steps("compile skeleton")), (1, 1), "{table}");
    for name in ["t.glb", "t.gltf", "t.obj", "t.svg"] {
        assert_eq!(steps(name), 1, "{table}");
    }

    // Both forms of glTF hold the same bytes of geometry, and the text refers to its file.
    let (glb, bin) = (fs::read(at.join("t.glb")).unwrap(), fs::read(at.join("t.bin")).unwrap());
    assert!(glb.ends_with(&bin) && bin.len() > 1_000_000);
    let gltf: serde_json::Value =
        serde_json::from_slice(&fs::read(at.join("t.gltf")).unwrap()).unwrap();
    assert_eq!(gltf["buffers"][0]["uri"], "t.bin");
    assert_eq!(gltf["buffers"][0]["byteLength"], bin.len());

    let obj = fs::read_to_string(at.join("t.obj")).unwrap();
    assert!(obj.contains("\nmtllib t.mtl\no tree\nusemtl bark\nv "), "{}", &obj[..200]);
    let n_faces = obj.lines().filter(|line| line.starts_with("f ")).count();
    let told = json(&says(at, "grow quaking_aspen --json"));
    assert_eq!(told["triangles"], n_faces);
}

#[test]
fn a_skeleton_may_be_written_as_lines() {
    let folder = tempfile::tempdir().unwrap();
    says(folder.path(), "grow quaking_aspen --levels 2 --detail skeleton -o a.obj -o a.svg");
    assert_eq!(files(folder.path()), ["a.obj", "a.svg"]);
    let obj = fs::read_to_string(folder.path().join("a.obj")).unwrap();
    assert_eq!(obj.lines().filter(|line| line.starts_with("l ")).count(), 51);
    let said = fails(folder.path(), "grow quaking_aspen --detail skeleton -o a.gltf", 2);
    assert!(said.contains("a.gltf: glTF files hold surfaces"), "{said}");
}

#[test]
fn a_tree_may_be_told_of_as_a_map_and_as_a_text() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let said = says(at, "grow palm --view map --seed 2 -o palm.svg");
    assert!(said.starts_with("Palm, seed 2\npalm.svg: "), "{said}");
    let map = fs::read_to_string(at.join("palm.svg")).unwrap();
    assert!(map.contains(">Palm</text>") && map.contains(">N</text>"), "{map}");
    let said = says(at, "grow palm --view text --seed 2");
    assert!(said.starts_with("tree: Palm, seed 2\n"), "{said}");
    says(at, "grow palm --view text --seed 2 -o palm.txt");
    assert_eq!(fs::read_to_string(at.join("palm.txt")).unwrap(), said);
    let said = fails(at, "grow palm --view text --detail draft", 2);
    assert!(said.contains("--detail: does nothing for --view text"), "{said}");
    assert_eq!(files(at), ["palm.svg", "palm.txt"]);
}

#[test]
fn where_one_output_is_bad_none_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let check = |outputs: &str, code, expected: &str| {
        let said = fails(at, &format!("grow quaking_aspen --levels 2 {outputs}"), code);
        assert!(said.contains(expected), "{outputs}: {said}");
    };
    check(
        "-o a.glb -o a.ply",
        2,
        "accepted: names that end in .glb, .gltf, .obj, .svg, .stl, .png or .txt",
    );
    check("-o a.glb -o no/a.obj", 3, "no/a-1.png: cannot be written: there is no folder");
    check("-o a.glb -o a.obj -o ./a.glb", 2, "a.glb and ./a.glb would both be written to");
    check("-o a.gltf -o a.GLTF", 2, "a.bin; nothing was written");
    fs::create_dir(at.join("folder.svg")).unwrap();
    check("-o a.gltf -o a.obj -o folder.svg", 3, "folder.svg: cannot be written");
    // The first of a pair is written before the second turns out to be a folder.
    fs::create_dir(at.join("b.bin")).unwrap();
    check("-o a.glb -o b.gltf", 3, "b.bin: cannot be written");
    fs::create_dir(at.join("c.obj")).unwrap();
    check("-o a.glb -o c.obj", 3, "c.obj: cannot be written");
}

/// A limit on the size of files stands for a full disk; it holds for the superuser too.
#[cfg(unix)]
#[test]
fn a_full_disk_changes_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for name in ["t.svg", "t.gltf", "t.bin", "t.obj", "t.mtl"] {
        fs::write(at.join(name), "old").unwrap();
    }
    let line = format!(
        "trap '' XFSZ; ulimit -f 512; exec '{}' grow quaking_aspen -o t.svg -o t.gltf -o t.obj",
        env!("CARGO_BIN_EXE_sapwood")
    );
    let output = Command::new("sh").args(["-c", &line]).current_dir(at).output().unwrap();
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(said.starts_with("sapwood: t.bin: cannot be written: "), "{said}");
    assert_eq!(files(at), ["t.bin", "t.gltf", "t.mtl", "t.obj", "t.svg"]);
    for name in files(at) {
        assert_eq!(fs::read(at.join(name)).unwrap(), b"old");
    }
}

#[test]
fn a_draft_takes_a_third_of_the_triangles_and_keeps_the_stems() {
    let folder = tempfile::tempdir().unwrap();
    for species in ["quaking_aspen", "black_tupelo", "weeping_willow", "palm", "balsam_fir"] {
        let full = json(&says(folder.path(), &format!("grow {species} --json")));
        let draft = json(&says(folder.path(), &format!("grow {species} --json --detail draft")));
        assert_eq!((&full["stems"], &full["segments"]), (&draft["stems"], &draft["segments"]));
        let triangles = |told: &serde_json::Value| told["triangles"].as_u64().unwrap();
        let (full, draft) = (triangles(&full), triangles(&draft));
        assert!(3 * draft <= full, "{species}: {draft} of {full}");
    }
}

#[test]
fn quality_trades_number_for_size_of_leaves() {
    let folder = tempfile::tempdir().unwrap();
    let leaves = |options: &str| {
        let told = json(&says(folder.path(), &format!("grow quaking_aspen --json {options}")));
        (told["leaves"].as_f64().unwrap(), told["stems"].clone(), told["quality"].clone())
    };
    let (all, half) = (leaves("--quality 1"), leaves("--quality 0.5"));
    assert!((half.0 / all.0 - 0.5).abs() < 0.02, "{half:?} {all:?}");
    assert_eq!((half.1, half.2), (all.1, serde_json::json!(0.5)));
    for wrong in ["0", "1.5", "-1", "nan", "much"] {
        let said = fails(folder.path(), &format!("grow quaking_aspen --quality {wrong}"), 2);
        assert!(said.contains("accepted: above 0, up to 1"), "{wrong}: {said}");
    }
}

#[test]
fn billboards_are_boards_with_images_of_the_tree() {
    let folder = tempfile::tempdir().unwrap();
    let grow = |options: &str| {
        json(&says(folder.path(), &format!("grow quaking_aspen --detail draft --json {options}")))
    };
    let crossed = grow("--billboard -o crossed.glb");
    assert_eq!((&crossed["triangles"], &crossed["billboard"]), (&8.into(), &"baked".into()));
    assert_eq!(crossed["stems"][0], 1, "the tree is told of all the same");
    let picture = "-o far.png --size 40x40 --samples 2";
    let facing = grow(&format!("--billboard=even --range 600 -o facing.glb {picture}"));
    assert_eq!((&facing["triangles"], &facing["billboard"]), (&2.into(), &"even".into()));
    let image = sapwood::io::read_image(folder.path().join("far.png")).unwrap();
    assert!(image.pixels.iter().any(|[r, g, b, _]| g > b && g > r), "leaves are green");
    let glb = fs::read(folder.path().join("facing.glb")).unwrap();
    let text = String::from_utf8_lossy(&glb);
    assert!(text.contains("\"alphaMode\":\"MASK\"") && !text.contains("emissiveTexture"));
    assert_eq!(grow("")["billboard"], serde_json::Value::Null);
    for (options, expected) in [
        ("--billboard=dim -o a.glb", "possible values: baked, even"),
        ("--billboard -o a.svg", "a.svg: billboards have no lines"),
        ("--billboard --detail skeleton -o a.obj", "accepted: with --detail full or draft"),
        ("--billboard --style skeleton -o a.png", "accepted: another --style"),
        ("--billboard --weld stem -o a.glb", "cannot be used with"),
        ("--billboard --wind 5,2 -o a.glb", "cannot be used with"),
        ("--billboard --view text", "does nothing for --view text"),
    ] {
        let said = fails(folder.path(), &format!("grow quaking_aspen {options}"), 2);
        assert!(said.contains(expected), "{options}: {said}");
    }
}

#[test]
fn the_summary_may_be_json() {
    let folder = tempfile::tempdir().unwrap();
    let line = "grow quaking_aspen --seed 3 --levels 2 --json -o a.glb -o a.gltf";
    let told = json(&says(folder.path(), line));
    let keys: Vec<_> = told.as_object().unwrap().keys().map(String::as_str).collect();
    let mut expected = [
        "species",
        "seed",
        "at",
        "detail",
        "quality",
        "prune",
        "prune_ratio",
        "range",
        "billboard",
        "wind",
        "components",
        "stems",
        "segments",
        "leaves",
        "vertices",
        "triangles",
        "weld",
        "bounds",
        "seconds",
        "outputs",
        "picture",
    ];
    expected.sort();
    assert_eq!(keys, expected);
    assert_eq!((&told["species"], &told["seed"]), (&"Quaking Aspen".into(), &3.into()));
    assert_eq!(told["stems"], serde_json::json!([1, 50]));
    assert_eq!(told["components"]["tree"], 1);
    assert!(told["bounds"]["max"][1].as_f64().unwrap() > 5.0);
    assert!(told["seconds"]["compile"].as_f64().unwrap() > 0.0);
    let size = |name: &str| fs::metadata(folder.path().join(name)).unwrap().len();
    let outputs = &told["outputs"];
    assert_eq!(
        (&outputs[0]["path"], &outputs[0]["bytes"]),
        (&"a.glb".into(), &size("a.glb").into())
    );
    // An output of several files counts them all.
    assert_eq!(outputs[1]["bytes"], size("a.gltf") + size("a.bin"));

    let placed = json(&says(folder.path(), "grow quaking_aspen --at 1,2,3 --json --levels 1"));
    assert_eq!(
        (&placed["seed"], &placed["at"]),
        (&serde_json::Value::Null, &[1.0, 2.0, 3.0].into())
    );
    // Errors stay lines for people.
    let said = fails(folder.path(), "grow oak --json", 1);
    assert!(said.starts_with("sapwood: no built-in species"), "{said}");
}

#[test]
fn nothing_but_the_summary_is_said_where_nobody_watches() {
    let folder = tempfile::tempdir().unwrap();
    // Long enough for progress to be shown on a terminal.
    says(folder.path(), "grow weeping_willow --detail draft -o t.obj");
    let help = says(folder.path(), "grow --help");
    for option in ["--quality", "--json", "draft", ".gltf", ".obj"] {
        assert!(help.contains(option), "{option}: {help}");
    }
}
