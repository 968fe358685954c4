//! Every backend over a set of spheres, and rays that all of them must answer as the judge does.

use std::sync::Arc;

use photosphere::accel::{Accel, Backend, BuildOptions, ErrorBound};
use photosphere::geometry::{PathRay, Sphere, SphereRows, SphereSet};
use photosphere::math::{Hit, Ray};
use photosphere::task::CancelToken;
use photosphere::verify::crosscheck::{CrosscheckResult, TestedBackend, compare};

/// The backends that a test runs over.
pub(crate) fn backends() -> impl Iterator<Item = Backend> {
    Backend::AVAILABLE.iter().copied()
}

/// The set of the spheres given; panics on more than fit.
pub(crate) fn set_of(exact: Vec<Sphere>) -> Arc<SphereSet> {
    let rows = SphereRows { exact, table: Vec::new() };
    Arc::new(SphereSet::new(rows).expect("few spheres"))
}

/// One backend over the spheres.
pub(crate) fn built(backend: Backend, spheres: &Arc<SphereSet>) -> Box<dyn Accel> {
    let options = BuildOptions { threads: 1, ..Default::default() };
    let built = backend.build(spheres, &options);
    built.unwrap_or_else(|error| panic!("{}: {error}", backend.name()))
}

/// Compares every backend with the judge, each put through `change`, and after them
/// [`RoundedRays`].
pub(crate) fn against_the_judge(
    spheres: &Arc<SphereSet>,
    rays: &[PathRay],
    change: fn(Box<dyn Accel>) -> Box<dyn Accel>,
) -> Vec<CrosscheckResult> {
    let rounded = Box::new(RoundedRays(built(Backend::BruteForce, spheres)));
    let mut accels: Vec<_> = backends().map(|b| (b.name(), change(built(b, spheres)))).collect();
    accels.push(("f32 rays", change(rounded)));
    let contenders: Vec<_> =
        accels.iter().map(|(name, accel)| TestedBackend { name, accel: accel.as_ref() }).collect();
    compare(spheres, &contenders, rays, &CancelToken::default()).expect("nobody cancels")
}

/// Brute force on rays rounded to f32: the least that any f32 backend gets wrong, and so a test of
/// the judge's band in builds that have no such backend.
struct RoundedRays(Box<dyn Accel>);

impl RoundedRays {
    fn rounded(rays: &[Ray]) -> Vec<Ray> {
        let exact = [0.0; 3];
        rays.iter().map(|ray| Ray { origin_low: exact, direction_low: exact, ..*ray }).collect()
    }
}

impl Accel for RoundedRays {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.0.closest(&Self::rounded(rays), hits);
    }

    fn occluded(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.0.occluded(&Self::rounded(rays), occluded);
    }

    /// Rounding turns the direction by at most 2^-24, which moves the line at the sphere by that
    /// share of the distance, and makes it longer or shorter by as much: `k = 2`, and room for what
    /// f64 adds.
    fn error_bound(&self) -> ErrorBound {
        ErrorBound { particles: 2.01, giants: 2.01, rounds_origin: true }
    }

    fn bytes(&self) -> usize {
        self.0.bytes()
    }
}

/// Fails with the first disagreeing rays of a backend, if there are any.
pub(crate) fn assert_no_failures(what: &str, result: &CrosscheckResult) {
    let shown: Vec<String> =
        result.disagreements.iter().take(3).map(|ray| format!("  {ray}")).collect();
    assert_eq!(
        result.failures(),
        0,
        "{what}: `{}` is beyond its stated error: {} wrong, {} lost, {} ghosts, {} distances \
         (largest {:.3}), {} sides, {} occlusions, of {} rays; the first:\n{}",
        result.name,
        result.wrong_ids,
        result.false_misses,
        result.false_hits,
        result.wrong_distances,
        result.max_distance_error,
        result.wrong_sides,
        result.wrong_occlusions,
        result.rays,
        shown.join("\n"),
    );
}
