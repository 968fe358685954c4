//! Traces one ray at a time and resolves its candidates immediately.

use std::mem::MaybeUninit;

use crate::accel::native::aggregate::Aggregate;
use crate::accel::native::node::{NodeRef, mask_lanes};
use crate::accel::native::query::ExactQuery;
use crate::math::Ray;

use super::query_mode::QueryMode;
use super::ray_state::RayState;
use super::simd::Portable;

/// Tests the ray's candidates up to its limit exactly, and removes them.
///
/// # Safety
/// The slot holds the ray, and its candidate leaves belong to the tree.
pub(super) unsafe fn resolve_candidates(bvh: &Aggregate, ray: &Ray, slot: &mut RayState) {
    let tree = &bvh.tree;
    let mut query = ExactQuery::new(ray, slot.best);
    for number in 0..slot.candidate_count {
        // SAFETY: the number is below `candidate_count`.
        let (leaf, lanes) = unsafe { slot.candidate_leaf::<Portable>(number) };
        let (ids, leaf) = (&tree.ids()[leaf as usize], &tree.leaves()[leaf as usize]);
        for lane in mask_lanes(lanes) {
            query.intersect(ids[lane], &bvh.sphere(leaf, lane, ids[lane]));
        }
    }
    slot.best = query.best;
    slot.candidate_count = 0;
}

/// Traces a single ray and resolves every candidate at once: for rays whose traversal was cut short
/// by a hit on an excluded sphere.
#[cold]
#[inline(never)]
pub(super) fn trace_scalar<Q: QueryMode>(bvh: &Aggregate, ray: &Ray) -> Q::Output {
    let best = bvh.closest_giant(ray, Q::ANY_HIT);
    if Q::ANY_HIT && best.is_hit() {
        return Q::output(best);
    }
    let tree = &bvh.tree;
    let mut slot = MaybeUninit::<RayState>::uninit();
    // SAFETY: as in `single::step_ray`; leaves are resolved one at a time. With `ANY_HIT`, a leaf
    // does not change the limit.
    unsafe {
        RayState::init(slot.as_mut_ptr(), ray, best, 0, tree.root);
        let slot = slot.assume_init_mut();
        if tree.root.is_none() {
            for (index, leaf) in tree.leaves().iter().enumerate() {
                slot.intersect_leaf::<Portable, true>(leaf, index as u32);
            }
            resolve_candidates(bvh, ray, slot);
            return Q::output(slot.best);
        }
        while slot.next != NodeRef::NONE && !(Q::ANY_HIT && slot.best.is_hit()) {
            let next = slot.next;
            if next.is_leaf() {
                let leaf = tree.leaves().as_ptr().add(next.index());
                slot.intersect_leaf::<Portable, true>(leaf, next.index() as u32);
                resolve_candidates(bvh, ray, slot);
                slot.limit = slot.limit_for(slot.best.t);
            } else {
                slot.intersect_node::<Portable, false>(tree.nodes().as_ptr().add(next.index()));
            }
            slot.pop::<false>();
        }
        Q::output(slot.best)
    }
}
