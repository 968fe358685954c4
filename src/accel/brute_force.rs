//! Every ray against every sphere, in f64: the oracle among the backends.

use std::sync::Arc;

use crate::geometry::SphereSet;
use crate::math::{DVec3, Hit, Ray};

use super::{Accel, Precision};

/// No structure at all.
pub(super) struct BruteForce {
    spheres: Arc<SphereSet>,
}

impl BruteForce {
    pub(super) fn new(spheres: Arc<SphereSet>) -> Self {
        Self { spheres }
    }

    /// Calls `visit` with each sphere that the ray hits and its distance, until it returns `false`.
    /// `visit` also says up to which distance hits are of interest.
    fn hits(&self, ray: &Ray, mut visit: impl FnMut(u32, f64) -> f64) {
        if !ray.is_valid() {
            return;
        }
        let (origin, direction): (DVec3, DVec3) = (ray.origin_f64(), ray.direction_f64());
        let (t_min, mut t_max) = (f64::from(ray.t_min), f64::from(ray.t_max));
        for id in 0..self.spheres.len() as u32 {
            if ray.excludes(id) {
                continue;
            }
            if let Some(t) = self.spheres.sphere(id).first_root(origin, direction, t_min, t_max) {
                t_max = visit(id, t);
                if t_max <= t_min {
                    return;
                }
            }
        }
    }
}

impl Accel for BruteForce {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = Hit::MISS;
            self.hits(ray, |id, t| {
                *hit = Hit { t: t as f32, id };
                t
            });
        }
    }

    fn occluded(&self, rays: &[Ray], blocked: &mut [bool]) {
        for (ray, blocked) in rays.iter().zip(blocked) {
            *blocked = false;
            self.hits(ray, |_, _| {
                *blocked = true;
                f64::NEG_INFINITY
            });
        }
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
