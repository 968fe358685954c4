//! Camera rays and their first hits, for integrators that trace no further path vertices.

use crate::geometry::{PathRay, SurfaceHit};
use crate::math::Hit;

use super::camera_rays::{Strata, generate_camera_ray, sampler_for};
use super::context::RenderContext;
use super::sample::{RenderStats, SampleAddress};
use super::workspace::Workspace;
use super::{aov, dimension};

/// The camera ray of a sample and its hit, if any.
pub(super) struct PrimaryHit {
    pub(super) ray: PathRay,
    pub(super) hit: Option<SurfaceHit>,
}

/// Returns the sample positions for a noise-free picture: the pixel's centre for one sample, the
/// whole pixel for more.
pub(super) fn noise_free_strata(samples_per_pixel: u32) -> Strata {
    let jitter = if samples_per_pixel == 1 { 0.0 } else { 1.0 };
    Strata { jitter, ..Strata::UNSTRATIFIED }
}

/// Traces the camera rays of all samples to their first hits.
pub(super) fn trace_primary_rays(
    context: RenderContext<'_>,
    strata: Strata,
    samples: &[SampleAddress],
    workspace: &mut Workspace,
    stats: &mut RenderStats,
) -> Vec<PrimaryHit> {
    let RenderContext { prepared, scene, accel, .. } = context;
    let spheres = scene.spheres();
    let camera_ray = |&address: &SampleAddress| {
        let sampler = sampler_for(prepared, strata, address);
        generate_camera_ray(prepared, strata, address, sampler, [dimension::PIXEL, dimension::LENS])
    };
    let mut primary_hits: Vec<PrimaryHit> =
        samples.iter().map(|address| PrimaryHit { ray: camera_ray(address), hit: None }).collect();
    let Workspace { rays, hits, .. } = workspace;
    rays.clear();
    rays.extend(primary_hits.iter().map(|primary| spheres.to_query(&primary.ray)));
    hits.clear();
    hits.resize(rays.len(), Hit::MISS);
    accel.closest(rays, hits);
    stats.count_rays(rays);
    for (primary, hit) in primary_hits.iter_mut().zip(&*hits) {
        primary.hit = spheres.resolve_hit(&primary.ray, *hit);
    }
    workspace.reset_visible_surfaces(samples.len());
    for (record, primary) in workspace.visible_surfaces.iter_mut().zip(&primary_hits) {
        if let Some(hit) = &primary.hit {
            aov::record_surface(record, scene, hit);
        }
    }
    primary_hits
}
