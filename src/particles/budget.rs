//! How much memory a reader may take.

use crate::task::available_memory;

use super::trouble::Trouble;

/// Memory that reading may take where the free memory is unknown.
const DEFAULT_MEMORY: u64 = 16 << 30;

/// A limit for the bytes that a reader holds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Budget {
    limit: u64,
}

impl Budget {
    /// A limit given by the user, or else by the free memory.
    pub(super) fn new(limit: Option<u64>) -> Self {
        Self { limit: limit.or_else(available_memory).unwrap_or(DEFAULT_MEMORY) }
    }

    /// Refuses to hold more bytes than the limit.
    pub(super) fn check(self, bytes: u64) -> Result<(), Trouble> {
        if bytes <= self.limit {
            return Ok(());
        }
        let mebibytes = self.limit >> 20;
        Err(Trouble::new(format!("its particles do not fit into {mebibytes} MiB of memory"))
            .with_help("read fewer columns, or set a larger memory limit"))
    }
}
