//! Diffuse fast path: shades vertices on diffuse surfaces in lanes.
//!
//! Most vertices of most pictures are alike: an opaque diffuse surface, hit from outside, lit by
//! emitters seen from outside. They are collected field by field in a [`DiffuseBatch`] and go
//! through its stages, whose loops over the lanes compile to vector instructions (see
//! [`crate::math::Isa`]). The loop bodies are the functions that
//! [`PathBatch::sample_light_and_bsdf`] calls for a single path, so both give the same bits.
//! Vertices that turn out to be different fall back to [`PathBatch::sample_light_and_bsdf`].

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
    DiffuseVertex, IntersectLanes, SampleBsdfLanes, SampleSingleEmitter, SampledLight,
};

/// A diffuse surface. Data passed between stages for every path is kept small, and is not written
/// and read back in pieces of other sizes, which stalls store forwarding.
#[derive(Clone, Copy)]
pub(super) struct DiffuseSurface<'a> {
    albedo: Rgb,
    emission: &'a Rgb,
}

impl<'a, R: PathRecorder> PathBatch<'a, R> {
    /// Returns true if diffuse surfaces are shaded in lanes: not while recording, and not where the
    /// scene or the integrator makes their vertices differ from each other.
    pub(super) fn uses_diffuse_batch(&self) -> bool {
        let (scene, transport) = (self.context.scene, self.integrator);
        !R::ENABLED
            && !scene.has_opacity()
            && transport.hemisphere == Hemisphere::Cosine
            && transport.max_scatterings == u32::MAX
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
        block: &mut DiffuseBatch,
        paths: &PathQueue,
        index: usize,
        id: u32,
        DiffuseSurface { albedo, emission }: DiffuseSurface<'_>,
    ) {
        let state = &paths.states[index];
        if emission.max_element() > 0.0 {
            self.add_emission(&paths.get(index), LightSource::Emitter(id), *emission, true);
        }
        if self.is_at_max_depth(state) {
            return;
        }
        if state.depth >= MAX_PATH_EDGES {
            self.terminate_at_length_limit();
            return;
        }
        let waiting = DiffuseVertex { path_index: index as u32, id, albedo };
        let sphere = self.context.scene.spheres().sphere(id);
        let sampler = self.samplers[state.batch_index as usize];
        block.push(waiting, &paths.rays.get(index), &sphere, sampler, state.depth);
    }

    /// Shades the vertices of a batch and empties it. Continuing paths are appended to `next`.
    pub(super) fn flush_diffuse(
        &mut self,
        isa: Isa,
        block: &mut DiffuseBatch,
        paths: &PathQueue,
        next: &mut PathQueue,
        shadow_queue: &mut ShadowQueue<'_>,
    ) {
        if block.count == 0 {
            return;
        }
        let scene = self.context.scene;
        let lights = self.context.prepared.lights();
        let estimator = self.integrator.estimator;
        isa.run(IntersectLanes { block, needs_selection: lights.needs_selection() });
        if estimator == Estimator::Bsdf {
            block.light.pdf.0.fill(0.0);
        } else if let Some(&emitter) = lights.single_emitter() {
            let sphere = scene.spheres().sphere(emitter.id);
            isa.run(SampleSingleEmitter { block, emitter, sphere });
        } else {
            for lane in 0..block.count {
                let ctx = LightSampleContext { hit: lane_hit(block, lane), is_two_sided: false };
                let u = [block.light.u[0].0[lane], block.light.u[1].0[lane]];
                let choose = block.light.u_select.0[lane];
                let sample = lights.sample(scene.spheres(), &ctx, choose, u);
                block.light.set(lane, sample);
            }
        }
        isa.run(SampleBsdfLanes { block, estimator });
        for lane in 0..block.count {
            self.continue_lane(block, lane, paths, next, shadow_queue);
        }
        block.count = 0;
    }

    /// Applies the result of a lane to its path.
    #[inline(always)]
    fn continue_lane(
        &mut self,
        block: &DiffuseBatch,
        lane: usize,
        paths: &PathQueue,
        next: &mut PathQueue,
        shadow_queue: &mut ShadowQueue<'_>,
    ) {
        let DiffuseVertex { path_index: path, id, albedo } = block.vertices[lane];
        let SampledLight { radiance, sphere_id: emitter } = block.light.sampled[lane];
        let (pdf_light, pdf) = (block.light.pdf.0[lane], block.bsdf.pdf.0[lane]);
        let is_own_emitter = emitter == id;
        let is_inside_emitter = pdf_light < 0.0 && !is_own_emitter;
        if block.hit.cos.0[lane] > 0.0 || is_inside_emitter || block.bsdf.cos.0[lane] < 0.0 {
            return self.continue_scalar(id, paths.get(path as usize), next, shadow_queue);
        }
        let mut state = paths.states[path as usize];
        let (point, normal) = (block.hit.point.get(lane), block.hit.normal.get(lane));
        if pdf_light > 0.0 && !is_own_emitter {
            let f = Diffuse { albedo }.eval(DVec3::Z);
            let light = state.throughput * f * radiance * block.light.mis_factor.0[lane];
            if light != Rgb::ZERO {
                let (direction, t_max) =
                    (block.light.direction.get(lane), block.light.distance.0[lane]);
                let free = PathRay::new(point, direction);
                let ray = PathRay { origin_sphere: id, target_sphere: emitter, t_max, ..free };
                let is_direct = state.is_light_sample_direct();
                shadow_queue.shadow_rays.push(
                    &ray,
                    PendingDirect { batch_index: state.batch_index, radiance: light, is_direct },
                );
            }
        }
        let cos = if fault!(CosineTwice) { block.bsdf.cos.0[lane] as f32 } else { 1.0 };
        state.throughput *= albedo * cos;
        state.scatter_count += 1;
        state.has_prev_vertex = true;
        if pdf > 0.0 && self.survives(&mut state) {
            state.depth += 1;
            let free = PathRay::new(point, block.bsdf.direction.get(lane));
            next.rays.push(&PathRay { origin_sphere: id, ..free });
            next.states.push(state);
            let (side, is_two_sided) = (Side::Outside, false);
            self.prev_vertices[state.batch_index as usize] =
                PrevVertex { pdf, point, normal, id, side, is_two_sided };
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
fn lane_hit(block: &DiffuseBatch, lane: usize) -> SurfaceHit {
    let DiffuseVertex { id, .. } = block.vertices[lane];
    SurfaceHit {
        id,
        t: 0.0,
        point: block.hit.point.get(lane),
        normal: block.hit.normal.get(lane),
        radius: 0.0,
        side: Side::Outside,
    }
}
