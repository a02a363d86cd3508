//! Runs of the program, as from a shell: what it says where, what it writes, how it exits.

use std::process::Command;

use crate::program::{command, fails, files, says, text};

#[test]
fn the_first_command_writes_an_aspen() {
    let folder = tempfile::tempdir().unwrap();
    let table = says(folder.path(), "grow quaking_aspen -o quaking_aspen.glb");
    assert!(table.starts_with("Quaking Aspen, seed 0\n\nstems, level 0"), "{table}");
    for row in ["leaves", "vertices", "triangles", "size", "compile", "quaking_aspen.glb"] {
        assert!(table.lines().any(|line| line.starts_with(row)), "{row}: {table}");
    }
    let glb = std::fs::read(folder.path().join("quaking_aspen.glb")).unwrap();
    assert!(glb.starts_with(b"glTF\x02\0\0\0") && glb.len() > 1_000_000);
    assert_eq!(files(folder.path()), ["quaking_aspen.glb"]);

    // The same arguments, the same bytes.
    says(folder.path(), "grow quaking_aspen --seed 0 --detail full -o again.GLB");
    assert!(glb == std::fs::read(folder.path().join("again.GLB")).unwrap());
}

#[test]
fn several_files_are_written_from_one_tree() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let table = says(at, "grow quaking_aspen --levels 2 -o a.glb -o a.svg --output b.svg");
    assert!(table.contains("\ncompile skeleton"), "{table}");
    assert_eq!(files(at), ["a.glb", "a.svg", "b.svg"]);
    says(at, "grow quaking_aspen --levels 2 --detail skeleton -o c.svg");
    let svg = |name: &str| std::fs::read_to_string(at.join(name)).unwrap();
    assert!(svg("a.svg").contains("<svg") && svg("a.svg") == svg("b.svg"));
    assert_eq!(svg("a.svg"), svg("c.svg"));
}

#[test]
fn species_files_are_grown_and_their_errors_passed_through() {
    let folder = tempfile::tempdir().unwrap();
    let text = says(folder.path(), "species show quaking_aspen");
    std::fs::write(folder.path().join("mine.toml"), &text).unwrap();
    let counts = |table: String| table.lines().take(9).map(str::to_owned).collect::<Vec<_>>();
    let own = counts(says(folder.path(), "grow mine.toml"));
    assert_eq!(own, counts(says(folder.path(), "grow quaking_aspen")));

    std::fs::write(folder.path().join("bad.toml"), text.replace("\nratio =", "\nrati =")).unwrap();
    let output =
        command(folder.path(), "grow bad.toml -o bad.glb").output().expect("the program runs");
    assert_eq!(output.status.code(), Some(1));
    let said = self::text(&output.stderr);
    assert!(said.starts_with("sapwood: bad.toml:") && said.contains("'ratio'"), "{said}");
    let said = fails(folder.path(), "grow none.toml", 1);
    assert!(said.contains("none.toml: cannot be read"), "{said}");
    let said = fails(folder.path(), "grow oak", 1);
    assert!(said.ends_with("did you mean 'ca_black_oak'?\n"), "{said}");
}

#[test]
fn wrong_arguments_exit_with_2_and_write_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let check = |arguments: &str, expected: &str| {
        let said = fails(folder.path(), &format!("grow quaking_aspen {arguments}"), 2);
        assert!(said.contains(expected), "{arguments}: {said}");
    };
    check("-o tree.ply", "accepted: names that end in .glb, .gltf, .obj, .svg, .stl, .png or .txt");
    check("-o tree", "accepted: names that end in .glb, .gltf, .obj, .svg, .stl, .png or .txt");
    check("-o", "a value is required");
    check("--detail skeleton -o tree.glb", "glTF files hold surfaces");
    check("--detail fine", "[possible values: full, draft, segments, skeleton]");
    check("--levels 0 -o tree.glb", "(accepted: 1 to 3)");
    check("--levels 4 -o tree.glb", "(accepted: 1 to 3)");
    check("--levels -1", "accepted: 1 up to the levels of the species");
    check("--seed -1", "accepted: whole numbers from 0");
    check("--at 1,2", "three finite numbers");
    check("--at 1,2,inf", "three finite numbers");
    check("--at 1,2,3 --seed 1", "cannot be used with");
    check("--max-triangles many", "accepted: whole numbers from 0");
    check("--colour green", "unexpected argument '--colour'");
    let said = fails(folder.path(), "grow", 2);
    assert!(said.contains("SPECIES|FILE"), "{said}");
    assert!(files(folder.path()).is_empty());
}

#[test]
fn an_exhausted_budget_exits_with_4_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("b.glb"), "old").unwrap();
    let line = "grow quaking_aspen --max-triangles 1000 -o a.svg -o b.glb";
    let said = fails(folder.path(), line, 4);
    assert!(
        said.contains("more than 1000 triangles") && said.contains("--max-triangles"),
        "{said}"
    );
    assert_eq!(files(folder.path()), ["b.glb"]);
    assert_eq!(std::fs::read(folder.path().join("b.glb")).unwrap(), b"old");
}

#[test]
fn output_that_cannot_be_written_exits_with_3() {
    let folder = tempfile::tempdir().unwrap();
    let said = fails(folder.path(), "grow quaking_aspen --levels 1 -o no/tree.glb", 3);
    assert!(said.contains("no/tree.glb: cannot be written"), "{said}");
    std::fs::create_dir(folder.path().join("folder.glb")).unwrap();
    let said = fails(folder.path(), "grow quaking_aspen --levels 1 -o folder.glb", 3);
    assert!(said.contains("folder.glb: cannot be written"), "{said}");
    assert_eq!(files(folder.path()), ["folder.glb"]);
}

/// A limit on the size of files stands for a full disk; it holds for the superuser too.
#[cfg(unix)]
#[test]
fn a_failed_write_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("tree.glb"), "old").unwrap();
    let line = format!(
        "trap '' XFSZ; ulimit -f 64; exec '{}' grow quaking_aspen -o tree.glb",
        env!("CARGO_BIN_EXE_sapwood")
    );
    let mut shell = Command::new("sh");
    let output = shell.args(["-c", &line]).current_dir(folder.path()).output().unwrap();
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(said.starts_with("sapwood: tree.glb: cannot be written: "), "{said}");
    assert_eq!(std::fs::read(folder.path().join("tree.glb")).unwrap(), b"old");
    assert_eq!(files(folder.path()), ["tree.glb"]);
}

#[test]
fn verbosity_goes_to_standard_error() {
    let folder = tempfile::tempdir().unwrap();
    let told = |flags: &str| {
        let line = format!("grow quaking_aspen --levels 2 {flags}");
        let output = command(folder.path(), &line).output().expect("the program runs");
        assert_eq!(output.status.code(), Some(0));
        assert!(text(&output.stdout).starts_with("Quaking Aspen"));
        text(&output.stderr).to_owned()
    };
    let (phases, rules, events) = (told("-v"), told("-vv"), told("-v -v -v"));
    assert!(phases.contains("step=\"compile\"") && !phases.contains("\x1b"), "{phases}");
    assert!(!phases.contains("weber_penn.branch"), "{phases}");
    assert!(rules.contains("rule=\"weber_penn.branch\" action=Compiled times=1"), "{rules}");
    assert!(events.lines().count() > rules.lines().count(), "{events}");
}

#[test]
fn help_is_no_failure_and_tells_everything() {
    let folder = tempfile::tempdir().unwrap();
    let help = says(folder.path(), "grow --help");
    for option in ["--seed", "--at", "--detail", "--levels", "--output", "--max-triangles"] {
        assert!(help.contains(option), "{option}: {help}");
    }
    assert!(says(folder.path(), "--help").contains("Exit codes:"));
    assert!(says(folder.path(), "--version").starts_with("sapwood "));
}

#[test]
fn trees_grow_inside_of_shapes() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let json = |line: &str| -> serde_json::Value {
        let line = format!("grow quaking_aspen --json --detail skeleton {line}");
        serde_json::from_str(&says(at, &line)).unwrap()
    };
    let max = |line: &str| {
        let said = json(line);
        [0, 1, 2].map(|axis| said["bounds"]["max"][axis].as_f64().unwrap())
    };
    let (free, stems) = (max(""), |line: &str| json(line)["stems"][2].as_u64().unwrap());
    let wall = "--prune half-space:1,0,0,1";
    let [x, y, z] = max(wall);
    assert!(x < 1.001 && free[0] > 2.0 && y == free[1] && z > 1.0, "{x} {y} {z} {free:?}");
    assert!(stems(wall) < stems(""));
    let [half, ..] = max(&format!("{wall} --prune-ratio 0.5"));
    assert!(half > 1.1 && half < free[0], "{half}");
    let [x, y, _] = max("--prune half-space:1,0,0,1 --prune half-space:0,1,0,6");
    assert!(x < 1.001 && (5.0..6.001).contains(&y), "{x} {y}");
    assert_eq!(json(wall)["prune"][0], "half-space:1,0,0,1");
    // The same in a species file, and a mesh beside it.
    says(at, "grow quaking_aspen --levels 1 -o trunk.glb");
    let species = says(at, "species show quaking_aspen");
    let held = |shape: &str| {
        let pruning = format!("[pruning]\nenvelope = \"{shape}\"");
        let text = species.replacen("[pruning]", &pruning, 1).replace("\nratio = 0\n", "\n");
        std::fs::write(at.join("held.toml"), text).unwrap();
        let said = says(at, "grow held.toml --json --detail skeleton");
        serde_json::from_str::<serde_json::Value>(&said).unwrap()["stems"].clone()
    };
    assert_eq!(held("half-space:1,0,0,1"), json(wall)["stems"]);
    let within = held("mesh:trunk.glb");
    assert!(within[0] == 1 && within[1].as_u64().unwrap() < 5, "{within}");

    let check = |rest: &str, code, told: &str| {
        let said = fails(at, &format!("grow quaking_aspen -o no.glb {rest}"), code);
        assert!(said.contains(told), "{said}");
    };
    check("--prune ball:1", 2, "'ball' is no shape (accepted: sphere:X,Y,Z,R");
    check("--prune mesh:none.glb", 1, "none.glb");
    check("--prune sphere:0,6,0,3 --prune-ratio 2", 2, "0 to 1");
    check("--prune-ratio 0.5", 2, "--prune");
}

#[test]
fn trees_are_cut_by_shapes() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let max = |line: &str| {
        let said: serde_json::Value = serde_json::from_str(&says(at, line)).unwrap();
        [0, 1, 2].map(|axis| said["bounds"]["max"][axis].as_f64().unwrap())
    };
    let [_, lopped, _] = max("grow quaking_aspen --json --cut half-space:0,1,0,5 -o lopped.glb");
    assert!((4.5..5.6).contains(&lopped), "{lopped}");
    // Several shapes cut one after the other; a drawing is cut too.
    let [_, lower, _] =
        max("grow quaking_aspen --json --detail skeleton --cut half-space:0,1,0,5 \
         --cut outside:box:-9,4,-9,9,9,9 -o lower.svg");
    assert!((3.9..4.1).contains(&lower), "{lower}");
    // A trunk is closed, and nothing but itself is in it.
    says(at, "grow quaking_aspen --levels 1 -o trunk.glb");
    let [x, y, z] = max("grow quaking_aspen --json --cut mesh:trunk.glb -o within.glb");
    assert!(y > 10.0 && x < 1.0 && z < 1.0, "{x} {y} {z}");

    let check = |cut: &str, code, told: &str| {
        let said = fails(at, &format!("grow quaking_aspen --cut {cut} -o no.glb"), code);
        assert!(said.contains(told), "{said}");
    };
    check("ball:1", 2, "'ball' is no shape (accepted: sphere:X,Y,Z,R");
    check("sphere:90,0,0,1", 2, "--cut sphere:90,0,0,1: nothing of the tree is left");
    says(at, "grow quaking_aspen -o whole.glb");
    check("mesh:whole.glb", 1, "it is far from closed (accepted: a closed surface)");
    check("mesh:none.glb", 1, "none.glb");
    check("box:-1,0,-1,1,4,1 --detail skeleton -o no.png", 2, "--detail skeleton");
    assert!(!files(at).iter().any(|name| name.starts_with("no.")));
}
