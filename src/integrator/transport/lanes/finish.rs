//! The end of a vertex: its shadow ray and the next edge of its path.

use crate::fault::fault;
use crate::geometry::PathRay;
use crate::light::{LightSample, LightSampleContext};
use crate::material::{BsdfSample, Diffuse, Lobe};
use crate::math::DVec3;

use super::super::super::context::RenderContext;
use super::super::super::trace::PathRecorder;
use super::super::batch::PathBatch;
use super::super::next_event::LightFactors;
use super::super::paths::{PathState, ShadowQueue, StageQueues};
use super::super::shade::{Vertex, VertexNumbers};
use super::VertexKind;
use super::arrive::Arrival;
use super::light::sample_light_in_lane;
use super::vertex_batch::VertexBatch;

/// The random numbers of a lane.
struct LaneNumbers<'a> {
    batch: &'a VertexBatch,
    lane: usize,
}

impl VertexNumbers for LaneNumbers<'_> {
    fn sample_light(
        &self,
        context: RenderContext<'_>,
        ctx: &LightSampleContext,
    ) -> Option<LightSample> {
        let Self { batch, lane } = *self;
        if batch.light.is_missing.0[lane] {
            return sample_light_in_lane(context, ctx, batch, lane);
        }
        (batch.light.pdf.0[lane] > 0.0).then(|| batch.light.get(lane))
    }

    #[inline(always)]
    fn direction(&self) -> [f64; 2] {
        VertexBatch::pair(&self.batch.numbers.direction, self.lane)
    }

    #[inline(always)]
    fn lobe(&self) -> f64 {
        self.batch.numbers.lobe.0[self.lane]
    }

    #[inline(always)]
    fn roulette(&self) -> f64 {
        self.batch.numbers.roulette.0[self.lane]
    }
}

impl<R: PathRecorder> PathBatch<'_, R> {
    /// Applies the result of a lane to its path.
    #[inline(always)]
    pub(super) fn finish_lane(
        &mut self,
        kind: VertexKind,
        batch: &VertexBatch,
        lane: usize,
        queues: &mut StageQueues<'_>,
    ) {
        let vertex = batch.vertices[lane];
        let path = vertex.path as usize;
        if batch.hit.is_lost.0[lane] {
            return self.shade_scalar(queues, path, batch.backend_hit(lane));
        }
        let hit = batch.hit(lane);
        let ray = match kind {
            VertexKind::Diffuse | VertexKind::Mirror => {
                if vertex.has_arrival {
                    let surface = self.context.scene.sphere_material(hit.id);
                    if self.arrive(&surface, batch, lane, &hit, queues).is_none() {
                        return;
                    }
                }
                let is_lambertian = kind == VertexKind::Diffuse;
                let ctx = LightSampleContext { hit, is_two_sided: false, is_lambertian };
                let StageQueues { paths, shadow, .. } = queues;
                let state = &mut paths.states[path];
                match kind {
                    VertexKind::Diffuse => self.finish_diffuse(state, &ctx, batch, lane, shadow),
                    _ => self.finish_mirror(state, &ctx, batch, lane),
                }
            }
            VertexKind::SmoothDielectric | VertexKind::Other => {
                let surface = self.context.scene.sphere_material(hit.id);
                let arrival = self.arrive(&surface, batch, lane, &hit, queues);
                let Some(Arrival { eta, crossing }) = arrival else { return };
                let wo = -batch.rays.direction.get(lane);
                let vertex = Vertex { hit, wo, surface, eta, crossing };
                let StageQueues { paths, shadow, .. } = queues;
                let state = &mut paths.states[path];
                self.sample_light_and_bsdf(state, &vertex, &LaneNumbers { batch, lane }, shadow)
            }
        };
        if let Some(ray) = ray {
            queues.next.rays.push(&ray);
            queues.next.states.push(queues.paths.states[path]);
        }
    }

    #[inline(always)]
    fn finish_diffuse(
        &mut self,
        state: &mut PathState,
        ctx: &LightSampleContext,
        batch: &VertexBatch,
        lane: usize,
        shadow: &mut ShadowQueue<'_>,
    ) -> Option<PathRay> {
        let albedo = batch.vertices[lane].color;
        let may_scatter = self.may_scatter(state);
        let is_lit = batch.light.pdf.0[lane] > 0.0 && self.samples_lights();
        if is_lit && may_scatter {
            let f = Diffuse { albedo }.eval(DVec3::Z);
            let factors = LightFactors { f, mis_factor: batch.light.mis_factor.0[lane] };
            let sample = batch.light.get(lane);
            self.push_light_sample(state, ctx, &sample, factors, None, shadow);
        }
        let (direction, pdf) = (batch.bsdf.direction.get(lane), batch.bsdf.pdf.0[lane]);
        if pdf <= 0.0 || !may_scatter {
            return None;
        }
        let cos = direction.dot(ctx.hit.facing_normal()) as f32;
        let weight = if fault!(CosineTwice) { albedo * cos } else { albedo };
        let sample = BsdfSample { wi: DVec3::Z, weight, pdf, lobe: Lobe::Diffuse, eta: 1.0 };
        self.continue_lane(state, ctx, &sample, batch, lane)
    }

    #[inline(always)]
    fn finish_mirror(
        &mut self,
        state: &mut PathState,
        ctx: &LightSampleContext,
        batch: &VertexBatch,
        lane: usize,
    ) -> Option<PathRay> {
        let weight = batch.vertices[lane].color;
        let sample = BsdfSample { wi: DVec3::Z, weight, pdf: 1.0, lobe: Lobe::Delta, eta: 1.0 };
        self.continue_lane(state, ctx, &sample, batch, lane)
    }

    /// Continues a path that is reflected in the direction of its lane.
    #[inline(always)]
    fn continue_lane(
        &mut self,
        state: &mut PathState,
        ctx: &LightSampleContext,
        sample: &BsdfSample,
        batch: &VertexBatch,
        lane: usize,
    ) -> Option<PathRay> {
        state.total_reflections = 0;
        let direction = batch.bsdf.direction.get(lane);
        self.scatter(state, ctx, sample, direction, None, &LaneNumbers { batch, lane })
    }
}
