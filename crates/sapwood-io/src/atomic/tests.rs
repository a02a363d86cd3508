//! What is there after writing went well, and after it did not.

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

#[test]
fn files_of_a_set_appear_together() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("b"), "old").unwrap();
    let mut files = FileSet::new();
    files.write(at("a"), |out| out.write_all(b"one")).unwrap();
    files.write(at("b"), |out| out.write_all(b"other")).unwrap();
    assert!(!at("a").exists());
    assert_eq!(fs::read(at("b")).unwrap(), b"old");
    let lengths: Vec<_> = files.written().map(|(_, bytes)| bytes).collect();
    assert_eq!(lengths, [3, 5]);
    files.commit().unwrap();
    assert_eq!(names(folder.path()), ["a", "b"]);
    assert_eq!(fs::read(at("b")).unwrap(), b"other");
}

#[test]
fn a_set_that_is_dropped_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = FileSet::new();
    files.write(folder.path().join("a"), |out| out.write_all(b"one")).unwrap();
    let error = files.write(folder.path().join("no/b"), |_| Ok(())).unwrap_err();
    assert_eq!(cause(&error), io::ErrorKind::NotFound);
    drop(files);
    assert!(names(folder.path()).is_empty());
}

#[test]
fn where_one_place_refuses_the_others_get_back_what_they_held() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("b"), "old").unwrap();
    let mut files = FileSet::new();
    for name in ["a", "b", "c"] {
        files.write(at(name), |out| out.write_all(b"new")).unwrap();
    }
    // Nothing can be renamed onto a folder.
    fs::create_dir(at("c")).unwrap();
    let error = files.commit().unwrap_err();
    assert!(error.file().is_some_and(|file| file.ends_with("c")), "{error}");
    assert_eq!(names(folder.path()), ["b", "c"]);
    assert_eq!(fs::read(at("b")).unwrap(), b"old");
}

#[cfg(target_os = "linux")]
#[test]
fn a_set_of_many_files_does_not_run_out_of_descriptors() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = FileSet::new();
    for i in 0..20 {
        files.write(folder.path().join(format!("{i}")), |out| out.write_all(b"x")).unwrap();
    }
    let open = fs::read_dir("/proc/self/fd").unwrap();
    let targets = open.filter_map(|entry| fs::read_link(entry.ok()?.path()).ok());
    let held: Vec<_> = targets.filter(|target| target.starts_with(folder.path())).collect();
    assert!(held.is_empty(), "{held:?}");
    files.commit().unwrap();
    assert_eq!(names(folder.path()).len(), 20);
}

#[test]
fn a_file_is_in_a_set_once() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("in")).unwrap();
    let mut files = FileSet::new();
    files.write(folder.path().join("a"), |_| Ok(())).unwrap();
    let error = files.write(folder.path().join("in/../a"), |_| Ok(())).unwrap_err();
    assert!(error.to_string().ends_with("it is written twice"), "{error}");
}

#[test]
fn a_watch_follows_the_writing_and_ends_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    let mut files = FileSet::watched(|_, bytes| {
        if bytes >= 1 << 20 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    let fill = |out: &mut dyn Write| (0..1000).try_for_each(|_| out.write_all(&[7; 4096]));
    let error = files.write(&path, fill).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::Stopped), "{error}");
    assert!(files.written().next().is_none());
    assert!(names(folder.path()).is_empty());
}
