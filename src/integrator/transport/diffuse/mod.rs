//! Diffuse fast path: shades vertices on diffuse surfaces in lanes.
//!
//! Most vertices of most pictures lie on an opaque diffuse surface, hit from outside and lit by
//! emitters seen from outside. A [`DiffuseBatch`] stores them as a structure of arrays and shades
//! them in stages, whose loops over the lanes compile to vector instructions (see
//! [`crate::math::Isa`]). The loop bodies are the functions that
//! [`PathBatch::sample_light_and_bsdf`] calls for a single path, so both give the same bits. Other
//! vertices fall back to [`PathBatch::sample_light_and_bsdf`].

mod diffuse_batch;

use crate::color::Rgb;
use crate::fault::fault;
use crate::geometry::{PathRay, Side, SurfaceHit};
use crate::light::{LightSampleContext, LightSource};
use crate::material::{Diffuse, Model};
use crate::math::{DVec3, Hit, Isa};
use crate::sampling::{Hemisphere, SamplerKind};
use crate::scene::settings::Estimator;

use super::super::trace::PathRecorder;
use super::batch::PathBatch;
use super::paths::{MAX_PATH_EDGES, Path, PathQueue, PendingDirect, PrevVertex, ShadowQueue};

pub(in super::super) use diffuse_batch::DiffuseBatch;
use diffuse_batch::{
    DiffuseVertex, IntersectLanes, SampleBsdfLanes, SampleCutEmitter, SampleSingleEmitter,
    SampledLight,
};

/// A diffuse surface: only what the next stage needs. It stays small, and no stage reads its parts
/// in other sizes than they were written, which would stall store forwarding.
#[derive(Clone, Copy)]
pub(super) struct DiffuseSurface<'a> {
    albedo: Rgb,
    emission: &'a Rgb,
}

impl<'a, R: PathRecorder> PathBatch<'a, R> {
    /// Returns true if diffuse surfaces are shaded in lanes: nothing is recorded, and the scene and
    /// the integrator treat all diffuse vertices alike.
    pub(super) fn uses_diffuse_batch(&self) -> bool {
        let (scene, tracer) = (self.context.scene, self.integrator);
        !R::ENABLED
            && !scene.has_opacity()
            && tracer.hemisphere == Hemisphere::Cosine
            && tracer.max_scatterings == u32::MAX
            && self.context.prepared.render_settings().sampler == SamplerKind::Sobol
    }

    /// Returns the surface that a path hits, if the diffuse fast path supports it.
    #[inline(always)]
    pub(super) fn diffuse_surface(
        &self,
        paths: &PathQueue,
        index: usize,
        hit: Hit,
    ) -> Option<DiffuseSurface<'a>> {
        let sample = paths.states[index].batch_index as usize;
        let is_in_medium = || self.media.get(sample).is_some_and(|media| !media.is_vacuum());
        if hit.is_miss() || paths.rays.is_inward(index) || is_in_medium() {
            return None;
        }
        let (material, color) = self.context.scene.material_and_color(hit.id);
        match &material.model {
            Model::Diffuse(diffuse) => Some(DiffuseSurface {
                albedo: diffuse.with_color(color).albedo,
                emission: &material.emission,
            }),
            _ => None,
        }
    }

    /// Adds the emission at a vertex, and adds the vertex to the batch unless the path ends there.
    #[inline(always)]
    pub(super) fn enqueue_diffuse(
        &mut self,
        batch: &mut DiffuseBatch,
        paths: &PathQueue,
        index: usize,
        id: u32,
        DiffuseSurface { albedo, emission }: DiffuseSurface<'_>,
    ) {
        let state = &paths.states[index];
        if emission.max_element() > 0.0 {
            self.add_emission(&paths.get(index), LightSource::Emitter(id), *emission);
        }
        if self.is_at_max_depth(state) {
            return;
        }
        if state.depth >= MAX_PATH_EDGES {
            self.terminate_at_length_limit();
            return;
        }
        let vertex = DiffuseVertex { path_index: index as u32, id, albedo };
        let sphere = self.context.scene.spheres().sphere(id);
        let sampler = self.samplers[state.batch_index as usize];
        batch.push(vertex, &paths.rays.get(index), &sphere, sampler, state.depth);
    }

    /// Shades the vertices of a batch and empties it. Continuing paths are appended to `next`.
    pub(super) fn flush_diffuse(
        &mut self,
        isa: Isa,
        batch: &mut DiffuseBatch,
        paths: &PathQueue,
        next: &mut PathQueue,
        shadow_queue: &mut ShadowQueue<'_>,
    ) {
        if batch.count == 0 {
            return;
        }
        let scene = self.context.scene;
        let lights = self.context.prepared.lights();
        let estimator = self.integrator.estimator;
        isa.run(IntersectLanes { batch, needs_selection: lights.needs_selection() });
        if estimator == Estimator::Bsdf {
            batch.light.pdf.0.fill(0.0);
        } else if let Some(&emitter) = lights.single_emitter() {
            let sphere = scene.spheres().sphere(emitter.id);
            match lights.single_emitter_cut() {
                Some(cut) => isa.run(SampleCutEmitter { batch, emitter, sphere, cut }),
                None => isa.run(SampleSingleEmitter { batch, emitter, sphere }),
            }
            for lane in 0..batch.count {
                if batch.light.is_cut_by_horizon.0[lane] {
                    self.sample_light_in_lane(batch, lane);
                }
            }
        } else {
            for lane in 0..batch.count {
                self.sample_light_in_lane(batch, lane);
            }
        }
        isa.run(SampleBsdfLanes { batch, estimator });
        for lane in 0..batch.count {
            self.continue_lane(batch, lane, paths, next, shadow_queue);
        }
        batch.count = 0;
    }

    /// Samples a light for one lane.
    fn sample_light_in_lane(&self, batch: &mut DiffuseBatch, lane: usize) {
        let scene = self.context.scene;
        let hit = lane_hit(batch, lane);
        let ctx = LightSampleContext { hit, is_two_sided: false, is_lambertian: true };
        let u = [batch.light.u[0].0[lane], batch.light.u[1].0[lane]];
        let u_select = batch.light.u_select.0[lane];
        let sample = self.context.prepared.lights().sample(scene.spheres(), &ctx, u_select, u);
        batch.light.set(lane, sample);
    }

    /// Applies the result of a lane to its path.
    #[inline(always)]
    fn continue_lane(
        &mut self,
        batch: &DiffuseBatch,
        lane: usize,
        paths: &PathQueue,
        next: &mut PathQueue,
        shadow_queue: &mut ShadowQueue<'_>,
    ) {
        let DiffuseVertex { path_index: path, id, albedo } = batch.vertices[lane];
        let SampledLight { radiance, sphere_id: emitter } = batch.light.sampled[lane];
        let (pdf_light, pdf) = (batch.light.pdf.0[lane], batch.bsdf.pdf.0[lane]);
        let is_own_emitter = emitter == id;
        let is_inside_emitter = pdf_light < 0.0 && !is_own_emitter;
        if batch.hit.cos.0[lane] > 0.0 || is_inside_emitter || batch.bsdf.cos.0[lane] < 0.0 {
            return self.continue_scalar(id, paths.get(path as usize), next, shadow_queue);
        }
        let mut state = paths.states[path as usize];
        let (point, normal) = (batch.hit.point.get(lane), batch.hit.normal.get(lane));
        if pdf_light > 0.0 && !is_own_emitter {
            let f = Diffuse { albedo }.eval(DVec3::Z);
            let light = state.throughput * f * radiance * batch.light.mis_factor.0[lane];
            if light != Rgb::ZERO {
                let (direction, t_max) =
                    (batch.light.direction.get(lane), batch.light.distance.0[lane]);
                let unbounded = PathRay::new(point, direction);
                let ray = PathRay { origin_sphere: id, target_sphere: emitter, t_max, ..unbounded };
                let is_direct = state.is_light_sample_direct();
                let pending =
                    PendingDirect { batch_index: state.batch_index, radiance: light, is_direct };
                shadow_queue.push_from_vacuum(self.context.scene, &ray, pending);
            }
        }
        let cos = if fault!(CosineTwice) { batch.bsdf.cos.0[lane] as f32 } else { 1.0 };
        state.throughput *= albedo * cos;
        state.scatter_count += 1;
        state.has_prev_vertex = true;
        if pdf > 0.0 && self.survives(&mut state) {
            state.depth += 1;
            let unbounded = PathRay::new(point, batch.bsdf.direction.get(lane));
            next.rays.push(&PathRay { origin_sphere: id, ..unbounded });
            next.states.push(state);
            let (side, is_two_sided, is_lambertian) = (Side::Outside, false, true);
            self.prev_vertices[state.batch_index as usize] =
                PrevVertex { pdf, point, normal, id, side, is_two_sided, is_lambertian };
        }
    }

    /// Scalar fallback for a vertex that the lanes do not support.
    #[inline(never)]
    fn continue_scalar(
        &mut self,
        id: u32,
        mut path: Path,
        next: &mut PathQueue,
        shadow_queue: &mut ShadowQueue<'_>,
    ) {
        let scene = self.context.scene;
        let Some(hit) = scene.spheres().resolve_hit(&path.ray, Hit { t: 0.0, id }) else { return };
        if self.sample_light_and_bsdf(
            &mut path,
            &hit,
            &scene.sphere_material(id),
            1.0,
            None,
            shadow_queue,
        ) {
            next.push(&path);
        }
    }
}

/// Returns the hit of a lane's ray on its sphere, from outside.
fn lane_hit(batch: &DiffuseBatch, lane: usize) -> SurfaceHit {
    let DiffuseVertex { id, .. } = batch.vertices[lane];
    SurfaceHit {
        id,
        t: 0.0,
        point: batch.hit.point.get(lane),
        normal: batch.hit.normal.get(lane),
        radius: 0.0,
        side: Side::Outside,
    }
}
