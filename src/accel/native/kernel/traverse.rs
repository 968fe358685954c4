//! Traversal of a batch: rays take steps in turn until all are resolved.

use std::mem::MaybeUninit;

use crate::accel::native::aggregate::Aggregate;
use crate::math::Ray;

use super::batch::RayBatch;
use super::candidates::CandidateQueue;
use super::packet::{PACKET_SIZE, PacketStatus, RayPacket};
use super::query_mode::{AnyHit, ClosestHit, QueryMode};
use super::ray_state::RayState;
use super::simd::Simd8;
use super::single::{prefetch, trace_single_rays};

/// Number of active packets.
const ACTIVE_PACKETS: usize = 4;

/// How a batch is traced in a query mode.
pub(super) trait TraceBatch: QueryMode + Sized {
    /// Traces the rays of a batch. Rays that await the exact test stay pending.
    ///
    /// # Safety
    /// As for [`traverse`].
    unsafe fn trace<L: Simd8>(batch: &mut RayBatch<'_, Self>, pending: &mut CandidateQueue);
}

impl TraceBatch for ClosestHit {
    #[inline(always)]
    unsafe fn trace<L: Simd8>(batch: &mut RayBatch<'_, Self>, pending: &mut CandidateQueue) {
        // SAFETY: upheld by the caller.
        unsafe { trace_packets::<L>(batch, pending) };
    }
}

impl TraceBatch for AnyHit {
    #[inline(always)]
    unsafe fn trace<L: Simd8>(batch: &mut RayBatch<'_, Self>, pending: &mut CandidateQueue) {
        // SAFETY: upheld by the caller.
        unsafe { trace_single_rays::<L, Self>(batch, pending) };
    }
}

/// Resolves all rays of a batch: coherent rays in packets, the others one by one.
///
/// # Safety
/// The CPU supports `L`, and there are as many outputs as rays; the tree has a root.
#[inline(always)]
pub(super) unsafe fn traverse<L: Simd8, Q: TraceBatch>(
    bvh: &Aggregate,
    rays: &[Ray],
    outputs: &mut [Q::Output],
) {
    let mut pending = CandidateQueue::new();
    let mut batch = RayBatch::<Q> { bvh, rays, outputs, next: 0, end: rays.len() };
    // SAFETY: upheld by the caller; all pending rays were added here.
    unsafe {
        Q::trace::<L>(&mut batch, &mut pending);
        pending.resolve::<L, Q>(&mut batch);
    }
}

/// Traces coherent rays in packets, and the rays between them one by one.
///
/// # Safety
/// As for [`traverse`].
#[inline(always)]
unsafe fn trace_packets<L: Simd8>(
    batch: &mut RayBatch<'_, ClosestHit>,
    pending: &mut CandidateQueue,
) {
    let mut packets = [const { MaybeUninit::<RayPacket>::uninit() }; ACTIVE_PACKETS];
    let mut active = packets.each_mut().map(MaybeUninit::as_mut_ptr);
    let tree = &batch.bvh.tree;
    let mut next = 0;
    // SAFETY: `active` holds distinct packets, initialised up to `count`; the rest is upheld by the
    // caller.
    unsafe {
        loop {
            // Incoherent rays.
            let first = next;
            while next < batch.rays.len() && !RayPacket::load_packet::<L>(active[0], batch, next) {
                next = batch.rays.len().min(next + PACKET_SIZE);
            }
            (batch.next, batch.end) = (first, next);
            trace_single_rays::<L, ClosestHit>(batch, pending);
            if next == batch.rays.len() {
                return;
            }
            next += PACKET_SIZE;
            let mut count = 1;
            while count < ACTIVE_PACKETS && RayPacket::load_packet::<L>(active[count], batch, next)
            {
                next += PACKET_SIZE;
                count += 1;
            }
            // Coherent rays.
            while count > 0 {
                let mut index = 0;
                while index < count {
                    let packet = active[index];
                    match (*packet).step::<L>(tree) {
                        PacketStatus::Active => {
                            prefetch::<L>(tree, (*packet).next());
                            index += 1;
                            continue;
                        }
                        PacketStatus::Done => (*packet).finish::<L>(batch, pending),
                        PacketStatus::Split => {
                            batch.next = (*packet).first_ray();
                            batch.end = batch.next + PACKET_SIZE;
                            trace_single_rays::<L, ClosestHit>(batch, pending);
                        }
                    }
                    if RayPacket::load_packet::<L>(packet, batch, next) {
                        next += PACKET_SIZE;
                    } else {
                        count -= 1;
                        active.swap(index, count);
                    }
                }
            }
        }
    }
}

/// [`traverse`] for a list of leaves without a tree.
///
/// # Safety
/// The CPU supports `L`, and there are as many outputs as rays.
#[inline(always)]
pub(super) unsafe fn scan_leaves<L: Simd8, Q: QueryMode>(
    bvh: &Aggregate,
    rays: &[Ray],
    outputs: &mut [Q::Output],
) {
    let mut slot = MaybeUninit::<RayState>::uninit();
    let mut batch = RayBatch::<Q> { bvh, rays, outputs, next: 0, end: rays.len() };
    let mut pending = CandidateQueue::new();
    // SAFETY: the slot is loaded before it is read. There are no more leaves than a slot can keep.
    unsafe {
        while batch.load_next_ray::<L>(slot.as_mut_ptr()) {
            let slot = slot.assume_init_mut();
            for (index, leaf) in bvh.tree.leaves().iter().enumerate() {
                if Q::ANY_HIT {
                    let leaf_hits = slot.intersect_leaf::<L, true>(leaf, index as u32);
                    if leaf_hits.certain != 0 {
                        slot.certain = leaf_hits.certain;
                        break;
                    }
                } else {
                    slot.intersect_leaf::<L, false>(leaf, index as u32);
                }
            }
            pending.push_ray::<L>(slot);
            if pending.is_full() {
                pending.resolve::<L, Q>(&mut batch);
            }
        }
        pending.resolve::<L, Q>(&mut batch);
    }
}
