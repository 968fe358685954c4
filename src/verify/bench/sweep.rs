//! Measures rates against batch size and thread count.
//!
//! Cores share caches, power and clock, so N threads are not N times as fast for any program.
//! Thread scaling is therefore compared with an arithmetic loop that touches no memory, measured in
//! the same rounds.

use std::hint::black_box;
use std::time::Instant;

use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::{self, Error, Result};
use crate::math::Ray;
use crate::task::CancelToken;

use super::backend_set::BackendSet;
use super::measurement::{Measurement, Quartiles, QueryKind, sample_evenly};

/// Largest number of rays used.
pub(super) const MAX_RAYS: usize = 1 << 18;

/// One setting of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SweepPoint {
    /// Threads that share the work, at least one.
    pub threads: usize,
    /// Batch size in rays per call, at least one.
    pub batch: usize,
}

/// Measurements at one setting.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepResult {
    /// The setting.
    pub point: SweepPoint,
    /// Rates of closest-hit and occlusion queries for each backend, in order. Rays per second,
    /// summed over all threads.
    pub rates: Vec<[Quartiles; 2]>,
    /// Passes per second of the arithmetic loop on the same number of threads.
    pub arithmetic: Quartiles,
}

/// Measures every backend at every setting on one ray set, interleaved. Returns nothing if there
/// are no rays.
///
/// # Errors
/// If threads cannot be started, or on cancellation.
pub fn sweep(
    backend_set: &BackendSet,
    rays: &[Ray],
    points: &[SweepPoint],
    rounds: usize,
    cancel: &CancelToken,
) -> Result<Vec<SweepResult>> {
    let rays = sample_evenly(rays, MAX_RAYS);
    if rays.is_empty() {
        return Ok(Vec::new());
    }
    let mut runs = Vec::new();
    for &point in points {
        runs.push(SweepRun::new(point, backend_set, &rays)?);
    }
    for _ in 0..rounds.max(1) {
        for run in &mut runs {
            cancel.check()?;
            run.repeat(backend_set);
        }
    }
    Ok(runs.iter().filter_map(SweepRun::result).collect())
}

/// A setting with its measurements for each backend.
struct SweepRun<'a> {
    point: SweepPoint,
    pool: ThreadPool,
    measurements: Vec<[Measurement<'a>; 2]>,
    /// Passes per second in each round.
    arithmetic: Vec<f64>,
}

impl<'a> SweepRun<'a> {
    fn new(point: SweepPoint, backend_set: &BackendSet, rays: &'a [Ray]) -> Result<Self> {
        let SweepPoint { threads, batch } = point;
        let pool = ThreadPoolBuilder::new().num_threads(threads.max(1)).build().map_err(|e| {
            Error::input(format!("cannot start {threads} threads: {e}"))
                .with_help("use fewer threads")
                .with_suggestion(error::Suggestion::Threads, "")
        })?;
        let measurements = pool.install(|| {
            let calibrate =
                |accel| QueryKind::ALL.map(|q| Measurement::calibrated(q, rays, batch, accel));
            backend_set.accels().map(calibrate).collect()
        });
        Ok(Self { point, pool, measurements, arithmetic: Vec::new() })
    }

    fn repeat(&mut self, backend_set: &BackendSet) {
        let Self { pool, measurements, arithmetic, .. } = self;
        pool.install(|| {
            for (accel, pair) in backend_set.accels().zip(measurements) {
                pair.iter_mut().for_each(|measurement| measurement.repeat(accel));
            }
            arithmetic.push(passes_per_second());
        });
    }

    fn result(&self) -> Option<SweepResult> {
        let rates =
            |[closest, occluded]: &[Measurement<'_>; 2]| Some([closest.rate()?, occluded.rate()?]);
        Some(SweepResult {
            point: self.point,
            rates: self.measurements.iter().map(rates).collect::<Option<_>>()?,
            arithmetic: Quartiles::from_samples(self.arithmetic.clone())?,
        })
    }
}

/// Returns how many passes of an arithmetic loop the threads of the current pool complete per
/// second.
fn passes_per_second() -> f64 {
    const PASSES: usize = 256;
    const STEPS: usize = 50_000;
    let pass = |pass: usize| {
        let mut lanes = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8].map(|x| x + pass as f64);
        for _ in 0..STEPS {
            lanes = lanes.map(|x| x * 0.999 + 0.5);
        }
        black_box(lanes);
    };
    let start = Instant::now();
    (0..PASSES).into_par_iter().with_max_len(1).for_each(pass);
    PASSES as f64 / start.elapsed().as_secs_f64().max(1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Backend;
    use crate::verify::bench::tests::{backend_set, rays};

    #[test]
    fn every_setting_is_measured_for_every_backend() {
        let backend_set = backend_set(&[Backend::Native, Backend::BruteForce]);
        let points = [(1, 1), (1, 64), (2, 64)];
        let points = points.map(|(threads, batch)| SweepPoint { threads, batch });
        let results = sweep(&backend_set, &rays(), &points, 1, &CancelToken::default()).unwrap();
        assert_eq!(results.iter().map(|result| result.point).collect::<Vec<_>>(), points);
        for result in &results {
            assert_eq!(result.rates.len(), 2);
            let figures = result.rates.iter().flatten().chain([&result.arithmetic]);
            assert!(figures.into_iter().all(|figure| figure.median > 1.0), "{result:?}");
        }
        assert_eq!(sweep(&backend_set, &[], &points, 1, &CancelToken::default()).unwrap(), []);
    }
}
