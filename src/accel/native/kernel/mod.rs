//! The kernel: traces a batch of rays through the tree, sixteen at a time, one step of each in
//! turn.
//!
//! While one ray waits for its next node from memory, the others take a step, so the cache misses
//! of sixteen rays overlap. This pays off only because a step has no branch that depends on the
//! hits: eight boxes, eight distances, a sorting network and a store that always writes eight
//! entries. docs/performance.md illustrates it.
//!
//! # Why the unsafe code is sound
//!
//! * **Instructions.** A [`KernelIsa`] other than `Portable` exists only where the processor was
//!   found to support its instructions ([`KernelIsa::is_available`]), and code compiled for them is
//!   entered only after that check.
//! * **Indices in the tree.** A `Bvh` is created only by the builder and never changes. Every
//!   `NodeRef` in it is the index of one of its own nodes or leaves, which is asserted
//!   ([`Bvh::new`](super::bvh::Bvh::new)); unused lanes of a node have boxes that no ray hits.
//!   There are as many ids as leaves.
//! * **The stack.** A node pops one entry and pushes up to eight, and no tree is deeper than
//!   `MAX_DEPTH`, which the builder guarantees by halving.
//!   [`STACK_SIZE`](super::limits::STACK_SIZE) has room for that, and for the eight entries that a
//!   step always writes.
//! * **Uninitialised memory.** A slot is only read after `init` has set it. Of its arrays, only
//!   entries below their counts are read.
//! * **Batches.** Outputs are written through the index of a ray, and there are as many as rays,
//!   which is asserted.

mod batch;
mod candidates;
mod cone;
pub(super) mod huge_pages;
mod isa;
mod packet;
mod query_mode;
mod ray_state;
mod scalar;
mod simd;
mod single;
mod slabs;
mod spheres;
mod traverse;

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(all(target_arch = "x86_64", has_avx512))]
#[allow(clippy::incompatible_msrv, reason = "build.rs asks the compiler for its version")]
mod avx512;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use isa::KernelIsa;

use crate::accel::native::aggregate::Aggregate;
use crate::math::{Hit, Ray};

use query_mode::{AnyHit, ClosestHit};
use simd::{Portable, Simd8};
use traverse::TraceBatch;

/// # Panics
/// When the slices differ in length.
pub(super) fn closest(isa: KernelIsa, bvh: &Aggregate, rays: &[Ray], hits: &mut [Hit]) {
    dispatch::<ClosestHit>(isa, bvh, rays, hits);
}

/// # Panics
/// When the slices differ in length.
pub(super) fn occluded(isa: KernelIsa, bvh: &Aggregate, rays: &[Ray], occluded: &mut [bool]) {
    dispatch::<AnyHit>(isa, bvh, rays, occluded);
}

fn dispatch<Q: TraceBatch>(
    isa: KernelIsa,
    bvh: &Aggregate,
    rays: &[Ray],
    outputs: &mut [Q::Output],
) {
    assert_eq!(rays.len(), outputs.len(), "one output per ray");
    assert!(rays.len() <= u32::MAX as usize, "a batch has fewer than 2^32 rays");
    match isa {
        #[cfg(target_arch = "x86_64")]
        KernelIsa::Avx2 if KernelIsa::Avx2.is_available() => {
            // SAFETY: the CPU supports the instructions.
            unsafe { run_avx2::<Q>(bvh, rays, outputs) }
        }
        #[cfg(all(target_arch = "x86_64", has_avx512))]
        KernelIsa::Avx512 if KernelIsa::Avx512.is_available() => {
            // SAFETY: the CPU supports the instructions.
            unsafe { run_avx512::<Q>(bvh, rays, outputs) }
        }
        // SAFETY: this variant needs no special instructions.
        _ => unsafe { run::<Portable, Q>(bvh, rays, outputs) },
    }
}

/// # Safety
/// The CPU supports `L`, and there are as many outputs as rays.
#[inline(always)]
unsafe fn run<L: Simd8, Q: TraceBatch>(bvh: &Aggregate, rays: &[Ray], outputs: &mut [Q::Output]) {
    // SAFETY: upheld by the caller.
    unsafe {
        if bvh.tree.root.is_some() {
            traverse::traverse::<L, Q>(bvh, rays, outputs);
        } else {
            traverse::scan_leaves::<L, Q>(bvh, rays, outputs);
        }
    }
}

/// # Safety
/// The CPU supports the features named, and there are as many outputs as rays.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
unsafe fn run_avx2<Q: TraceBatch>(bvh: &Aggregate, rays: &[Ray], outputs: &mut [Q::Output]) {
    // SAFETY: upheld by the caller.
    unsafe { run::<avx2::Avx2, Q>(bvh, rays, outputs) }
}

/// # Safety
/// The CPU supports the features named, and there are as many outputs as rays.
#[cfg(all(target_arch = "x86_64", has_avx512))]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt,avx512f,avx512vl")]
unsafe fn run_avx512<Q: TraceBatch>(bvh: &Aggregate, rays: &[Ray], outputs: &mut [Q::Output]) {
    // SAFETY: upheld by the caller.
    unsafe { run::<avx512::Avx512, Q>(bvh, rays, outputs) }
}
