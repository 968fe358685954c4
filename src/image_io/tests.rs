use std::fs;
use std::path::{Path, PathBuf};

use crate::color::Rgb;

use super::format::FileFormat;
use super::{ImageWriter, Picture};

/// A picture with values typical of a render.
pub(super) fn picture() -> Picture {
    let (width, height) = (13, 5);
    let layer = |scale: f32| {
        (0..width * height)
            .map(|i| Rgb::new(i as f32, 0.3 + (i % 7) as f32, 1e-3) * scale)
            .collect()
    };
    Picture { width, height, direct: layer(0.013), indirect: layer(0.37), ..Picture::default() }
}

/// Writes the picture into a temporary folder; returns the folder and the file's path.
pub(super) fn written(picture: &Picture, name: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    ImageWriter::new(&path).unwrap().write(picture).unwrap();
    assert_eq!(names(folder.path()), [name]);
    (folder, path)
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn another_extension_is_refused_with_the_list() {
    for name in ["a.bmp", "a", "png", ".png", "a.PNG.txt"] {
        let error = ImageWriter::new(Path::new(name)).unwrap_err();
        let expected = format!("`{name}` does not end in .png, .exr, .hdr or .pfm");
        assert_eq!(error.to_string(), expected);
    }
    assert_eq!(FileFormat::from_path(Path::new("a.b.ExR")).unwrap(), FileFormat::Exr);
}

#[test]
fn places_that_cannot_be_written_are_refused_before_rendering() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| ImageWriter::new(&folder.path().join(name)).unwrap_err().to_string();
    assert!(at("missing/a.png").ends_with("missing` does not exist"), "{}", at("missing/a.png"));
    fs::create_dir(folder.path().join("a.png")).unwrap();
    assert!(at("a.png").ends_with("it is a folder"));
    fs::write(folder.path().join("file"), "").unwrap();
    let inside_a_file = at("file/a.png");
    assert!(inside_a_file.contains("nothing can be created in"), "{inside_a_file}");
    assert!(inside_a_file.ends_with("(Not a directory (os error 20))"), "{inside_a_file}");
    assert_eq!(names(folder.path()), ["a.png", "file"]);
}

#[test]
fn a_failed_write_leaves_the_old_file_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    fs::write(&path, "old").unwrap();
    drop(ImageWriter::new(&path).unwrap());
    assert_eq!(fs::read(&path).unwrap(), b"old");

    // A folder created under the target's name during the render makes the rename fail.
    let target = ImageWriter::new(&path).unwrap();
    fs::remove_file(&path).unwrap();
    fs::create_dir(&path).unwrap();
    let error = target.write(&picture()).unwrap_err().to_string();
    assert!(error.starts_with("cannot write `") && error.contains("a.png`: "), "{error}");
    assert_eq!(names(folder.path()), ["a.png"]);
}

#[cfg(unix)]
#[test]
fn the_file_has_the_permissions_of_any_new_file_and_links_are_followed() {
    use std::os::unix::fs::PermissionsExt;
    let (folder, path) = written(&picture(), "a.pfm");
    let beside = folder.path().join("any");
    fs::write(&beside, "").unwrap();
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&path), mode(&beside));

    let link = folder.path().join("link.pfm");
    std::os::unix::fs::symlink("any", &link).unwrap();
    ImageWriter::new(&link).unwrap().write(&picture()).unwrap();
    assert!(link.is_symlink());

    let dangling = folder.path().join("dangling.pfm");
    std::os::unix::fs::symlink("nowhere", &dangling).unwrap();
    let error = ImageWriter::new(&dangling).unwrap_err().to_string();
    assert!(error.contains("it is a link to `nowhere`, which cannot be reached ("), "{error}");
    assert_eq!(fs::read(&beside).unwrap(), fs::read(&path).unwrap());
}
