//! Checks every backend against the ground truth, ray by ray: ids, resolved distances and
//! occlusion.

use std::fmt;

use rayon::prelude::*;

use crate::accel::{Accel, ErrorBound};
use crate::error::Result;
use crate::geometry::{PathRay, Side, SphereSet};
use crate::math::{DVec3, Hit, NO_SPHERE, Ray};
use crate::task::CancelToken;

use super::ground_truth::{ExactHit, RayCase, Verdict, covering_precision};

/// Rays per batch, as many as an integrator has in flight.
const BATCH_RAYS: usize = 256;
/// Disagreeing rays kept per backend; any more are only counted.
const MAX_DISAGREEMENTS: usize = 1000;

/// A backend to check.
#[derive(Clone, Copy)]
pub struct TestedBackend<'a> {
    /// Name in the report.
    pub name: &'a str,
    /// Acceleration structure, built over the spheres that are checked.
    pub accel: &'a dyn Accel,
}

/// Result for one backend.
#[derive(Clone, Debug, Default)]
pub struct CrosscheckResult {
    /// Name of the backend, as given by the caller.
    pub name: String,
    /// Error bound that the backend states.
    pub precision: ErrorBound,
    /// Rays traced, each for its closest hit and for occlusion.
    pub rays: usize,
    /// Ids equal to the exact one, including misses.
    pub exact: usize,
    /// Different ids within the backend's error bound.
    pub ambiguous: usize,
    /// Ambiguous hits that resolve to a point behind another sphere, which the path then never
    /// sees.
    pub hidden_hits: usize,
    /// Ids of the wrong sphere, beyond the error bound.
    pub wrong_ids: usize,
    /// Misses, beyond the error bound, where there is an exact hit.
    pub false_misses: usize,
    /// Hits, beyond the error bound, where there is no exact hit.
    pub false_hits: usize,
    /// Resolved distances with an error above the f64 tolerance.
    pub wrong_distances: usize,
    /// Largest error of a resolved distance, relative to the f64 tolerance.
    pub max_distance_error: f64,
    /// Hits on the wrong side of a sphere, where its chord is long enough to tell.
    pub wrong_sides: usize,
    /// Occlusion results that differ from the exact one, within the error bound.
    pub ambiguous_occlusions: usize,
    /// Occlusion results that are wrong beyond the error bound.
    pub wrong_occlusions: usize,
    /// The first wrong rays of any kind, in ray order.
    pub disagreements: Vec<Disagreement>,
}

/// A ray for which a backend is wrong beyond its error bound, with everything needed to trace it
/// again.
#[derive(Clone, Debug)]
pub struct Disagreement {
    /// Name of the backend, as given by the caller.
    pub backend: String,
    /// Kind of disagreement.
    pub mismatch: Mismatch,
    /// The ray, relative to [`SphereSet::origin`].
    pub ray: PathRay,
    /// The backend's hit after [`SphereSet::resolve_hit`]: id and distance.
    pub backend_hit: Option<(u32, f64)>,
    /// The exact hit: id and distance.
    pub exact_hit: Option<(u32, f64)>,
}

/// Kind of disagreement between a backend and the ground truth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mismatch {
    /// First sphere hit.
    Id,
    /// Distance of the hit.
    Distance,
    /// Side of the sphere on which the ray arrives.
    Side,
    /// Occlusion.
    Occlusion,
}

/// Traces every ray with every backend and compares with the ground truth. Returns one result per
/// backend, in order, independent of the number of threads.
///
/// # Errors
/// On cancellation.
pub fn compare(
    spheres: &SphereSet,
    backends: &[TestedBackend<'_>],
    rays: &[PathRay],
    cancel: &CancelToken,
) -> Result<Vec<CrosscheckResult>> {
    let batches: Vec<Vec<CrosscheckResult>> = rays
        .par_chunks(BATCH_RAYS)
        .map(|rays| cancel.check().map(|()| compare_batch(spheres, backends, rays)))
        .collect::<Result<_>>()?;
    let mut results: Vec<CrosscheckResult> = backends.iter().map(CrosscheckResult::new).collect();
    for batch in batches {
        results.iter_mut().zip(batch).for_each(|(result, part)| result.merge(part));
    }
    Ok(results)
}

fn compare_batch(
    spheres: &SphereSet,
    backends: &[TestedBackend<'_>],
    rays: &[PathRay],
) -> Vec<CrosscheckResult> {
    let precision = covering_precision(backends.iter().map(|backend| backend.accel.error_bound()));
    let cases: Vec<RayCase<'_>> =
        rays.iter().map(|ray| RayCase::new(spheres, ray, &precision)).collect();
    let queries: Vec<Ray> = rays.iter().map(|ray| spheres.to_query(ray)).collect();
    let check_backend = |backend: &TestedBackend<'_>| {
        let mut hits = vec![Hit::MISS; rays.len()];
        backend.accel.closest(&queries, &mut hits);
        let mut occluded = vec![false; rays.len()];
        backend.accel.occluded(&queries, &mut occluded);
        let mut result = CrosscheckResult::new(backend);
        for (i, case) in cases.iter().enumerate() {
            let resolved = resolve(spheres, &rays[i], hits[i]);
            result.count(case, &resolved, occluded[i]);
        }
        result
    };
    backends.iter().map(check_backend).collect()
}

/// A hit as an integrator sees it.
struct ResolvedHit {
    /// Sphere that the backend found.
    found: Option<u32>,
    hit: Option<(u32, f64)>,
    side: Option<Side>,
}

/// Resolves a hit. Keeps an invalid id, so that it is reported.
fn resolve(spheres: &SphereSet, ray: &PathRay, hit: Hit) -> ResolvedHit {
    let found = (!hit.is_miss()).then_some(hit.id);
    if found.is_some_and(|id| id as usize >= spheres.len()) {
        return ResolvedHit { found, hit: Some((hit.id, f64::NAN)), side: None };
    }
    let hit = spheres.resolve_hit(ray, hit);
    ResolvedHit { found, hit: hit.map(|hit| (hit.id, hit.t)), side: hit.map(|hit| hit.side) }
}

impl CrosscheckResult {
    fn new(backend: &TestedBackend<'_>) -> Self {
        let precision = backend.accel.error_bound();
        Self { name: backend.name.to_owned(), precision, ..Self::default() }
    }

    /// Number of answers beyond the error bound; 0 if the backend is correct.
    pub fn failures(&self) -> usize {
        let ids = self.wrong_ids + self.false_misses + self.false_hits;
        ids + self.wrong_distances + self.wrong_sides + self.wrong_occlusions
    }

    fn count(&mut self, case: &RayCase<'_>, resolved: &ResolvedHit, occluded: bool) {
        self.rays += 1;
        let exact_hit = case.first_hit().map(|ExactHit { id, t }| (id, t));
        let hit_mismatch = self.count_id(case, resolved).or_else(|| self.count_hit(case, resolved));
        let occlusion_mismatch = self.count_occlusion(case, occluded);
        if let Some(mismatch) = hit_mismatch.or(occlusion_mismatch) {
            if self.disagreements.len() < MAX_DISAGREEMENTS {
                let (backend, ray) = (self.name.clone(), *case.ray());
                let backend_hit = resolved.hit;
                self.disagreements.push(Disagreement {
                    backend,
                    mismatch,
                    ray,
                    backend_hit,
                    exact_hit,
                });
            }
        }
    }

    fn count_id(&mut self, case: &RayCase<'_>, resolved: &ResolvedHit) -> Option<Mismatch> {
        match case.judge_closest(resolved.found, resolved.hit.map(|(id, _)| id), &self.precision) {
            Verdict::Equal => self.exact += 1,
            Verdict::Ambiguous => {
                self.ambiguous += 1;
                let is_hidden = |(id, t)| case.is_hidden(id, t, &self.precision);
                self.hidden_hits += usize::from(resolved.hit.is_some_and(is_hidden));
            }
            Verdict::Wrong => {
                match (resolved.hit, case.first_hit()) {
                    (None, _) => self.false_misses += 1,
                    (_, None) => self.false_hits += 1,
                    _ => self.wrong_ids += 1,
                }
                return Some(Mismatch::Id);
            }
        }
        None
    }

    /// Checks distance and side of a hit whose id is accepted.
    fn count_hit(&mut self, case: &RayCase<'_>, resolved: &ResolvedHit) -> Option<Mismatch> {
        let ((id, t), side) = (resolved.hit?, resolved.side?);
        let error = case.distance_error(id, t);
        self.max_distance_error = self.max_distance_error.max(error);
        if error > 1.0 || error.is_nan() {
            self.wrong_distances += 1;
            return Some(Mismatch::Distance);
        }
        let is_wrong = case.side(id, t).is_some_and(|exact| exact != side);
        self.wrong_sides += usize::from(is_wrong);
        is_wrong.then_some(Mismatch::Side)
    }

    fn count_occlusion(&mut self, case: &RayCase<'_>, occluded: bool) -> Option<Mismatch> {
        let verdict = case.judge_occluded(occluded, &self.precision);
        self.ambiguous_occlusions += usize::from(verdict == Verdict::Ambiguous);
        self.wrong_occlusions += usize::from(verdict == Verdict::Wrong);
        (verdict == Verdict::Wrong).then_some(Mismatch::Occlusion)
    }

    /// Adds the same backend's result on other rays.
    pub fn merge(&mut self, other: Self) {
        self.rays += other.rays;
        self.exact += other.exact;
        self.ambiguous += other.ambiguous;
        self.hidden_hits += other.hidden_hits;
        self.wrong_ids += other.wrong_ids;
        self.false_misses += other.false_misses;
        self.false_hits += other.false_hits;
        self.wrong_distances += other.wrong_distances;
        self.max_distance_error = self.max_distance_error.max(other.max_distance_error);
        self.wrong_sides += other.wrong_sides;
        self.ambiguous_occlusions += other.ambiguous_occlusions;
        self.wrong_occlusions += other.wrong_occlusions;
        let room = MAX_DISAGREEMENTS - self.disagreements.len();
        self.disagreements.extend(other.disagreements.into_iter().take(room));
    }
}

/// Formats one line of a dump. Decimal numbers are the shortest that read back as the same f64.
impl fmt::Display for Disagreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { backend, mismatch, ray, .. } = self;
        let vector = |v: DVec3| format!("{:?} {:?} {:?}", v.x, v.y, v.z);
        let sphere = |id: u32| if id == NO_SPHERE { "none".to_owned() } else { id.to_string() };
        let hit = |hit: Option<(u32, f64)>| {
            hit.map_or("miss".to_owned(), |(id, t)| format!("{id} at {t:?}"))
        };
        let mismatch = match mismatch {
            Mismatch::Id => "id",
            Mismatch::Distance => "distance",
            Mismatch::Side => "side",
            Mismatch::Occlusion => "occlusion",
        };
        write!(
            f,
            "{backend} {mismatch}: origin {} direction {} t_min {:?} t_max {:?} origin_sphere {} target_sphere {} \
             t_exit {:?} backend_hit {} exact_hit {}",
            vector(ray.origin),
            vector(ray.direction),
            ray.t_min,
            ray.t_max,
            sphere(ray.origin_sphere),
            sphere(ray.target_sphere),
            ray.t_exit,
            hit(self.backend_hit),
            hit(self.exact_hit),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{Backend, BuildOptions};
    use crate::geometry::{Sphere, SphereRows};
    use crate::verify::rays;
    use std::sync::Arc;

    /// A backend with an injected fault.
    struct FaultyAccel {
        correct: Box<dyn Accel>,
        alter_ray: fn(&mut Ray),
        alter_hit: fn(&mut Hit),
        alter_occlusion: fn(&mut bool),
    }

    impl Accel for FaultyAccel {
        fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
            self.correct.closest(&self.faulty(rays), hits);
            hits.iter_mut().for_each(self.alter_hit);
        }

        fn occluded(&self, rays: &[Ray], occluded: &mut [bool]) {
            self.correct.occluded(&self.faulty(rays), occluded);
            occluded.iter_mut().for_each(self.alter_occlusion);
        }

        fn error_bound(&self) -> ErrorBound {
            ErrorBound { particles: 16.0, giants: 16.0, rounds_origin: true }
        }

        fn bytes(&self) -> usize {
            self.correct.bytes()
        }
    }

    impl FaultyAccel {
        fn faulty(&self, rays: &[Ray]) -> Vec<Ray> {
            let mut rays = rays.to_vec();
            rays.iter_mut().for_each(self.alter_ray);
            rays
        }
    }

    fn spheres() -> Arc<SphereSet> {
        let ball = |i: u32| Sphere {
            center: DVec3::new(f64::from(i % 5), f64::from(i / 5 % 5), f64::from(i / 25)),
            radius: 0.4,
        };
        let rows = SphereRows { exact: (0..125).map(ball).collect(), table: Vec::new() };
        Arc::new(SphereSet::new(rows).expect("few spheres"))
    }

    fn result(
        alter_ray: fn(&mut Ray),
        alter_hit: fn(&mut Hit),
        alter_occlusion: fn(&mut bool),
    ) -> CrosscheckResult {
        let spheres = spheres();
        let correct =
            Backend::BruteForce.build(&spheres, &BuildOptions::default()).expect("builds");
        let faulty = FaultyAccel { correct, alter_ray, alter_hit, alter_occlusion };
        let backend = TestedBackend { name: "broken", accel: &faulty };
        let rays = rays::random(&spheres, 3000, 7);
        compare(&spheres, &[backend], &rays, &CancelToken::default())
            .expect("not cancelled")
            .remove(0)
    }

    #[test]
    fn a_sound_backend_has_no_failures() {
        let correct = result(|_| (), |_| (), |_| ());
        assert_eq!((correct.rays, correct.failures()), (3000, 0));
        assert!(correct.exact > 2800 && correct.disagreements.is_empty());
    }

    #[test]
    fn every_kind_of_fault_is_found_and_named() {
        let lost = result(|_| (), |hit| *hit = Hit::MISS, |_| ());
        assert!(lost.false_misses > 1000 && lost.wrong_ids + lost.false_hits == 0);
        let ghosts = result(|_| (), |hit| hit.id = 0, |_| ());
        assert!(ghosts.false_hits > 100 && ghosts.wrong_ids > 1000 && ghosts.false_misses == 0);
        let shifted = result(|ray| ray.origin[0] += 1e-3, |_| (), |_| ());
        assert!(shifted.failures() > 10);
        let blind = result(|_| (), |_| (), |occluded| *occluded = !*occluded);
        assert!(blind.wrong_occlusions > 2800 && blind.wrong_ids + blind.false_misses == 0);
        let unknown = result(|_| (), |hit| hit.id = 4_000_000, |_| ());
        assert_eq!(unknown.wrong_ids + unknown.false_hits, 3000);
    }

    #[test]
    fn a_dumped_line_reads_back_to_the_same_ray() {
        let lost = result(|_| (), |hit| *hit = Hit::MISS, |_| ());
        let disagreement = &lost.disagreements[0];
        let line = disagreement.to_string();
        let numbers: Vec<f64> = line.split(' ').filter_map(|word| word.parse().ok()).collect();
        assert_eq!(numbers[..3], disagreement.ray.origin.to_array());
        assert_eq!(numbers[3..6], disagreement.ray.direction.to_array());
        assert!(
            line.starts_with("broken id: origin ") && line.contains("backend_hit miss exact_hit")
        );
    }

    #[test]
    fn a_request_to_stop_is_an_error() {
        let spheres = spheres();
        let cancel = CancelToken::default();
        cancel.cancel();
        assert!(compare(&spheres, &[], &rays::random(&spheres, 9, 1), &cancel).is_err());
    }
}
