//! Ray queries for an intersector, and their hits.
//!
//! A path's own ray is f64 ([`crate::geometry::PathRay`]). A [`Ray`] is derived from it and serves
//! only as a query: which sphere is hit first? It is stored in f32, the precision that backends
//! trace in, and carries the rounding residuals, so that a backend that computes in f64 sees the
//! path's ray to 48 bits.

use crate::fault::fault;

use super::DVec3;

/// The id that means "no sphere".
pub const NO_SPHERE: u32 = u32::MAX;

/// The largest coordinate, radius or distance that a scene may contain, in scene units. Its square
/// stays finite in f32, and Embree (which aborts above 1.8e18) never sees more than four times it:
/// moving the origin may double a coordinate, and a surface lies one radius further out.
pub const MAX_COORDINATE: f64 = 1e15;

/// A ray for a backend: `origin + t * direction`, `t` in `(t_min, t_max)`.
///
/// One cache line, shared with C: `ffi/shim.h` declares the same layout.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Ray {
    /// Origin, rounded to f32.
    pub origin: [f32; 3],
    /// Hits at or before this distance do not count. Never negative.
    pub t_min: f32,
    /// Direction, rounded to f32; unit length within rounding.
    pub direction: [f32; 3],
    /// Hits at or beyond this distance do not count. May be infinite.
    pub t_max: f32,
    /// Ids of spheres that this ray cannot hit; [`NO_SPHERE`] if unused.
    pub exclude: [u32; 2],
    /// Residual of rounding `origin` to f32.
    pub origin_low: [f32; 3],
    /// Residual of rounding `direction` to f32.
    pub direction_low: [f32; 3],
}

/// A backend's hit: the id of the first sphere hit, and the backend's estimate of the distance.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Hit {
    /// The backend's distance along the ray; infinite for a miss.
    pub t: f32,
    /// The sphere, or [`NO_SPHERE`] for a miss.
    pub id: u32,
}

impl Hit {
    /// A miss.
    pub const MISS: Self = Self { t: f32::INFINITY, id: NO_SPHERE };

    /// Returns true for a miss.
    pub fn is_miss(self) -> bool {
        self.id == NO_SPHERE
    }
}

impl Ray {
    /// Creates the query for an f64 ray. The interval is rounded outwards, so that no hit is lost.
    pub fn new(origin: DVec3, direction: DVec3, t_min: f64, t_max: f64, exclude: [u32; 2]) -> Self {
        let (origin, origin_low) = split(origin);
        let (direction, direction_low) = split(direction);
        let [t_min, t_max] = rounded_interval(t_min, t_max);
        Self { origin, t_min, direction, t_max, exclude, origin_low, direction_low }
    }

    /// Returns the origin to 48 bits.
    pub fn origin_f64(&self) -> DVec3 {
        join(self.origin, self.origin_low)
    }

    /// Returns the direction to 48 bits.
    pub fn direction_f64(&self) -> DVec3 {
        join(self.direction, self.direction_low)
    }

    /// Returns true if this ray must ignore the sphere.
    pub fn excludes(&self, id: u32) -> bool {
        self.exclude.contains(&id)
    }

    /// Returns true if a backend may trace this ray: all finite, within range, `0 <= t_min`, and no
    /// NaN.
    ///
    /// Debian's Embree aborts the process on anything else.
    pub fn is_valid(&self) -> bool {
        let limit = 4.0 * MAX_COORDINATE as f32;
        // Branch-free: nearly all rays are valid.
        let bounded =
            |&[x, y, z]: &[f32; 3]| (x.abs() <= limit) & (y.abs() <= limit) & (z.abs() <= limit);
        bounded(&self.origin)
            & bounded(&self.direction)
            & (self.t_min >= 0.0)
            & (self.t_min <= limit)
            & (self.t_max >= 0.0)
    }
}

fn split(v: DVec3) -> ([f32; 3], [f32; 3]) {
    let high = v.as_vec3();
    let low = if fault!(RayRoundedToF32) { DVec3::ZERO } else { v - high.as_dvec3() };
    (high.to_array(), low.as_vec3().to_array())
}

fn join(high: [f32; 3], low: [f32; 3]) -> DVec3 {
    DVec3::from_array(high.map(f64::from)) + DVec3::from_array(low.map(f64::from))
}

/// Rounds the interval in which a ray may hit outwards to f32. All backends use it rounded.
#[inline(always)]
pub fn rounded_interval(t_min: f64, t_max: f64) -> [f32; 2] {
    [round_down(t_min), round_up(t_max)]
}

/// Returns the smallest f32 that is not below a distance `x >= 0`.
#[inline(always)]
fn round_up(x: f64) -> f32 {
    let nearest = x as f32;
    if f64::from(nearest) < x { f32::from_bits(nearest.to_bits() + 1) } else { nearest }
}

/// Returns the largest f32 that is not above a distance `x >= 0`.
#[inline(always)]
fn round_down(x: f64) -> f32 {
    let nearest = x as f32;
    if f64::from(nearest) > x { f32::from_bits(nearest.to_bits() - 1) } else { nearest }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_is_one_cache_line() {
        assert_eq!(size_of::<Ray>(), 64);
        assert_eq!(align_of::<Ray>(), 64);
    }

    #[test]
    fn the_low_parts_restore_48_bits() {
        let origin = DVec3::new(1.0 / 3.0, -1e5 / 7.0, 1e-9 / 3.0);
        let direction = DVec3::new(0.1, 0.7, -0.3).normalize();
        let ray = Ray::new(origin, direction, 0.0, 0.1, [NO_SPHERE; 2]);
        assert!((ray.origin_f64() - origin).abs().max_element() <= 1e5 * 2f64.powi(-48));
        assert!((ray.direction_f64() - direction).abs().max_element() <= 2f64.powi(-48));
        assert!(f64::from(ray.t_max) >= 0.1);
    }

    #[test]
    fn validity_refuses_what_embree_aborts_on() {
        let good = Ray::new(DVec3::ZERO, DVec3::Z, 0.0, f64::INFINITY, [NO_SPHERE; 2]);
        assert!(good.is_valid());
        let far_side = 3.0 * MAX_COORDINATE as f32;
        assert!(Ray { origin: [far_side; 3], ..good }.is_valid(), "the far side of a moved sphere");
        for bad in [f32::NAN, f32::INFINITY, 1e19] {
            assert!(!Ray { origin: [0.0, bad, 0.0], ..good }.is_valid());
            assert!(!Ray { direction: [bad, 0.0, 0.0], ..good }.is_valid());
        }
        assert!(!Ray { t_min: -1.0, ..good }.is_valid());
        assert!(!Ray { t_min: f32::NAN, ..good }.is_valid());
        assert!(!Ray { t_max: f32::NAN, ..good }.is_valid());
    }
}
