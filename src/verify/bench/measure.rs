//! Measures one scene, or all standard scenes in turn.

use std::sync::Arc;

use crate::accel::{Backend, BuildOptions, BuildQuality};
use crate::error::Result;
use crate::generate::Arrangement;
use crate::geometry::{PathRay, SphereSet};
use crate::integrator::StageProfile;
use crate::job::MemoryPlan;
use crate::task::CancelToken;

use super::{
    BackendBench, BackendSet, BenchOptions, MAX_BRUTE_FORCE_SPHERES, RenderBench, SECOND_BOUNCE,
    StandardScene, SweepPoint, SweepResult, bench, sweep,
};

/// Memory budget in bytes for the rays of a standard scene, per-intersector copies included.
const RAY_BUDGET: u64 = 1 << 30;

/// Plan of a benchmark: what to measure, and how often.
#[derive(Clone, Debug)]
pub struct BenchPlan {
    /// Measurement rounds. Every intersector runs once in each.
    pub rounds: usize,
    /// Builds of each intersector, interleaved between intersectors.
    pub builds: usize,
    /// Build quality of the acceleration structures.
    pub quality: BuildQuality,
    /// Batch sizes, in rays per call. The first is used for every measurement. If there are more,
    /// they are compared on second-bounce rays.
    pub batches: Vec<usize>,
    /// True if thread counts (1, 2, 4, ... up to all threads) are compared on second-bounce rays.
    pub scaling: bool,
    /// Set from another thread to cancel the measurement.
    pub cancel: CancelToken,
}

/// Measurements of one scene.
#[derive(Clone, Debug, Default)]
pub struct SceneBench {
    /// Names of the ray sets.
    pub ray_sets: Vec<&'static str>,
    /// Results, one per intersector.
    pub results: Vec<BackendBench>,
    /// Rates on second-bounce rays for each batch size.
    pub batch_sweep: Vec<SweepResult>,
    /// Rates on second-bounce rays for each number of threads.
    pub thread_sweep: Vec<SweepResult>,
    /// Timings of whole renders.
    pub renders: Vec<RenderBench>,
    /// The stages of a render with each intersector.
    pub stages: Vec<(Backend, StageProfile)>,
}

/// A standard scene and its measurements.
#[derive(Clone, Debug)]
pub struct SuiteEntry {
    /// Arrangement of the spheres.
    pub arrangement: Arrangement,
    /// Number of spheres.
    pub spheres: u64,
    /// Measurements of this scene.
    pub bench: SceneBench,
}

/// Benchmark over the standard scenes.
#[derive(Clone, Debug)]
pub struct Suite {
    /// What to measure on each scene.
    pub plan: BenchPlan,
    /// Intersectors to measure. One is skipped on scenes for which it is far too slow or needs too
    /// much memory.
    pub backends: Vec<Backend>,
    /// Largest number of spheres in a scene.
    pub max_spheres: u64,
    /// Available memory in bytes; `None` if unknown.
    pub memory: Option<u64>,
}

/// Progress event of a running suite.
#[derive(Clone, Copy, Debug)]
pub enum SuiteEvent<'a> {
    /// An intersector does not fit into memory for scenes of at least this many spheres.
    Skipped(Backend, u64),
    /// A scene is finished.
    Finished(&'a SuiteEntry),
}

impl BenchPlan {
    /// Returns the options for every measurement except the batch size sweep.
    pub fn rounds(&self) -> BenchOptions {
        BenchOptions { rounds: self.rounds, batch: self.batches.first().copied().unwrap_or(1) }
    }

    /// Builds the intersectors over `spheres`.
    ///
    /// # Errors
    /// Same as [`BackendSet::build`].
    pub fn backend_set(
        &self,
        spheres: &Arc<SphereSet>,
        backends: &[Backend],
    ) -> Result<BackendSet> {
        let threads = rayon::current_num_threads();
        let (quality, cancel) = (self.quality, self.cancel.clone());
        let options = BuildOptions { threads, quality, cancel, ..Default::default() };
        BackendSet::build(spheres, backends, &options, self.builds)
    }

    /// Measures everything except whole renders, on the camera rays given and the secondary and
    /// shadow rays derived from them.
    ///
    /// # Errors
    /// On cancellation, or if threads cannot be started.
    pub fn measure(&self, backend_set: &BackendSet, camera: Vec<PathRay>) -> Result<SceneBench> {
        let ray_sets = backend_set.ray_sets(camera);
        let rounds = self.rounds();
        let results = bench(backend_set, &ray_sets, rounds, &self.cancel)?;
        let second_bounce = ray_sets.iter().find(|set| set.name == SECOND_BOUNCE);
        let second_bounce = second_bounce.map_or(&[][..], |set| &set.rays);
        let run_sweep = |points: Vec<SweepPoint>| match &points[..] {
            [] | [_] => Ok(Vec::new()),
            points => sweep(backend_set, second_bounce, points, rounds.rounds, &self.cancel),
        };
        let threads = rayon::current_num_threads();
        let batch_point = |&batch: &usize| SweepPoint { threads, batch };
        let batch_sweep = run_sweep(self.batches.iter().map(batch_point).collect())?;
        let thread_point = |threads| SweepPoint { threads, batch: rounds.batch };
        let max_threads = if self.scaling { threads } else { 1 };
        let scaling = run_sweep(thread_counts(max_threads).map(thread_point).collect())?;
        let ray_sets = ray_sets.iter().map(|set| set.name).collect();
        Ok(SceneBench {
            ray_sets,
            results,
            batch_sweep,
            thread_sweep: scaling,
            renders: Vec::new(),
            stages: Vec::new(),
        })
    }
}

impl SceneBench {
    /// Returns the index of a ray set by its name.
    pub fn ray_set_index(&self, name: &str) -> Option<usize> {
        self.ray_sets.iter().position(|&set| set == name)
    }
}

impl Suite {
    /// Measures every scene that fits into memory. On cancellation, returns the scenes finished so
    /// far. `report` receives progress events.
    ///
    /// # Errors
    /// If an intersector cannot be built.
    pub fn measure(&self, report: &mut dyn FnMut(SuiteEvent<'_>)) -> Result<Vec<SuiteEntry>> {
        let mut entries = Vec::new();
        for count in scene_sizes(self.max_spheres) {
            let requested = backends_for(&self.backends, count);
            let backends = drop_until_fit(requested.clone(), |backends| self.fits(count, backends));
            for skipped in requested.iter().filter(|backend| !backends.contains(backend)) {
                report(SuiteEvent::Skipped(*skipped, count));
            }
            if backends.is_empty() {
                break;
            }
            for &(_, arrangement) in Arrangement::NAMES {
                match self.entry(arrangement, count, &backends) {
                    Err(_) if self.plan.cancel.is_cancelled() => return Ok(entries),
                    entry => entries.push(entry?),
                }
                entries.last().map(SuiteEvent::Finished).into_iter().for_each(&mut *report);
            }
        }
        Ok(entries)
    }

    fn fits(&self, spheres: u64, backends: &[Backend]) -> bool {
        let plan = MemoryPlan::for_spheres(spheres, backends, rayon::current_num_threads());
        self.memory.is_none_or(|memory| plan.peak() + RAY_BUDGET <= memory)
    }

    fn entry(
        &self,
        arrangement: Arrangement,
        spheres: u64,
        backends: &[Backend],
    ) -> Result<SuiteEntry> {
        let scene = StandardScene::new(arrangement, spheres)?;
        let backend_set = self.plan.backend_set(&scene.spheres, backends)?;
        let bench = self.plan.measure(&backend_set, scene.camera_rays)?;
        Ok(SuiteEntry { arrangement, spheres, bench })
    }
}

/// Thread counts 1, 2, 4, ..., ending with `max_threads`.
fn thread_counts(max_threads: usize) -> impl Iterator<Item = usize> {
    let powers = std::iter::successors(Some(1), |threads: &usize| Some(2 * threads));
    powers.take_while(move |&threads| threads < max_threads).chain([max_threads])
}

/// Scene sizes: 3, then powers of ten from 100 up to `max_spheres`.
fn scene_sizes(max_spheres: u64) -> impl Iterator<Item = u64> {
    let powers = (2..10).map(|exponent| 10u64.pow(exponent));
    [3].into_iter().chain(powers).take_while(move |&count| count <= max_spheres)
}

/// Returns the backends that finish in reasonable time with this many spheres.
fn backends_for(backends: &[Backend], spheres: u64) -> Vec<Backend> {
    let is_feasible =
        |backend: &Backend| *backend != Backend::BruteForce || spheres <= MAX_BRUTE_FORCE_SPHERES;
    backends.iter().copied().filter(is_feasible).collect()
}

/// Drops backends, largest first, until the rest fit into memory.
fn drop_until_fit(mut backends: Vec<Backend>, fits: impl Fn(&[Backend]) -> bool) -> Vec<Backend> {
    let size = |backend: &Backend| MemoryPlan::for_spheres(1 << 20, &[*backend], 1).accel;
    while !backends.is_empty() && !fits(&backends) {
        let largest = (0..backends.len()).max_by_key(|&i| size(&backends[i]));
        largest.map(|i| backends.remove(i));
    }
    backends
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_double_up_to_the_most() {
        let of = |max_threads| thread_counts(max_threads).collect::<Vec<_>>();
        assert_eq!(of(1), [1]);
        assert_eq!(of(2), [1, 2]);
        assert_eq!(of(6), [1, 2, 4, 6]);
        assert_eq!(of(8), [1, 2, 4, 8]);
    }

    #[test]
    fn sizes_grow_tenfold_up_to_the_largest() {
        assert_eq!(scene_sizes(1).count(), 0);
        assert_eq!(scene_sizes(3).collect::<Vec<_>>(), [3]);
        assert_eq!(scene_sizes(20_000).collect::<Vec<_>>(), [3, 100, 1000, 10_000]);
        assert_eq!(scene_sizes(100_000_000).last(), Some(100_000_000));
    }

    #[test]
    fn brute_force_is_left_out_where_it_is_hopeless() {
        let all = [Backend::Native, Backend::BruteForce];
        assert_eq!(backends_for(&all, 100), all);
        assert_eq!(backends_for(&all, 1_000_000), [Backend::Native]);
    }

    #[test]
    fn the_largest_are_left_out_first() {
        let all = vec![Backend::BruteForce, Backend::Native];
        assert_eq!(drop_until_fit(all.clone(), |_| true), all);
        assert_eq!(drop_until_fit(all.clone(), |b| b.len() < 2), [Backend::BruteForce]);
        assert_eq!(drop_until_fit(all, |b| b.is_empty()), []);
    }
}
