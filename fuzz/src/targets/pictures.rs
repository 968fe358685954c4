//! Picture files, as `compare`, `info` and `reproduce` read them.

use std::fs;
use std::path::Path;

use photosphere::image_io::{self, LayeredImage, has_picture_extension};
use photosphere::report::compare::{CompareMetric, CompareOptions, Comparison, ImagePair};

use super::accepted;

/// Larger pictures are read but not compared.
const MAX_PIXELS: usize = 1 << 12;

/// The bytes that files begin with, and the extension that chooses their reader.
const FORMATS: [(&[u8], &str); 5] = [
    (b"\x89PNG", "png"),
    (b"\x76\x2f\x31\x01", "exr"),
    (b"#?", "hdr"),
    (b"PF", "pfm"),
    (b"Pf", "pfm"),
];

/// Returns the extension for a file that begins so.
pub(super) fn extension(file: &[u8]) -> Option<&'static str> {
    FORMATS.iter().find(|(magic, _)| file.starts_with(magic)).map(|(_, extension)| *extension)
}

/// The input is the file; its first bytes choose the reader.
pub(super) fn picture(input: &[u8]) -> bool {
    let Some(extension) = extension(input) else { return false };
    let folder = tempfile::tempdir().expect("a folder for temporary files");
    let path = folder.path().join("a").with_extension(extension);
    fs::write(&path, input).expect("a file in it");
    assert!(has_picture_extension(&path));
    if matches!(extension, "png" | "exr") {
        accepted(image_io::read_metadata(&path));
        let channels = accepted(image_io::read_raw_channels(&path)).unwrap_or_default();
        let count = channels.first().map_or(0, |channel| channel.bits.len());
        let is_whole = channels.iter().all(|channel| channel.bits.len() == count);
        // Channels of OpenEXR may be subsampled.
        assert!(is_whole || extension == "exr", "channels of different sizes");
    }
    let Some(picture) = accepted(image_io::read_image(&path)) else { return false };
    let count = picture.width * picture.height;
    assert!(count > 0 && picture.layers.iter().all(|layer| layer.pixels.len() == count));
    if count <= MAX_PIXELS {
        compare(picture, &path);
    }
    true
}

/// Compares a picture with itself.
fn compare(picture: LayeredImage, path: &Path) {
    let pair = ImagePair { a: picture.clone(), b: picture.clone(), twin: Some(picture) };
    let metrics = CompareMetric::NAMES.iter().map(|(_, metric)| *metric).collect();
    let options = CompareOptions { metrics, limits: vec![(CompareMetric::Mse, 0.0)], peak: 1.0 };
    // The command refuses a beauty that is not finite.
    let is_finite =
        |name: &&str| pair.a.layer(name).is_some_and(|layer| layer.count_non_finite().is_none());
    let layers: Vec<String> =
        pair.comparable().into_iter().filter(is_finite).map(str::to_owned).collect();
    pair.remarks();
    let comparison = Comparison::of(&pair, &options, &layers);
    assert!(comparison.exceeded().is_empty(), "a picture differs from itself: {comparison}");
    assert!(comparison.json(path, path)["layers"].is_array());
    if let Some(layer) = layers.first() {
        pair.heatmap(layer, CompareMetric::Flip);
    }
}
