//! Surface shading: hits and misses, emission, and the continuation of the path.

use crate::color::Rgb;
use crate::fault::fault;
use crate::geometry::{Side, SurfaceHit};
use crate::light::{LightSampleContext, LightSource};
use crate::material::{Lobe, MediumStack};
use crate::math::Frame;
use crate::sampling::power_heuristic;
use crate::scene::SphereMaterial;
use crate::scene::settings::{Estimator, MissPolicy};

use super::super::dimension::{VertexDimensions, bsdf_extra};
use super::super::trace::{PathEvent, PathRecorder, Termination};
use super::batch::PathBatch;
use super::opacity;
use super::paths::{MAX_PATH_EDGES, Path, PathState, PrevVertex, ShadowQueue};

impl<R: PathRecorder> PathBatch<'_, R> {
    /// Shades a path that misses: adds the environment's radiance. Returns true if the path
    /// continues.
    pub(super) fn shade_miss(&mut self, path: &mut Path) -> bool {
        self.record_miss(path);
        if self.retry_camera_ray(path) {
            return true;
        }
        let (scene, direction) = (self.context.scene, path.ray.direction);
        let radiance = if path.state.depth == 1 {
            // The path has not scattered yet: it comes straight from the camera.
            let radiance = scene.camera_background(direction);
            self.set_background_alpha(&path.state);
            self.record_background(path, radiance.direct);
            radiance.direct
        } else {
            scene.background_radiance(direction)
        };
        let is_dropped = path.state.depth > 1 && fault!(BackgroundCameraOnly);
        let radiance = if is_dropped { Rgb::ZERO } else { radiance };
        self.add_emission(path, LightSource::Environment, radiance);
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
            if !self.context.scene.camera_sees_background() {
                radiance = Rgb::ZERO;
            }
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

    /// Shades a path that hits a surface. Returns true if the path continues.
    pub(super) fn shade_hit(
        &mut self,
        path: &mut Path,
        hit: SurfaceHit,
        shadow_queue: &mut ShadowQueue<'_>,
    ) -> bool {
        let scene = self.context.scene;
        let transmittance = match scene.has_media() {
            true => self.media_of(path).transmittance(hit.t - path.ray.t_min),
            false => Rgb::ONE,
        };
        path.state.throughput *= transmittance;
        let PathState { depth, throughput, .. } = path.state;
        let surface = scene.sphere_material(hit.id);
        let opacity = surface.opacity(hit.id, hit.side, self.media_of(path));
        let wo = -path.ray.direction;
        let hit_event = || PathEvent::Hit { depth, hit, wo, opacity, transmittance, throughput };
        self.recorder.record(hit_event);
        if surface.material.is_emissive() {
            let is_far = opacity::is_far_wall(scene, self.prev_vertex(path), &hit);
            let wall = if is_far { LightSource::FarWall } else { LightSource::Emitter };
            let radiance = surface.material.emission * opacity;
            self.add_emission(path, wall(hit.id), radiance);
        }
        if opacity < 1.0 && !opacity::passes_opacity_test(path, self.sampler(path), opacity) {
            return self.pass_transparent(path, &hit);
        }

        // Pass a dielectric boundary that is hidden in another dielectric or matches its index.
        let entering = hit.side == Side::Outside;
        let boundary = surface.medium(hit.id).map(|m| self.media_of(path).boundary(m, entering));
        let transmitted_media = boundary.as_ref().map(|boundary| &boundary.transmitted_media);
        if let Some(boundary) = boundary.as_ref().filter(|boundary| surface.is_straight(boundary)) {
            let is_passable = scene.has_straight_boundaries() && opacity >= 1.0;
            return self.pass_boundary(path, &hit, boundary, is_passable);
        }
        let eta = boundary.as_ref().and_then(|boundary| boundary.eta).unwrap_or(1.0);

        // Is another edge allowed?
        if self.is_at_max_depth(&path.state) {
            return self.terminate(Termination::MaxDepth);
        }
        if depth >= MAX_PATH_EDGES {
            return self.terminate_at_length_limit();
        }
        self.sample_light_and_bsdf(path, &hit, &surface, eta, transmitted_media, shadow_queue)
    }

    /// Returns true if a path has reached `max_depth`.
    pub(super) fn is_at_max_depth(&self, state: &PathState) -> bool {
        state.depth - u32::from(fault!(DepthOffByOne)) >= self.integrator.max_depth
    }

    /// Samples a light, then the BSDF. Returns true if the path continues.
    pub(super) fn sample_light_and_bsdf(
        &mut self,
        path: &mut Path,
        hit: &SurfaceHit,
        surface: &SphereMaterial<'_>,
        eta: f64,
        transmitted_media: Option<&MediumStack>,
        shadow_queue: &mut ShadowQueue<'_>,
    ) -> bool {
        let scene = self.context.scene;
        let bsdf = surface.material.bsdf(surface.albedo, eta, self.integrator.hemisphere);
        let ctx = LightSampleContext {
            hit: *hit,
            is_two_sided: bsdf.is_rough_transmissive(),
            is_lambertian: bsdf.is_lambertian(),
        };
        let frame = Frame::from_z(hit.facing_normal());
        let wo = frame.to_local(-path.ray.direction);
        let may_scatter = path.state.scatter_count < self.integrator.max_scatterings;
        if self.integrator.estimator != Estimator::Bsdf && may_scatter && !bsdf.is_delta() {
            let direct = self.sample_light(path, &ctx, &bsdf, &frame, wo, transmitted_media);
            shadow_queue.push(scene, direct);
        }
        let vertex = VertexDimensions::at(path.state.depth);
        let sampler = self.sampler(path);
        let u = sampler.get_2d(vertex.bsdf_direction());
        let u = if fault!(RandomNumberReused) { [u[0]; 2] } else { u };
        let lobe = if bsdf.needs_lobe_sample() { sampler.get(vertex.lobe()) } else { 0.0 };
        let extra_u = || sampler.get_2d(bsdf_extra(path.state.depth));
        let Some(sample) = bsdf.sample(wo, lobe, u, &extra_u) else {
            return self.terminate(Termination::Absorbed);
        };
        if sample.lobe != Lobe::Delta && !may_scatter {
            return self.terminate(Termination::DirectOnly);
        }
        let direction = frame.to_world(sample.wi);
        if self.is_trapped(path, hit, &sample, eta, direction) {
            return self.terminate(Termination::Trapped);
        }
        let continues = self.scatter(path, &ctx, &sample, direction, transmitted_media);
        path.state.depth += 1;
        continues
    }

    /// Adds emission found by BSDF sampling, with its MIS weight if light sampling could have found
    /// it.
    pub(super) fn add_emission(&mut self, path: &Path, source: LightSource, radiance: Rgb) {
        if radiance == Rgb::ZERO && !R::ENABLED {
            return;
        }
        let prev = self.prev_vertex(path);
        let pdf_light = prev.map_or(0.0, |prev| self.pdf_light(path, prev, source));
        let pdf = prev.map(|prev| prev.pdf);
        let weight = match (self.integrator.estimator, pdf) {
            (Estimator::Mis, Some(_)) if fault!(BsdfMisWeightMissing) => 1.0,
            (Estimator::Mis, Some(p)) if fault!(MisWeightsSwapped) => {
                power_heuristic(pdf_light, p) as f32
            }
            (Estimator::Mis, Some(_)) if pdf_light > 0.0 && self.is_light_exact(prev) => 0.0,
            (Estimator::Mis, Some(pdf)) => power_heuristic(pdf, pdf_light) as f32,
            (Estimator::Light, Some(_)) if pdf_light > 0.0 => 0.0,
            _ => 1.0,
        };
        let contribution = self
            .clamp_contribution(path.state.throughput * radiance * weight, path.state.is_direct());
        self.add_contribution(path.state.batch_index, contribution);
        self.recorder.record(|| PathEvent::Emission {
            source,
            radiance,
            pdf,
            pdf_light,
            weight,
            contribution,
        });
    }

    /// Returns true if light samples at the previous vertex were exact.
    fn is_light_exact(&self, prev: Option<&PrevVertex>) -> bool {
        let spheres = self.context.scene.spheres();
        let lights = self.context.prepared.lights();
        prev.is_some_and(|prev| lights.is_exact(spheres, &prev.light_sample_context(spheres)))
    }

    /// Returns the pdf with which light sampling would have sampled the path's current direction.
    fn pdf_light(&self, path: &Path, prev: &PrevVertex, source: LightSource) -> f64 {
        if self.integrator.estimator == Estimator::Bsdf {
            return 0.0;
        }
        let scene = self.context.scene;
        self.context.prepared.lights().pdf(
            scene.spheres(),
            &prev.light_sample_context(scene.spheres()),
            source,
            path.ray.direction,
        )
    }
}
