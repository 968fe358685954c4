//! How much memory a backend takes, known before it is built.

use super::Backend;

/// Bytes that a backend holds, without the spheres themselves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MemoryEstimate {
    /// Once it is built.
    pub built: u64,
    /// The most at any time while it is built.
    pub peak: u64,
}

impl Backend {
    /// What building over so many spheres takes: bytes of each, as measured on random and on clustered
    /// spheres from a million upwards; other scenes differ by some percent. Giants count like other
    /// spheres.
    pub fn memory_estimate(self, spheres: u64) -> MemoryEstimate {
        let n = spheres as f64;
        let [finished, peak] = match self {
            Self::BruteForce => [0.0, 0.0],
            // Cells are built in waves of a million spheres, beside the tree that has grown so far.
            Self::Native => [34.0 * n, 34.0 * n + 42.0 * n.min(1e6)],
            // Embree takes some millions of bytes at once.
            Self::Embree => [32.0 * n, 32.2 * n].map(|bytes| bytes + (10.0 * n).min(6e6)),
            Self::EmbreeUser => [77.0 * n, 119.0 * n],
        };
        MemoryEstimate { built: finished as u64, peak: peak as u64 }
    }
}
