//! Times one query type on one backend, repeatedly, and summarizes the results.

use std::borrow::Cow;
use std::time::Instant;

use rayon::prelude::*;

use crate::accel::Accel;
use crate::math::{Hit, Ray};

/// Camera rays per pixel.
pub(super) const SAMPLES_PER_PIXEL: usize = 16;
/// Rays in a run of neighbouring rays.
const RUN_LENGTH: usize = 512;
/// Time budget of one measurement in one round, in seconds.
const ROUND_SECONDS: f64 = 0.2;

/// Median of a figure over several rounds, with its interquartile range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quartiles {
    /// Median over the rounds.
    pub median: f64,
    /// Lower quartile of the rounds.
    pub low: f64,
    /// Upper quartile of the rounds.
    pub high: f64,
}

impl Quartiles {
    /// Summarizes one value per round; `None` if there are no values.
    pub fn from_samples(mut values: Vec<f64>) -> Option<Self> {
        values.sort_unstable_by(f64::total_cmp);
        let last = values.len().checked_sub(1)?;
        let median = 0.5 * (values[last / 2] + values[last.div_ceil(2)]);
        let quarter = values.len() / 4;
        Some(Self { median, low: values[quarter], high: values[last - quarter] })
    }

    /// Wraps a single value, with no spread.
    pub fn from_single(value: f64) -> Self {
        Self { median: value, low: value, high: value }
    }

    /// Converts to another unit by multiplying by `factor`.
    pub fn scaled(self, factor: f64) -> Self {
        let Self { median, low, high } = self;
        Self { median: factor * median, low: factor * low, high: factor * high }
    }

    /// Half the interquartile range, relative to the median.
    pub fn relative_spread(&self) -> f64 {
        0.5 * (self.high - self.low) / self.median.max(f64::MIN_POSITIVE)
    }
}

/// Type of ray query.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QueryKind {
    /// Closest hit along each ray.
    Closest,
    /// Occlusion: any hit along each ray.
    Occluded,
}

impl QueryKind {
    /// All query types, in the order of reports.
    pub const ALL: [Self; 2] = [Self::Closest, Self::Occluded];

    /// Returns the seconds taken to trace all rays, in batches distributed over the threads of the
    /// current rayon pool.
    fn seconds_for(self, rays: &[Ray], batch: usize, accel: &dyn Accel) -> f64 {
        match self {
            Self::Closest => {
                let mut hits = vec![Hit::MISS; rays.len()];
                time_batches(rays, &mut hits, batch, |rays, hits| accel.closest(rays, hits))
            }
            Self::Occluded => {
                let mut occluded = vec![false; rays.len()];
                time_batches(rays, &mut occluded, batch, |rays, occluded| {
                    accel.occluded(rays, occluded)
                })
            }
        }
    }
}

/// Repeated measurement of one query type on one ray set.
pub(super) struct Measurement<'a> {
    query: QueryKind,
    rays: Cow<'a, [Ray]>,
    batch: usize,
    /// Rays per second in each round.
    rates: Vec<f64>,
}

impl<'a> Measurement<'a> {
    /// Creates a measurement with as many rays as fit into a round, found by growing the count.
    pub(super) fn calibrated(
        query: QueryKind,
        rays: &'a [Ray],
        batch: usize,
        accel: &dyn Accel,
    ) -> Self {
        let mut count = rays.len().min(1);
        loop {
            let subset = sample_evenly(rays, count);
            let seconds = query.seconds_for(&subset, batch, accel);
            if count >= rays.len() || seconds > ROUND_SECONDS / 4.0 {
                return Self { query, rays: subset, batch, rates: Vec::new() };
            }
            count = (4 * count).min(rays.len());
        }
    }

    /// Runs one more round on the current rayon pool.
    pub(super) fn repeat(&mut self, accel: &dyn Accel) {
        if !self.rays.is_empty() {
            let seconds = self.query.seconds_for(&self.rays, self.batch, accel);
            self.rates.push(self.rays.len() as f64 / seconds.max(1e-9));
        }
    }

    /// Rays per second; `None` if there are no rays.
    pub(super) fn rate(&self) -> Option<Quartiles> {
        Quartiles::from_samples(self.rates.clone())
    }
}

fn time_batches<T: Send>(
    rays: &[Ray],
    results: &mut [T],
    batch: usize,
    trace: impl Fn(&[Ray], &mut [T]) + Sync,
) -> f64 {
    let start = Instant::now();
    let batches = rays.par_chunks(batch).zip(results.par_chunks_mut(batch));
    batches.for_each(|(rays, results)| trace(rays, results));
    start.elapsed().as_secs_f64()
}

/// Picks `count` of the rays, as evenly spread runs of neighbouring rays. Runs start at pixel
/// boundaries.
pub(super) fn sample_evenly(rays: &[Ray], count: usize) -> Cow<'_, [Ray]> {
    if count >= rays.len() {
        return Cow::Borrowed(rays);
    }
    let run = count.clamp(1, RUN_LENGTH);
    let runs = count / run;
    let starts = (0..runs).map(|i| i * (rays.len() - run) / runs);
    let starts = starts.map(|start| start - start % SAMPLES_PER_PIXEL);
    starts.flat_map(|start| &rays[start..start + run]).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{DVec3, NO_SPHERE};

    fn ray(x: f64) -> Ray {
        Ray::new(DVec3::new(x, 0.0, -9.0), DVec3::Z, 0.0, f64::INFINITY, [NO_SPHERE; 2])
    }

    #[test]
    fn fewer_rays_come_from_everywhere() {
        let rays: Vec<_> = (0..10_000).map(|i| ray(f64::from(i))).collect();
        let subset = sample_evenly(&rays, 2048);
        assert_eq!(subset.len(), 2048);
        assert_eq!(subset[0], rays[0]);
        assert_eq!(subset[511], rays[511]);
        assert!(subset[2047].origin[0] > 7000.0);
        assert_eq!(sample_evenly(&rays, 1).len(), 1);
        assert_eq!(*sample_evenly(&rays, 20_000), rays);
    }

    #[test]
    fn a_figure_is_the_median_and_the_middle_half() {
        let figure = Quartiles::from_samples(vec![1.0, 50.0, 100.0, 25.0, 40.0]);
        assert_eq!(figure, Some(Quartiles { median: 40.0, low: 25.0, high: 50.0 }));
        assert_eq!(figure.map(|figure| figure.relative_spread()), Some(0.5 * (50.0 - 25.0) / 40.0));
        let two = Quartiles { median: 2.0, low: 1.0, high: 3.0 };
        assert_eq!(Quartiles::from_samples(vec![3.0, 1.0]), Some(two));
        assert_eq!(Quartiles::from_samples(vec![7.0]), Some(Quartiles::from_single(7.0)));
        assert_eq!(two.scaled(0.5), Quartiles { median: 1.0, low: 0.5, high: 1.5 });
        assert_eq!(Quartiles::from_samples(Vec::new()), None);
    }
}
