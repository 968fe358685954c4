//! Rays by themselves, sixteen under way, one step of each in turn.

use std::mem::MaybeUninit;

use crate::accel::native::limits::KEPT;
use crate::accel::native::node::Child;
use crate::accel::native::tree::Tree;

use super::alone::judge;
use super::batch::Batch;
use super::lanes::Lanes;
use super::pending::Pending;
use super::question::Question;
use super::slot::Slot;

/// Rays under way at once. Eight are 6 to 8 % slower where memory is, and 32 no faster.
const SLOTS: usize = 16;

/// The rays from the batch's next to its end, each by itself.
///
/// # Safety
/// As for [`fly`](super::flight::fly).
#[inline(always)]
pub(super) unsafe fn one_by_one<L: Lanes, Q: Question>(
    batch: &mut Batch<'_, Q>,
    pending: &mut Pending,
) {
    let mut slots: [MaybeUninit<Slot>; SLOTS] = [const { MaybeUninit::uninit() }; SLOTS];
    let mut under_way: [*mut Slot; SLOTS] = [std::ptr::null_mut(); SLOTS];
    let mut count = 0;
    for slot in &mut slots {
        // SAFETY: there are as many answers as rays.
        if !unsafe { batch.board::<L>(slot.as_mut_ptr()) } {
            break;
        }
        under_way[count] = slot.as_mut_ptr();
        count += 1;
    }
    while count > 0 {
        let mut turn = 0;
        while turn < count {
            // SAFETY: `under_way` holds distinct slots that have been boarded, up to `count`; the
            // instructions are there by the caller's promise, and as many answers as rays.
            unsafe {
                let slot = *under_way.get_unchecked(turn);
                if step::<L, Q>(batch, &mut *slot) {
                    pending.add::<L>(&*slot);
                    if pending.is_full() {
                        pending.settle::<L, Q>(batch);
                    }
                    if !batch.board::<L>(slot) {
                        count -= 1;
                        *under_way.get_unchecked_mut(turn) = *under_way.get_unchecked(count);
                        continue;
                    }
                } else {
                    prefetch::<L>(&batch.bvh.tree, (*slot).next);
                }
            }
            turn += 1;
        }
    }
}

/// One step of one ray; whether it was its last.
///
/// # Safety
/// The slot has been boarded and is not done; the instructions of `L` are there.
#[inline(always)]
unsafe fn step<L: Lanes, Q: Question>(batch: &Batch<'_, Q>, slot: &mut Slot) -> bool {
    let tree = &batch.bvh.tree;
    let next = slot.next;
    // SAFETY: `next` is a node or leaf of this tree. The stack has room by the builder's bound, and
    // `kept` is below its end, as `make_room` sees to.
    unsafe {
        if next.is_leaf() {
            let leaf = tree.leaves().as_ptr().add(next.index());
            let found = if Q::ANY {
                slot.through_leaf::<L, true>(leaf, next.index() as u32)
            } else {
                slot.through_leaf::<L, false>(leaf, next.index() as u32)
            };
            let place = if found.candidates != 0 { next.index() } else { 0 };
            L::prefetch(tree.ids().as_ptr().add(place).cast());
            if Q::ANY && found.sure != 0 {
                slot.sure = found.sure;
                return true;
            }
            if slot.kept as usize == KEPT && make_room(batch, slot) {
                return true;
            }
        } else if Q::ANY {
            slot.through_node::<L, true>(tree.nodes().as_ptr().add(next.index()));
        } else {
            slot.through_node::<L, false>(tree.nodes().as_ptr().add(next.index()));
        }
        if Q::ANY {
            slot.pop::<true>();
        } else {
            slot.pop::<false>();
        }
    }
    slot.next == Child::NONE
}

/// Asks for all lines of what comes next: four for a node, two for a leaf.
///
/// # Safety
/// `next` is a node or leaf of this tree.
#[inline(always)]
pub(super) unsafe fn prefetch<L: Lanes>(tree: &Tree, next: Child) {
    let index = next.index();
    let leaf = tree.leaves().as_ptr().wrapping_add(index).cast::<u8>();
    let node = tree.nodes().as_ptr().wrapping_add(index).cast::<u8>();
    let (first, second) =
        if next.is_leaf() { (leaf, leaf) } else { (node, node.wrapping_add(128)) };
    // SAFETY: nothing is read; the instructions are there.
    unsafe {
        L::prefetch(first);
        L::prefetch(first.wrapping_add(64));
        L::prefetch(second);
        L::prefetch(second.wrapping_add(64));
    }
}

/// Judges the leaves kept so far, so that more can be; whether that answered the question.
///
/// # Safety
/// The slot holds a ray of the batch, and the leaves that it has kept are of its tree.
#[cold]
#[inline(never)]
unsafe fn make_room<Q: Question>(batch: &Batch<'_, Q>, slot: &mut Slot) -> bool {
    // SAFETY: the caller's promise.
    unsafe { judge(&batch.bvh.tree, batch.rays.get_unchecked(slot.ray as usize), slot) };
    let limit = slot.limit_of(slot.best.t);
    slot.limit = if Q::ANY || limit > slot.limit { slot.limit } else { limit };
    Q::ANY && slot.best.is_hit()
}
