//! Run-time selection of the vector instructions for stages that work on lanes.
//!
//! A [`SimdKernel`] is plain code: loops over arrays, whose bodies are the same functions that
//! handle a single path. It is compiled once for every instruction set, and the compiler vectorises
//! its loops. Arithmetic is the same in all of them, operation by operation: nothing is fused,
//! reordered or approximated. So the results are bit-identical, which `tests/transport/lanes.rs`
//! checks.
//!
//! The `unsafe` here, and its argument: a function compiled for an instruction set may be called on
//! a processor that supports it. An [`Isa`] other than the portable one is created only in
//! [`Isa::available`], which queries the processor.

use crate::fault::{VectorWidth, allows};

/// An instruction set that this processor supports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Isa(Level);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Level {
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(all(target_arch = "x86_64", has_avx512))]
    Avx512,
}

/// A kernel to be compiled for several instruction sets.
pub trait SimdKernel {
    /// Runs the kernel. Must always be inlined, and so must the functions whose loops are to be
    /// vectorised.
    fn run(self);
}

impl Isa {
    /// The baseline instruction set of the target architecture.
    pub const PORTABLE: Self = Self(Level::Portable);

    /// Returns all instruction sets that this processor and this build support, the widest last.
    pub fn available() -> Vec<Self> {
        let mut found = vec![Self::PORTABLE];
        #[cfg(target_arch = "x86_64")]
        {
            if allows(VectorWidth::Avx2)
                && is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("bmi1")
                && is_x86_feature_detected!("bmi2")
                && is_x86_feature_detected!("lzcnt")
                && is_x86_feature_detected!("popcnt")
            {
                found.push(Self(Level::Avx2));
            }
            #[cfg(has_avx512)]
            if allows(VectorWidth::Avx512)
                && is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512bw")
                && is_x86_feature_detected!("avx512vl")
            {
                found.push(Self(Level::Avx512));
            }
        }
        found
    }

    /// Returns the widest available instruction set.
    pub fn best() -> Self {
        Self::available().pop().unwrap_or(Self::PORTABLE)
    }

    /// Returns the display name.
    pub fn name(self) -> &'static str {
        match self.0 {
            Level::Portable => "portable",
            #[cfg(target_arch = "x86_64")]
            Level::Avx2 => "AVX2",
            #[cfg(all(target_arch = "x86_64", has_avx512))]
            Level::Avx512 => "AVX-512",
        }
    }

    /// Returns true if it has AVX2, with what every processor with AVX2 has: BMI1, BMI2, LZCNT and
    /// POPCNT.
    #[cfg(target_arch = "x86_64")]
    pub(super) fn has_avx2(self) -> bool {
        self.0 != Level::Portable
    }

    /// Runs a kernel with this instruction set.
    #[inline(always)]
    pub fn run(self, stage: impl SimdKernel) {
        match self.0 {
            Level::Portable => stage.run(),
            // SAFETY: only `available` creates this variant, on processors that have the
            // instructions.
            #[cfg(target_arch = "x86_64")]
            Level::Avx2 => unsafe { avx2(stage) },
            // SAFETY: as above.
            #[cfg(all(target_arch = "x86_64", has_avx512))]
            Level::Avx512 => unsafe { avx512(stage) },
        }
    }
}

impl Default for Isa {
    fn default() -> Self {
        Self::best()
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
unsafe fn avx2(stage: impl SimdKernel) {
    stage.run();
}

#[cfg(all(target_arch = "x86_64", has_avx512))]
#[target_feature(enable = "avx512f,avx512dq,avx512bw,avx512vl")]
unsafe fn avx512(stage: impl SimdKernel) {
    stage.run();
}
