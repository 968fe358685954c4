//! Camera rays and what they meet, for the integrators that look no further by themselves.

use crate::geometry::{PathRay, SurfaceHit};
use crate::math::Hit;

use super::camera_rays::{Strata, camera_ray, sampler_of};
use super::sample::{SampleAddress, Tally};
use super::workspace::Workspace;
use super::world::World;
use super::{dimension, seen};

/// The camera ray of a sample, and where it ends if it meets anything.
pub(super) struct FirstHit {
    pub(super) ray: PathRay,
    pub(super) surface: Option<SurfaceHit>,
}

/// Where the samples of a picture without noise go: one of them through the middle of its pixel,
/// more of them all over it.
pub(super) fn strata_without_noise(samples_per_pixel: u32) -> Strata {
    let jitter = if samples_per_pixel == 1 { 0.0 } else { 1.0 };
    Strata { jitter, ..Strata::NONE }
}

/// The first hits of all samples.
pub(super) fn first_hits(
    world: World<'_>,
    strata: Strata,
    samples: &[SampleAddress],
    workspace: &mut Workspace,
    tally: &mut Tally,
) -> Vec<FirstHit> {
    let World { shot, scene, accel, .. } = world;
    let spheres = scene.spheres();
    let ray_of = |&address: &SampleAddress| {
        let sampler = sampler_of(shot, strata, address);
        camera_ray(shot, strata, address, sampler, [dimension::PIXEL, dimension::LENS])
    };
    let mut found: Vec<FirstHit> =
        samples.iter().map(|at| FirstHit { ray: ray_of(at), surface: None }).collect();
    let Workspace { rays, hits, .. } = workspace;
    rays.clear();
    rays.extend(found.iter().map(|first| spheres.ask(&first.ray)));
    hits.clear();
    hits.resize(rays.len(), Hit::MISS);
    accel.closest(rays, hits);
    tally.count(rays);
    for (first, hit) in found.iter_mut().zip(&*hits) {
        first.surface = spheres.answer(&first.ray, *hit);
    }
    workspace.begin_seen(samples.len());
    for (record, first) in workspace.seen.iter_mut().zip(&found) {
        if let Some(hit) = &first.surface {
            seen::note(record, scene, hit);
        }
    }
    found
}
