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
use crate::geometry::SphereSet;
use crate::math::{Hit, Ray};

/// Rays of one call, and of one run of neighbouring rays.
const BATCH: usize = 512;
/// What one measurement of one round should take at most, in seconds.
const ROUND_SECONDS: f64 = 0.2;

/// The rays to measure with.
#[derive(Clone, Copy, Debug)]
pub struct BenchRays<'a> {
    /// Coherent rays: the camera's, in the order of the pixels.
    pub camera: &'a [Ray],
    /// Incoherent rays, after diffuse bounces.
    pub bounced: &'a [Ray],
}

/// What was measured of one backend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BackendBench {
    /// Which one.
    pub backend: Backend,
    /// Seconds that the build took.
    pub build_s: f64,
    /// Bytes of the structure per sphere, without the spheres themselves.
    pub bytes_per_sphere: f64,
    /// Rates for camera rays; `None` where there are no such rays.
    pub camera: Option<Rates>,
    /// Rates for bounced rays; `None` where there are no such rays.
    pub bounced: Option<Rates>,
}

/// Rays per second, of all threads of the current rayon pool together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates {
    /// For the first sphere along each ray.
    pub closest: f64,
    /// For whether each ray hits anything.
    pub occluded: f64,
}

/// Builds every backend and measures them against each other on the current rayon pool, over
/// `rounds` rounds (at least one; odd numbers have a true median).
///
/// # Errors
/// When a backend cannot be built, or on cancellation through `options`.
pub fn bench(
    spheres: &Arc<SphereSet>,
    backends: &[Backend],
    rays: BenchRays,
    options: &BuildOptions,
    rounds: usize,
) -> Result<Vec<BackendBench>> {
    let mut stands = Vec::new();
    for &backend in backends {
        stands.push(Stand::set_up(backend, spheres, rays, options)?);
    }
    for _ in 0..rounds.max(1) {
        for stand in &mut stands {
            for measurement in &mut stand.measurements {
                options.cancel.check()?;
                measurement.repeat(&*stand.accel);
            }
        }
    }
    Ok(stands.iter().map(|stand| stand.result(spheres.len())).collect())
}

/// A backend with its measurements: closest and occluded for camera rays, then for bounced ones.
struct Stand {
    backend: Backend,
    accel: Box<dyn Accel>,
    build_s: f64,
    measurements: [Measurement; 4],
}

/// One kind of question, put again and again.
struct Measurement {
    question: Question,
    rays: Vec<Ray>,
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
        rays: BenchRays,
        options: &BuildOptions,
    ) -> Result<Self> {
        let start = Instant::now();
        let accel = backend.build(spheres, options)?;
        let build_s = start.elapsed().as_secs_f64();
        let calibrate = |question, rays| Measurement::calibrated(question, rays, &*accel);
        let measurements = [
            calibrate(Question::Closest, rays.camera),
            calibrate(Question::Occluded, rays.camera),
            calibrate(Question::Closest, rays.bounced),
            calibrate(Question::Occluded, rays.bounced),
        ];
        Ok(Self { backend, accel, build_s, measurements })
    }

    fn result(&self, spheres: usize) -> BackendBench {
        let [camera_closest, camera_occluded, closest, occluded] =
            self.measurements.each_ref().map(Measurement::rate);
        let rates = |closest: Option<f64>, occluded: Option<f64>| {
            Some(Rates { closest: closest?, occluded: occluded? })
        };
        BackendBench {
            backend: self.backend,
            build_s: self.build_s,
            bytes_per_sphere: self.accel.bytes() as f64 / spheres.max(1) as f64,
            camera: rates(camera_closest, camera_occluded),
            bounced: rates(closest, occluded),
        }
    }
}

impl Measurement {
    /// With as many rays as fit into a round, found by trying more and more.
    fn calibrated(question: Question, rays: &[Ray], accel: &dyn Accel) -> Self {
        let mut count = rays.len().min(1);
        loop {
            let chosen = spread(rays, count);
            let seconds = question.seconds_for(&chosen, accel);
            if count >= rays.len() || seconds > ROUND_SECONDS / 4.0 {
                return Self { question, rays: chosen, seconds: Vec::new() };
            }
            count = (4 * count).min(rays.len());
        }
    }

    fn repeat(&mut self, accel: &dyn Accel) {
        self.seconds.push(self.question.seconds_for(&self.rays, accel));
    }

    /// The median over the rounds, in rays per second; `None` without rays.
    fn rate(&self) -> Option<f64> {
        let mut seconds = self.seconds.clone();
        seconds.sort_unstable_by(f64::total_cmp);
        let median = *seconds.get(seconds.len() / 2)?;
        (!self.rays.is_empty()).then(|| self.rays.len() as f64 / median.max(1e-9))
    }
}

impl Question {
    /// How long all the rays take, in batches shared among the threads.
    fn seconds_for(self, rays: &[Ray], accel: &dyn Accel) -> f64 {
        match self {
            Self::Closest => {
                let mut hits = vec![Hit::MISS; rays.len()];
                timed(rays, &mut hits, |rays, hits| accel.closest(rays, hits))
            }
            Self::Occluded => {
                let mut blocked = vec![false; rays.len()];
                timed(rays, &mut blocked, |rays, blocked| accel.occluded(rays, blocked))
            }
        }
    }
}

fn timed<T: Send>(rays: &[Ray], answers: &mut [T], ask: impl Fn(&[Ray], &mut [T]) + Sync) -> f64 {
    let start = Instant::now();
    let batches = rays.par_chunks(BATCH).zip(answers.par_chunks_mut(BATCH));
    batches.for_each(|(rays, answers)| ask(rays, answers));
    start.elapsed().as_secs_f64()
}

/// `count` of the rays, in runs of neighbours that are spread evenly.
fn spread(rays: &[Ray], count: usize) -> Vec<Ray> {
    if count >= rays.len() {
        return rays.to_vec();
    }
    let run = count.clamp(1, BATCH);
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

    #[test]
    fn every_backend_gets_rates_for_the_rays_there_are() {
        let camera: Vec<_> = (0..3000).map(|i| ray(f64::from(i) * 1e-2)).collect();
        let rays = BenchRays { camera: &camera, bounced: &[] };
        let backends = [Backend::Native, Backend::BruteForce];
        let options = BuildOptions::default();
        let results = bench(&spheres(), &backends, rays, &options, 3).expect("nobody cancels");
        assert_eq!(results.iter().map(|result| result.backend).collect::<Vec<_>>(), backends);
        for result in results {
            let rates = result.camera.expect("there are camera rays");
            assert!(rates.closest > 1.0 && rates.closest.is_finite());
            assert!(rates.occluded > 1.0 && rates.occluded.is_finite());
            assert_eq!(result.bounced, None);
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
    fn the_rate_is_the_median() {
        let measurement = Measurement {
            question: Question::Closest,
            rays: vec![ray(0.0); 100],
            seconds: vec![9.0, 2.0, 1.0],
        };
        assert_eq!(measurement.rate(), Some(50.0));
    }

    #[test]
    fn it_can_be_cancelled() {
        let options = BuildOptions::default();
        options.cancel.cancel();
        let rays = BenchRays { camera: &[], bounced: &[] };
        assert!(bench(&spheres(), &[Backend::Native], rays, &options, 1).is_err());
    }
}
