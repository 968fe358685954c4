//! Build options.

use std::str::FromStr;

use crate::error::{Error, Result};
use crate::names::named_enum;
use crate::task::{CancelToken, ProgressCallback};

use super::native::KernelIsa;

/// Options for building a backend.
#[derive(Clone, Debug, Default)]
pub struct BuildOptions {
    /// Threads for Embree's own build; 0 means all. The native backend builds on the current rayon
    /// pool.
    pub threads: usize,
    /// Build quality of the native backend.
    pub quality: BuildQuality,
    /// Receives the progress of the build.
    pub progress: ProgressCallback,
    /// The variant of the native kernel; `None` selects the fastest one available.
    pub isa: Option<KernelIsa>,
    /// Cancels the build, which then fails with a cancellation error.
    pub cancel: CancelToken,
}

/// The trade-off between build time and tracing speed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BuildQuality {
    /// For renders that take longer than the build.
    #[default]
    Best,
    /// For previews: builds three times faster, traces up to 10 % slower.
    Fast,
}

impl BuildQuality {
    /// Every quality.
    pub const ALL: &[Self] = &[Self::Best, Self::Fast];
}

named_enum! { BuildQuality { Best = "best", Fast = "fast" } }

impl FromStr for BuildQuality {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        Self::named(name).ok_or_else(|| Error::input(format!("there is no build `{name}`")))
    }
}
