//! Every backend against the judge, ray by ray: the ids, the resolved distances and the occlusions.

use std::fmt;

use rayon::prelude::*;

use crate::accel::{Accel, Precision};
use crate::error::Result;
use crate::geometry::{PathRay, Side, SphereSet};
use crate::math::{DVec3, Hit, NO_SPHERE, Ray};
use crate::task::Cancel;

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
    /// What the backend states of its error.
    pub precision: Precision,
    /// Rays asked, each for its first hit and for occlusion.
    pub rays: usize,
    /// Ids equal to the judge's, misses included.
    pub equal: usize,
    /// Other ids, within the backend's stated error.
    pub ambiguous: usize,
    /// Those among the ambiguous that resolve to a point behind another sphere, which the path then
    /// never sees.
    pub passed_over: usize,
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
    /// Sides of a sphere arrived at other than the judge's, where its chord is long enough to tell.
    pub wrong_sides: usize,
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
    /// Which side of the sphere it arrives at.
    Side,
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
    let mut tallies: Vec<Tally> = contenders.iter().map(Tally::of).collect();
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
        let mut tally = Tally::of(contender);
        for (i, case) in cases.iter().enumerate() {
            let answer = answer_of(spheres, &rays[i], hits[i]);
            tally.count(case, &answer, blocked[i]);
        }
        tally
    };
    contenders.iter().map(judged).collect()
}

/// The answer as an integrator sees it.
struct Answer {
    /// The sphere that the backend found.
    found: Option<u32>,
    hit: Option<(u32, f64)>,
    side: Option<Side>,
}

/// An id that does not exist stays visible.
fn answer_of(spheres: &SphereSet, ray: &PathRay, hit: Hit) -> Answer {
    let found = (!hit.is_miss()).then_some(hit.id);
    if found.is_some_and(|id| id as usize >= spheres.len()) {
        return Answer { found, hit: Some((hit.id, f64::NAN)), side: None };
    }
    let hit = spheres.answer(ray, hit);
    Answer { found, hit: hit.map(|hit| (hit.id, hit.t)), side: hit.map(|hit| hit.side) }
}

impl Tally {
    fn of(contender: &Contender<'_>) -> Self {
        let precision = contender.accel.precision();
        Self { name: contender.name.to_owned(), precision, ..Self::default() }
    }

    /// Everything that is beyond what was stated; 0 if the backend is right.
    pub fn failures(&self) -> usize {
        let ids = self.wrong + self.lost + self.ghosts;
        ids + self.wrong_distances + self.wrong_sides + self.wrong_occlusions
    }

    /// The share of rays whose id differs from the judge's within the stated error.
    pub fn ambiguous_share(&self) -> f64 {
        self.ambiguous as f64 / self.rays.max(1) as f64
    }

    fn count(&mut self, case: &Case<'_>, answer: &Answer, blocked: bool) {
        self.rays += 1;
        let judged = case.first().map(|First { id, t }| (id, t));
        let about_hit = self.count_id(case, answer).or_else(|| self.count_hit(case, answer));
        let about_occlusion = self.count_occlusion(case, blocked);
        if let Some(about) = about_hit.or(about_occlusion) {
            if self.disagreements.len() < KEPT {
                let (backend, ray) = (self.name.clone(), *case.ray());
                let answered = answer.hit;
                self.disagreements.push(Disagreement { backend, about, ray, answered, judged });
            }
        }
    }

    fn count_id(&mut self, case: &Case<'_>, answer: &Answer) -> Option<Disputed> {
        match case.judge_closest(answer.found, answer.hit.map(|(id, _)| id), &self.precision) {
            Verdict::Equal => self.equal += 1,
            Verdict::Ambiguous => {
                self.ambiguous += 1;
                let passes = |(id, t)| case.is_passed_over(id, t, &self.precision);
                self.passed_over += usize::from(answer.hit.is_some_and(passes));
            }
            Verdict::Wrong => {
                match (answer.hit, case.first()) {
                    (None, _) => self.lost += 1,
                    (_, None) => self.ghosts += 1,
                    _ => self.wrong += 1,
                }
                return Some(Disputed::Id);
            }
        }
        None
    }

    /// Distance and side of a hit whose id is accepted.
    fn count_hit(&mut self, case: &Case<'_>, answer: &Answer) -> Option<Disputed> {
        let ((id, t), side) = (answer.hit?, answer.side?);
        let error = case.distance_error(id, t);
        self.largest_distance_error = self.largest_distance_error.max(error);
        if error > 1.0 || error.is_nan() {
            self.wrong_distances += 1;
            return Some(Disputed::Distance);
        }
        let is_wrong = case.side(id, t).is_some_and(|judged| judged != side);
        self.wrong_sides += usize::from(is_wrong);
        is_wrong.then_some(Disputed::Side)
    }

    fn count_occlusion(&mut self, case: &Case<'_>, blocked: bool) -> Option<Disputed> {
        let verdict = case.judge_occluded(blocked, &self.precision);
        self.ambiguous_occlusions += usize::from(verdict == Verdict::Ambiguous);
        self.wrong_occlusions += usize::from(verdict == Verdict::Wrong);
        (verdict == Verdict::Wrong).then_some(Disputed::Occlusion)
    }

    /// Adds what the same backend did on other rays.
    pub fn add(&mut self, other: Self) {
        self.rays += other.rays;
        self.equal += other.equal;
        self.ambiguous += other.ambiguous;
        self.passed_over += other.passed_over;
        self.wrong += other.wrong;
        self.lost += other.lost;
        self.ghosts += other.ghosts;
        self.wrong_distances += other.wrong_distances;
        self.largest_distance_error = self.largest_distance_error.max(other.largest_distance_error);
        self.wrong_sides += other.wrong_sides;
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
            Disputed::Side => "side",
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{Backend, BuildOptions};
    use crate::geometry::{Sphere, SphereRows};
    use crate::verify::rays;
    use std::sync::Arc;

    /// A backend with a fault of choice.
    struct Broken {
        sound: Box<dyn Accel>,
        break_ray: fn(&mut Ray),
        break_hit: fn(&mut Hit),
        break_occlusion: fn(&mut bool),
    }

    impl Accel for Broken {
        fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
            self.sound.closest(&self.broken(rays), hits);
            hits.iter_mut().for_each(self.break_hit);
        }

        fn occluded(&self, rays: &[Ray], blocked: &mut [bool]) {
            self.sound.occluded(&self.broken(rays), blocked);
            blocked.iter_mut().for_each(self.break_occlusion);
        }

        fn precision(&self) -> Precision {
            Precision { particles: 16.0, giants: 16.0, rounds_origin: true }
        }

        fn bytes(&self) -> usize {
            self.sound.bytes()
        }
    }

    impl Broken {
        fn broken(&self, rays: &[Ray]) -> Vec<Ray> {
            let mut rays = rays.to_vec();
            rays.iter_mut().for_each(self.break_ray);
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

    fn tally(
        break_ray: fn(&mut Ray),
        break_hit: fn(&mut Hit),
        break_occlusion: fn(&mut bool),
    ) -> Tally {
        let spheres = spheres();
        let sound = Backend::BruteForce.build(&spheres, &BuildOptions::default()).expect("builds");
        let broken = Broken { sound, break_ray, break_hit, break_occlusion };
        let contender = Contender { name: "broken", accel: &broken };
        let rays = rays::random(&spheres, 3000, 7);
        compare(&spheres, &[contender], &rays, &Cancel::default()).expect("not cancelled").remove(0)
    }

    #[test]
    fn a_sound_backend_has_no_failures() {
        let sound = tally(|_| (), |_| (), |_| ());
        assert_eq!((sound.rays, sound.failures()), (3000, 0));
        assert!(sound.equal > 2800 && sound.disagreements.is_empty());
    }

    #[test]
    fn every_kind_of_fault_is_found_and_named() {
        let lost = tally(|_| (), |hit| *hit = Hit::MISS, |_| ());
        assert!(lost.lost > 1000 && lost.wrong + lost.ghosts == 0);
        let ghosts = tally(|_| (), |hit| hit.id = 0, |_| ());
        assert!(ghosts.ghosts > 100 && ghosts.wrong > 1000 && ghosts.lost == 0);
        let shifted = tally(|ray| ray.origin[0] += 1e-3, |_| (), |_| ());
        assert!(shifted.failures() > 10);
        let blind = tally(|_| (), |_| (), |blocked| *blocked = !*blocked);
        assert!(blind.wrong_occlusions > 2800 && blind.wrong + blind.lost == 0);
        let unknown = tally(|_| (), |hit| hit.id = 4_000_000, |_| ());
        assert_eq!(unknown.wrong + unknown.ghosts, 3000);
    }

    #[test]
    fn a_dumped_line_reads_back_to_the_same_ray() {
        let lost = tally(|_| (), |hit| *hit = Hit::MISS, |_| ());
        let disagreement = &lost.disagreements[0];
        let line = disagreement.to_string();
        let numbers: Vec<f64> = line.split(' ').filter_map(|word| word.parse().ok()).collect();
        assert_eq!(numbers[..3], disagreement.ray.origin.to_array());
        assert_eq!(numbers[3..6], disagreement.ray.direction.to_array());
        assert!(line.starts_with("broken id: origin ") && line.contains("answered miss judged"));
    }

    #[test]
    fn a_request_to_stop_is_an_error() {
        let spheres = spheres();
        let cancel = Cancel::default();
        cancel.cancel();
        assert!(compare(&spheres, &[], &rays::random(&spheres, 9, 1), &cancel).is_err());
    }
}
