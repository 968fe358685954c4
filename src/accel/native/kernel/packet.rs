//! Coherent rays: sixteen traverse the tree as one packet.
//!
//! The samples of a pixel leave the camera within a thin cone and hit the same boxes. So a *packet*
//! of them takes each step once: its *interval ray* hits a box if any ray within the ranges of the
//! packet's origins and directions might (Reshetov, Soupikov and Hurley 2005, "Multi-level ray
//! tracing algorithm"), and reaches as far as the ray with the farthest limit. In a leaf, a sphere
//! is tested only if the cone may overlap it, and then with all rays in SIMD; after that each ray
//! has its own limit and its own candidates, as in [`super::ray_state`].
//!
//! # Boxes
//!
//! Let the packet's origins lie in a box and the components of its directions in intervals that do
//! not contain 0, or are exactly 0, which counts as 2^-60. A ray enters through a plane `p` at
//! `(p - o) / u`. For `u > 0` this is at least `(p - o') / u`, with the largest origin `o'`, and
//! this in turn is at least the smaller of its values at the two ends of the interval of `1 / u`;
//! for `u < 0` likewise with the smallest `o'`. So the earliest entry and the latest exit come from
//! four sums for each axis ([`Slabs::set`] for both ends), and the error of each is no larger than
//! that of the ray it belongs to.

use std::mem::MaybeUninit;

use crate::accel::native::bvh::Bvh;
use crate::accel::native::limits::MAX_CANDIDATE_LEAVES;
use crate::accel::native::node::{NodeRef, SphereLeaf, mask_lanes};
use crate::accel::native::query::BestHit;
use crate::math::Ray;

use super::batch::{RayBatch, is_valid};
use super::candidates::{CandidateQueue, FinishedRay, LeafCandidates};
use super::cone::{
    AxisRanges, PacketCone, PacketFloats, axis_ranges, load_half, load_vec3, min_max,
};
use super::query_mode::ClosestHit;
use super::ray_state::{F32x8, RayState, is_unit, limit_for, t_min_bounds};
use super::scalar::trace_scalar;
use super::simd::Simd8;
use super::slabs::{NearPlanes, Slabs, slack};
use super::spheres::{ERROR_SCALE, MIN_ERROR, SphereHits, SphereTest};

/// Rays of a packet.
pub(super) const PACKET_SIZE: usize = 2 * 8;
/// Steps, including spheres tested, after which a packet is split. Sixteen single rays take some
/// hundreds of steps together, and packets that pay off take far fewer than this.
const MAX_STEPS: u32 = 384;
/// Maximum number of spheres with candidates in a packet: the bits of a mask.
const MAX_CANDIDATES: usize = 64;

/// Sixteen rays that traverse together.
#[repr(C, align(64))]
pub(super) struct RayPacket {
    /// The interval ray, which owns the stack; its slabs are for one end of the direction ranges.
    interval: RayState,
    /// Slabs for the other end.
    far_slabs: Slabs,
    cone: PacketCone,
    origin: [PacketFloats; 3],
    unit: [PacketFloats; 3],
    error: PacketFloats,
    t_min: [PacketFloats; 2],
    limit: PacketFloats,
    best: [BestHit; PACKET_SIZE],
    /// The index of the first ray.
    first_ray: u32,
    /// Spheres with candidates so far.
    candidate_count: u32,
    steps: u32,
    candidates: [MaybeUninit<LeafCandidates>; MAX_CANDIDATES],
    t_lower: [MaybeUninit<PacketFloats>; MAX_CANDIDATES],
}

/// The state of a packet after a step.
pub(super) enum PacketStatus {
    Active,
    Done,
    /// The rays are faster one by one: there is no room for another sphere, or the tree is much
    /// finer than the cone where they are.
    Split,
}

/// A quick test of two rays if a packet may be coherent. Never rejects rays that pass all of
/// [`RayPacket::init`]'s tests.
#[inline(always)]
fn may_be_coherent(rays: &[Ray; PACKET_SIZE]) -> bool {
    let [first, .., last] = rays;
    let spread = |axis: usize| (first.direction[axis] - last.direction[axis]).abs();
    spread(0) + spread(1) + spread(2) < 0.5
}

impl RayPacket {
    /// Makes a packet of sixteen rays of a batch from this index. Returns false if they are not
    /// coherent, or too few.
    ///
    /// # Safety
    /// `packet` is valid for writing, the tree has a root, and the CPU supports `L`.
    #[inline(always)]
    pub(super) unsafe fn load_packet<L: Simd8>(
        packet: *mut Self,
        batch: &RayBatch<'_, ClosestHit>,
        first: usize,
    ) -> bool {
        let rays = batch.rays.get(first..).and_then(|rays| rays.first_chunk::<PACKET_SIZE>());
        let Some(rays) = rays.filter(|rays| may_be_coherent(rays)) else { return false };
        // SAFETY: upheld by the caller.
        unsafe {
            for ray in rays {
                if !is_valid::<L>(ray) {
                    return false;
                }
            }
            let best = rays.each_ref().map(|ray| batch.bvh.closest_giant(ray, false));
            Self::init::<L>(packet, &batch.bvh.tree, rays, &best, first as u32)
        }
    }

    /// Makes a packet of valid, unresolved rays, at the root of the tree. Returns false if they are
    /// not coherent.
    ///
    /// # Safety
    /// `packet` is valid for writing, and after `true` for reading. There are as many rays as a
    /// packet has, the tree has a root, and the CPU supports `L`.
    #[inline(always)]
    unsafe fn init<L: Simd8>(
        packet: *mut Self,
        tree: &Bvh,
        rays: &[Ray; PACKET_SIZE],
        best: &[BestHit; PACKET_SIZE],
        first: u32,
    ) -> bool {
        // SAFETY: all fields that are read before they are written are set here; the arrays at the
        // end need no value. All of them are plain numbers.
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
            packet.error[half].0[lane] = ERROR_SCALE * (x.abs() + y.abs() + z.abs()) + MIN_ERROR;
            let [earliest, latest] = t_min_bounds(ray, 1.0);
            packet.t_min[0][half].0[lane] = earliest;
            packet.t_min[1][half].0[lane] = latest;
            packet.limit[half].0[lane] = limit_for(best.t);
        }
        if !is_unit_length {
            return false;
        }
        // SAFETY: the CPU supports the instructions.
        unsafe {
            let origin = axis_ranges::<L>(&packet.origin);
            let unit = axis_ranges::<L>(&packet.unit);
            if !unit.iter().all(has_constant_sign) {
                return false;
            }
            let cone = PacketCone::from_rays::<L>((&packet.origin, &origin), (&packet.unit, &unit));
            if !cone.is_coherent(tree) {
                return false;
            }
            packet.cone = cone;
            let [t_min, _] = min_max::<L>(&packet.t_min[0]);
            let [_, limit] = min_max::<L>(&packet.limit);
            let near = NearPlanes::from_direction(&interval_end(&unit, 0, 1.0));
            let slabs = packet.interval.init_interval(root, near, [t_min, limit]);
            set_interval_slabs([slabs, &mut packet.far_slabs], &origin, &unit, cone.max_origin_sum);
        }
        packet.best = *best;
        packet.first_ray = first;
        packet.candidate_count = 0;
        packet.steps = 0;
        true
    }

    /// Takes a step.
    ///
    /// # Safety
    /// The packet is initialised for this tree and active; the CPU supports `L`.
    #[inline(always)]
    pub(super) unsafe fn step<L: Simd8>(&mut self, tree: &Bvh) -> PacketStatus {
        // SAFETY: the interval ray is at a node or a leaf of this tree, and its stack has room by
        // the builder's bound.
        unsafe {
            let next = self.interval.next;
            if next.is_leaf() {
                let leaf = tree.leaves().as_ptr().add(next.index());
                if !self.intersect_leaf::<L>(leaf, next.index() as u32) {
                    return PacketStatus::Split;
                }
            } else {
                let node = tree.nodes().as_ptr().add(next.index());
                self.interval.intersect_node_interval::<L>(&self.far_slabs, node);
            }
            self.interval.pop::<false>();
            self.steps += 1;
            if self.interval.next == NodeRef::NONE {
                PacketStatus::Done
            } else if self.steps < MAX_STEPS {
                PacketStatus::Active
            } else {
                PacketStatus::Split
            }
        }
    }

    /// The node or leaf to visit next.
    #[inline(always)]
    pub(super) fn next(&self) -> NodeRef {
        self.interval.next
    }

    /// The index of the first ray.
    #[inline(always)]
    pub(super) fn first_ray(&self) -> usize {
        self.first_ray as usize
    }

    /// Tests the spheres of a leaf that the cone may overlap. Returns false if there is no room for
    /// them.
    ///
    /// # Safety
    /// The packet is initialised, `leaf` is valid, and the CPU supports `L`.
    #[inline(always)]
    unsafe fn intersect_leaf<L: Simd8>(&mut self, leaf: *const SphereLeaf, index: u32) -> bool {
        // SAFETY: a leaf is four times eight aligned numbers, of which a lane is one each.
        unsafe {
            let overlapping = self.cone.overlapping::<L>(leaf, self.interval.limit);
            self.steps += overlapping.count_ones();
            for lane in mask_lanes(overlapping) {
                if self.candidate_count as usize == MAX_CANDIDATES {
                    return false;
                }
                let lanes = leaf.cast::<f32>().add(lane);
                let center = [*lanes, *lanes.add(8), *lanes.add(16)];
                let leaf_candidates = LeafCandidates { leaf: index, mask: 1 << lane };
                self.test_sphere::<L>(center, *lanes.add(24), leaf_candidates);
            }
        }
        true
    }

    /// Tests a sphere with every ray.
    ///
    /// # Safety
    /// The packet is initialised and has room for a sphere; the CPU supports `L`.
    #[inline(always)]
    unsafe fn test_sphere<L: Simd8>(
        &mut self,
        center: [f32; 3],
        radius: f32,
        leaf_candidates: LeafCandidates,
    ) {
        // SAFETY: `candidate_count` is an index into the arrays.
        unsafe {
            let slot = self.candidate_count as usize;
            let src = self.t_lower.as_mut_ptr().add(slot).cast::<F32x8>();
            let (mut candidates, mut certain) = (0, 0);
            for half in 0..2 {
                let origin = load_vec3::<L>(&self.origin, half);
                let limit = load_half::<L>(&self.limit[half]);
                let rays = SphereTest::<L> {
                    to_center: [
                        L::sub(L::splat(center[0]), origin[0]),
                        L::sub(L::splat(center[1]), origin[1]),
                        L::sub(L::splat(center[2]), origin[2]),
                    ],
                    unit: load_vec3::<L>(&self.unit, half),
                    error: load_half::<L>(&self.error[half]),
                    t_min: [
                        load_half::<L>(&self.t_min[0][half]),
                        load_half::<L>(&self.t_min[1][half]),
                    ],
                    limit,
                };
                let SphereHits { candidate, certain: is_certain, t_lower: t, t_upper } =
                    rays.intersect(L::splat(radius));
                let nearer = L::min(limit, L::select(is_certain, t_upper, limit));
                L::store(self.limit[half].0.as_mut_ptr(), nearer);
                let t = L::select(candidate, t, L::splat(f32::NAN));
                L::store(src.add(half).cast(), t);
                candidates |= L::mask_bits(candidate);
                certain |= L::mask_bits(is_certain);
            }
            self.candidates.as_mut_ptr().add(slot).cast::<LeafCandidates>().write(leaf_candidates);
            self.candidate_count += u32::from(candidates != 0);
            if certain != 0 {
                let [_, limit] = min_max::<L>(&self.limit);
                self.interval.limit = limit;
            }
        }
    }

    /// Pushes the rays to the queue for the exact test.
    ///
    /// # Safety
    /// The packet is done and belongs to this batch, `to` is not full, and the CPU supports `L`.
    #[inline(always)]
    pub(super) unsafe fn finish<L: Simd8>(
        &self,
        batch: &mut RayBatch<'_, ClosestHit>,
        to: &mut CandidateQueue,
    ) {
        // A mask of the candidate spheres of each ray.
        let mut spheres_of = [0u64; PACKET_SIZE];
        for slot in 0..self.candidate_count as usize {
            // SAFETY: entries below the count were written; the CPU supports `L`.
            let rays = unsafe {
                let src = self.t_lower.get_unchecked(slot).assume_init_ref();
                let lo = L::le(load_half::<L>(&src[0]), load_half::<L>(&self.limit[0]));
                let hi = L::le(load_half::<L>(&src[1]), load_half::<L>(&self.limit[1]));
                L::mask_bits(lo) | L::mask_bits(hi) << 8
            };
            for ray in mask_lanes(rays) {
                spheres_of[ray] |= 1 << slot;
            }
        }
        for (number, (spheres, &best)) in spheres_of.into_iter().zip(&self.best).enumerate() {
            let ray = self.first_ray + number as u32;
            // SAFETY: a bit is the index of a sphere that was written; there is room for one ray
            // and its maximum number of leaves.
            unsafe {
                if spheres.count_ones() as usize > MAX_CANDIDATE_LEAVES {
                    batch.outputs[ray as usize] =
                        trace_scalar::<ClosestHit>(batch.bvh, &batch.rays[ray as usize]);
                    continue;
                }
                let mut remaining = spheres;
                while remaining != 0 {
                    let slot = remaining.trailing_zeros() as usize;
                    to.push_candidates(self.candidates.get_unchecked(slot).assume_init());
                    remaining &= remaining - 1;
                }
                let limit = self.limit[number / 8].0[number % 8];
                to.push_finished(FinishedRay {
                    ray,
                    leaf_end: 0,
                    limit,
                    is_certain: false,
                    best,
                    length: 1.0,
                });
                if to.is_full() {
                    to.resolve::<L, ClosestHit>(batch);
                }
            }
        }
    }
}

/// Sets the slabs for both ends of the direction ranges.
#[inline(always)]
fn set_interval_slabs(slabs: [&mut Slabs; 2], origin: &AxisRanges, unit: &AxisRanges, sum: f32) {
    let (low, high) = (interval_end(origin, 0, 0.0), interval_end(origin, 1, 0.0));
    let ends = [0, 1].map(|which| interval_end(unit, which, 1.0));
    let of = |is_first: bool| -> [f32; 4] {
        std::array::from_fn(|axis| {
            if ends[0][axis].is_sign_positive() == is_first { low[axis] } else { high[axis] }
        })
    };
    let (first, last, slack) = (of(true), of(false), slack(sum));
    slabs.into_iter().zip(&ends).for_each(|(slabs, unit)| slabs.set(&first, &last, unit, slack));
}

/// The lower or upper ends of all axes, and a fourth number. A zero is always the positive zero.
#[inline(always)]
fn interval_end(pairs: &AxisRanges, which: usize, fourth: f32) -> [f32; 4] {
    [pairs[0][which] + 0.0, pairs[1][which] + 0.0, pairs[2][which] + 0.0, fourth]
}

/// Returns true if all numbers in the range are positive, all are negative, or all are 0.
#[inline(always)]
fn has_constant_sign([low, high]: &[f32; 2]) -> bool {
    *low > 0.0 || *high < 0.0 || (*low == 0.0 && *high == 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::BuildOptions;
    use crate::accel::native::NativeAccel;
    use crate::accel::native::kernel::simd::Portable;
    use crate::geometry::{Sphere, SphereRows, SphereSet};
    use crate::math::{DVec3, Hit, NO_SPHERE};
    use std::sync::Arc;

    /// A grid of 16 x 16 x 16 spheres at distance 2.
    fn cube() -> NativeAccel {
        let cell = |i: i32| DVec3::new((i % 16).into(), (i / 16 % 16).into(), (i / 256).into());
        let ball = |i| Sphere { center: 2.0 * cell(i) - 15.0, radius: 0.5 };
        let rows = SphereRows { exact: (0..4096).map(ball).collect(), ..SphereRows::default() };
        let set = Arc::new(SphereSet::new(rows).expect("few spheres"));
        NativeAccel::new(set, &BuildOptions::default()).expect("nobody cancels")
    }

    /// Sixteen rays from one point whose directions differ by up to `spread`.
    fn coherent_rays(spread: f64) -> Vec<Ray> {
        let direction = |i: i32| DVec3::new(0.3, 0.2 + spread * f64::from(i) / 15.0, -1.0);
        let origin = DVec3::new(-9.0, -6.0, 40.0);
        let exclude = [NO_SPHERE; 2];
        (0..16)
            .map(|i| Ray::new(origin, direction(i).normalize(), 0.0, f64::INFINITY, exclude))
            .collect()
    }

    fn is_packet(native: &NativeAccel, rays: &[Ray]) -> bool {
        let outputs = &mut vec![Hit::MISS; rays.len()];
        let batch =
            RayBatch::<ClosestHit> { bvh: &native.bvh, rays, outputs, next: 0, end: rays.len() };
        let mut packet = MaybeUninit::uninit();
        // SAFETY: the tree has a root, and the portable variant needs no special instructions.
        unsafe { RayPacket::load_packet::<Portable>(packet.as_mut_ptr(), &batch, 0) }
    }

    #[test]
    fn rays_go_together_that_are_close_beside_the_leaves() {
        let native = cube();
        for spread in [0.0, 1e-6, 1e-3, 1e-2] {
            assert!(is_packet(&native, &coherent_rays(spread)), "{spread}");
        }
        for spread in [0.5, 2.0] {
            assert!(!is_packet(&native, &coherent_rays(spread)), "{spread}");
        }
        assert!(!is_packet(&native, &coherent_rays(0.0)[1..]));
        let mut rays = coherent_rays(1e-3);
        rays[7].t_min = f32::NAN;
        assert!(!is_packet(&native, &rays));
        rays[7] = Ray { direction: [0.0, 0.0, -2.0], ..rays[0] };
        assert!(!is_packet(&native, &rays));
        rays[7] = Ray { direction: [-1e-4, 0.0, -1.0], ..rays[0] };
        assert!(!is_packet(&native, &rays));
    }
}
