//! One text per fault, and the message it must give.

use std::sync::Arc;

use sapwood_geom::glam::{Affine3, Vec2, Vec3};
use sapwood_geom::{Mesh, Purpose, SharedMesh, Stream, StreamPath};
use sapwood_graph::{Body, DrawList, DrawRow, Kind, Material, Named, Occurrence};
use sapwood_rules::weber_penn::{Dialect, LeafTarget, Species, Target};

use crate::parse_species;

const GOOD: &str = r#"name = "Stick"
shape = 3
scale = 2
levels = 1
ratio = 0.05
"#;

fn good(more: &str) -> Species {
    parse_species(&format!("{GOOD}{more}"), "stick.toml").unwrap_or_else(|e| panic!("{e}"))
}

/// Line 6 is the first of `more`.
fn check(more: &str, expected: &str) {
    let error = parse_species(&format!("{GOOD}{more}"), "stick.toml").unwrap_err();
    assert_eq!(error.to_string(), expected);
}

fn check_whole(text: &str, expected: &str) {
    let error = parse_species(text, "stick.toml").unwrap_err();
    assert_eq!(error.line().to_string(), expected);
}

#[test]
fn five_keys_make_a_species() {
    let species = good("");
    assert_eq!(species.scale, 2.0);
    assert_eq!(species.flare, Species::default().flare);
}

#[test]
fn keys_of_every_type_are_read() {
    let species = good(
        "dialect = 'arbaro'\nattraction_target = { point = [1, 2.5, -3] }\nlobes = 5.0\n\
         [leaves]\nshape = 'disc:7'\ntarget = [0, 0, 1]\n[level.1]\ncurve = -4_0\n\
         [ext.tree_gen]\ntropism = [0, 0.5, 1]\n",
    );
    assert_eq!(species.effective_dialect(), Dialect::Arbaro);
    assert_eq!(species.attraction_target, Target::Point(Vec3::new(1.0, 2.5, -3.0)));
    assert_eq!(species.leaves.target, LeafTarget::Direction(Vec3::Z));
    assert_eq!((species.lobes, species.level[1].curve), (5, -40.0));
    assert_eq!(species.ext.unwrap().tropism, Some([0.0, 0.5, 1.0]));
}

#[test]
fn misspelt_keys_are_told_what_was_meant() {
    check(
        "[level.1]\ncurve_rez = 3",
        "stick.toml:7:1: unknown key 'curve_rez' in [level.1]; did you mean 'curve_res'?",
    );
    check(
        "atraction_up = 1",
        "stick.toml:6:1: unknown key 'atraction_up' at the top of the file; \
         did you mean 'attraction_up'?",
    );
    check(
        "bend = 1",
        "stick.toml:6:1: unknown key 'bend' at the top of the file; \
         did you mean 'leaves.bend'?",
    );
    check(
        "colour_of_bark = 1",
        "stick.toml:6:1: unknown key 'colour_of_bark' at the top of the file",
    );
    check("[leafs]\n", "stick.toml:6:2: unknown table [leafs]; did you mean [leaves]?");
    check("[level.4]\n", "stick.toml:6:8: unknown table [level.4]; did you mean [level.3]?");
    check("'leaves.bend' = 1", "stick.toml:6:1: unknown key 'leaves.bend' at the top of the file");
    check("[wood]\n", "stick.toml:6:2: unknown table [wood]");
    check(
        "[level.1]\nTaper = 1",
        "stick.toml:7:1: unknown key 'Taper' in [level.1]; did you mean 'taper'?",
    );
}

#[test]
fn values_out_of_range_are_told_the_range() {
    check(
        "[level.1]\n  taper = 3.5",
        "stick.toml:7:11: level.1.taper = 3.5 is out of range \
         (accepted: a number at least 0 and below 3)",
    );
    check(
        "flare = nan",
        "stick.toml:6:9: flare = nan is out of range (accepted: a number at least -1 and at most 100)",
    );
    check(
        "attraction_up = -inf",
        "stick.toml:6:17: attraction_up = -inf is out of range \
         (accepted: a number at least -100 and at most 100)",
    );
    check(
        "attraction_up = 1e39",
        "stick.toml:6:17: attraction_up = 1e39 is out of range \
         (accepted: a number at least -100 and at most 100)",
    );
    check(
        "lobes = 99999999999999999999",
        "stick.toml:6:9: lobes = 99999999999999999999 is out of range \
         (accepted: a whole number from 0 to 1000)",
    );
    check(
        "[level.2]\ncurve_res = 2.5",
        "stick.toml:7:13: level.2.curve_res = 2.5 is out of range \
         (accepted: a whole number from 1 to 1000)",
    );
    check(
        "[ext.tree_gen]\ntropism = [0, 1]",
        "stick.toml:7:11: ext.tree_gen.tropism = [0, 1] is out of range \
         (accepted: a list of 3 numbers, each from -100 to 100)",
    );
    check(
        "attraction_target = [0, 0, 0.0]",
        "stick.toml:6:21: attraction_target = [0, 0, 0.0] is out of range \
         (accepted: \"up\", a direction [x, y, z] or { point = [x, y, z] })",
    );
    check(
        "attraction_target = { point = [1, 2] }",
        "stick.toml:6:21: attraction_target = { point = [1, 2] } is out of range \
         (accepted: \"up\", a direction [x, y, z] or { point = [x, y, z] })",
    );
}

#[test]
fn what_is_accepted_depends_on_the_origin() {
    let negative = "[trunk]\nbase_splits = -2\n";
    assert_eq!(good(&format!("origin = 'tree_gen'\n{negative}")).trunk.base_splits, -2);
    check(
        negative,
        "stick.toml:7:15: trunk.base_splits = -2 is out of range \
         (accepted: a whole number from 0 to 100)",
    );
}

#[test]
fn wrong_types_are_told_the_right_one() {
    check(
        "flare = 'big'",
        "stick.toml:6:9: flare takes a number at least -1 and at most 100, not the text 'big'",
    );
    check(
        "flare = true",
        "stick.toml:6:9: flare takes a number at least -1 and at most 100, not true",
    );
    check(
        "flare = 1979-05-27",
        "stick.toml:6:9: flare takes a number at least -1 and at most 100, not a date or time",
    );
    check("notes = 'x'", "stick.toml:6:9: notes takes a list of texts, not the text 'x'");
    check("notes = ['x', 7]", "stick.toml:6:15: notes takes a list of texts, not the number 7");
    check(
        "origin = 7",
        "stick.toml:6:10: origin takes one of \"paper\", \"arbaro\", \"tree_gen\", \"sapwood\", not \
         the number 7",
    );
    check("[[level]]", "stick.toml:6:1: level takes a table, not a list");
    check(
        "[ext.tree_gen]\nbend_v = [0, 'x', 0, 0]",
        "stick.toml:7:14: ext.tree_gen.bend_v takes a list of numbers, not the text 'x'",
    );
    check("trunk = 3", "stick.toml:6:9: trunk takes a table, not the number 3");
}

#[test]
fn unknown_names_are_told_the_nearest() {
    check(
        "dialect = 'papper'",
        "stick.toml:6:11: dialect = \"papper\" is not known \
         (accepted: one of \"paper\", \"arbaro\", \"tree_gen\"); did you mean \"paper\"?",
    );
    let error = parse_species(&format!("{GOOD}[leaves]\nshape = 'mapel5'"), "s").unwrap_err();
    assert!(error.to_string().ends_with("; did you mean \"maple5\"?"), "{error}");
    check(
        "attraction_target = 'upp'",
        "stick.toml:6:21: attraction_target = \"upp\" is not known (accepted: \"up\", \
         a direction [x, y, z] or { point = [x, y, z] }); did you mean \"up\"?",
    );
}

#[test]
fn missing_keys_are_named_with_their_table() {
    check_whole("", "stick.toml: missing key 'name' at the top of the file");
    assert_eq!(parse_species("", "stick.toml").unwrap_err().all().count(), 5);
    check_whole(
        &GOOD.replace("levels = 1", "levels = 3\nlevel.1 = { branches = 3, length = 0.5 }"),
        "stick.toml: missing key 'branches' in [level.2]",
    );
    check_whole(
        &GOOD.replace("levels = 1", "levels = 2\nlevel.1 = { branches = 3 }"),
        "stick.toml:5:7: missing key 'length' in [level.1]",
    );
}

#[test]
fn all_errors_are_found_in_the_order_of_the_file() {
    let text = format!("{GOOD}flair = 1\nlobes = -1\n[level.0]\ntaper = 3\ncurve = 'x'\n");
    let error = parse_species(&text, "stick.toml").unwrap_err();
    let lines: Vec<_> = error.all().map(|error| error.place().unwrap().line).collect();
    assert_eq!(lines, [6, 7, 9, 10]);
    assert!(error.to_string().ends_with("\nand 3 more errors in this file"));
    let many = (0..1000).map(|i| format!("x{i} = 1\n")).collect::<String>();
    assert_eq!(parse_species(&many, "f").unwrap_err().all().count(), 20);
}

#[test]
fn what_is_no_toml_is_told_where() {
    check("name = 'x'", "stick.toml:6:1: not valid TOML: duplicate key");
    check(
        "flare = ",
        "stick.toml:6:9: not valid TOML: string values must be quoted, expected literal string",
    );
    check("[level.1", "stick.toml:6:9: not valid TOML: unclosed table, expected `]`");
}

#[test]
fn nesting_and_garbage_end_in_errors() {
    for text in [
        format!("notes = {}{}", "[".repeat(20_000), "]".repeat(20_000)),
        format!("notes = {}", "{a = ".repeat(20_000)),
        format!("{}x = 1", "a.".repeat(20_000)),
        format!("[{}x]", "a.".repeat(20_000)),
        "[".repeat(1 << 19),
        "\0\u{7}=\r[".repeat(1 << 16),
        "x = 1\n".repeat(1 << 16),
        format!("{} = 1", "x".repeat(1 << 19)),
        format!("{GOOD}dialect = '{}'", "x".repeat(1 << 19)),
    ] {
        let error = parse_species(&text, "f").unwrap_err();
        assert!(error.to_string().len() < 4000, "{error}");
    }
}

#[test]
fn a_byte_order_mark_is_skipped_and_other_encodings_are_refused() {
    let text = format!("\u{feff}{GOOD}flair = 1");
    let error = parse_species(&text, "stick.toml").unwrap_err();
    assert_eq!(error.place().unwrap().line, 6);
    parse_species(&format!("\u{feff}{GOOD}"), "stick.toml").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wide.toml");
    let wide: Vec<u8> = GOOD.encode_utf16().flat_map(u16::to_le_bytes).collect();
    std::fs::write(&path, [b"\xFF\xFE".as_slice(), &wide].concat()).unwrap();
    let error = crate::read_species(&path).unwrap_err().to_string();
    assert!(error.ends_with("wide.toml:1:1: not a UTF-8 text from here on"), "{error}");
}

#[test]
fn files_that_cannot_be_read_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing.toml");
    let error = crate::read_species(&missing).unwrap_err().to_string();
    assert!(error.contains("missing.toml: cannot be read: No such file"), "{error}");
    let error = crate::read_species(folder.path()).unwrap_err().to_string();
    assert!(error.contains("cannot be read: is a directory"), "{error}");
    let long = folder.path().join("long.toml");
    std::fs::write(&long, vec![b'#'; (1 << 20) + 1]).unwrap();
    let error = crate::read_species(&long).unwrap_err().to_string();
    assert!(error.ends_with("is 1048577 bytes long; at most 1048576 are read"), "{error}");
    #[cfg(target_os = "linux")]
    assert!(crate::read_species("/dev/zero").unwrap_err().to_string().contains("bytes long"));
}

/// Built-in files with bytes changed, cut out or doubled never panic, and what is still read
/// holds only accepted values.
#[test]
fn damaged_files_are_read_or_refused() {
    let mut stream = Stream::new(StreamPath::new(7), Purpose("damage"));
    let mut pick = |n: usize| (stream.bits() % n as u64) as usize;
    let names: Vec<_> = crate::built_in_names().collect();
    let mut read = 0;
    for _ in 0..3000 {
        let mut text = crate::built_in_text(names[pick(names.len())]).unwrap().as_bytes().to_vec();
        for _ in 0..=pick(3) {
            let at = pick(text.len());
            let end = (at + pick(20)).min(text.len());
            match pick(3) {
                0 => text[at] = b"0129.-+e=[]{}\"'#\n \t_x\xFF"[pick(22)],
                1 => drop(text.drain(at..end)),
                _ => text.splice(at..at, text[at..end].to_vec()).for_each(drop),
            }
        }
        match super::super::parse(&text, "damaged.toml", None, false) {
            Ok(species) => {
                assert_eq!(species.faults(), []);
                read += 1;
            }
            Err(error) => assert!(error.all().all(|error| error.to_string().len() < 1000)),
        }
    }
    assert!((100..2900).contains(&read), "{read}");
}

#[test]
fn envelopes_are_read_from_words_and_from_models_beside_the_file() {
    let text = |envelope: &str| format!("{GOOD}[pruning]\nratio = 1\nenvelope = {envelope}\n");
    let read = good("[pruning]\nratio = 1\nenvelope = \"outside:sphere:0,5,0,2\"\n");
    let written = read.pruning.envelope.as_ref().unwrap();
    assert!(!written.envelope.contains(Vec3::Y * 6.0) && written.envelope.contains(Vec3::ZERO));
    assert_eq!(parse_species(&crate::write_species(&read), "f").unwrap(), read);

    let error = |envelope: &str| parse_species(&text(envelope), "f").unwrap_err().to_string();
    let told = "f:8:12: pruning.envelope is \"ball:1\": 'ball' is no shape (accepted: sphere:";
    assert!(error("\"ball:1\"").starts_with(told), "{}", error("\"ball:1\""));
    assert!(error("\"mesh:none.glb\"").contains("none.glb: cannot be read"));
    assert!(error("3").contains("sphere:X,Y,Z,R"), "{}", error("3"));

    // A path is taken from the folder of the file that says it.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("held.toml");
    std::fs::write(&path, text("\"mesh:hull.glb\"")).unwrap();
    let mut body = Body::new(Kind::of::<Hull>());
    let (material, local) = (Arc::new(Material::matte("", 0.5, 0.5, 0.5)), Affine3::IDENTITY);
    body.rows.push(DrawRow::new(local, hull(), material));
    let occurrences = vec![Occurrence { body: 0, world: Affine3::from_translation(Vec3::X) }];
    let list = DrawList { bodies: vec![body], occurrences };
    crate::write_glb(folder.path().join("hull.glb"), &list).unwrap();
    let envelope = crate::read_species(&path).unwrap().pruning.envelope.unwrap().envelope;
    assert!(envelope.contains(Vec3::new(1.1, 0.1, 0.1)) && !envelope.contains(Vec3::splat(0.1)));
}

struct Hull;

impl Named for Hull {
    const NAME: &'static str = "hull";
}

/// A corner of a cube, cut off.
fn hull() -> SharedMesh {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let mut mesh = Mesh::default();
    for face in [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]] {
        let [a, b, c] = face.map(|corner: usize| corners[corner]);
        mesh.indices.extend([0, 1, 2].map(|i| mesh.positions.len() as u32 + i));
        mesh.positions.extend([a, b, c]);
        mesh.normals.extend([(b - a).cross(c - a).normalize(); 3]);
        mesh.uvs.extend([Vec2::ZERO; 3]);
    }
    SharedMesh::new(mesh)
}
