//! The interface of all backends.

use crate::geometry::{PathRays, SphereSet};
use crate::math::{Hit, Ray};

/// An intersector over a fixed set of spheres.
///
/// Rays come in batches of any length, including one. Results are in the order of the rays. A ray
/// that is not [valid](Ray::is_valid) hits nothing. All backends skip excluded spheres, report the
/// exit point for a sphere that the ray starts in, and accept hits only in the open interval
/// `(t_min, t_max)`. If two spheres are hit at exactly the same distance, the backends in Rust
/// return the smaller id, regardless of traversal order.
pub trait Accel: Send + Sync {
    /// Finds the closest hit of each ray. The slices have equal lengths.
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]);

    /// Sets each flag to true if the ray is occluded. The slices have equal lengths.
    fn occluded(&self, rays: &[Ray], occluded: &mut [bool]);

    /// [`Self::closest`] for the f64 rays of paths. By default each ray is converted with
    /// [`SphereSet::to_query`], using `queries` as scratch memory; a backend that computes in f64
    /// may use the rays directly.
    fn closest_path_rays(
        &self,
        spheres: &SphereSet,
        rays: &PathRays,
        queries: &mut Vec<Ray>,
        hits: &mut [Hit],
    ) {
        to_queries(spheres, rays, queries);
        self.closest(queries, hits);
    }

    /// [`Self::occluded`] for the f64 rays of paths.
    fn occluded_path_rays(
        &self,
        spheres: &SphereSet,
        rays: &PathRays,
        queries: &mut Vec<Ray>,
        occluded: &mut [bool],
    ) {
        to_queries(spheres, rays, queries);
        self.occluded(queries, occluded);
    }

    /// Bounds how far this backend's arithmetic may move a sphere's surface for a ray.
    fn error_bound(&self) -> ErrorBound;

    /// Bytes held by the acceleration structure, without the spheres themselves.
    fn bytes(&self) -> usize;

    /// A short human-readable description of build and kernel; may be empty.
    fn details(&self) -> String {
        String::new()
    }
}

/// Converts path rays to queries.
pub(super) fn to_queries(spheres: &SphereSet, rays: &PathRays, queries: &mut Vec<Ray>) {
    queries.clear();
    queries.extend(rays.iter().map(|ray| spheres.to_query(&ray)));
}

/// The guaranteed accuracy of a backend, as a backward error: a result is exact for spheres whose
/// radius is changed by at most `k 2^-24 (|o - c| + R)`, plus the distance by which rounding to f32
/// moved the ray's origin.
///
/// `crosscheck` and the differential tests accept an id that differs from the exact one only within
/// this error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorBound {
    /// The factor `k` for spheres stored in f32.
    pub particles: f64,
    /// The factor `k` for giants.
    pub giants: f64,
    /// True if the backend traces from the origin rounded to f32.
    pub rounds_origin: bool,
}
