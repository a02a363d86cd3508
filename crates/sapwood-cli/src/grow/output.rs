//! Output files: what is written follows from how their names end.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use sapwood::graph::DrawList;

/// A file to be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Output {
    path: PathBuf,
    format: Format,
}

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// Surfaces and leaves as binary glTF.
    Glb,
    /// The skeleton as a drawing.
    Svg,
}

impl Output {
    pub(crate) fn format(&self) -> Format {
        self.format
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the file, whole or not at all, and tells its size in bytes.
    pub(crate) fn write(&self, list: &DrawList) -> Result<u64, sapwood::io::Error> {
        match self.format {
            Format::Glb => sapwood::io::write_glb(&self.path, list)?,
            Format::Svg => sapwood::io::write_svg(&self.path, list)?,
        }
        // A device has no size.
        Ok(std::fs::metadata(&self.path).map_or(0, |file| file.len()))
    }
}

impl FromStr for Output {
    type Err = String;

    fn from_str(path: &str) -> Result<Self, String> {
        let path = PathBuf::from(path);
        let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
        let format = match ending.as_ref().and_then(|ending| ending.to_str()) {
            Some("glb") => Format::Glb,
            Some("svg") => Format::Svg,
            _ => return Err("accepted: names that end in .glb or .svg".to_owned()),
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
        assert_eq!(format("a/b.glb"), Ok(Format::Glb));
        assert_eq!(format("TREE.GLB"), Ok(Format::Glb));
        assert_eq!(format("tree.v2.svg"), Ok(Format::Svg));
        for wrong in ["", "tree", "tree.obj", ".glb", "glb", "tree.glb/", "/dev/null"] {
            let accepted = wrong == "tree.glb/";
            assert_eq!(format(wrong).is_ok(), accepted, "{wrong}");
        }
    }
}
