//! A batch on its way: rays take turns until all have been answered.

use std::mem::MaybeUninit;

use crate::accel::native::Native;
use crate::accel::native::node::{Child, each_lane};
use crate::accel::native::query::Query;
use crate::accel::native::tree::Tree;
use crate::math::{Hit, Ray};

use super::lanes::{Lanes, Portable};
use super::slot::{KEPT, Slot};

/// Rays under way at once. Eight are 6 to 8 % slower where memory is, and 32 no faster.
const SLOTS: usize = 16;

/// What a batch is asked.
pub(super) trait Question {
    /// Whether any hit will do.
    const ANY: bool;
    /// What each ray is told.
    type Answer;

    fn answer(query: &Query) -> Self::Answer;
    fn no() -> Self::Answer;
    /// For a hit that needs no distance.
    fn yes() -> Self::Answer;
}

/// Which sphere is hit first.
pub(super) struct Closest;

/// Whether any sphere is hit.
pub(super) struct Any;

impl Question for Closest {
    const ANY: bool = false;
    type Answer = Hit;

    #[inline(always)]
    fn answer(query: &Query) -> Hit {
        query.hit()
    }

    fn no() -> Hit {
        Hit::MISS
    }

    fn yes() -> Hit {
        unreachable!("the first hit is always judged")
    }
}

impl Question for Any {
    const ANY: bool = true;
    type Answer = bool;

    #[inline(always)]
    fn answer(query: &Query) -> bool {
        query.has_hit()
    }

    fn no() -> bool {
        false
    }

    #[inline(always)]
    fn yes() -> bool {
        true
    }
}

/// Answers all rays of a batch.
///
/// # Safety
/// Needs the instructions of `L`, and as many answers as rays.
#[inline(always)]
pub(super) unsafe fn fly<L: Lanes, Q: Question>(
    native: &Native,
    rays: &[Ray],
    answers: &mut [Q::Answer],
) {
    let mut slots: [MaybeUninit<Slot>; SLOTS] = [const { MaybeUninit::uninit() }; SLOTS];
    let mut under_way: [*mut Slot; SLOTS] = [std::ptr::null_mut(); SLOTS];
    let mut batch = Batch::<Q> { native, rays, answers, next: 0 };
    let mut count = 0;
    for slot in &mut slots {
        // SAFETY: there are as many answers as rays.
        if unsafe { batch.board(slot.as_mut_ptr()) } {
            under_way[count] = slot.as_mut_ptr();
            count += 1;
        } else {
            break;
        }
    }
    while count > 0 {
        let mut turn = 0;
        while turn < count {
            // SAFETY: `under_way` holds distinct slots that have been boarded, up to `count`; the
            // instructions are there by the caller's promise.
            unsafe {
                let slot = *under_way.get_unchecked(turn);
                let is_done = step::<L, Q>(&native.tree, &mut *slot);
                if is_done {
                    batch.answer(&mut *slot);
                    if !batch.board(slot) {
                        count -= 1;
                        under_way[turn] = under_way[count];
                        continue;
                    }
                } else {
                    prefetch::<L>(&native.tree, (*slot).next);
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
unsafe fn step<L: Lanes, Q: Question>(tree: &Tree, slot: &mut Slot) -> bool {
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
            let ids = tree.ids().as_ptr();
            let place = if found.candidates != 0 { next.index() } else { 0 };
            L::prefetch(ids.add(place).cast());
            if Q::ANY && found.sure != 0 {
                slot.sure = found.sure;
                return true;
            }
            if slot.kept as usize == KEPT && make_room::<Q>(tree, slot) {
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
unsafe fn prefetch<L: Lanes>(tree: &Tree, next: Child) {
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
/// The slot has been boarded and all its kept leaves are of this tree.
#[cold]
#[inline(never)]
unsafe fn make_room<Q: Question>(tree: &Tree, slot: &mut Slot) -> bool {
    // SAFETY: the caller's promise.
    unsafe { judge(tree, slot) };
    slot.kept = 0;
    let limit = slot.limit_of(slot.query.t);
    slot.limit = if Q::ANY || limit > slot.limit { slot.limit } else { limit };
    Q::ANY && slot.query.has_hit()
}

/// Offers the query what was kept and is not beyond the limit.
///
/// # Safety
/// The slot has been boarded and all its kept leaves are of this tree.
#[inline(always)]
unsafe fn judge(tree: &Tree, slot: &mut Slot) {
    for number in 0..slot.kept {
        // SAFETY: the number is below `kept`, and the leaf one of this tree's.
        unsafe {
            let (leaf, lanes) = slot.kept_lanes(number);
            let ids = tree.ids().get_unchecked(leaf as usize);
            let leaf = tree.leaves().get_unchecked(leaf as usize);
            for lane in each_lane(lanes) {
                let id = *ids.get_unchecked(lane);
                slot.query.offer(id, &leaf.sphere(lane));
            }
        }
    }
}

/// The rays of a batch, and how far it has come.
struct Batch<'a, Q: Question> {
    native: &'a Native,
    rays: &'a [Ray],
    answers: &'a mut [Q::Answer],
    /// The first ray that has not been on its way yet.
    next: usize,
}

impl<Q: Question> Batch<'_, Q> {
    /// Puts the next ray that needs the tree into the slot, and answers those before it that do not;
    /// `false` when there is none left.
    ///
    /// # Safety
    /// `slot` is valid for writing, and there are as many answers as rays.
    #[inline(always)]
    unsafe fn board(&mut self, slot: *mut Slot) -> bool {
        while let Some(ray) = self.rays.get(self.next) {
            let number = self.next;
            self.next += 1;
            match self.native.begin(ray, Q::ANY) {
                // SAFETY: the caller's promise.
                Ok((query, root)) => unsafe {
                    Slot::begin(slot, query, number as u32, root);
                    return true;
                },
                Err(answered) => {
                    let answer = answered.map_or_else(Q::no, |query| Q::answer(&query));
                    // SAFETY: there are as many answers as rays.
                    unsafe { *self.answers.get_unchecked_mut(number) = answer };
                }
            }
        }
        false
    }

    /// Answers a ray that has taken its last step.
    ///
    /// # Safety
    /// The slot holds a ray of this batch that is done.
    #[inline(always)]
    unsafe fn answer(&mut self, slot: &mut Slot) {
        // SAFETY: the caller's promise.
        let answer = unsafe { conclude::<Q>(self.native, slot) };
        let answer = match answer {
            Some(answer) => answer,
            // SAFETY: the ray is one of this batch.
            None => alone::<Q>(self.native, unsafe { self.rays.get_unchecked(slot.ray as usize) }),
        };
        // SAFETY: the ray is one of this batch, which has as many answers.
        unsafe { *self.answers.get_unchecked_mut(slot.ray as usize) = answer };
    }
}

/// What a ray that is done is told; `None` where its way was cut short by a sphere that it is to
/// overlook.
///
/// Nothing tests for such spheres on the way, because it hardly ever matters: a sphere that a ray
/// leaves is never sure to be hit, as the ray starts on it, nor is a lamp that ends it.
///
/// # Safety
/// The slot holds a ray that is done, in this tree.
#[inline(always)]
unsafe fn conclude<Q: Question>(native: &Native, slot: &mut Slot) -> Option<Q::Answer> {
    let tree = &native.tree;
    if Q::ANY && slot.sure != 0 {
        // SAFETY: sure hits are of the leaf that was kept last, and of lanes below 8.
        let is_hit = unsafe {
            let leaf = slot.kept_leaf(slot.kept - 1);
            let ids = tree.ids().get_unchecked(leaf as usize);
            each_lane(slot.sure).any(|lane| !slot.query.excludes(*ids.get_unchecked(lane)))
        };
        return is_hit.then(Q::yes);
    }
    // SAFETY: the caller's promise.
    unsafe { judge(tree, slot) };
    let reached = slot.query.t * slot.length;
    let is_cut_short = !Q::ANY && reached > f64::from(slot.limit);
    (!is_cut_short).then(|| Q::answer(&slot.query))
}

/// The same for a single ray, with every candidate judged at once: for rays that were cut short.
#[cold]
#[inline(never)]
fn alone<Q: Question>(native: &Native, ray: &Ray) -> Q::Answer {
    let (query, root) = match native.begin(ray, Q::ANY) {
        Ok(begun) => begun,
        Err(answered) => return answered.map_or_else(Q::no, |query| Q::answer(&query)),
    };
    let tree = &native.tree;
    let mut slot = MaybeUninit::<Slot>::uninit();
    // SAFETY: as in `step`; leaves are kept one at a time. With `ANY`, a leaf leaves the limit alone.
    unsafe {
        Slot::begin(slot.as_mut_ptr(), query, 0, root);
        let slot = slot.assume_init_mut();
        while slot.next != Child::NONE && !(Q::ANY && slot.query.has_hit()) {
            let next = slot.next;
            if next.is_leaf() {
                let leaf = tree.leaves().as_ptr().add(next.index());
                slot.through_leaf::<Portable, true>(leaf, next.index() as u32);
                judge(tree, slot);
                slot.kept = 0;
                slot.limit = slot.limit_of(slot.query.t);
            } else {
                slot.through_node::<Portable, false>(tree.nodes().as_ptr().add(next.index()));
            }
            slot.pop::<false>();
        }
        Q::answer(&slot.query)
    }
}
