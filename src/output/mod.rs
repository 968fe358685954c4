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
mod read;
mod records;
mod whole;

use std::path::Path;

use crate::color::{Look, Rgb};
use crate::error::{Error, Result};
use crate::film::Picture;

pub use read::{BEAUTY, Layer, Layered, RawChannel, raw_channels, read};
pub use records::{Record, records};
pub use whole::{Sink, WholeFile, remove_unfinished};

/// A place where a picture can be written: the folder is there and lets us in.
#[derive(Debug)]
pub struct Target {
    file: WholeFile,
    format: Format,
}

/// The file formats, by their extensions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Png,
    Exr,
    Hdr,
    Pfm,
}

/// What a file can say of a picture beside its pixels.
#[derive(Clone, Debug, Default)]
pub struct Notes {
    /// Which part of a larger picture this is; an EXR file places it there.
    pub cropped_from: Option<Crop>,
    /// How a PNG file shows it.
    pub look: Look,
    /// How it was made, in PNG and EXR files.
    pub records: Vec<Record>,
    /// Whether the file is wanted soon rather than small: it is then compressed less, and left to the
    /// system to be brought to the disk.
    pub quickly: bool,
}

/// The place of a part in a larger picture.
#[derive(Clone, Copy, Debug)]
pub struct Crop {
    /// Pixels of the larger picture, across and down.
    pub full_size: [usize; 2],
    /// Column and row there of the part's upper left pixel.
    pub corner: [usize; 2],
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
        whole::refuse_folder(path, "picture.png")?;
        let format = Format::of(path)?;
        Ok(Self { file: WholeFile::new(path)?, format })
    }

    /// Whether the file has layers.
    pub fn has_layers(&self) -> bool {
        self.format == Format::Exr
    }

    /// Whether the file is for the screen, and so has a [`Look`].
    pub fn is_for_screen(&self) -> bool {
        self.format == Format::Png
    }

    /// Writes the picture, whole, as often as one likes, and gives the file its name.
    ///
    /// # Errors
    /// When the disk refuses; a file that was there before is then unchanged, and nothing else is
    /// left behind.
    pub fn write(&self, picture: &Picture) -> Result<()> {
        self.write_with(picture, &Notes::default())
    }

    /// The same with notes, as far as the format has a place for them.
    ///
    /// # Errors
    /// Like [`Self::write`].
    pub fn write_with(&self, picture: &Picture, notes: &Notes) -> Result<()> {
        let content = |sink: &mut Sink<'_>| match self.format {
            Format::Png => png::write(picture, notes, sink),
            Format::Exr => exr::write(picture, notes, sink),
            Format::Hdr => hdr::write(picture, sink),
            Format::Pfm => pfm::write(picture, sink),
        };
        match notes.quickly {
            true => self.file.write_unsynced(content),
            false => self.file.write(content),
        }
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
    use std::fs;
    use std::path::PathBuf;

    /// A picture with every kind of value that a render can give.
    pub(super) fn picture() -> Picture {
        let (width, height) = (13, 5);
        let layer = |scale: f32| {
            (0..width * height)
                .map(|i| Rgb::new(i as f32, 0.3 + (i % 7) as f32, 1e-3) * scale)
                .collect()
        };
        Picture { width, height, direct: layer(0.013), indirect: layer(0.37), ..Picture::default() }
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
