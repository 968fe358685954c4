//! Which vector instructions a stage over many lanes is run with: chosen once, at run time.
//!
//! A [`SimdKernel`] is plain code: loops over arrays, whose bodies are the same functions that serve one
//! path. It is compiled once for every instruction set, and the compiler turns its loops into vector
//! instructions. Arithmetic is the same in all of them, operation by operation: nothing is fused,
//! reordered or approximated. So the results have the same bits, and `tests/transport/lanes.rs`
//! holds them to that.
//!
//! The `unsafe` here, and its argument: a function compiled for an instruction set may be called
//! where the processor has it. An [`Isa`] other than the portable one is made only in [`Isa::all`],
//! which asks the processor.

use std::sync::LazyLock;

/// Instructions that this processor has.
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

/// Work to be compiled for several instruction sets.
pub trait SimdKernel {
    /// Does the work. To be inlined always, and so must be the functions whose loops are to become
    /// vector instructions.
    fn run(self);
}

impl Isa {
    /// What every processor of this kind has.
    pub const PORTABLE: Self = Self(Level::Portable);

    /// All that this processor has and this build knows, the widest last.
    pub fn available() -> Vec<Self> {
        let mut found = vec![Self::PORTABLE];
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx2") {
                found.push(Self(Level::Avx2));
            }
            #[cfg(has_avx512)]
            if is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512bw")
                && is_x86_feature_detected!("avx512vl")
            {
                found.push(Self(Level::Avx512));
            }
        }
        found
    }

    /// The widest of them.
    pub fn best() -> Self {
        static BEST: LazyLock<Isa> =
            LazyLock::new(|| Isa::available().pop().unwrap_or(Isa::PORTABLE));
        *BEST
    }

    /// The name that a reader knows.
    pub fn name(self) -> &'static str {
        match self.0 {
            Level::Portable => "portable",
            #[cfg(target_arch = "x86_64")]
            Level::Avx2 => "AVX2",
            #[cfg(all(target_arch = "x86_64", has_avx512))]
            Level::Avx512 => "AVX-512",
        }
    }

    /// Runs a stage with these instructions.
    #[inline(always)]
    pub fn run(self, stage: impl SimdKernel) {
        match self.0 {
            Level::Portable => stage.run(),
            // SAFETY: only `all` makes this kind, where the processor has the instructions.
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
