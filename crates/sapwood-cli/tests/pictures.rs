//! Pictures: that they are written with what was asked for, and what is said where they cannot be.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
#[cfg(unix)]
use std::{
    io::{BufRead as _, BufReader},
    process::Stdio,
};

fn sapwood(folder: &Path, line: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sapwood"))
        .args(line.split_whitespace())
        .current_dir(folder)
        .output()
        .expect("the program runs")
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("the program writes UTF-8")
}

/// The program succeeds and says nothing on standard error; gives its output.
fn says(folder: &Path, line: &str) -> String {
    let output = sapwood(folder, line);
    assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""), "{line}");
    text(&output.stdout).to_owned()
}

/// The program fails with this code in one line, and leaves every file as it was; gives the line.
fn fails(folder: &Path, line: &str, code: i32) -> String {
    let before = files(folder);
    let output = sapwood(folder, line);
    assert_eq!((output.status.code(), text(&output.stdout)), (Some(code), ""), "{line}");
    assert_eq!(files(folder), before, "{line}");
    let said = text(&output.stderr).to_owned();
    assert_eq!(said.lines().count(), 1, "{line}: {said}");
    said
}

fn files(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("the folder is there");
    let name = |entry: std::io::Result<fs::DirEntry>| {
        entry.expect("the folder can be read").file_name().to_string_lossy().into_owned()
    };
    let mut names: Vec<_> = entries.map(name).collect();
    names.sort();
    names
}

fn json(text: &str) -> serde_json::Value {
    assert_eq!(text.lines().count(), 1, "{text}");
    serde_json::from_str(text).expect("the program writes JSON")
}

fn image(folder: &Path, name: &str) -> sapwood::geom::Image {
    sapwood::io::read_image(folder.join(name)).expect("the program writes PNG files")
}

/// How many pixels differ much.
fn n_different(a: &sapwood::geom::Image, b: &sapwood::geom::Image) -> usize {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let differs = |(a, b): &(&[u8; 4], &[u8; 4])| (0..4).any(|i| a[i].abs_diff(b[i]) > 24);
    a.pixels.iter().zip(&b.pixels).filter(differs).count()
}

/// A trunk with its branches: quickly grown and drawn.
const SMALL: &str = "grow quaking_aspen --levels 2 --samples 1 --size 48x64";

#[test]
fn a_picture_is_written_beside_other_files() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let table = says(at, &format!("{SMALL} -o t.png -o t.svg -o u.PNG"));
    assert_eq!(files(at), ["t.png", "t.svg", "u.PNG"]);
    assert_eq!(fs::read(at.join("t.png")).unwrap(), fs::read(at.join("u.PNG")).unwrap());
    for row in ["rays ", "pictures ", "t.png ", "u.PNG "] {
        assert_eq!(table.lines().filter(|line| line.starts_with(row)).count(), 1, "{table}");
    }
    let told = json(&says(at, &format!("{SMALL} -o t.png --json")));
    let picture = &told["picture"];
    assert_eq!((&picture["width"], &picture["height"]), (&48.into(), &64.into()));
    assert_eq!((&picture["samples"], &picture["count"]), (&1.into(), &1.into()));
    assert_eq!(picture["rays"]["primary"], 48 * 64);
    assert!(picture["rays"]["shadow"].as_u64().unwrap() > 0);
    assert!(picture["seconds"].as_f64().unwrap() > 0.0);
    assert_eq!(told["outputs"][0]["bytes"], fs::metadata(at.join("t.png")).unwrap().len());
    let told = json(&says(at, "grow quaking_aspen --levels 1 --json"));
    assert_eq!(told["picture"], serde_json::Value::Null);
}

#[test]
fn pictures_are_the_same_on_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let drawn = |threads: &str, line: &str, name: &str| {
        let output = Command::new(env!("CARGO_BIN_EXE_sapwood"))
            .args(line.split_whitespace())
            .args(["-o", name])
            .env("RAYON_NUM_THREADS", threads)
            .current_dir(at)
            .output()
            .expect("the program runs");
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        fs::read(at.join(name)).unwrap()
    };
    says(at, "grow palm --detail draft -o palm.glb");
    for line in [
        "grow quaking_aspen --samples 2 --size 80x100 --ground",
        "picture palm.glb --samples 2 --size 80x100",
        "family wheat -n 3 --samples 1 --size 40x40",
    ] {
        assert_eq!(drawn("1", line, "one.png"), drawn("4", line, "four.png"), "{line}");
    }
}

#[test]
fn each_option_changes_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    says(at, &format!("{SMALL} -o plain.png"));
    let plain = image(at, "plain.png");
    for (options, least) in [
        ("--style wire", 20),
        ("--style skeleton", 20),
        ("--from 1,0.2,0", 20),
        ("--eye 3,2,4 --target 0,6,0", 100),
        ("--eye 3,2,4", 100),
        ("--fov 60", 20),
        ("--orthographic", 20),
        ("--eye 0,5,30 --orthographic=30", 20),
        ("--sun 1,0.2,-0.3", 10),
        ("--ground", 100),
        ("--transparent", 1000),
        ("--seed 9", 20),
    ] {
        says(at, &format!("{SMALL} {options} -o other.png"));
        let n = n_different(&plain, &image(at, "other.png"));
        assert!(n >= least, "{options}: {n} pixels");
    }
    for options in ["--no-ground", "--ground --no-ground", "--style solid", "--fov 30"] {
        says(at, &format!("{SMALL} {options} -o other.png"));
        assert_eq!(image(at, "other.png"), plain, "{options}");
    }
    // More samples: the same picture with less grain.
    says(at, "grow quaking_aspen --levels 2 --samples 3 --size 48x64 -o other.png");
    assert_ne!(image(at, "other.png"), plain);
}

#[test]
fn a_style_concerns_the_picture_alone() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    says(at, &format!("{SMALL} --style wire -o wire.png -o wire.glb"));
    says(at, "grow quaking_aspen --levels 2 -o solid.glb");
    assert_eq!(fs::read(at.join("wire.glb")).unwrap(), fs::read(at.join("solid.glb")).unwrap());
    // A skeleton can be looked at as well.
    says(at, &format!("{SMALL} --detail skeleton -o lines.png"));
    says(at, &format!("{SMALL} --style skeleton -o style.png"));
    let (lines, style) = (image(at, "lines.png"), image(at, "style.png"));
    assert!(lines.pixels.iter().filter(|pixel| pixel[0] < 100).count() > 20);
    assert!(n_different(&lines, &style) < 48 * 64 / 10);
}

#[test]
fn transparent_pictures_cover_what_is_there() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    says(at, &format!("{SMALL} --transparent -o t.png"));
    let pixels = image(at, "t.png").pixels;
    let n = |coverage: u8| pixels.iter().filter(|pixel| pixel[3] == coverage).count();
    assert!(n(0) > 1000 && n(255) > 30, "{} {}", n(0), n(255));
}

/// The leftmost and rightmost columns, and the upper and lower rows, that anything covers.
fn covered(image: &sapwood::geom::Image) -> [u32; 4] {
    let mut edges = [u32::MAX, 0, u32::MAX, 0];
    for (i, _) in image.pixels.iter().enumerate().filter(|(_, pixel)| pixel[3] > 0) {
        let (x, y) = (i as u32 % image.width, i as u32 / image.width);
        let [left, right, top, bottom] = edges;
        edges = [left.min(x), right.max(x), top.min(y), bottom.max(y)];
    }
    edges
}

#[test]
fn a_turntable_holds_everything_still() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let small = "grow palm --samples 2 --size 90x100 --transparent";
    let table = says(at, &format!("{small} --turntable 6 -o turn.png"));
    let names: Vec<String> = (0..6).map(|i| format!("turn-00{i}.png")).collect();
    assert_eq!(files(at), names, "{table}");
    let mut foot = Vec::new();
    for name in &names {
        let image = image(at, name);
        let [left, right, top, bottom] = covered(&image);
        assert!(left > 0 && right < 89 && top > 0 && bottom < 99, "{name}");
        foot.push((top, bottom));
    }
    // The tree stands at one height all around.
    let spread = |f: &dyn Fn(&(u32, u32)) -> u32| {
        foot.iter().map(f).max().unwrap() - foot.iter().map(f).min().unwrap()
    };
    assert!(spread(&|edges| edges.0) <= 6 && spread(&|edges| edges.1) <= 6, "{foot:?}");
    let pictures: Vec<_> = names.iter().map(|name| image(at, name)).collect();
    for (i, a) in pictures.iter().enumerate() {
        assert!(pictures[..i].iter().all(|b| n_different(a, b) > 50));
    }
    // Half a turn shows the other side of something placed by hand.
    says(at, &format!("{small} --turntable 2 --eye 9,4,0 --target 0,3,0 -o by-hand.png"));
    says(at, &format!("{small} --eye -9,4,0 --target 0,3,0 -o opposite.png"));
    assert!(n_different(&image(at, "by-hand-001.png"), &image(at, "opposite.png")) < 30);
}

#[test]
fn where_one_picture_cannot_be_written_none_is() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::create_dir(at.join("a-002.png")).unwrap();
    fs::write(at.join("a-000.png"), "old").unwrap();
    let said = fails(at, &format!("{SMALL} --turntable 3 -o a.png -o b.glb"), 3);
    assert!(said.contains("a-002.png: cannot be written"), "{said}");
    assert_eq!(fs::read(at.join("a-000.png")).unwrap(), b"old");
    let said = fails(at, &format!("{SMALL} -o no/a.png -o b.glb"), 3);
    assert!(said.contains("no/a.png: cannot be written: there is no folder"), "{said}");
    let said = fails(at, &format!("{SMALL} -o a.png -o ./a.png"), 2);
    assert!(said.contains("would both be written to"), "{said}");
}

#[test]
fn wrong_options_are_told_with_what_is_accepted() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    // None of these reads the file.
    let check = |options: &str, expected: &str| {
        for command in ["grow palm", "picture no.glb", "family palm -n 2"] {
            let said = fails(at, &format!("{command} {options} -o t.png"), 2);
            assert!(said.contains(expected), "{command} {options}: {said}");
        }
    };
    for wrong in ["0x5", "5x0", "10", "-1x5", "axb", "99999x99999"] {
        check(&format!("--size {wrong}"), "--size <WxH>': accepted: 1x1 and more");
    }
    for wrong in ["0", "-3", "4097", "nan", "1.5"] {
        check(&format!("--samples {wrong}"), "accepted: whole numbers from 1 to 4096");
    }
    for wrong in ["0", "nan", "-20", "180", "inf"] {
        check(&format!("--fov {wrong}"), "accepted: 1 to 170 degrees");
    }
    for wrong in ["nan,0,0", "1,2", "inf,0,0", "x"] {
        check(&format!("--eye {wrong}"), "accepted: three finite numbers");
        check(&format!("--eye 1,2,3 --target {wrong}"), "accepted: three finite numbers");
        check(&format!("--from {wrong}"), "accepted: three numbers, not all 0");
        check(&format!("--sun {wrong}"), "accepted: three numbers, not all 0");
    }
    check("--from 0,0,0", "accepted: three numbers, not all 0");
    check("--sun 0,0,0", "accepted: three numbers, not all 0");
    check("--style outline", "possible values: solid, wire, skeleton");
    check("--target 1,2,3", "required arguments were not provided: --eye");
    check("--eye 1,2,3 --target 1,2,3", "the eye is there (accepted: any other place)");
    check("--eye 1,2,3 --from 1,0,0", "cannot be used with");
    check("--orthographic --fov 40", "cannot be used with");
    check("--orthographic=0", "accepted: 0.000001 to 1000000000 metres");
    check("--orthographic=5", "the height follows from what is to be seen");
    check("--orthographic --eye 1,2,3", "the height of the picture is needed");
    check("--transparent --ground", "cannot be used with");
    for wrong in ["0", "-1", "1001", "nan"] {
        for command in ["grow palm", "picture no.glb"] {
            let said = fails(at, &format!("{command} --turntable {wrong} -o t.png"), 2);
            assert!(said.contains("accepted: whole numbers from 1 to 1000"), "{said}");
        }
    }
    // Wishes in vain.
    for option in ["--size 9x9", "--style wire", "--sun 1,1,1", "--no-ground", "--turntable 3"] {
        let said = fails(at, &format!("grow palm {option} -o t.glb"), 2);
        let name = option.split(' ').next().unwrap();
        assert!(said.contains(&format!("{name}: there is no picture")), "{said}");
    }
}

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

/// Like [`fails`], with 2 s of processor time and, where the system counts it, 384 MiB of addresses:
/// 256 MiB to work with and the rest for the program's own code, its two threads and what the
/// allocator sets aside for each. That is more than is ever touched, and less than a bomb takes.
fn fails_in_little(folder: &Path, line: &str, code: i32) -> String {
    if !cfg!(target_os = "linux") {
        return fails(folder, line, code);
    }
    let before = files(folder);
    let limited = "ulimit -t 2 && ulimit -v 393216 && exec \"$@\"";
    let output = Command::new("sh")
        .args(["-c", limited, "sh", env!("CARGO_BIN_EXE_sapwood")])
        .args(line.split_whitespace())
        .env("RAYON_NUM_THREADS", "2")
        .current_dir(folder)
        .output()
        .expect("there is a shell");
    let said = text(&output.stderr).to_owned();
    assert_eq!((output.status.code(), text(&output.stdout)), (Some(code), ""), "{line}: {said}");
    assert_eq!(files(folder), before, "{line}");
    assert_eq!(said.lines().count(), 1, "{line}: {said}");
    said
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

#[test]
fn a_family_is_a_sheet_of_individuals() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let small = "--levels 2 --samples 1 --size 100x80";
    let line = format!("family quaking_aspen {small} -n 3 --seed 5 -o sheet.png --json");
    let told = json(&says(at, &line));
    assert_eq!(files(at), ["sheet.png"]);
    assert_eq!(told["seeds"], serde_json::json!([5, 6, 7]));
    assert_eq!((&told["picture"]["count"], &told["picture"]["width"]), (&3.into(), &100.into()));
    let sheet = image(at, "sheet.png");
    assert_eq!(told["width"].as_u64().unwrap(), u64::from(sheet.width));
    assert!(sheet.width > 300 || sheet.height > 240, "{} {}", sheet.width, sheet.height);
    // Other individuals, other pictures.
    says(at, &format!("family quaking_aspen {small} -n 3 --seed 6 -o other.png"));
    assert!(n_different(&sheet, &image(at, "other.png")) > 100);
    says(
        at,
        &format!("family quaking_aspen {small} -n 1 --transparent --style skeleton -o one.png"),
    );
    assert_eq!(image(at, "one.png").pixels[0], [0; 4]);

    for wrong in ["0", "-1", "1001", "many"] {
        let said = fails(at, &format!("family palm -n {wrong} -o t.png"), 2);
        assert!(said.contains("accepted: whole numbers from 1 to 1000"), "{said}");
    }
    let said = fails(at, "family palm -n 1000 --size 1024x1024 -o t.png", 2);
    assert!(said.contains("--count 1000: a sheet of pictures of 1024x1024 would be"), "{said}");
    let said = fails(at, &format!("family palm -n 2 --seed {} -o t.png", u64::MAX), 2);
    assert!(said.contains("not as many seeds"), "{said}");
    let said = fails(at, "family oak -o t.png", 1);
    assert!(said.contains("ca_black_oak"), "{said}");
    let said = fails(at, "family palm -o no/t.png", 3);
    assert!(said.contains("there is no folder"), "{said}");
    let said = fails(at, "family palm --max-triangles 10 -o t.png", 4);
    assert!(said.contains("10 triangles, the limit"), "{said}");
}

#[cfg(unix)]
#[test]
fn an_interrupt_leaves_no_picture() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    says(at, "grow palm -o palm.glb");
    for command in [
        "grow quaking_aspen -o old.png -o new.svg --turntable 3 -o other.png",
        "picture palm.glb -o old.png",
        "family quaking_aspen -n 20 --size 600x600 -o old.png",
    ] {
        fs::write(at.join("old.png"), "old").unwrap();
        let before = files(at);
        // More rays than come back in any time that somebody waits for, and told when they start.
        let mut child = Command::new(env!("CARGO_BIN_EXE_sapwood"))
            .args(format!("-v {command} --samples 4096").split_whitespace())
            .current_dir(at)
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program runs");
        let mut lines = BufReader::new(child.stderr.take().expect("it is piped")).lines();
        let mut next = || lines.next().map(|line| line.expect("the program writes UTF-8"));
        while !next().expect("it is told that rays start").contains("drawing") {}
        let kill = format!("kill -INT {}", child.id());
        assert!(Command::new("sh").args(["-c", &kill]).status().unwrap().success());
        let rest: Vec<String> = std::iter::from_fn(next).collect();
        assert_eq!(child.wait().unwrap().code(), Some(130), "{command}: {rest:?}");
        let last = "sapwood: interrupted; nothing was written";
        assert_eq!(rest.last().map(String::as_str), Some(last), "{command}: {rest:?}");
        assert_eq!(files(at), before, "{command}");
        assert_eq!(fs::read(at.join("old.png")).unwrap(), b"old");
    }
}

#[test]
fn help_tells_of_pictures() {
    let folder = tempfile::tempdir().unwrap();
    for command in ["grow", "picture", "family"] {
        let help = says(folder.path(), &format!("{command} --help"));
        assert_eq!(help.matches("\nPictures:\n").count(), 1, "{help}");
        for option in ["--size", "--samples", "--style", "--eye", "--fov", "--sun", "--ground"] {
            assert!(help.contains(option), "{command}: {option} is missing in {help}");
        }
        assert_eq!(help.contains("--turntable"), command != "family");
    }
}
