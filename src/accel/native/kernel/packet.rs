//! Rays that are alike: sixteen go through the tree as one.
//!
//! The samples of a pixel leave the camera within a thin beam and meet the same boxes. So a *packet* of
//! them takes each step once: its *lead* meets a box where any ray between the extremes of the
//! packet's origins and directions might (Reshetov, Soupikov and Hurley 2005, "Multi-level ray tracing
//! algorithm"), and goes as far as the ray with the farthest limit. In a leaf, a sphere is looked at
//! if the beam may touch it, and then by all rays, side by side; from there on each ray has its own
//! limit and its own candidates, as in [`super::slot`].
//!
//! # Boxes
//!
//! Let the packet's origins lie in a box and the components of its directions in intervals that do not
//! contain 0, or are nothing but 0, which counts as 2^-60. A ray enters through a plane `p` at
//! `(p - o) / u`. For `u > 0` this is at least `(p - o') / u`, with the largest `o'` there is, and this
//! in turn at least the smaller of its values at the two ends of the interval of `1 / u`; for `u < 0`
//! likewise with the smallest `o'`. So the earliest entry and the latest exit come from four sums for
//! each axis ([`Slabs::set`] for both ends), and each is wrong by no more than for the ray that it
//! belongs to.

use std::mem::MaybeUninit;

use crate::accel::native::limits::KEPT;
use crate::accel::native::node::{Child, Leaf, each_lane};
use crate::accel::native::query::Best;
use crate::accel::native::tree::Tree;
use crate::math::Ray;

use super::alone::alone;
use super::batch::{Batch, is_valid};
use super::beam::{Beam, Each, Extremes, all_extremes, extremes, load, load_all};
use super::lanes::Lanes;
use super::pending::{Kept, Pending, Waiting};
use super::question::Closest;
use super::slabs::{Near, Slabs, slack};
use super::slot::{Eight, Slot, begin_of, is_unit, limit_of};
use super::spheres::{ERROR, LEAST_ERROR, Met, Rays};

/// Rays of a packet.
pub(super) const RAYS: usize = 2 * 8;
/// Steps, and spheres looked at, after which a packet is given up. Sixteen rays by themselves take some
/// hundreds of steps together, and packets that pay far fewer than these.
const MOST_STEPS: u32 = 384;
/// Spheres with candidates that a packet can hold, as many as a number has bits.
const SPHERES: usize = 64;

/// Sixteen rays on their way together.
#[repr(C, align(64))]
pub(super) struct Packet {
    /// For the stack: a ray that stands for all of them, with planes for one end of the directions.
    lead: Slot,
    /// Planes for the other end.
    other: Slabs,
    beam: Beam,
    origin: [Each; 3],
    unit: [Each; 3],
    error: Each,
    t_min: [Each; 2],
    limit: Each,
    best: [Best; RAYS],
    /// The number of the first ray.
    first: u32,
    /// Spheres with candidates so far.
    count: u32,
    steps: u32,
    spheres: [MaybeUninit<Kept>; SPHERES],
    from: [MaybeUninit<Each>; SPHERES],
}

/// How far a packet has come.
pub(super) enum Step {
    OnTheWay,
    Done,
    /// The rays go better by themselves: there is no room for another sphere, or where they go the tree
    /// is much finer than the beam.
    Split,
}

/// Whether rays may be a packet, judged by two of them. Never leaves out rays that pass all of
/// [`Packet::begin`]'s tests.
#[inline(always)]
fn may_be_alike(rays: &[Ray; RAYS]) -> bool {
    let [first, .., last] = rays;
    let apart = |axis: usize| (first.direction[axis] - last.direction[axis]).abs();
    apart(0) + apart(1) + apart(2) < 0.5
}

impl Packet {
    /// Makes a packet of the sixteen rays of a batch from this one on; `false` if they are not alike, or
    /// too few.
    ///
    /// # Safety
    /// `packet` is valid for writing, the tree has a root, and the instructions of `L` are there.
    #[inline(always)]
    pub(super) unsafe fn board<L: Lanes>(
        packet: *mut Self,
        batch: &Batch<'_, Closest>,
        first: usize,
    ) -> bool {
        let rays = batch.rays.get(first..).and_then(|rays| rays.first_chunk::<RAYS>());
        let Some(rays) = rays.filter(|rays| may_be_alike(rays)) else { return false };
        // SAFETY: the caller's promise.
        unsafe {
            for ray in rays {
                if !is_valid::<L>(ray) {
                    return false;
                }
            }
            let best = rays.each_ref().map(|ray| batch.bvh.best_giant(ray, false));
            Self::begin::<L>(packet, &batch.bvh.tree, rays, &best, first as u32)
        }
    }

    /// Makes a packet of rays that are valid and not answered yet, at the root of the tree; `false` if
    /// they are not alike enough for that.
    ///
    /// # Safety
    /// `packet` is valid for writing, and after `true` for reading. There are as many rays as a packet
    /// has, the tree has a root, and the instructions of `L` are there.
    #[inline(always)]
    unsafe fn begin<L: Lanes>(
        packet: *mut Self,
        tree: &Tree,
        rays: &[Ray; RAYS],
        best: &[Best; RAYS],
        first: u32,
    ) -> bool {
        // SAFETY: all fields that are read before they are written are set here; the arrays at the end
        // need no value. All of them are plain numbers.
        let packet = unsafe { &mut *packet };
        let Some(root) = tree.root else { return false };
        let mut is_unit_length = true;
        for (number, (ray, best)) in rays.iter().zip(best).enumerate() {
            let (half, lane) = (number / 8, number % 8);
            is_unit_length &= is_unit(ray);
            for axis in 0..3 {
                packet.origin[axis][half].0[lane] = ray.origin[axis];
                packet.unit[axis][half].0[lane] = ray.direction[axis];
            }
            let [x, y, z] = ray.origin;
            packet.error[half].0[lane] = ERROR * (x.abs() + y.abs() + z.abs()) + LEAST_ERROR;
            let [earliest, latest] = begin_of(ray, 1.0);
            packet.t_min[0][half].0[lane] = earliest;
            packet.t_min[1][half].0[lane] = latest;
            packet.limit[half].0[lane] = limit_of(best.t);
        }
        if !is_unit_length {
            return false;
        }
        // SAFETY: the instructions are there.
        unsafe {
            let origin = all_extremes::<L>(&packet.origin);
            let unit = all_extremes::<L>(&packet.unit);
            if !unit.iter().all(is_of_one_sign) {
                return false;
            }
            let beam = Beam::around::<L>((&packet.origin, &origin), (&packet.unit, &unit));
            if !beam.is_thin(tree) {
                return false;
            }
            packet.beam = beam;
            let [t_min, _] = extremes::<L>(&packet.t_min[0]);
            let [_, limit] = extremes::<L>(&packet.limit);
            let near = Near::of(&end(&unit, 0, 1.0));
            let slabs = packet.lead.lead(root, near, [t_min, limit]);
            set_planes([slabs, &mut packet.other], &origin, &unit, beam.sum);
        }
        packet.best = *best;
        packet.first = first;
        packet.count = 0;
        packet.steps = 0;
        true
    }

    /// Takes a step.
    ///
    /// # Safety
    /// The packet has begun in this tree and is on the way; the instructions of `L` are there.
    #[inline(always)]
    pub(super) unsafe fn step<L: Lanes>(&mut self, tree: &Tree) -> Step {
        // SAFETY: the lead is at a node or a leaf of this tree, and its stack has room by the builder's
        // bound.
        unsafe {
            let next = self.lead.next;
            if next.is_leaf() {
                let leaf = tree.leaves().as_ptr().add(next.index());
                if !self.through_leaf::<L>(leaf, next.index() as u32) {
                    return Step::Split;
                }
            } else {
                let node = tree.nodes().as_ptr().add(next.index());
                self.lead.through_node_with::<L>(&self.other, node);
            }
            self.lead.pop::<false>();
            self.steps += 1;
            if self.lead.next == Child::NONE {
                Step::Done
            } else if self.steps < MOST_STEPS {
                Step::OnTheWay
            } else {
                Step::Split
            }
        }
    }

    /// What it does next.
    #[inline(always)]
    pub(super) fn next(&self) -> Child {
        self.lead.next
    }

    /// The number of the first of its rays.
    #[inline(always)]
    pub(super) fn first(&self) -> usize {
        self.first as usize
    }

    /// Looks at the spheres of a leaf that the beam may touch; `false` if there is no room for them.
    ///
    /// # Safety
    /// The packet has begun, `leaf` is valid, and the instructions of `L` are there.
    #[inline(always)]
    unsafe fn through_leaf<L: Lanes>(&mut self, leaf: *const Leaf, index: u32) -> bool {
        // SAFETY: a leaf is four times eight numbers, aligned, of which a lane is one of each.
        unsafe {
            let touched = self.beam.touched::<L>(leaf, self.lead.limit);
            self.steps += touched.count_ones();
            for lane in each_lane(touched) {
                if self.count as usize == SPHERES {
                    return false;
                }
                let lanes = leaf.cast::<f32>().add(lane);
                let center = [*lanes, *lanes.add(8), *lanes.add(16)];
                let kept = Kept { leaf: index, lanes: 1 << lane };
                self.look_at::<L>(center, *lanes.add(24), kept);
            }
        }
        true
    }

    /// Tests a sphere with every ray.
    ///
    /// # Safety
    /// The packet has begun and has room for a sphere; the instructions of `L` are there.
    #[inline(always)]
    unsafe fn look_at<L: Lanes>(&mut self, center: [f32; 3], radius: f32, kept: Kept) {
        // SAFETY: `count` is a place of the arrays.
        unsafe {
            let place = self.count as usize;
            let from = self.from.as_mut_ptr().add(place).cast::<Eight>();
            let (mut candidates, mut sure) = (0, 0);
            for half in 0..2 {
                let origin = load_all::<L>(&self.origin, half);
                let limit = load::<L>(&self.limit[half]);
                let rays = Rays::<L> {
                    to_center: [
                        L::sub(L::splat(center[0]), origin[0]),
                        L::sub(L::splat(center[1]), origin[1]),
                        L::sub(L::splat(center[2]), origin[2]),
                    ],
                    unit: load_all::<L>(&self.unit, half),
                    error: load::<L>(&self.error[half]),
                    t_min: [load::<L>(&self.t_min[0][half]), load::<L>(&self.t_min[1][half])],
                    limit,
                };
                let Met { candidate, sure: is_sure, t, t_above } = rays.meet(L::splat(radius));
                let nearer = L::min(limit, L::select(is_sure, t_above, limit));
                L::store(self.limit[half].0.as_mut_ptr(), nearer);
                let t = L::select(candidate, t, L::splat(f32::NAN));
                L::store(from.add(half).cast(), t);
                candidates |= L::bits(candidate);
                sure |= L::bits(is_sure);
            }
            self.spheres.as_mut_ptr().add(place).cast::<Kept>().write(kept);
            self.count += u32::from(candidates != 0);
            if sure != 0 {
                let [_, limit] = extremes::<L>(&self.limit);
                self.lead.limit = limit;
            }
        }
    }

    /// Hands the rays over to be judged.
    ///
    /// # Safety
    /// The packet is done and of this batch, `to` is not full, and the instructions of `L` are there.
    #[inline(always)]
    pub(super) unsafe fn land<L: Lanes>(&self, batch: &mut Batch<'_, Closest>, to: &mut Pending) {
        // The spheres of each ray, as bits.
        let mut spheres_of = [0u64; RAYS];
        for place in 0..self.count as usize {
            // SAFETY: what is below the count was written; the instructions are there.
            let rays = unsafe {
                let from = self.from.get_unchecked(place).assume_init_ref();
                let one = L::le(load::<L>(&from[0]), load::<L>(&self.limit[0]));
                let two = L::le(load::<L>(&from[1]), load::<L>(&self.limit[1]));
                L::bits(one) | L::bits(two) << 8
            };
            for ray in each_lane(rays) {
                spheres_of[ray] |= 1 << place;
            }
        }
        for (number, (spheres, &best)) in spheres_of.into_iter().zip(&self.best).enumerate() {
            let ray = self.first + number as u32;
            // SAFETY: a bit is the place of a sphere that was written; there is room for one ray and
            // as many leaves as it can have kept.
            unsafe {
                if spheres.count_ones() as usize > KEPT {
                    batch.answers[ray as usize] =
                        alone::<Closest>(batch.bvh, &batch.rays[ray as usize]);
                    continue;
                }
                let mut left = spheres;
                while left != 0 {
                    let place = left.trailing_zeros() as usize;
                    to.keep(self.spheres.get_unchecked(place).assume_init());
                    left &= left - 1;
                }
                let limit = self.limit[number / 8].0[number % 8];
                to.finish(Waiting { ray, end: 0, limit, is_sure: false, best, length: 1.0 });
                if to.is_full() {
                    to.settle::<L, Closest>(batch);
                }
            }
        }
    }
}

/// Sets the planes for both ends of the directions between these extremes.
#[inline(always)]
fn set_planes(slabs: [&mut Slabs; 2], origin: &Extremes, unit: &Extremes, sum: f32) {
    let (low, high) = (end(origin, 0, 0.0), end(origin, 1, 0.0));
    let ends = [0, 1].map(|which| end(unit, which, 1.0));
    let of = |is_first: bool| -> [f32; 4] {
        std::array::from_fn(|axis| {
            if ends[0][axis].is_sign_positive() == is_first { low[axis] } else { high[axis] }
        })
    };
    let (first, last, slack) = (of(true), of(false), slack(sum));
    slabs.into_iter().zip(&ends).for_each(|(slabs, unit)| slabs.set(&first, &last, unit, slack));
}

/// The smallest numbers of all axes, or the largest, and a fourth. Of the two zeros there are, they are
/// never the negative one.
#[inline(always)]
fn end(pairs: &Extremes, which: usize, fourth: f32) -> [f32; 4] {
    [pairs[0][which] + 0.0, pairs[1][which] + 0.0, pairs[2][which] + 0.0, fourth]
}

/// Whether numbers between these are all above 0, all below, or all 0.
#[inline(always)]
fn is_of_one_sign([low, high]: &[f32; 2]) -> bool {
    *low > 0.0 || *high < 0.0 || (*low == 0.0 && *high == 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::BuildOptions;
    use crate::accel::native::Native;
    use crate::accel::native::kernel::lanes::Portable;
    use crate::geometry::{Sphere, SphereRows, SphereSet};
    use crate::math::{DVec3, Hit, NO_SPHERE};
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
        let batch = Batch::<Closest> { bvh: &native.bvh, rays, answers, next: 0, end: rays.len() };
        let mut packet = MaybeUninit::uninit();
        // SAFETY: the tree has a root, and the portable form needs no special instructions.
        unsafe { Packet::board::<Portable>(packet.as_mut_ptr(), &batch, 0) }
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
