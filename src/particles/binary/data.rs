//! Bytes that are read at any place: a plain file, or memory with what was decompressed.

use std::fs::File;
use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::particles::budget::Budget;
use crate::particles::source::Source;
use crate::particles::trouble::{Outcome, Trouble, io_failure};

/// Bytes that are read at any place.
#[derive(Clone)]
pub(in crate::particles) struct Data {
    path: PathBuf,
    kind: Kind,
    /// Where these bytes begin in the file or the memory.
    start: u64,
    length: u64,
}

#[derive(Clone)]
enum Kind {
    File,
    Memory(Arc<Vec<u8>>),
}

/// Reads [`Data`] from the beginning, or from where it was sought.
pub(in crate::particles) enum DataReader {
    File(File, u64),
    Memory(Cursor<SharedBytes>),
}

/// Bytes with a shared owner.
pub(in crate::particles) struct SharedBytes(Arc<Vec<u8>>, std::ops::Range<usize>);

impl AsRef<[u8]> for SharedBytes {
    fn as_ref(&self) -> &[u8] {
        &self.0[self.1.clone()]
    }
}

impl Data {
    /// Takes a plain file as it is, and anything else into memory, as far as the budget goes.
    pub(in crate::particles) fn new(source: Source, budget: Budget) -> Outcome<Self> {
        let Source { path, head, rest, plain_length, .. } = source;
        if let Some(length) = plain_length {
            return Ok(Self { path, kind: Kind::File, start: 0, length });
        }
        let bytes = Self::collect(&path, head, rest, budget)?;
        Ok(Self::from_bytes(path, bytes))
    }

    /// Bytes in memory.
    pub(in crate::particles) fn from_bytes(path: PathBuf, bytes: Vec<u8>) -> Self {
        let length = bytes.len() as u64;
        Self { path, kind: Kind::Memory(Arc::new(bytes)), start: 0, length }
    }

    /// Reads everything after `bytes` into memory.
    pub(in crate::particles) fn collect(
        path: &Path,
        mut bytes: Vec<u8>,
        mut rest: impl Read,
        budget: Budget,
    ) -> Outcome<Vec<u8>> {
        const STEP: u64 = 16 << 20;
        loop {
            let read = rest.by_ref().take(STEP).read_to_end(&mut bytes);
            let read = read.map_err(|error| io_failure(path, error))?;
            budget.check(bytes.len() as u64)?;
            if (read as u64) < STEP {
                return Ok(bytes);
            }
        }
    }

    /// A part of these bytes.
    ///
    /// # Errors
    /// If they end before the part does; `what` names it.
    pub(in crate::particles) fn part(&self, start: u64, length: u64, what: &str) -> Outcome<Self> {
        if start.checked_add(length).is_none_or(|end| end > self.length) {
            let message = format!(
                "the file ends too early: {what} needs {length} bytes from byte {start} on, and \
                 the file has {}",
                self.length
            );
            return Err(Trouble::new(message).with_help("is it complete?").into());
        }
        Ok(Self { start: self.start + start, length, ..self.clone() })
    }

    /// The file.
    pub(in crate::particles) fn path(&self) -> &Path {
        &self.path
    }

    /// Number of bytes.
    pub(in crate::particles) fn len(&self) -> u64 {
        self.length
    }

    /// A reader of its own, at the beginning.
    pub(in crate::particles) fn reader(&self) -> io::Result<DataReader> {
        match &self.kind {
            Kind::File => {
                let mut file = File::open(&self.path)?;
                file.seek(SeekFrom::Start(self.start))?;
                Ok(DataReader::File(file, self.start))
            }
            Kind::Memory(bytes) => {
                let range = self.start as usize..(self.start + self.length) as usize;
                Ok(DataReader::Memory(Cursor::new(SharedBytes(Arc::clone(bytes), range))))
            }
        }
    }

    /// A few bytes, which exist.
    pub(in crate::particles) fn bytes(
        &self,
        start: u64,
        length: u64,
        what: &str,
    ) -> Outcome<Vec<u8>> {
        let part = self.part(start, length, what)?;
        let mut bytes = Vec::new();
        let read = part.reader().and_then(|r| r.take(length).read_to_end(&mut bytes));
        read.map_err(|error| self.failure(error))?;
        if (bytes.len() as u64) < length {
            return Err(self.failure(io::ErrorKind::UnexpectedEof.into()));
        }
        Ok(bytes)
    }

    /// A failure to read the bytes.
    pub(in crate::particles) fn failure(
        &self,
        error: io::Error,
    ) -> crate::particles::trouble::Failure {
        io_failure(&self.path, error)
    }
}

impl Read for DataReader {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::File(file, _) => file.read(to),
            Self::Memory(bytes) => bytes.read(to),
        }
    }
}

impl Seek for DataReader {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match self {
            Self::File(file, start) => {
                let to = match to {
                    SeekFrom::Start(at) => SeekFrom::Start(at.saturating_add(*start)),
                    other => other,
                };
                Ok(file.seek(to)?.saturating_sub(*start))
            }
            Self::Memory(bytes) => bytes.seek(to),
        }
    }
}

impl DataReader {
    /// Fills a buffer from a place on.
    pub(in crate::particles) fn read_at(&mut self, start: u64, to: &mut [u8]) -> io::Result<()> {
        self.seek(SeekFrom::Start(start))?;
        self.read_exact(to)
    }
}
