//! A document as a text and a buffer beside it.

use std::io;
use std::path::{Path, PathBuf};

use super::document::Document;
use crate::{Error, FileSet};

/// Where [`write_gltf`](crate::write_gltf) puts everything that is not text: beside the file at
/// `path`, with the ending `.bin`.
pub fn gltf_buffer_path(path: impl AsRef<Path>) -> PathBuf {
    path.as_ref().with_extension("bin")
}

/// Adds both files. The buffer takes its place first: a text never waits for its buffer.
pub(super) fn add(files: &mut FileSet, path: &Path, document: Document) -> Result<(), Error> {
    let Document { mut root, bin } = document;
    if let Some(bin) = bin {
        let bin_path = gltf_buffer_path(path);
        let name = bin_path.file_name().and_then(|name| name.to_str());
        let name = name.ok_or_else(|| Error::write(path, io::ErrorKind::InvalidFilename.into()))?;
        root.buffers[0].uri = Some(percent_encoded(name));
        files.write(&bin_path, |out| out.write_all(&bin))?;
    }
    files.write(path, |out| {
        root.to_writer_pretty(&mut *out)?;
        out.write_all(b"\n")
    })
}

/// A file's name as a relative reference of RFC 3986: only what it calls unreserved stays.
fn percent_encoded(name: &str) -> String {
    const DIGITS: [char; 16] =
        ['0', '1', '2', '3', '4', '5', '6', '7', '8', '9', 'A', 'B', 'C', 'D', 'E', 'F'];
    let mut text = String::with_capacity(name.len());
    for byte in name.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~".contains(&byte) {
            text.push(char::from(byte));
        } else {
            text.extend(['%', DIGITS[usize::from(byte >> 4)], DIGITS[usize::from(byte & 15)]]);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_encoded_by_bytes() {
        assert_eq!(percent_encoded("tree_v1.2~a-b.bin"), "tree_v1.2~a-b.bin");
        assert_eq!(percent_encoded("a b%c#d?.bin"), "a%20b%25c%23d%3F.bin");
        assert_eq!(percent_encoded("\u{fc}:.bin"), "%C3%BC%3A.bin");
    }
}
