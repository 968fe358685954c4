//! The kernel: a batch of rays through the tree, sixteen at a time, one step of each in turn.
//!
//! While one ray waits for its next node to come from memory, the others take a step: the cache
//! misses of sixteen rays overlap. That pays only because a step has no branch that depends on what
//! is hit: eight boxes, eight distances, a sorting network and a store that always writes eight
//! entries. docs/performance.md draws it.
//!
//! # Why the unsafe code is sound
//!
//! * **Instructions.** An [`Instance`] other than `Portable` exists only where the processor was
//!   found to have its instructions ([`Instance::is_available`]), and only [`Instance`]'s own functions
//!   enter the code that is compiled for them.
//! * **Places in the tree.** A `Tree` is made by the builder alone and never changes. Every
//!   `Child` in it is the number of one of its own nodes or leaves, which is asserted
//!   ([`Tree::new`](super::tree::Tree::new)); lanes beyond a node's children have boxes that no ray meets. There are as many
//!   ids as leaves.
//! * **The stack.** A node takes one entry and leaves up to eight, and no tree is deeper than
//!   `LEVELS`, which the builder sees to by halving what is left. [`STACK_SIZE`](super::tree::STACK_SIZE) has room for that,
//!   and for the eight entries that a step always writes.
//! * **Uninitialised memory.** A slot is only read after `begin` has set it. Of its arrays, only what
//!   lies below their counts is read.
//! * **Batches.** Answers are written through the index of a ray, and there are as many as rays,
//!   which is asserted.

mod beam;
mod lanes;
mod packet;
mod pending;
mod single;
mod slabs;
mod slot;
mod spheres;

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(all(target_arch = "x86_64", has_avx512))]
#[allow(clippy::incompatible_msrv, reason = "build.rs asks the compiler for its version")]
mod avx512;
#[cfg(target_arch = "x86_64")]
mod x86;

mod flight;
pub(super) mod pages;

pub(super) use slot::KEPT;

use crate::math::{Hit, Ray};

use super::Native;
use flight::{Any, Closest, Question};
use lanes::{Lanes, Portable};

/// The forms in which the kernel is compiled. All give the same answers, bit for bit, as each judges
/// its candidates by the same f64 routine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instance {
    /// In the instructions of the whole program.
    Portable,
    /// AVX2 and FMA.
    Avx2,
    /// AVX-512VL; only from compilers since Rust 1.89.
    Avx512,
}

impl Instance {
    /// Every form there is, the fastest last.
    pub const ALL: &[Self] = &[Self::Portable, Self::Avx2, Self::Avx512];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2 => "AVX2",
            Self::Avx512 => "AVX-512",
        }
    }

    /// Whether this program has it and this processor runs it.
    pub fn is_available(self) -> bool {
        match self {
            Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => has_avx2(),
            #[cfg(all(target_arch = "x86_64", has_avx512))]
            Self::Avx512 => has_avx2() && is_x86_feature_detected!("avx512vl"),
            #[allow(unreachable_patterns, reason = "which are left depends on the build")]
            _ => false,
        }
    }

    /// The fastest that is available.
    pub fn best() -> Self {
        let mut available = Self::ALL.iter().rev().filter(|instance| instance.is_available());
        available.next().copied().unwrap_or(Self::Portable)
    }
}

#[cfg(target_arch = "x86_64")]
fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2")
        && is_x86_feature_detected!("fma")
        && is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("bmi2")
        && is_x86_feature_detected!("lzcnt")
        && is_x86_feature_detected!("popcnt")
}

/// # Panics
/// When the slices differ in length.
pub(super) fn closest(native: &Native, rays: &[Ray], hits: &mut [Hit]) {
    trace::<Closest>(native, rays, hits);
}

/// # Panics
/// When the slices differ in length.
pub(super) fn occluded(native: &Native, rays: &[Ray], blocked: &mut [bool]) {
    trace::<Any>(native, rays, blocked);
}

fn trace<Q: Question>(native: &Native, rays: &[Ray], answers: &mut [Q::Answer]) {
    assert_eq!(rays.len(), answers.len(), "one answer for each ray");
    assert!(rays.len() <= u32::MAX as usize, "a batch has fewer than 2^32 rays");
    match native.instance {
        #[cfg(target_arch = "x86_64")]
        Instance::Avx2 if Instance::Avx2.is_available() => {
            // SAFETY: the instructions are there.
            unsafe { avx2_form::<Q>(native, rays, answers) }
        }
        #[cfg(all(target_arch = "x86_64", has_avx512))]
        Instance::Avx512 if Instance::Avx512.is_available() => {
            // SAFETY: the instructions are there.
            unsafe { avx512_form::<Q>(native, rays, answers) }
        }
        // SAFETY: this form needs no special instructions.
        _ => unsafe { form::<Portable, Q>(native, rays, answers) },
    }
}

/// # Safety
/// Needs the instructions of `L`, and as many answers as rays.
#[inline(always)]
unsafe fn form<L: Lanes, Q: Question>(native: &Native, rays: &[Ray], answers: &mut [Q::Answer]) {
    // SAFETY: the caller's promise.
    unsafe {
        if native.tree.root.is_some() {
            flight::fly::<L, Q>(native, rays, answers);
        } else {
            flight::walk::<L, Q>(native, rays, answers);
        }
    }
}

/// # Safety
/// Needs the features named, and as many answers as rays.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
unsafe fn avx2_form<Q: Question>(native: &Native, rays: &[Ray], answers: &mut [Q::Answer]) {
    // SAFETY: the caller's promise.
    unsafe { form::<avx2::Avx2, Q>(native, rays, answers) }
}

/// # Safety
/// Needs the features named, and as many answers as rays.
#[cfg(all(target_arch = "x86_64", has_avx512))]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt,avx512f,avx512vl")]
unsafe fn avx512_form<Q: Question>(native: &Native, rays: &[Ray], answers: &mut [Q::Answer]) {
    // SAFETY: the caller's promise.
    unsafe { form::<avx512::Avx512, Q>(native, rays, answers) }
}
