//! Axis-aligned bounding boxes in f32, as used by the builder.

/// A box. The fourth lane is unused, so that a union takes two vector instructions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::accel::native) struct Aabb {
    pub(in crate::accel::native) low: [f32; 4],
    pub(in crate::accel::native) high: [f32; 4],
}

impl Aabb {
    /// The empty box; its union with any box is that box.
    pub(in crate::accel::native) const EMPTY: Self =
        Self { low: [f32::INFINITY; 4], high: [f32::NEG_INFINITY; 4] };

    /// The box of `[x, y, z, radius]` and of all spheres that round to it, whose surfaces are at
    /// most `2^-24 (|x| + r)` away along an axis. Half of what is added here covers that, the other
    /// half the rounding of the sum to `reach`; [`crate::accel::native::node::BvhNode::set_child`]
    /// compensates for the rounding of `x - reach`.
    pub(in crate::accel::native) fn from_sphere(sphere: &[f32; 4]) -> Self {
        const ROUNDING: f32 = 1.0 / (1u32 << 23) as f32;
        let radius = sphere[3];
        let reach = sphere.map(|x| radius + ROUNDING * (x.abs() + radius));
        let [mut low, mut high] = [*sphere; 2];
        for axis in 0..4 {
            low[axis] -= reach[axis];
            high[axis] += reach[axis];
        }
        Self { low, high }
    }

    /// The box of one point; the fourth coordinate is ignored.
    pub(in crate::accel::native) fn from_point(point: &[f32; 4]) -> Self {
        Self { low: *point, high: *point }
    }

    /// The smallest box around both boxes.
    #[must_use]
    pub(in crate::accel::native) fn union(&self, other: &Self) -> Self {
        let mut joined = *self;
        for lane in 0..4 {
            joined.low[lane] = fast_min(self.low[lane], other.low[lane]);
            joined.high[lane] = fast_max(self.high[lane], other.high[lane]);
        }
        joined
    }

    /// Half the surface area; 0 for the empty box. Does not overflow for coordinates within
    /// [`crate::math::MAX_COORDINATE`].
    #[inline(always)]
    pub(in crate::accel::native) fn half_area(&self) -> f32 {
        let extent = |axis: usize| fast_max(self.high[axis] - self.low[axis], 0.0);
        let (x, y, z) = (extent(0), extent(1), extent(2));
        x * y + y * z + z * x
    }

    /// The largest absolute value of any coordinate.
    pub(in crate::accel::native) fn max_abs(&self) -> f32 {
        (0..3).map(|i| self.low[i].abs().max(self.high[i].abs())).fold(0.0, f32::max)
    }
}

/// Returns the smaller number, in one machine instruction; `b` if either is NaN.
#[inline(always)]
pub(in crate::accel::native) fn fast_min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Returns the larger number, in one machine instruction; `b` if either is NaN.
#[inline(always)]
pub(in crate::accel::native) fn fast_max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
