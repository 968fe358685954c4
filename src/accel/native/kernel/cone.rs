//! The bounding cone of a packet's rays, truncated at their origins.
//!
//! With the mean origin `m` and the unit vector `a`, all origins are within `r` of `m`, and all
//! directions within `s < 1/4` of `a`. A ray that hits the sphere `(c, R)` does so at a distance of
//! at most `|v| + R + r`, where `v = c - m`. There it is within `r + s t` of the cone's axis, so
//! the vector `p` from the axis to `c` has `|p| <= R + r + s (|v| + R + r)`. With
//! `|v| <= |b| + |p|`, `b = v.a`, this gives
//!
//! `|p| <= max_offset = ((R + r) (1 + s) + s |b|) / (1 - s)`,
//!
//! and the hit is at a distance between `b - R - r` and `b + max_offset`. The errors of `v`, `b`
//! and `p` in f32 are at most `E = 36 e (|b| + max_offset + |o|)`, as in [`super::spheres`].

use crate::accel::native::build::fast_max;
use crate::accel::native::bvh::Bvh;
use crate::accel::native::node::SphereLeaf;
use crate::fault::fault;

use super::ray_state::F32x8;
use super::simd::Simd8;
use super::spheres::{ERROR_SCALE, MIN_ERROR, length_squared, project, radii, to_centers};

/// Maximum radius of a cone at the distance of the tree's centre, in mean leaf extents. In a gas of
/// spheres, packets are 2.5 times as fast as single rays at 0.15, 1.2 times at 0.6, and slower
/// beyond 1; in denser scenes they pay off up to twice that width.
const MAX_RELATIVE_WIDTH: f32 = 0.7;
/// More than the rounding errors of a length in f32.
const LENGTH_SLACK: f32 = 1.0 + 1.0 / (1u32 << 20) as f32;

/// One number for each of sixteen rays.
pub(super) type PacketFloats = [F32x8; 2];

/// The smallest and the largest number for each axis.
pub(super) type AxisRanges = [[f32; 2]; 3];

/// The bounding cone of a packet.
#[derive(Clone, Copy)]
pub(super) struct PacketCone {
    /// `m` of the module documentation.
    origin: [f32; 4],
    /// `a`.
    axis: [f32; 3],
    /// `r`.
    radius: f32,
    /// `s`.
    spread: f32,
    /// The largest sum of an origin's coordinates.
    pub(super) max_origin_sum: f32,
}

impl PacketCone {
    /// The cone of rays with these origins and directions, and the ranges of both.
    ///
    /// # Safety
    /// The CPU supports `L`.
    #[inline(always)]
    pub(super) unsafe fn from_rays<L: Simd8>(
        (origins, origin): (&[PacketFloats; 3], &AxisRanges),
        (units, unit): (&[PacketFloats; 3], &AxisRanges),
    ) -> Self {
        let [x, y, z] = origin.map(|[low, high]| 0.5 * (low + high));
        let middle = [x, y, z, 0.0];
        let axis = unit.map(|[low, high]| f64::from(low) + f64::from(high));
        let length = (axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]).sqrt();
        let axis = axis.map(|component| (component / length) as f32);
        // SAFETY: upheld by the caller.
        let (radius, spread) =
            unsafe { (max_distance::<L>(origins, [x, y, z]), max_distance::<L>(units, axis)) };
        let largest = |[low, high]: &[f32; 2]| if -low > *high { -low } else { *high };
        Self {
            origin: middle,
            axis,
            radius: radius + MIN_ERROR,
            spread: spread + ERROR_SCALE,
            max_origin_sum: origin.iter().map(largest).sum(),
        }
    }

    /// Returns true if the cone is thin enough, compared to the leaves, that its rays mostly visit
    /// the same nodes.
    #[inline(always)]
    pub(super) fn is_coherent(&self, tree: &Bvh) -> bool {
        let Self { origin: middle, radius, spread, .. } = *self;
        let to_tree: [f32; 3] = std::array::from_fn(|axis| tree.center[axis] - middle[axis]);
        let distance = to_tree.iter().map(|x| x * x).sum::<f32>().sqrt();
        spread < 0.25 && radius + spread * distance < MAX_RELATIVE_WIDTH * tree.mean_leaf_extent
    }

    /// Returns a mask of the leaf's spheres that the cone may overlap before this distance.
    ///
    /// # Safety
    /// `leaf` is valid, and the CPU supports `L`.
    #[inline(always)]
    pub(super) unsafe fn overlapping<L: Simd8>(&self, leaf: *const SphereLeaf, limit: f32) -> u32 {
        // SAFETY: a leaf is four times eight aligned numbers.
        unsafe {
            let u = [L::splat(self.axis[0]), L::splat(self.axis[1]), L::splat(self.axis[2])];
            let (b, p) = project::<L>(to_centers::<L>(leaf, &self.origin), u);
            let q = length_squared::<L>(p);

            let axial_distance = L::abs(b);
            let near = L::add(radii::<L>(leaf), L::splat(self.radius));
            let inv_one_minus_spread = 1.0 / (1.0 - self.spread);
            let max_offset = L::mul(near, L::splat((1.0 + self.spread) * inv_one_minus_spread));
            let max_offset = L::mul_add(
                axial_distance,
                L::splat(self.spread * inv_one_minus_spread),
                max_offset,
            );
            let error = L::splat(ERROR_SCALE * self.max_origin_sum + MIN_ERROR);
            let error =
                L::mul_add(L::add(axial_distance, max_offset), L::splat(ERROR_SCALE), error);
            let max_offset = L::add(max_offset, error);
            let max_offset = if fault!(PacketConeTooNarrow) {
                L::mul(max_offset, L::splat(0.5))
            } else {
                max_offset
            };
            let is_within = L::le(q, L::mul(max_offset, max_offset));
            let is_ahead = L::le(L::splat(0.0), L::add(b, max_offset));
            let is_near = L::le(L::sub(L::sub(b, near), error), L::splat(limit));
            L::mask_bits(L::and(L::and(is_within, is_ahead), is_near))
        }
    }
}

/// # Safety
/// The CPU supports `L`.
#[inline(always)]
pub(super) unsafe fn load_half<L: Simd8>(eight: &F32x8) -> L::F {
    // SAFETY: eight aligned numbers.
    unsafe { L::load(eight.0.as_ptr()) }
}

/// # Safety
/// The CPU supports `L`.
#[inline(always)]
pub(super) unsafe fn load_vec3<L: Simd8>([x, y, z]: &[PacketFloats; 3], half: usize) -> [L::F; 3] {
    // SAFETY: upheld by the caller.
    unsafe { [load_half::<L>(&x[half]), load_half::<L>(&y[half]), load_half::<L>(&z[half])] }
}

/// The smallest and the largest number for each axis; none is NaN.
///
/// # Safety
/// The CPU supports `L`.
#[inline(always)]
pub(super) unsafe fn axis_ranges<L: Simd8>([x, y, z]: &[PacketFloats; 3]) -> AxisRanges {
    // SAFETY: upheld by the caller.
    unsafe { [min_max::<L>(x), min_max::<L>(y), min_max::<L>(z)] }
}

/// The smallest and the largest number; none is NaN.
///
/// # Safety
/// The CPU supports `L`.
#[inline(always)]
pub(super) unsafe fn min_max<L: Simd8>(numbers: &PacketFloats) -> [f32; 2] {
    // SAFETY: upheld by the caller.
    unsafe {
        let (lo, hi) = (load_half::<L>(&numbers[0]), load_half::<L>(&numbers[1]));
        let opposite = L::sub(L::splat(0.0), L::max(lo, hi));
        [L::reduce_min(L::min(lo, hi)), -L::reduce_min(opposite)]
    }
}

/// The largest distance from a point.
///
/// # Safety
/// The CPU supports `L`.
#[inline(always)]
unsafe fn max_distance<L: Simd8>(
    points: &[PacketFloats; 3],
    [from_x, from_y, from_z]: [f32; 3],
) -> f32 {
    let mut max = 0.0;
    for half in 0..2 {
        // SAFETY: upheld by the caller.
        unsafe {
            let [x, y, z] = load_vec3::<L>(points, half);
            let offset = [
                L::sub(x, L::splat(from_x)),
                L::sub(y, L::splat(from_y)),
                L::sub(z, L::splat(from_z)),
            ];
            let squared = length_squared::<L>(offset);
            max = fast_max(max, -L::reduce_min(L::sub(L::splat(0.0), squared)));
        }
    }
    max.sqrt() * LENGTH_SLACK
}
