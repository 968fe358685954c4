//! Ray-sphere tests in f32: where a sphere may be hit, and where it is certainly hit.
//!
//! # Errors of the f32 test
//!
//! `u` is the direction, of unit length within `6.5 e`, where `e = 2^-24`; `v = c - o`, `b = v.u`,
//! and `p = v - b u` is the vector from the line to the centre. Rounding `o` moves it by `e |o|`,
//! rounding `u` by `e`. So the error of the computed `v` is at most `e (|v| + |o|)`, of `b`
//! `e (5 |v| + |o|)`, and of `p` `e (9 |v| + 2 |o|)`, where the error of `b` is left out, because
//! it runs along the line; its square adds `2 e |p|`. As `u` is not exactly unit, `b` and `p` have
//! an additional error of `13 e |b|`. The sphere `(c, R)` of a leaf is a rounded copy of the one
//! that the user wrote, whose surface is at most `e (|c| + R)` away, and `|c| <= |o| + |v|`. With
//! `|v| <= |b| + |p|`, and `|p| <= R` for a hit, the length of `p` is known to within
//!
//! `E' = e (26 (|b| + R) + 3 |o|)`, which is at most 3/4 of `E = 36 e (|b| + R + |o|)`.
//!
//! This holds with fused and with separate roundings. It follows that
//!
//! * a sphere that is hit has `q = p.p <= (R + E)^2` as computed: all others are no candidates;
//! * half the chord is at most `h = sqrt((R + E)^2 - q)`, including roundings, which take at most
//!   `4 e R^2` of the margin `2 R (E - E')`, which is at least `18 e R^2`;
//! * half the chord squared is at least `(R + E)^2 - q - 4 (R + E) E`, because `h^2` minus its true
//!   value is at most `2 R E + E^2 + 2 (R + E) E' + E'^2` and the roundings again. If this is above
//!   0, the sphere is certainly hit;
//! * the roots lie in `b - h - E .. b - h' + E` and `b + h' - E .. b + h + E`, where `h'` is the
//!   root of that lower bound: of each `E` the error of `b` takes 20/36, of which the rounding of
//!   the sphere is 2, the length of `u` in half the chord 7/36, and the roundings of the sums and
//!   the root 4/36.
//!
//! `E` is at least 2^-60, so that underflow is far below the remaining margin.
//!
//! A candidate is *certain* if it is certainly hit, beyond `t_min` and, for occlusion, before
//! `t_max`. The smallest upper bound of a certain hit limits the search. Every candidate whose
//! lower bound is within the limit is kept, and those that remain at the end are tested in f64,
//! with the numbers that the user wrote.

use crate::accel::native::node::SphereLeaf;

use super::simd::Simd8;

/// `36 e` of the module documentation.
pub(super) const ERROR_SCALE: f32 = 36.0 / (1u32 << 24) as f32;
/// The smallest error bound.
pub(super) const MIN_ERROR: f32 = f32::from_bits((127 - 60) << 23);

/// A SIMD sphere test: one ray per lane, or one ray in all lanes.
pub(super) struct SphereTest<L: Simd8> {
    /// From the rays' origins to the spheres' centres.
    pub(super) to_center: [L::F; 3],
    /// Directions of unit length.
    pub(super) unit: [L::F; 3],
    /// The part of `E` that does not depend on the sphere.
    pub(super) error: L::F,
    /// The earliest and the latest start of the rays.
    pub(super) t_min: [L::F; 2],
    /// Hits beyond this distance are irrelevant.
    pub(super) limit: L::F,
}

/// The results of a sphere test, lane by lane.
pub(super) struct SphereHits<L: Simd8> {
    /// True if there may be a hit.
    pub(super) candidate: L::M,
    /// True if there is certainly a hit beyond the start of the ray.
    pub(super) certain: L::M,
    /// Lower bound of the distance.
    pub(super) t_lower: L::F,
    /// Upper bound of the distance of a certain hit.
    pub(super) t_upper: L::F,
}

impl<L: Simd8> SphereTest<L> {
    /// Intersects the rays with spheres of these radii.
    ///
    /// # Safety
    /// The CPU supports `L`.
    #[inline(always)]
    pub(super) unsafe fn intersect(&self, radius: L::F) -> SphereHits<L> {
        // SAFETY: upheld by the caller.
        unsafe {
            let (b, p) = project::<L>(self.to_center, self.unit);
            let q = length_squared::<L>(p);

            let zero = L::splat(0.0);
            let error = L::mul_add(L::add(L::abs(b), radius), L::splat(ERROR_SCALE), self.error);
            let outer_radius = L::add(radius, error);
            let upper = L::mul_sub(outer_radius, outer_radius, q);
            let lower = L::neg_mul_add(L::mul(error, L::splat(4.0)), outer_radius, upper);
            let h_upper = L::sqrt(L::max(upper, zero));
            let h_lower = L::sqrt(L::max(lower, zero));
            let (b_lower, b_upper) = (L::sub(b, error), L::add(b, error));
            let near = (L::sub(b_lower, h_upper), L::sub(b_upper, h_lower));
            let far = (L::add(b_lower, h_lower), L::add(b_upper, h_upper));

            let [t_min, t_min_upper] = self.t_min;
            let starts_inside = L::le(near.1, t_min);
            let t = L::select(starts_inside, far.0, near.0);
            let t_upper = L::select(starts_inside, far.1, near.1);
            let hit = L::and(L::le(zero, upper), L::lt(t_min, far.1));
            let candidate = L::and(hit, L::le(t, self.limit));
            let certain = L::and(L::lt(zero, lower), L::lt(t_min_upper, t));
            SphereHits { candidate, certain: L::and(candidate, certain), t_lower: t, t_upper }
        }
    }
}

/// Vectors from a point, whose fourth number is ignored, to the centres of a leaf's spheres.
///
/// # Safety
/// `leaf` is valid, and the CPU supports `L`.
#[inline(always)]
pub(super) unsafe fn to_centers<L: Simd8>(leaf: *const SphereLeaf, from: &[f32; 4]) -> [L::F; 3] {
    // SAFETY: a leaf is four times eight aligned numbers.
    unsafe {
        let base = leaf.cast::<f32>();
        [
            L::sub(L::load(base), L::splat(from[0])),
            L::sub(L::load(base.add(8)), L::splat(from[1])),
            L::sub(L::load(base.add(16)), L::splat(from[2])),
        ]
    }
}

/// The radii of a leaf's spheres.
///
/// # Safety
/// `leaf` is valid, and the CPU supports `L`.
#[inline(always)]
pub(super) unsafe fn radii<L: Simd8>(leaf: *const SphereLeaf) -> L::F {
    // SAFETY: as above.
    unsafe { L::load(leaf.cast::<f32>().add(24)) }
}

/// Projects points onto lines through the origin: the distance along the line, and the vector from
/// there to the point.
///
/// # Safety
/// The CPU supports `L`.
#[inline(always)]
pub(super) unsafe fn project<L: Simd8>(v: [L::F; 3], u: [L::F; 3]) -> (L::F, [L::F; 3]) {
    // SAFETY: upheld by the caller.
    unsafe {
        let b = L::mul_add(v[0], u[0], L::mul_add(v[1], u[1], L::mul(v[2], u[2])));
        (
            b,
            [
                L::neg_mul_add(b, u[0], v[0]),
                L::neg_mul_add(b, u[1], v[1]),
                L::neg_mul_add(b, u[2], v[2]),
            ],
        )
    }
}

/// The squared length.
///
/// # Safety
/// The CPU supports `L`.
#[inline(always)]
pub(super) unsafe fn length_squared<L: Simd8>([x, y, z]: [L::F; 3]) -> L::F {
    // SAFETY: upheld by the caller.
    unsafe { L::mul_add(x, x, L::mul_add(y, y, L::mul(z, z))) }
}
