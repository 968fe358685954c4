//! A batch on its way: rays take turns until all have been answered.

use std::mem::MaybeUninit;

use crate::accel::native::aggregate::Aggregate;
use crate::math::Ray;

use super::batch::Batch;
use super::lanes::Lanes;
use super::packet::{Packet, RAYS, Step};
use super::pending::Pending;
use super::question::{Any, Closest, Question};
use super::single::{one_by_one, prefetch};
use super::slot::Slot;

/// Packets under way at once.
const PACKETS: usize = 4;

/// How a batch is answered that is asked this.
pub(super) trait Fly: Question + Sized {
    /// Answers the rays of a batch; what is still to be judged stays pending.
    ///
    /// # Safety
    /// As for [`fly`].
    unsafe fn trace<L: Lanes>(batch: &mut Batch<'_, Self>, pending: &mut Pending);
}

impl Fly for Closest {
    #[inline(always)]
    unsafe fn trace<L: Lanes>(batch: &mut Batch<'_, Self>, pending: &mut Pending) {
        // SAFETY: the caller's promise.
        unsafe { in_packets::<L>(batch, pending) };
    }
}

impl Fly for Any {
    #[inline(always)]
    unsafe fn trace<L: Lanes>(batch: &mut Batch<'_, Self>, pending: &mut Pending) {
        // SAFETY: the caller's promise.
        unsafe { one_by_one::<L, Self>(batch, pending) };
    }
}

/// Answers all rays of a batch: those that are alike in packets, the others by themselves.
///
/// # Safety
/// Needs the instructions of `L`, and as many answers as rays; the tree has a root.
#[inline(always)]
pub(super) unsafe fn fly<L: Lanes, Q: Fly>(bvh: &Aggregate, rays: &[Ray], answers: &mut [Q::Answer]) {
    let mut pending = Pending::new();
    let mut batch = Batch::<Q> { bvh, rays, answers, next: 0, end: rays.len() };
    // SAFETY: the caller's promise; all that is pending was added here.
    unsafe {
        Q::trace::<L>(&mut batch, &mut pending);
        pending.settle::<L, Q>(&mut batch);
    }
}

/// Packets of rays, as long as there are any, and what is between them ray by ray.
///
/// # Safety
/// As for [`fly`].
#[inline(always)]
unsafe fn in_packets<L: Lanes>(batch: &mut Batch<'_, Closest>, pending: &mut Pending) {
    let mut packets = [const { MaybeUninit::<Packet>::uninit() }; PACKETS];
    let mut under_way = packets.each_mut().map(MaybeUninit::as_mut_ptr);
    let tree = &batch.bvh.tree;
    let mut next = 0;
    // SAFETY: `under_way` holds distinct packets, those up to `count` have begun; the rest is the
    // caller's promise.
    unsafe {
        loop {
            // Rays that are not alike.
            let first = next;
            while next < batch.rays.len() && !Packet::board::<L>(under_way[0], batch, next) {
                next = batch.rays.len().min(next + RAYS);
            }
            (batch.next, batch.end) = (first, next);
            one_by_one::<L, Closest>(batch, pending);
            if next == batch.rays.len() {
                return;
            }
            next += RAYS;
            let mut count = 1;
            while count < PACKETS && Packet::board::<L>(under_way[count], batch, next) {
                next += RAYS;
                count += 1;
            }
            // Rays that are.
            while count > 0 {
                let mut turn = 0;
                while turn < count {
                    let packet = under_way[turn];
                    match (*packet).step::<L>(tree) {
                        Step::OnTheWay => {
                            prefetch::<L>(tree, (*packet).next());
                            turn += 1;
                            continue;
                        }
                        Step::Done => (*packet).land::<L>(batch, pending),
                        Step::Split => {
                            batch.next = (*packet).first();
                            batch.end = batch.next + RAYS;
                            one_by_one::<L, Closest>(batch, pending);
                        }
                    }
                    if Packet::board::<L>(packet, batch, next) {
                        next += RAYS;
                    } else {
                        count -= 1;
                        under_way.swap(turn, count);
                    }
                }
            }
        }
    }
}

/// As [`fly`], but through a list of leaves that has no tree.
///
/// # Safety
/// Needs the instructions of `L`, and as many answers as rays.
#[inline(always)]
pub(super) unsafe fn walk<L: Lanes, Q: Question>(
    bvh: &Aggregate,
    rays: &[Ray],
    answers: &mut [Q::Answer],
) {
    let mut slot = MaybeUninit::<Slot>::uninit();
    let mut batch = Batch::<Q> { bvh, rays, answers, next: 0, end: rays.len() };
    let mut pending = Pending::new();
    // SAFETY: the slot is boarded before it is read. There are no more leaves than a slot can keep.
    unsafe {
        while batch.board::<L>(slot.as_mut_ptr()) {
            let slot = slot.assume_init_mut();
            for (index, leaf) in bvh.tree.leaves().iter().enumerate() {
                if Q::ANY {
                    let found = slot.through_leaf::<L, true>(leaf, index as u32);
                    if found.sure != 0 {
                        slot.sure = found.sure;
                        break;
                    }
                } else {
                    slot.through_leaf::<L, false>(leaf, index as u32);
                }
            }
            pending.add::<L>(slot);
            if pending.is_full() {
                pending.settle::<L, Q>(&mut batch);
            }
        }
        pending.settle::<L, Q>(&mut batch);
    }
}
