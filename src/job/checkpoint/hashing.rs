//! Hashing wrappers around streams.

use std::io::{self, Read, Write};

use blake3::Hasher;

use super::read_error::ReadError;

/// A stream that hashes every byte read or written.
#[derive(Debug)]
pub(super) struct HashingStream<S> {
    pub(super) inner: S,
    hasher: Hasher,
    /// Number of bytes read.
    bytes_read: u64,
}

impl<S> HashingStream<S> {
    pub(super) fn new(inner: S) -> Self {
        Self { inner, hasher: Hasher::new(), bytes_read: 0 }
    }
}

impl<S: Write> HashingStream<S> {
    pub(super) fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.hasher.update(bytes);
        self.inner.write_all(bytes)
    }

    pub(super) fn write_hash(&mut self) -> io::Result<()> {
        let hash = self.hasher.finalize();
        self.write_all(hash.as_bytes())
    }
}

impl<S: Read> HashingStream<S> {
    pub(super) fn read_exact(&mut self, bytes: &mut [u8]) -> std::result::Result<(), ReadError> {
        let mut filled = 0;
        while filled < bytes.len() {
            match self.inner.read(&mut bytes[filled..]) {
                Ok(0) => return Err(ReadError::Truncated(self.bytes_read + filled as u64)),
                Ok(count) => filled += count,
                Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
                Err(e) => return Err(ReadError::Io(e)),
            }
        }
        self.bytes_read += filled as u64;
        self.hasher.update(bytes);
        Ok(())
    }

    pub(super) fn read_u32(&mut self) -> std::result::Result<u32, ReadError> {
        let mut bytes = [0; 4];
        self.read_exact(&mut bytes)?;
        Ok(u32::from_le_bytes(bytes))
    }

    pub(super) fn verify_hash(&mut self) -> std::result::Result<(), ReadError> {
        let expected = self.hasher.finalize();
        let mut hash = [0; 32];
        self.read_exact(&mut hash)?;
        let is_same = expected == hash;
        is_same.then_some(()).ok_or(ReadError::Corrupt("its checksum is wrong"))
    }
}
