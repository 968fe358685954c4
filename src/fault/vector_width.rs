//! A limit on vector instructions, for tests: a processor with AVX-512 then also runs what it would
//! run without.
//!
//! Without the feature `faults`, the limit is a constant that allows everything.

/// Sets of vector instructions, each containing those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(not(feature = "faults"), allow(unreachable_pub, reason = "one list for both"))]
pub enum VectorWidth {
    /// The baseline of the target architecture.
    Portable,
    /// Up to AVX2.
    Avx2,
    /// Up to AVX-512.
    Avx512,
}

/// Returns true if these instructions may be used where the processor has them: always, in this
/// build.
#[cfg(not(feature = "faults"))]
pub(crate) const fn allows(width: VectorWidth) -> bool {
    width as u8 >= VectorWidth::Portable as u8
}

/// Returns true if these instructions may be used where the processor has them.
#[cfg(feature = "faults")]
pub(crate) fn allows(width: VectorWidth) -> bool {
    width as u8 <= WIDEST.load(std::sync::atomic::Ordering::Relaxed)
}

/// Limits the whole process to these instructions. Intersectors and workspaces that exist already
/// keep theirs.
#[cfg(feature = "faults")]
pub fn limit_vectors(widest: VectorWidth) {
    WIDEST.store(widest as u8, std::sync::atomic::Ordering::Relaxed);
}

/// Number of the widest allowed instructions.
#[cfg(feature = "faults")]
static WIDEST: std::sync::atomic::AtomicU8 =
    std::sync::atomic::AtomicU8::new(VectorWidth::Avx512 as u8);
