//! Pictures: that they are written with what was asked for, and what is said where they cannot be.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::program::{fails, files, json, says, text};

pub(crate) fn image(folder: &Path, name: &str) -> sapwood::geom::Image {
    sapwood::io::read_image(folder.join(name)).expect("the program writes PNG files")
}

/// How many pixels differ much.
pub(crate) fn n_different(a: &sapwood::geom::Image, b: &sapwood::geom::Image) -> usize {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let differs = |(a, b): &(&[u8; 4], &[u8; 4])| (0..4).any(|i| a[i].abs_diff(b[i]) > 24);
    a.pixels.iter().zip(&b.pixels).filter(differs).count()
}

/// A trunk with its branches: quickly grown and drawn.
pub(crate) const SMALL: &str = "grow quaking_aspen --levels 2 --samples 1 --size 48x64";

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
