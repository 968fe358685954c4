//! The option that limits memory.

use clap::Args;

use super::values::bytes;

/// How much memory may be used.
#[derive(Args, Clone, Copy, Debug)]
pub struct MemoryArg {
    /// Refuse a scene that needs more memory than this, such as 8GiB, before loading it
    #[arg(long = "memory-limit", value_name = "SIZE", value_parser = bytes)]
    pub limit: Option<u64>,
}
