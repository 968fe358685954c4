//! Rays that have finished traversal and wait for the exact test of their candidates.
//!
//! The exact test is done in f64, with two dependent divisions and a square root, and the ids of
//! the candidates may not be in the cache yet. So finished rays are queued until there are several,
//! whose latencies then overlap.

use std::mem::MaybeUninit;

use crate::accel::native::aggregate::Aggregate;
use crate::accel::native::limits::MAX_CANDIDATE_LEAVES;
use crate::accel::native::node::mask_lanes;
use crate::accel::native::query::{BestHit, ExactQuery};

use super::batch::RayBatch;
use super::query_mode::QueryMode;
use super::ray_state::RayState;
use super::scalar::trace_scalar;
use super::simd::Simd8;

/// Maximum number of queued rays.
const MAX_RAYS: usize = 16;
/// Maximum number of candidate leaves of all queued rays.
const MAX_LEAVES: usize = 64;

/// Finished rays and their candidates.
pub(super) struct CandidateQueue {
    rays: [MaybeUninit<FinishedRay>; MAX_RAYS],
    count: usize,
    leaves: [MaybeUninit<LeafCandidates>; MAX_LEAVES],
    leaf_count: usize,
}

/// A ray that has finished traversal.
#[derive(Clone, Copy)]
pub(super) struct FinishedRay {
    pub(super) ray: u32,
    /// One past the last of its leaves.
    pub(super) leaf_end: u32,
    /// Distance up to which all candidates are kept.
    pub(super) limit: f32,
    /// True if a sphere of the last leaf is certainly hit, so that no exact test is needed.
    pub(super) is_certain: bool,
    pub(super) best: BestHit,
    pub(super) length: f64,
}

/// A leaf, and a mask of its candidate lanes.
#[derive(Clone, Copy)]
pub(super) struct LeafCandidates {
    pub(super) leaf: u32,
    pub(super) mask: u32,
}

impl CandidateQueue {
    #[inline(always)]
    pub(super) fn new() -> Self {
        let (rays, leaves) = (
            [const { MaybeUninit::uninit() }; MAX_RAYS],
            [const { MaybeUninit::uninit() }; MAX_LEAVES],
        );
        Self { rays, count: 0, leaves, leaf_count: 0 }
    }

    /// Adds a finished ray.
    ///
    /// # Safety
    /// The slot holds a finished ray, the queue is not [full](Self::is_full), and the CPU supports
    /// `L`.
    #[inline(always)]
    pub(super) unsafe fn push_ray<L: Simd8>(&mut self, slot: &RayState) {
        // SAFETY: there is room for one ray and all its candidates.
        unsafe {
            if slot.certain != 0 {
                let (leaf, _) = slot.candidate_leaf::<L>(slot.candidate_count - 1);
                self.push_candidates(LeafCandidates { leaf, mask: slot.certain });
            } else {
                for number in 0..slot.candidate_count {
                    let (leaf, lanes) = slot.candidate_leaf::<L>(number);
                    self.push_candidates(LeafCandidates { leaf, mask: lanes });
                }
            }
            let RayState { ray, limit, certain, best, length, .. } = *slot;
            self.push_finished(FinishedRay {
                ray,
                leaf_end: 0,
                limit,
                is_certain: certain != 0,
                best,
                length,
            });
        }
    }

    /// Adds candidates of the next ray, unless the mask is empty.
    ///
    /// # Safety
    /// There is room: no ray has more than [`MAX_CANDIDATE_LEAVES`] leaves, and the queue was not
    /// [full](Self::is_full) before the first of them.
    #[inline(always)]
    pub(super) unsafe fn push_candidates(&mut self, candidates: LeafCandidates) {
        // SAFETY: upheld by the caller.
        unsafe { self.leaves.get_unchecked_mut(self.leaf_count).write(candidates) };
        self.leaf_count += usize::from(candidates.mask != 0);
    }

    /// Adds the ray that owns the candidates added since the previous ray.
    ///
    /// # Safety
    /// There is room, as for [`Self::push_candidates`].
    #[inline(always)]
    pub(super) unsafe fn push_finished(&mut self, ray: FinishedRay) {
        let ray = FinishedRay { leaf_end: self.leaf_count as u32, ..ray };
        // SAFETY: upheld by the caller.
        unsafe { self.rays.get_unchecked_mut(self.count).write(ray) };
        self.count += 1;
    }

    /// Returns true if there may be no room for another ray.
    #[inline(always)]
    pub(super) fn is_full(&self) -> bool {
        self.count == MAX_RAYS || self.leaf_count > MAX_LEAVES - MAX_CANDIDATE_LEAVES
    }

    /// Prefetches the spheres of all candidates.
    ///
    /// # Safety
    /// All candidates belong to this tree, and the CPU supports `L`.
    #[inline(always)]
    unsafe fn prefetch_spheres<L: Simd8>(&self, bvh: &Aggregate) {
        for candidates in &self.leaves[..self.leaf_count] {
            // SAFETY: entries below the count were written, with leaves of this tree; lanes are
            // below 8.
            unsafe {
                let LeafCandidates { leaf, mask } = candidates.assume_init();
                let ids = bvh.tree.ids().get_unchecked(leaf as usize);
                for lane in mask_lanes(mask) {
                    let [sphere, _] = bvh.spheres.addresses(*ids.get_unchecked(lane));
                    L::prefetch(sphere);
                }
            }
        }
    }

    /// Resolves all queued rays.
    ///
    /// The traversal does not check for excluded spheres, because they hardly ever matter: the
    /// origin sphere is never certainly hit, as the ray starts on it, nor is the emitter at its
    /// end. Where an excluded sphere was certain and cut the traversal short, it is detected here.
    ///
    /// The closest hit is shaded next, so the memory of its sphere is prefetched here, while other
    /// rays are traversing.
    ///
    /// # Safety
    /// All queued rays belong to this batch, which has as many outputs as rays, and the CPU
    /// supports `L`.
    #[inline(always)]
    pub(super) unsafe fn resolve<L: Simd8, Q: QueryMode>(&mut self, batch: &mut RayBatch<'_, Q>) {
        let tree = &batch.bvh.tree;
        if !batch.bvh.spheres.is_exact_in_f32() {
            // SAFETY: as for this function.
            unsafe { self.prefetch_spheres::<L>(batch.bvh) };
        }
        let mut first = 0;
        for pending in &self.rays[..self.count] {
            // SAFETY: entries below the counts were written, with leaves of this tree and rays of
            // this batch; lanes are below 8.
            unsafe {
                let pending = pending.assume_init_ref();
                let ray = batch.rays.get_unchecked(pending.ray as usize);
                let candidates = self.leaves.get_unchecked(first..pending.leaf_end as usize);
                first = pending.leaf_end as usize;
                let mut best = pending.best;
                let needs_retrace;
                if Q::ANY_HIT && pending.is_certain {
                    let LeafCandidates { leaf, mask: lanes } =
                        candidates.get_unchecked(0).assume_init();
                    let ids = tree.ids().get_unchecked(leaf as usize);
                    let not_excluded = |lane: &usize| !ray.excludes(*ids.get_unchecked(*lane));
                    let hit_lane = mask_lanes(lanes).find(not_excluded);
                    needs_retrace = hit_lane.is_none();
                    best.id = hit_lane.map_or(best.id, |lane| *ids.get_unchecked(lane));
                } else {
                    let mut query = ExactQuery::new(ray, best);
                    for candidates in candidates {
                        let LeafCandidates { leaf, mask: lanes } = candidates.assume_init();
                        let ids = tree.ids().get_unchecked(leaf as usize);
                        let leaf = tree.leaves().get_unchecked(leaf as usize);
                        for lane in mask_lanes(lanes) {
                            let id = *ids.get_unchecked(lane);
                            query.intersect(id, &batch.bvh.sphere(leaf, lane, id));
                        }
                    }
                    best = query.best;
                    needs_retrace =
                        !Q::ANY_HIT && best.t * pending.length > f64::from(pending.limit);
                }
                let output =
                    if needs_retrace { trace_scalar::<Q>(batch.bvh, ray) } else { Q::output(best) };
                *batch.outputs.get_unchecked_mut(pending.ray as usize) = output;
                if !Q::ANY_HIT {
                    let [sphere, row] = batch.bvh.spheres.addresses(best.id);
                    L::prefetch(sphere);
                    L::prefetch(row);
                }
            }
        }
        self.count = 0;
        self.leaf_count = 0;
    }
}
