//! The variants of the kernel, and which of them this processor supports.

use crate::fault::{VectorWidth, allows};

/// A variant of the kernel. All variants return the same hits, bit for bit, because all test their
/// candidates with the same f64 routine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KernelIsa {
    /// The instruction set of the whole program.
    Portable,
    /// AVX2 and FMA.
    Avx2,
    /// AVX-512VL; requires a compiler since Rust 1.89.
    Avx512,
}

impl KernelIsa {
    /// Every variant, the fastest last.
    pub const ALL: &[Self] = &[Self::Portable, Self::Avx2, Self::Avx512];

    /// The name of the variant.
    pub fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2 => "AVX2",
            Self::Avx512 => "AVX-512",
        }
    }

    /// Returns true if this build contains the variant, whatever the processor.
    pub fn is_compiled(self) -> bool {
        match self {
            Self::Portable => true,
            Self::Avx2 => cfg!(target_arch = "x86_64"),
            Self::Avx512 => cfg!(all(target_arch = "x86_64", has_avx512)),
        }
    }

    /// Returns true if this build contains the variant and this processor supports it.
    pub fn is_available(self) -> bool {
        match self {
            Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => has_avx2(),
            #[cfg(all(target_arch = "x86_64", has_avx512))]
            Self::Avx512 => {
                allows(VectorWidth::Avx512) && has_avx2() && is_x86_feature_detected!("avx512vl")
            }
            #[allow(unreachable_patterns, reason = "which are left depends on the build")]
            _ => false,
        }
    }

    /// The fastest available variant.
    pub fn best() -> Self {
        let mut available = Self::ALL.iter().rev().filter(|isa| isa.is_available());
        available.next().copied().unwrap_or(Self::Portable)
    }
}

#[cfg(target_arch = "x86_64")]
fn has_avx2() -> bool {
    allows(VectorWidth::Avx2)
        && is_x86_feature_detected!("avx2")
        && is_x86_feature_detected!("fma")
        && is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("bmi2")
        && is_x86_feature_detected!("lzcnt")
        && is_x86_feature_detected!("popcnt")
}
