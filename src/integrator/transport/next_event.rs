//! Next-event estimation: light samples and their shadow rays.

use crate::color::Rgb;
use crate::fault::fault;
use crate::geometry::{PathRay, SurfaceHit};
use crate::light::LightSampleContext;
use crate::material::{Bsdf, MediumStack};
use crate::math::{DVec3, Frame};
use crate::scene::Scene;

use super::super::dimension::VertexDimensions;
use super::super::trace::{PathEvent, PathRecorder};
use super::batch::PathBatch;
use super::opacity;
use super::paths::{Path, PendingDirect, ShadowQueue};
use super::weight::light_weight;

impl ShadowQueue<'_> {
    /// Adds a shadow ray and the media it starts in.
    pub(super) fn push(
        &mut self,
        scene: &Scene,
        direct: Option<(PathRay, PendingDirect, &MediumStack)>,
    ) {
        let Some((ray, pending, media)) = direct else { return };
        self.shadow_rays.push(&ray, pending);
        if scene.has_passable_surfaces() {
            self.media.push(media.clone());
        }
    }

    /// Adds a shadow ray that starts outside of all media.
    #[inline(always)]
    pub(super) fn push_from_vacuum(
        &mut self,
        scene: &Scene,
        ray: &PathRay,
        pending: PendingDirect,
    ) {
        self.shadow_rays.push(ray, pending);
        if scene.has_passable_surfaces() {
            self.media.push(MediumStack::VACUUM);
        }
    }
}

impl<R: PathRecorder> PathBatch<'_, R> {
    /// Samples a light and returns the shadow ray towards it, if it can contribute, and the media
    /// that ray starts in. `transmitted_media` are those on the other side of the surface, if they
    /// differ.
    pub(super) fn sample_light<'p>(
        &'p mut self,
        path: &Path,
        ctx: &LightSampleContext,
        bsdf: &Bsdf<'_>,
        frame: &Frame,
        wo: DVec3,
        transmitted_media: Option<&'p MediumStack>,
    ) -> Option<(PathRay, PendingDirect, &'p MediumStack)> {
        let vertex = VertexDimensions::at(path.state.depth);
        let sampler = self.sampler(path);
        let u = sampler.get_2d(vertex.light_direction());
        let scene = self.context.scene;
        let lights = self.context.prepared.lights();
        let has_choice = lights.needs_selection();
        let u_select = if has_choice { sampler.get(vertex.light_selection()) } else { 0.0 };
        let mut light = lights.sample(scene.spheres(), ctx, u_select, u)?;
        let wi = frame.to_local(light.direction);
        let f = bsdf.eval(wo, wi);
        if f.max_element() <= 0.0 {
            return None;
        }
        let transmitted = transmitted_media.filter(|_| wi.z < 0.0);
        let media = transmitted.unwrap_or_else(|| self.media_of(path));
        let spawn = match scene.has_passable_surfaces() {
            true => SurfaceHit::spawn_ray_to,
            false => SurfaceHit::spawn_shadow_ray,
        };
        let ray = spawn(&ctx.hit, light.direction, light.distance, light.source.sphere_id())?;
        light.radiance = opacity::emitter_radiance(scene, &light, ctx, media);
        // A shadow ray that may enter other media multiplies by their transmittances itself.
        let transmittance = match scene.has_media() && !scene.has_straight_boundaries() {
            true => media.transmittance(light.distance),
            false => Rgb::ONE,
        };
        let cos = if fault!(DirectCosineMissing) { 1.0 } else { wi.z.abs() };
        let pdf_bsdf = bsdf.pdf(wo, wi);
        let weight = light_weight(self.integrator.estimator, light.is_exact, light.pdf, pdf_bsdf);
        self.recorder.record(|| PathEvent::LightSample {
            sample: light,
            transmittance,
            f,
            cos,
            pdf_bsdf,
            weight,
        });
        let radiance = light.radiance * transmittance;
        let light = path.state.throughput * f * radiance * (weight * cos / light.pdf) as f32;
        if light == Rgb::ZERO {
            return None;
        }
        let is_direct = path.state.is_light_sample_direct();
        let media = transmitted.unwrap_or_else(|| self.media_of(path));
        Some((
            ray,
            PendingDirect { batch_index: path.state.batch_index, radiance: light, is_direct },
            media,
        ))
    }
}
