//! References: what stands at a URI of a model file, or at a path that it names. Nothing outside
//! the file's folder is opened.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, Read as _};
use std::path::{Component, Path, PathBuf};

use data_url::DataUrl;
use percent_encoding::percent_decode_str;

use super::document::invalid;
use super::schema::quoted;
use crate::{Error, ErrorKind};

const ACCEPTED: &str = "the relative path of a file in the folder of the model, or a data URI";
const ACCEPTED_PATH: &str = "the relative path of a file in the folder of the model";

/// The folder of a model, and how many bytes may still be read from it.
pub(crate) struct Folder {
    /// With no symbolic links in it; nothing where there is no folder.
    path: Option<PathBuf>,
    limit: u64,
    left: u64,
    files: BTreeSet<PathBuf>,
}

impl Folder {
    /// The folder of the file at `model`, of which `read` bytes of at most `limit` were read
    /// already.
    pub(crate) fn of(model: Option<&Path>, read: u64, limit: u64) -> Self {
        let folder = model.map(|model| match model.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        });
        let path = folder.and_then(|folder| folder.canonicalize().ok());
        Self { path, limit, left: limit.saturating_sub(read), files: BTreeSet::new() }
    }

    /// The bytes that `uri`, which stands at the place `at`, refers to.
    pub(crate) fn read(&mut self, uri: &str, at: &str) -> Result<Vec<u8>, Error> {
        let bytes = match uri.get(..5) {
            Some(scheme) if scheme.eq_ignore_ascii_case("data:") => self.data(uri, at)?,
            _ => self.file(uri, relative(uri), (at, ACCEPTED))?,
        };
        self.left -= bytes.len() as u64;
        Ok(bytes)
    }

    /// The bytes of the file at `path`, which stands as it is at the place `at`: with `/` or `\`
    /// between its parts, and nothing encoded.
    pub(crate) fn read_path(&mut self, path: &str, at: &str) -> Result<Vec<u8>, Error> {
        let inside = relative_path(&path.replace('\\', "/"));
        let bytes = self.file(path, inside, (at, ACCEPTED_PATH))?;
        self.left -= bytes.len() as u64;
        Ok(bytes)
    }

    /// How many bytes were read, those of the model itself included.
    pub(super) fn n_read(&self) -> u64 {
        self.limit - self.left
    }

    /// The files that were read, each once, with no symbolic links in their paths.
    pub(super) fn into_files(self) -> BTreeSet<PathBuf> {
        self.files
    }

    fn data(&self, uri: &str, at: &str) -> Result<Vec<u8>, Error> {
        let broken = |why: &str| {
            let found = format!("the data URI {} {why}", quoted(&uri[..floor(uri, 40)]));
            invalid(at, found, "a data URI in Base64")
        };
        let data = DataUrl::process(uri).map_err(|_| broken("has no comma"))?;
        let (bytes, _) = data.decode_to_vec().map_err(|_| broken("is not valid Base64"))?;
        match bytes.len() as u64 <= self.left {
            true => Ok(bytes),
            false => Err(self.over(at, bytes.len() as u64)),
        }
    }

    /// The bytes of the file that `name` stands for, which is `inside` the folder.
    fn file(
        &mut self,
        name: &str,
        inside: Result<PathBuf, &'static str>,
        (at, accepted): (&str, &str),
    ) -> Result<Vec<u8>, Error> {
        let Some(folder) = &self.path else {
            return Err(invalid(at, "the model has no folder", "a data URI"));
        };
        let inside =
            inside.map_err(|why| invalid(at, format!("{} {why}", quoted(name)), accepted))?;
        let unreadable =
            |cause: io::Error| invalid(at, format!("{} cannot be read: {cause}", quoted(name)), "");
        // Resolving links opens nothing.
        let path = folder.join(inside).canonicalize().map_err(unreadable)?;
        if !path.starts_with(folder) {
            let found = format!("{} is a link out of the folder", quoted(name));
            return Err(invalid(at, found, accepted));
        }
        let metadata = path.metadata().map_err(unreadable)?;
        if !metadata.is_file() {
            return Err(invalid(at, format!("{} is no file", quoted(name)), accepted));
        }
        if metadata.len() > self.left {
            return Err(self.over(at, metadata.len()));
        }
        let mut bytes = Vec::with_capacity(metadata.len() as usize);
        let file = File::open(&path).map_err(unreadable)?;
        file.take(self.left + 1).read_to_end(&mut bytes).map_err(unreadable)?;
        if bytes.len() as u64 > self.left {
            return Err(self.over(at, bytes.len() as u64));
        }
        self.files.insert(path);
        Ok(bytes)
    }

    fn over(&self, at: &str, more: u64) -> Error {
        let found = (self.limit - self.left).saturating_add(more);
        let (at, what) = (at.to_owned(), "bytes in all files together");
        Error::new(ErrorKind::OverLimit { at, found, what, limit: self.limit })
    }
}

/// The path that a relative URI stands for, or why it stands for none that is followed.
fn relative(uri: &str) -> Result<PathBuf, &'static str> {
    let scheme = uri.split(['/', '?', '#']).next().unwrap_or_default();
    if scheme.contains(':') {
        return Err("is no relative path");
    }
    let path = percent_decode_str(uri).decode_utf8().map_err(|_| "is no UTF-8 text")?;
    relative_path(&path)
}

/// The path that a text with `/` between its parts is, or why it is none that is followed.
fn relative_path(path: &str) -> Result<PathBuf, &'static str> {
    if path.is_empty() {
        return Err("is no path");
    }
    if path.chars().any(|c| c.is_control() || c == '\\' || c == ':') {
        return Err("has characters that no path should have");
    }
    let mut inside = PathBuf::new();
    for component in Path::new(path).components() {
        match component {
            Component::Normal(name) => inside.push(name),
            Component::CurDir => {}
            Component::ParentDir => return Err("leads out of the folder"),
            Component::RootDir | Component::Prefix(_) => return Err("is no relative path"),
        }
    }
    Ok(inside)
}

/// The largest length up to `most` at which `text` may be cut.
fn floor(text: &str, most: usize) -> usize {
    (0..=most.min(text.len())).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_paths_downwards_are_followed() {
        for (uri, expected) in [
            ("a.bin", Ok("a.bin")),
            ("./a%20b/c.png", Ok("a b/c.png")),
            ("100%.png", Ok("100%.png")),
            ("../a", Err("leads out of the folder")),
            ("b/../../a", Err("leads out of the folder")),
            ("%2e%2E/a", Err("leads out of the folder")),
            ("..%2fa", Err("leads out of the folder")),
            ("..\\a", Err("has characters that no path should have")),
            ("%5c%5cserver%5cshare", Err("has characters that no path should have")),
            ("/etc/passwd", Err("is no relative path")),
            ("%2fetc/passwd", Err("is no relative path")),
            ("//server/share", Err("is no relative path")),
            ("file:///etc/passwd", Err("is no relative path")),
            ("http://127.0.0.1/a", Err("is no relative path")),
            ("C:/a", Err("is no relative path")),
            ("C%3a/a", Err("has characters that no path should have")),
            ("a%00.png", Err("has characters that no path should have")),
            ("a%ff", Err("is no UTF-8 text")),
            ("", Err("is no path")),
        ] {
            assert_eq!(relative(uri), expected.map(PathBuf::from), "{uri}");
        }
    }

    #[test]
    fn paths_are_taken_as_they_are() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("b")).unwrap();
        for name in ["a%20b.png", "a b#c?.png", "b/c.png"] {
            std::fs::write(folder.path().join(name), name).unwrap();
        }
        let mut inside = Folder::of(Some(&folder.path().join("b.obj")), 0, 100);
        let mut read = |path: &str| {
            let bytes = inside.read_path(path, "map");
            bytes.map(|bytes| String::from_utf8(bytes).unwrap()).map_err(|error| error.to_string())
        };
        for name in ["a%20b.png", "a b#c?.png", "b/c.png"] {
            assert_eq!(read(name).unwrap(), name);
        }
        assert_eq!(read(".\\b\\c.png").unwrap(), "b/c.png");
        for (path, why) in [
            ("..\\a", "leads out of the folder"),
            ("b/../../a", "leads out of the folder"),
            ("\\\\server\\share", "is no relative path"),
            ("/etc/passwd", "is no relative path"),
            ("C:\\a", "has characters that no path should have"),
            ("data:,a", "has characters that no path should have"),
            ("%2e%2e/a", "cannot be read"),
            ("", "is no path"),
            ("b", "is no file"),
        ] {
            let told = read(path).unwrap_err();
            assert!(told.contains(why) && !told.contains("data URI"), "{path}: {told}");
        }
        // What was read counts.
        assert!(
            Folder::of(Some(&folder.path().join("b.obj")), 94, 100)
                .read_path("b/c.png", "")
                .is_err()
        );
        assert_eq!(inside.n_read(), 9 + 10 + 7 + 7);
    }
}
