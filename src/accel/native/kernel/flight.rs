//! A batch on its way: rays take turns until all have been answered.

use std::mem::MaybeUninit;

use crate::accel::native::Native;
use crate::accel::native::query::Best;
use crate::math::{Hit, Ray};

use super::lanes::Lanes;
use super::packet::{Packet, RAYS, Step, may_be_alike};
use super::pending::Pending;
use super::single::{alone, one_by_one, prefetch};
use super::slot::Slot;

/// Packets under way at once.
const PACKETS: usize = 4;

/// What a batch is asked.
pub(super) trait Question {
    /// Whether any hit will do.
    const ANY: bool;
    /// What each ray is told.
    type Answer;

    fn answer(best: Best) -> Self::Answer;

    /// Answers the rays of a batch; what is still to be judged stays pending.
    ///
    /// # Safety
    /// As for [`fly`].
    #[inline(always)]
    unsafe fn trace<L: Lanes>(batch: &mut Batch<'_, Self>, pending: &mut Pending)
    where
        Self: Sized,
    {
        // SAFETY: the caller's promise.
        unsafe { one_by_one::<L, Self>(batch, pending) };
    }
}

/// Which sphere is hit first.
pub(super) struct Closest;

/// Whether any sphere is hit.
pub(super) struct Any;

impl Question for Closest {
    const ANY: bool = false;
    type Answer = Hit;

    #[inline(always)]
    fn answer(best: Best) -> Hit {
        best.hit()
    }

    #[inline(always)]
    unsafe fn trace<L: Lanes>(batch: &mut Batch<'_, Self>, pending: &mut Pending) {
        // SAFETY: the caller's promise.
        unsafe { in_packets::<L>(batch, pending) };
    }
}

impl Question for Any {
    const ANY: bool = true;
    type Answer = bool;

    #[inline(always)]
    fn answer(best: Best) -> bool {
        best.is_hit()
    }
}

/// Answers all rays of a batch: those that are alike in packets, the others by themselves.
///
/// # Safety
/// Needs the instructions of `L`, and as many answers as rays; the tree has a root.
#[inline(always)]
pub(super) unsafe fn fly<L: Lanes, Q: Question>(
    native: &Native,
    rays: &[Ray],
    answers: &mut [Q::Answer],
) {
    let mut pending = Pending::new();
    let mut batch = Batch::<Q> { native, rays, answers, next: 0, end: rays.len() };
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
    let tree = &batch.native.tree;
    let mut next = 0;
    // SAFETY: `under_way` holds distinct packets, those up to `count` have begun; the rest is the
    // caller's promise.
    unsafe {
        loop {
            // Rays that are not alike.
            let first = next;
            while next < batch.rays.len() && !batch.board_packet::<L>(under_way[0], next) {
                next = batch.rays.len().min(next + RAYS);
            }
            (batch.next, batch.end) = (first, next);
            one_by_one::<L, Closest>(batch, pending);
            if next == batch.rays.len() {
                return;
            }
            next += RAYS;
            let mut count = 1;
            while count < PACKETS && batch.board_packet::<L>(under_way[count], next) {
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
                    if batch.board_packet::<L>(packet, next) {
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
    native: &Native,
    rays: &[Ray],
    answers: &mut [Q::Answer],
) {
    let mut slot = MaybeUninit::<Slot>::uninit();
    let mut batch = Batch::<Q> { native, rays, answers, next: 0, end: rays.len() };
    let mut pending = Pending::new();
    // SAFETY: the slot is boarded before it is read. There are no more leaves than a slot can keep.
    unsafe {
        while batch.board::<L>(slot.as_mut_ptr()) {
            let slot = slot.assume_init_mut();
            for (index, leaf) in native.tree.leaves().iter().enumerate() {
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

/// The rays of a batch, and how far it has come.
pub(super) struct Batch<'a, Q: Question> {
    pub(super) native: &'a Native,
    pub(super) rays: &'a [Ray],
    pub(super) answers: &'a mut [Q::Answer],
    /// The first ray that has not been on its way yet.
    pub(super) next: usize,
    /// Behind the last ray that is to go.
    pub(super) end: usize,
}

impl<Q: Question> Batch<'_, Q> {
    /// Puts the next ray that needs the tree into the slot, and answers those before it that do not;
    /// `false` when there is none left.
    ///
    /// # Safety
    /// `slot` is valid for writing, the instructions of `L` are there, and as many answers as rays.
    #[inline(always)]
    pub(super) unsafe fn board<L: Lanes>(&mut self, slot: *mut Slot) -> bool {
        while let Some(ray) = self.rays[..self.end].get(self.next) {
            let number = self.next;
            self.next += 1;
            let mut best = Best::none(ray);
            // SAFETY: the caller's promise.
            unsafe {
                if is_valid::<L>(ray) {
                    best = self.native.best_giant(ray, Q::ANY);
                    let root = self.native.tree.root;
                    let is_open = !(Q::ANY && best.is_hit());
                    if is_open && Slot::begin(slot, ray, best, number as u32, root) {
                        return true;
                    }
                }
                *self.answers.get_unchecked_mut(number) = Q::answer(best);
            }
        }
        false
    }
}

impl Batch<'_, Closest> {
    /// Makes a packet of the sixteen rays from this one on; `false` if they are not alike, or too few.
    ///
    /// # Safety
    /// `packet` is valid for writing, the tree has a root, and the instructions of `L` are there.
    #[inline(always)]
    unsafe fn board_packet<L: Lanes>(&self, packet: *mut Packet, first: usize) -> bool {
        let rays = self.rays.get(first..).and_then(|rays| rays.first_chunk::<RAYS>());
        let Some(rays) = rays.filter(|rays| may_be_alike(rays)) else { return false };
        // SAFETY: the caller's promise.
        unsafe {
            for ray in rays {
                if !is_valid::<L>(ray) {
                    return false;
                }
            }
            let best = rays.each_ref().map(|ray| self.native.best_giant(ray, false));
            Packet::begin::<L>(packet, &self.native.tree, rays, &best, first as u32)
        }
    }

    /// Answers a ray by itself.
    #[inline(always)]
    pub(super) fn answer_alone(&mut self, ray: u32) {
        self.answers[ray as usize] = alone::<Closest>(self.native, &self.rays[ray as usize]);
    }
}

/// [`Ray::is_valid`], all numbers at once.
///
/// # Safety
/// The instructions of `L` are there.
#[inline(always)]
unsafe fn is_valid<L: Lanes>(ray: &Ray) -> bool {
    /// As [`Bounds`], lane by lane.
    #[repr(C, align(32))]
    struct Bounds([f32; 8]);
    const MOST: f32 = 4.0 * crate::math::MAX_COORDINATE as f32;
    const INFINITE: f32 = f32::INFINITY;
    static LOW: Bounds = Bounds([-MOST, -MOST, -MOST, 0.0, -MOST, -MOST, -MOST, 0.0]);
    static HIGH: Bounds = Bounds([MOST, MOST, MOST, MOST, MOST, MOST, MOST, INFINITE]);
    // SAFETY: a ray begins with its origin, t_min, direction and t_max, eight numbers, aligned.
    unsafe {
        let numbers = L::load(std::ptr::from_ref(ray).cast());
        let is_above = L::le(L::load(LOW.0.as_ptr()), numbers);
        let is_below = L::le(numbers, L::load(HIGH.0.as_ptr()));
        L::bits(L::and(is_above, is_below)) == 0xff
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::BuildOptions;
    use crate::accel::native::kernel::lanes::Portable;
    use crate::geometry::{Sphere, SphereRows, SphereSet};
    use crate::math::{DVec3, NO_SPHERE};
    use std::sync::Arc;

    /// A cube of 16 x 16 x 16 balls, two apart.
    fn cube() -> Native {
        let place = |i: i32| DVec3::new((i % 16).into(), (i / 16 % 16).into(), (i / 256).into());
        let ball = |i| Sphere { center: 2.0 * place(i) - 15.0, radius: 0.5 };
        let rows = SphereRows { exact: (0..4096).map(ball).collect(), ..SphereRows::default() };
        let set = Arc::new(SphereSet::new(rows).expect("few spheres"));
        Native::new(set, &BuildOptions::default()).expect("nobody cancels")
    }

    /// Sixteen rays from one place whose directions differ by up to this.
    fn beam(apart: f64) -> Vec<Ray> {
        let direction = |i: i32| DVec3::new(0.3, 0.2 + apart * f64::from(i) / 15.0, -1.0);
        let origin = DVec3::new(-9.0, -6.0, 40.0);
        let exclude = [NO_SPHERE; 2];
        (0..16)
            .map(|i| Ray::new(origin, direction(i).normalize(), 0.0, f64::INFINITY, exclude))
            .collect()
    }

    fn is_packet(native: &Native, rays: &[Ray]) -> bool {
        let answers = &mut vec![Hit::MISS; rays.len()];
        let batch = Batch::<Closest> { native, rays, answers, next: 0, end: rays.len() };
        let mut packet = MaybeUninit::uninit();
        // SAFETY: the tree has a root, and the portable form needs no special instructions.
        unsafe { batch.board_packet::<Portable>(packet.as_mut_ptr(), 0) }
    }

    #[test]
    fn rays_go_together_that_are_close_beside_the_leaves() {
        let native = cube();
        for apart in [0.0, 1e-6, 1e-3, 1e-2] {
            assert!(is_packet(&native, &beam(apart)), "{apart}");
        }
        for apart in [0.5, 2.0] {
            assert!(!is_packet(&native, &beam(apart)), "{apart}");
        }
        assert!(!is_packet(&native, &beam(0.0)[1..]));
        let mut rays = beam(1e-3);
        rays[7].t_min = f32::NAN;
        assert!(!is_packet(&native, &rays));
        rays[7] = Ray { direction: [0.0, 0.0, -2.0], ..rays[0] };
        assert!(!is_packet(&native, &rays));
        rays[7] = Ray { direction: [-1e-4, 0.0, -1.0], ..rays[0] };
        assert!(!is_packet(&native, &rays));
    }
}
