//! Every backend against the judge, ray by ray: the ids, the resolved distances and the occlusions.

use std::fmt;

use rayon::prelude::*;

use crate::accel::{Accel, Cancel, Precision};
use crate::error::Result;
use crate::geometry::{PathRay, SphereSet, SurfaceHit};
use crate::math::{DVec3, Hit, NO_SPHERE, Ray};

use super::judge::{Case, First, Verdict, widest};

/// Rays asked in one batch, as many as an integrator has in flight.
const BATCH: usize = 256;
/// Disagreeing rays kept for each backend; the rest are only counted.
const KEPT: usize = 1000;

/// A backend to be checked.
#[derive(Clone, Copy)]
pub struct Contender<'a> {
    /// What the report calls it.
    pub name: &'a str,
    /// Built from the very spheres that are checked.
    pub accel: &'a dyn Accel,
}

/// How one backend fared.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// What the caller called the backend.
    pub name: String,
    /// Rays asked, each for its first hit and for occlusion.
    pub rays: usize,
    /// Ids equal to the judge's, misses included.
    pub equal: usize,
    /// Other ids, within the backend's stated error.
    pub ambiguous: usize,
    /// Ids of another sphere than the judge's, beyond the stated error.
    pub wrong: usize,
    /// Misses, beyond the stated error, where the judge sees a sphere.
    pub lost: usize,
    /// Hits, beyond the stated error, where the judge sees none.
    pub ghosts: usize,
    /// Resolved distances that are off by more than f64 is allowed.
    pub wrong_distances: usize,
    /// The largest error of a resolved distance, in units of what is allowed.
    pub largest_distance_error: f64,
    /// Occlusions other than the judge's, within the stated error.
    pub ambiguous_occlusions: usize,
    /// Occlusions beyond it.
    pub wrong_occlusions: usize,
    /// The first rays of those that are wrong in any way, in the order of the rays.
    pub disagreements: Vec<Disagreement>,
}

/// A ray that a backend answered beyond its stated error, with all that is needed to ask it again.
#[derive(Clone, Debug)]
pub struct Disagreement {
    /// What the caller called the backend.
    pub backend: String,
    /// In what they disagree.
    pub about: Disputed,
    /// The ray, relative to [`SphereSet::origin`].
    pub ray: PathRay,
    /// The backend's answer after [`SphereSet::answer`]: id and distance.
    pub answered: Option<(u32, f64)>,
    /// The judge's answer.
    pub judged: Option<(u32, f64)>,
}

/// In what a backend and the judge disagree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Disputed {
    /// Which sphere is hit first.
    Id,
    /// How far away it is.
    Distance,
    /// Whether anything is hit.
    Occlusion,
}

/// Asks every contender about every ray and compares with the judge. One tally for each contender,
/// in their order, independent of the number of threads.
///
/// # Errors
/// On cancellation.
pub fn compare(
    spheres: &SphereSet,
    contenders: &[Contender<'_>],
    rays: &[PathRay],
    cancel: &Cancel,
) -> Result<Vec<Tally>> {
    let batches: Vec<Vec<Tally>> = rays
        .par_chunks(BATCH)
        .map(|rays| cancel.check().map(|()| compare_batch(spheres, contenders, rays)))
        .collect::<Result<_>>()?;
    let named = |contender: &Contender<'_>| Tally::of(contender.name);
    let mut tallies: Vec<Tally> = contenders.iter().map(named).collect();
    for batch in batches {
        tallies.iter_mut().zip(batch).for_each(|(tally, part)| tally.add(part));
    }
    Ok(tallies)
}

fn compare_batch(
    spheres: &SphereSet,
    contenders: &[Contender<'_>],
    rays: &[PathRay],
) -> Vec<Tally> {
    let precision = widest(contenders.iter().map(|contender| contender.accel.precision()));
    let cases: Vec<Case<'_>> = rays.iter().map(|ray| Case::new(spheres, ray, &precision)).collect();
    let asked: Vec<Ray> = rays.iter().map(|ray| spheres.ask(ray)).collect();
    let judged = |contender: &Contender<'_>| {
        let mut hits = vec![Hit::MISS; rays.len()];
        contender.accel.closest(&asked, &mut hits);
        let mut blocked = vec![false; rays.len()];
        contender.accel.occluded(&asked, &mut blocked);
        let precision = contender.accel.precision();
        let mut tally = Tally::of(contender.name);
        for (i, case) in cases.iter().enumerate() {
            let answer = answer_of(spheres, &rays[i], hits[i]);
            tally.count(case, &rays[i], answer, blocked[i], &precision);
        }
        tally
    };
    contenders.iter().map(judged).collect()
}

/// The answer as an integrator sees it; an id that does not exist stays visible.
fn answer_of(spheres: &SphereSet, ray: &PathRay, hit: Hit) -> Option<(u32, f64)> {
    if !hit.is_miss() && hit.id as usize >= spheres.len() {
        return Some((hit.id, f64::NAN));
    }
    spheres.answer(ray, hit).map(|SurfaceHit { id, t, .. }| (id, t))
}

impl Tally {
    fn of(name: &str) -> Self {
        Self { name: name.to_owned(), ..Self::default() }
    }

    /// Everything that is beyond what was stated; 0 if the backend is right.
    pub fn failures(&self) -> usize {
        self.wrong + self.lost + self.ghosts + self.wrong_distances + self.wrong_occlusions
    }

    /// The share of rays whose id differs from the judge's within the stated error.
    pub fn ambiguous_share(&self) -> f64 {
        self.ambiguous as f64 / self.rays.max(1) as f64
    }

    fn count(
        &mut self,
        case: &Case<'_>,
        ray: &PathRay,
        answer: Option<(u32, f64)>,
        blocked: bool,
        precision: &Precision,
    ) {
        self.rays += 1;
        let judged = case.first().map(|First { id, t }| (id, t));
        let mut disputed = None;
        match case.judge_closest(answer.map(|(id, _)| id), precision) {
            Verdict::Equal => self.equal += 1,
            Verdict::Ambiguous => self.ambiguous += 1,
            Verdict::Wrong => {
                disputed = Some(Disputed::Id);
                match (answer, judged) {
                    (None, _) => self.lost += 1,
                    (_, None) => self.ghosts += 1,
                    _ => self.wrong += 1,
                }
            }
        }
        if let (Some((id, t)), None) = (answer, disputed) {
            let error = case.distance_error(id, t);
            self.largest_distance_error = self.largest_distance_error.max(error);
            if error > 1.0 || error.is_nan() {
                self.wrong_distances += 1;
                disputed = Some(Disputed::Distance);
            }
        }
        match case.judge_occluded(blocked, precision) {
            Verdict::Equal => {}
            Verdict::Ambiguous => self.ambiguous_occlusions += 1,
            Verdict::Wrong => {
                self.wrong_occlusions += 1;
                disputed = disputed.or(Some(Disputed::Occlusion));
            }
        }
        if let Some(about) = disputed.filter(|_| self.disagreements.len() < KEPT) {
            let backend = self.name.clone();
            let ray = *ray;
            self.disagreements.push(Disagreement { backend, about, ray, answered: answer, judged });
        }
    }

    fn add(&mut self, other: Self) {
        self.rays += other.rays;
        self.equal += other.equal;
        self.ambiguous += other.ambiguous;
        self.wrong += other.wrong;
        self.lost += other.lost;
        self.ghosts += other.ghosts;
        self.wrong_distances += other.wrong_distances;
        self.largest_distance_error = self.largest_distance_error.max(other.largest_distance_error);
        self.ambiguous_occlusions += other.ambiguous_occlusions;
        self.wrong_occlusions += other.wrong_occlusions;
        let room = KEPT - self.disagreements.len();
        self.disagreements.extend(other.disagreements.into_iter().take(room));
    }
}

/// One line of a dump. Decimal numbers are the shortest that read back as the same f64.
impl fmt::Display for Disagreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { backend, about, ray, .. } = self;
        let vector = |v: DVec3| format!("{:?} {:?} {:?}", v.x, v.y, v.z);
        let sphere = |id: u32| if id == NO_SPHERE { "none".to_owned() } else { id.to_string() };
        let hit = |hit: Option<(u32, f64)>| {
            hit.map_or("miss".to_owned(), |(id, t)| format!("{id} at {t:?}"))
        };
        let about = match about {
            Disputed::Id => "id",
            Disputed::Distance => "distance",
            Disputed::Occlusion => "occlusion",
        };
        write!(
            f,
            "{backend} {about}: origin {} direction {} t_min {:?} t_max {:?} leaves {} aims_at {} \
             far_wall {:?} answered {} judged {}",
            vector(ray.origin),
            vector(ray.direction),
            ray.t_min,
            ray.t_max,
            sphere(ray.leaves),
            sphere(ray.aims_at),
            ray.far_wall,
            hit(self.answered),
            hit(self.judged),
        )
    }
}
