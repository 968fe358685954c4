//! Every backend over a set of spheres, and rays that all of them must answer as the judge does.

use std::sync::Arc;

use photosphere::accel::{Accel, Backend, BuildOptions, Cancel};
use photosphere::geometry::{PathRay, Sphere, SphereRows, SphereSet};
use photosphere::verify::crosscheck::{Contender, Tally, compare};

/// The backends that a test runs over.
pub fn backends() -> impl Iterator<Item = Backend> {
    Backend::AVAILABLE.iter().copied().filter(|b| *b == Backend::BruteForce)
}

/// The set of the spheres given; panics on more than fit.
pub fn set_of(exact: Vec<Sphere>) -> Arc<SphereSet> {
    let rows = SphereRows { exact, table: Vec::new() };
    Arc::new(SphereSet::new(rows).expect("few spheres"))
}

/// One backend over the spheres.
pub fn built(backend: Backend, spheres: &Arc<SphereSet>) -> Box<dyn Accel> {
    let options = BuildOptions { threads: 1, cancel: Cancel::default() };
    let built = backend.build(spheres, &options);
    built.unwrap_or_else(|error| panic!("{}: {error}", backend.name()))
}

/// Compares every backend with the judge.
pub fn against_the_judge(spheres: &Arc<SphereSet>, rays: &[PathRay]) -> Vec<Tally> {
    let accels: Vec<_> = backends().map(|b| (b.name(), built(b, spheres))).collect();
    let contenders: Vec<_> =
        accels.iter().map(|(name, accel)| Contender { name, accel: accel.as_ref() }).collect();
    compare(spheres, &contenders, rays, &Cancel::default()).expect("nobody cancels")
}

/// Fails with the first disagreeing rays of a backend, if there are any.
pub fn assert_no_failures(what: &str, tally: &Tally) {
    let shown: Vec<String> =
        tally.disagreements.iter().take(3).map(|ray| format!("  {ray}")).collect();
    assert_eq!(
        tally.failures(),
        0,
        "{what}: `{}` is beyond its stated error: {} wrong, {} lost, {} ghosts, {} distances \
         (largest {:.3}), {} sides, {} occlusions, of {} rays; the first:\n{}",
        tally.name,
        tally.wrong,
        tally.lost,
        tally.ghosts,
        tally.wrong_distances,
        tally.largest_distance_error,
        tally.wrong_sides,
        tally.wrong_occlusions,
        tally.rays,
        shown.join("\n"),
    );
}
