//! Streams that keep count of what goes by.

use std::io::{self, Read, Write};

use blake3::Hasher;

use super::bad::Bad;

/// A stream whose bytes are hashed as they go by.
#[derive(Debug)]
pub(super) struct Hashing<S> {
    pub(super) inner: S,
    hasher: Hasher,
    /// How many have been read.
    bytes: u64,
}

impl<S> Hashing<S> {
    pub(super) fn new(inner: S) -> Self {
        Self { inner, hasher: Hasher::new(), bytes: 0 }
    }
}

impl<S: Write> Hashing<S> {
    pub(super) fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.hasher.update(bytes);
        self.inner.write_all(bytes)
    }

    pub(super) fn write_hash(&mut self) -> io::Result<()> {
        let hash = self.hasher.finalize();
        self.write_all(hash.as_bytes())
    }
}

impl<S: Read> Hashing<S> {
    pub(super) fn fill(&mut self, bytes: &mut [u8]) -> std::result::Result<(), Bad> {
        let mut filled = 0;
        while filled < bytes.len() {
            match self.inner.read(&mut bytes[filled..]) {
                Ok(0) => return Err(Bad::CutOff(self.bytes + filled as u64)),
                Ok(count) => filled += count,
                Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
                Err(e) => return Err(Bad::Unreadable(e)),
            }
        }
        self.bytes += filled as u64;
        self.hasher.update(bytes);
        Ok(())
    }

    pub(super) fn u32(&mut self) -> std::result::Result<u32, Bad> {
        let mut bytes = [0; 4];
        self.fill(&mut bytes)?;
        Ok(u32::from_le_bytes(bytes))
    }

    pub(super) fn check_hash(&mut self) -> std::result::Result<(), Bad> {
        let expected = self.hasher.finalize();
        let mut hash = [0; 32];
        self.fill(&mut hash)?;
        let is_same = expected == hash;
        is_same.then_some(()).ok_or(Bad::Damaged("its checksum is wrong"))
    }
}
