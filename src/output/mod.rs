//! Pictures become files, whole or not at all.
//!
//! A [`Target`] is made before any rendering: it refuses a place that cannot be written to while
//! that costs nobody an hour. The picture goes into a temporary file beside the target, which takes
//! the target's name only once every byte is on the disk, so an earlier picture of that name is
//! replaced whole or stays as it was.
//!
//! Values that are not finite are written as they are where the format can hold them (`.exr`,
//! `.pfm`). The others show them: not-a-number becomes magenta, infinity the brightest value. They
//! are never made black; [`Picture::non_finite`] counts them for the caller to report.

mod exr;
mod hdr;
mod pfm;
mod png;

use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::color::Rgb;
use crate::error::{Error, Result};
use crate::film::Picture;

/// What the writers write to.
type Sink<'a> = BufWriter<&'a mut File>;

/// A place where a picture can be written: the folder is there and lets us in.
#[derive(Debug)]
pub struct Target {
    path: PathBuf,
    format: Format,
    temporary: NamedTempFile,
}

/// The file formats, by their extensions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Png,
    Exr,
    Hdr,
    Pfm,
}

impl Target {
    /// Prepares to write `path`. Its extension, in any case, chooses the format: `.png` (sRGB, 8
    /// bit), or linear radiance as `.exr` (32-bit float with the layers `direct` and `indirect`),
    /// `.hdr` (RGBE) or `.pfm` (32-bit float).
    ///
    /// # Errors
    /// When the extension is another one, when `path` is a folder, or when its folder is missing or
    /// cannot be written to.
    pub fn new(path: &Path) -> Result<Self> {
        let refused = |reason: &str| Error::file("write", path, reason);
        if path.is_dir() {
            let example = path.join("picture.png");
            return Err(refused("it is a folder")
                .with_help(format!("name a file in it, such as `{}`", example.display())));
        }
        let format = Format::of(path)?;
        if path.exists() && !path.is_file() {
            return Err(refused("it is not a regular file"));
        }
        let path = end_of_link(path)?;
        let temporary = create_beside(&path)?;
        Ok(Self { path, format, temporary })
    }

    /// The unfinished file. It disappears with this target; a program that is about to die without
    /// cleaning up may remove it.
    pub fn temporary(&self) -> &Path {
        self.temporary.path()
    }

    /// Writes the picture and gives the file its name.
    ///
    /// # Errors
    /// When the disk refuses; a file that was there before is then unchanged, and nothing else is
    /// left behind.
    pub fn write(mut self, picture: &Picture) -> Result<()> {
        let failed = |e: io::Error| Error::file("write", &self.path, e);
        let mut sink = BufWriter::new(self.temporary.as_file_mut());
        match self.format {
            Format::Png => png::write(picture, &mut sink),
            Format::Exr => exr::write(picture, &mut sink),
            Format::Hdr => hdr::write(picture, &mut sink),
            Format::Pfm => pfm::write(picture, &mut sink),
        }
        .map_err(failed)?;
        sink.into_inner().map_err(|e| failed(e.into_error()))?.sync_all().map_err(failed)?;
        self.temporary.persist(&self.path).map_err(|e| failed(e.error))?;
        Ok(())
    }
}

impl Format {
    fn of(path: &Path) -> Result<Self> {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        match extension.to_str() {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            Some("hdr") => Ok(Self::Hdr),
            Some("pfm") => Ok(Self::Pfm),
            _ => Err(Error::input(format!(
                "`{}` does not end in .png, .exr, .hdr or .pfm",
                path.display()
            ))
            .with_help(
                "the ending chooses the format: .png for the screen (sRGB, 8 bit), .exr for linear \
                 light with its layers, .hdr or .pfm for linear light",
            )),
        }
    }
}

/// The file that a symbolic link means, so that writing replaces that and keeps the link.
fn end_of_link(path: &Path) -> Result<PathBuf> {
    let Ok(link) = fs::read_link(path) else {
        return Ok(path.to_path_buf());
    };
    fs::canonicalize(path).map_err(|e| {
        let reason = format!("it is a link to `{}`, which cannot be reached ({e})", link.display());
        Error::file("write", path, reason).with_help("remove the link, or name another file")
    })
}

/// Creates the temporary file in the folder of `path`, with the permissions of any new file (by
/// default the library makes it private).
fn create_beside(path: &Path) -> Result<NamedTempFile> {
    let refused = |reason: String| Error::file("write", path, reason);
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let shown = folder.display();
    if !folder.exists() {
        return Err(refused(format!("the folder `{shown}` does not exist"))
            .with_help(format!("create it first: mkdir -p '{shown}'")));
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".photosphere-").suffix(".tmp");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder
        .tempfile_in(folder)
        .map_err(|e| refused(format!("nothing can be created in `{shown}` ({})", system_words(&e))))
}

/// The system's own words, without the name of the temporary file that tempfile adds behind them.
fn system_words(error: &io::Error) -> String {
    let words = error.to_string();
    words.split(" at path ").next().unwrap_or_default().to_owned()
}

/// The beauty of a pixel for a format that knows no infinity and no not-a-number.
fn finite_beauty(picture: &Picture, pixel: usize) -> Rgb {
    let beauty = picture.beauty(pixel);
    if beauty.is_nan() {
        return Rgb::new(1.0, 0.0, 1.0);
    }
    beauty.clamp(Rgb::splat(f32::MIN), Rgb::splat(f32::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture with every kind of value that a render can give.
    pub(super) fn picture() -> Picture {
        let (width, height) = (13, 5);
        let layer = |scale: f32| {
            (0..width * height)
                .map(|i| Rgb::new(i as f32, 0.3 + (i % 7) as f32, 1e-3) * scale)
                .collect()
        };
        Picture { width, height, direct: layer(0.013), indirect: layer(0.37) }
    }

    /// Writes the picture in a folder of its own and returns that and the file's path.
    pub(super) fn written(picture: &Picture, name: &str) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        Target::new(&path).unwrap().write(picture).unwrap();
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
            let error = Target::new(Path::new(name)).unwrap_err();
            let expected = format!("`{name}` does not end in .png, .exr, .hdr or .pfm");
            assert_eq!(error.to_string(), expected);
        }
        assert_eq!(Format::of(Path::new("a.b.ExR")).unwrap(), Format::Exr);
    }

    #[test]
    fn places_that_cannot_be_written_are_refused_before_rendering() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| Target::new(&folder.path().join(name)).unwrap_err().to_string();
        assert!(
            at("missing/a.png").ends_with("missing` does not exist"),
            "{}",
            at("missing/a.png")
        );
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
        drop(Target::new(&path).unwrap());
        assert_eq!(fs::read(&path).unwrap(), b"old");

        // A folder that takes the name while we render makes the rename fail.
        let target = Target::new(&path).unwrap();
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
        Target::new(&link).unwrap().write(&picture()).unwrap();
        assert!(link.is_symlink());

        let dangling = folder.path().join("dangling.pfm");
        std::os::unix::fs::symlink("nowhere", &dangling).unwrap();
        let error = Target::new(&dangling).unwrap_err().to_string();
        assert!(error.contains("it is a link to `nowhere`, which cannot be reached ("), "{error}");
        assert_eq!(fs::read(&beside).unwrap(), fs::read(&path).unwrap());
    }
}
