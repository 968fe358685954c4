//! Surface shading: hits and misses, and the continuation of the path.

use crate::color::Rgb;
use crate::fault::fault;
use crate::geometry::{PathRay, Side, SurfaceHit};
use crate::light::{CategoryPmf, LightPdf, LightSampleContext, LightSource};
use crate::material::Lobe;
use crate::math::{Frame, renormalize};
use crate::scene::settings::{Estimator, MissPolicy};

use super::super::dimension::{VertexDimensions, bsdf_extra};
use super::super::trace::{PathEvent, PathRecorder, Termination};
use super::batch::PathBatch;
use super::chain::FoundLight;
use super::next_event::Scattering;
use super::opacity;
use super::paths::{MAX_PATH_EDGES, Path, PathState, PrevVertex, ShadowQueue};
use super::vertex::{SurfaceVertex, VertexNumbers};

impl<R: PathRecorder> PathBatch<'_, R> {
    /// Shades a path that misses: adds the environment's radiance. Returns the ray on which it
    /// continues, if a camera ray is redrawn.
    pub(super) fn shade_miss(&mut self, path: &mut Path) -> Option<PathRay> {
        self.record_miss(path);
        if self.retry_camera_ray(path) {
            return Some(path.ray);
        }
        let (lights, direction) = (self.context.prepared.lights(), path.ray.direction);
        let state = &path.state;
        let (mut radiance, map_pdf) = lights.environment().radiance_and_pdf(direction);
        if state.depth == 1 {
            // The path has not scattered yet: it comes straight from the camera.
            radiance = self.context.scene.seen_by_camera(radiance);
            self.set_background_alpha(state);
            self.record_background(path, radiance);
        } else if fault!(BackgroundCameraOnly) {
            radiance = Rgb::ZERO;
        }
        // Connections find the sun alone, not the sky around it.
        let sun = match self.context.prepared.connections() {
            Some(_) => lights.sun_radiance(direction),
            None => Rgb::ZERO,
        };
        let pdfs = match sun {
            Rgb::ZERO => None,
            _ => self.chain_pdfs(state, direction, &FoundLight::Sun),
        };
        if let Some(pdfs) = pdfs {
            radiance = (radiance - sun).max(Rgb::ZERO);
            self.add_connectable_emission(state, LightSource::Environment, sun, &pdfs);
        }
        let pdf_light = |prev: &PrevVertex| {
            LightPdf::inexact(lights.environment_pdf(&prev.lights, direction, map_pdf))
        };
        self.add_weighted_emission(state, LightSource::Environment, radiance, pdf_light);
        self.terminate(Termination::Escaped)
    }

    /// Returns the radiance of a constant environment, if [`Self::shade_constant_miss`] is
    /// sufficient to shade a miss.
    pub(super) fn constant_environment(&self) -> Option<Rgb> {
        let is_sufficient = !R::ENABLED
            && self.visible_surfaces.is_empty()
            && self.integrator.miss != MissPolicy::Redraw;
        self.context.prepared.lights().environment().constant_radiance().filter(|_| is_sufficient)
    }

    /// Terminates a path that misses in a scene with a constant environment, as
    /// [`Self::shade_miss`] does. Light sampling never targets such an environment.
    #[inline(always)]
    pub(super) fn shade_constant_miss(&mut self, state: &PathState, mut radiance: Rgb) {
        if state.depth == 1 {
            self.set_background_alpha(state);
            radiance = self.context.scene.seen_by_camera(radiance);
        }
        if state.depth > 1 && fault!(BackgroundCameraOnly) {
            radiance = Rgb::ZERO;
        }
        if radiance != Rgb::ZERO {
            let contribution =
                self.clamp_contribution(state.throughput * radiance, state.is_direct());
            self.add_contribution(state.batch_index, contribution);
        }
    }

    /// Sets the alpha of a sample that sees the background: what the media in between absorb.
    #[inline(always)]
    fn set_background_alpha(&mut self, state: &PathState) {
        self.radiance[state.batch_index as usize].alpha = 1.0 - state.throughput.max_element();
    }

    /// Shades a path that hits a surface. Returns the ray on which it continues.
    pub(super) fn shade_hit(
        &mut self,
        path: &mut Path,
        hit: SurfaceHit,
        shadow_queue: &mut ShadowQueue<'_>,
    ) -> Option<PathRay> {
        let scene = self.context.scene;
        let transmittance = match scene.has_media() {
            true => self.media_of(&path.state).transmittance(hit.t - path.ray.t_min),
            false => Rgb::ONE,
        };
        path.state.throughput *= transmittance;
        let PathState { depth, throughput, .. } = path.state;
        let surface = scene.sphere_material(hit.id);
        let opacity = surface.opacity(hit.id, hit.side, self.media_of(&path.state));
        let wo = -path.ray.direction;
        let hit_event = || PathEvent::Hit { depth, hit, wo, opacity, transmittance, throughput };
        self.recorder.record(hit_event);
        if surface.material.is_emissive() {
            let is_far = opacity::is_far_wall(scene, self.prev_vertex(&path.state), &hit);
            let wall = if is_far { LightSource::FarWall } else { LightSource::Emitter };
            let radiance = surface.material.emission * opacity;
            self.add_emission(&path.state, path.ray.direction, wall, &hit, radiance);
        }
        let is_absent =
            || !opacity::passes_opacity_test(&path.state, self.sampler(&path.state), opacity);
        if opacity < 1.0 && is_absent() {
            return self.pass_transparent(path, &hit);
        }

        // Pass a dielectric boundary that is hidden in another dielectric or matches its index.
        let entering = hit.side == Side::Outside;
        let media = self.media_of(&path.state);
        let boundary = surface.medium(hit.id).map(|medium| media.boundary(medium, entering));
        let crossing = boundary.map(|boundary| boundary.crossing);
        if let Some(boundary) = boundary.filter(|boundary| surface.is_straight(boundary)) {
            let is_passable = scene.has_straight_boundaries() && opacity >= 1.0;
            return self.pass_boundary(path, &hit, &boundary, is_passable);
        }
        let eta = boundary.and_then(|boundary| boundary.eta).unwrap_or(1.0);

        if self.is_at_last_edge(&path.state) {
            return None;
        }
        let vertex = SurfaceVertex { hit, wo, surface, eta, crossing };
        let numbers = (self.sampler(&path.state), VertexDimensions::at(depth));
        self.sample_light_and_bsdf(&mut path.state, &vertex, &numbers, shadow_queue)
    }

    /// Returns true if no further edge is allowed, and terminates the path.
    #[inline(always)]
    pub(super) fn is_at_last_edge(&mut self, state: &PathState) -> bool {
        if self.is_at_max_depth(state) {
            self.terminate(Termination::MaxDepth);
            return true;
        }
        if state.depth >= MAX_PATH_EDGES {
            self.terminate_at_length_limit();
            return true;
        }
        false
    }

    /// Returns true if a path has reached `max_depth`.
    pub(super) fn is_at_max_depth(&self, state: &PathState) -> bool {
        state.depth - u32::from(fault!(DepthOffByOne)) >= self.integrator.max_depth
    }

    /// Samples a light, then the BSDF. Returns the ray on which the path continues.
    pub(super) fn sample_light_and_bsdf(
        &mut self,
        state: &mut PathState,
        vertex: &SurfaceVertex<'_>,
        numbers: &impl VertexNumbers,
        shadow_queue: &mut ShadowQueue<'_>,
    ) -> Option<PathRay> {
        let SurfaceVertex { ref hit, ref surface, eta, crossing, .. } = *vertex;
        let bsdf = surface.material.bsdf(surface.albedo, eta, self.integrator.hemisphere);
        let ctx = LightSampleContext {
            hit: *hit,
            is_two_sided: bsdf.is_rough_transmissive(),
            is_lambertian: bsdf.is_lambertian(),
        };
        let frame = Frame::from_z(hit.facing_normal());
        let wo = frame.to_local(vertex.wo);
        let may_scatter = self.may_scatter(state);
        let mut category_pmf = CategoryPmf::NONE;
        if self.samples_lights() && may_scatter && !bsdf.is_delta() {
            let light;
            (category_pmf, light) = numbers.sample_light(self.context, &ctx);
            let scattering = Scattering { ctx: &ctx, bsdf: &bsdf, frame: &frame, wo, crossing };
            if let Some(light) = light {
                self.add_light_sample(state, &scattering, light, shadow_queue);
            }
            self.add_connections(state, &scattering, numbers, shadow_queue);
        }
        let u = numbers.direction();
        let u = if fault!(RandomNumberReused) { [u[0]; 2] } else { u };
        let lobe = if bsdf.needs_lobe_sample() { numbers.lobe() } else { 0.0 };
        let (sampler, depth) = (self.sampler(state), state.depth);
        let extra_u = || sampler.get_2d(bsdf_extra(depth));
        let Some(sample) = bsdf.sample(wo, lobe, u, &extra_u) else {
            return self.terminate(Termination::Absorbed);
        };
        if sample.lobe != Lobe::Delta && !may_scatter {
            return self.terminate(Termination::DirectOnly);
        }
        let direction = frame.to_world(sample.wi);
        if self.is_trapped(state, hit, &sample, eta, direction) {
            return self.terminate(Termination::Trapped);
        }
        let from = (&ctx, category_pmf);
        self.scatter(state, from, &sample, renormalize(direction), crossing, numbers)
    }

    /// Returns true if paths sample lights.
    pub(super) fn samples_lights(&self) -> bool {
        self.integrator.estimator != Estimator::Bsdf
    }

    /// Returns true if a path may be scattered in more than one direction once more.
    pub(super) fn may_scatter(&self, state: &PathState) -> bool {
        state.scatter_count < self.integrator.max_scatterings
    }
}
