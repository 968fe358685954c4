//! Benchmarks of trace, build and render speed: what `photosphere bench` prints.
//!
//! Machines are noisy, so backends are interleaved round by round, and each figure is the median
//! over the rounds. In each round a measurement gets a fixed time budget: a slow backend traces
//! fewer rays, in runs spread over all of them, so every backend sees the same mix.

mod measure;
mod measurement;
mod record;
mod render_bench;
mod standard_scene;
mod sweep;

use std::sync::Arc;
use std::time::Instant;

use crate::accel::{Accel, Backend, BuildOptions};
use crate::camera::Camera;
use crate::error::Result;
use crate::geometry::{PathRay, SphereSet};
use crate::math::{Hit, Ray};
use crate::task::CancelToken;

use super::rays;
use measurement::{Measurement, SAMPLES_PER_PIXEL, sample_evenly};

pub use measure::{Event, Measuring, SceneBench, Suite, SuiteEntry};
pub use measurement::{Quartiles, QueryKind};
pub use record::Record;
pub use render_bench::{RenderBench, bench_renders};
pub use standard_scene::StandardScene;
pub use sweep::{SweepPoint, SweepResult, sweep};

/// Rays per ray set whose hit ids are compared between backends.
const COMPARED_RAYS: usize = 4096;

/// A named set of rays to benchmark with.
#[derive(Clone, Debug)]
pub struct RaySet {
    /// Name of the set.
    pub name: &'static str,
    /// Rays in the order in which an integrator would trace them.
    pub rays: Vec<Ray>,
}

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
    /// How the backend was built and works; see [`Accel::details`].
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
    pub fn get(&self, question: QueryKind) -> Quartiles {
        match question {
            QueryKind::Closest => self.closest,
            QueryKind::Occluded => self.occluded,
        }
    }
}

/// Backends under comparison, built over the same spheres.
pub struct BackendSet {
    spheres: Arc<SphereSet>,
    built: Vec<BuiltBackend>,
}

struct BuiltBackend {
    backend: Backend,
    accel: Box<dyn Accel>,
    /// Build time in seconds, over the repeated builds.
    seconds: Quartiles,
}

impl BackendSet {
    /// Builds each backend `builds` times (at least once), interleaved, and keeps the last of each.
    ///
    /// # Errors
    /// If a backend cannot be built, or on cancellation through `options`.
    pub fn build(
        spheres: &Arc<SphereSet>,
        backends: &[Backend],
        options: &BuildOptions,
        times: usize,
    ) -> Result<Self> {
        let timed = |backend: Backend| {
            let start = Instant::now();
            let accel = backend.build(spheres, options)?;
            Ok((accel, start.elapsed().as_secs_f64()))
        };
        let mut seconds = vec![Vec::new(); backends.len()];
        for _ in 1..times {
            for (&backend, seconds) in backends.iter().zip(&mut seconds) {
                seconds.push(timed(backend)?.1);
            }
        }
        let mut built = Vec::new();
        for (&backend, mut all) in backends.iter().zip(seconds) {
            let (accel, seconds) = timed(backend)?;
            all.push(seconds);
            let seconds = Quartiles::from_samples(all).unwrap_or(Quartiles::from_single(seconds));
            built.push(BuiltBackend { backend, accel, seconds });
        }
        Ok(Self { spheres: spheres.clone(), built })
    }

    /// The spheres that all backends are built over.
    pub fn spheres(&self) -> &Arc<SphereSet> {
        &self.spheres
    }

    /// Each backend with its acceleration structure, in the order requested.
    pub fn backends(&self) -> impl Iterator<Item = (Backend, &dyn Accel)> {
        self.built.iter().map(|built| (built.backend, &*built.accel))
    }

    fn accels(&self) -> impl Iterator<Item = &dyn Accel> {
        self.backends().map(|(_, accel)| accel)
    }

    /// Builds the ray sets: the camera rays given, two diffuse bounces of them, and shadow rays.
    /// Hits are found with the first backend.
    pub fn ray_sets(&self, camera: Vec<PathRay>) -> Vec<RaySet> {
        let (spheres, accel) = (&*self.spheres, self.accels().next());
        let Some(accel) = accel else { return Vec::new() };
        let first = rays::secondary(spheres, accel, &camera, SEED);
        let second = rays::secondary(spheres, accel, &first, SEED + 1);
        let shadow = rays::shadow(spheres, accel, &camera, SEED + 2);
        let kinds: [_; RAY_SETS] = [
            (CAMERA, camera),
            ("first bounce", first),
            (SECOND_BOUNCE, second),
            ("shadow", shadow),
        ];
        let ask = |(name, rays): (_, Vec<PathRay>)| RaySet {
            name,
            rays: rays.iter().map(|ray| spheres.to_query(ray)).collect(),
        };
        kinds.into_iter().map(ask).collect()
    }
}

/// Generates camera rays as a render does, 16 per pixel. Uses all pixels, or a regular grid of
/// pixels if that would exceed `most` rays.
pub fn camera_rays(camera: &Camera, [width, height]: [u32; 2], most: usize) -> Vec<PathRay> {
    let side = (SAMPLES_PER_PIXEL as f64).sqrt() as u32;
    let rays = |step: u32| {
        (width.div_ceil(step) as usize * height.div_ceil(step) as usize) * SAMPLES_PER_PIXEL
    };
    let step = (1..).find(|&step| step >= width.max(height) || rays(step) <= most).unwrap_or(1);
    let place =
        |pixel: u32, cell: u32| f64::from(pixel) + (f64::from(cell) + 0.5) / f64::from(side);
    let columns = || (0..width).step_by(step as usize);
    let pixels = (0..height).step_by(step as usize).flat_map(|y| columns().map(move |x| (x, y)));
    let cells = || (0..side).flat_map(|row| (0..side).map(move |column| (column, row)));
    let ray =
        |(x, y), (column, row)| camera.generate_ray(place(x, column), place(y, row), LENS_CENTER);
    pixels.flat_map(|pixel| cells().map(move |cell| ray(pixel, cell))).collect()
}

/// Sample that maps to the centre of a lens, or close to it for a lens with blades.
const LENS_CENTER: [f64; 2] = [0.5; 2];

/// Largest number of spheres for which brute force is worth the wait.
pub const MAX_BRUTE_FORCE_SPHERES: u64 = 10_000;

/// Number of ray sets that [`BackendSet::ray_sets`] returns.
pub const RAY_SETS: usize = 4;

/// Name of the camera ray set.
pub const CAMERA: &str = "camera";

/// Name of the ray set after two diffuse bounces. These rays are incoherent, so caches do not help.
pub const SECOND_BOUNCE: &str = "second bounce";

/// Seed for bounce and shadow-ray directions.
const SEED: u64 = 0;

/// Benchmarks every backend on the current rayon pool.
///
/// # Errors
/// On cancellation.
pub fn bench(
    field: &BackendSet,
    kinds: &[RaySet],
    rounds: BenchOptions,
    cancel: &CancelToken,
) -> Result<Vec<BackendBench>> {
    let set_up = |built| BackendRun::new(built, kinds, rounds.batch);
    let mut stands: Vec<BackendRun<'_>> = field.built.iter().map(set_up).collect();
    for _ in 0..rounds.rounds.max(1) {
        for kind in 0..kinds.len() {
            for question in QueryKind::ALL {
                for stand in &mut stands {
                    cancel.check()?;
                    stand.measurements[kind][question as usize].repeat(&*stand.backend.accel);
                }
            }
        }
    }
    let spheres = field.spheres.len();
    Ok(stands.iter().map(|stand| stand.result(&stands[0], spheres)).collect())
}

/// A backend with its measurements for each ray set.
struct BackendRun<'a> {
    backend: &'a BuiltBackend,
    measurements: Vec<[Measurement<'a>; 2]>,
    /// Hit ids of some rays of each ray set.
    ids: Vec<Vec<u32>>,
}

impl<'a> BackendRun<'a> {
    fn new(built: &'a BuiltBackend, kinds: &'a [RaySet], batch: usize) -> Self {
        let accel = &*built.accel;
        let calibrated = |kind: &'a RaySet| {
            QueryKind::ALL
                .map(|question| Measurement::calibrated(question, &kind.rays, batch, accel))
        };
        let measurements = kinds.iter().map(calibrated).collect();
        let ids = kinds
            .iter()
            .map(|kind| ids(&sample_evenly(&kind.rays, COMPARED_RAYS), accel))
            .collect();
        Self { backend: built, measurements, ids }
    }

    fn result(&self, first: &Self, spheres: usize) -> BackendBench {
        let rates = |(kind, [closest, occluded]): (usize, &[Measurement<'_>; 2])| {
            let both = self.ids[kind].iter().zip(&first.ids[kind]);
            let other_ids = both.filter(|(own, first)| own != first).count();
            Some(Rates {
                closest: closest.rate()?,
                occluded: occluded.rate()?,
                differing_ids: other_ids,
            })
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
    use crate::geometry::{Sphere, SphereRows};
    use crate::math::{DVec3, NO_SPHERE};

    const ROUNDS: BenchOptions = BenchOptions { rounds: 3, batch: 100 };

    /// Rays that hit some of the spheres of [`field`].
    pub(super) fn rays() -> Vec<Ray> {
        let ray = |i: u32| {
            let origin = DVec3::new(f64::from(i) * 1e-2, 0.0, -9.0);
            Ray::new(origin, DVec3::Z, 0.0, f64::INFINITY, [NO_SPHERE; 2])
        };
        (0..3000).map(ray).collect()
    }

    pub(super) fn field(backends: &[Backend]) -> BackendSet {
        let ball = |i: i32| Sphere { center: DVec3::X * f64::from(i), radius: 0.4 };
        let rows = SphereRows { exact: (0..20).map(ball).collect(), ..SphereRows::default() };
        let spheres = Arc::new(SphereSet::new(rows).expect("few spheres"));
        BackendSet::build(&spheres, backends, &BuildOptions::default(), 2).expect("builds")
    }

    #[test]
    fn every_backend_gets_rates_for_the_rays_there_are() {
        let kind = |name, rays| RaySet { name, rays };
        let kinds = [kind("camera", rays()), kind("none", Vec::new())];
        let backends = [Backend::Native, Backend::BruteForce];
        let results = bench(&field(&backends), &kinds, ROUNDS, &CancelToken::default());
        let results = results.expect("nobody cancels");
        assert_eq!(results.iter().map(|result| result.backend).collect::<Vec<_>>(), backends);
        for result in results {
            let [Some(rates), None] = result.rates[..] else { panic!("one kind has rays") };
            for rate in QueryKind::ALL.map(|question| rates.get(question)) {
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
        let kinds = [RaySet { name: CAMERA, rays: rays() }];
        let cancel = CancelToken::default();
        cancel.cancel();
        assert!(bench(&field(&[Backend::Native]), &kinds, ROUNDS, &cancel).is_err());
    }
}
