//! How a backend is built.

use std::str::FromStr;

use crate::error::{Error, Result};
use crate::names::named_enum;
use crate::task::{CancelToken, ProgressCallback};

use super::native::KernelIsa;

/// How a backend is built.
#[derive(Clone, Debug, Default)]
pub struct BuildOptions {
    /// Threads that Embree's own build may use; 0 means all. The native backend builds on the
    /// current rayon pool.
    pub threads: usize,
    /// How much care the native backend takes.
    pub quality: BuildQuality,
    /// Told how far a build is.
    pub progress: ProgressCallback,
    /// The form of the native kernel; the fastest that there is where `None`.
    pub isa: Option<KernelIsa>,
    /// Set from elsewhere to stop the build, which then fails with a cancellation.
    pub cancel: CancelToken,
}

/// How much care a build takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BuildQuality {
    /// For pictures that take longer than the build.
    #[default]
    Best,
    /// Three times faster to build, and up to a tenth slower to trace: for previews.
    Fast,
}

impl BuildQuality {
    /// Every kind of care.
    pub const ALL: &[Self] = &[Self::Best, Self::Fast];
}

named_enum! { BuildQuality { Best = "best", Fast = "fast" } }

impl FromStr for BuildQuality {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        Self::named(name).ok_or_else(|| Error::input(format!("there is no build `{name}`")))
    }
}
