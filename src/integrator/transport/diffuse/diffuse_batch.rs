//! Diffuse vertices in lanes (structure of arrays), and the stages that process them.

use crate::color::Rgb;
use crate::fault::fault;
use crate::geometry::{PathRay, Sphere};
use crate::light::{
    Emitter, EmitterCut, LaneLightSample, LightSample, sample_cut_emitter, sample_projected,
};
use crate::material::Diffuse;
use crate::math::{DVec3, Frame, LANES, Lanes, Lanes3, NO_SPHERE, SimdKernel, renormalize};
use crate::sampling::{Sampler, SobolLanes};
use crate::scene::settings::Estimator;

use super::super::super::dimension::VertexDimensions;
use super::super::weight::light_weight;

/// A batch of diffuse vertices that are shaded together.
#[derive(Default)]
pub(in super::super::super) struct DiffuseBatch {
    /// Number of lanes in use; the remaining lanes hold stale data.
    pub(super) count: usize,
    /// Per-vertex data that no stage computes with.
    pub(super) vertices: [DiffuseVertex; LANES],
    sobol: SobolLanes,
    depth: Lanes<u32>,
    origin: Lanes3,
    direction: Lanes3,
    t_min: Lanes<f64>,
    center: Lanes3,
    radius: Lanes<f64>,
    pub(super) hit: HitLanes,
    pub(super) light: LightSampleLanes,
    pub(super) bsdf: BsdfSampleLanes,
}

/// Per-vertex data: path index in the batch, sphere and colour.
#[derive(Clone, Copy, Default)]
pub(super) struct DiffuseVertex {
    pub(super) path_index: u32,
    pub(super) id: u32,
    pub(super) albedo: Rgb,
}

/// Hit points of the rays.
#[derive(Default)]
pub(super) struct HitLanes {
    pub(super) point: Lanes3,
    pub(super) normal: Lanes3,
    /// Cosine between the ray and the outward normal: positive from inside.
    pub(super) cos: Lanes<f64>,
}

/// Light samples.
#[derive(Default)]
pub(super) struct LightSampleLanes {
    pub(super) u_select: Lanes<f64>,
    pub(super) u: [Lanes<f64>; 2],
    pub(super) direction: Lanes3,
    pub(super) distance: Lanes<f64>,
    /// 0 where the emitter is not visible; negative inside an emitter.
    pub(super) pdf: Lanes<f64>,
    /// True where BSDF sampling need not find the emitter as well.
    is_exact: Lanes<bool>,
    /// True where the horizon cuts the only emitter, which the scalar code then samples.
    pub(super) is_cut_by_horizon: Lanes<bool>,
    /// `weight cos / pdf`.
    pub(super) mis_factor: Lanes<f32>,
    pub(super) sampled: [SampledLight; LANES],
}

/// The contribution of a light sample and its target sphere.
#[derive(Clone, Copy)]
pub(super) struct SampledLight {
    pub(super) radiance: Rgb,
    pub(super) sphere_id: u32,
}

/// The sampled directions in which paths continue.
#[derive(Default)]
pub(super) struct BsdfSampleLanes {
    u: [Lanes<f64>; 2],
    pub(super) direction: Lanes3,
    pub(super) pdf: Lanes<f64>,
    /// Cosine between the direction and the outward normal.
    pub(super) cos: Lanes<f64>,
}

impl Default for SampledLight {
    fn default() -> Self {
        Self { radiance: Rgb::ZERO, sphere_id: NO_SPHERE }
    }
}

impl DiffuseBatch {
    /// Returns true if the batch is full.
    pub(in super::super) fn is_full(&self) -> bool {
        self.count == LANES
    }

    /// Adds a vertex where `ray` hits `sphere` at the end of edge `depth`.
    #[inline(always)]
    pub(super) fn push(
        &mut self,
        vertex: DiffuseVertex,
        ray: &PathRay,
        sphere: &Sphere,
        sampler: Sampler,
        depth: u32,
    ) {
        let lane = self.count;
        if lane >= LANES {
            return;
        }
        self.vertices[lane] = vertex;
        self.origin.set(lane, ray.origin);
        self.direction.set(lane, ray.direction);
        self.t_min.0[lane] = ray.t_min;
        self.center.set(lane, sphere.center);
        self.radius.0[lane] = sphere.radius;
        sampler.store_in_lane(&mut self.sobol, lane);
        self.depth.0[lane] = depth;
        self.count += 1;
    }
}

impl LightSampleLanes {
    /// Stores a sample of the only emitter.
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, light: &LaneLightSample, is_outside: bool) {
        self.direction.set(lane, light.sample.direction);
        self.distance.0[lane] = light.sample.distance;
        self.pdf.0[lane] = if is_outside { light.sample.pdf } else { -1.0 };
        self.is_exact.0[lane] = light.is_projected;
        self.is_cut_by_horizon.0[lane] = is_outside && light.is_cut_by_horizon;
    }

    /// Stores a light sample that was drawn by the scalar code.
    pub(super) fn set(&mut self, lane: usize, sample: Option<LightSample>) {
        self.pdf.0[lane] = sample.map_or(0.0, |sample| sample.pdf);
        self.is_exact.0[lane] = sample.is_some_and(|sample| sample.is_exact);
        let Some(sample) = sample else { return };
        self.direction.set(lane, sample.direction);
        self.distance.0[lane] = sample.distance;
        self.sampled[lane] =
            SampledLight { radiance: sample.radiance, sphere_id: sample.source.sphere_id() };
    }
}

/// Computes the hit points and draws the random numbers for light sampling.
pub(super) struct IntersectLanes<'a> {
    pub(super) batch: &'a mut DiffuseBatch,
    pub(super) needs_selection: bool,
}

impl SimdKernel for IntersectLanes<'_> {
    #[inline(always)]
    fn run(self) {
        let DiffuseBatch {
            sobol, depth, origin, direction, t_min, center, radius, hit, light, ..
        } = self.batch;
        for lane in 0..LANES {
            let sphere = Sphere { center: center.get(lane), radius: radius.0[lane] };
            let (origin, direction) = (origin.get(lane), direction.get(lane));
            let t = sphere.hit_distance(origin, direction, t_min.0[lane]);
            let (point, normal) = sphere.reproject(origin, direction, t);
            hit.point.set(lane, point);
            hit.normal.set(lane, normal);
            hit.cos.0[lane] = direction.dot(normal);
        }
        draw_2d(sobol, depth, &mut light.u, |vertex| vertex.light_direction());
        if self.needs_selection {
            sobol.select_set(|lane| {
                VertexDimensions::at(depth.0[lane]).light_selection() / SobolLanes::SET_SIZE
            });
            sobol.get(
                VertexDimensions::at(1).light_selection() % SobolLanes::SET_SIZE,
                &mut light.u_select,
            );
        }
    }
}

/// Draws two consecutive dimensions; the set depends on a path's depth.
#[inline(always)]
fn draw_2d(
    sobol: &mut SobolLanes,
    depth: &Lanes<u32>,
    [first, second]: &mut [Lanes<f64>; 2],
    dimension: impl Fn(VertexDimensions) -> u32,
) {
    let first_in_set = dimension(VertexDimensions::at(1)) % SobolLanes::SET_SIZE;
    sobol.select_set(|lane| dimension(VertexDimensions::at(depth.0[lane])) / SobolLanes::SET_SIZE);
    sobol.get(first_in_set, first);
    sobol.get(first_in_set + 1, second);
}

/// Samples the only emitter.
pub(super) struct SampleSingleEmitter<'a> {
    pub(super) batch: &'a mut DiffuseBatch,
    pub(super) emitter: Emitter,
    pub(super) sphere: Sphere,
}

impl SimdKernel for SampleSingleEmitter<'_> {
    #[inline(always)]
    fn run(self) {
        let DiffuseBatch { hit, light, .. } = self.batch;
        light.sampled =
            [SampledLight { radiance: self.emitter.emission, sphere_id: self.emitter.id }; LANES];
        let Sphere { center, radius } = self.sphere;
        for lane in 0..LANES {
            let (point, normal) = (hit.point.get(lane), hit.normal.get(lane));
            let u = [light.u[0].0[lane], light.u[1].0[lane]];
            let is_outside = radius < (center - point).length();
            light.set_lane(lane, &sample_projected(point, normal, &self.sphere, u), is_outside);
        }
    }
}

/// Samples the only emitter, which a wall cuts.
pub(super) struct SampleCutEmitter<'a> {
    pub(super) batch: &'a mut DiffuseBatch,
    pub(super) emitter: Emitter,
    pub(super) sphere: Sphere,
    pub(super) cut: &'a EmitterCut,
}

impl SimdKernel for SampleCutEmitter<'_> {
    #[inline(always)]
    fn run(self) {
        let DiffuseBatch { hit, light, vertices, .. } = self.batch;
        light.sampled =
            [SampledLight { radiance: self.emitter.emission, sphere_id: self.emitter.id }; LANES];
        let (sphere, cut) = (self.sphere, *self.cut);
        for (lane, vertex) in vertices.iter().enumerate() {
            let (point, normal) = (hit.point.get(lane), hit.normal.get(lane));
            let u = [light.u[0].0[lane], light.u[1].0[lane]];
            let is_outside = sphere.radius < (sphere.center - point).length();
            let sample = sample_cut_emitter(&cut, vertex.id, (point, normal), &sphere, u);
            light.set_lane(lane, &sample, is_outside);
        }
    }
}

/// Weights the light samples and samples the BSDF directions.
pub(super) struct SampleBsdfLanes<'a> {
    pub(super) batch: &'a mut DiffuseBatch,
    pub(super) estimator: Estimator,
}

impl SimdKernel for SampleBsdfLanes<'_> {
    #[inline(always)]
    fn run(self) {
        let DiffuseBatch { sobol, depth, hit, light, bsdf, .. } = self.batch;
        draw_2d(sobol, depth, &mut bsdf.u, |vertex| vertex.bsdf_direction());
        for lane in 0..LANES {
            let normal = hit.normal.get(lane);
            let wi = DVec3::new(0.0, 0.0, normal.dot(light.direction.get(lane)));
            let (pdf, pdf_bsdf) = (light.pdf.0[lane], Diffuse::pdf_cosine(wi));
            let weight = light_weight(self.estimator, light.is_exact.0[lane], pdf, pdf_bsdf);
            let cos = if fault!(DirectCosineMissing) { 1.0 } else { wi.z };
            let factor = (weight * cos / pdf) as f32;
            light.mis_factor.0[lane] = if wi.z > 0.0 { factor } else { 0.0 };
        }
        for lane in 0..LANES {
            let normal = hit.normal.get(lane);
            let u = [bsdf.u[0].0[lane], bsdf.u[1].0[lane]];
            let u = if fault!(RandomNumberReused) { [u[0]; 2] } else { u };
            let (wi, pdf) = Diffuse::sample_cosine(u);
            let direction = renormalize(Frame::from_z(normal).to_world(wi));
            bsdf.direction.set(lane, direction);
            bsdf.pdf.0[lane] = pdf;
            bsdf.cos.0[lane] = direction.dot(normal);
        }
    }
}
