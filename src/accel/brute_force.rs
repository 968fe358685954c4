//! Every ray against every sphere, in f64: the oracle among the backends, and the fastest of them where
//! spheres are few.
//!
//! Many rays meet a sphere at a time, side by side, in loops that become vector instructions.

use std::sync::Arc;

use crate::geometry::{PathRay, PathRays, RayBlock, SphereSet};
use crate::math::{Hit, Isa, LANES, Lanes, NO_SPHERE, Ray, Stage};

use super::intersector::{Accel, Precision};

/// After so many spheres it is looked whether all rays of a block are blocked already.
const STRETCH: usize = 64;

/// No structure at all.
pub(super) struct BruteForce {
    spheres: Arc<SphereSet>,
    isa: Isa,
}

impl BruteForce {
    pub(super) fn new(spheres: Arc<SphereSet>) -> Self {
        Self { spheres, isa: Isa::best() }
    }

    fn count(&self) -> u32 {
        self.spheres.len() as u32
    }

    fn closest_in(&self, rays: &PathRays, hits: &mut [Hit]) {
        let mut found = Found::default();
        for (rays, hits) in rays.blocks().iter().zip(hits.chunks_mut(LANES)) {
            self.isa.run(Begin { rays, found: &mut found });
            let ids = 0..self.count();
            self.isa.run(Meet { rays, spheres: &self.spheres, ids, found: &mut found });
            for ((hit, &id), &t) in hits.iter_mut().zip(&found.id.0).zip(&found.t.0) {
                *hit = if id == NO_SPHERE { Hit::MISS } else { Hit { t: t as f32, id } };
            }
        }
    }

    fn occluded_in(&self, rays: &PathRays, blocked: &mut [bool]) {
        let mut found = Found::default();
        for (rays, blocked) in rays.blocks().iter().zip(blocked.chunks_mut(LANES)) {
            self.isa.run(Begin { rays, found: &mut found });
            for first in (0..self.count()).step_by(STRETCH) {
                let ids = first..self.count().min(first + STRETCH as u32);
                self.isa.run(Meet { rays, spheres: &self.spheres, ids, found: &mut found });
                if found.id.0[..blocked.len()].iter().all(|&id| id != NO_SPHERE) {
                    break;
                }
            }
            for (blocked, &id) in blocked.iter_mut().zip(&found.id.0) {
                *blocked = id != NO_SPHERE;
            }
        }
    }
}

impl Accel for BruteForce {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.closest_in(&as_they_are(rays), hits);
    }

    fn occluded(&self, rays: &[Ray], blocked: &mut [bool]) {
        self.occluded_in(&as_they_are(rays), blocked);
    }

    fn closest_of(&self, _: &SphereSet, rays: &PathRays, _: &mut Vec<Ray>, hits: &mut [Hit]) {
        self.closest_in(rays, hits);
    }

    fn occluded_of(&self, _: &SphereSet, rays: &PathRays, _: &mut Vec<Ray>, blocked: &mut [bool]) {
        self.occluded_in(rays, blocked);
    }

    /// The ray is known to 48 bits and the arithmetic is f64, so the band is that of 2^-48, with
    /// room: `k 2^-24 = 2^-44`.
    fn precision(&self) -> Precision {
        let k = 2f64.powi(-20);
        Precision { particles: k, giants: k, rounds_origin: false }
    }

    fn bytes(&self) -> usize {
        0
    }
}

/// Rays with the bits that they were asked with.
fn as_they_are(rays: &[Ray]) -> PathRays {
    let mut found = PathRays::default();
    for ray in rays {
        found.push(&PathRay {
            t_min: f64::from(ray.t_min),
            t_max: f64::from(ray.t_max),
            leaves: ray.exclude[0],
            aims_at: ray.exclude[1],
            ..PathRay::free(ray.origin_f64(), ray.direction_f64())
        });
    }
    found
}

/// What the rays of a block have met.
#[derive(Default)]
struct Found {
    per_length_squared: Lanes<f64>,
    /// Of the nearest hit so far; before, the end of the ray's interval.
    t: Lanes<f64>,
    /// The sphere, or `NO_SPHERE`.
    id: Lanes<u32>,
}

/// Nothing met yet.
struct Begin<'a> {
    rays: &'a RayBlock,
    found: &'a mut Found,
}

impl Stage for Begin<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { rays, found } = self;
        for lane in 0..LANES {
            found.per_length_squared.0[lane] = 1.0 / rays.direction.get(lane).length_squared();
            found.t.0[lane] = rays.end(lane);
            found.id.0[lane] = NO_SPHERE;
        }
    }
}

/// All rays of a block against some spheres.
struct Meet<'a> {
    rays: &'a RayBlock,
    spheres: &'a SphereSet,
    ids: std::ops::Range<u32>,
    found: &'a mut Found,
}

impl Stage for Meet<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { rays, spheres, ids, found } = self;
        for id in ids {
            let sphere = spheres.sphere(id);
            for lane in 0..LANES {
                let (origin, direction) = (rays.origin.get(lane), rays.direction.get(lane));
                let (t_min, nearest, id_before) =
                    (rays.t_min.0[lane], found.t.0[lane], found.id.0[lane]);
                let per_length_squared = found.per_length_squared.0[lane];
                let t = sphere.nearer_root(origin, direction, per_length_squared, t_min);
                // Without branches, which would keep the loop from becoming vector instructions.
                let is_excluded = (rays.leaves.0[lane] == id) | (rays.aims_at.0[lane] == id);
                let is_nearer = (t > t_min) & (t < nearest) & !is_excluded;
                found.t.0[lane] = if is_nearer { t } else { nearest };
                found.id.0[lane] = if is_nearer { id } else { id_before };
            }
        }
    }
}
