//! Writing a file whole or not at all.
//!
//! The bytes go to a temporary file in the folder of the target, which takes the target's place
//! only when everything is written and on the disk. What goes into the file is the caller's.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::Error;

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
    let path = path.as_ref();
    write_whole(path, fill).map_err(|cause| Error::write(path, cause))
}

fn write_whole(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let old = match fs::metadata(path) {
        Ok(metadata) if metadata.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
        Ok(metadata) if !metadata.is_file() => {
            return fill_buffered(&mut File::options().write(true).open(path)?, fill);
        }
        Ok(metadata) => Some(metadata),
        Err(error) if error.kind() == io::ErrorKind::NotFound => None,
        Err(error) => return Err(error),
    };
    // The rename must replace the file that a link points to, not the link.
    let target = if old.is_some() { fs::canonicalize(path)? } else { path.to_owned() };
    let name = target.file_name().ok_or(io::ErrorKind::InvalidFilename)?;
    let folder = folder_of(&target);

    let mut prefix = std::ffi::OsString::from(".");
    prefix.push(name);
    prefix.push(".");
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        // Less the process's own mask, as for any new file; the default would be private.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut part = builder.tempfile_in(&folder).map_err(|cause| match cause.kind() {
        io::ErrorKind::NotFound => {
            io::Error::new(cause.kind(), format!("there is no folder {}", folder.display()))
        }
        // The bare kind, for the cause names a temporary file that nobody knows.
        kind => kind.into(),
    })?;
    fill_buffered(part.as_file_mut(), fill)?;
    if let Some(old) = old {
        part.as_file().set_permissions(old.permissions())?;
    }
    part.as_file().sync_all()?;
    part.persist(&target).map_err(|failure| failure.error)?;
    // The new name reaches the disk with the folder; where folders cannot be synchronised the
    // file is in place all the same.
    if let Ok(folder) = File::open(&folder) {
        let _ = folder.sync_all();
    }
    Ok(())
}

fn fill_buffered(
    file: &mut File,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut buffered = BufWriter::with_capacity(1 << 16, file);
    fill(&mut buffered)?;
    buffered.flush()
}

fn folder_of(target: &Path) -> PathBuf {
    match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ErrorKind;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    fn cause(error: &Error) -> io::ErrorKind {
        match error.kind() {
            ErrorKind::Write { cause } => cause.kind(),
            other => panic!("{other}"),
        }
    }

    #[test]
    fn a_file_is_written_and_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_atomically(&path, |out| out.write_all(b"one")).unwrap();
        write_atomically(&path, |out| out.write_all(b"two")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[test]
    fn a_writer_that_fails_midway_leaves_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        fs::write(&path, "old").unwrap();
        let error = write_atomically(&path, |out| {
            out.write_all(&vec![7; 1 << 20])?;
            Err(io::ErrorKind::StorageFull.into())
        })
        .unwrap_err();
        assert_eq!(cause(&error), io::ErrorKind::StorageFull);
        assert!(error.to_string().starts_with(&path.display().to_string()), "{error}");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[test]
    fn a_panicking_writer_leaves_no_temporary_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        let write = || write_atomically(&path, |_| panic!("on purpose"));
        assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(write)).is_err());
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn a_missing_folder_and_a_folder_as_target_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("no/such/a.txt");
        let error = write_atomically(&missing, |out| out.write_all(b"x")).unwrap_err();
        assert_eq!(cause(&error), io::ErrorKind::NotFound);
        assert!(error.to_string().contains("cannot be written: there is no folder "), "{error}");
        let error = write_atomically(folder.path(), |out| out.write_all(b"x")).unwrap_err();
        assert_eq!(cause(&error), io::ErrorKind::IsADirectory);
        let error = write_atomically("", |out| out.write_all(b"x")).unwrap_err();
        assert!(error.is_write());
        assert!(names(folder.path()).is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn a_read_only_folder_is_refused() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        fs::write(&path, "old").unwrap();
        fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o555)).unwrap();
        if File::create(folder.path().join("probe")).is_ok() {
            println!("skipped: this user may write to read-only folders");
            return;
        }
        let error = write_atomically(&path, |out| out.write_all(b"new")).unwrap_err();
        assert_eq!(cause(&error), io::ErrorKind::PermissionDenied);
        assert_eq!(fs::read(&path).unwrap(), b"old");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_device_is_reported_and_not_replaced() {
        let error = write_atomically("/dev/full", |out| out.write_all(&[0; 4096])).unwrap_err();
        assert_eq!(cause(&error), io::ErrorKind::StorageFull);
        write_atomically("/dev/null", |out| out.write_all(b"x")).unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_permissions_kept() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        let (path, link) = (folder.path().join("a.txt"), folder.path().join("link"));
        fs::write(&path, "old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        std::os::unix::fs::symlink(&path, &link).unwrap();
        write_atomically(&link, |out| out.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    }
}
