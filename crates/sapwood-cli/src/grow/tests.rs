//! What the command does with its arguments, and what it says.

use clap::Parser as _;
use sapwood::geom::glam::Vec3;
use sapwood::scene::{Action, Attribute, Transform};

use super::*;
use crate::arguments::{Arguments, Command};

fn parsed(line: &str) -> GrowArguments {
    let line = ["sapwood", "grow"].into_iter().chain(line.split_whitespace());
    match Arguments::try_parse_from(line).unwrap().command {
        Command::Grow(arguments) => arguments.with_detail(),
        other => panic!("{other:?}"),
    }
}

fn grown(line: &str) -> Result<String, String> {
    let mut out = Vec::new();
    run(&parsed(line), &Watch::default(), &mut out).map_err(|failure| format!("{failure:?}"))?;
    Ok(String::from_utf8(out).unwrap())
}

/// The table without its times.
fn sizes(line: &str) -> String {
    let table = grown(line).unwrap();
    table
        .lines()
        .take_while(|line| !line.starts_with("read"))
        .map(|line| format!("{line}\n"))
        .collect()
}

#[test]
fn seeds_and_places_tell_trees_apart() {
    assert_eq!(sizes("quaking_aspen"), sizes("quaking_aspen --seed 0"));
    assert_ne!(sizes("quaking_aspen --seed 1"), sizes("quaking_aspen --seed 2"));
    let near = sizes("quaking_aspen --at -1,2,-3.5");
    assert!(near.starts_with("Quaking Aspen at -1, 2, -3.5\n"), "{near}");
    // Another place in the same cell is the same tree.
    let counts =
        |table: &str| table[table.find("stems").unwrap()..table.find("metres").unwrap()].to_owned();
    assert_eq!(counts(&near), counts(&sizes("quaking_aspen --at -1.01,2,-3.49")));
    assert_ne!(counts(&near), counts(&sizes("quaking_aspen --at 4,2,-3.5")));
}

#[test]
fn details_share_stems() {
    let lines = sizes("quaking_aspen --detail skeleton");
    assert!(lines.starts_with("Quaking Aspen, seed 0, skeleton\n"), "{lines}");
    assert!(!lines.contains("leaves") && !lines.contains("triangles"), "{lines}");
    let full = sizes("quaking_aspen --detail full");
    for row in ["stems, level 0", "stems, level 1", "stems, level 2", "segments"] {
        let numbers = |table: &str| {
            let row = table.lines().find(|line| line.starts_with(row)).unwrap();
            row.split_whitespace().last().unwrap().to_owned()
        };
        assert_eq!(numbers(&full), numbers(&lines), "{row}");
    }
}

#[test]
fn levels_are_those_of_the_species() {
    let trunk = sizes("quaking_aspen --levels 1");
    assert!(trunk.contains("stems, level 0") && !trunk.contains("stems, level 1"), "{trunk}");
    assert_eq!(sizes("quaking_aspen --levels 3"), sizes("quaking_aspen"));
    for wrong in [0, 4, u32::MAX] {
        let error = grown(&format!("quaking_aspen --levels {wrong}")).unwrap_err();
        assert!(error.contains("code: 2"), "{error}");
        assert!(error.contains("has 3 levels of stems (accepted: 1 to 3)"), "{error}");
    }
}

#[test]
fn less_is_left_of_a_tree_that_is_further_away() {
    let triangles = |line: &str| -> u64 {
        let table = sizes(line);
        let row = table.lines().find(|line| line.starts_with("triangles")).unwrap();
        row.split_whitespace().last().unwrap().replace(',', "").parse().unwrap()
    };
    let near = triangles("quaking_aspen --range 5");
    assert_eq!(near, triangles("quaking_aspen"));
    let left = [60, 240, 1200].map(|range| triangles(&format!("quaking_aspen --range {range}")));
    assert!(near > left[0] && left[0] > left[1] && left[1] > left[2], "{near} {left:?}");
    assert!(sizes("quaking_aspen --range 60").starts_with("Quaking Aspen, seed 0, from 60 m\n"));
    for detail in ["skeleton", "segments"] {
        let line = format!("quaking_aspen --detail {detail} --range 60");
        let error = grown(&line).unwrap_err();
        assert!(error.contains("code: 2") && error.contains("do not fade"), "{error}");
    }
    let error = grown("palm --detail segments --weld union").unwrap_err();
    assert!(error.contains("code: 2") && error.contains("segments are open"), "{error}");
}

#[test]
fn views_tell_of_the_same_tree() {
    assert_eq!(sizes("wheat --view skeleton"), sizes("wheat --detail skeleton"));
    assert_eq!(sizes("wheat --view full"), sizes("wheat"));
    let text = grown("quaking_aspen --levels 2 --seed 3 --view text").unwrap();
    assert!(text.starts_with("tree: Quaking Aspen, seed 3\n  "), "{text}");
    assert!(text.contains("\n  level 1: ") && !text.contains("level 2"), "{text}");
    for (line, expected) in [
        ("palm --view map", "--view map: there is no file"),
        ("palm --view map -o a.txt", "a.txt: --view map is not written to such files"),
        ("palm --view text -o a.svg", "(accepted: names that end in .txt, or --view full)"),
        ("palm -o a.txt", "a.txt: what is drawn is no text"),
        ("palm --view text --weld stem", "--weld: does nothing for --view text"),
        ("palm --view text --json", "--json: does nothing for --view text"),
        ("palm --view text --size 4x4", "--size: does nothing for --view text"),
        ("palm --view text -o a.txt -o ./a.txt", "would both be written to"),
    ] {
        let error = grown(line).unwrap_err();
        assert!(error.contains("code: 2") && error.contains(expected), "{line}: {error}");
    }
}

#[test]
fn surfaces_need_full_detail() {
    let error = grown("quaking_aspen --detail skeleton -o a.svg -o no/b.glb").unwrap_err();
    assert!(error.contains("code: 2") && error.contains("no/b.glb: glTF files hold"), "{error}");
}

#[test]
fn segments_are_welded() {
    let [full, separate, welded] =
        ["", "--detail segments", "--weld stem"].map(|how| sizes(&format!("palm {how}")));
    assert_eq!(row(&full, "triangles"), row(&welded, "triangles"));
    assert_eq!(row(&full, "vertices"), row(&welded, "vertices"));
    assert_ne!(row(&separate, "vertices"), row(&welded, "vertices"));
    let error = grown("palm --weld stem --detail skeleton").unwrap_err();
    assert!(error.contains("code: 2") && error.contains("--weld: surfaces"), "{error}");
}

/// The last column of a row of the summary.
fn row(table: &str, name: &str) -> Option<String> {
    let line = table.lines().find(|line| line.starts_with(name));
    line.map(|line| line.split_whitespace().last().unwrap().replace(' ', ""))
}

#[test]
fn wood_is_welded() {
    let plain = sizes("palm --levels 1");
    let welded = sizes("palm --levels 1 --weld union");
    assert_eq!(row(&plain, "welded"), None);
    assert_eq!(row(&welded, "welded stems").as_deref(), Some("1"));
    assert_eq!(row(&plain, "leaves"), row(&welded, "leaves"));
    let error = grown("palm --weld union --detail skeleton").unwrap_err();
    assert!(error.contains("code: 2") && error.contains("--weld: surfaces"), "{error}");
}

#[test]
fn the_budget_is_the_views() {
    let error = grown("quaking_aspen --max-triangles 1000").unwrap_err();
    assert!(error.contains("code: 4"), "{error}");
    let told = "more than 1000 triangles, the limit, which was met in a component of kind";
    assert!(error.contains(told) && error.contains("--max-triangles"), "{error}");
    let enough = sizes("quaking_aspen --max-triangles 1000000");
    assert_eq!(enough, sizes("quaking_aspen"));
    grown("quaking_aspen --max-triangles 0").unwrap_err();
    grown("quaking_aspen --max-triangles 0 --detail skeleton").unwrap();
}

#[test]
fn a_drawing_beside_a_full_tree_grows_no_stem_again() {
    let arguments = parsed("quaking_aspen");
    let species = sapwood::io::find_species("quaking_aspen").unwrap();
    let mut scene = Scene::new();
    let root =
        tree::planted(&mut scene, &species, arguments.individual.individual(), &arguments.tree)
            .unwrap();
    let rules = sapwood::standard_rules();
    tree::compiled(&mut scene, root, &rules, &arguments.tree, &Watch::default()).unwrap();
    scene.set_logging(true);
    let view = scene.open_view(root, &sapwood::skeleton_rules()).unwrap();
    scene.bounds(view).unwrap();
    let log = scene.take_log();
    let compiled = log.iter().filter(|event| event.action == Action::Compiled);
    for event in compiled {
        assert!(["stem_surface", "leaves"].contains(&event.kind.name()), "{event:?}");
    }
}

#[test]
fn what_cannot_be_compiled_is_told_with_its_place() {
    let mut scene = Scene::new();
    let root = scene.add(Attribute::new());
    let nowhere = Transform(Affine3::from_translation(Vec3::NAN));
    scene.add_to(root, nowhere).unwrap();
    let rules = sapwood::standard_rules();
    let (wheat, watch) = (parsed("wheat"), Watch::default());
    let failure = tree::compiled(&mut scene, root, &rules, &wheat.tree, &watch).unwrap_err();
    let shown = format!("{failure:?}");
    assert!(shown.contains("code: 1"), "{shown}");
    assert!(shown.contains("transform: the transform is not finite"), "{shown}");
    assert!(shown.contains("(at /0/0)"), "{shown}");
}
