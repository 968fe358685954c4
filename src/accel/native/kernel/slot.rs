//! One ray on its way through the tree, and the two steps that it takes: through a node, and through
//! a leaf.
//!
//! # What the f32 numbers of a leaf may be wrong by
//!
//! `u` is the direction, of unit length within `6.5 e`, where `e = 2^-24`; `v = c - o`, `b = v.u`,
//! and `p = v - b u` is the way from the line to the centre. Rounding `o` moves it by `e |o|`, rounding
//! `u` by `e`. So the computed `v` is wrong by at most `e (|v| + |o|)`, `b` by `e (5 |v| + |o|)`, and
//! `p` by `e (9 |v| + 2 |o|)`, where the error of `b` is left out, which runs along the line; its square
//! adds `2 e |p|`. That `u` is not quite unit makes `b` and `p` wrong by `13 e |b|` more. With `|v| <=
//! |b| + |p|`, and `|p| <= R` for a hit, the length of `p` is known to within
//!
//! `E' = e (24 (|b| + R) + 2 |o|)`, which is at most 3/4 of `E = 32 e (|b| + R + |o|)`.
//!
//! This holds with fused and with separate roundings. It follows that
//!
//! * a sphere that is hit has `q = p.p <= (R + E)^2` as computed: the others are no candidates;
//! * half the chord is at most `h = sqrt((R + E)^2 - q)`, roundings included, which take at most `4 e
//!   R^2` of the `2 R (E - E')` that there is room for;
//! * half the chord squared is at least `(R + E)^2 - q - 4 (R + E) E`, because `h^2` less its true
//!   value is at most `2 R E + E^2 + 2 (R + E) E' + E'^2` and the roundings again. Where this is above
//!   0, the sphere is certainly hit;
//! * the roots lie in `b - h - E .. b - h' + E` and `b + h' - E .. b + h + E`, `h'` being the root of
//!   that lower bound: of each `E` the error of `b` takes 18/32, the length of `u` in half the chord
//!   7/32, and the roundings of the sums and the root 4/32.
//!
//! `E` is at least 2^-60, so that what underflows is far below the room that is left.
//!
//! A candidate is *sure* if it is hit for certain, beyond `t_min` and, for occlusion, before `t_max`.
//! The smallest upper bound of a sure hit limits the search; every candidate whose lower bound is not
//! beyond that is kept, and those that remain at the end are judged in f64.
//!
//! # Boxes
//!
//! A ray meets a plane at `(p - o) / u`, computed as `p i + a` with `i = 1 / u` and `a = -i (o +- s)`.
//! `i` is wrong by `2 e`, `a` by `3 e |o|` in terms of the place, and the sum rounds once more. With
//! `|p - o| <= |p| + |o|` the place of the plane is wrong by at most `3.1 e |p| + 6.2 e |o|`. The part
//! with `|p|` is in the box ([`Node::set`]), the part with `|o|` is `s`: upwards for entering and
//! downwards for leaving, if `u > 0`. What lies behind the origin may be entered too late, but never
//! after the origin. Components of `u` below 2^-60 are raised to that, which moves a point at distance
//! `t` by `2^-60 t`. There is no division by zero and no NaN: even the infinite planes of unused lanes
//! only give infinities.

use std::mem::MaybeUninit;

use crate::accel::native::build::larger;
use crate::accel::native::node::{Child, F64_SLACK, Leaf, Node, TINY};
use crate::accel::native::query::Best;
use crate::accel::native::tree::STACK_SIZE;
use crate::fault::fault;
use crate::math::Ray;

use super::lanes::Lanes;

/// Leaves with candidates that a slot can hold.
pub(in crate::accel::native) const KEPT: usize = 16;
/// `32 e` of the module's head.
const ERROR: f32 = 1.0 / (1u32 << 19) as f32;
/// What a box gives way to a ray from `o`, as a part of `|o|`.
const BOX_SLACK: f32 = 1.0 / (1u32 << 21) as f32;
/// The smallest error that is reckoned with.
const LEAST_ERROR: f32 = f32::from_bits((127 - 60) << 23);
/// The smallest component of a direction that is told from zero, 2^-60.
const SMALLEST: f32 = f32::from_bits((127 - 60) << 23);
/// Relative slack that makes up for a few roundings to f32.
const F32_SLACK: f64 = 1.0 / (1u32 << 22) as f64;
/// A direction whose squared length in f32 differs from 1 by less is unit for the bounds above.
const UNIT_WITHIN: f32 = 1.0 / (1u32 << 21) as f32;

/// A ray and its stack. What is read first comes first: two cache lines serve the steps.
#[repr(C, align(64))]
pub(super) struct Slot {
    // For boxes.
    inverse: [f32; 4],
    enter: [f32; 4],
    leave: [f32; 4],
    /// Where the planes that the ray meets first are in a node, in numbers.
    near: [u32; 4],
    t_min: f32,
    /// No hit beyond this distance is of interest.
    pub(super) limit: f32,
    /// Entries of the stack.
    top: u32,
    /// Leaves with candidates so far.
    pub(super) kept: u32,
    /// What the ray does next.
    pub(super) next: Child,
    /// Which of the batch's rays this is.
    pub(super) ray: u32,
    // For leaves.
    t_min_above: f32,
    /// The part of `E` that does not depend on the sphere.
    error: f32,
    origin: [f32; 4],
    unit: [f32; 4],
    /// Lanes of the leaf kept last that settle the question, as bits.
    pub(super) sure: u32,
    /// The best hit that does not come from the leaves kept.
    pub(super) best: Best,
    /// Length of the ray's own direction; 1 where that is unit.
    pub(super) length: f64,
    kept_leaves: [MaybeUninit<u32>; KEPT],
    kept_from: [MaybeUninit<Eight>; KEPT],
    keys: [MaybeUninit<u32>; STACK_SIZE],
    children: [MaybeUninit<u32>; STACK_SIZE],
}

/// Eight numbers as [`Lanes::load`] wants them.
#[derive(Clone, Copy)]
#[repr(C, align(32))]
struct Eight([f32; 8]);

/// What a step through a leaf found.
pub(super) struct Found {
    /// Lanes that may be hit, as bits.
    pub(super) candidates: u32,
    /// Those of them that are hit for certain.
    pub(super) sure: u32,
}

impl Slot {
    /// Puts a ray into the slot, at the root of the tree, or with no boxes to meet where there is
    /// none; `false` if it has no direction.
    ///
    /// # Safety
    /// `slot` is valid for writing, and after `true` for reading.
    #[inline(always)]
    pub(super) unsafe fn begin(
        slot: *mut Self,
        ray: &Ray,
        best: Best,
        number: u32,
        root: Option<Child>,
    ) -> bool {
        // SAFETY: all fields that are read before they are written are set here; the arrays at the
        // end need no value. All of them are plain numbers.
        let slot = unsafe { &mut *slot };
        let [x, y, z] = ray.direction;
        let off_unit = x * x + y * y + z * z - 1.0;
        let (unit, length) = if off_unit.abs() < UNIT_WITHIN {
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
        slot.error = ERROR * sum + LEAST_ERROR;
        if let Some(root) = root {
            slot.begin_at(root, F64_SLACK as f32 * sum + TINY as f32);
        }
        slot.length = length;
        let t_min = f64::from(ray.t_min) * length;
        slot.t_min = larger((t_min * (1.0 - F32_SLACK) - TINY) as f32, 0.0);
        slot.t_min_above = (t_min * (1.0 + F32_SLACK) + TINY) as f32;
        slot.best = best;
        slot.limit = slot.limit_of(best.t);
        slot.kept = 0;
        slot.sure = 0;
        slot.ray = number;
        length > 0.0
    }

    /// What boxes need, and the stack with the root; `slack` is what boxes give way everywhere.
    #[inline(always)]
    fn begin_at(&mut self, root: Child, slack: f32) {
        for axis in 0..4 {
            let (o, u) = (self.origin[axis], self.unit[axis]);
            let slack = (BOX_SLACK * o.abs() + slack).copysign(u);
            let inverse = 1.0 / larger(u.abs(), SMALLEST).copysign(u);
            self.inverse[axis] = inverse;
            self.enter[axis] = -inverse * (o + slack);
            self.leave[axis] = -inverse * (o - slack);
            self.near[axis] = 8 * axis as u32 + 24 * (u.to_bits() >> 31);
        }
        self.next = root;
        self.keys[0].write(0);
        self.children[0].write(Child::NONE.0);
        self.top = 1;
    }

    /// The distance up to which boxes and spheres matter when hits matter up to `t`.
    #[inline(always)]
    pub(super) fn limit_of(&self, t: f64) -> f32 {
        (t * self.length * (1.0 + F32_SLACK) + TINY) as f32
    }

    /// Puts the children of a node that are met onto the stack: for `ANY` in any order, else the
    /// nearest on top.
    ///
    /// # Safety
    /// [`Self::begin`] was called, `node` is valid, and the stack holds less than a tree of the
    /// builder's depth can leave there ([`STACK_SIZE`]).
    #[inline(always)]
    pub(super) unsafe fn through_node<L: Lanes, const ANY: bool>(&mut self, node: *const Node) {
        // SAFETY: a node's planes are its first 48 numbers, aligned, of which `near` selects one of
        // each pair; its children follow. Eight entries fit behind `top` by the caller's promise.
        unsafe {
            let planes = node.cast::<f32>();
            let meet = |axis: usize, add: &[f32; 4], from: usize| {
                let plane = L::load(planes.add(from));
                L::mul_add(plane, L::splat(self.inverse[axis]), L::splat(add[axis]))
            };
            let near = |axis: usize| self.near[axis] as usize;
            let enter = |axis| meet(axis, &self.enter, near(axis));
            let leave = |axis| meet(axis, &self.leave, 16 * axis + 24 - near(axis));
            let entered =
                L::max(L::max(enter(0), enter(1)), L::max(enter(2), L::splat(self.t_min)));
            let left = L::min(L::min(leave(0), leave(1)), L::min(leave(2), L::splat(self.limit)));
            let met = L::le(entered, left);
            let from = planes.add(48).cast::<u32>();
            let top = self.top as usize;
            let children = self.children.as_mut_ptr().add(top).cast::<u32>();
            if ANY {
                L::put_any(children, met, from);
            } else {
                let keys = self.keys.as_mut_ptr().add(top).cast::<u32>();
                L::put_sorted(keys, children, entered, met, from);
            }
            self.top += L::bits(met).count_ones();
        }
    }

    /// Tests the spheres of a leaf. Where there are candidates, the leaf is kept and the limit
    /// follows the nearest sure hit; for `ANY`, the limit stays.
    ///
    /// # Safety
    /// [`Self::begin`] was called, `leaf` is valid, and [`Self::kept`] is below [`KEPT`].
    #[inline(always)]
    pub(super) unsafe fn through_leaf<L: Lanes, const ANY: bool>(
        &mut self,
        leaf: *const Leaf,
        index: u32,
    ) -> Found {
        // SAFETY: a leaf is four times eight numbers, aligned; `kept` is a place of the arrays.
        unsafe {
            let place = leaf.cast::<f32>();
            let from_origin =
                |axis: usize| L::sub(L::load(place.add(8 * axis)), L::splat(self.origin[axis]));
            let v = [from_origin(0), from_origin(1), from_origin(2)];
            let radius = L::load(place.add(24));
            let u = [L::splat(self.unit[0]), L::splat(self.unit[1]), L::splat(self.unit[2])];
            let b = L::mul_add(v[0], u[0], L::mul_add(v[1], u[1], L::mul(v[2], u[2])));
            let p =
                [L::sub_mul(b, u[0], v[0]), L::sub_mul(b, u[1], v[1]), L::sub_mul(b, u[2], v[2])];
            let q = L::mul_add(p[0], p[0], L::mul_add(p[1], p[1], L::mul(p[2], p[2])));

            let zero = L::splat(0.0);
            let error =
                L::mul_add(L::add(L::abs(b), radius), L::splat(ERROR), L::splat(self.error));
            let reach = L::add(radius, error);
            let above = L::mul_sub(reach, reach, q);
            let below = L::sub_mul(L::mul(error, L::splat(4.0)), reach, above);
            let longest = L::sqrt(L::max(above, zero));
            let shortest = L::sqrt(L::max(below, zero));
            let (b_below, b_above) = (L::sub(b, error), L::add(b, error));
            let near = (L::sub(b_below, longest), L::sub(b_above, shortest));
            let far = (L::add(b_below, shortest), L::add(b_above, longest));

            let (t_min, limit) = (L::splat(self.t_min), L::splat(self.limit));
            let starts_inside = L::le(near.1, t_min);
            let t = L::select(starts_inside, far.0, near.0);
            let t_above = L::select(starts_inside, far.1, near.1);
            let hit = L::and(L::le(zero, above), L::lt(t_min, far.1));
            let candidate = L::and(hit, L::le(t, limit));
            let sure = L::and(L::lt(zero, below), L::lt(L::splat(self.t_min_above), t));
            let sure = L::and(candidate, sure);
            let (candidates, sure) = if ANY {
                let t_max = L::splat(self.limit * (1.0 - 4.0 * F32_SLACK as f32));
                let sure = L::and(sure, L::lt(t_above, t_max));
                (L::bits(candidate), L::bits(sure))
            } else {
                let nearest = L::smallest(L::select(sure, t_above, L::splat(f32::INFINITY)));
                let is_nearer = nearest < self.limit && !fault!(NotTheNearest);
                self.limit = if is_nearer { nearest } else { self.limit };
                (L::bits(L::and(candidate, L::le(t, L::splat(self.limit)))), L::bits(sure))
            };
            let kept = self.kept as usize;
            let from = L::select(candidate, t, L::splat(f32::NAN));
            L::store(self.kept_from.as_mut_ptr().add(kept).cast(), from);
            self.kept_leaves.as_mut_ptr().add(kept).cast::<u32>().write(index);
            self.kept += u32::from(candidates != 0);
            Found { candidates, sure }
        }
    }

    /// Takes what is on top of the stack and not beyond the limit, [`Child::NONE`] at its end.
    ///
    /// # Safety
    /// [`Self::begin`] was called, and the end of the stack was not taken yet.
    #[inline(always)]
    pub(super) unsafe fn pop<const ANY: bool>(&mut self) {
        // Three bits of a key are the number of a lane.
        let limit = if fault!(PrunedTooEarly) { 0.9 * self.limit } else { self.limit };
        let limit = limit.to_bits() | 7;
        loop {
            self.top -= 1;
            // SAFETY: entries below the top were written; the lowest has the key 0, which is below
            // every limit.
            unsafe {
                let top = self.top as usize;
                if ANY || self.keys.get_unchecked(top).assume_init() <= limit {
                    self.next = Child(self.children.get_unchecked(top).assume_init());
                    return;
                }
            }
        }
    }

    /// The kept leaf of this number, and its lanes that are not beyond the limit, as bits.
    ///
    /// # Safety
    /// `number` is below [`Self::kept`].
    #[inline(always)]
    pub(super) unsafe fn kept<L: Lanes>(&self, number: u32) -> (u32, u32) {
        // SAFETY: what is below `kept` was written.
        unsafe {
            let number = number as usize;
            let leaf = self.kept_leaves.get_unchecked(number).assume_init();
            let from = L::load(self.kept_from.as_ptr().add(number).cast());
            (leaf, L::bits(L::le(from, L::splat(self.limit))))
        }
    }
}
