//! PNG: 8 or 16 bits per channel for display, through the
//! [`ViewTransform`](crate::color::ViewTransform). The default is the sRGB curve, clipped to white
//! above 1. Whatever the tone curve, the pixels are values for an sRGB display, and the file says
//! so.
//!
//! A picture with alpha becomes RGBA with colors that are not premultiplied, as the specification
//! requires (PNG third edition, section 6.2).

use std::fs::File;
use std::io::{self, BufReader};
use std::path::Path;

use png::chunk::ChunkType;
use png::text_metadata::ITXtChunk;
use png::{
    BitDepth, ColorType, Compression, Decoder, Encoder, EncodingError, Filter, PixelDimensions,
    ScaledFloat, SrgbRenderingIntent, Unit, Writer,
};

use super::atomic_file::Sink;
use super::display::{deep_pixels, display_pixels};
use super::notes::WriteOptions;
use super::picture::Picture;
use super::png_depth::PngDepth;
use super::record::MetadataEntry;

/// Texts longer than this, in bytes, are compressed.
const COMPRESS_TEXT_ABOVE: usize = 512;

/// Chunk with code points of ITU-T H.273, which takes precedence over the other chunks about color.
const CICP: ChunkType = ChunkType(*b"cICP");
/// Rec. 709 primaries, the sRGB curve, RGB, and the full range of values.
const SRGB_CODE_POINTS: [u8; 4] = [1, 13, 0, 1];
/// The exponent that is closest to the sRGB curve, in steps of 1e-5 (PNG third edition, section
/// 11.3.2.5).
const SRGB_GAMMA: u32 = 45_455;

const METERS_PER_INCH: f64 = 0.0254;

/// Maximum length of all texts together, in bytes. Longer ones are neither written nor read.
const MAX_TEXT_BYTES: usize = 64 << 20;

/// Writes the beauty for display, rounded to the nearest level.
pub(super) fn write(picture: &Picture, notes: &WriteOptions, to: &mut Sink) -> io::Result<()> {
    let length: usize = notes.metadata.iter().map(|record| record.text.len()).sum();
    if length > MAX_TEXT_BYTES {
        return Err(io::Error::other(format!(
            "its metadata has {length} bytes, more than the {MAX_TEXT_BYTES} that can be read again"
        )));
    }
    let mut encoder = Encoder::new(to, picture.width as u32, picture.height as u32);
    encoder.set_compression(Compression::Fast);
    encoder.set_filter(if notes.fast { Filter::Up } else { Filter::Adaptive });
    encoder.set_color(match picture.alpha {
        None => ColorType::Rgb,
        Some(_) => ColorType::Rgba,
    });
    encoder.set_pixel_dims(notes.dpi.map(|dpi| {
        let per_meter = (f64::from(dpi) / METERS_PER_INCH).round() as u32;
        PixelDimensions { xppu: per_meter, yppu: per_meter, unit: Unit::Meter }
    }));
    let mut writer = write_srgb_header(encoder, notes.png_depth)?;
    for record in &notes.metadata {
        let mut chunk = ITXtChunk::new(record.key(), &record.text);
        chunk.compressed = record.text.len() > COMPRESS_TEXT_ABOVE;
        writer.write_text_chunk(&chunk)?;
    }
    let bytes = match notes.png_depth {
        PngDepth::Eight => display_pixels(picture, notes),
        PngDepth::Sixteen => deep_pixels(picture, notes),
    };
    writer.write_image_data(&bytes)?;
    writer.finish()?;
    Ok(())
}

/// Writes the chunks before the pixels, which are sRGB. `gAMA` is for programs that do not
/// know `sRGB`.
fn write_srgb_header<W: io::Write>(
    mut encoder: Encoder<'_, W>,
    depth: PngDepth,
) -> Result<Writer<W>, EncodingError> {
    encoder.set_depth(match depth {
        PngDepth::Eight => BitDepth::Eight,
        PngDepth::Sixteen => BitDepth::Sixteen,
    });
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    encoder.set_source_gamma(ScaledFloat::from_scaled(SRGB_GAMMA));
    let mut writer = encoder.write_header()?;
    writer.write_chunk(CICP, &SRGB_CODE_POINTS)?;
    Ok(writer)
}

/// Encodes 8-bit RGBA pixels as a PNG file in memory; `None` if `bytes` does not match the size.
pub fn rgba_png(width: u32, height: u32, bytes: &[u8]) -> Option<Vec<u8>> {
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, width, height);
    encoder.set_color(ColorType::Rgba);
    let mut writer = write_srgb_header(encoder, PngDepth::Eight).ok()?;
    writer.write_image_data(bytes).ok()?;
    writer.finish().ok()?;
    Some(file)
}

/// Reads the metadata of a file.
pub(super) fn read_metadata(path: &Path) -> Result<Vec<MetadataEntry>, String> {
    let file = File::open(path).map_err(|e| e.to_string())?;
    let reader = Decoder::new(BufReader::new(file)).read_info().map_err(|e| e.to_string())?;
    let info = reader.info();
    let mut found = Vec::new();
    for chunk in &info.uncompressed_latin1_text {
        found.extend(MetadataEntry::from_key(&chunk.keyword, chunk.text.clone()));
    }
    let mut left = MAX_TEXT_BYTES;
    for chunk in info.utf8_text.iter().filter(|chunk| MetadataEntry::is_ours(&chunk.keyword)) {
        let mut chunk = chunk.clone();
        chunk.decompress_text_with_limit(left).map_err(|e| e.to_string())?;
        let text = chunk.get_text().map_err(|e| e.to_string())?;
        left = left.checked_sub(text.len()).ok_or("its texts are too long")?;
        found.extend(MetadataEntry::from_key(&chunk.keyword, text));
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{picture, written};
    use super::super::{CropWindow, ImageWriter, OverlayImage, PngDepth, WriteOptions};
    use std::sync::Arc;

    use crate::color::{Rgb, ToneCurve, ViewTransform, srgb_from_linear};

    #[test]
    fn pixels_come_back_in_place_and_rounded() {
        let picture = picture();
        let (_folder, path) = written(&picture, "a.PNG");
        let image = image::ImageReader::open(path).unwrap().with_guessed_format().unwrap();
        let image = image.decode().unwrap().into_rgb8();
        assert_eq!(image.dimensions(), (13, 5));
        for (pixel, read) in image.pixels().enumerate() {
            for (value, read) in picture.beauty(pixel).to_array().into_iter().zip(read.0) {
                let exact = srgb_from_linear(value) * 255.0;
                assert!((exact - f32::from(read)).abs() <= 0.5);
            }
        }
    }

    #[test]
    fn colours_are_not_multiplied_with_alpha() {
        let mut picture = picture();
        picture.direct[0] = Rgb::splat(0.25);
        picture.indirect[0] = Rgb::ZERO;
        let mut alpha = vec![1.0; picture.len()];
        alpha[..2].copy_from_slice(&[0.5, 0.0]);
        picture.alpha = Some(alpha);
        let (_folder, path) = written(&picture, "a.png");
        let image = image::open(path).unwrap();
        assert_eq!(image.color(), image::ColorType::Rgba8);
        let half = (srgb_from_linear(0.5) * 255.0).round() as u8;
        assert_eq!(image.to_rgba8().get_pixel(0, 0).0, [half, half, half, 128]);
        assert_eq!(image.to_rgba8().get_pixel(1, 0).0, [0; 4]);
        assert_eq!(image.to_rgba8().get_pixel(2, 0).0[3], 255);
    }

    #[test]
    fn the_look_is_that_of_the_notes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let look = ViewTransform { exposure: -2.5, tone: ToneCurve::AgX, dither: true };
        let cropped_from = Some(CropWindow { full_size: [640, 480], offset: [31, 17] });
        let notes = WriteOptions {
            view_transform: look,
            crop_window: cropped_from,
            ..WriteOptions::default()
        };
        let picture = picture();
        ImageWriter::new(&path).unwrap().write_with(&picture, &notes).unwrap();
        let image = image::open(&path).unwrap().into_rgb8();
        for (x, y, read) in image.enumerate_pixels() {
            let (x, y) = (x as usize, y as usize);
            assert_eq!(read.0, look.to_display_8bit(picture.beauty(13 * y + x), 31 + x, 17 + y));
        }
    }

    /// The types and contents of all chunks.
    fn chunks(file: &[u8]) -> Vec<(String, Vec<u8>)> {
        let mut chunks = Vec::new();
        let mut rest = &file[8..];
        while !rest.is_empty() {
            let length = u32::from_be_bytes(rest[..4].try_into().unwrap()) as usize;
            let name = String::from_utf8(rest[4..8].to_vec()).unwrap();
            chunks.push((name, rest[8..8 + length].to_vec()));
            rest = &rest[12 + length..];
        }
        chunks
    }

    fn chunk(file: &[u8], name: &str) -> Option<Vec<u8>> {
        chunks(file).into_iter().find(|(its, _)| its == name).map(|(_, content)| content)
    }

    #[test]
    fn the_colour_space_is_srgb() {
        let (_folder, path) = written(&picture(), "a.png");
        let chart = super::rgba_png(2, 1, &[7; 8]).unwrap();
        assert_eq!(image::load_from_memory(&chart).unwrap().into_rgba8().into_raw(), [7; 8]);
        for file in [std::fs::read(path).unwrap(), chart] {
            assert_eq!(chunk(&file, "sRGB").unwrap(), [0]);
            assert_eq!(chunk(&file, "gAMA").unwrap(), 45_455u32.to_be_bytes());
            assert_eq!(chunk(&file, "cICP").unwrap(), [1, 13, 0, 1]);
            assert_eq!(chunk(&file, "pHYs"), None);
            // All of them must stand before the pixels.
            let names: Vec<_> = chunks(&file).into_iter().map(|(name, _)| name).collect();
            let pixels = names.iter().position(|name| name == "IDAT").unwrap();
            for name in ["sRGB", "gAMA", "cICP"] {
                assert!(names.iter().position(|n| n == name).unwrap() < pixels, "{names:?}");
            }
        }
    }

    #[test]
    fn a_resolution_is_written_in_pixels_per_metre() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let notes = WriteOptions { dpi: Some(300), ..WriteOptions::default() };
        ImageWriter::new(&path).unwrap().write_with(&picture(), &notes).unwrap();
        let expected = [&11_811u32.to_be_bytes()[..], &11_811u32.to_be_bytes(), &[1]].concat();
        assert_eq!(chunk(&std::fs::read(path).unwrap(), "pHYs").unwrap(), expected);
    }

    /// Texts that together are longer than allowed, each a thousandth in the file, are refused
    /// without being held; the texts of other programs are not even decompressed.
    #[test]
    fn texts_that_swell_are_refused() {
        let write = |prefix: &str, count: usize| {
            let mut file = Vec::new();
            let mut writer = png::Encoder::new(&mut file, 1, 1).write_header().unwrap();
            for i in 0..count {
                let text = "0".repeat(40 << 20);
                let mut chunk = png::text_metadata::ITXtChunk::new(format!("{prefix}{i}"), text);
                chunk.compressed = true;
                writer.write_text_chunk(&chunk).unwrap();
            }
            writer.write_image_data(&[0]).unwrap();
            writer.finish().unwrap();
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("a.png");
            std::fs::write(&path, &file).unwrap();
            assert!(file.len() < 1 << 20);
            super::read_metadata(&path)
        };
        assert_eq!(write("photosphere:", 1).unwrap().len(), 1);
        assert!(write("photosphere:", 2).is_err());
        assert_eq!(write("other", 2).unwrap(), []);
    }

    #[test]
    fn sixteen_bits_are_finer_by_257_and_blend_as_eight_do() {
        let mut picture = picture();
        let count = picture.len();
        picture.alpha = Some((0..count).map(|i| i as f32 / count as f32).collect());
        let mut pixels = vec![[0; 4]; count];
        pixels[7] = [90, 60, 30, 120];
        let overlay = Some(Arc::new(OverlayImage { width: 13, pixels }));
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, png_depth: PngDepth| {
            let path = folder.path().join(name);
            let notes =
                WriteOptions { png_depth, overlay: overlay.clone(), ..WriteOptions::default() };
            ImageWriter::new(&path).unwrap().write_with(&picture, &notes).unwrap();
            image::open(path).unwrap()
        };
        let (deep, plain) =
            (write("a.png", PngDepth::Sixteen), write("b.png", PngDepth::Eight).into_rgba8());
        assert_eq!(deep.color(), image::ColorType::Rgba16);
        let mut odd = 0;
        for (deep, plain) in deep.into_rgba16().pixels().zip(plain.pixels()) {
            for (deep, plain) in deep.0.into_iter().zip(plain.0) {
                // A blend of 8 bits rounds twice.
                assert!((f32::from(deep) / 257.0 - f32::from(plain)).abs() < 1.6);
                odd += usize::from(deep % 257 != 0);
            }
        }
        assert!(odd > count, "the finer levels are used: {odd}");
    }

    #[test]
    fn values_that_are_not_finite_are_seen() {
        let mut picture = picture();
        picture.direct[0] = Rgb::new(0.0, f32::NAN, 0.0);
        picture.direct[1] = Rgb::new(f32::INFINITY, 0.0, f32::NEG_INFINITY);
        picture.indirect[..2].fill(Rgb::ZERO);
        let (_folder, path) = written(&picture, "a.png");
        let image = image::open(path).unwrap().into_rgb8();
        assert_eq!(image.get_pixel(0, 0).0, [255, 0, 255]);
        assert_eq!(image.get_pixel(1, 0).0, [255, 0, 0]);
    }
}
