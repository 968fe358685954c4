//! The traversal state of one ray, and its two kinds of steps: through a node and through a leaf.

use std::mem::MaybeUninit;

use crate::accel::native::build::fast_max;
use crate::accel::native::limits::{MAX_CANDIDATE_LEAVES, STACK_SIZE};
use crate::accel::native::node::{ABSOLUTE_SLACK, BvhNode, NodeRef, SphereLeaf};
use crate::accel::native::query::BestHit;
use crate::fault::fault;
use crate::math::Ray;

use super::simd::Simd8;
use super::slabs::{NearPlanes, Slabs, slack};
use super::spheres::{ERROR_SCALE, MIN_ERROR, SphereHits, SphereTest, radii, to_centers};

/// Relative slack for a few roundings to f32.
const RAY_SLACK: f64 = 1.0 / (1u32 << 22) as f64;
/// Directions whose squared length in f32 is closer to 1 than this count as unit for the bounds
/// above.
const UNIT_TOLERANCE: f32 = 1.0 / (1u32 << 21) as f32;

/// A ray and its stack. Fields are in the order of use: two cache lines serve the steps.
#[repr(C, align(64))]
pub(super) struct RayState {
    // For boxes.
    slabs: Slabs,
    near_planes: NearPlanes,
    t_min: f32,
    /// Hits beyond this distance are irrelevant.
    pub(super) limit: f32,
    /// Number of stack entries.
    top: u32,
    /// Number of leaves with candidates so far.
    pub(super) candidate_count: u32,
    /// The node or leaf to visit next.
    pub(super) next: NodeRef,
    /// The index of the ray in the batch.
    pub(super) ray: u32,
    // For leaves.
    t_min_upper: f32,
    /// The part of `E` that does not depend on the sphere.
    error: f32,
    origin: [f32; 4],
    unit: [f32; 4],
    /// Mask of the lanes of the last candidate leaf that decide the query.
    pub(super) certain: u32,
    /// The best hit that does not come from the candidate leaves.
    pub(super) best: BestHit,
    /// Length of the ray's original direction; 1 if that is unit.
    pub(super) length: f64,
    candidate_leaves: [MaybeUninit<u32>; MAX_CANDIDATE_LEAVES],
    candidate_t: [MaybeUninit<F32x8>; MAX_CANDIDATE_LEAVES],
    keys: [MaybeUninit<u32>; STACK_SIZE],
    children: [MaybeUninit<u32>; STACK_SIZE],
}

/// Eight numbers, aligned for [`Simd8::load`].
#[derive(Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct F32x8(pub(super) [f32; 8]);

/// The result of a step through a leaf.
pub(super) struct LeafHits {
    /// Mask of the lanes that may be hit.
    pub(super) candidates: u32,
    /// Mask of the candidates that are certainly hit.
    pub(super) certain: u32,
}

impl RayState {
    /// Initialises the slot with a ray at the root of the tree, or without any box if `root` is
    /// `None`. Returns false if the ray has no direction.
    ///
    /// # Safety
    /// `slot` is valid for writing, and after `true` for reading.
    #[inline(always)]
    pub(super) unsafe fn init(
        slot: *mut Self,
        ray: &Ray,
        best: BestHit,
        number: u32,
        root: Option<NodeRef>,
    ) -> bool {
        // SAFETY: all fields that are read before they are written are set here; the arrays at the
        // end need no value. All of them are plain numbers.
        let slot = unsafe { &mut *slot };
        let (unit, length) = if is_unit(ray) {
            (ray.direction, 1.0)
        } else {
            let direction = ray.direction_f64();
            let length = direction.length();
            ((direction / length).as_vec3().to_array(), length)
        };
        let [x, y, z] = unit;
        slot.unit = [x, y, z, 1.0];
        let [x, y, z] = ray.origin;
        slot.origin = [x, y, z, 0.0];
        let sum = x.abs() + y.abs() + z.abs();
        slot.error = ERROR_SCALE * sum + MIN_ERROR;
        if let Some(root) = root {
            slot.slabs.set(&slot.origin, &slot.origin, &slot.unit, slack(sum));
            slot.near_planes = NearPlanes::from_direction(&slot.unit);
            slot.push_root(root);
        }
        slot.length = length;
        [slot.t_min, slot.t_min_upper] = t_min_bounds(ray, length);
        slot.best = best;
        slot.limit = slot.limit_for(best.t);
        slot.candidate_count = 0;
        slot.certain = 0;
        slot.ray = number;
        length > 0.0
    }

    /// Makes this the interval ray of a packet, at the root of the tree, between these distances.
    /// The slabs remain to be set.
    #[inline(always)]
    pub(super) fn init_interval(
        &mut self,
        root: NodeRef,
        near: NearPlanes,
        [t_min, limit]: [f32; 2],
    ) -> &mut Slabs {
        (self.near_planes, self.t_min, self.limit) = (near, t_min, limit);
        self.push_root(root);
        &mut self.slabs
    }

    /// Starts at the root of a tree.
    #[inline(always)]
    fn push_root(&mut self, root: NodeRef) {
        self.next = root;
        self.keys[0].write(0);
        self.children[0].write(NodeRef::NONE.0);
        self.top = 1;
    }

    /// The limit for boxes and spheres if hits matter up to `t`.
    #[inline(always)]
    pub(super) fn limit_for(&self, t: f64) -> f32 {
        limit_for(t * self.length)
    }

    /// Pushes the children of a node that are hit onto the stack: in any order for `ANY_HIT`,
    /// otherwise with the nearest on top.
    ///
    /// # Safety
    /// [`Self::init`] was called, `node` is valid, and the stack holds less than a tree of the
    /// builder's maximum depth can leave there ([`STACK_SIZE`]).
    #[inline(always)]
    pub(super) unsafe fn intersect_node<L: Simd8, const ANY_HIT: bool>(
        &mut self,
        node: *const BvhNode,
    ) {
        // SAFETY: upheld by the caller.
        unsafe {
            let x = self.slabs.intersect::<L>(node, &self.near_planes, 0);
            let y = self.slabs.intersect::<L>(node, &self.near_planes, 1);
            let z = self.slabs.intersect::<L>(node, &self.near_planes, 2);
            self.push_children::<L, ANY_HIT>([x, y, z], node);
        }
    }

    /// [`Self::intersect_node`] for all rays between this one and another with the slabs `other`.
    ///
    /// # Safety
    /// As for [`Self::intersect_node`], after [`Self::init_interval`].
    #[inline(always)]
    pub(super) unsafe fn intersect_node_interval<L: Simd8>(
        &mut self,
        other: &Slabs,
        node: *const BvhNode,
    ) {
        // SAFETY: upheld by the caller.
        unsafe {
            let x = self.slabs.intersect_interval::<L>(other, node, &self.near_planes, 0);
            let y = self.slabs.intersect_interval::<L>(other, node, &self.near_planes, 1);
            let z = self.slabs.intersect_interval::<L>(other, node, &self.near_planes, 2);
            self.push_children::<L, false>([x, y, z], node);
        }
    }

    /// Pushes the children of a node that are hit, given the entry and exit distances of each axis.
    ///
    /// # Safety
    /// As for [`Self::intersect_node`].
    #[inline(always)]
    unsafe fn push_children<L: Simd8, const ANY_HIT: bool>(
        &mut self,
        [x, y, z]: [[L::F; 2]; 3],
        node: *const BvhNode,
    ) {
        // SAFETY: a node's children follow its 48 planes. Eight entries fit above `top` by the
        // caller's contract.
        unsafe {
            let entry = L::max(L::max(x[0], y[0]), L::max(z[0], L::splat(self.t_min)));
            let exit = L::min(L::min(x[1], y[1]), L::min(z[1], L::splat(self.limit)));
            let is_hit = L::le(entry, exit);
            let from = node.cast::<u32>().add(48);
            let top = self.top as usize;
            let children = self.children.as_mut_ptr().add(top).cast::<u32>();
            if ANY_HIT {
                L::compress(children, is_hit, from);
            } else {
                let keys = self.keys.as_mut_ptr().add(top).cast::<u32>();
                L::compress_sorted(keys, children, entry, is_hit, from);
            }
            self.top += L::mask_bits(is_hit).count_ones();
        }
    }

    /// Tests the spheres of a leaf. If there are candidates, the leaf is kept and the limit is
    /// reduced to the nearest certain hit; for `ANY_HIT`, the limit stays.
    ///
    /// # Safety
    /// [`Self::init`] was called, `leaf` is valid, and `candidate_count` is below
    /// [`MAX_CANDIDATE_LEAVES`].
    #[inline(always)]
    pub(super) unsafe fn intersect_leaf<L: Simd8, const ANY_HIT: bool>(
        &mut self,
        leaf: *const SphereLeaf,
        index: u32,
    ) -> LeafHits {
        // SAFETY: a leaf is four times eight aligned numbers; `candidate_count` is an index into
        // the arrays.
        unsafe {
            let rays = SphereTest::<L> {
                to_center: to_centers::<L>(leaf, &self.origin),
                unit: [L::splat(self.unit[0]), L::splat(self.unit[1]), L::splat(self.unit[2])],
                error: L::splat(self.error),
                t_min: [L::splat(self.t_min), L::splat(self.t_min_upper)],
                limit: L::splat(self.limit),
            };
            let SphereHits { candidate, certain, t_lower: t, t_upper } =
                rays.intersect(radii::<L>(leaf));
            let (candidates, certain) = if ANY_HIT {
                let t_max = L::splat(self.limit * (1.0 - 4.0 * RAY_SLACK as f32));
                let certain = L::and(certain, L::lt(t_upper, t_max));
                (L::mask_bits(candidate), L::mask_bits(certain))
            } else {
                let nearest = L::reduce_min(L::select(certain, t_upper, L::splat(f32::INFINITY)));
                let is_nearer = nearest < self.limit && !fault!(NotClosestHit);
                self.limit = if is_nearer { nearest } else { self.limit };
                (
                    L::mask_bits(L::and(candidate, L::le(t, L::splat(self.limit)))),
                    L::mask_bits(certain),
                )
            };
            let slot = self.candidate_count as usize;
            let from = L::select(candidate, t, L::splat(f32::NAN));
            L::store(self.candidate_t.as_mut_ptr().add(slot).cast(), from);
            self.candidate_leaves.as_mut_ptr().add(slot).cast::<u32>().write(index);
            self.candidate_count += u32::from(candidates != 0);
            LeafHits { candidates, certain }
        }
    }

    /// Pops the next stack entry within the limit, or [`NodeRef::NONE`] at the end.
    ///
    /// # Safety
    /// [`Self::init`] was called, and the end of the stack was not popped yet.
    #[inline(always)]
    pub(super) unsafe fn pop<const ANY_HIT: bool>(&mut self) {
        // The lowest three bits of a key are the lane.
        let limit = if fault!(PrunedTooEarly) { 0.9 * self.limit } else { self.limit };
        let limit = limit.to_bits() | 7;
        loop {
            self.top -= 1;
            // SAFETY: entries below the top were written; the lowest has the key 0, which is below
            // every limit.
            unsafe {
                let top = self.top as usize;
                if ANY_HIT || self.keys.get_unchecked(top).assume_init() <= limit {
                    self.next = NodeRef(self.children.get_unchecked(top).assume_init());
                    return;
                }
            }
        }
    }

    /// The candidate leaf with this number, and a mask of its lanes within the limit.
    ///
    /// # Safety
    /// `number` is below `candidate_count`.
    #[inline(always)]
    pub(super) unsafe fn candidate_leaf<L: Simd8>(&self, number: u32) -> (u32, u32) {
        // SAFETY: entries below `candidate_count` were written.
        unsafe {
            let number = number as usize;
            let leaf = self.candidate_leaves.get_unchecked(number).assume_init();
            let from = L::load(self.candidate_t.as_ptr().add(number).cast());
            (leaf, L::mask_bits(L::le(from, L::splat(self.limit))))
        }
    }
}

/// Returns true if a ray's direction counts as unit for the bounds of [`super::spheres`].
#[inline(always)]
pub(super) fn is_unit(ray: &Ray) -> bool {
    let [x, y, z] = ray.direction;
    (x * x + y * y + z * z - 1.0).abs() < UNIT_TOLERANCE
}

/// The earliest and latest start of a ray whose direction has this length, in units of space.
#[inline(always)]
pub(super) fn t_min_bounds(ray: &Ray, length: f64) -> [f32; 2] {
    let t_min = f64::from(ray.t_min) * length;
    let earliest = (t_min * (1.0 - RAY_SLACK) - ABSOLUTE_SLACK) as f32;
    [fast_max(earliest, 0.0), (t_min * (1.0 + RAY_SLACK) + ABSOLUTE_SLACK) as f32]
}

/// The limit for boxes and spheres if hits matter up to `distance`.
#[inline(always)]
pub(super) fn limit_for(distance: f64) -> f32 {
    (distance * (1.0 + RAY_SLACK) + ABSOLUTE_SLACK) as f32
}
