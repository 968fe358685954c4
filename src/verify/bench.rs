//! How fast each backend answers: what `photosphere bench` prints.
//!
//! Machines are never quiet, so backends take turns, round by round, and a rate is the median over
//! the rounds. A round of one measurement takes a fixed share of a second: a slow backend is given
//! fewer rays, in runs spread over all of them, so that each sees the same mixture.

use std::sync::Arc;
use std::time::Instant;

use rayon::prelude::*;

use crate::accel::{Accel, Backend, BuildOptions};
use crate::error::Result;
use crate::geometry::{PathRay, SphereSet};
use crate::math::{Hit, Ray};

use super::rays;

/// Rays of one run of neighbouring rays.
const RUN: usize = 512;
/// What one measurement of one round should take at most, in seconds.
const ROUND_SECONDS: f64 = 0.2;
/// Rays of each kind whose ids are compared.
const COMPARED: usize = 4096;

/// Rays of one kind to measure with.
#[derive(Clone, Debug)]
pub struct RayKind {
    /// What they are called.
    pub name: &'static str,
    /// The rays, in the order in which an integrator would ask.
    pub rays: Vec<Ray>,
}

/// How to measure.
#[derive(Clone, Copy, Debug)]
pub struct Rounds {
    /// In each, every backend has its turn; at least one. Odd numbers have a true median.
    pub count: usize,
    /// Rays in one call.
    pub batch: usize,
}

/// What was measured of one backend.
#[derive(Clone, Debug, PartialEq)]
pub struct BackendBench {
    /// Which one.
    pub backend: Backend,
    /// How it was built and works, as [`Accel::details`] says.
    pub details: String,
    /// Seconds that the build took.
    pub build_s: f64,
    /// Bytes of the structure per sphere, without the spheres themselves.
    pub bytes_per_sphere: f64,
    /// Rates for each kind of rays, in their order; `None` where there are no such rays.
    pub rates: Vec<Option<Rates>>,
}

/// Rates for one kind of rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates {
    /// For the first sphere along each ray.
    pub closest: Rate,
    /// For whether each ray hits anything.
    pub occluded: Rate,
    /// How many of the rays that were compared have another id than with the first backend.
    pub other_ids: usize,
}

/// Rays per second, of all threads of the current rayon pool together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate {
    /// The median over the rounds.
    pub median: f64,
    /// Half of the rounds lie within this share of the median, up and down.
    pub spread: f64,
}

/// Kinds of rays that [`kinds_of_rays`] makes.
pub const KINDS: usize = 4;

/// Chooses the directions of bounces and shadow rays.
const SEED: u64 = 0;

/// Rays of a camera, what becomes of them at diffuse surfaces, and shadow rays.
pub fn kinds_of_rays(spheres: &SphereSet, accel: &dyn Accel, camera: Vec<PathRay>) -> Vec<RayKind> {
    let first = rays::bounces(spheres, accel, &camera, SEED);
    let second = rays::bounces(spheres, accel, &first, SEED + 1);
    let shadow = rays::shadows(spheres, accel, &camera, SEED + 2);
    let kinds: [_; KINDS] = [
        ("camera", camera),
        ("first bounce", first),
        ("second bounce", second),
        ("shadow", shadow),
    ];
    let ask = |(name, rays): (_, Vec<PathRay>)| RayKind {
        name,
        rays: rays.iter().map(|ray| spheres.ask(ray)).collect(),
    };
    kinds.into_iter().map(ask).collect()
}

/// Builds every backend and measures them against each other on the current rayon pool.
///
/// # Errors
/// When a backend cannot be built, or on cancellation through `options`.
pub fn bench(
    spheres: &Arc<SphereSet>,
    backends: &[Backend],
    kinds: &[RayKind],
    options: &BuildOptions,
    rounds: Rounds,
) -> Result<Vec<BackendBench>> {
    let mut stands = Vec::new();
    for &backend in backends {
        stands.push(Stand::set_up(backend, spheres, kinds, options, rounds.batch)?);
    }
    for _ in 0..rounds.count.max(1) {
        for kind in 0..kinds.len() {
            for question in [Question::Closest, Question::Occluded] {
                for stand in &mut stands {
                    options.cancel.check()?;
                    stand.measurements[kind][question as usize].repeat(&*stand.accel);
                }
            }
        }
    }
    Ok(stands.iter().map(|stand| stand.result(&stands[0], spheres.len())).collect())
}

/// A backend with its measurements, for each kind of rays.
struct Stand {
    backend: Backend,
    accel: Box<dyn Accel>,
    build_s: f64,
    measurements: Vec<[Measurement; 2]>,
    /// The ids of some rays of each kind.
    ids: Vec<Vec<u32>>,
}

/// One kind of question, put again and again.
struct Measurement {
    question: Question,
    rays: Vec<Ray>,
    batch: usize,
    /// Seconds of each round.
    seconds: Vec<f64>,
}

#[derive(Clone, Copy)]
enum Question {
    Closest,
    Occluded,
}

impl Stand {
    fn set_up(
        backend: Backend,
        spheres: &Arc<SphereSet>,
        kinds: &[RayKind],
        options: &BuildOptions,
        batch: usize,
    ) -> Result<Self> {
        let start = Instant::now();
        let accel = backend.build(spheres, options)?;
        let build_s = start.elapsed().as_secs_f64();
        let calibrated = |kind: &RayKind| {
            [Question::Closest, Question::Occluded]
                .map(|question| Measurement::calibrated(question, &kind.rays, batch, &*accel))
        };
        let measurements = kinds.iter().map(calibrated).collect();
        let ids = kinds.iter().map(|kind| ids(&spread(&kind.rays, COMPARED), &*accel)).collect();
        Ok(Self { backend, accel, build_s, measurements, ids })
    }

    fn result(&self, first: &Self, spheres: usize) -> BackendBench {
        let rates = |(kind, [closest, occluded]): (usize, &[Measurement; 2])| {
            let both = self.ids[kind].iter().zip(&first.ids[kind]);
            let other_ids = both.filter(|(own, first)| own != first).count();
            Some(Rates { closest: closest.rate()?, occluded: occluded.rate()?, other_ids })
        };
        BackendBench {
            backend: self.backend,
            details: self.accel.details(),
            build_s: self.build_s,
            bytes_per_sphere: self.accel.bytes() as f64 / spheres.max(1) as f64,
            rates: self.measurements.iter().enumerate().map(rates).collect(),
        }
    }
}

impl Measurement {
    /// With as many rays as fit into a round, found by trying more and more.
    fn calibrated(question: Question, rays: &[Ray], batch: usize, accel: &dyn Accel) -> Self {
        let mut count = rays.len().min(1);
        loop {
            let chosen = spread(rays, count);
            let seconds = question.seconds_for(&chosen, batch, accel);
            if count >= rays.len() || seconds > ROUND_SECONDS / 4.0 {
                return Self { question, rays: chosen, batch, seconds: Vec::new() };
            }
            count = (4 * count).min(rays.len());
        }
    }

    fn repeat(&mut self, accel: &dyn Accel) {
        self.seconds.push(self.question.seconds_for(&self.rays, self.batch, accel));
    }

    /// The median over the rounds, in rays per second; `None` without rays.
    fn rate(&self) -> Option<Rate> {
        let mut seconds = self.seconds.clone();
        seconds.sort_unstable_by(f64::total_cmp);
        let (count, rays) = (seconds.len(), self.rays.len() as f64);
        let rate = |place: usize| rays / seconds[place].max(1e-9);
        if rays == 0.0 || count == 0 {
            return None;
        }
        let (median, slow, fast) = (rate(count / 2), rate(count - 1 - count / 4), rate(count / 4));
        Some(Rate { median, spread: 0.5 * (fast - slow) / median })
    }
}

impl Question {
    /// How long all the rays take, in batches shared among the threads.
    fn seconds_for(self, rays: &[Ray], batch: usize, accel: &dyn Accel) -> f64 {
        match self {
            Self::Closest => {
                let mut hits = vec![Hit::MISS; rays.len()];
                timed(rays, &mut hits, batch, |rays, hits| accel.closest(rays, hits))
            }
            Self::Occluded => {
                let mut blocked = vec![false; rays.len()];
                timed(rays, &mut blocked, batch, |rays, blocked| accel.occluded(rays, blocked))
            }
        }
    }
}

fn ids(rays: &[Ray], accel: &dyn Accel) -> Vec<u32> {
    let mut hits = vec![Hit::MISS; rays.len()];
    accel.closest(rays, &mut hits);
    hits.iter().map(|hit| hit.id).collect()
}

fn timed<T: Send>(
    rays: &[Ray],
    answers: &mut [T],
    batch: usize,
    ask: impl Fn(&[Ray], &mut [T]) + Sync,
) -> f64 {
    let start = Instant::now();
    let batches = rays.par_chunks(batch).zip(answers.par_chunks_mut(batch));
    batches.for_each(|(rays, answers)| ask(rays, answers));
    start.elapsed().as_secs_f64()
}

/// `count` of the rays, in runs of neighbours that are spread evenly.
fn spread(rays: &[Ray], count: usize) -> Vec<Ray> {
    if count >= rays.len() {
        return rays.to_vec();
    }
    let run = count.clamp(1, RUN);
    let runs = count / run;
    let starts = (0..runs).map(|i| i * (rays.len() - run) / runs);
    starts.flat_map(|start| &rays[start..start + run]).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Sphere, SphereRows};
    use crate::math::{DVec3, NO_SPHERE};

    fn ray(x: f64) -> Ray {
        Ray::new(DVec3::new(x, 0.0, -9.0), DVec3::Z, 0.0, f64::INFINITY, [NO_SPHERE; 2])
    }

    fn spheres() -> Arc<SphereSet> {
        let ball = |i: i32| Sphere { center: DVec3::X * f64::from(i), radius: 0.4 };
        let rows = SphereRows { exact: (0..20).map(ball).collect(), ..SphereRows::default() };
        Arc::new(SphereSet::new(rows).expect("few spheres"))
    }

    const ROUNDS: Rounds = Rounds { count: 3, batch: 100 };

    #[test]
    fn every_backend_gets_rates_for_the_rays_there_are() {
        let camera: Vec<_> = (0..3000).map(|i| ray(f64::from(i) * 1e-2)).collect();
        let kind = |name, rays| RayKind { name, rays };
        let kinds = [kind("camera", camera), kind("none", Vec::new())];
        let backends = [Backend::Native, Backend::BruteForce];
        let options = BuildOptions::default();
        let results = bench(&spheres(), &backends, &kinds, &options, ROUNDS);
        let results = results.expect("nobody cancels");
        assert_eq!(results.iter().map(|result| result.backend).collect::<Vec<_>>(), backends);
        for result in results {
            let [Some(rates), None] = result.rates[..] else { panic!("one kind has rays") };
            for rate in [rates.closest, rates.occluded] {
                assert!(rate.median > 1.0 && rate.median.is_finite());
                assert!(rate.spread >= 0.0);
            }
            assert_eq!(rates.other_ids, 0);
            assert!(result.build_s >= 0.0);
            assert_eq!(result.bytes_per_sphere > 0.0, result.backend == Backend::Native);
        }
    }

    #[test]
    fn fewer_rays_come_from_everywhere() {
        let rays: Vec<_> = (0..10_000).map(|i| ray(f64::from(i))).collect();
        let chosen = spread(&rays, 2048);
        assert_eq!(chosen.len(), 2048);
        assert_eq!(chosen[0], rays[0]);
        assert_eq!(chosen[511], rays[511]);
        assert!(chosen[2047].origin[0] > 7000.0);
        assert_eq!(spread(&rays, 1).len(), 1);
        assert_eq!(spread(&rays, 20_000), rays);
    }

    #[test]
    fn the_rate_is_the_median_and_the_spread_that_of_the_middle_half() {
        let measurement = Measurement {
            question: Question::Closest,
            rays: vec![ray(0.0); 100],
            batch: 10,
            seconds: vec![100.0, 2.0, 1.0, 4.0, 2.5],
        };
        let rate = measurement.rate().expect("there are rays");
        assert_eq!(rate, Rate { median: 40.0, spread: 0.5 * (50.0 - 25.0) / 40.0 });
    }

    #[test]
    fn it_can_be_cancelled() {
        let options = BuildOptions::default();
        options.cancel.cancel();
        assert!(bench(&spheres(), &[Backend::Native], &[], &options, ROUNDS).is_err());
    }
}
