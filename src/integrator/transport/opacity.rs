//! Shadow rays through surfaces that are there only with a probability, their opacity.
//!
//! A path decides at every such surface whether it is there. A shadow ray need not: it is walked
//! from surface to surface by repeated closest queries, and its light is multiplied with the
//! probability that nothing was there, which has the same mean and less noise. Both are weighted
//! against each other as ever: the probability is a factor of the light on its way, the same for a
//! direction that was aimed and for one that was found by chance.

use crate::color::Rgb;
use crate::fault::fault;
use crate::geometry::{PathRay, Side, SurfaceHit};
use crate::light::{LightSample, LightSampleContext, LightSource};
use crate::material::MediumStack;
use crate::math::{Hit, Ray};
use crate::sampling::Sampler;
use crate::scene::Scene;

use super::super::dimension;
use super::super::sample::RenderStats;
use super::super::world::RenderContext;
use super::paths::{MAX_PATH_EDGES, Path, PrevVertex, ShadowRays};

/// Whether a path finds a surface there that is there with this probability.
pub(super) fn passes_opacity_test(path: &Path, sampler: Sampler, presence: f32) -> bool {
    sampler.get(dimension::opacity(path.state.depth, path.state.passthroughs)) < f64::from(presence)
}

/// Whether this is the far wall of a lamp whose near wall let the path in: light is aimed at the
/// near one alone.
pub(super) fn is_back_wall_of_emitter(
    scene: &Scene,
    drawn: Option<&PrevVertex>,
    hit: &SurfaceHit,
) -> bool {
    let is_within = |at: &LightSampleContext| at.is_inside(hit.id, &scene.spheres().sphere(hit.id));
    scene.has_opacity()
        && hit.side == Side::Inside
        && drawn.is_some_and(|drawn| !is_within(&drawn.light_sample_context(scene.spheres())))
}

/// Walks all shadow rays to their ends; `passed` becomes the share of the light of each that arrives.
/// `media` are those that each starts in: light aimed at a lamp enters none, since a surface that is
/// there ends it.
pub(super) fn trace_visibility(
    world: RenderContext<'_>,
    shadows: &mut ShadowRays,
    media: &[MediumStack],
    rays: &mut Vec<Ray>,
    hits: &mut Vec<Hit>,
    passed: &mut Vec<f32>,
) -> RenderStats {
    let spheres = world.scene.spheres();
    let mut tally = RenderStats::default();
    passed.clear();
    passed.resize(shadows.pending.len(), 1.0);
    let mut active: Vec<usize> = (0..shadows.pending.len()).collect();
    for _ in 0..MAX_PATH_EDGES {
        // What is estimated after a request to stop is not used.
        if active.is_empty() || world.cancel.is_cancelled() {
            return tally;
        }
        rays.clear();
        rays.extend(active.iter().map(|&i| spheres.to_query(&shadows.rays.get(i))));
        hits.clear();
        hits.resize(rays.len(), Hit::MISS);
        world.accel.closest(rays, hits);
        tally.count_rays(rays);
        let mut answers = hits.iter();
        active.retain(|&i| {
            let hit = answers.next().copied().unwrap_or(Hit::MISS);
            let hit = spheres.resolve_hit(&shadows.rays.get(i), hit);
            let Some(hit) = hit else { return false };
            let (share, ray) =
                surface_visibility(world.scene, &shadows.rays.get(i), &media[i], &hit);
            passed[i] *= share;
            let behind = ray.filter(|_| passed[i] > 0.0);
            behind.inspect(|ray| shadows.rays.set(i, ray)).is_some()
        });
    }
    tally.truncated_paths += active.len() as u64;
    active.into_iter().for_each(|i| passed[i] = 0.0);
    tally
}

/// The share of the light that a surface lets through, and the ray behind it, if there is more to ask.
fn surface_visibility(
    scene: &Scene,
    ray: &PathRay,
    media: &MediumStack,
    hit: &SurfaceHit,
) -> (f32, Option<PathRay>) {
    let (lamp, left) = (ray.target_sphere, ray.t_max - hit.t);
    if hit.id == lamp || left <= 0.0 {
        return (1.0, None);
    }
    let presence = scene.sphere_material(hit.id).opacity(hit.id, hit.side, media);
    let behind = hit.spawn_ray_to(ray.direction, left, lamp);
    if presence >= 1.0 || behind.is_none() {
        return (0.0, None);
    }
    (if fault!(ShadowRayOpacityLost) { presence } else { 1.0 - presence }, behind)
}

/// The radiance that a light sends to a receiver in `media`, its own opacity included. Only a lamp of
/// glass seen from inside needs care: it is there if the path has entered it.
pub(super) fn emitter_radiance(
    scene: &Scene,
    aim: &LightSample,
    receiver: &LightSampleContext,
    media: &MediumStack,
) -> Rgb {
    match aim.source {
        LightSource::Emitter(id)
            if scene.has_opacity() && receiver.is_inside(id, &scene.spheres().sphere(id)) =>
        {
            let surface = scene.sphere_material(id);
            surface.material.emission * surface.opacity(id, Side::Inside, media)
        }
        _ => aim.radiance,
    }
}
