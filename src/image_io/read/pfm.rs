//! Portable float map: `PF` (color) or `Pf` (grey), the size, and a scale whose sign gives the byte
//! order; then f32 rows from bottom to top.

use std::path::Path;

use crate::color::Rgb;

use super::layered::{BEAUTY, ImageLayer, LayeredImage, MAX_SAMPLES, check_samples};

struct PfmHeader {
    width: usize,
    height: usize,
    channels: usize,
    is_little_endian: bool,
    /// Offset of the first float, in bytes.
    length: usize,
}

pub(super) fn read(path: &Path, length: u64) -> Result<LayeredImage, String> {
    // Four bytes for each sample allowed, and a header.
    if length > 4 * MAX_SAMPLES + 4096 {
        return Err("it is too large".to_owned());
    }
    let bytes = std::fs::read(path).map_err(|e| e.to_string())?;
    let PfmHeader { width, height, channels, is_little_endian, length } = header(&bytes)?;
    let expected = 4 * width * height * channels;
    let found = bytes.len() - length;
    if found < expected {
        return Err(format!("{expected} bytes must follow its header, but {found} do"));
    }
    let float = |b: &[u8]| {
        let b = [b[0], b[1], b[2], b[3]];
        if is_little_endian { f32::from_le_bytes(b) } else { f32::from_be_bytes(b) }
    };
    let values: Vec<f32> = bytes[length..length + expected].chunks_exact(4).map(float).collect();
    let pixel = |v: &[f32]| if channels == 1 { Rgb::splat(v[0]) } else { Rgb::from_slice(v) };
    let row = |y: usize| values.chunks_exact(channels).skip(y * width).take(width).map(pixel);
    let pixels = (0..height).rev().flat_map(row).collect();
    let layers = vec![ImageLayer { name: BEAUTY.to_owned(), pixels }];
    Ok(LayeredImage { width, height, layers, is_display_referred: false })
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
    check_samples(width.into(), height.into(), channels as u64)?;
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
        read(&path, bytes.len() as u64)
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
