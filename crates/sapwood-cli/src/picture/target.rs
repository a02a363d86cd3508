//! The files that pictures go to: how they are called where there are several, and whether they
//! can be written at all, which had better be known before long work.

use std::fs;
use std::path::{Path, PathBuf};

use sapwood::io::FileSet;

use crate::failure::Failure;

/// The files of a picture: the path itself, or where the scene is turned NAME-000.png and so on.
pub(crate) fn names(path: &Path, turns: Option<u32>) -> impl Iterator<Item = PathBuf> + '_ {
    let (stem, ending) = (path.file_stem().unwrap_or_default(), path.extension());
    let numbered = move |number: u32| {
        let mut name = stem.to_owned();
        name.push(format!("-{number:03}"));
        if let Some(ending) = ending {
            name.push(".");
            name.push(ending);
        }
        path.with_file_name(name)
    };
    (0..turns.unwrap_or(1)).map(move |number| match turns {
        None => path.to_owned(),
        Some(_) => numbered(number),
    })
}

/// Fails as writing to one of these files would, as far as that shows beforehand; all stay as
/// they are.
pub(crate) fn check_targets(paths: impl IntoIterator<Item = PathBuf>) -> Result<(), Failure> {
    for path in paths {
        // To open a pipe may have an effect on who reads it.
        let is_special = fs::metadata(&path).is_ok_and(|old| !old.is_file() && !old.is_dir());
        if !is_special {
            FileSet::new().write(&path, |_| Ok(()))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turned_pictures_are_numbered() {
        let named = |path, turns| -> Vec<_> { names(Path::new(path), turns).collect() };
        assert_eq!(named("a/b.png", None), [Path::new("a/b.png")]);
        assert_eq!(named("a/b.png", Some(1)), [Path::new("a/b-000.png")]);
        let many = named("b.v2.PNG", Some(1000));
        assert_eq!(many.last().unwrap(), Path::new("b.v2-999.PNG"));
    }

    #[test]
    fn targets_are_left_as_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("old.png"), "old").unwrap();
        fs::create_dir(at("folder.png")).unwrap();
        check_targets([at("old.png"), at("new.png")]).unwrap();
        assert_eq!(fs::read(at("old.png")).unwrap(), b"old");
        assert!(!at("new.png").exists());
        for wrong in ["folder.png", "no/new.png"] {
            let failure = format!("{:?}", check_targets([at(wrong)]).unwrap_err());
            assert!(failure.contains("code: 3") && failure.contains("cannot be written"));
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }
}
