//! Ray-box intersection in f32.
//!
//! A ray intersects a plane at `(p - o) / u`, computed as `p i + a` with `i = 1 / u` and
//! `a = -i (o +- s)`. The error of `i` is `2 e`, that of `a` is `3 e |o|` in terms of the position,
//! and the sum rounds once more. With `|p - o| <= |p| + |o|` the error of the plane's position is
//! at most `3.1 e |p| + 6.2 e |o|`. The part with `|p|` is in the box ([`BvhNode::set_child`]), the
//! part with `|o|` is `s`: upwards for the entry and downwards for the exit, if `u > 0`. For planes
//! behind the origin the entry may be too late, but never after the origin. Components of `u` below
//! 2^-60 are raised to that, which moves a point at distance `t` by `2^-60 t`. There is no division
//! by zero and no NaN: even the infinite planes of unused lanes only give infinities.

use super::simd::Simd8;
use crate::accel::native::build::fast_max;
use crate::accel::native::node::{ABSOLUTE_SLACK, BvhNode, F64_BOX_SLACK};

/// Slack of a box for a ray from `o`, relative to `|o|`.
const BOX_SLACK: f32 = 1.0 / (1u32 << 21) as f32;
/// The smallest component of a direction that is distinguished from zero, 2^-60.
const MIN_COMPONENT: f32 = f32::from_bits((127 - 60) << 23);

/// A ray's direction and origin, prepared for the slab test.
#[derive(Clone, Copy)]
#[repr(C)]
pub(super) struct Slabs {
    inverse: [f32; 4],
    entry: [f32; 4],
    exit: [f32; 4],
}

/// Offsets in a node of the planes that rays of an octant intersect first.
#[derive(Clone, Copy)]
pub(super) struct NearPlanes([u32; 4]);

impl NearPlanes {
    #[inline(always)]
    pub(super) fn from_direction(unit: &[f32; 4]) -> Self {
        Self(std::array::from_fn(|axis| 8 * axis as u32 + 24 * (unit[axis].to_bits() >> 31)))
    }
}

/// Absolute slack of boxes for rays from points whose coordinates sum to at most `sum`, in addition
/// to the slack of each axis.
#[inline(always)]
pub(super) fn slack(sum: f32) -> f32 {
    F64_BOX_SLACK as f32 * sum + ABSOLUTE_SLACK as f32
}

impl Slabs {
    /// Sets the slabs for rays in this direction from anywhere between two points: no origin is
    /// before `first` or after `last` along any axis. `slack` is the absolute slack.
    #[inline(always)]
    pub(super) fn set(&mut self, first: &[f32; 4], last: &[f32; 4], unit: &[f32; 4], slack: f32) {
        for axis in 0..4 {
            let u = unit[axis];
            let farthest = fast_max(first[axis].abs(), last[axis].abs());
            let slack = (BOX_SLACK * farthest + slack).copysign(u);
            let inverse = 1.0 / fast_max(u.abs(), MIN_COMPONENT).copysign(u);
            self.inverse[axis] = inverse;
            self.entry[axis] = -inverse * (last[axis] + slack);
            self.exit[axis] = -inverse * (first[axis] - slack);
        }
    }

    /// The distances at which a ray intersects the planes of an axis: the near plane of each
    /// pair, and the far one.
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
        // SAFETY: a node's planes are its first 48 aligned numbers, of which `near` selects one of
        // each pair.
        unsafe {
            let planes = node.cast::<f32>();
            let near = near[axis] as usize;
            let inverse = L::splat(self.inverse[axis]);
            let (first, second) = (planes.add(near), planes.add(16 * axis + 24 - near));
            let (entry, exit) = (L::splat(self.entry[axis]), L::splat(self.exit[axis]));
            [L::mul_add(L::load(first), inverse, entry), L::mul_add(L::load(second), inverse, exit)]
        }
    }

    /// [`Self::intersect`] for all rays between this and another of the same octant: the earliest
    /// entry and the latest exit.
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
            let [entry, exit] = self.intersect::<L>(node, near, axis);
            let [other_entry, other_exit] = other.intersect::<L>(node, near, axis);
            [L::min(entry, other_entry), L::max(exit, other_exit)]
        }
    }
}
