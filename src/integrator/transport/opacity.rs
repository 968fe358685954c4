//! Shadow rays through surfaces that are partly transparent (opacity below 1).
//!
//! A path makes a random opacity test at every such surface. A shadow ray does not: it steps from
//! surface to surface with closest-hit queries and multiplies its light by the transmitted
//! fractions, which has the same mean and less noise. MIS weights are unaffected: visibility is a
//! factor of the transported light, the same for light sampling and BSDF sampling.

use crate::color::Rgb;
use crate::fault::fault;
use crate::geometry::{PathRay, Side, SurfaceHit};
use crate::light::{LightSample, LightSampleContext, LightSource};
use crate::material::MediumStack;
use crate::math::{Hit, Ray};
use crate::sampling::Sampler;
use crate::scene::Scene;

use super::super::context::RenderContext;
use super::super::dimension;
use super::super::sample::RenderStats;
use super::paths::{MAX_PATH_EDGES, Path, PrevVertex, ShadowRays};

/// Makes the random opacity test of a path at a surface. Returns false if the path passes straight
/// through.
pub(super) fn passes_opacity_test(path: &Path, sampler: Sampler, opacity: f32) -> bool {
    sampler.get(dimension::opacity(path.state.depth, path.state.passthroughs)) < f64::from(opacity)
}

/// Returns true if a path hits the far wall of an emitter after passing through its near wall.
pub(super) fn is_far_wall(scene: &Scene, prev: Option<&PrevVertex>, hit: &SurfaceHit) -> bool {
    let is_within = |at: &LightSampleContext| at.is_inside(hit.id, &scene.spheres().sphere(hit.id));
    scene.has_opacity()
        && hit.side == Side::Inside
        && prev.is_some_and(|prev| !is_within(&prev.light_sample_context(scene.spheres())))
}

/// Traces all shadow rays to their ends and sets the visibility of each. `media` are those that
/// each ray starts in. A shadow ray never enters a medium: it either passes a surface straight
/// through or ends there.
pub(super) fn trace_visibility(
    context: RenderContext<'_>,
    shadow_rays: &mut ShadowRays,
    media: &[MediumStack],
    rays: &mut Vec<Ray>,
    hits: &mut Vec<Hit>,
    visibility: &mut Vec<f32>,
) -> RenderStats {
    let spheres = context.scene.spheres();
    let mut stats = RenderStats::default();
    visibility.clear();
    visibility.resize(shadow_rays.pending.len(), 1.0);
    let mut active: Vec<usize> = (0..shadow_rays.pending.len()).collect();
    for _ in 0..MAX_PATH_EDGES {
        // Estimates made after cancellation are discarded.
        if active.is_empty() || context.cancel.is_cancelled() {
            return stats;
        }
        rays.clear();
        rays.extend(active.iter().map(|&i| spheres.to_query(&shadow_rays.rays.get(i))));
        hits.clear();
        hits.resize(rays.len(), Hit::MISS);
        context.accel.closest(rays, hits);
        stats.count_rays(rays);
        let mut results = hits.iter();
        active.retain(|&i| {
            let hit = results.next().copied().unwrap_or(Hit::MISS);
            let hit = spheres.resolve_hit(&shadow_rays.rays.get(i), hit);
            let Some(hit) = hit else { return false };
            let (transmitted, ray) =
                surface_visibility(context.scene, &shadow_rays.rays.get(i), &media[i], &hit);
            visibility[i] *= transmitted;
            let behind = ray.filter(|_| visibility[i] > 0.0);
            behind.inspect(|ray| shadow_rays.rays.set(i, ray)).is_some()
        });
    }
    stats.truncated_paths += active.len() as u64;
    active.into_iter().for_each(|i| visibility[i] = 0.0);
    stats
}

/// Returns the fraction of light that a surface transmits, and the ray behind it unless it ends.
fn surface_visibility(
    scene: &Scene,
    ray: &PathRay,
    media: &MediumStack,
    hit: &SurfaceHit,
) -> (f32, Option<PathRay>) {
    let (emitter, remaining) = (ray.target_sphere, ray.t_max - hit.t);
    if hit.id == emitter || remaining <= 0.0 {
        return (1.0, None);
    }
    let opacity = scene.sphere_material(hit.id).opacity(hit.id, hit.side, media);
    let behind = hit.spawn_ray_to(ray.direction, remaining, emitter);
    if opacity >= 1.0 || behind.is_none() {
        return (0.0, None);
    }
    (if fault!(ShadowRayOpacityLost) { opacity } else { 1.0 - opacity }, behind)
}

/// Returns the radiance that a light sends to a shading point in `media`, including its own
/// opacity. Only a glass emitter seen from inside is special: its opacity depends on whether the
/// path has entered it.
pub(super) fn emitter_radiance(
    scene: &Scene,
    light: &LightSample,
    ctx: &LightSampleContext,
    media: &MediumStack,
) -> Rgb {
    match light.source {
        LightSource::Emitter(id)
            if scene.has_opacity() && ctx.is_inside(id, &scene.spheres().sphere(id)) =>
        {
            let surface = scene.sphere_material(id);
            surface.material.emission * surface.opacity(id, Side::Inside, media)
        }
        _ => light.radiance,
    }
}
