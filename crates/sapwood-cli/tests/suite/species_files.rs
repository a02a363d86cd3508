//! Runs of the program over species files, good and bad, of ours and of Arbaro.

use std::path::{Path, PathBuf};

use sapwood::rules::weber_penn::{Dialect, LeavesSpec, Origin, Species};

use crate::program::command;

const BUSH: &str = r#"<arbaro><species name="Bush">
  <param name="Levels" value="2"/>
  <param name="Scale" value="2"/>
  <param name="1Branches" value="7"/>
  <param name="Leaves" value="5"/>
</species></arbaro>
"#;

/// Exit code, standard output and standard error.
fn outcome(folder: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let output = command(folder, "").args(arguments).output().expect("the program runs");
    let text = |bytes| String::from_utf8(bytes).expect("the program writes UTF-8");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

/// The program succeeds and says nothing on standard error; gives its output.
fn says(folder: &Path, arguments: &[&str]) -> String {
    let (code, said, errors) = outcome(folder, arguments);
    assert_eq!((code, errors.as_str()), (Some(0), ""), "{arguments:?}");
    said
}

/// The program fails with this code and without output; gives what it says.
fn fails(folder: &Path, arguments: &[&str], code: i32) -> String {
    let (found, said, errors) = outcome(folder, arguments);
    assert_eq!((found, said.as_str()), (Some(code), ""), "{arguments:?}: {errors}");
    errors
}

fn read(path: &Path) -> Species {
    sapwood::io::read_species(path).unwrap_or_else(|error| panic!("{error}"))
}

/// What the table says before the times.
fn counts(table: &str) -> String {
    let (counts, _times) = table.rsplit_once("\n\n").expect("the times stand last");
    counts.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn files_of_arbaro_are_grown_shown_and_converted() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("bush.xml"), BUSH).unwrap();
    let line = says(at, &["species", "check", "bush.xml"]);
    assert_eq!(line, "bush.xml: Bush, dialect arbaro, 2 levels of stems\n");

    let line = says(at, &["species", "convert", "bush.xml", "bush.toml"]);
    assert_eq!(line, "bush.toml: Bush, dialect arbaro, 2 levels of stems\n");
    assert_eq!(read(&at.join("bush.toml")), read(&at.join("bush.xml")));
    let text = std::fs::read_to_string(at.join("bush.toml")).unwrap();
    assert_eq!(says(at, &["species", "show", "bush.xml"]), text);

    let table = says(at, &["grow", "bush.xml", "-o", "xml.glb", "-o", "xml.svg"]);
    assert!(table.starts_with("Bush, seed 0\n"), "{table}");
    says(at, &["grow", "bush.toml", "-o", "toml.glb", "-o", "toml.svg"]);
    for ending in ["glb", "svg"] {
        let file = |name| std::fs::read(at.join(format!("{name}.{ending}"))).unwrap();
        assert!(file("xml") == file("toml"));
    }
}

#[test]
fn all_files_are_checked_and_what_is_wrong_goes_to_standard_error() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let write = |name: &str, text: &str| std::fs::write(at.join(name), text).unwrap();
    write("good.xml", BUSH);
    write("noted.xml", &BUSH.replace("Levels\" value=\"2", "LeafShape\" value=\"fern"));
    write("bad.xml", &BUSH.replace("Scale\" value=\"2", "Scal\" value=\"0").replace("7", "x"));
    write("cut.xml", &BUSH[..50]);
    let files = ["bad.xml", "good.xml", "cut.xml", "noted.xml", "none.xml", "wheat"];
    let (code, said, errors) = outcome(at, &[&["species", "check"], &files[..]].concat());
    assert_eq!(code, Some(1));
    assert_eq!(
        said,
        "good.xml: Bush, dialect arbaro, 2 levels of stems\n\
         noted.xml: Bush, dialect arbaro, 3 levels of stems\n\
         noted.xml: note: LeafShape \"fern\" was read as \"disc\", as any that Arbaro does not know.\n\
         wheat: Wheat, dialect arbaro, 2 levels of stems\n"
    );
    assert_eq!(
        errors.replace("(os error 2)", "").trim_end(),
        "sapwood: bad.xml:3:16: unknown parameter 'Scal'; did you mean 'Scale'?\n\
         sapwood: bad.xml:4:34: 1Branches takes a whole number from -100000 to 100000, not the \
         text \"x\"\n\
         sapwood: cut.xml:2:21: not valid XML: the file ends inside <param>, which begins in line 2\n\
         sapwood: none.xml: cannot be read: No such file or directory"
    );
    assert!(fails(at, &["species", "check"], 2).contains("<FILE>"));
}

#[test]
fn nothing_is_converted_onto_itself_or_by_halves() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("bush.xml"), BUSH).unwrap();
    std::fs::write(at.join("bad.xml"), &BUSH[..80]).unwrap();
    let text = says(at, &["species", "show", "wheat"]);
    std::fs::write(at.join("own.toml"), &text).unwrap();
    let convert = |from, to, code, expected: &str| {
        let said = fails(at, &["species", "convert", from, to], code);
        assert!(said.starts_with("sapwood: ") && said.contains(expected), "{said}");
    };
    convert("own.toml", "own.toml", 2, "own.toml is the file that is read; name another one");
    convert("own.toml", "./own.toml", 2, "./own.toml is the file that is read");
    convert("bad.xml", "own.toml", 1, "bad.xml:3:16: not valid XML");
    convert("bush.xml", "bush.txt", 2, "bush.txt: accepted: names that end in .toml");
    convert("bush.xml", "-", 2, "-: accepted: names that end in .toml");
    convert("-", "x.toml", 1, "no built-in species and no file is called '-'\n");
    convert("bush.xml", "no/x.toml", 3, "no/x.toml: cannot be written");
    assert_eq!(std::fs::read_to_string(at.join("own.toml")).unwrap(), text);
    assert_eq!(std::fs::read_dir(at).unwrap().count(), 3);

    // A built-in species is no file, and any other file may be replaced.
    says(at, &["species", "convert", "palm", "own.toml"]);
    assert_eq!(Some(read(&at.join("own.toml"))), sapwood::io::built_in("palm"));
}

/// The species files in the folder that `SAPWOOD_ARBARO_DIR` names, in the order of their names.
fn files_of_arbaro() -> Vec<PathBuf> {
    let Some(folder) = std::env::var_os("SAPWOOD_ARBARO_DIR").filter(|name| !name.is_empty())
    else {
        println!("not run: SAPWOOD_ARBARO_DIR names no folder of Arbaro's species files");
        return Vec::new();
    };
    let entries = std::fs::read_dir(&folder).expect("SAPWOOD_ARBARO_DIR names a folder");
    let paths = entries.map(|entry| entry.expect("the folder can be read").path());
    let mut files: Vec<_> =
        paths.filter(|path| path.extension().is_some_and(|e| e == "xml")).collect();
    assert!(!files.is_empty(), "no species files in {folder:?}");
    files.sort();
    files
}

#[test]
fn arbaros_own_files_are_read_converted_and_grown() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for path in files_of_arbaro() {
        let (file, stem) = (path.to_str().unwrap(), path.file_stem().unwrap().to_str().unwrap());
        let species = read(&path);
        assert_eq!(species.effective_dialect(), Dialect::Arbaro, "{file}");
        assert_eq!(species.faults(), [], "{file}");

        let toml = format!("{stem}.toml");
        says(at, &["species", "convert", file, &toml]);
        assert_eq!(read(&at.join(&toml)), species, "{file}");
        let table = says(at, &["grow", file]);
        assert_eq!(counts(&table), counts(&says(at, &["grow", &toml])), "{file}");

        // Built-in species of Arbaro's have the same values under a name for people, and looks,
        // of which Arbaro's files say nothing.
        let built_in = sapwood::io::built_in(stem).filter(|known| known.origin == Origin::Arbaro);
        if let Some(built_in) = built_in {
            let of_arbaro = species.leaves.clone();
            let leaves = LeavesSpec {
                outline: of_arbaro.outline,
                color: of_arbaro.color,
                vein_color: of_arbaro.vein_color,
                translucency: of_arbaro.translucency,
                ..built_in.leaves.clone()
            };
            let (name, bark) = (species.name.clone(), species.bark.clone());
            assert_eq!(Species { name, bark, leaves, ..built_in }, species, "{file}");
        }
    }
}
