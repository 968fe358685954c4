//! What is measured of one scene, and of all standard scenes one after the other.

use std::sync::Arc;

use crate::accel::{Backend, BuildOptions, BuildQuality};
use crate::error::Result;
use crate::generate::Arrangement;
use crate::geometry::{PathRay, SphereSet};
use crate::job::MemoryPlan;
use crate::task::CancelToken;

use super::{
    BackendBench, BackendSet, BenchOptions, MAX_BRUTE_FORCE_SPHERES, RenderBench, SECOND_BOUNCE,
    StandardScene, SweepPoint, SweepResult, bench, sweep,
};

/// All the rays of a standard scene, and their copies for each intersector, in bytes.
const RAYS: u64 = 1 << 30;

/// What is to be measured, and how.
#[derive(Clone, Debug)]
pub struct Measuring {
    /// Rounds in which all take turns.
    pub rounds: usize,
    /// Builds of each intersector, in turns.
    pub builds: usize,
    /// How much care is taken in building.
    pub quality: BuildQuality,
    /// Rays in one call. The first is used for everything; where there are more, they are compared on
    /// rays of the second bounce.
    pub batches: Vec<usize>,
    /// Whether 1, 2, 4 and so on up to all threads are compared on rays of the second bounce.
    pub scaling: bool,
    /// Set from elsewhere to stop.
    pub cancel: CancelToken,
}

/// What was measured on one scene.
#[derive(Clone, Debug, Default)]
pub struct SceneBench {
    /// What the kinds of rays are called.
    pub ray_sets: Vec<&'static str>,
    /// One for each intersector.
    pub results: Vec<BackendBench>,
    /// Rates on rays of the second bounce for several lengths of calls.
    pub batch_sweep: Vec<SweepResult>,
    /// The same for several numbers of threads.
    pub thread_sweep: Vec<SweepResult>,
    /// Whole renders.
    pub renders: Vec<RenderBench>,
}

/// One standard scene, and what was measured on it.
#[derive(Clone, Debug)]
pub struct SuiteEntry {
    /// How its spheres are arranged.
    pub arrangement: Arrangement,
    /// How many there are.
    pub spheres: u64,
    /// What was measured.
    pub bench: SceneBench,
}

/// The standard scenes to measure on.
#[derive(Clone, Debug)]
pub struct Suite {
    /// What is measured on each.
    pub measuring: Measuring,
    /// Each is left out where it is hopeless, or where it would not fit into memory.
    pub backends: Vec<Backend>,
    /// The most spheres of a scene.
    pub largest: u64,
    /// How much memory there is; `None` where nobody knows.
    pub memory: Option<u64>,
}

/// What happens while a suite is measured.
#[derive(Clone, Copy, Debug)]
pub enum Event<'a> {
    /// From so many spheres on, an intersector does not fit into memory.
    LeftOut(Backend, u64),
    /// A scene is finished.
    Finished(&'a SuiteEntry),
}

impl Measuring {
    /// The rounds of all but the comparison of several batches.
    pub fn rounds(&self) -> BenchOptions {
        BenchOptions { rounds: self.rounds, batch: self.batches.first().copied().unwrap_or(1) }
    }

    /// Builds the intersectors.
    ///
    /// # Errors
    /// As [`BackendSet::build`].
    pub fn field(&self, spheres: &Arc<SphereSet>, backends: &[Backend]) -> Result<BackendSet> {
        let threads = rayon::current_num_threads();
        let (quality, cancel) = (self.quality, self.cancel.clone());
        let options = BuildOptions { threads, quality, cancel, ..Default::default() };
        BackendSet::build(spheres, backends, &options, self.builds)
    }

    /// Measures everything but whole renders, with these rays of a camera and what becomes of them.
    ///
    /// # Errors
    /// On cancellation, and when threads cannot be started.
    pub fn measure(&self, field: &BackendSet, camera: Vec<PathRay>) -> Result<SceneBench> {
        let kinds = field.ray_sets(camera);
        let rounds = self.rounds();
        let results = bench(field, &kinds, rounds, &self.cancel)?;
        let bounced = kinds.iter().find(|kind| kind.name == SECOND_BOUNCE);
        let bounced = bounced.map_or(&[][..], |kind| &kind.rays);
        let swept = |settings: Vec<SweepPoint>| match &settings[..] {
            [] | [_] => Ok(Vec::new()),
            settings => sweep(field, bounced, settings, rounds.rounds, &self.cancel),
        };
        let threads = rayon::current_num_threads();
        let of_batch = |&batch: &usize| SweepPoint { threads, batch };
        let batches = swept(self.batches.iter().map(of_batch).collect())?;
        let of_threads = |threads| SweepPoint { threads, batch: rounds.batch };
        let most = if self.scaling { threads } else { 1 };
        let scaling = swept(doubling(most).map(of_threads).collect())?;
        let kinds = kinds.iter().map(|kind| kind.name).collect();
        Ok(SceneBench {
            ray_sets: kinds,
            results,
            batch_sweep: batches,
            thread_sweep: scaling,
            renders: Vec::new(),
        })
    }
}

impl SceneBench {
    /// The place of a kind of rays.
    pub fn ray_set_index(&self, name: &str) -> Option<usize> {
        self.ray_sets.iter().position(|&kind| kind == name)
    }
}

impl Suite {
    /// Measures all that fits, or, where that is cancelled, all that is finished by then. `told` is
    /// told of what happens.
    ///
    /// # Errors
    /// When an intersector cannot be built.
    pub fn measure(&self, told: &mut dyn FnMut(Event<'_>)) -> Result<Vec<SuiteEntry>> {
        let mut entries = Vec::new();
        for count in sizes(self.largest) {
            let wanted = backends_for(&self.backends, count);
            let backends = those_that_fit(wanted.clone(), |backends| self.fits(count, backends));
            for left_out in wanted.iter().filter(|backend| !backends.contains(backend)) {
                told(Event::LeftOut(*left_out, count));
            }
            if backends.is_empty() {
                break;
            }
            for &(_, arrangement) in Arrangement::NAMES {
                match self.entry(arrangement, count, &backends) {
                    Err(_) if self.measuring.cancel.is_cancelled() => return Ok(entries),
                    entry => entries.push(entry?),
                }
                entries.last().map(Event::Finished).into_iter().for_each(&mut *told);
            }
        }
        Ok(entries)
    }

    fn fits(&self, spheres: u64, backends: &[Backend]) -> bool {
        let plan = MemoryPlan::for_spheres(spheres, backends, rayon::current_num_threads());
        self.memory.is_none_or(|memory| plan.peak() + RAYS <= memory)
    }

    fn entry(
        &self,
        arrangement: Arrangement,
        spheres: u64,
        backends: &[Backend],
    ) -> Result<SuiteEntry> {
        let scene = StandardScene::new(arrangement, spheres)?;
        let field = self.measuring.field(&scene.spheres, backends)?;
        let measured = self.measuring.measure(&field, scene.camera_rays)?;
        Ok(SuiteEntry { arrangement, spheres, bench: measured })
    }
}

/// 1, 2, 4 and so on, and the most.
fn doubling(most: usize) -> impl Iterator<Item = usize> {
    let powers = std::iter::successors(Some(1), |threads: &usize| Some(2 * threads));
    powers.take_while(move |&threads| threads < most).chain([most])
}

/// 3, then powers of ten from 100 on.
fn sizes(largest: u64) -> impl Iterator<Item = u64> {
    let powers = (2..10).map(|exponent| 10u64.pow(exponent));
    [3].into_iter().chain(powers).take_while(move |&count| count <= largest)
}

/// Those that are not hopeless.
fn backends_for(backends: &[Backend], spheres: u64) -> Vec<Backend> {
    let can =
        |backend: &Backend| *backend != Backend::BruteForce || spheres <= MAX_BRUTE_FORCE_SPHERES;
    backends.iter().copied().filter(can).collect()
}

/// Leaves out one after the other, the largest first, until the others fit.
fn those_that_fit(mut backends: Vec<Backend>, fit: impl Fn(&[Backend]) -> bool) -> Vec<Backend> {
    let size = |backend: &Backend| MemoryPlan::for_spheres(1 << 20, &[*backend], 1).accel;
    while !backends.is_empty() && !fit(&backends) {
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
        let of = |most| doubling(most).collect::<Vec<_>>();
        assert_eq!(of(1), [1]);
        assert_eq!(of(2), [1, 2]);
        assert_eq!(of(6), [1, 2, 4, 6]);
        assert_eq!(of(8), [1, 2, 4, 8]);
    }

    #[test]
    fn sizes_grow_tenfold_up_to_the_largest() {
        assert_eq!(sizes(1).count(), 0);
        assert_eq!(sizes(3).collect::<Vec<_>>(), [3]);
        assert_eq!(sizes(20_000).collect::<Vec<_>>(), [3, 100, 1000, 10_000]);
        assert_eq!(sizes(100_000_000).last(), Some(100_000_000));
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
        assert_eq!(those_that_fit(all.clone(), |_| true), all);
        assert_eq!(those_that_fit(all.clone(), |b| b.len() < 2), [Backend::BruteForce]);
        assert_eq!(those_that_fit(all, |b| b.is_empty()), []);
    }
}
