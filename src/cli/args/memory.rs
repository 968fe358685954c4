//! The option that limits memory.

use clap::Args;

use super::values::bytes;

/// How much memory may be used.
#[derive(Args, Clone, Copy, Debug)]
pub struct MemoryArg {
    /// Refuse, before anything is loaded, what would need more memory than this, as in 8GiB
    #[arg(long = "memory-limit", value_name = "SIZE", value_parser = bytes)]
    pub limit: Option<u64>,
}
