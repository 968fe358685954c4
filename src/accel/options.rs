//! How a backend is built.

use std::str::FromStr;

use crate::error::{Error, Result};
use crate::names::named;
use crate::task::{Cancel, Progress};

use super::native::Instance;

/// How a backend is built.
#[derive(Clone, Debug, Default)]
pub struct BuildOptions {
    /// Threads that Embree's own build may use; 0 means all. The native backend builds on the
    /// current rayon pool.
    pub threads: usize,
    /// How much care the native backend takes.
    pub quality: Quality,
    /// Told how far a build is.
    pub progress: Progress,
    /// The form of the native kernel; the fastest that there is where `None`.
    pub instance: Option<Instance>,
    /// Set from elsewhere to stop the build, which then fails with a cancellation.
    pub cancel: Cancel,
}

/// How much care a build takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// For pictures that take longer than the build.
    #[default]
    Best,
    /// Three times faster to build, and up to a tenth slower to trace: for previews.
    Fast,
}

impl Quality {
    /// Every kind of care.
    pub const ALL: &[Self] = &[Self::Best, Self::Fast];
}

named! { Quality { Best = "best", Fast = "fast" } }

impl FromStr for Quality {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        Self::named(name).ok_or_else(|| Error::input(format!("there is no build `{name}`")))
    }
}
