//! What is read from Arbaro's files; one text per fault, and the message it must give.

use std::time::Instant;

use sapwood_geom::{Purpose, Stream, StreamPath};
use sapwood_rules::weber_penn::{CrownShape, Dialect, LeafShape, Origin, Species};

use super::super::parse;
use crate::{ErrorKind, Place, parse_species, write_species};

const FULL: &str = r#"<?xml version="1.0" ?>
<!-- A tree that nobody has seen. -->
<arbaro>
  <species name='Test &amp; Tree'>
    <param name="Shape" value="7"/>
    <param name='Levels' value='2'/>
    <param name="Scale" value="3.5"/>
    <param name="LeafShape" value='disc2'/>
    <param name="0Scale" value="1.5" />
    <param name="0Branches" value="2"></param>
    <param name="1Length" value="0.0010"/>
    <param
        value = " -120 "
        name = "1Rotate"/>
    <param name="1CurveRes" value="6.0"/>
  </species>
</arbaro>
"#;

fn read(text: &str) -> Species {
    parse_species(text, "tree.xml").unwrap_or_else(|error| panic!("{error}"))
}

fn with(params: &str) -> String {
    format!("<arbaro><species name='T'>\n{params}\n</species></arbaro>")
}

fn param(name: &str, value: &str) -> String {
    with(&format!("<param name='{name}' value='{value}'/>"))
}

/// The first error, without the others.
fn check_whole(text: &str, expected: &str) {
    let error = parse(text.as_bytes(), "f", None, true).unwrap_err();
    assert_eq!(error.line().to_string(), expected);
}

/// Line 2 is the first of `params`.
fn check(params: &str, expected: &str) {
    check_whole(&with(params), expected);
}

#[test]
fn parameters_are_read_wherever_they_belong() {
    let species = read(FULL);
    assert_eq!(species.name, "Test & Tree");
    assert_eq!((species.origin, species.dialect), (Origin::Arbaro, None));
    assert_eq!(species.effective_dialect(), Dialect::Arbaro);
    assert_eq!((species.shape, species.levels, species.scale), (CrownShape::TendFlame, 2, 3.5));
    assert_eq!((species.trunk.scale, species.level[0].branches), (1.5, 2));
    let level = &species.level[1];
    assert_eq!((level.length, level.rotate, level.curve_res), (0.001, -120.0, 6));
    assert_eq!(species.notes, Vec::<String>::new());
    assert_eq!(read(&write_species(&species)), species);
}

#[test]
fn what_is_left_out_has_the_defaults_and_is_noted() {
    let species = read("<arbaro><species name=''/></arbaro>");
    let origin = Origin::Arbaro;
    let defaulted = species.defaulted.clone();
    assert_eq!(species, Species { origin, smooth: Some(0.5), defaulted, ..Species::default() });
    assert_eq!(species.defaulted.len(), 2 + 28 + 4 * 16);

    let defaulted = read(FULL).defaulted;
    assert_eq!(defaulted[..4], ["z_scale", "z_scale_v", "scale_v", "base_size"]);
    for given in ["shape", "leaves.shape", "trunk.scale", "level.0.branches", "level.1.length"] {
        assert!(!defaulted.iter().any(|key| key == given), "{given}");
    }
}

#[test]
fn leaf_shapes_are_arbaros() {
    let shape = |name: &str| {
        let species = read(&param("LeafShape", name));
        (species.leaves.shape, species.notes)
    };
    for (name, expected) in [
        ("0", LeafShape::Oval),
        ("disc", LeafShape::Oval),
        ("disc1", LeafShape::Disc(3)),
        ("disc6", LeafShape::Disc(8)),
        ("disc998", LeafShape::Disc(1000)),
        ("square", LeafShape::Square),
        ("sphere", LeafShape::Sphere),
        ("palm", LeafShape::Palm),
    ] {
        assert_eq!(shape(name), (expected, vec![]), "{name}");
    }
    for (name, meant) in [("3", "."), ("maple5", "."), ("disc0", "; did you mean \"disc\"?")] {
        let note = format!(
            "LeafShape \"{name}\" was read as \"disc\", as any that Arbaro does not know{meant}"
        );
        assert_eq!(shape(name), (LeafShape::Oval, vec![note]));
    }
}

#[test]
fn attributes_that_nothing_is_known_of_are_noted() {
    let species = read("<arbaro xmlns='x' by='W'><species name='T' id='7'/></arbaro>");
    assert_eq!(
        species.notes,
        [
            "Attribute 'by' of <arbaro> was passed over.",
            "Attribute 'id' of <species> was passed over."
        ]
    );
}

#[test]
fn values_are_held_to_their_ranges() {
    let range = |name: &str, value: &str, accepted: &str| {
        let column = 22 + name.len();
        let place = format!("f:2:{}", column + 1);
        let expected = format!("{place}: {name} = {value} is out of range (accepted: {accepted})");
        check_whole(&param(name, value), &expected);
    };
    range("1Taper", "3.5", "a number at least 0 and below 3");
    range("BaseSize", "NaN", "a number at least 0 and at most 1");
    range("AttractionUp", "-inf", "a number at least -100 and at most 100");
    range("AttractionUp", "1e39", "a number at least -100 and at most 100");
    range("Lobes", "99999999999999999999", "a whole number from 0 to 1000");
    range("2CurveRes", "2.5", "a whole number from 1 to 1000");
    range("0BaseSplits", "-2", "a whole number from 0 to 100");
    range("1SplitAngle", "-1", "a number at least 0 and at most 180");
    assert_eq!(read(&param("Levels", "0")).levels, 0);
    check(
        "<param name='Scale' value='big'/>",
        "f:2:28: Scale takes a number above 0 and at most 1000, not the text \"big\"",
    );
    check(
        "<param name='Scale' value=''/>",
        "f:2:28: Scale takes a number above 0 and at most 1000, not the text \"\"",
    );
}

#[test]
fn unknown_parameters_are_told_what_was_meant() {
    let unknown = |name: &str, meant: &str| {
        let expected = format!("f:2:14: unknown parameter '{name}'{meant}");
        check_whole(&param(name, "1"), &expected);
    };
    unknown("1Lenght", "; did you mean '1Length'?");
    unknown("2length", "; did you mean '2Length'?");
    unknown("4Length", "; did you mean '3Length'?");
    unknown("Length", "; did you mean '0Length'?");
    unknown("leafscale", "; did you mean 'LeafScale'?");
    unknown("AtractionUp", "; did you mean 'AttractionUp'?");
    unknown("ColourOfBark", "");
    unknown("", "");
    unknown("ü", "");
}

#[test]
fn what_is_given_twice_is_refused() {
    check(
        "<param name='Scale' value='1'/>\n <param name='Scale' value='1'/>",
        "f:3:15: Scale was given before, at line 2, column 14",
    );
    check(
        "</species>\n<species name='U'>",
        "f:3:1: unexpected second <species> in <arbaro> (accepted: one <species>)",
    );
    check(
        "<param name='Scale' name='Scale' value='1'/>",
        "f:2:21: not valid XML: attribute 'name' is already defined",
    );
}

#[test]
fn what_has_no_place_in_such_a_file_is_refused() {
    check_whole("", "f:1:1: missing <arbaro> in the file");
    check_whole("<!-- x -->\n", "f:2:1: missing <arbaro> in the file");
    check_whole("<svg/>", "f:1:1: unexpected <svg> in the file (accepted: <arbaro>)");
    check_whole(" <arbaro/>", "f:1:2: missing <species> in <arbaro>");
    check_whole(
        "<arbaro><scene/></arbaro>",
        "f:1:9: unexpected <scene> in <arbaro> (accepted: <species>)",
    );
    check_whole("<arbaro><species/></arbaro>", "f:1:9: missing attribute 'name' in <species>");
    check("<parm/>", "f:2:1: unexpected <parm> in <species> (accepted: <param>)");
    check("<param name='Scale'/>", "f:2:1: missing attribute 'value' in <param>");
    check("<param value='1'/>", "f:2:1: missing attribute 'name' in <param>");
    check("\n  so be it", "f:3:3: unexpected text \"so be it\" in <species> (accepted: <param>)");
    check(
        "<param name='Scale' value='1'>2</param>",
        "f:2:31: unexpected text \"2\" in <param> (accepted: nothing)",
    );
    check(
        "<param name='Scale' value='1'><i/></param>",
        "f:2:31: unexpected <i> in <param> (accepted: nothing)",
    );
}

#[test]
fn what_is_no_xml_is_told_where() {
    check_whole("name = 'x'", "f:1:1: not valid XML: unexpected 'n'");
    check("<param name=Scale/>", "f:2:13: not valid XML: expected a quote, not 'S'");
    check(
        "<param name='Scale value='1'/>",
        "f:2:27: not valid XML: expected a whitespace, not '1'",
    );
    check("<param name='Scale/>", "f:3:1: not valid XML: expected the closing quote, not '<'");
    check("<param>", "f:3:1: not valid XML: expected </param>, not </species>");
    check(
        "<param name='&bomb;' value='1'/>",
        "f:2:14: not valid XML: unknown entity reference 'bomb'",
    );
    check_whole("<arbaro/><arbaro/>", "f:1:10: not valid XML: unexpected '<'");
    let error = parse(b"<arbaro>\n\xE4", "f", None, false).unwrap_err();
    assert_eq!(error.to_string(), "f:2:1: not a UTF-8 text from here on");
}

#[test]
fn entities_and_external_files_are_refused() {
    let refused = "a document type declaration is refused; \
                   entities and external files are not read";
    for more in [
        "",
        " [<!ENTITY a 'aaaaaaaaaa'><!ENTITY b '&a;&a;&a;&a;&a;&a;&a;&a;'>]",
        " SYSTEM 'file:///etc/passwd'",
        " PUBLIC 'x' 'http://localhost/x.dtd'",
        " [<!ENTITY % p SYSTEM 'x'> %p;]",
    ] {
        let text = format!("<?xml version='1.0'?>\n <!DOCTYPE arbaro{more}>\n<arbaro/>");
        check_whole(&text, &format!("f:2:2: {refused}"));
    }
}

#[test]
fn hostile_texts_are_refused_in_no_time() {
    let namespaces: String = (0..40_000).map(|i| format!("<a xmlns:a{i}='x'>")).collect();
    let attributes: String = (0..80_000).map(|i| format!(" a{i}=''")).collect();
    for text in [
        "<a>".repeat(100_000),
        format!("{}{}", "<a>".repeat(100_000), "</a>".repeat(100_000)),
        with(&"<param>".repeat(100_000)),
        namespaces,
        format!("<arbaro{attributes}/>"),
        with(&"<param name='Scale' value='1'/>".repeat(30_000)),
        with(&"<p/>".repeat(200_000)),
        with(&"<p/>x".repeat(150_000)),
        with(&"&amp;".repeat(200_000)),
        with(&"<![CDATA[x]]>".repeat(60_000)),
        format!("<{}/>", "x".repeat(1_000_000)),
        param(&"x".repeat(1_000_000), "1"),
        param("Scale", &"1".repeat(1_000_000)),
        param("Scale", &"&#49;".repeat(200_000)),
        "<!--".repeat(200_000),
        "<".repeat(1 << 20),
        "</a>".repeat(200_000),
        "\u{7}<".repeat(1 << 19),
    ] {
        let start = Instant::now();
        let error = parse(text.as_bytes(), "f", None, true).unwrap_err();
        assert!(start.elapsed().as_secs() < 2, "{:?}: {error}", start.elapsed());
        assert!(error.place().is_some(), "{error}");
        assert!(error.all().all(|error| error.line().to_string().len() < 1000), "{error}");
    }
    check_whole(&"<a>".repeat(100_000), "f:1:25: elements are nested more than 8 deep");
    let long = " ".repeat(1 << 20) + "<";
    check_whole(&long, "f: is 1048577 bytes long; at most 1048576 are read");
}

#[test]
fn truncated_texts_are_told_where_they_end() {
    check_whole(
        &FULL[..30],
        "f:2:8: not valid XML: the file ends inside a comment, which begins in line 2",
    );
    let upto = |end: &str| &FULL[..FULL.find(end).unwrap() + end.len()];
    check_whole(
        upto("value='2'/>"),
        "f:6:37: not valid XML: the file ends inside <species>, which begins in line 4",
    );
    check_whole(
        upto("name='Lev"),
        "f:6:21: not valid XML: the file ends inside <param>, which begins in line 6",
    );
    check_whole(
        upto("</species>"),
        "f:16:13: not valid XML: the file ends inside <arbaro>, which begins in line 3",
    );
}

#[test]
fn every_beginning_of_a_text_is_an_error_with_a_place() {
    let text = FULL.replace("Tree", "B\u{e4}um\u{1F333}");
    let whole = text.trim_end().len();
    let end = |text: &[u8]| {
        let text = String::from_utf8_lossy(text);
        let line = text.rsplit('\n').next().unwrap_or_default();
        Place { line: text.split('\n').count(), column: line.chars().count() + 1 }
    };
    for length in 0..=text.len() {
        let part = &text.as_bytes()[..length];
        match parse(part, "f", None, true) {
            Ok(_) => assert!(length >= whole, "{length}"),
            Err(error) => {
                assert!(length < whole, "{length}: {error}");
                let utf8 = matches!(error.kind(), ErrorKind::NotUtf8);
                let place = error.place().unwrap_or_else(|| panic!("{length}: {error}"));
                assert!(utf8 || place == end(part), "{length}: {error}");
            }
        }
    }
}

/// Texts with bytes changed, cut out or doubled never panic nor take long, and what is still read
/// holds only accepted values.
#[test]
fn damaged_texts_are_read_or_refused() {
    let mut stream = Stream::new(StreamPath::new(11), Purpose("damage"));
    let mut pick = |n: usize| (stream.bits() % n as u64) as usize;
    let mut read = 0;
    let start = Instant::now();
    for _ in 0..4000 {
        let mut text = FULL.as_bytes().to_vec();
        for _ in 0..=pick(3) {
            let at = pick(text.len());
            let end = (at + pick(20)).min(text.len());
            match pick(4) {
                0 => text[at] = b"0129.-+e=<>/!?[]{}\"'&;# \n\tx-\xFF"[pick(29)],
                1 => text[at] = pick(256) as u8,
                2 => drop(text.drain(at..end)),
                _ => text.splice(at..at, text[at..end].to_vec()).for_each(drop),
            }
        }
        match parse(&text, "damaged.xml", None, true) {
            Ok(species) => {
                assert_eq!(species.faults(), []);
                read += 1;
            }
            Err(error) => {
                let fine = |error: &crate::Error| error.place().is_some();
                assert!(error.all().all(|error| fine(error) && error.to_string().len() < 1000));
            }
        }
    }
    assert!((100..3900).contains(&read), "{read}");
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
}

#[test]
fn files_are_told_apart_by_their_beginning_or_their_name() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        crate::read_species(&path).map(|species| species.name).map_err(|error| error.to_string())
    };
    for name in ["a.xml", "a.XML", "a.toml", "a"] {
        assert_eq!(read(name, FULL).unwrap(), "Test & Tree", "{name}");
        assert_eq!(read(name, &format!("\u{feff}\r\n{}", with(""))).unwrap(), "T", "{name}");
    }
    assert!(read("a.toml", "").unwrap_err().contains("missing key 'name'"));
    assert!(read("a.xml", "").unwrap_err().ends_with("a.xml:1:1: missing <arbaro> in the file"));
    let toml = write_species(&Species::default());
    assert!(read("a.xml", &toml).unwrap_err().contains("a.xml:1:1: not valid XML: "));
    read("a.txt", &toml).unwrap();
}
