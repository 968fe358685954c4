//! Emission that a path finds by chance, weighted against the techniques that look for it.

use crate::color::Rgb;
use crate::fault::fault;
use crate::geometry::SurfaceHit;
use crate::light::{LightPdf, LightSource};
use crate::math::DVec3;
use crate::sampling::power_heuristic;
use crate::scene::settings::Estimator;

use super::super::trace::{PathEvent, PathRecorder, Rival};
use super::batch::PathBatch;
use super::chain::{ChainPdfs, FoundLight};
use super::paths::{PathState, PrevVertex};

impl<R: PathRecorder> PathBatch<'_, R> {
    /// Adds emission found by BSDF sampling, with its MIS weight if light sampling could have found
    /// it.
    pub(super) fn add_emission(
        &mut self,
        state: &PathState,
        direction: DVec3,
        wall: impl Fn(u32) -> LightSource,
        hit: &SurfaceHit,
        radiance: Rgb,
    ) {
        let source = wall(hit.id);
        if let Some(pdfs) = self.chain_pdfs(state, direction, &FoundLight::Emitter(hit)) {
            return self.add_connectable_emission(state, source, radiance, &pdfs);
        }
        let (spheres, lights) = (self.context.scene.spheres(), self.context.prepared.lights());
        let pdf_light = |prev: &PrevVertex| {
            let ctx = prev.light_sample_context(spheres);
            lights.pdf_by(&prev.lights, spheres, &ctx, source, direction)
        };
        self.add_weighted_emission(state, source, radiance, pdf_light);
    }

    /// As [`Self::add_emission`], given the pdf with which light sampling at the previous vertex
    /// would have sampled the path's direction.
    pub(super) fn add_weighted_emission(
        &mut self,
        state: &PathState,
        source: LightSource,
        radiance: Rgb,
        pdf_light: impl Fn(&PrevVertex) -> LightPdf,
    ) {
        if radiance == Rgb::ZERO && !R::ENABLED {
            return;
        }
        let prev = self.prev_vertex(state).filter(|_| self.samples_lights());
        let light = prev.map(pdf_light);
        let pdf_light = light.map_or(0.0, |light| light.pdf);
        let is_exact = light.is_some_and(|light| light.is_exact);
        let pdf = self.prev_vertex(state).map(|prev| prev.pdf);
        let weight = match (self.integrator.estimator, pdf) {
            (Estimator::Mis, Some(_)) if fault!(BsdfMisWeightMissing) => 1.0,
            (Estimator::Mis, Some(p)) if fault!(MisWeightsSwapped) => {
                power_heuristic(pdf_light, p) as f32
            }
            (Estimator::Mis, Some(_)) if pdf_light > 0.0 && is_exact => 0.0,
            (Estimator::Mis, Some(pdf)) => power_heuristic(pdf, pdf_light) as f32,
            (Estimator::Light, Some(_)) if pdf_light > 0.0 => 0.0,
            _ => 1.0,
        };
        self.add_found(state, (source, radiance), weight, (pdf, Rival::LightSample(pdf_light)));
    }

    /// Adds emission found by chance over a polished ball, with its MIS weight against connections.
    pub(super) fn add_connectable_emission(
        &mut self,
        state: &PathState,
        source: LightSource,
        radiance: Rgb,
        pdfs: &ChainPdfs,
    ) {
        let weight = match self.integrator.estimator {
            Estimator::Light => 0.0,
            _ => power_heuristic(pdfs.chance, pdfs.connection) as f32,
        };
        let rivals = (Some(pdfs.chance), Rival::Connection(pdfs.connection));
        self.add_found(state, (source, radiance), weight, rivals);
    }

    /// Adds emission with its weight, and records the densities with which it was found and could
    /// have been.
    fn add_found(
        &mut self,
        state: &PathState,
        (source, radiance): (LightSource, Rgb),
        weight: f32,
        (pdf, rival): (Option<f64>, Rival),
    ) {
        let contribution =
            self.clamp_contribution(state.throughput * radiance * weight, state.is_direct());
        self.add_contribution(state.batch_index, contribution);
        let event = || PathEvent::Emission { source, radiance, pdf, rival, weight, contribution };
        self.recorder.record(event);
    }
}
