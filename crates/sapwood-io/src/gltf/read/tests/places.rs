//! Where files may lie: nothing outside the folder of a model is read.

use super::*;

#[test]
fn nothing_outside_the_folder_is_read() {
    let outside = tempfile::tempdir().unwrap();
    let folder = outside.path().join("model");
    std::fs::create_dir_all(folder.join("inside")).unwrap();
    let (mut document, bin) = triangle();
    std::fs::write(outside.path().join("a.bin"), &bin).unwrap();
    std::fs::write(folder.join("inside/a b.bin"), &bin).unwrap();
    let path = folder.join("model.gltf");
    let mut read_with = |uri: &str| {
        set(&mut document, "/buffers/0/uri", json!(uri));
        std::fs::write(&path, document.to_string()).unwrap();
        read_gltf(&path, &ReadLimits::default()).map_err(|error| error.to_string())
    };
    assert_eq!(only_mesh(&read_with("inside/a%20b.bin").unwrap()).n_triangles(), 1);
    assert_eq!(only_mesh(&read_with("./inside/a b.bin").unwrap()).n_triangles(), 1);
    let read = read_with("./inside/a b.bin").unwrap().files;
    let real = folder.canonicalize().unwrap();
    assert_eq!(read, [real.join("model.gltf"), real.join("inside").join("a b.bin")]);
    let absolute = outside.path().join("a.bin").display().to_string();
    let at = format!("{}: buffers[0].uri: ", folder.join("model.gltf").display());
    let accepted = "(accepted: the relative path of a file in the folder of the model, or a data \
                    URI)";
    for (uri, why) in [
        ("../a.bin", "leads out of the folder"),
        ("inside/../../a.bin", "leads out of the folder"),
        ("%2e%2e/a.bin", "leads out of the folder"),
        (&absolute, "is no relative path"),
        (&format!("file://{absolute}"), "is no relative path"),
        ("http://127.0.0.1:1/a.bin", "is no relative path"),
        ("..\\a.bin", "has characters that no path should have"),
        ("inside", "is no file"),
        (".", "is no file"),
    ] {
        let error = read_with(uri).unwrap_err();
        assert_eq!(error, format!("{at}{} {why} {accepted}", schema::quoted(uri)));
    }
    let error = read_with("missing.bin").unwrap_err();
    let told = "\"missing.bin\" cannot be read: No such file or directory (os error 2)";
    assert!(!cfg!(target_os = "linux") || error == format!("{at}{told}"), "{error}");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(outside.path().join("a.bin"), folder.join("link.bin")).unwrap();
        std::os::unix::fs::symlink("inside/a b.bin", folder.join("good.bin")).unwrap();
        std::os::unix::fs::symlink(outside.path(), folder.join("up")).unwrap();
        std::os::unix::fs::symlink("/dev/zero", folder.join("zero.bin")).unwrap();
        for uri in ["link.bin", "up/a.bin", "zero.bin"] {
            let error = read_with(uri).unwrap_err();
            assert_eq!(error, format!("{at}\"{uri}\" is a link out of the folder {accepted}"));
        }
        assert_eq!(only_mesh(&read_with("good.bin").unwrap()).n_triangles(), 1);
    }
    // All files together are limited.
    let text =
        read_with("inside/a b.bin").map(|_| std::fs::metadata(&path).unwrap().len()).unwrap();
    let limits = ReadLimits { bytes: text + 43, ..ReadLimits::default() };
    let error = read_gltf(&path, &limits).unwrap_err().to_string();
    let told =
        format!("{at}{} bytes in all files together; at most {} are read", text + 44, text + 43);
    assert_eq!(error, told);
}

#[test]
fn a_file_that_cannot_be_opened_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("none.glb");
    let error = read_gltf(&path, &ReadLimits::default()).unwrap_err().to_string();
    assert!(error.starts_with(&format!("{}: cannot be read: ", path.display())), "{error}");
    let error = read_gltf(folder.path(), &ReadLimits::default()).unwrap_err().to_string();
    assert!(error.contains(": cannot be read: "), "{error}");
}
