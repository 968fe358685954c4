//! How large a picture a file's header may announce. Every reader asks here before it allocates:
//! a header is believed as far as the file's bytes could be decompressed to such a picture, and as
//! far as it fits into free memory.

use std::fs::File;
use std::path::Path;

use crate::task::available_memory;

/// Bytes that one byte of a deflate stream can stand for: a run of 258 bytes takes two bits (RFC
/// 1951).
pub(super) const DEFLATE_RATIO: u64 = 1032;
/// Memory that reading may take where the free memory is unknown.
const DEFAULT_MEMORY: u64 = 16 << 30;

/// Pixels that a header announces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Announced {
    pub(super) width: u64,
    pub(super) height: u64,
    /// Bits per pixel before compression.
    pub(super) bits: u64,
    /// Bytes of memory per pixel while the file is read, at most.
    pub(super) held: u64,
    /// The most bytes that one byte in the file can stand for.
    pub(super) max_ratio: u64,
}

/// Opens a regular file and returns it with its length. A device may never end, and opening a pipe
/// waits for a writer.
pub(in crate::image_io) fn open(path: &Path) -> Result<(File, u64), String> {
    let info = path.metadata().map_err(|e| e.to_string())?;
    if info.is_dir() {
        return Err("it is a folder".to_owned());
    }
    if !info.is_file() {
        return Err("it is not a regular file".to_owned());
    }
    let file = File::open(path).map_err(|e| e.to_string())?;
    Ok((file, info.len()))
}

/// Refuses parts of a file of `length` bytes that cannot all be in it, or do not fit into memory.
pub(super) fn check(parts: &[Announced], length: u64) -> Result<(), String> {
    check_with(parts, length, available_memory().unwrap_or(DEFAULT_MEMORY))
}

fn check_with(parts: &[Announced], length: u64, memory: u64) -> Result<(), String> {
    let (mut stored, mut held) = (0u64, 0u64);
    for part in parts {
        let Announced { width, height, bits, held: bytes, max_ratio } = *part;
        if width == 0 || height == 0 {
            return Err("it has no pixels".to_owned());
        }
        let pixels = width.saturating_mul(height);
        held = held.saturating_add(pixels.saturating_mul(bytes));
        stored = stored.saturating_add(pixels.saturating_mul(bits) / 8 / max_ratio);
        let size = format!("{width} x {height} pixels");
        if stored > length {
            return Err(format!("it is shorter than its header says: {size}"));
        }
        if held > memory {
            return Err(format!("its {size} do not fit into memory"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(width: u64, height: u64) -> Announced {
        Announced { width, height, bits: 96, held: 48, max_ratio: 1000 }
    }

    #[test]
    fn headers_are_believed_as_far_as_compression_and_memory_go() {
        let check = |parts: &[Announced], length| check_with(parts, length, 48_000_000);
        assert_eq!(check(&[part(1000, 1000)], 12_000), Ok(()));
        assert!(check(&[part(1000, 1000)], 11_999).unwrap_err().contains("shorter"));
        assert!(check(&[part(1000, 1001)], 1 << 40).unwrap_err().contains("fit into memory"));
        assert!(check(&[part(0, 5)], 100).unwrap_err().contains("no pixels"));
        assert!(check(&[part(u64::MAX, 2)], u64::MAX).is_err());
    }

    /// Many parts that each could be in the file, but not all of them.
    #[test]
    fn parts_share_the_bytes_and_the_memory() {
        let parts = [part(100, 100); 10];
        assert_eq!(check_with(&parts, 1200, 1 << 40), Ok(()));
        assert!(check_with(&parts, 1199, 1 << 40).unwrap_err().contains("shorter"));
        assert!(check_with(&parts, 1200, 10 * 480_000 - 1).unwrap_err().contains("memory"));
    }
}
