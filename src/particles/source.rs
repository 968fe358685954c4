//! A file, standard input or bytes in memory, decompressed.

use std::fs::File;
use std::io::{self, Cursor, Read};
use std::path::{Path, PathBuf};

use flate2::read::MultiGzDecoder;

use crate::error::Error;

use super::trouble::{Outcome, io_failure};
use super::zstd::ZstdReader;

/// Bytes at the beginning by which a format is recognised.
pub(super) const HEAD_BYTES: usize = 1 << 16;

/// What is read, with its beginning.
pub(super) struct Source {
    /// The name for messages; `-` is standard input.
    pub(super) path: PathBuf,
    /// The compression.
    pub(super) compression: Option<&'static str>,
    /// The first bytes, or all of them.
    pub(super) head: Vec<u8>,
    /// What follows the head.
    pub(super) rest: Box<dyn Read + Send>,
    /// Length of a plain file.
    pub(super) plain_length: Option<u64>,
}

impl Source {
    /// Opens a regular file, or standard input for `-`.
    pub(super) fn open(path: &Path) -> Outcome<Self> {
        if path == Path::new("-") {
            return Self::new(path, Box::new(io::stdin()), None);
        }
        let trouble = |error: io::Error| Error::file("read", path, error);
        let info = path.metadata().map_err(trouble)?;
        if info.is_dir() {
            return Err(Error::file("read", path, "it is a folder").into());
        }
        if !info.is_file() {
            let error = Error::file("read", path, "it is not a regular file");
            return Err(error
                .with_help("pipe it into standard input, and name the file `-`")
                .into());
        }
        let file = File::open(path).map_err(trouble)?;
        Self::new(path, Box::new(file), Some(info.len()))
    }

    /// Bytes in memory, with a name for messages.
    pub(super) fn from_bytes(path: &Path, bytes: Vec<u8>) -> Outcome<Self> {
        Self::new(path, Box::new(Cursor::new(bytes)), None)
    }

    fn new(path: &Path, raw: Box<dyn Read + Send>, length: Option<u64>) -> Outcome<Self> {
        let path = path.to_owned();
        let (head, rest) = split_head(raw).map_err(|e| io_failure(&path, e))?;
        let mut source = Self { path, compression: None, head, rest, plain_length: length };
        let compression = match source.head[..] {
            [0x1f, 0x8b, ..] => Some("gzip"),
            // A frame, or a skippable one.
            [0x28, 0xb5, 0x2f, 0xfd, ..] | [0x50..=0x5f, 0x2a, 0x4d, 0x18, ..] => Some("zstd"),
            _ => None,
        };
        if compression.is_some() {
            source.compression = compression;
            source.plain_length = None;
            let whole = Cursor::new(std::mem::take(&mut source.head)).chain(source.rest);
            let reader: Box<dyn Read + Send> = match compression {
                Some("gzip") => Box::new(MultiGzDecoder::new(whole)),
                _ => Box::new(ZstdReader::new(Box::new(whole))),
            };
            (source.head, source.rest) =
                split_head(reader).map_err(|e| io_failure(&source.path, e))?;
        }
        Ok(source)
    }

    /// Returns true if the head is everything.
    pub(super) fn is_short(&self) -> bool {
        self.head.len() < HEAD_BYTES
    }
}

fn split_head(mut from: Box<dyn Read + Send>) -> io::Result<(Vec<u8>, Box<dyn Read + Send>)> {
    let mut head = Vec::new();
    from.by_ref().take(HEAD_BYTES as u64).read_to_end(&mut head)?;
    Ok((head, from))
}
