//! How fast each backend answers, builds and renders: what `photosphere bench` prints.
//!
//! Machines are never quiet, so backends take turns, round by round, and a figure is the median over
//! the rounds. A round of one measurement takes a fixed share of a second: a slow backend is given
//! fewer rays, in runs spread over all of them, so that each sees the same mixture.

mod chart;
mod field;
mod measurement;
pub mod page;
mod standard;
mod sweep;
mod whole;

use crate::accel::{Accel, Backend};
use crate::error::Result;
use crate::math::{Hit, Ray};
use crate::task::Cancel;

use field::Built;
use measurement::{Measurement, spread};

pub use field::{CAMERA, Field, KINDS, RayKind, SECOND_BOUNCE, camera_rays};
pub use measurement::{Figure, Question};
pub use standard::StandardScene;
pub use sweep::{Setting, Swept, sweep};
pub use whole::{WholeBench, renders};

/// Rays of each kind whose ids are compared.
const COMPARED: usize = 4096;

/// How to measure.
#[derive(Clone, Copy, Debug)]
pub struct Rounds {
    /// In each, every backend has its turn; at least one.
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
    pub build_s: Figure,
    /// Bytes of the structure per sphere, without the spheres themselves.
    pub bytes_per_sphere: f64,
    /// Rates for each kind of rays, in their order; `None` where there are no such rays.
    pub rates: Vec<Option<Rates>>,
}

/// Rates for one kind of rays, in rays per second of all threads of the current rayon pool together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates {
    /// For the first sphere along each ray.
    pub closest: Figure,
    /// For whether each ray hits anything.
    pub occluded: Figure,
    /// How many of the rays that were compared have another id than with the first backend.
    pub other_ids: usize,
}

impl Rates {
    /// The rate for one question.
    pub fn of(&self, question: Question) -> Figure {
        match question {
            Question::Closest => self.closest,
            Question::Occluded => self.occluded,
        }
    }
}

/// With more spheres than this, brute force is not worth the wait.
pub const MOST_FOR_BRUTE_FORCE: u64 = 10_000;

/// Measures every backend against the others on the current rayon pool.
///
/// # Errors
/// On cancellation.
pub fn bench(
    field: &Field,
    kinds: &[RayKind],
    rounds: Rounds,
    cancel: &Cancel,
) -> Result<Vec<BackendBench>> {
    let set_up = |built| Stand::set_up(built, kinds, rounds.batch);
    let mut stands: Vec<Stand<'_>> = field.built.iter().map(set_up).collect();
    for _ in 0..rounds.count.max(1) {
        for kind in 0..kinds.len() {
            for question in Question::ALL {
                for stand in &mut stands {
                    cancel.check()?;
                    stand.measurements[kind][question as usize].repeat(&*stand.built.accel);
                }
            }
        }
    }
    let spheres = field.spheres.len();
    Ok(stands.iter().map(|stand| stand.result(&stands[0], spheres)).collect())
}

/// A backend with its measurements, for each kind of rays.
struct Stand<'a> {
    built: &'a Built,
    measurements: Vec<[Measurement<'a>; 2]>,
    /// The ids of some rays of each kind.
    ids: Vec<Vec<u32>>,
}

impl<'a> Stand<'a> {
    fn set_up(built: &'a Built, kinds: &'a [RayKind], batch: usize) -> Self {
        let accel = &*built.accel;
        let calibrated = |kind: &'a RayKind| {
            Question::ALL
                .map(|question| Measurement::calibrated(question, &kind.rays, batch, accel))
        };
        let measurements = kinds.iter().map(calibrated).collect();
        let ids = kinds.iter().map(|kind| ids(&spread(&kind.rays, COMPARED), accel)).collect();
        Self { built, measurements, ids }
    }

    fn result(&self, first: &Self, spheres: usize) -> BackendBench {
        let rates = |(kind, [closest, occluded]): (usize, &[Measurement<'_>; 2])| {
            let both = self.ids[kind].iter().zip(&first.ids[kind]);
            let other_ids = both.filter(|(own, first)| own != first).count();
            Some(Rates { closest: closest.rate()?, occluded: occluded.rate()?, other_ids })
        };
        let Built { backend, accel, seconds } = self.built;
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
    use std::sync::Arc;

    use super::*;
    use crate::accel::BuildOptions;
    use crate::geometry::{Sphere, SphereRows, SphereSet};
    use crate::math::{DVec3, NO_SPHERE};

    const ROUNDS: Rounds = Rounds { count: 3, batch: 100 };

    /// Rays that meet some of the spheres of [`field`].
    pub(super) fn rays() -> Vec<Ray> {
        let ray = |i: u32| {
            let origin = DVec3::new(f64::from(i) * 1e-2, 0.0, -9.0);
            Ray::new(origin, DVec3::Z, 0.0, f64::INFINITY, [NO_SPHERE; 2])
        };
        (0..3000).map(ray).collect()
    }

    pub(super) fn field(backends: &[Backend]) -> Field {
        let ball = |i: i32| Sphere { center: DVec3::X * f64::from(i), radius: 0.4 };
        let rows = SphereRows { exact: (0..20).map(ball).collect(), ..SphereRows::default() };
        let spheres = Arc::new(SphereSet::new(rows).expect("few spheres"));
        Field::build(&spheres, backends, &BuildOptions::default(), 2).expect("builds")
    }

    #[test]
    fn every_backend_gets_rates_for_the_rays_there_are() {
        let kind = |name, rays| RayKind { name, rays };
        let kinds = [kind("camera", rays()), kind("none", Vec::new())];
        let backends = [Backend::Native, Backend::BruteForce];
        let results = bench(&field(&backends), &kinds, ROUNDS, &Cancel::default());
        let results = results.expect("nobody cancels");
        assert_eq!(results.iter().map(|result| result.backend).collect::<Vec<_>>(), backends);
        for result in results {
            let [Some(rates), None] = result.rates[..] else { panic!("one kind has rays") };
            for rate in Question::ALL.map(|question| rates.of(question)) {
                assert!(rate.median > 1.0 && rate.median.is_finite());
                assert!(rate.low <= rate.median && rate.median <= rate.high);
            }
            assert_eq!(rates.other_ids, 0);
            assert!(result.build_s.median >= 0.0);
            assert_eq!(result.bytes_per_sphere > 0.0, result.backend == Backend::Native);
        }
    }

    #[test]
    fn it_can_be_cancelled() {
        let kinds = [RayKind { name: CAMERA, rays: rays() }];
        let cancel = Cancel::default();
        cancel.cancel();
        assert!(bench(&field(&[Backend::Native]), &kinds, ROUNDS, &cancel).is_err());
    }
}
