//! How a checkpoint begins.

/// The first bytes of every one.
pub(super) const MAGIC: [u8; 8] = *b"PHSPPART";

/// The version of the format; it grows with every change.
pub(super) const VERSION: u32 = 2;

/// The oldest version that is read.
pub(super) const MIN_VERSION: u32 = 2;
