//! Rays that have taken their last step and wait for their answer.
//!
//! What a ray has kept is judged in f64, which takes two divisions and a root one after the other,
//! and the ids of its candidates may still be on their way from memory. So answers wait until there
//! are several, which then do not wait for each other.

use std::mem::MaybeUninit;

use crate::accel::native::limits::MAX_CANDIDATE_LEAVES;
use crate::accel::native::node::mask_lanes;
use crate::accel::native::query::{BestHit, ExactQuery};

use super::alone::trace_scalar;
use super::batch::RayBatch;
use super::question::QueryMode;
use super::ray_state::RayState;
use super::simd::Simd8;

/// Rays that wait at most.
const MAX_RAYS: usize = 16;
/// Leaves that they have kept together.
const MAX_LEAVES: usize = 64;

/// The rays, and what each has kept.
pub(super) struct CandidateQueue {
    rays: [MaybeUninit<FinishedRay>; MAX_RAYS],
    count: usize,
    leaves: [MaybeUninit<LeafCandidates>; MAX_LEAVES],
    leaf_count: usize,
}

/// A ray that is done.
#[derive(Clone, Copy)]
pub(super) struct FinishedRay {
    pub(super) ray: u32,
    /// Behind the last of its leaves.
    pub(super) leaf_end: u32,
    /// Up to where every candidate was kept.
    pub(super) limit: f32,
    /// True if a sphere of the last leaf is certainly hit, so that nothing is left to judge.
    pub(super) is_certain: bool,
    pub(super) best: BestHit,
    pub(super) length: f64,
}

/// A leaf, and the lanes of it that matter, as bits.
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

    /// Adds a ray that is done.
    ///
    /// # Safety
    /// The slot holds a ray that is done, this is not [full](Self::is_full), and the instructions
    /// of `L` are there.
    #[inline(always)]
    pub(super) unsafe fn push_ray<L: Simd8>(&mut self, slot: &RayState) {
        // SAFETY: there is room for one ray and all that it can have kept.
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
            let RayState { ray, limit, certain: sure, best, length, .. } = *slot;
            self.push_finished(FinishedRay {
                ray,
                leaf_end: 0,
                limit,
                is_certain: sure != 0,
                best,
                length,
            });
        }
    }

    /// Adds what the next ray has kept, if any lane of it.
    ///
    /// # Safety
    /// There is room for it: no ray has kept more than [`MAX_CANDIDATE_LEAVES`], and this was not
    /// [full](Self::is_full) before the first of them.
    #[inline(always)]
    pub(super) unsafe fn push_candidates(&mut self, kept: LeafCandidates) {
        // SAFETY: upheld by the caller.
        unsafe { self.leaves.get_unchecked_mut(self.leaf_count).write(kept) };
        self.leaf_count += usize::from(kept.mask != 0);
    }

    /// Adds the ray to which belongs what was kept since the one before.
    ///
    /// # Safety
    /// There is room for it, as for [`Self::push_candidates`].
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

    /// Answers all that wait.
    ///
    /// Nothing tests on the way for the spheres that a ray is to overlook, because it hardly ever
    /// matters: a sphere that a ray leaves is never sure to be hit, as the ray starts on it, nor is
    /// a lamp that ends it. Where such a sphere was sure and cut the way short, it is seen here.
    ///
    /// What is hit first will be looked at next: the memory of those spheres is asked for here, so
    /// that it comes while other rays are on their way.
    ///
    /// # Safety
    /// All that waits is of this batch, which has as many outputs as rays, and the instructions of
    /// `L` are there.
    #[inline(always)]
    pub(super) unsafe fn resolve<L: Simd8, Q: QueryMode>(&mut self, batch: &mut RayBatch<'_, Q>) {
        let tree = &batch.bvh.tree;
        let mut first = 0;
        for waiting in &self.rays[..self.count] {
            // SAFETY: what is below the counts was written, with leaves of this tree and rays of
            // this batch; lanes are below 8.
            unsafe {
                let waiting = waiting.assume_init_ref();
                let ray = batch.rays.get_unchecked(waiting.ray as usize);
                let kept = self.leaves.get_unchecked(first..waiting.leaf_end as usize);
                first = waiting.leaf_end as usize;
                let mut best = waiting.best;
                let needs_retrace;
                if Q::ANY_HIT && waiting.is_certain {
                    let LeafCandidates { leaf, mask: lanes } = kept.get_unchecked(0).assume_init();
                    let ids = tree.ids().get_unchecked(leaf as usize);
                    let others = |lane: &usize| !ray.excludes(*ids.get_unchecked(*lane));
                    let other = mask_lanes(lanes).find(others);
                    needs_retrace = other.is_none();
                    best.id = other.map_or(best.id, |lane| *ids.get_unchecked(lane));
                } else {
                    let mut query = ExactQuery::new(ray, best);
                    for kept in kept {
                        let LeafCandidates { leaf, mask: lanes } = kept.assume_init();
                        let ids = tree.ids().get_unchecked(leaf as usize);
                        let leaf = tree.leaves().get_unchecked(leaf as usize);
                        for lane in mask_lanes(lanes) {
                            query.consider(*ids.get_unchecked(lane), &leaf.sphere(lane));
                        }
                    }
                    best = query.best;
                    needs_retrace =
                        !Q::ANY_HIT && best.t * waiting.length > f64::from(waiting.limit);
                }
                let answer =
                    if needs_retrace { trace_scalar::<Q>(batch.bvh, ray) } else { Q::output(best) };
                *batch.outputs.get_unchecked_mut(waiting.ray as usize) = answer;
                if !Q::ANY_HIT {
                    let spheres = &batch.bvh.spheres;
                    let at = best.id as usize;
                    L::prefetch(spheres.particles().as_ptr().wrapping_add(at).cast());
                    L::prefetch(spheres.rows().as_ptr().wrapping_add(at).cast());
                }
            }
        }
        self.count = 0;
        self.leaf_count = 0;
    }
}
