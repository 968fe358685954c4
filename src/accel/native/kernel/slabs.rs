//! Rays and boxes in f32.
//!
//! A ray meets a plane at `(p - o) / u`, computed as `p i + a` with `i = 1 / u` and `a = -i (o +-
//! s)`. `i` is wrong by `2 e`, `a` by `3 e |o|` in terms of the place, and the sum rounds once
//! more. With `|p - o| <= |p| + |o|` the place of the plane is wrong by at most `3.1 e |p| + 6.2 e
//! |o|`. The part with `|p|` is in the box ([`BvhNode::set`]), the part with `|o|` is `s`: upwards
//! for entering and downwards for leaving, if `u > 0`. What lies behind the origin may be entered
//! too late, but never after the origin. Components of `u` below 2^-60 are raised to that, which
//! moves a point at distance `t_lower` by `2^-60 t`. There is no division by zero and no NaN: even
//! the infinite planes of unused lanes only give infinities.

use super::simd::Simd8;
use crate::accel::native::build::fast_max;
use crate::accel::native::node::{ABSOLUTE_SLACK, BvhNode, F64_BOX_SLACK};

/// What a box gives way to a ray from `o`, as a part of `|o|`.
const BOX_SLACK: f32 = 1.0 / (1u32 << 21) as f32;
/// The smallest component of a direction that is told from zero, 2^-60.
const MIN_COMPONENT: f32 = f32::from_bits((127 - 60) << 23);

/// What a ray needs to meet planes: of its direction and its origin.
#[derive(Clone, Copy)]
#[repr(C)]
pub(super) struct Slabs {
    inverse: [f32; 4],
    enter: [f32; 4],
    leave: [f32; 4],
}

/// Where the planes that rays of the same octant meet first are in a node, in numbers.
#[derive(Clone, Copy)]
pub(super) struct NearPlanes([u32; 4]);

impl NearPlanes {
    #[inline(always)]
    pub(super) fn from_direction(unit: &[f32; 4]) -> Self {
        Self(std::array::from_fn(|axis| 8 * axis as u32 + 24 * (unit[axis].to_bits() >> 31)))
    }
}

/// What boxes give way to rays from places whose coordinates add up to no more than `sum`, beside
/// what depends on the axis.
#[inline(always)]
pub(super) fn slack(sum: f32) -> f32 {
    F64_BOX_SLACK as f32 * sum + ABSOLUTE_SLACK as f32
}

impl Slabs {
    /// Sets them for rays in this direction from anywhere between two places, of which none is
    /// before the `first` nor behind the `last` along any axis; `slack` is what boxes give way
    /// everywhere.
    #[inline(always)]
    pub(super) fn set(&mut self, first: &[f32; 4], last: &[f32; 4], unit: &[f32; 4], slack: f32) {
        for axis in 0..4 {
            let u = unit[axis];
            let farthest = fast_max(first[axis].abs(), last[axis].abs());
            let slack = (BOX_SLACK * farthest + slack).copysign(u);
            let inverse = 1.0 / fast_max(u.abs(), MIN_COMPONENT).copysign(u);
            self.inverse[axis] = inverse;
            self.enter[axis] = -inverse * (last[axis] + slack);
            self.leave[axis] = -inverse * (first[axis] - slack);
        }
    }

    /// The distances at which the planes of an axis are met: that which is met first of each pair,
    /// and the other.
    ///
    /// # Safety
    /// `node` is valid, the axis is below 3, and the CPU supports `L`.
    #[inline(always)]
    pub(super) unsafe fn intersect<L: Simd8>(
        &self,
        node: *const BvhNode,
        NearPlanes(near): &NearPlanes,
        axis: usize,
    ) -> [L::F; 2] {
        // SAFETY: a node's planes are its first 48 numbers, aligned, of which `near` selects one of
        // each pair.
        unsafe {
            let planes = node.cast::<f32>();
            let near = near[axis] as usize;
            let inverse = L::splat(self.inverse[axis]);
            let (first, second) = (planes.add(near), planes.add(16 * axis + 24 - near));
            let (enter, leave) = (L::splat(self.enter[axis]), L::splat(self.leave[axis]));
            [
                L::mul_add(L::load(first), inverse, enter),
                L::mul_add(L::load(second), inverse, leave),
            ]
        }
    }

    /// The slab test for all rays between these and others of the same octant: where the first of
    /// them may enter and the last may leave.
    ///
    /// # Safety
    /// As for [`Self::intersect`].
    #[inline(always)]
    pub(super) unsafe fn intersect_interval<L: Simd8>(
        &self,
        other: &Self,
        node: *const BvhNode,
        near: &NearPlanes,
        axis: usize,
    ) -> [L::F; 2] {
        // SAFETY: upheld by the caller.
        unsafe {
            let [enter, leave] = self.intersect::<L>(node, near, axis);
            let [other_enter, other_leave] = other.intersect::<L>(node, near, axis);
            [L::min(enter, other_enter), L::max(leave, other_leave)]
        }
    }
}
