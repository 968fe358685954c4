//! Magic bytes and versions of the checkpoint format.

/// The first bytes of every checkpoint.
pub(super) const MAGIC: [u8; 8] = *b"PHSPPART";

/// The current format version; every change increments it.
pub(super) const VERSION: u32 = 3;

/// The oldest format version that can be read.
pub(super) const MIN_VERSION: u32 = 3;
