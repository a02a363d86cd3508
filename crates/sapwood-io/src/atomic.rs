//! Writing files whole or not at all, several together.
//!
//! The bytes of each file go to a temporary file in the folder of its target. When everything is
//! written and on the disk, all of them take their targets' places, one after the other. What
//! goes into the files is the caller's.

use std::ffi::OsString;
use std::fmt;
use std::fs::{self, File, Metadata};
use std::io::{self, BufWriter, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use tempfile::{NamedTempFile, TempPath};

use crate::{Error, ErrorKind};

/// Bytes that are handed to the operating system at once.
const PIECE: usize = 1 << 16;

/// Writes the file at `path` with what `fill` produces, or leaves everything as it was.
///
/// On failure the old file is byte for byte what it was and no temporary file stays behind.
/// A symbolic link is followed, an existing file keeps its permissions, and something that is
/// no regular file (a pipe, a device) is written to directly.
///
/// # Errors
/// When the folder is missing or read-only, the target is a folder, the disk is full, or `fill`
/// fails; the error names the path and the cause.
pub fn write_atomically(
    path: impl AsRef<Path>,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Error> {
    let mut files = FileSet::new();
    files.write(path, fill)?;
    files.commit()
}

/// Files that are written together: all of them or none.
///
/// Each file is written as by [`write_atomically`], but takes its target's place only when
/// [`commit`](Self::commit) is called. A set that is dropped before leaves nothing behind.
#[derive(Default)]
pub struct FileSet {
    files: Vec<Staged>,
    notes: Vec<(String, String)>,
    watch: Option<Watch>,
}

type Watch = Box<dyn Fn(&Path, u64) -> ControlFlow<()>>;

impl FileSet {
    /// A set without files.
    pub fn new() -> Self {
        Self::default()
    }

    /// A set without files that lets `watch` follow, and end, the writing.
    ///
    /// It is called often, with the file that is being written and the bytes written to it so
    /// far; a break makes the writer fail with [`ErrorKind::Stopped`].
    pub fn watched(watch: impl Fn(&Path, u64) -> ControlFlow<()> + 'static) -> Self {
        Self { watch: Some(Box::new(watch)), ..Self::default() }
    }

    /// Has the files that are added from now on say something about what they hold, such as the
    /// seed that it grew from, if their format has a place for it: glTF files as a text below
    /// `key` in the `extras` of their `asset`, OBJ files as a comment.
    pub fn note(&mut self, key: &str, text: &str) {
        self.notes.retain(|(known, _)| known != key);
        self.notes.push((key.to_owned(), text.to_owned()));
    }

    /// What files are to say, in the order in which it was noted.
    pub(crate) fn notes(&self) -> &[(String, String)] {
        &self.notes
    }

    /// Adds a file with what `fill` produces. Its target stays as it is for now, unless it is no
    /// regular file.
    ///
    /// # Errors
    /// Those of [`write_atomically`], and when the set has this file already.
    pub fn write(
        &mut self,
        path: impl AsRef<Path>,
        fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), Error> {
        let path = path.as_ref();
        let staged = self.stage(path, fill).map_err(|cause| {
            if cause.get_ref().is_some_and(|inner| inner.is::<Stopped>()) {
                return Error::new(ErrorKind::Stopped).in_file(&path.display().to_string());
            }
            Error::write(path, cause)
        })?;
        self.files.push(staged);
        Ok(())
    }

    /// The files added so far, each with its length in bytes.
    pub fn written(&self) -> impl Iterator<Item = (&Path, u64)> {
        self.files.iter().map(|file| (file.path.as_path(), file.bytes))
    }

    /// Puts every file in its place, in the order in which they were added.
    ///
    /// Each place changes hands at once, so nobody ever sees a part of a file. Should one refuse,
    /// those before it get back what they held.
    ///
    /// # Errors
    /// When a file cannot be renamed; all targets are then as they were.
    pub fn commit(self) -> Result<(), Error> {
        let is_lone = self.files.len() == 1;
        let mut placed: Vec<Placed> = Vec::with_capacity(self.files.len());
        for Staged { path, part, .. } in self.files {
            let Some(part) = part else { continue };
            match part.place(!is_lone) {
                Ok(done) => placed.push(done),
                Err(cause) => {
                    placed.into_iter().rev().for_each(Placed::undo);
                    return Err(Error::write(&path, cause));
                }
            }
        }
        // The new names reach the disk with their folders; where folders cannot be synchronised
        // the files are in place all the same.
        let mut folders: Vec<PathBuf> =
            placed.iter().map(|placed| folder_of(&placed.target)).collect();
        folders.sort();
        folders.dedup();
        for folder in folders {
            if let Ok(folder) = File::open(folder) {
                let _ = folder.sync_all();
            }
        }
        Ok(())
    }

    /// Adds several files that belong together: should one fail, none of them is added.
    pub(crate) fn together(
        &mut self,
        add: impl FnOnce(&mut Self) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let n_before = self.files.len();
        add(self).inspect_err(|_| self.files.truncate(n_before))
    }

    fn stage(
        &self,
        path: &Path,
        fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<Staged> {
        let old = match fs::metadata(path) {
            Ok(metadata) if metadata.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
            Ok(metadata) if !metadata.is_file() => {
                let mut file = File::options().write(true).open(path)?;
                self.fill(path, &mut file, fill)?;
                // A device has no length.
                return Ok(Staged { path: path.to_owned(), bytes: 0, part: None });
            }
            Ok(metadata) => Some(metadata),
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => return Err(error),
        };
        let target = target_of(path)?;
        let twice = |file: &Staged| file.part.as_ref().is_some_and(|part| part.target == target);
        if self.files.iter().any(twice) {
            return Err(io::Error::other("it is written twice"));
        }
        let mut file = temporary(&target)?;
        let bytes = self.fill(path, file.as_file_mut(), fill)?;
        if let Some(old) = &old {
            file.as_file().set_permissions(old.permissions())?;
        }
        file.as_file().sync_all()?;
        // Closed here, for a set may have more files than a process may have open.
        let part = Part { target, file: file.into_temp_path(), old };
        Ok(Staged { path: path.to_owned(), bytes, part: Some(part) })
    }

    fn fill(
        &self,
        path: &Path,
        file: &mut File,
        fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<u64> {
        let watched = Watched { file, path, bytes: 0, watch: self.watch.as_ref() };
        let mut buffered = BufWriter::with_capacity(PIECE, watched);
        let done = fill(&mut buffered).and_then(|()| buffered.flush());
        // What failed must not be written once more when the buffer is dropped.
        let (watched, _) = buffered.into_parts();
        done.map(|()| watched.bytes)
    }
}

impl fmt::Debug for FileSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.written()).finish()
    }
}

/// A file of a set, written but for its name.
struct Staged {
    /// As the caller gave it.
    path: PathBuf,
    bytes: u64,
    /// Nothing for what was written to directly.
    part: Option<Part>,
}

/// A temporary file beside its target, written and closed.
struct Part {
    target: PathBuf,
    file: TempPath,
    /// What is known of the file that stands in the target's place.
    old: Option<Metadata>,
}

impl Part {
    /// Takes the target's place; on request what stood there can be put back.
    fn place(self, keeps_old: bool) -> io::Result<Placed> {
        let Self { target, file, old } = self;
        let kept = match old {
            Some(_) if keeps_old => Some(second_name(&target)?),
            _ => None,
        };
        file.persist(&target).map_err(|failure| failure.error)?;
        Ok(Placed { target, kept })
    }
}

/// A file of a set that took its target's place.
struct Placed {
    target: PathBuf,
    /// What stood there before, under a name of its own that goes when this is dropped.
    kept: Option<TempPath>,
}

impl Placed {
    /// Puts back what stood there, as well as that can be done.
    fn undo(self) {
        let _ = match self.kept {
            Some(kept) => kept.persist(&self.target).map_err(|failure| failure.error),
            None => fs::remove_file(&self.target),
        };
    }
}

/// A new file in the folder of `target`, with the permissions of any new file.
fn temporary(target: &Path) -> io::Result<NamedTempFile> {
    let (prefix, folder) = (hidden(target)?, folder_of(target));
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(".part");
    // Opened here, for what the builder says when it opens a file names a path that nobody knows.
    let open = |path: &Path| File::options().write(true).create_new(true).open(path);
    builder.make_in(&folder, open).map_err(|cause| match cause.kind() {
        io::ErrorKind::NotFound => {
            io::Error::new(cause.kind(), format!("there is no folder {}", folder.display()))
        }
        _ => cause,
    })
}

/// A second name for a file, or a copy of it where a file has one name only.
fn second_name(target: &Path) -> io::Result<TempPath> {
    let mut builder = tempfile::Builder::new();
    let prefix = hidden(target)?;
    builder.prefix(&prefix).suffix(".old");
    let made = builder.make_in(folder_of(target), |path| match fs::hard_link(target, path) {
        Err(cause) if cause.kind() != io::ErrorKind::AlreadyExists => {
            fs::copy(target, path).map(drop)
        }
        outcome => outcome,
    })?;
    Ok(made.into_temp_path())
}

/// The file that a rename must replace: what a link points to, not the link.
fn target_of(path: &Path) -> io::Result<PathBuf> {
    if let Ok(target) = fs::canonicalize(path) {
        return Ok(target);
    }
    let name = path.file_name().ok_or(io::ErrorKind::InvalidFilename)?;
    // Where the folder is missing, whoever makes a file in it will say so.
    let folder = folder_of(path);
    Ok(fs::canonicalize(&folder).map_or_else(|_| path.to_owned(), |folder| folder.join(name)))
}

/// How the names of hidden files begin that stand in for `target`.
fn hidden(target: &Path) -> io::Result<OsString> {
    let mut prefix = OsString::from(".");
    prefix.push(target.file_name().ok_or(io::ErrorKind::InvalidFilename)?);
    prefix.push(".");
    Ok(prefix)
}

fn folder_of(target: &Path) -> PathBuf {
    match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// A file that somebody watches being written.
struct Watched<'a> {
    file: &'a mut File,
    path: &'a Path,
    bytes: u64,
    watch: Option<&'a Watch>,
}

impl Write for Watched<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if let Some(watch) = self.watch
            && watch(self.path, self.bytes).is_break()
        {
            return Err(io::Error::other(Stopped));
        }
        let n = self.file.write(bytes)?;
        self.bytes += n as u64;
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// The watch wanted the writing to end.
#[derive(Debug)]
struct Stopped;

impl fmt::Display for Stopped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("stopped")
    }
}

impl std::error::Error for Stopped {}

#[cfg(test)]
mod tests;
