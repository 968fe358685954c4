//! Radiance HDR: pixels of three mantissas and a common exponent (Ward 1991, "Real Pixels"). The
//! `image` crate reads the header. The pixels are decoded here, because their exponents are needed.
//!
//! A mantissa m stands for the middle of its step, (m + 0.5) / 256, as in Radiance's own reader.
//! Writers truncate, so a picture keeps its mean. `EXPOSURE` and `COLORCORR` tell by what radiance
//! was multiplied; all of these lines are divided out.

use std::io::{BufRead, BufReader, Cursor, Read};
use std::path::Path;

use image::codecs::hdr::{HdrDecoder, HdrMetadata};

use crate::color::Rgb;

use super::image::Image;
use super::limits::{self, Announced};

/// Bytes of pixels that one byte in the file can stand for: in the older encoding, a pixel and two
/// markers, 12 bytes, are up to 65,536 pixels.
const MAX_RATIO: u64 = 4 * 65_536 / 12;
/// Longest header, in bytes.
const MAX_HEADER_BYTES: u64 = 1 << 20;
/// Longest first line, in bytes.
const MAX_FIRST_LINE: u64 = 256;
/// Widths of scanlines whose components may be encoded apart.
const WIDTHS_IN_COMPONENTS: std::ops::Range<usize> = 8..32_768;

/// Three mantissas and an exponent.
type Rgbe = [u8; 4];

pub(super) fn read(path: &Path) -> Result<Image, String> {
    let (file, length) = limits::open(path)?;
    let mut file = BufReader::new(file);
    let header = read_header(&mut file)?;
    let announced = Announced {
        width: header.width.into(),
        height: header.height.into(),
        bits: 32,
        held: size_of::<Rgb>() as u64,
        max_ratio: MAX_RATIO,
    };
    limits::check(&[announced], length)?;
    let factors = factors(&header)?;
    let (width, height) = (header.width as usize, header.height as usize);
    let mut row = vec![Rgbe::default(); width];
    let mut pixels = Vec::with_capacity(width * height);
    for _ in 0..height {
        read_scanline(&mut file, &mut row)?;
        pixels.extend(row.iter().map(|&rgbe| decode(rgbe, factors)));
    }
    Ok(Image { width, height, pixels })
}

/// Reads the header, up to the pixels. The first line names the program's family: `#?RADIANCE`,
/// `#?RGBE`, or another.
fn read_header(file: &mut impl BufRead) -> Result<HdrMetadata, String> {
    let mut first = Vec::new();
    file.by_ref().take(MAX_FIRST_LINE).read_until(b'\n', &mut first).map_err(|e| e.to_string())?;
    if !first.starts_with(b"#?") || !first.ends_with(b"\n") {
        return Err("it does not begin with #?RADIANCE or #?RGBE".to_owned());
    }
    // The decoder knows only one of the names.
    let text = Cursor::new(b"#?RADIANCE\n").chain(file.by_ref().take(MAX_HEADER_BYTES));
    Ok(HdrDecoder::new(text).map_err(|e| e.to_string())?.metadata())
}

/// Returns what the channels are multiplied by to give radiance.
fn factors(header: &HdrMetadata) -> Result<[f64; 3], String> {
    let exposure = header.exposure.unwrap_or(1.0);
    let (r, g, b) = header.color_correction.unwrap_or((1.0, 1.0, 1.0));
    let factors = [r, g, b].map(|correction| 1.0 / (f64::from(exposure) * f64::from(correction)));
    match factors.iter().all(|factor| factor.is_finite() && *factor > 0.0) {
        true => Ok(factors),
        false => {
            Err(format!("its EXPOSURE {exposure} and COLORCORR {r} {g} {b} are not all above 0"))
        }
    }
}

fn decode([r, g, b, exponent]: Rgbe, factors: [f64; 3]) -> Rgb {
    if exponent == 0 {
        return Rgb::ZERO;
    }
    let step = libm::exp2(f64::from(exponent) - (128.0 + 8.0));
    let mantissas = [r, g, b].map(|mantissa| f64::from(mantissa) + 0.5);
    Rgb::from_array(std::array::from_fn(|c| (mantissas[c] * step * factors[c]) as f32))
}

fn read_scanline(file: &mut impl Read, row: &mut [Rgbe]) -> Result<(), String> {
    let first = read_bytes(file)?;
    let [a, b, high, low] = first;
    if WIDTHS_IN_COMPONENTS.contains(&row.len()) && [a, b] == [2, 2] && high < 128 {
        if usize::from(u16::from_be_bytes([high, low])) != row.len() {
            return Err("it has a scanline of another width".to_owned());
        }
        return (0..4).try_for_each(|component| read_component(file, row, component));
    }
    read_old_scanline(file, row, first)
}

/// Reads one component of a scanline: runs, and stretches of single bytes.
fn read_component(file: &mut impl Read, row: &mut [Rgbe], component: usize) -> Result<(), String> {
    let mut at = 0;
    while at < row.len() {
        let [code] = read_bytes(file)?;
        let (count, is_run) = match code {
            129.. => (usize::from(code - 128), true),
            _ => (usize::from(code), false),
        };
        let end = at + count;
        if count == 0 || end > row.len() {
            return Err("it has a run of pixels of an impossible length".to_owned());
        }
        let [mut value] = read_bytes(file)?;
        for (i, pixel) in row[at..end].iter_mut().enumerate() {
            if i > 0 && !is_run {
                [value] = read_bytes(file)?;
            }
            pixel[component] = value;
        }
        at = end;
    }
    Ok(())
}

/// Reads a scanline of whole pixels. After a pixel, the marker (1, 1, 1, n) repeats it n times, and
/// the next marker 256 n times.
fn read_old_scanline(file: &mut impl Read, row: &mut [Rgbe], first: Rgbe) -> Result<(), String> {
    row[0] = first;
    let (mut at, mut scale) = (1, 1);
    while at < row.len() {
        let pixel = read_bytes(file)?;
        if pixel[..3] != [1, 1, 1] {
            row[at] = pixel;
            (at, scale) = (at + 1, 1);
            continue;
        }
        let end = at + usize::from(pixel[3]) * scale;
        if end > row.len() {
            return Err("it has a run of pixels of an impossible length".to_owned());
        }
        let repeated = row[at - 1];
        row[at..end].fill(repeated);
        (at, scale) = (end, scale.saturating_mul(256));
    }
    Ok(())
}

fn read_bytes<const N: usize>(file: &mut impl Read) -> Result<[u8; N], String> {
    let mut bytes = [0; N];
    match file.read_exact(&mut bytes) {
        Ok(()) => Ok(bytes),
        Err(_) => Err("it ends before its last pixel".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::tests::written;
    use super::*;
    use crate::image_io::Picture;

    fn read_file(header: &str, pixels: &[u8]) -> Result<Image, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.hdr");
        std::fs::write(&path, [header.as_bytes(), pixels].concat()).unwrap();
        read(&path)
    }

    /// Two equal pixels of 1, with the half step.
    fn grey(lines: &str) -> Result<Image, String> {
        let header = format!("{lines}FORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n");
        read_file(&header, &[128, 128, 128, 129].repeat(2))
    }

    const ONE: f32 = 128.5 / 128.0;

    #[test]
    fn headers_of_other_programs_are_accepted() {
        for first in ["#?RADIANCE\n", "#?RGBE\n", "#?RGBE\n# Made with 100% pure HDR Shop\n"] {
            assert_eq!(grey(first).unwrap().pixels, [Rgb::splat(ONE); 2], "{first}");
        }
        assert!(grey("RADIANCE\n").unwrap_err().contains("does not begin with #?RADIANCE"));
    }

    #[test]
    fn exposures_and_corrections_are_divided_out() {
        let lines = "#?RGBE\nEXPOSURE=2.0\nEXPOSURE= 4\nCOLORCORR=1 2 4\nCOLORCORR=1 0.5 1\n";
        let expected = Rgb::new(1.0, 1.0, 0.25) * ONE / 8.0;
        assert_eq!(grey(lines).unwrap().pixels[1], expected);
        for bad in ["EXPOSURE=0\n", "EXPOSURE=x\n", "COLORCORR=1 -1 1\n", "EXPOSURE=nan\n"] {
            assert!(grey(&format!("#?RGBE\n{bad}")).is_err(), "{bad}");
        }
    }

    #[test]
    fn every_encoding_of_scanlines_is_read() {
        let header = "#?RGBE\n\n-Y 1 +X 300\n";
        // Old: a pixel, 43 + 256 repetitions of it.
        let old = [9, 8, 7, 129, 1, 1, 1, 43, 1, 1, 1, 1];
        // New: 127 + 127 + 46 for three components; one of them as single bytes.
        let run = |value: u8| [255, value, 255, value, 128 + 46, value];
        let single = [[127].as_slice(), &[8; 127], &[127], &[8; 127], &[46], &[8; 46]].concat();
        let new = [&[2, 2, 1, 44], &run(9)[..], &single, &run(7), &run(129)].concat();
        let flat = [9, 8, 7, 129].repeat(300);
        let [old, new, flat] =
            [&old[..], &new, &flat].map(|pixels| read_file(header, pixels).unwrap().pixels);
        assert_eq!(flat, vec![Rgb::new(9.5, 8.5, 7.5) / 128.0; 300]);
        assert!(old == flat && new == flat);
    }

    #[test]
    fn impossible_runs_and_ends_are_refused() {
        let header = "#?RGBE\n\n-Y 1 +X 300\n";
        for pixels in [
            &[2, 2, 1, 45, 255, 1][..],
            &[2, 2, 1, 44, 255, 1, 255, 1, 255, 1],
            &[2, 2, 1, 44, 0, 0],
            &[9, 8, 7, 129, 1, 1, 1, 44, 1, 1, 1, 1],
            &[9, 8, 7, 129, 1, 1, 1],
        ] {
            assert!(read_file(header, pixels).is_err(), "{pixels:?}");
        }
        let long = "#?RGBE\n\n-Y 1000000 +X 1000000\n";
        assert!(read_file(long, &[0; 4]).unwrap_err().contains("shorter than its header"));
    }

    /// Values spread evenly over some octaves: truncation alone makes them darker by 0.3 %.
    #[test]
    fn what_is_written_keeps_its_mean() {
        let (width, height) = (256, 128);
        let value = |i: usize| libm::exp2f(i as f32 / 4096.0 - 3.0);
        let direct: Vec<Rgb> = (0..width * height)
            .map(|i| Rgb::new(value(i), 0.7 * value(i), 0.1 * value(i)))
            .collect();
        let indirect = vec![Rgb::ZERO; direct.len()];
        let picture = Picture { width, height, direct, indirect, ..Picture::default() };
        let (_folder, path) = written(&picture, "a.hdr");
        let pixels = read(&path).unwrap().pixels;
        let sum = pixels.iter().map(|pixel| pixel.as_dvec3()).reduce(|a, b| a + b).unwrap();
        let mean = sum / pixels.len() as f64;
        let ratio = mean / picture.mean();
        assert!((ratio - 1.0).abs().max_element() < 2e-4, "{ratio}");
    }

    /// More than the 512 MiB that the `image` crate allows by default.
    #[test]
    fn wide_pictures_are_read() {
        let (width, height) = (16_384, 2_800);
        let header = format!("#?RADIANCE\n\n-Y {height} +X {width}\n");
        let component = [[255, 128].repeat(129), vec![128 + 1, 128]].concat();
        let row = [vec![2, 2, 64, 0], component.repeat(4)].concat();
        let image = read_file(&header, &row.repeat(height)).unwrap();
        assert_eq!(
            (image.width, image.height, image.pixels.len()),
            (width, height, width * height)
        );
        assert_eq!(image.pixels[width * height - 1], Rgb::splat(128.5 / 256.0));
    }
}
