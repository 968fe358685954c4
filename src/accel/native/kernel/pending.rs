//! Rays that have taken their last step and wait for their answer.
//!
//! What a ray has kept is judged in f64, which takes two divisions and a root one after the other,
//! and the ids of its candidates may still be on their way from memory. So answers wait until there
//! are several, which then do not wait for each other.

use std::mem::MaybeUninit;

use crate::accel::native::limits::KEPT;
use crate::accel::native::node::each_lane;
use crate::accel::native::query::{Best, Query};

use super::alone::alone;
use super::batch::Batch;
use super::lanes::Lanes;
use super::question::Question;
use super::slot::Slot;

/// Rays that wait at most.
const RAYS: usize = 16;
/// Leaves that they have kept together.
const LEAVES: usize = 64;

/// The rays, and what each has kept.
pub(super) struct Pending {
    rays: [MaybeUninit<Waiting>; RAYS],
    count: usize,
    leaves: [MaybeUninit<Kept>; LEAVES],
    leaf_count: usize,
}

/// A ray that is done.
#[derive(Clone, Copy)]
pub(super) struct Waiting {
    pub(super) ray: u32,
    /// Behind the last of its leaves.
    pub(super) end: u32,
    /// Up to where every candidate was kept.
    pub(super) limit: f32,
    /// Whether a sphere of the last leaf is hit for certain, so that nothing is left to judge.
    pub(super) is_sure: bool,
    pub(super) best: Best,
    pub(super) length: f64,
}

/// A leaf, and the lanes of it that matter, as bits.
#[derive(Clone, Copy)]
pub(super) struct Kept {
    pub(super) leaf: u32,
    pub(super) lanes: u32,
}

impl Pending {
    #[inline(always)]
    pub(super) fn new() -> Self {
        let (rays, leaves) =
            ([const { MaybeUninit::uninit() }; RAYS], [const { MaybeUninit::uninit() }; LEAVES]);
        Self { rays, count: 0, leaves, leaf_count: 0 }
    }

    /// Adds a ray that is done.
    ///
    /// # Safety
    /// The slot holds a ray that is done, this is not [full](Self::is_full), and the instructions of
    /// `L` are there.
    #[inline(always)]
    pub(super) unsafe fn add<L: Lanes>(&mut self, slot: &Slot) {
        // SAFETY: there is room for one ray and all that it can have kept.
        unsafe {
            if slot.sure != 0 {
                let (leaf, _) = slot.kept::<L>(slot.kept - 1);
                self.keep(Kept { leaf, lanes: slot.sure });
            } else {
                for number in 0..slot.kept {
                    let (leaf, lanes) = slot.kept::<L>(number);
                    self.keep(Kept { leaf, lanes });
                }
            }
            let Slot { ray, limit, sure, best, length, .. } = *slot;
            self.finish(Waiting { ray, end: 0, limit, is_sure: sure != 0, best, length });
        }
    }

    /// Adds what the next ray has kept, if any lane of it.
    ///
    /// # Safety
    /// There is room for it: no ray has kept more than [`KEPT`], and this was not
    /// [full](Self::is_full) before the first of them.
    #[inline(always)]
    pub(super) unsafe fn keep(&mut self, kept: Kept) {
        // SAFETY: the caller's promise.
        unsafe { self.leaves.get_unchecked_mut(self.leaf_count).write(kept) };
        self.leaf_count += usize::from(kept.lanes != 0);
    }

    /// Adds the ray to which belongs what was kept since the one before.
    ///
    /// # Safety
    /// There is room for it, as for [`Self::keep`].
    #[inline(always)]
    pub(super) unsafe fn finish(&mut self, ray: Waiting) {
        let ray = Waiting { end: self.leaf_count as u32, ..ray };
        // SAFETY: the caller's promise.
        unsafe { self.rays.get_unchecked_mut(self.count).write(ray) };
        self.count += 1;
    }

    /// Whether there may be no room for another ray.
    #[inline(always)]
    pub(super) fn is_full(&self) -> bool {
        self.count == RAYS || self.leaf_count > LEAVES - KEPT
    }

    /// Answers all that wait.
    ///
    /// Nothing tests on the way for the spheres that a ray is to overlook, because it hardly ever
    /// matters: a sphere that a ray leaves is never sure to be hit, as the ray starts on it, nor is
    /// a lamp that ends it. Where such a sphere was sure and cut the way short, it is seen here.
    ///
    /// What is hit first will be looked at next: the memory of those spheres is asked for here, so that
    /// it comes while other rays are on their way.
    ///
    /// # Safety
    /// All that waits is of this batch, which has as many answers as rays, and the instructions of `L`
    /// are there.
    #[inline(always)]
    pub(super) unsafe fn settle<L: Lanes, Q: Question>(&mut self, batch: &mut Batch<'_, Q>) {
        let tree = &batch.bvh.tree;
        let mut first = 0;
        for waiting in &self.rays[..self.count] {
            // SAFETY: what is below the counts was written, with leaves of this tree and rays of this
            // batch; lanes are below 8.
            unsafe {
                let waiting = waiting.assume_init_ref();
                let ray = batch.rays.get_unchecked(waiting.ray as usize);
                let kept = self.leaves.get_unchecked(first..waiting.end as usize);
                first = waiting.end as usize;
                let mut best = waiting.best;
                let is_cut_short;
                if Q::ANY && waiting.is_sure {
                    let Kept { leaf, lanes } = kept.get_unchecked(0).assume_init();
                    let ids = tree.ids().get_unchecked(leaf as usize);
                    let others = |lane: &usize| !ray.excludes(*ids.get_unchecked(*lane));
                    let other = each_lane(lanes).find(others);
                    is_cut_short = other.is_none();
                    best.id = other.map_or(best.id, |lane| *ids.get_unchecked(lane));
                } else {
                    let mut query = Query::new(ray, best);
                    for kept in kept {
                        let Kept { leaf, lanes } = kept.assume_init();
                        let ids = tree.ids().get_unchecked(leaf as usize);
                        let leaf = tree.leaves().get_unchecked(leaf as usize);
                        for lane in each_lane(lanes) {
                            query.offer(*ids.get_unchecked(lane), &leaf.sphere(lane));
                        }
                    }
                    best = query.best;
                    is_cut_short = !Q::ANY && best.t * waiting.length > f64::from(waiting.limit);
                }
                let answer =
                    if is_cut_short { alone::<Q>(batch.bvh, ray) } else { Q::answer(best) };
                *batch.answers.get_unchecked_mut(waiting.ray as usize) = answer;
                if !Q::ANY {
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
