//! glTF 2.0: a draw list as one self-contained `.glb` file, or as a `.gltf` text with its `.bin`.
//! Reading such files is `read`'s own matter.
//!
//! Every body becomes one glTF mesh with one primitive for each material, and every occurrence
//! one node, so what several occurrences share is written once; an image is written once however
//! many materials have it. Lights and cameras become those of glTF, lines of text nodes that
//! carry the text in their `extras`. What sways is still, or is animated. Bodies that are solid are
//! written as such. Polylines have no place in these files and are left out.

mod buffer;
mod document;
mod fixtures;
mod manifold;
mod materials;
mod pair;
mod placement;
mod read;
mod sway;

use std::io;
use std::path::Path;

use gltf::binary::Glb;
use sapwood_graph::DrawList;

use crate::{Error, ErrorKind, FileSet};
use document::Document;

pub use pair::gltf_buffer_path;
pub(crate) use read::{Folder, flat};
pub use read::{Model, ModelNode, ReadLimits, read_gltf};
pub use sway::{SwayAnimation, Swayed};

/// The bytes of a `.glb` file with everything in `list` that has triangles, lights, is looked
/// from or is written.
///
/// The same list gives the same bytes. A list with nothing of the kind gives a valid file
/// without scene and meshes.
///
/// # Errors
/// When a mesh, a material, an image, a light, a camera, a text or a place holds a value that
/// glTF does not allow (NaN, an index without a vertex), or the file would be longer than 4 GiB;
/// the size is found before any geometry is copied.
pub fn glb_bytes(list: &DrawList) -> Result<Vec<u8>, Error> {
    let list = list.as_drawn();
    let glb = Document::of(&list)?.into_glb()?;
    let mut bytes = Vec::with_capacity(glb.header.length as usize);
    glb.to_writer(&mut bytes)
        .map_err(|error| Error::new(ErrorKind::Write { cause: to_io(error) }))?;
    Ok(bytes)
}

/// As [`glb_bytes`], with an animation of what sways: bodies become skinned meshes, and occurrences
/// of one body move alike.
///
/// # Errors
/// Those of [`glb_bytes`].
pub fn swaying_glb_bytes(
    list: &DrawList,
    animation: &SwayAnimation,
) -> Result<(Vec<u8>, Swayed), Error> {
    let list = list.as_drawn();
    let (document, swayed) = Document::animated(&list, Some(animation))?;
    let glb = document.into_glb()?;
    let mut bytes = Vec::with_capacity(glb.header.length as usize);
    glb.to_writer(&mut bytes)
        .map_err(|error| Error::new(ErrorKind::Write { cause: to_io(error) }))?;
    Ok((bytes, swayed))
}

/// Writes what [`glb_bytes`] gives to the file at `path`, whole or not at all.
///
/// # Errors
/// Those of [`glb_bytes`] and of [`write_atomically`](crate::write_atomically).
pub fn write_glb(path: impl AsRef<Path>, list: &DrawList) -> Result<(), Error> {
    let mut files = FileSet::new();
    files.add_glb(path, list)?;
    files.commit()
}

/// Writes what [`glb_bytes`] writes as a pair: the text at `path` and, beside it under
/// [`gltf_buffer_path`], everything else. Both files take their places, or neither.
///
/// # Errors
/// Those of [`glb_bytes`] and of [`write_atomically`](crate::write_atomically).
pub fn write_gltf(path: impl AsRef<Path>, list: &DrawList) -> Result<(), Error> {
    let mut files = FileSet::new();
    files.add_gltf(path, list)?;
    files.commit()
}

/// glTF.
impl FileSet {
    /// Adds what [`write_glb`] writes.
    ///
    /// # Errors
    /// Those of [`write_glb`].
    pub fn add_glb(&mut self, path: impl AsRef<Path>, list: &DrawList) -> Result<(), Error> {
        self.add_any_glb(path.as_ref(), list, None).map(|_| ())
    }

    /// Adds what [`swaying_glb_bytes`] gives.
    ///
    /// # Errors
    /// Those of [`write_glb`].
    pub fn add_swaying_glb(
        &mut self,
        path: impl AsRef<Path>,
        list: &DrawList,
        animation: &SwayAnimation,
    ) -> Result<Swayed, Error> {
        self.add_any_glb(path.as_ref(), list, Some(animation))
    }

    fn add_any_glb(
        &mut self,
        path: &Path,
        list: &DrawList,
        animation: Option<&SwayAnimation>,
    ) -> Result<Swayed, Error> {
        let list = list.as_drawn();
        let made = Document::animated(&list, animation)
            .and_then(|(document, swayed)| Ok((document.noting(self.notes()).into_glb()?, swayed)));
        let (glb, swayed): (Glb<'_>, _) =
            made.map_err(|error| error.in_file(&path.display().to_string()))?;
        self.write(path, |out| glb.to_writer(out).map_err(to_io))?;
        Ok(swayed)
    }

    /// Adds what [`write_gltf`] writes: two files, or one where there is nothing to put into the
    /// second.
    ///
    /// # Errors
    /// Those of [`write_gltf`].
    pub fn add_gltf(&mut self, path: impl AsRef<Path>, list: &DrawList) -> Result<(), Error> {
        self.add_any_gltf(path.as_ref(), list, None).map(|_| ())
    }

    /// Adds what [`add_swaying_glb`](Self::add_swaying_glb) does, as a text with its buffer.
    ///
    /// # Errors
    /// Those of [`write_gltf`].
    pub fn add_swaying_gltf(
        &mut self,
        path: impl AsRef<Path>,
        list: &DrawList,
        animation: &SwayAnimation,
    ) -> Result<Swayed, Error> {
        self.add_any_gltf(path.as_ref(), list, Some(animation))
    }

    fn add_any_gltf(
        &mut self,
        path: &Path,
        list: &DrawList,
        animation: Option<&SwayAnimation>,
    ) -> Result<Swayed, Error> {
        let list = list.as_drawn();
        let (document, swayed) = Document::animated(&list, animation)
            .map_err(|error| error.in_file(&path.display().to_string()))?;
        let document = document.noting(self.notes());
        self.together(|files| pair::add(files, path, document))?;
        Ok(swayed)
    }
}

fn to_io(error: gltf::Error) -> io::Error {
    match error {
        gltf::Error::Io(cause) => cause,
        other => io::Error::other(other),
    }
}

#[cfg(test)]
mod tests;
