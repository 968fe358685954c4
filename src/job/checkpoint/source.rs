//! Where a checkpoint is read from: a file, or bytes in memory.

use std::fs::File;
use std::io::{self, BufReader, Cursor, Read};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

/// Bytes of a checkpoint, of known length.
#[derive(Debug)]
pub(super) enum Source {
    File { path: PathBuf, length: u64, reader: BufReader<File> },
    Memory(Cursor<Vec<u8>>),
}

impl Source {
    /// Opens a file.
    ///
    /// # Errors
    /// If the file cannot be opened, or is not a regular file.
    pub(super) fn open(path: &Path) -> Result<Self> {
        let trouble = |e: io::Error| Error::file("read", path, e);
        let metadata = path.metadata().map_err(trouble)?;
        if metadata.is_dir() {
            return Err(Error::file("read", path, "it is a folder"));
        }
        // Opening a pipe waits for a writer.
        if !metadata.is_file() {
            return Err(Error::file("read", path, "it is not a regular file"));
        }
        let file = File::open(path).map_err(trouble)?;
        let reader = BufReader::with_capacity(1 << 16, file);
        Ok(Self::File { path: path.to_path_buf(), length: metadata.len(), reader })
    }

    pub(super) fn from_bytes(bytes: Vec<u8>) -> Self {
        Self::Memory(Cursor::new(bytes))
    }

    /// Number of bytes, read or not.
    pub(super) fn length(&self) -> u64 {
        match self {
            Self::File { length, .. } => *length,
            Self::Memory(bytes) => bytes.get_ref().len() as u64,
        }
    }

    pub(super) fn path(&self) -> Option<&Path> {
        match self {
            Self::File { path, .. } => Some(path),
            Self::Memory(_) => None,
        }
    }
}

impl Read for Source {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::File { reader, .. } => reader.read(to),
            Self::Memory(bytes) => bytes.read(to),
        }
    }
}
