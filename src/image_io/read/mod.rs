//! Reads pictures from files, our own and those of other programs.
//!
//! A file is a list of named layers of equal size. An `.exr` file may hold many: channels `R`, `G`,
//! `B` form the layer [`BEAUTY`]; `direct.R`, `direct.G`, `direct.B` the layer `direct`, and so on
//! through all parts of the file; `normal.X`, `normal.Y`, `normal.Z` the layer `normal`. A layer
//! with one channel is grey, and `A` is a separate grey layer. All values are linear; a `.png` is
//! decoded from sRGB, regardless of its color profile.
//!
//! A damaged or malicious file is an error: sizes in headers are checked against the file's length
//! and against free memory.

mod exr;
mod hdr;
mod image;
mod layered;
mod light;
mod limits;
mod pfm;
mod png;
mod raw;
mod stored;

use std::path::Path;

use crate::error::{Error, Result};

use super::format::FileFormat;
use super::png_depth::PngDepth;

pub use image::Image;
pub use layered::{BEAUTY, ImageLayer, LayeredImage};
pub use light::read_light;
pub(super) use limits::open as open_ordinary;
pub use raw::{RawChannel, read_raw_channels};
pub use stored::StoredPicture;

/// Reads a picture; the extension selects the format.
///
/// # Errors
/// When the extension is not `.png`, `.exr`, `.hdr` or `.pfm`, or when the file is unreadable or
/// invalid.
pub fn read_image(path: &Path) -> Result<LayeredImage> {
    let format = FileFormat::from_path(path)?;
    let trouble = |reason: String| Error::file("read", path, reason);
    let layered = match format {
        FileFormat::Exr => exr::read_layers(path),
        FileFormat::Pfm => pfm::read(path),
        FileFormat::Png => png::read(path),
        FileFormat::Hdr => hdr::read(path).map(LayeredImage::from),
    };
    let layered = layered.map_err(|reason| {
        trouble(reason).with_help("check that the file is complete and that its extension is right")
    })?;
    let count = layered.width * layered.height;
    debug_assert!(layered.layers.iter().all(|layer| layer.pixels.len() == count));
    Ok(layered)
}

/// Reads how finely a .png file stores its values.
///
/// # Errors
/// If the file cannot be read.
pub fn read_png_depth(path: &Path) -> Result<PngDepth> {
    png::read_depth(path).map_err(|reason| Error::file("read", path, reason))
}

/// Reads all channels of a `.exr` file.
///
/// # Errors
/// If the file cannot be read, or has another format.
pub fn read_stored(path: &Path) -> Result<StoredPicture> {
    let trouble = |reason: String| Error::file("read", path, reason);
    match FileFormat::from_path(path)? {
        FileFormat::Exr => exr::read_channels(path).map_err(trouble),
        _ => Err(trouble("it is no .exr file".to_owned())),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::super::tests::{picture, written};
    use super::*;
    use crate::color::Rgb;

    #[test]
    fn linear_formats_come_back_to_the_bit_or_to_their_step() {
        let picture = picture();
        for (name, steps) in [("a.exr", 0.0), ("a.pfm", 0.0), ("a.hdr", 1.0 / 256.0)] {
            let (_folder, path) = written(&picture, name);
            let read = read_image(&path).unwrap();
            assert_eq!((read.width, read.height, read.is_display_referred), (13, 5, false));
            let beauty = &read.layer(BEAUTY).unwrap().pixels;
            for (pixel, &value) in beauty.iter().enumerate() {
                let exact = picture.beauty(pixel);
                let allowed = steps * exact.max_element();
                assert!((value - exact).abs().max_element() <= allowed, "{name} {pixel}");
            }
        }
    }

    #[test]
    fn a_png_is_decoded_to_linear_light_and_cut_off_at_one() {
        let picture = picture();
        let (_folder, path) = written(&picture, "a.png");
        let read = read_image(&path).unwrap();
        assert!(read.is_display_referred);
        // Half a step of 1/255 at the steepest slope of the curve, 2.4 / 1.055.
        let allowed = 0.5 / 255.0 * 2.4 / 1.055 + 1e-6;
        for (pixel, &value) in read.layers[0].pixels.iter().enumerate() {
            let exact = picture.beauty(pixel).min(Rgb::ONE);
            assert!((value - exact).abs().max_element() <= allowed, "{pixel}");
        }
    }

    #[test]
    fn our_layers_come_back_by_name() {
        let picture = picture();
        let (_folder, path) = written(&picture, "a.exr");
        let read = read_image(&path).unwrap();
        assert_eq!(read.layers[0].name, BEAUTY);
        assert_eq!(read.layer("direct").unwrap().pixels, picture.direct);
        assert_eq!(read.layer("indirect").unwrap().pixels, picture.indirect);
        assert_eq!(read.layer("nothing"), None);
    }

    #[test]
    fn cut_off_and_foreign_files_are_refused() {
        let picture = picture();
        for name in ["a.exr", "a.pfm", "a.png", "a.hdr"] {
            let (_folder, path) = written(&picture, name);
            let whole = fs::read(&path).unwrap();
            for keep in [0, 5, 20, whole.len() / 2, whole.len() - 20] {
                fs::write(&path, &whole[..keep]).unwrap();
                let error = read_image(&path).unwrap_err();
                assert!(error.to_string().starts_with("cannot read `"), "{name} {keep}: {error}");
            }
            fs::write(&path, "format = 1\n".repeat(40)).unwrap();
            assert!(read_image(&path).is_err(), "{name}");
        }
    }

    #[test]
    fn sizes_that_cannot_be_in_the_file_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let refused = |name: &str, bytes: &[u8]| {
            let path = folder.path().join(name);
            fs::write(&path, bytes).unwrap();
            let error = read_image(&path).unwrap_err().to_string();
            assert!(error.contains("shorter than its header says"), "{name}: {error}");
        };
        refused("a.pfm", b"PF\n4000000000 4000000000\n-1.0\n");
        refused("a.pfm", b"Pf\n10 10\n-1.0\n0123");
        let header = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4000000 +X 4000000\n";
        refused("a.hdr", header);
        // The header of a PNG: 30,000 x 30,000 pixels of one bit.
        let mut png = Vec::new();
        ::png::Encoder::new(&mut png, 30_000, 30_000).write_header().unwrap();
        refused("a.png", &png);
    }

    #[cfg(unix)]
    #[test]
    fn what_never_ends_is_not_read() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.exr", "a.pfm", "a.png", "a.hdr"] {
            let path = folder.path().join(name);
            std::os::unix::fs::symlink("/dev/zero", &path).unwrap();
            let error = read_image(&path).unwrap_err().to_string();
            assert!(error.contains("it is not a regular file"), "{name}: {error}");
        }
    }
}
