//! Next-event estimation: light samples and their shadow rays.

use crate::color::Rgb;
use crate::fault::fault;
use crate::geometry::PathRay;
use crate::light::{LightSample, LightSampleContext};
use crate::material::{Bsdf, Crossing, MediumStack};
use crate::math::{DVec3, Frame};

use super::super::trace::{PathEvent, PathRecorder};
use super::batch::PathBatch;
use super::opacity;
use super::paths::{PathState, PendingDirect, ShadowQueue};
use super::weight::light_weight;

/// What a light sample is multiplied by: the light's BSDF value `f`, and the cosine and MIS weight
/// over the pdf.
#[derive(Clone, Copy)]
pub(super) struct LightFactors {
    pub(super) f: Rgb,
    pub(super) mis_factor: f32,
}

/// How a vertex scatters light.
#[derive(Clone, Copy)]
pub(super) struct Scattering<'a> {
    pub(super) ctx: &'a LightSampleContext,
    pub(super) bsdf: &'a Bsdf<'a>,
    pub(super) frame: &'a Frame,
    /// Local direction to the previous vertex.
    pub(super) wo: DVec3,
    /// What a path does that goes through the surface, if the media differ on both sides.
    pub(super) crossing: Option<Crossing>,
}

/// A shadow ray, the radiance that arrives along it if unoccluded, and the fraction of it that the
/// medium transmits.
struct ArrivingLight {
    ray: PathRay,
    radiance: Rgb,
    transmittance: Rgb,
}

impl<R: PathRecorder> PathBatch<'_, R> {
    /// Adds the shadow ray of a light sample to the queue, if it can contribute.
    pub(super) fn add_light_sample(
        &mut self,
        state: &PathState,
        scattering: &Scattering<'_>,
        mut sample: LightSample,
        shadow_queue: &mut ShadowQueue<'_>,
    ) {
        let Scattering { ctx, bsdf, frame, wo, crossing } = *scattering;
        let wi = frame.to_local(sample.direction);
        let f = bsdf.eval(wo, wi);
        if f.max_element() <= 0.0 {
            return;
        }
        let crossing = crossing.filter(|_| wi.z < 0.0);
        let Some(arriving) = self.arriving_light(state, ctx, &sample, crossing) else { return };
        sample.radiance = arriving.radiance;
        let transmittance = arriving.transmittance;
        let pdf_bsdf = bsdf.pdf(wo, wi);
        let cos = if fault!(DirectCosineMissing) { 1.0 } else { wi.z.abs() };
        let estimator = self.integrator.estimator;
        let weight = light_weight(estimator, sample.is_exact, sample.pdf, pdf_bsdf);
        self.recorder.record(|| PathEvent::LightSample {
            sample,
            transmittance,
            f,
            cos,
            pdf_bsdf,
            weight,
        });
        let factors = LightFactors { f, mis_factor: (weight * cos / sample.pdf) as f32 };
        self.push_shadow_ray(state, arriving, factors, crossing, shadow_queue);
    }

    /// Adds the shadow ray of a light sample with its factors to the queue, if it can contribute.
    #[inline(always)]
    pub(super) fn push_light_sample(
        &mut self,
        state: &PathState,
        ctx: &LightSampleContext,
        sample: &LightSample,
        factors: LightFactors,
        crossing: Option<Crossing>,
        shadow_queue: &mut ShadowQueue<'_>,
    ) {
        if let Some(arriving) = self.arriving_light(state, ctx, sample, crossing) {
            self.push_shadow_ray(state, arriving, factors, crossing, shadow_queue);
        }
    }

    /// Spawns the shadow ray of a light sample; `None` if the surface itself is in the way.
    #[inline(always)]
    fn arriving_light(
        &self,
        state: &PathState,
        ctx: &LightSampleContext,
        sample: &LightSample,
        crossing: Option<Crossing>,
    ) -> Option<ArrivingLight> {
        let scene = self.context.scene;
        let LightSample { source, direction, distance, radiance, .. } = *sample;
        let ray = match scene.has_passable_surfaces() {
            true => ctx.hit.spawn_ray_to(direction, distance, source.sphere_id()),
            false => ctx.hit.spawn_shadow_ray(direction, distance, source.sphere_id()),
        }?;
        if !scene.has_media() && !scene.has_opacity() {
            return Some(ArrivingLight { ray, radiance, transmittance: Rgb::ONE });
        }
        let beyond = crossing.map(|crossing| self.media_of(state).beyond(crossing));
        let media = beyond.as_ref().unwrap_or_else(|| self.media_of(state));
        // A shadow ray that may enter other media multiplies by their transmittances itself.
        let transmittance = match scene.has_straight_boundaries() {
            true => Rgb::ONE,
            false => media.transmittance(distance),
        };
        let radiance = opacity::emitter_radiance(scene, (source, radiance), ctx, media);
        Some(ArrivingLight { ray, radiance, transmittance })
    }

    #[inline(always)]
    fn push_shadow_ray(
        &mut self,
        state: &PathState,
        arriving: ArrivingLight,
        LightFactors { f, mis_factor }: LightFactors,
        crossing: Option<Crossing>,
        shadow_queue: &mut ShadowQueue<'_>,
    ) {
        let ArrivingLight { ray, radiance, transmittance } = arriving;
        let radiance = state.throughput * f * (radiance * transmittance) * mis_factor;
        if radiance == Rgb::ZERO {
            return;
        }
        let is_direct = state.is_light_sample_direct();
        let batch_index = state.batch_index;
        let pending = PendingDirect {
            batch_index,
            radiance,
            is_direct,
            has_more: false,
            connection: 0,
            is_caught: false,
        };
        shadow_queue.shadow_rays.push(&ray, pending);
        if self.context.scene.has_passable_surfaces() {
            let media = self.media_of(state);
            shadow_queue.media.push(match crossing {
                Some(crossing) => media.beyond(crossing),
                None => MediumStack::clone(media),
            });
        }
    }
}
