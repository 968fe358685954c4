//! Ground truth for the backends: decides in higher precision than f64, and by a different formula,
//! which sphere a ray hits first, and if a backend's different answer is within its error bound.
//!
//! # The rule
//! A backend states a *backward* error ([`ErrorBound`]): its answer is exact for spheres whose
//! radius was changed by at most
//!
//! `e = k 2^-24 (|o - c| + R) + |o - o'|`,
//!
//! where `o'` is the origin that it traces from. A backend that traces from an origin rounded to
//! f32 also traverses boxes rounded to f32, at the scale of `|c|`, which is at most `|o| + |o -
//! c|`; it is allowed another `2^-24 |o|`. So each sphere has, besides its exact first hit, a set
//! of *possible* first hits, one for each radius in `[R - e, R + e]`. Its hit is *certain* if every
//! such radius gives one. An answer B is accepted if B has a possible hit and no other sphere has a
//! certain hit that lies before B's earliest possible one whatever the radius. A miss is accepted
//! if no sphere has a certain hit. The exit point of a ray's origin sphere is part of the ray and
//! exact. An accepted answer that is not the exact one is *ambiguous*: a silhouette or another
//! sphere lies within the band.
//!
//! No tree is involved: a linear, conservative f64 pass over all spheres selects the candidates for
//! double-double arithmetic.

use twofloat::TwoFloat;

use crate::accel::ErrorBound;
use crate::geometry::{PathRay, Roots, Side, Sphere, SphereSet};
use crate::math::{DVec3, F32_UNIT_ROUNDOFF};

use super::double_double::ClosestApproach;

/// A ray's ends are rounded outwards to f32 for a backend, by at most this relative error.
const INTERVAL_ROUNDING: f64 = 2.0 * F32_UNIT_ROUNDOFF;

/// Verdict on a backend's answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The exact answer.
    Equal,
    /// A different answer within the backend's error bound.
    Ambiguous,
    /// A wrong answer, beyond the error bound.
    Wrong,
}

/// The exact first hit.
#[derive(Clone, Copy, Debug)]
pub struct ExactHit {
    /// Sphere index. If the ray reaches its exit point from its origin sphere, the index of that
    /// sphere.
    pub id: u32,
    /// Distance along the ray, rounded to f64.
    pub t: f64,
}

/// The exact hits and the candidates of one ray.
#[derive(Debug)]
pub struct RayCase<'a> {
    spheres: &'a SphereSet,
    ray: &'a PathRay,
    candidates: Vec<Candidate>,
    first_hit: Option<ExactHit>,
    occluded: bool,
    origin_errors: [f64; 2],
}

/// A sphere that some error bound allows to be hit.
#[derive(Debug)]
struct Candidate {
    id: u32,
    sphere: Sphere,
    approach: ClosestApproach,
}

/// First hits of one sphere over all radii of its band.
struct HitInterval {
    /// Earliest first hit over the radii.
    earliest_possible: Option<TwoFloat>,
    /// Latest first hit over the radii, if every radius gives one.
    latest_certain: Option<TwoFloat>,
}

/// Both roots of a line and a sphere, computed in double-double and rounded to f64; `None` if the
/// line misses.
pub fn roots(origin: DVec3, direction: DVec3, sphere: &Sphere) -> Option<Roots> {
    let approach = ClosestApproach::new(origin, direction, sphere);
    let h = approach.half_chord(TwoFloat::from(sphere.radius))?;
    Some(Roots { near: (approach.t - h).hi(), far: (approach.t + h).hi() })
}

/// Returns the error bound that covers all of those given.
pub fn covering_precision(precisions: impl IntoIterator<Item = ErrorBound>) -> ErrorBound {
    precisions.into_iter().fold(ErrorBound::default(), |a, b| ErrorBound {
        particles: a.particles.max(b.particles),
        giants: a.giants.max(b.giants),
        rounds_origin: a.rounds_origin || b.rounds_origin,
    })
}

impl<'a> RayCase<'a> {
    /// Finds the exact hits and the candidates of a ray. `max_bound` must cover the error bound of
    /// every backend to be judged.
    pub fn new(spheres: &'a SphereSet, ray: &'a PathRay, max_bound: &ErrorBound) -> Self {
        let mut case = Self {
            spheres,
            ray,
            candidates: Vec::new(),
            first_hit: None,
            occluded: false,
            origin_errors: origin_errors(ray.origin),
        };
        case.find_candidates(max_bound);
        case.find_first_hit();
        case
    }

    /// The ray.
    pub fn ray(&self) -> &'a PathRay {
        self.ray
    }

    /// The exact first hit; `None` for a miss.
    pub fn first_hit(&self) -> Option<ExactHit> {
        self.first_hit
    }

    /// Returns true if any sphere lies between the ray's ends. The exit point from the origin
    /// sphere is an end, not an occluder.
    pub fn occluded(&self) -> bool {
        self.occluded
    }

    /// Judges a backend's closest hit: the sphere `found` (`None` for a miss) and the sphere
    /// `resolved` by [`SphereSet::resolve_hit`], which may be the origin sphere instead.
    pub fn judge_closest(
        &self,
        found: Option<u32>,
        resolved: Option<u32>,
        precision: &ErrorBound,
    ) -> Verdict {
        if resolved == self.first_hit.map(|first| first.id) {
            return Verdict::Equal;
        }
        let exit = (self.ray.t_exit < self.ray.t_max).then_some(self.ray.t_exit.into());
        let earliest = match found {
            None => exit,
            Some(id) => match self.earliest_possible_hit(id, precision) {
                Some(t) => Some(t),
                None => return Verdict::Wrong,
            },
        };
        let is_wrong = match earliest {
            Some(earliest) => {
                self.is_behind_other(found, earliest, precision)
                    || exit.is_some_and(|exit| exit < earliest)
            }
            None => self.has_certain_hit(precision),
        };
        if is_wrong { Verdict::Wrong } else { Verdict::Ambiguous }
    }

    /// Returns true if a point on sphere `id` at distance `t` lies behind another sphere whatever
    /// the radii. This happens for some ambiguous answers: a sphere that the ray starts just inside
    /// of, and that an f32 backend hits from outside at once, resolves to its far root.
    pub fn is_hidden(&self, id: u32, t: f64, precision: &ErrorBound) -> bool {
        self.is_behind_other(Some(id), t.into(), precision)
    }

    /// Judges a backend's occlusion result.
    pub fn judge_occluded(&self, occluded: bool, precision: &ErrorBound) -> Verdict {
        let mut intervals =
            self.candidates.iter().map(|candidate| self.hit_interval(candidate, precision));
        let accepted = match occluded {
            _ if occluded == self.occluded => return Verdict::Equal,
            true => intervals.any(|interval| interval.earliest_possible.is_some()),
            false => !self.has_certain_hit(precision),
        };
        if accepted { Verdict::Ambiguous } else { Verdict::Wrong }
    }

    /// Error of a resolved distance, relative to the f64 tolerance: at most 1 if correct.
    ///
    /// With `s = |o - c| + R` and `h` half the chord, the tolerance is `8 eps s (1 + |o - c| / h)`.
    /// At a tangent `h` is itself the root of a rounding error, and the tolerance is `d + sqrt(2 (R
    /// + d) d)` with `d = 8 eps s`: the effect of changing the radius by `d` on a chord of length
    /// 0. The exit point is part of the ray and must come back unchanged.
    pub fn distance_error(&self, id: u32, t: f64) -> f64 {
        if id == self.ray.origin_sphere {
            return if t == self.ray.t_exit { 0.0 } else { f64::INFINITY };
        }
        let sphere = self.written(id);
        let approach = ClosestApproach::new(self.ray.origin, self.ray.direction, &sphere);
        let half_chord = approach.half_chord(TwoFloat::from(sphere.radius));
        let tolerance = distance_tolerance(self.ray.origin, &sphere, half_chord.map(|h| h.hi()));
        let h = half_chord.unwrap_or(TwoFloat::from(0.0));
        let error = |root: TwoFloat| {
            let expected = if root < self.ray.t_min { self.ray.t_min.into() } else { root };
            ((expected - t).abs().hi()) / tolerance
        };
        let (near, far) = (approach.t - h, approach.t + h);
        // If the near root equals t_min within rounding, either root is correct.
        let gap = (near - self.ray.t_min).hi();
        match () {
            () if gap.abs() <= tolerance => error(near).min(error(far)),
            () if gap > 0.0 => error(near),
            () => error(far),
        }
    }

    /// Side on which the ray arrives at a sphere at the resolved distance `t`; `None` if the chord
    /// is too short for f64 to tell. An exit point is always reached from inside.
    pub fn side(&self, id: u32, t: f64) -> Option<Side> {
        if id == self.ray.origin_sphere {
            return Some(Side::Inside);
        }
        let sphere = self.written(id);
        let approach = ClosestApproach::new(self.ray.origin, self.ray.direction, &sphere);
        let h = approach.half_chord(TwoFloat::from(sphere.radius))?.hi();
        let can_tell = h > 2.0 * distance_tolerance(self.ray.origin, &sphere, Some(h));
        can_tell.then(|| if approach.t < t { Side::Inside } else { Side::Outside })
    }

    /// The sphere as the user wrote it: the judge does not read what the backends read.
    fn written(&self, id: u32) -> Sphere {
        self.spheres.sphere_as_written(id).relative_to(self.spheres.origin())
    }

    fn find_candidates(&mut self, max_bound: &ErrorBound) {
        let prefilter = Prefilter::new(self.ray);
        let mut t_limit = self.t_end() * (1.0 + 2.0 * INTERVAL_ROUNDING);
        for id in 0..self.spheres.len() as u32 {
            let sphere = self.written(id);
            let error = self.radius_error(id, &sphere, max_bound);
            if id == self.ray.origin_sphere
                || id == self.ray.target_sphere
                || !prefilter.may_hit(&sphere, error, t_limit)
            {
                continue;
            }
            let approach = ClosestApproach::new(self.ray.origin, self.ray.direction, &sphere);
            let candidate = Candidate { id, sphere, approach };
            if let Some(t) = self.hit_interval(&candidate, max_bound).latest_certain {
                t_limit = t_limit.min(t.hi() * (1.0 + f64::EPSILON));
            }
            self.candidates.push(candidate);
        }
    }

    fn find_first_hit(&mut self) {
        let mut first: Option<(u32, TwoFloat)> = None;
        for candidate in &self.candidates {
            let nearest = |&t: &TwoFloat| first.is_none_or(|(_, nearest)| t < nearest);
            if let Some(t) = self.exact_hit(candidate).filter(nearest) {
                first = Some((candidate.id, t));
            }
        }
        self.occluded = first.is_some();
        self.first_hit = match first {
            Some((id, t)) => Some(ExactHit { id, t: t.hi() }),
            None if self.ray.t_exit < self.ray.t_max => {
                Some(ExactHit { id: self.ray.origin_sphere, t: self.ray.t_exit })
            }
            None => None,
        };
    }

    /// Where the ray ends if it hits no other sphere.
    fn t_end(&self) -> f64 {
        self.ray.t_max.min(self.ray.t_exit)
    }

    fn exact_hit(&self, Candidate { sphere, approach, .. }: &Candidate) -> Option<TwoFloat> {
        let h = approach.half_chord(TwoFloat::from(sphere.radius))?;
        let near = approach.t - h;
        let root = if near > self.ray.t_min { near } else { approach.t + h };
        (root > self.ray.t_min && root < self.t_end()).then_some(root)
    }

    fn is_behind_other(&self, id: Option<u32>, t: TwoFloat, precision: &ErrorBound) -> bool {
        let others = self.candidates.iter().filter(|candidate| Some(candidate.id) != id);
        others
            .filter_map(|other| self.hit_interval(other, precision).latest_certain)
            .any(|latest| latest < t)
    }

    fn has_certain_hit(&self, precision: &ErrorBound) -> bool {
        self.candidates
            .iter()
            .any(|candidate| self.hit_interval(candidate, precision).latest_certain.is_some())
    }

    fn earliest_possible_hit(&self, id: u32, precision: &ErrorBound) -> Option<TwoFloat> {
        let candidate = self.candidates.iter().find(|candidate| candidate.id == id)?;
        self.hit_interval(candidate, precision).earliest_possible
    }

    /// Bound on the backend's error in the sphere's radius.
    fn radius_error(&self, id: u32, sphere: &Sphere, precision: &ErrorBound) -> f64 {
        let is_particle = (id as usize) < self.spheres.particle_count();
        let k = if is_particle { precision.particles } else { precision.giants };
        let scale = self.ray.origin.distance(sphere.center) + sphere.radius;
        let [split, rounded] = self.origin_errors;
        k * F32_UNIT_ROUNDOFF * scale + if precision.rounds_origin { rounded } else { split }
    }

    fn hit_interval(&self, candidate: &Candidate, precision: &ErrorBound) -> HitInterval {
        let error = self.radius_error(candidate.id, &candidate.sphere, precision);
        HitInterval {
            earliest_possible: self.earliest_in_band(candidate, error),
            latest_certain: self.latest_in_band(candidate, error),
        }
    }

    /// The earliest hit over all radii in the band. The near root moves towards the origin as the
    /// radius grows, the far root away from it. A far root is first only for the radii whose near
    /// root lies at or before `t_min`.
    fn earliest_in_band(&self, candidate: &Candidate, error: f64) -> Option<TwoFloat> {
        let Candidate { sphere, approach, .. } = candidate;
        let t_min = self.ray.t_min * (1.0 - INTERVAL_ROUNDING);
        let t_max = self.t_end() * (1.0 + INTERVAL_ROUNDING);
        let widest = approach.half_chord(TwoFloat::new_add(sphere.radius, error))?;
        let narrowest = narrowest_half_chord(candidate, error).unwrap_or(TwoFloat::from(0.0));
        let first_near = approach.t - widest;
        if first_near > t_min {
            return (first_near < t_max).then_some(first_near);
        }
        if approach.t - narrowest > t_min {
            return Some(TwoFloat::from(t_min));
        }
        let first_far = approach.t + narrowest;
        let last_far = approach.t + widest;
        let first_far = if first_far > t_min { first_far } else { TwoFloat::from(t_min) };
        (last_far > t_min && first_far < t_max).then_some(first_far)
    }

    /// The latest hit over all radii in the band, if each of them gives one.
    fn latest_in_band(&self, candidate: &Candidate, error: f64) -> Option<TwoFloat> {
        let approach = &candidate.approach;
        let radius = TwoFloat::new_add(candidate.sphere.radius, error);
        let (narrowest, widest) =
            (narrowest_half_chord(candidate, error)?, approach.half_chord(radius)?);
        let every_near_counts = approach.t - widest > self.ray.t_min;
        let some_near_counts = approach.t - narrowest > self.ray.t_min;
        let every_far_counts = approach.t + narrowest > self.ray.t_min;
        let latest = match () {
            () if every_near_counts => approach.t - narrowest,
            () if some_near_counts || every_far_counts => approach.t + widest,
            () => return None,
        };
        (latest < self.t_end()).then_some(latest)
    }
}

/// Half the chord at the smallest radius of the band, if that is positive and the line hits it.
fn narrowest_half_chord(candidate: &Candidate, error: f64) -> Option<TwoFloat> {
    let radius = TwoFloat::new_sub(candidate.sphere.radius, error);
    (radius > 0.0).then_some(radius).and_then(|radius| candidate.approach.half_chord(radius))
}

/// Errors due to the size of the ray's coordinates: first with the origin split in two f32, which
/// keep 48 bits of each coordinate, then with origin and boxes rounded to one f32.
fn origin_errors(origin: DVec3) -> [f64; 2] {
    let unit = F32_UNIT_ROUNDOFF * origin.length();
    let error = origin.distance(origin.as_vec3().as_dvec3());
    [2.0 * F32_UNIT_ROUNDOFF * unit, error + unit]
}

/// Tolerance of a resolved distance; `half_chord` is `None` if the line misses.
fn distance_tolerance(origin: DVec3, sphere: &Sphere, half_chord: Option<f64>) -> f64 {
    let distance = origin.distance(sphere.center);
    let error = 8.0 * f64::EPSILON * (distance + sphere.radius);
    let tangent = (2.0 * (sphere.radius + error) * error).sqrt();
    match half_chord {
        Some(h) if h > tangent => error * (1.0 + distance / h),
        Some(h) if h > 0.0 => (error * (1.0 + distance / h)).max(error + tangent),
        _ => error + tangent,
    }
}

/// A conservative f64 test, applied to all spheres of a scene.
struct Prefilter {
    origin: DVec3,
    direction: DVec3,
    length: f64,
    t_min: f64,
}

impl Prefilter {
    /// Bound on the f64 rounding error, relative to the distance: 2^-40, where 2^-49 would do.
    const MARGIN: f64 = 1.0 / (1u64 << 40) as f64;

    fn new(ray: &PathRay) -> Self {
        let PathRay { origin, direction, t_min, .. } = *ray;
        Self {
            origin,
            direction,
            length: direction.length(),
            t_min: t_min * (1.0 - INTERVAL_ROUNDING),
        }
    }

    /// Returns true if a hit before `t_limit` is possible for any radius off by at most `error`.
    fn may_hit(&self, sphere: &Sphere, error: f64, t_limit: f64) -> bool {
        let to_center = sphere.center - self.origin;
        let t = to_center.dot(self.direction) / (self.length * self.length);
        let distance = (to_center - self.direction * t).length();
        let margin = Self::MARGIN * (to_center.length() + sphere.radius);
        let bound = sphere.radius + error + margin;
        let half_chord = bound / self.length + Self::MARGIN * t.abs();
        distance <= bound && t + half_chord >= self.t_min && t - half_chord <= t_limit
    }
}

#[cfg(test)]
mod tests;
