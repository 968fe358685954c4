//! Traces single rays: sixteen are active, and take one step each in turn.

use std::mem::MaybeUninit;

use crate::accel::native::bvh::Bvh;
use crate::accel::native::limits::MAX_CANDIDATE_LEAVES;
use crate::accel::native::node::NodeRef;

use super::batch::RayBatch;
use super::candidates::CandidateQueue;
use super::query_mode::QueryMode;
use super::ray_state::RayState;
use super::scalar::resolve_candidates;
use super::simd::Simd8;

/// Number of active rays. Eight are 6 to 8 % slower when memory-bound, and 32 are no faster.
const ACTIVE_RAYS: usize = 16;

/// Traces the batch's rays from `next` to `end` one by one.
///
/// # Safety
/// As for [`traverse`](super::traverse::traverse).
#[inline(always)]
pub(super) unsafe fn trace_single_rays<L: Simd8, Q: QueryMode>(
    batch: &mut RayBatch<'_, Q>,
    pending: &mut CandidateQueue,
) {
    let mut slots: [MaybeUninit<RayState>; ACTIVE_RAYS] =
        [const { MaybeUninit::uninit() }; ACTIVE_RAYS];
    let mut active: [*mut RayState; ACTIVE_RAYS] = [std::ptr::null_mut(); ACTIVE_RAYS];
    let mut count = 0;
    for slot in &mut slots {
        // SAFETY: there are as many outputs as rays.
        if !unsafe { batch.load_next_ray::<L>(slot.as_mut_ptr()) } {
            break;
        }
        active[count] = slot.as_mut_ptr();
        count += 1;
    }
    while count > 0 {
        let mut index = 0;
        while index < count {
            // SAFETY: `active` holds distinct slots, loaded up to `count`; the CPU supports `L` by
            // the caller's contract, and there are as many outputs as rays.
            unsafe {
                let slot = *active.get_unchecked(index);
                if step_ray::<L, Q>(batch, &mut *slot) {
                    pending.push_ray::<L>(&*slot);
                    if pending.is_full() {
                        pending.resolve::<L, Q>(batch);
                    }
                    if !batch.load_next_ray::<L>(slot) {
                        count -= 1;
                        *active.get_unchecked_mut(index) = *active.get_unchecked(count);
                        continue;
                    }
                } else {
                    prefetch::<L>(&batch.bvh.tree, (*slot).next);
                }
            }
            index += 1;
        }
    }
}

/// Takes one step of one ray. Returns true if that was its last.
///
/// # Safety
/// The slot is loaded and not done; the CPU supports `L`.
#[inline(always)]
unsafe fn step_ray<L: Simd8, Q: QueryMode>(batch: &RayBatch<'_, Q>, slot: &mut RayState) -> bool {
    let tree = &batch.bvh.tree;
    let next = slot.next;
    // SAFETY: `next` is a node or leaf of this tree. The stack has room by the builder's bound, and
    // `candidate_count` is below its maximum, as `flush_candidates` ensures.
    unsafe {
        if next.is_leaf() {
            let leaf = tree.leaves().as_ptr().add(next.index());
            let leaf_hits = if Q::ANY_HIT {
                slot.intersect_leaf::<L, true>(leaf, next.index() as u32)
            } else {
                slot.intersect_leaf::<L, false>(leaf, next.index() as u32)
            };
            let ids_index = if leaf_hits.candidates != 0 { next.index() } else { 0 };
            L::prefetch(tree.ids().as_ptr().add(ids_index).cast());
            if Q::ANY_HIT && leaf_hits.certain != 0 {
                slot.certain = leaf_hits.certain;
                return true;
            }
            if slot.candidate_count as usize == MAX_CANDIDATE_LEAVES
                && flush_candidates(batch, slot)
            {
                return true;
            }
        } else if Q::ANY_HIT {
            slot.intersect_node::<L, true>(tree.nodes().as_ptr().add(next.index()));
        } else {
            slot.intersect_node::<L, false>(tree.nodes().as_ptr().add(next.index()));
        }
        if Q::ANY_HIT {
            slot.pop::<true>();
        } else {
            slot.pop::<false>();
        }
    }
    slot.next == NodeRef::NONE
}

/// Prefetches the cache lines of the next node (four) or leaf (two).
///
/// # Safety
/// `next` is a node or leaf of this tree.
#[inline(always)]
pub(super) unsafe fn prefetch<L: Simd8>(tree: &Bvh, next: NodeRef) {
    let index = next.index();
    let leaf = tree.leaves().as_ptr().wrapping_add(index).cast::<u8>();
    let node = tree.nodes().as_ptr().wrapping_add(index).cast::<u8>();
    let (first, second) =
        if next.is_leaf() { (leaf, leaf) } else { (node, node.wrapping_add(128)) };
    // SAFETY: nothing is read; the CPU supports `L`.
    unsafe {
        L::prefetch(first);
        L::prefetch(first.wrapping_add(64));
        L::prefetch(second);
        L::prefetch(second.wrapping_add(64));
    }
}

/// Resolves the candidates so far to make room for more. Returns true if that decided the query.
///
/// # Safety
/// The slot holds a ray of the batch, and its candidate leaves belong to the batch's tree.
#[cold]
#[inline(never)]
unsafe fn flush_candidates<Q: QueryMode>(batch: &RayBatch<'_, Q>, slot: &mut RayState) -> bool {
    // SAFETY: upheld by the caller.
    unsafe { resolve_candidates(batch.bvh, batch.rays.get_unchecked(slot.ray as usize), slot) };
    let limit = slot.limit_for(slot.best.t);
    slot.limit = if Q::ANY_HIT || limit > slot.limit { slot.limit } else { limit };
    Q::ANY_HIT && slot.best.is_hit()
}
