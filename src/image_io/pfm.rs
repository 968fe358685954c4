//! Portable float map: three header lines, then f32 rows from bottom to top.
//! Format: Debevec, "PFM Portable FloatMap Image Format".

use std::io::{self, Write};

use super::atomic_file::Sink;
use super::picture::Picture;

/// Writes the linear beauty; a scale of -1 means little-endian.
pub(super) fn write(picture: &Picture, to: &mut Sink) -> io::Result<()> {
    write!(to, "PF\n{} {}\n-1.0\n", picture.width, picture.height)?;
    for y in (0..picture.height).rev() {
        for x in 0..picture.width {
            for value in picture.beauty(y * picture.width + x).to_array() {
                to.write_all(&value.to_le_bytes())?;
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::tests::{picture, written};

    #[test]
    fn rows_run_from_the_bottom_in_little_endian() {
        let picture = picture();
        let (_folder, path) = written(&picture, "a.pfm");
        let bytes = std::fs::read(path).unwrap();
        let floats = bytes.strip_prefix(b"PF\n13 5\n-1.0\n").unwrap();
        let read: Vec<_> =
            floats.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
        let rows = [4, 3, 2, 1, 0].into_iter().flat_map(|y| y * 13..(y + 1) * 13);
        let expected: Vec<_> = rows.flat_map(|pixel| picture.beauty(pixel).to_array()).collect();
        assert_eq!(read, expected);
    }
}
