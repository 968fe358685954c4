//! Estimates of a backend's memory use before it is built.

use super::Backend;

/// Bytes held by a backend, without the spheres themselves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MemoryEstimate {
    /// After the build.
    pub built: u64,
    /// The maximum during the build.
    pub peak: u64,
}

impl Backend {
    /// Estimates the memory for this many spheres: bytes per sphere, measured on random and
    /// clustered scenes of at least a million spheres. Other scenes differ by a few percent. Giants
    /// count as spheres.
    pub fn memory_estimate(self, spheres: u64) -> MemoryEstimate {
        let n = spheres as f64;
        let [built, peak] = match self {
            Self::BruteForce => [0.0, 0.0],
            // Treelets are built in batches of a million spheres, in addition to the tree so far.
            Self::Native => [34.0 * n, 34.0 * n + 42.0 * n.min(1e6)],
            // Embree allocates several megabytes at once.
            Self::Embree => [48.0 * n, 50.0 * n].map(|bytes| bytes + (10.0 * n).min(6e6)),
            Self::EmbreeUser => [77.0 * n, 119.0 * n],
        };
        MemoryEstimate { built: built as u64, peak: peak as u64 }
    }
}
