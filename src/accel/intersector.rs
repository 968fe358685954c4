//! What every backend can do.

use crate::geometry::{PathRays, SphereSet};
use crate::math::{Hit, Ray};

/// An intersector over a fixed set of spheres.
///
/// Rays come in batches of any length; a batch of one is a single ray. Answers are in the order of
/// the rays. A ray that is not [valid](Ray::is_valid) hits nothing. All backends overlook excluded
/// spheres, report the far wall of a sphere that the ray starts in, and take hits in the open
/// interval `(t_min, t_max)` only. Where two spheres are hit at exactly the same distance, the
/// backends in Rust answer the smaller id, whatever order they met them in.
pub trait Accel: Send + Sync {
    /// The first sphere that each ray hits. The slices have equal lengths.
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]);

    /// Whether each ray hits anything. The slices have equal lengths.
    fn occluded(&self, rays: &[Ray], blocked: &mut [bool]);

    /// [`Self::closest`] for the f64 rays of paths. Most backends are asked with [`SphereSet::to_query`] of
    /// each, for which `queries` is room; one that computes in f64 may take them as they are.
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
        blocked: &mut [bool],
    ) {
        to_queries(spheres, rays, queries);
        self.occluded(queries, blocked);
    }

    /// How far this backend's arithmetic may move a sphere's surface for a ray.
    fn error_bound(&self) -> ErrorBound;

    /// Bytes held by the structure, without the spheres themselves.
    fn bytes(&self) -> usize;

    /// How it was built and works, in a few words for people; empty where there is nothing to say.
    fn details(&self) -> String {
        String::new()
    }
}

/// Makes the rays to ask with.
pub(super) fn to_queries(spheres: &SphereSet, rays: &PathRays, queries: &mut Vec<Ray>) {
    queries.clear();
    queries.extend(rays.iter().map(|ray| spheres.to_query(&ray)));
}

/// The stated error of a backend's arithmetic, as a backward error: an answer is exact for spheres
/// whose radius was changed by at most `k 2^-24 (|o - c| + R)`, plus what rounding the ray's own
/// origin to f32 moved it.
///
/// `crosscheck` and the differential tests accept an id that differs from the judge's only within
/// this band.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorBound {
    /// The factor `k` for spheres stored in f32.
    pub particles: f64,
    /// The factor `k` for giants.
    pub giants: f64,
    /// Whether the backend traces from the origin as rounded to f32.
    pub rounds_origin: bool,
}
