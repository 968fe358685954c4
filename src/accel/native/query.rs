//! The exact test of candidates: one ray in f64, and its best hit so far.

use crate::fault::fault;
use crate::geometry::Sphere;
use crate::math::{DVec3, Hit, NO_SPHERE, Ray};

/// One ray in f64, and the best hit so far.
pub(super) struct ExactQuery<'a> {
    pub(super) origin: DVec3,
    pub(super) direction: DVec3,
    pub(super) t_min: f64,
    ray: &'a Ray,
    pub(super) best: BestHit,
}

/// The best hit so far.
#[derive(Clone, Copy)]
pub(super) struct BestHit {
    /// Distance in units of the direction's length; initially the end of the ray.
    pub(super) t: f64,
    /// The sphere hit, or [`NO_SPHERE`].
    pub(super) id: u32,
}

impl BestHit {
    /// No hit yet.
    #[inline(always)]
    pub(super) fn none(ray: &Ray) -> Self {
        Self { t: f64::from(ray.t_max), id: NO_SPHERE }
    }

    #[inline(always)]
    pub(super) fn is_hit(&self) -> bool {
        self.id != NO_SPHERE
    }

    #[inline(always)]
    pub(super) fn to_hit(self) -> Hit {
        if self.is_hit() { Hit { t: self.t as f32, id: self.id } } else { Hit::MISS }
    }
}

impl<'a> ExactQuery<'a> {
    #[inline(always)]
    pub(super) fn new(ray: &'a Ray, best: BestHit) -> Self {
        let (origin, direction) = (ray.origin_f64(), ray.direction_f64());
        Self { origin, direction, t_min: f64::from(ray.t_min), ray, best }
    }

    /// Tests a sphere and keeps the hit if it is nearer, or equally near with a smaller id.
    #[inline(always)]
    pub(super) fn intersect(&mut self, id: u32, sphere: &Sphere) {
        if self.ray.excludes(id) {
            return;
        }
        let root = sphere.first_root(self.origin, self.direction, self.t_min, f64::INFINITY);
        let Some(t) = root else { return };
        let BestHit { t: best, id: best_id } = self.best;
        let is_better = t < best
            || fault!(NotClosestHit)
            || (t == best && id < best_id && best_id != NO_SPHERE);
        if is_better {
            self.best = BestHit { t, id };
        }
    }
}
