//! Tests every ray against every sphere in f64: the reference backend, and the fastest one for few
//! spheres.
//!
//! Blocks of rays are tested against one sphere at a time, in loops that the compiler vectorises.

use std::sync::Arc;

use crate::geometry::{LineApproach, PathRay, PathRays, RayBlock, SphereSet};
use crate::math::{Hit, Isa, LANES, Lanes, NO_SPHERE, Ray, SimdKernel, rounded_interval};

use super::intersector::{Accel, ErrorBound};

/// After this many spheres, occlusion queries check if all rays of a block are occluded.
const EARLY_OUT_INTERVAL: usize = 64;

/// The backend without any acceleration structure.
pub(super) struct BruteForce {
    spheres: Arc<SphereSet>,
    isa: Isa,
}

impl BruteForce {
    pub(super) fn new(spheres: Arc<SphereSet>) -> Self {
        Self { spheres, isa: Isa::best() }
    }

    fn sphere_count(&self) -> u32 {
        self.spheres.len() as u32
    }

    fn closest_blocks(&self, rays: &PathRays, hits: &mut [Hit]) {
        let mut block_hits = BlockHits::default();
        for (rays, hits) in rays.blocks().iter().zip(hits.chunks_mut(LANES)) {
            self.isa.run(InitHits { rays, block_hits: &mut block_hits });
            let ids = 0..self.sphere_count();
            self.isa.run(IntersectSpheres {
                rays,
                spheres: &self.spheres,
                ids,
                block_hits: &mut block_hits,
            });
            for ((hit, &id), &t) in hits.iter_mut().zip(&block_hits.id.0).zip(&block_hits.t.0) {
                *hit = if id == NO_SPHERE { Hit::MISS } else { Hit { t: t as f32, id } };
            }
        }
    }

    fn occluded_blocks(&self, rays: &PathRays, occluded: &mut [bool]) {
        let mut block_hits = BlockHits::default();
        for (rays, occluded) in rays.blocks().iter().zip(occluded.chunks_mut(LANES)) {
            self.isa.run(InitHits { rays, block_hits: &mut block_hits });
            for first in (0..self.sphere_count()).step_by(EARLY_OUT_INTERVAL) {
                let ids = first..self.sphere_count().min(first + EARLY_OUT_INTERVAL as u32);
                self.isa.run(IntersectSpheres {
                    rays,
                    spheres: &self.spheres,
                    ids,
                    block_hits: &mut block_hits,
                });
                if block_hits.id.0[..occluded.len()].iter().all(|&id| id != NO_SPHERE) {
                    break;
                }
            }
            for (occluded, &id) in occluded.iter_mut().zip(&block_hits.id.0) {
                *occluded = id != NO_SPHERE;
            }
        }
    }
}

impl Accel for BruteForce {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.closest_blocks(&to_path_rays(rays), hits);
    }

    fn occluded(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.occluded_blocks(&to_path_rays(rays), occluded);
    }

    fn closest_path_rays(
        &self,
        _: &SphereSet,
        rays: &PathRays,
        _: &mut Vec<Ray>,
        hits: &mut [Hit],
    ) {
        self.closest_blocks(rays, hits);
    }

    fn occluded_path_rays(
        &self,
        _: &SphereSet,
        rays: &PathRays,
        _: &mut Vec<Ray>,
        occluded: &mut [bool],
    ) {
        self.occluded_blocks(rays, occluded);
    }

    /// Rays are stored with 48 bits and all arithmetic is f64, so the error is that of 2^-48, with
    /// some margin: `k 2^-24 = 2^-44`.
    fn error_bound(&self) -> ErrorBound {
        let k = 2f64.powi(-20);
        ErrorBound { particles: k, giants: k, rounds_origin: false }
    }

    fn bytes(&self) -> usize {
        0
    }
}

/// Converts queries to path rays with the same bits.
fn to_path_rays(rays: &[Ray]) -> PathRays {
    let mut path_rays = PathRays::default();
    for ray in rays {
        path_rays.push(&PathRay {
            t_min: f64::from(ray.t_min),
            t_max: f64::from(ray.t_max),
            origin_sphere: ray.exclude[0],
            target_sphere: ray.exclude[1],
            ..PathRay::new(ray.origin_f64(), ray.direction_f64())
        });
    }
    path_rays
}

/// The closest hits of a block of rays.
#[derive(Default)]
struct BlockHits {
    inv_length_squared: Lanes<f64>,
    /// Hits at or before this distance do not count.
    t_min: Lanes<f64>,
    /// Distance to the closest hit so far; initially the end of the ray's interval.
    t: Lanes<f64>,
    /// The sphere hit, or `NO_SPHERE`.
    id: Lanes<u32>,
    /// The closest approach to the sphere that is tested, as in [`LineApproach`].
    approach: Lanes<f64>,
    half_chord_squared: Lanes<f64>,
}

/// Initialises a block without hits.
struct InitHits<'a> {
    rays: &'a RayBlock,
    block_hits: &'a mut BlockHits,
}

impl SimdKernel for InitHits<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { rays, block_hits } = self;
        for lane in 0..LANES {
            block_hits.inv_length_squared.0[lane] = 1.0 / rays.direction.get(lane).length_squared();
            let [t_min, t_end] = rounded_interval(rays.t_min.0[lane], rays.t_end(lane));
            block_hits.t_min.0[lane] = t_min.into();
            block_hits.t.0[lane] = t_end.into();
            block_hits.id.0[lane] = NO_SPHERE;
        }
    }
}

/// Tests all rays of a block against a list of spheres.
struct IntersectSpheres<'a> {
    rays: &'a RayBlock,
    spheres: &'a SphereSet,
    ids: std::ops::Range<u32>,
    block_hits: &'a mut BlockHits,
}

impl SimdKernel for IntersectSpheres<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { rays, spheres, ids, block_hits } = self;
        for id in ids {
            // The shadow rays of a block are often aimed at one emitter, which cannot occlude them.
            let aimed: u32 = rays.target_sphere.0.iter().map(|&to| u32::from(to == id)).sum();
            if aimed == LANES as u32 {
                continue;
            }
            let sphere = spheres.sphere(id);
            // Most spheres are missed by all rays of a block, which then need no square root.
            let mut hits = 0u64;
            for lane in 0..LANES {
                let (origin, direction) = (rays.origin.get(lane), rays.direction.get(lane));
                let per_length_squared = block_hits.inv_length_squared.0[lane];
                let LineApproach { t, half_chord_squared } =
                    sphere.closest_approach(origin, direction, per_length_squared);
                block_hits.approach.0[lane] = t;
                block_hits.half_chord_squared.0[lane] = half_chord_squared;
                hits += u64::from(half_chord_squared >= 0.0);
            }
            if hits > 0 {
                keep_nearer(rays, block_hits, id);
            }
        }
    }
}

/// Keeps the hits of a sphere that are nearer than those so far.
#[inline(always)]
fn keep_nearer(rays: &RayBlock, block_hits: &mut BlockHits, id: u32) {
    for lane in 0..LANES {
        let (t_min, nearest, best_id) =
            (block_hits.t_min.0[lane], block_hits.t.0[lane], block_hits.id.0[lane]);
        let (t, half_chord_squared) =
            (block_hits.approach.0[lane], block_hits.half_chord_squared.0[lane]);
        let t = LineApproach { t, half_chord_squared }.nearer_root(t_min);
        // No branches, which would prevent vectorisation.
        let is_excluded = (rays.origin_sphere.0[lane] == id) | (rays.target_sphere.0[lane] == id);
        let is_nearer = (t > t_min) & (t < nearest) & !is_excluded;
        block_hits.t.0[lane] = if is_nearer { t } else { nearest };
        block_hits.id.0[lane] = if is_nearer { id } else { best_id };
    }
}
