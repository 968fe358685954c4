//! A ray whose candidates are judged as they come, while no other is on its way.

use std::mem::MaybeUninit;

use crate::accel::native::aggregate::Aggregate;
use crate::accel::native::node::{Child, each_lane};
use crate::accel::native::query::Query;
use crate::accel::native::tree::Tree;
use crate::math::Ray;

use super::lanes::Portable;
use super::question::Question;
use super::slot::Slot;

/// Offers the ray what its slot has kept and is not beyond the limit, and keeps nothing of it.
///
/// # Safety
/// The slot holds the ray, and the leaves that it has kept are of the tree.
pub(super) unsafe fn judge(tree: &Tree, ray: &Ray, slot: &mut Slot) {
    let mut query = Query::new(ray, slot.best);
    for number in 0..slot.kept {
        // SAFETY: the number is below `kept`.
        let (leaf, lanes) = unsafe { slot.kept::<Portable>(number) };
        let (ids, leaf) = (&tree.ids()[leaf as usize], &tree.leaves()[leaf as usize]);
        each_lane(lanes).for_each(|lane| query.offer(ids[lane], &leaf.sphere(lane)));
    }
    slot.best = query.best;
    slot.kept = 0;
}

/// A single ray, with every candidate judged at once: for rays whose way was cut short by a sphere
/// that they are to overlook.
#[cold]
#[inline(never)]
pub(super) fn alone<Q: Question>(bvh: &Aggregate, ray: &Ray) -> Q::Answer {
    let best = bvh.best_giant(ray, Q::ANY);
    if Q::ANY && best.is_hit() {
        return Q::answer(best);
    }
    let tree = &bvh.tree;
    let mut slot = MaybeUninit::<Slot>::uninit();
    // SAFETY: as in `single::step`; leaves are kept one at a time. With `ANY`, a leaf leaves the limit
    // alone.
    unsafe {
        Slot::begin(slot.as_mut_ptr(), ray, best, 0, tree.root);
        let slot = slot.assume_init_mut();
        if tree.root.is_none() {
            for (index, leaf) in tree.leaves().iter().enumerate() {
                slot.through_leaf::<Portable, true>(leaf, index as u32);
            }
            judge(tree, ray, slot);
            return Q::answer(slot.best);
        }
        while slot.next != Child::NONE && !(Q::ANY && slot.best.is_hit()) {
            let next = slot.next;
            if next.is_leaf() {
                let leaf = tree.leaves().as_ptr().add(next.index());
                slot.through_leaf::<Portable, true>(leaf, next.index() as u32);
                judge(tree, ray, slot);
                slot.limit = slot.limit_of(slot.best.t);
            } else {
                slot.through_node::<Portable, false>(tree.nodes().as_ptr().add(next.index()));
            }
            slot.pop::<false>();
        }
        Q::answer(slot.best)
    }
}
