//! Benchmarks of trace, build and render speed: what `photosphere bench` prints.
//!
//! Machines are noisy, so backends are interleaved round by round, and each figure is the median
//! over the rounds. In each round a measurement gets a fixed time budget: a slow backend traces
//! fewer rays, in runs spread over all of them, so every backend sees the same mix.

mod backend_set;
mod measure;
mod measurement;
mod record;
mod render_bench;
mod stage_bench;
mod standard_scene;
mod sweep;

use crate::accel::{Accel, Backend};
use crate::error::Result;
use crate::math::{Hit, Ray};
use crate::task::CancelToken;

use backend_set::BuiltBackend;
use measurement::{Measurement, sample_evenly};

pub use backend_set::{
    BackendSet, CAMERA, MAX_BRUTE_FORCE_SPHERES, RAY_SETS, RaySet, SECOND_BOUNCE, camera_rays,
};
pub use measure::{BenchPlan, SceneBench, Suite, SuiteEntry, SuiteEvent};
pub use measurement::{Quartiles, QueryKind};
pub use record::Record;
pub use render_bench::{RenderBench, bench_renders};
pub use stage_bench::bench_stages;
pub use standard_scene::StandardScene;
pub use sweep::{SweepPoint, SweepResult, sweep};

/// Rays per ray set whose hit ids are compared between backends.
const COMPARED_RAYS: usize = 4096;

/// Benchmark options.
#[derive(Clone, Copy, Debug)]
pub struct BenchOptions {
    /// Rounds, at least one. Every backend runs once in each.
    pub rounds: usize,
    /// Batch size: rays per call.
    pub batch: usize,
}

/// Measurements of one backend.
#[derive(Clone, Debug, PartialEq)]
pub struct BackendBench {
    /// The backend.
    pub backend: Backend,
    /// Build and traversal details; see [`Accel::details`].
    pub details: String,
    /// Build time in seconds.
    pub build_s: Quartiles,
    /// Memory of the acceleration structure in bytes per sphere, excluding the spheres themselves.
    pub bytes_per_sphere: f64,
    /// Rates for each ray set, in order; `None` for an empty set.
    pub rates: Vec<Option<Rates>>,
}

/// Rates on one ray set, in rays per second, summed over all threads of the current rayon pool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates {
    /// Rate of closest-hit queries.
    pub closest: Quartiles,
    /// Rate of occlusion queries.
    pub occluded: Quartiles,
    /// Number of compared rays whose hit id differs from the first backend's.
    pub differing_ids: usize,
}

impl Rates {
    /// Returns the rate for one query type.
    pub fn get(&self, query: QueryKind) -> Quartiles {
        match query {
            QueryKind::Closest => self.closest,
            QueryKind::Occluded => self.occluded,
        }
    }
}

/// Benchmarks every backend on the current rayon pool.
///
/// # Errors
/// On cancellation.
pub fn bench(
    backend_set: &BackendSet,
    ray_sets: &[RaySet],
    rounds: BenchOptions,
    cancel: &CancelToken,
) -> Result<Vec<BackendBench>> {
    let new_run = |built| BackendRun::new(built, ray_sets, rounds.batch);
    let mut runs: Vec<BackendRun<'_>> = backend_set.built.iter().map(new_run).collect();
    for _ in 0..rounds.rounds.max(1) {
        for set in 0..ray_sets.len() {
            for query in QueryKind::ALL {
                for run in &mut runs {
                    cancel.check()?;
                    run.measurements[set][query as usize].repeat(&*run.backend.accel);
                }
            }
        }
    }
    let spheres = backend_set.spheres.len();
    Ok(runs.iter().map(|run| run.result(&runs[0], spheres)).collect())
}

/// A backend with its measurements for each ray set.
struct BackendRun<'a> {
    backend: &'a BuiltBackend,
    measurements: Vec<[Measurement<'a>; 2]>,
    /// Hit ids of some rays of each ray set.
    ids: Vec<Vec<u32>>,
}

impl<'a> BackendRun<'a> {
    fn new(built: &'a BuiltBackend, ray_sets: &'a [RaySet], batch: usize) -> Self {
        let accel = &*built.accel;
        let calibrated = |set: &'a RaySet| {
            QueryKind::ALL.map(|query| Measurement::calibrated(query, &set.rays, batch, accel))
        };
        let measurements = ray_sets.iter().map(calibrated).collect();
        let ids = ray_sets
            .iter()
            .map(|set| ids(&sample_evenly(&set.rays, COMPARED_RAYS), accel))
            .collect();
        Self { backend: built, measurements, ids }
    }

    fn result(&self, first: &Self, spheres: usize) -> BackendBench {
        let rates = |(set, [closest, occluded]): (usize, &[Measurement<'_>; 2])| {
            let pairs = self.ids[set].iter().zip(&first.ids[set]);
            let differing_ids = pairs.filter(|(id, first)| id != first).count();
            Some(Rates { closest: closest.rate()?, occluded: occluded.rate()?, differing_ids })
        };
        let BuiltBackend { backend, accel, seconds } = self.backend;
        BackendBench {
            backend: *backend,
            details: accel.details(),
            build_s: *seconds,
            bytes_per_sphere: accel.bytes() as f64 / spheres.max(1) as f64,
            rates: self.measurements.iter().enumerate().map(rates).collect(),
        }
    }
}

fn ids(rays: &[Ray], accel: &dyn Accel) -> Vec<u32> {
    let mut hits = vec![Hit::MISS; rays.len()];
    accel.closest(rays, &mut hits);
    hits.iter().map(|hit| hit.id).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::BuildOptions;
    use crate::geometry::SphereSet;
    use crate::geometry::{Sphere, SphereRows};
    use crate::math::{DVec3, NO_SPHERE};
    use std::sync::Arc;

    const ROUNDS: BenchOptions = BenchOptions { rounds: 3, batch: 100 };

    /// Rays that hit some of the spheres of [`backend_set`].
    pub(super) fn rays() -> Vec<Ray> {
        let ray = |i: u32| {
            let origin = DVec3::new(f64::from(i) * 1e-2, 0.0, -9.0);
            Ray::new(origin, DVec3::Z, 0.0, f64::INFINITY, [NO_SPHERE; 2])
        };
        (0..3000).map(ray).collect()
    }

    pub(super) fn backend_set(backends: &[Backend]) -> BackendSet {
        let ball = |i: i32| Sphere { center: DVec3::X * f64::from(i), radius: 0.4 };
        let rows = SphereRows { exact: (0..20).map(ball).collect(), ..SphereRows::default() };
        let spheres = Arc::new(SphereSet::new(rows).expect("few spheres"));
        BackendSet::build(&spheres, backends, &BuildOptions::default(), 2).expect("builds")
    }

    #[test]
    fn every_backend_gets_rates_for_the_rays_there_are() {
        let set = |name, rays| RaySet { name, rays };
        let ray_sets = [set("camera", rays()), set("none", Vec::new())];
        let backends = [Backend::Native, Backend::BruteForce];
        let results = bench(&backend_set(&backends), &ray_sets, ROUNDS, &CancelToken::default());
        let results = results.expect("nobody cancels");
        assert_eq!(results.iter().map(|result| result.backend).collect::<Vec<_>>(), backends);
        for result in results {
            let [Some(rates), None] = result.rates[..] else { panic!("one kind has rays") };
            for rate in QueryKind::ALL.map(|query| rates.get(query)) {
                assert!(rate.median > 1.0 && rate.median.is_finite());
                assert!(rate.low <= rate.median && rate.median <= rate.high);
            }
            assert_eq!(rates.differing_ids, 0);
            assert!(result.build_s.median >= 0.0);
            assert_eq!(result.bytes_per_sphere > 0.0, result.backend == Backend::Native);
        }
    }

    #[test]
    fn it_can_be_cancelled() {
        let ray_sets = [RaySet { name: CAMERA, rays: rays() }];
        let cancel = CancelToken::default();
        cancel.cancel();
        assert!(bench(&backend_set(&[Backend::Native]), &ray_sets, ROUNDS, &cancel).is_err());
    }
}
