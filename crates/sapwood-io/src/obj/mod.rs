//! Wavefront OBJ: a draw list as text, in world space, with its materials and images beside it.
//!
//! Every occurrence of a body is one object (`o`), and in it `usemtl` tells the materials apart.
//! So a program that opens the file, such as Blender, shows one object for each tree, to be moved
//! and hidden as a whole, with one slot for each material by which its parts can be selected; an
//! object for each stem or leaf would be thousands of them, and one for each material would tear
//! trees apart. Positions are in metres, y up. Instances are written out one by one, for the
//! format knows none, but never all held at once; texture coordinates, which all instances of a
//! mesh share, are written once. Polylines are `l` elements, without their radii. Lights, cameras
//! and lines of text have no place in these files and are left out.

mod materials;
mod numbers;
mod pieces;
mod read;
mod read_materials;
mod scribe;

use std::io;
use std::path::{Path, PathBuf};

use sapwood_graph::DrawList;

use crate::{Error, ErrorKind, FileSet};
use materials::Materials;
pub(crate) use read::{ObjModel, read_obj};

/// Where [`write_obj`] puts the materials: beside the file at `path`, with the ending `.mtl`.
///
/// White space in the name becomes `_`, for many readers take it for the name's end.
pub fn obj_material_path(path: impl AsRef<Path>) -> PathBuf {
    beside(path.as_ref(), ".mtl")
}

/// Where [`write_obj`] puts an image, of which the first has the number 1: beside the file at
/// `path`, as `NAME-1.png`, with `_` for white space.
pub fn obj_image_path(path: impl AsRef<Path>, number: usize) -> PathBuf {
    beside(path.as_ref(), &format!("-{number}.png"))
}

/// Writes three sorts of files that take their places together, or none does: the text at
/// `path`, the materials at [`obj_material_path`], and each distinct image as a PNG file
/// at its [`obj_image_path`].
///
/// The same list gives the same bytes, and every number reads back as the very number that it
/// was. Without triangles no materials are written.
///
/// # Errors
/// When a mesh, a polyline or an image holds a value that the format cannot (NaN, an index
/// without a vertex), and those of [`write_atomically`](crate::write_atomically).
pub fn write_obj(path: impl AsRef<Path>, list: &DrawList) -> Result<(), Error> {
    let mut files = FileSet::new();
    files.add_obj(path, list)?;
    files.commit()
}

/// OBJ.
impl FileSet {
    /// Adds what [`write_obj`] writes.
    ///
    /// # Errors
    /// Those of [`write_obj`].
    pub fn add_obj(&mut self, path: impl AsRef<Path>, list: &DrawList) -> Result<(), Error> {
        let (path, list) = (path.as_ref(), &*list.as_drawn());
        let materials = Materials::of(list, |number| obj_image_path(path, number))
            .map_err(|error| error.in_file(&path.display().to_string()))?;
        self.together(|files| add(files, path, list, &materials))
    }
}

fn add(
    files: &mut FileSet,
    path: &Path,
    list: &DrawList,
    materials: &Materials,
) -> Result<(), Error> {
    for (image, bytes) in &materials.images {
        files.write(image, |out| out.write_all(bytes))?;
    }
    let mut library = None;
    if !materials.is_empty() {
        let path = obj_material_path(path);
        files.write(&path, |out| out.write_all(materials.text.as_bytes()))?;
        library = Some(name_of(&path));
    }
    let mut refused = None;
    let of_line = |(key, note): &(String, String)| {
        let line = format!("{key}: {note}");
        // A comment ends with its line.
        format!("# {}\n", line.replace(char::is_control, " "))
    };
    let notes: String = files.notes().iter().map(of_line).collect();
    let written = files.write(path, |out| {
        scribe::write(list, materials, library.as_deref(), &notes, out).map_err(|error| match error
        {
            scribe::Failure::Write(cause) => cause,
            scribe::Failure::Refused { component, reason } => {
                refused = Some(ErrorKind::Unwritable { component, reason });
                io::ErrorKind::InvalidData.into()
            }
        })
    });
    match refused {
        Some(kind) => Err(Error::new(kind).in_file(&path.display().to_string())),
        None => written,
    }
}

/// The path of a companion of the file at `path`, in the same folder.
fn beside(path: &Path, ending: &str) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!("{}{ending}", without_spaces(&stem)))
}

/// The last part of a path.
fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// `text` with `_` for white space and control characters, which end names in these files.
fn without_spaces(text: &str) -> String {
    let ends = |c: char| c.is_whitespace() || c.is_control();
    text.chars().map(|c| if ends(c) { '_' } else { c }).collect()
}

#[cfg(test)]
mod tests;
