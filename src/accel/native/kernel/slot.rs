//! One ray on its way through the tree, and the two steps that it takes: through a node, and through
//! a leaf.
//!
//! # What the f32 numbers of a leaf may be wrong by
//!
//! All is told in units of length, with `u` the unit direction, `v = c - o`, `b = v.u`, `p = v - b u`
//! (the way from the line to the centre), and `e = 2^-24`. Rounding `o` moves it by `e |o|`, rounding
//! `u` by `e`. So the computed `v` is wrong by at most `e (|v| + |o|)`, `b` by `e (5 |v| + |o|)`, and
//! `p`, whose error by that of `b` runs along the line, by `e (9 |v| + 2 |o|)`; its square adds `e 2
//! |p|`. With `|v| <= |b| + |p|` and `|p| <= R` for a hit, the length of `p` is known to within
//!
//! `E' = e (11 (|b| + R) + 2 |o|)`, which is less than 11/16 of `E = 16 e (|b| + R + |o|)`.
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
//!   that lower bound: of each `E` the error of `b` takes 6/16, and the roundings of the sums and the
//!   root at most 4/16.
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

use crate::accel::native::node::{Child, F64_SLACK, Leaf, Node, TINY, lanes_where};
use crate::accel::native::query::Query;
use crate::accel::native::tree::STACK_SIZE;
use crate::fault::fault;

use super::lanes::Lanes;

/// Leaves with candidates that a slot can hold.
pub(super) const KEPT: usize = 16;
/// `16 e` of the module's head.
const ERROR: f32 = 1.0 / (1u32 << 20) as f32;
/// What a box gives way to a ray from `o`, as a part of `|o|`.
const BOX_SLACK: f32 = 1.0 / (1u32 << 21) as f32;
/// The smallest error that is reckoned with.
const LEAST_ERROR: f32 = f32::from_bits((127 - 60) << 23);
/// The smallest component of a direction that is told from zero, 2^-60.
const SMALLEST: f32 = f32::from_bits((127 - 60) << 23);
/// Relative slack that makes up for a few roundings to f32.
const F32_SLACK: f64 = 1.0 / (1u32 << 22) as f64;
/// A direction whose squared length differs from 1 by less is unit for the bounds above.
const UNIT_WITHIN: f64 = 1.0 / (1u64 << 40) as f64;

/// A ray and its stack. What is read first comes first: two cache lines serve the steps.
#[repr(C, align(64))]
pub(super) struct Slot {
    // For boxes.
    inverse: [f32; 3],
    enter: [f32; 3],
    leave: [f32; 3],
    t_min: f32,
    /// No hit beyond this distance is of interest.
    pub(super) limit: f32,
    /// Entries of the stack.
    top: u32,
    /// Where the planes that the ray meets first are in a node, in numbers.
    near: [u32; 3],
    /// Leaves with candidates so far.
    pub(super) kept: u32,
    // For leaves.
    origin: [f32; 3],
    unit: [f32; 3],
    /// The part of `E` that does not depend on the sphere.
    error: f32,
    t_min_above: f32,
    /// What the ray does next.
    pub(super) next: Child,
    /// Lanes of the leaf kept last that settle the question, as bits.
    pub(super) sure: u32,
    /// Which of the batch's rays this is.
    pub(super) ray: u32,
    /// Length of the ray's own direction.
    pub(super) length: f64,
    pub(super) query: Query,
    kept_leaves: [MaybeUninit<u32>; KEPT],
    kept_from: [MaybeUninit<[f32; 8]>; KEPT],
    keys: [MaybeUninit<u32>; STACK_SIZE],
    children: [MaybeUninit<u32>; STACK_SIZE],
}

/// What a step through a leaf found.
pub(super) struct Found {
    /// Lanes that may be hit, as bits.
    pub(super) candidates: u32,
    /// Those of them that are hit for certain.
    pub(super) sure: u32,
}

impl Slot {
    /// Puts a ray into the slot, at the root of the tree.
    ///
    /// # Safety
    /// `slot` is valid for writing, and afterwards for reading.
    #[inline(always)]
    pub(super) unsafe fn begin(slot: *mut Self, query: Query, ray: u32, root: Child) {
        // SAFETY: all fields that are read before they are written are set here; the arrays at the
        // end need no value.
        let slot = unsafe {
            (&raw mut (*slot).query).write(query);
            &mut *slot
        };
        let squared = query.direction.length_squared();
        let (unit, length) = if (squared - 1.0).abs() < UNIT_WITHIN {
            (query.direction, 1.0)
        } else {
            let length = squared.sqrt();
            (query.direction / length, length)
        };
        slot.length = length;
        let (origin, unit) = (query.origin.as_vec3(), unit.as_vec3());
        let magnitude = origin.abs();
        let everywhere = F64_SLACK as f32 * magnitude.max_element() + TINY as f32;
        let (origin, unit, magnitude) = (origin.to_array(), unit.to_array(), magnitude.to_array());
        for axis in 0..3 {
            let (o, u) = (origin[axis], unit[axis]);
            let slack = (BOX_SLACK * magnitude[axis] + everywhere).copysign(u);
            let inverse = 1.0 / u.abs().max(SMALLEST).copysign(u);
            slot.inverse[axis] = inverse;
            slot.enter[axis] = -inverse * (o + slack);
            slot.leave[axis] = -inverse * (o - slack);
            slot.near[axis] = 8 * axis as u32 + 24 * (u.to_bits() >> 31);
        }
        slot.origin = origin;
        slot.unit = unit;
        slot.error = ERROR * (magnitude[0] + magnitude[1] + magnitude[2]) + LEAST_ERROR;
        let t_min = query.t_min * length;
        slot.t_min = (t_min * (1.0 - F32_SLACK) - TINY).max(0.0) as f32;
        slot.t_min_above = (t_min * (1.0 + F32_SLACK) + TINY) as f32;
        slot.limit = slot.limit_of(query.t);
        slot.kept = 0;
        slot.sure = 0;
        slot.ray = ray;
        slot.next = root;
        slot.keys[0].write(0);
        slot.children[0].write(Child::NONE.0);
        slot.top = 1;
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
            let meet = |axis: usize, add: &[f32; 3], from: usize| {
                let plane = L::load(planes.add(from));
                L::mul_add(plane, L::splat(self.inverse[axis]), L::splat(add[axis]))
            };
            let near = self.near.map(|near| near as usize);
            let enter = |axis| meet(axis, &self.enter, near[axis]);
            let leave = |axis| meet(axis, &self.leave, 16 * axis + 24 - near[axis]);
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
            let u = self.unit.map(|u| L::splat(u));
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

    /// The kept leaf of this number.
    ///
    /// # Safety
    /// `number` is below [`Self::kept`].
    #[inline(always)]
    pub(super) unsafe fn kept_leaf(&self, number: u32) -> u32 {
        // SAFETY: what is below `kept` was written.
        unsafe { self.kept_leaves.get_unchecked(number as usize).assume_init() }
    }

    /// The kept leaf of this number, and its lanes that are not beyond the limit, as bits.
    ///
    /// # Safety
    /// `number` is below [`Self::kept`].
    #[inline(always)]
    pub(super) unsafe fn kept_lanes(&self, number: u32) -> (u32, u32) {
        // SAFETY: what is below `kept` was written.
        unsafe {
            let from = self.kept_from.get_unchecked(number as usize).assume_init();
            (self.kept_leaf(number), lanes_where::<8>(|lane| from[lane] <= self.limit))
        }
    }
}
