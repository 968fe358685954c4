//! The end of a vertex: its shadow ray and the next edge of its path.

use crate::fault::fault;
use crate::geometry::PathRay;
use crate::light::specular::{CasterPairs, Connection, PairSampler, SpecularPath};
use crate::light::{CategoryPmf, ConnectedPoint, LightSample, LightSampleContext, Lights};
use crate::material::{Bsdf, BsdfSample, Diffuse, Lobe};
use crate::math::{DVec3, Frame};
use crate::sampling::Hemisphere;

use super::super::super::context::RenderContext;
use super::super::super::trace::PathRecorder;
use super::super::batch::PathBatch;
use super::super::next_event::{LightFactors, Scattering};
use super::super::pair_site::PairSite;
use super::super::paths::{PathState, ShadowQueue, StageQueues};
use super::super::vertex::{SurfaceVertex, VertexNumbers};
use super::arrive::Arrival;
use super::light::sample_light_in_lane;
use super::vertex_batch::{Vertex, VertexBatch};

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
    ) -> (CategoryPmf, Option<LightSample>) {
        let Self { batch, lane } = *self;
        if batch.light.is_missing.0[lane] {
            return sample_light_in_lane(context, ctx, batch, lane);
        }
        let sample = (batch.light.pdf.0[lane] > 0.0).then(|| batch.light.get(lane));
        (batch.light.categories[lane], sample)
    }

    fn choose_pairs(
        &self,
        pairs: &PairSampler,
        ctx: &LightSampleContext,
        inside: Option<u32>,
        u_light: impl FnOnce() -> f64,
    ) -> CasterPairs {
        let Self { batch, lane } = *self;
        if inside.is_some() || pairs.needs_choice() {
            let u = VertexBatch::pair(&batch.numbers.connection, lane);
            return pairs.sample(ctx, inside, u, u_light);
        }
        pairs.accepted(batch.pairs.0[lane], ctx.hit.point)
    }

    fn connect(
        &self,
        lights: &Lights,
        site: &PairSite<'_>,
        u: impl FnOnce() -> [f64; 2],
        found: impl FnMut(&ConnectedPoint, SpecularPath, &Connection),
    ) -> bool {
        let Self { batch, lane } = *self;
        // Lanes are solved outside of all balls.
        let solved = batch.connections.of_lane(site.pair.n, lane);
        let Some((point, roots)) = solved.filter(|_| site.inside.is_none()) else {
            return site.connect(lights, u(), found);
        };
        let Some(point) = point else { return false };
        site.connect_lane(point, (roots, lane), found);
        true
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
    /// Applies the results of all lanes to their paths, each by `finish`.
    #[inline(always)]
    pub(super) fn finish_lanes(
        &mut self,
        batch: &VertexBatch,
        queues: &mut StageQueues<'_>,
        finish: impl Fn(&mut Self, &VertexBatch, usize, &mut StageQueues<'_>) -> Option<PathRay>,
    ) {
        for lane in 0..batch.count {
            let path = batch.vertices[lane].path as usize;
            if batch.hit.is_lost.0[lane] {
                self.shade_scalar(queues, path, batch.backend_hit(lane));
                continue;
            }
            if let Some(ray) = finish(self, batch, lane, queues) {
                queues.next.rays.push(&ray);
                queues.next.states.push(queues.paths.states[path]);
            }
        }
    }

    #[inline(always)]
    pub(super) fn finish_diffuse(
        &mut self,
        batch: &VertexBatch,
        lane: usize,
        queues: &mut StageQueues<'_>,
    ) -> Option<PathRay> {
        let vertex = batch.vertices[lane];
        if vertex.has_arrival {
            self.arrive(batch, lane, queues)?;
        }
        let (albedo, state) = (vertex.color, &mut queues.paths.states[vertex.path as usize]);
        let hit = batch.hit(lane);
        let ctx = &LightSampleContext { hit, is_two_sided: false, is_lambertian: true };
        let may_scatter = self.may_scatter(state);
        let is_lit = batch.light.pdf.0[lane] > 0.0 && self.samples_lights();
        if is_lit && may_scatter {
            let f = Diffuse { albedo }.eval(DVec3::Z);
            let factors = LightFactors { f, mis_factor: batch.light.mis_factor.0[lane] };
            let sample = batch.light.get(lane);
            self.push_light_sample(state, ctx, &sample, factors, None, &mut queues.shadow);
        }
        if may_scatter {
            self.connect_diffuse(state, ctx, batch, lane, &mut queues.shadow);
        }
        let (direction, pdf) = (batch.bsdf.direction.get(lane), batch.bsdf.pdf.0[lane]);
        if pdf <= 0.0 || !may_scatter {
            return None;
        }
        let cos = || direction.dot(ctx.hit.facing_normal()) as f32;
        let weight = if fault!(CosineTwice) { albedo * cos() } else { albedo };
        let sample = BsdfSample { wi: DVec3::Z, weight, pdf, lobe: Lobe::Diffuse, eta: 1.0 };
        self.continue_lane(state, ctx, &sample, batch, lane)
    }

    /// Adds the connections of a Lambertian vertex.
    #[inline(always)]
    fn connect_diffuse(
        &mut self,
        state: &PathState,
        ctx: &LightSampleContext,
        batch: &VertexBatch,
        lane: usize,
        shadow_queue: &mut ShadowQueue<'_>,
    ) {
        let Some(pairs) = self.context.prepared.connections() else { return };
        let Vertex { color: albedo, has_arrival, .. } = batch.vertices[lane];
        // In vacuum, and none of the pairs is worth it.
        if batch.pairs.0[lane] == 0 && !has_arrival && !pairs.needs_choice() {
            return;
        }
        let bsdf = &Bsdf::Diffuse(Diffuse { albedo }, Hemisphere::Cosine);
        let frame = &Frame::from_z(ctx.hit.facing_normal());
        let scattering = Scattering { ctx, bsdf, frame, wo: DVec3::Z, crossing: None };
        self.add_connections(state, &scattering, &LaneNumbers { batch, lane }, shadow_queue);
    }

    #[inline(always)]
    pub(super) fn finish_mirror(
        &mut self,
        batch: &VertexBatch,
        lane: usize,
        queues: &mut StageQueues<'_>,
    ) -> Option<PathRay> {
        let Vertex { path, color: weight, has_arrival, .. } = batch.vertices[lane];
        if has_arrival {
            self.arrive(batch, lane, queues)?;
        }
        let state = &mut queues.paths.states[path as usize];
        let hit = batch.hit(lane);
        let ctx = &LightSampleContext { hit, is_two_sided: false, is_lambertian: false };
        let sample = BsdfSample { wi: DVec3::Z, weight, pdf: 1.0, lobe: Lobe::Delta, eta: 1.0 };
        self.continue_lane(state, ctx, &sample, batch, lane)
    }

    #[inline(always)]
    pub(super) fn finish_any(
        &mut self,
        batch: &VertexBatch,
        lane: usize,
        queues: &mut StageQueues<'_>,
    ) -> Option<PathRay> {
        let Arrival { surface, eta, crossing } = self.arrive(batch, lane, queues)?;
        let hit = batch.hit(lane);
        let wo = -batch.rays.direction.get(lane);
        let vertex = SurfaceVertex { hit, wo, surface, eta, crossing };
        let state = &mut queues.paths.states[batch.vertices[lane].path as usize];
        let numbers = LaneNumbers { batch, lane };
        self.sample_light_and_bsdf(state, &vertex, &numbers, &mut queues.shadow)
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
        let from = (ctx, batch.light.categories[lane]);
        self.scatter(state, from, sample, direction, None, &LaneNumbers { batch, lane })
    }
}
