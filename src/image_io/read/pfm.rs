//! Portable float map: `PF` (color) or `Pf` (grey), the size, and a scale whose sign gives the byte
//! order; then f32 rows from bottom to top.

use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use crate::color::Rgb;

use super::image::Image;
use super::layered::LayeredImage;
use super::limits::{self, Announced};

/// Longest header, in bytes.
const MAX_HEADER_BYTES: u64 = 4096;

struct PfmHeader {
    width: usize,
    height: usize,
    channels: usize,
    is_little_endian: bool,
    /// Offset of the first float, in bytes.
    length: usize,
}

pub(super) fn read(path: &Path) -> Result<LayeredImage, String> {
    let (mut file, file_length) = limits::open(path)?;
    let mut bytes = Vec::new();
    file.by_ref().take(MAX_HEADER_BYTES).read_to_end(&mut bytes).map_err(|e| e.to_string())?;
    let PfmHeader { width, height, channels, is_little_endian, length } = header(&bytes)?;
    let pixel_bytes = 4 * channels;
    let announced = Announced {
        width: width as u64,
        height: height as u64,
        bits: 8 * pixel_bytes as u64,
        held: (pixel_bytes + size_of::<Rgb>()) as u64,
        max_ratio: 1,
    };
    limits::check(&[announced], file_length)?;
    let expected = (width * height * pixel_bytes) as u64;

    file.seek(SeekFrom::Start(length as u64)).map_err(|e| e.to_string())?;
    bytes.clear();
    file.take(expected).read_to_end(&mut bytes).map_err(|e| e.to_string())?;
    if (bytes.len() as u64) < expected {
        return Err(format!("{expected} bytes must follow its header, but {} do", bytes.len()));
    }
    let float = |b: &[u8]| {
        let b = [b[0], b[1], b[2], b[3]];
        if is_little_endian { f32::from_le_bytes(b) } else { f32::from_be_bytes(b) }
    };
    let pixel = |bytes: &[u8]| match channels {
        1 => Rgb::splat(float(bytes)),
        _ => Rgb::new(float(bytes), float(&bytes[4..]), float(&bytes[8..])),
    };
    let rows = bytes.chunks_exact(pixel_bytes * width).rev();
    let pixels = rows.flat_map(|row| row.chunks_exact(pixel_bytes).map(pixel)).collect();
    Ok(Image { width, height, pixels }.into())
}

fn header(bytes: &[u8]) -> Result<PfmHeader, String> {
    let mut at = 0;
    let mut word = || -> Option<&str> {
        let rest = bytes.get(at..)?;
        let begin = rest.iter().position(|b| !b.is_ascii_whitespace())?;
        let end = begin + rest[begin..].iter().position(u8::is_ascii_whitespace)?;
        at += end;
        std::str::from_utf8(&rest[begin..end]).ok()
    };
    let mut words = [""; 4];
    for place in &mut words {
        *place = word().ok_or("it has no PFM header")?;
    }
    let [kind, width, height, scale] = words;
    let channels = match kind {
        "PF" => 3,
        "Pf" => 1,
        _ => return Err("it does not begin with PF or Pf".to_owned()),
    };
    let size =
        |word: &str| word.parse::<u32>().map_err(|_| format!("its size `{word}` is not a number"));
    let (width, height) = (size(width)?, size(height)?);
    let scale: f32 = scale.parse().map_err(|_| format!("its scale `{scale}` is not a number"))?;
    if scale == 0.0 || !scale.is_finite() {
        return Err(format!("its scale is {scale}"));
    }
    Ok(PfmHeader {
        width: width as usize,
        height: height as usize,
        channels,
        is_little_endian: scale < 0.0,
        length: at + 1,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_bytes(bytes: &[u8]) -> Result<LayeredImage, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.pfm");
        std::fs::write(&path, bytes).unwrap();
        read(&path)
    }

    #[test]
    fn grey_big_endian_maps_are_read_from_the_bottom_up() {
        let mut bytes = b"Pf\n1 2\n1.0\n".to_vec();
        bytes.extend([3.0f32, 4.0].iter().flat_map(|v| v.to_be_bytes()));
        let read = read_bytes(&bytes).unwrap();
        assert_eq!(read.layers[0].pixels, [Rgb::splat(4.0), Rgb::splat(3.0)]);
    }

    #[test]
    fn headers_that_make_no_sense_are_refused() {
        let bad =
            ["PX\n1 1\n-1\n", "PF\n1 x\n-1\n", "PF\n1 1\n0\n", "PF\n0 1\n-1\n", "PF\n1 1\n-1"];
        for text in bad {
            assert!(read_bytes(text.as_bytes()).is_err(), "{text:?}");
        }
    }
}
