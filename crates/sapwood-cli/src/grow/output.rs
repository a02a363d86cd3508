//! Output files: what is written follows from how their names end.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use sapwood::geom::Solid;
use sapwood::graph::DrawList;
use sapwood::io::{FileSet, SwayAnimation, Swayed};

use crate::failure::Failure;
use crate::picture;

const ACCEPTED: &str = "accepted: names that end in .glb, .gltf, .obj, .svg, .stl, .png or .txt";

/// A file to be written, or several where a picture is turned.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Output {
    path: PathBuf,
    format: Format,
}

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// What is drawn.
    List(ListFormat),
    /// A picture of it.
    Png,
    /// It in words.
    Text,
}

/// How a file holds what is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ListFormat {
    /// Surfaces and leaves as binary glTF.
    Glb,
    /// Surfaces and leaves as glTF text, with a `.bin` file.
    Gltf,
    /// Surfaces and leaves, or the skeleton's lines, with a `.mtl` file.
    Obj,
    /// The skeleton as a drawing.
    Svg,
    /// The wood as one solid, without leaves.
    Stl,
}

/// What there is to be written.
pub(crate) struct Drawn<'a> {
    /// What is drawn, at rest where it sways.
    pub(crate) list: &'a DrawList,
    /// The moment of it that files hold which cannot move.
    pub(crate) still: &'a DrawList,
    /// How files move that can.
    pub(crate) animation: Option<&'a SwayAnimation>,
    /// The lines that are drawn in its place.
    pub(crate) lines: &'a DrawList,
    /// The wood, where it was welded to one solid.
    pub(crate) solid: Option<&'a Solid>,
}

impl Output {
    pub(crate) fn format(&self) -> Format {
        self.format
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Whether the format has nothing but surfaces.
    pub(crate) fn needs_surfaces(&self) -> bool {
        matches!(self.format, Format::List(ListFormat::Glb | ListFormat::Gltf))
    }

    /// Whether the format has nothing but a solid.
    pub(crate) fn needs_solid(&self) -> bool {
        self.format == Format::List(ListFormat::Stl)
    }

    /// What somebody might not expect of the file.
    pub(crate) fn note(&self) -> Option<String> {
        self.needs_solid()
            .then(|| format!("{}: without leaves, in metres, z up", self.path.display()))
    }

    /// The files that may be written, the output itself first. Of images the first stands for
    /// all: outputs that share one share that too.
    fn claims(&self, turns: Option<u32>) -> Vec<PathBuf> {
        let beside = match self.format {
            Format::Png => {
                return picture::names(&self.path, turns).map(|path| resolved(&path)).collect();
            }
            Format::List(ListFormat::Glb | ListFormat::Svg | ListFormat::Stl) | Format::Text => {
                Vec::new()
            }
            Format::List(ListFormat::Gltf) => vec![sapwood::io::gltf_buffer_path(&self.path)],
            Format::List(ListFormat::Obj) => vec![
                sapwood::io::obj_material_path(&self.path),
                sapwood::io::obj_image_path(&self.path, 1),
            ],
        };
        [self.path.clone()].into_iter().chain(beside).map(|path| resolved(&path)).collect()
    }
}

impl ListFormat {
    /// Adds the file, and those that belong to it, to `files`; tells their size in bytes, and how
    /// many joints move where it can hold an animation.
    pub(crate) fn write(
        self,
        path: &Path,
        files: &mut FileSet,
        drawn: &Drawn<'_>,
    ) -> Result<(u64, Option<Swayed>), sapwood::io::Error> {
        let Drawn { list, still, animation, lines, solid } = drawn;
        let n_before = files.written().count();
        let mut swayed = None;
        match (self, animation) {
            (Self::Glb, None) => files.add_glb(path, list)?,
            (Self::Gltf, None) => files.add_gltf(path, list)?,
            (Self::Glb, Some(animation)) => {
                swayed = Some(files.add_swaying_glb(path, list, animation)?);
            }
            (Self::Gltf, Some(animation)) => {
                swayed = Some(files.add_swaying_gltf(path, list, animation)?);
            }
            (Self::Obj, _) => files.add_obj(path, still)?,
            (Self::Svg, _) => files.add_svg(path, lines)?,
            (Self::Stl, _) => files.add_stl(path, solid.unwrap_or(&Solid::default()))?,
        }
        Ok((files.written().skip(n_before).map(|(_, bytes)| bytes).sum(), swayed))
    }
}

/// Refuses outputs that would write to the same file.
pub(crate) fn refuse_clashes(outputs: &[Output], turns: Option<u32>) -> Result<(), Failure> {
    let Some((first, second, file)) = clash(outputs, turns) else { return Ok(()) };
    Err(Failure::usage(format!(
        "{} and {} would both be written to {}; nothing was written",
        first.path().display(),
        second.path().display(),
        file.display()
    )))
}

/// The first two outputs that would write to the same file, and that file.
fn clash(outputs: &[Output], turns: Option<u32>) -> Option<(&Output, &Output, PathBuf)> {
    let mut claimed: BTreeMap<PathBuf, &Output> = BTreeMap::new();
    for output in outputs {
        for path in output.claims(turns) {
            if let Some(first) = claimed.get(&path) {
                return Some((first, output, path));
            }
            claimed.insert(path, output);
        }
    }
    None
}

/// One path for each file, as far as the folders are there.
fn resolved(path: &Path) -> PathBuf {
    if let Ok(path) = path.canonicalize() {
        return path;
    }
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    match (folder.canonicalize(), path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => path.to_owned(),
    }
}

impl FromStr for Output {
    type Err = String;

    fn from_str(path: &str) -> Result<Self, String> {
        let path = PathBuf::from(path);
        let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
        let format = match ending.as_ref().and_then(|ending| ending.to_str()) {
            Some("glb") => Format::List(ListFormat::Glb),
            Some("gltf") => Format::List(ListFormat::Gltf),
            Some("obj") => Format::List(ListFormat::Obj),
            Some("stl") => Format::List(ListFormat::Stl),
            Some("svg") => Format::List(ListFormat::Svg),
            Some("png") => Format::Png,
            Some("txt") => Format::Text,
            _ => return Err(ACCEPTED.to_owned()),
        };
        Ok(Self { path, format })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_decides() {
        let format = |path: &str| path.parse::<Output>().map(|output| output.format);
        assert_eq!(format("a/b.glb"), Ok(Format::List(ListFormat::Glb)));
        assert_eq!(format("a.stl"), Ok(Format::List(ListFormat::Stl)));
        assert_eq!(format("TREE.GLB"), Ok(Format::List(ListFormat::Glb)));
        assert_eq!(format("tree.v2.svg"), Ok(Format::List(ListFormat::Svg)));
        assert_eq!(format("tree.obj"), Ok(Format::List(ListFormat::Obj)));
        assert_eq!(format("tree.gltf"), Ok(Format::List(ListFormat::Gltf)));
        assert_eq!(format("tree.Png"), Ok(Format::Png));
        assert_eq!(format("tree.txt"), Ok(Format::Text));
        for wrong in ["", "tree", "tree.ply", ".glb", "glb", "tree.glb/", "/dev/null"] {
            let accepted = wrong == "tree.glb/";
            assert_eq!(format(wrong).is_ok(), accepted, "{wrong}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn outputs_that_share_an_image_are_refused_early() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("b-1.png"), "old").unwrap();
        std::os::unix::fs::symlink(at("b-1.png"), at("a-1.png")).unwrap();
        let outputs = ["a.obj", "b.obj"].map(|name| at(name).to_str().unwrap().parse().unwrap());
        let (_, _, file) = clash(&outputs, None).unwrap();
        assert!(file.ends_with("b-1.png"), "{file:?}");
    }

    #[test]
    fn outputs_clash_by_all_their_files() {
        let turned = |paths: [&str; 2], turns, expected: Option<&str>| {
            let outputs = paths.map(|path| path.parse().unwrap());
            let clash = clash(&outputs, turns).map(|(_, _, path)| path);
            let name = clash.as_ref().and_then(|path| path.file_name()?.to_str());
            assert_eq!(name, expected, "{paths:?}");
        };
        let check = |paths, expected| turned(paths, None, expected);
        check(["a.glb", "./a.glb"], Some("a.glb"));
        check(["a.glb", "no-such-folder/a.glb"], None);
        check(["a.gltf", "a.GLTF"], Some("a.bin"));
        check(["a.obj", "src/../a.obj"], Some("a.obj"));
        check(["a b.obj", "a_b.obj"], Some("a_b.mtl"));
        check(["a.glb", "a.obj"], None);
        check(["a.png", "a-001.png"], None);
        check(["a.png", "./a.png"], Some("a.png"));
        turned(["a.png", "a.PNG"], Some(2), None);
        turned(["a.png", "./a.png"], Some(2), Some("a-000.png"));
    }
}
