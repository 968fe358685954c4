//! Shadow rays through surfaces that are partly transparent (opacity below 1) and through straight
//! boundaries of media (see [`SphereMaterial::is_straight`]).
//!
//! A path makes a random opacity test at every partly transparent surface. A shadow ray does not:
//! it steps from surface to surface with closest-hit queries and multiplies its light by the
//! transmitted fractions, which has the same mean and less noise. MIS weights are unaffected:
//! visibility is a factor of the transported light, the same for light sampling and BSDF sampling.
//!
//! Both also pass straight boundaries, and the media behind dim their light alike. Only a glass
//! sphere that is present with a probability is left to BSDF sampling where it is present: the
//! shadow ray passes it as absent.
//!
//! [`SphereMaterial::is_straight`]: crate::scene::SphereMaterial::is_straight

use crate::color::Rgb;
use crate::fault::fault;
use crate::geometry::{PathRay, Side, SurfaceHit};
use crate::light::{LightSampleContext, LightSource};
use crate::material::MediumStack;
use crate::math::{Hit, Ray};
use crate::sampling::Sampler;
use crate::scene::Scene;

use super::super::context::RenderContext;
use super::super::dimension;
use super::super::sample::RenderStats;
use super::paths::{MAX_PATH_EDGES, PathState, PrevVertex, ShadowRays};

/// Makes the random opacity test of a path at a surface. Returns false if the path passes straight
/// through.
pub(super) fn passes_opacity_test(state: &PathState, sampler: Sampler, opacity: f32) -> bool {
    sampler.get(dimension::opacity(state.depth, state.passthroughs)) < f64::from(opacity)
}

/// Returns true if a path hits the far wall of an emitter after passing through its near wall.
pub(super) fn is_far_wall(scene: &Scene, prev: Option<&PrevVertex>, hit: &SurfaceHit) -> bool {
    let is_within = |at: &LightSampleContext| at.is_inside(hit.id, &scene.spheres().sphere(hit.id));
    scene.has_passable_surfaces()
        && hit.side == Side::Inside
        && prev.is_some_and(|prev| !is_within(&prev.light_sample_context(scene.spheres())))
}

/// The shadow rays of a stage, on their way through surfaces.
pub(super) struct ShadowWalk<'a> {
    pub(super) context: RenderContext<'a>,
    pub(super) shadow_rays: &'a mut ShadowRays,
    /// The media that each ray is in.
    pub(super) media: &'a mut [MediumStack],
    /// The fraction of its light that each ray has transmitted so far.
    pub(super) visibility: &'a mut [Rgb],
    pub(super) stats: RenderStats,
}

impl ShadowWalk<'_> {
    /// Traces all shadow rays to their ends. Without partly transparent surfaces, `occluded` says
    /// which of them hit anything but their exit point.
    pub(super) fn run(&mut self, occluded: &[bool], rays: &mut Vec<Ray>, hits: &mut Vec<Hit>) {
        let scene = self.context.scene;
        let spheres = scene.spheres();
        let mut active: Vec<usize> = (0..occluded.len())
            .filter(|&i| {
                let ray = self.shadow_rays.rays.get(i);
                let may_hit = scene.has_opacity() || occluded[i] || ray.t_exit < ray.t_max;
                may_hit || self.arrive(i)
            })
            .collect();
        for _ in 0..MAX_PATH_EDGES {
            // Estimates made after cancellation are discarded.
            if active.is_empty() || self.context.cancel.is_cancelled() {
                return;
            }
            rays.clear();
            rays.extend(active.iter().map(|&i| spheres.to_query(&self.shadow_rays.rays.get(i))));
            hits.clear();
            hits.resize(rays.len(), Hit::MISS);
            self.context.accel.closest(rays, hits);
            self.stats.count_rays(rays);
            let mut results = hits.iter();
            active.retain(|&i| {
                let hit = results.next().copied().unwrap_or(Hit::MISS);
                let ray = self.shadow_rays.rays.get(i);
                let hit = spheres.resolve_hit(&ray, hit);
                match hit {
                    Some(hit) => self.advance(i, &ray, &hit),
                    None => self.arrive(i),
                }
            });
        }
        self.stats.truncated_paths += active.len() as u64;
        active.into_iter().for_each(|i| self.visibility[i] = Rgb::ZERO);
    }

    /// Ends a ray that nothing stops any more. Returns false.
    fn arrive(&mut self, index: usize) -> bool {
        self.absorb(index, self.shadow_rays.rays.get(index).t_max);
        false
    }

    /// Multiplies by the transmittance of the medium that a ray is in. Where no light can enter
    /// another medium, the pending contribution includes it.
    fn absorb(&mut self, index: usize, distance: f64) {
        if self.context.scene.has_straight_boundaries() && !fault!(PassedMediumLost) {
            self.visibility[index] *= self.media[index].transmittance(distance);
        }
    }

    /// Moves a ray behind the surface that it hits. Returns false if it ends there.
    fn advance(&mut self, index: usize, ray: &PathRay, hit: &SurfaceHit) -> bool {
        let (emitter, remaining) = (ray.target_sphere, ray.t_max - hit.t);
        if hit.id == emitter || remaining <= 0.0 {
            return self.arrive(index);
        }
        self.absorb(index, hit.t);
        let behind = hit.spawn_ray_to(ray.direction, remaining, emitter);
        let transmitted = if behind.is_some() { self.pass(index, hit) } else { 0.0 };
        self.visibility[index] *= transmitted;
        let behind = behind.filter(|_| self.visibility[index] != Rgb::ZERO);
        behind.inspect(|ray| self.shadow_rays.rays.set(index, ray)).is_some()
    }

    /// Returns the fraction of light that a surface transmits, and enters the medium behind it.
    fn pass(&mut self, index: usize, hit: &SurfaceHit) -> f32 {
        let scene = self.context.scene;
        let surface = scene.sphere_material(hit.id);
        let media = &mut self.media[index];
        let opacity = surface.opacity(hit.id, hit.side, media);
        if opacity < 1.0 {
            return if fault!(ShadowRayOpacityLost) { opacity } else { 1.0 - opacity };
        }
        if !scene.has_straight_boundaries() {
            return 0.0;
        }
        let Some(medium) = surface.medium(hit.id) else { return 0.0 };
        let boundary = media.boundary(medium, hit.side == Side::Outside);
        if !surface.is_straight(&boundary) {
            return 0.0;
        }
        media.cross(boundary.crossing);
        1.0
    }
}

/// Returns the radiance that a light sends to a shading point in `media`, including its own
/// opacity. Only a glass emitter seen from inside is special: its opacity depends on whether the
/// path has entered it.
#[inline(always)]
pub(super) fn emitter_radiance(
    scene: &Scene,
    (source, radiance): (LightSource, Rgb),
    ctx: &LightSampleContext,
    media: &MediumStack,
) -> Rgb {
    match source {
        LightSource::Emitter(id)
            if scene.has_opacity() && ctx.is_inside(id, &scene.spheres().sphere(id)) =>
        {
            let surface = scene.sphere_material(id);
            surface.material.emission * surface.opacity(id, Side::Inside, media)
        }
        _ => radiance,
    }
}
