//! The stages that compile to vector instructions. Their loop bodies are the functions that the
//! scalar code calls, so both give the same bits.

use crate::fault::fault;
use crate::geometry::Sphere;
use crate::light::specular::{PairWorth, is_accepted};
use crate::light::{Emitter, EmitterCut, LightSource, sample_cut_in_lane, sample_in_lane};
use crate::material::{Diffuse, Mirror};
use crate::math::{DVec3, Frame, LANES, Lanes, SimdKernel, renormalize};
use crate::sampling::SobolLanes;
use crate::scene::settings::Estimator;

use super::super::super::dimension::VertexDimensions;
use super::super::weight::light_weight;
use super::vertex_batch::{SampledSource, VertexBatch};

/// The random numbers that a batch needs.
#[derive(Clone, Copy)]
pub(super) struct Needs {
    pub(super) light: bool,
    pub(super) light_selection: bool,
    pub(super) direction: bool,
    pub(super) lobe: bool,
    pub(super) roulette: bool,
    pub(super) connection: bool,
}

/// Computes the hit points.
pub(super) struct Intersect<'a> {
    pub(super) batch: &'a mut VertexBatch,
}

impl SimdKernel for Intersect<'_> {
    #[inline(always)]
    fn run(self) {
        let VertexBatch { rays, hit, .. } = self.batch;
        for lane in 0..LANES {
            let sphere = Sphere { center: rays.center.get(lane), radius: rays.radius.0[lane] };
            let (origin, direction) = (rays.origin.get(lane), rays.direction.get(lane));
            let (t_exit, is_exit) = (rays.t_exit.0[lane], rays.is_exit.0[lane]);
            let t = sphere.hit_distance(origin, direction, rays.t_min.0[lane]);
            hit.is_lost.0[lane] = !is_exit & (t >= t_exit);
            let t = if is_exit { t_exit } else { t };
            let (point, normal) = sphere.reproject(origin, direction, t);
            let is_inside = is_exit | (direction.dot(normal) > 0.0);
            hit.set(lane, t, point, normal, is_inside);
            let flipped = if fault!(NormalFacesAway) { normal } else { -normal };
            hit.facing_normal.set(lane, if is_inside { flipped } else { normal });
        }
    }
}

/// Draws the random numbers.
pub(super) struct DrawNumbers<'a> {
    pub(super) batch: &'a mut VertexBatch,
    pub(super) needs: Needs,
}

impl SimdKernel for DrawNumbers<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { batch: VertexBatch { sobol, depth, numbers, .. }, needs } = self;
        let first = VertexDimensions::at(1);
        if needs.light {
            select_set(sobol, depth, VertexDimensions::light_direction);
            draw_2d(sobol, first.light_direction(), &mut numbers.light);
        }
        if needs.direction {
            select_set(sobol, depth, VertexDimensions::bsdf_direction);
            draw_2d(sobol, first.bsdf_direction(), &mut numbers.direction);
        }
        if needs.connection {
            select_set(sobol, depth, VertexDimensions::connection_choice);
            draw_2d(sobol, first.connection_choice(), &mut numbers.connection);
        }
        if needs.light_selection || needs.lobe || needs.roulette {
            // They share a set.
            select_set(sobol, depth, VertexDimensions::lobe);
            if needs.light_selection {
                draw(sobol, first.light_selection(), &mut numbers.light_selection);
            }
            if needs.lobe {
                draw(sobol, first.lobe(), &mut numbers.lobe);
            }
            if needs.roulette {
                draw(sobol, first.roulette(), &mut numbers.roulette);
            }
        }
    }
}

/// Selects the set of a dimension, which depends on a path's depth.
#[inline(always)]
fn select_set(
    sobol: &mut SobolLanes,
    depth: &Lanes<u32>,
    dimension: impl Fn(VertexDimensions) -> u32,
) {
    sobol.select_set(|lane| dimension(VertexDimensions::at(depth.0[lane])) / SobolLanes::SET_SIZE);
}

/// Draws a dimension of the selected set.
#[inline(always)]
fn draw(sobol: &SobolLanes, dimension: u32, numbers: &mut Lanes<f64>) {
    sobol.get(dimension % SobolLanes::SET_SIZE, numbers);
}

/// Draws two consecutive dimensions of the selected set.
#[inline(always)]
fn draw_2d(sobol: &SobolLanes, dimension: u32, [first, second]: &mut [Lanes<f64>; 2]) {
    draw(sobol, dimension, first);
    draw(sobol, dimension + 1, second);
}

/// Samples the only light: an emitter.
pub(super) struct SampleSingleEmitter<'a, const IS_LAMBERTIAN: bool> {
    pub(super) batch: &'a mut VertexBatch,
    pub(super) emitter: Emitter,
    pub(super) sphere: Sphere,
}

impl<const IS_LAMBERTIAN: bool> SimdKernel for SampleSingleEmitter<'_, IS_LAMBERTIAN> {
    #[inline(always)]
    fn run(self) {
        let Self { batch: VertexBatch { hit, light, vertices, numbers, .. }, emitter, sphere } =
            self;
        light.sources = [source_of(&emitter); LANES];
        for (lane, vertex) in vertices.iter().enumerate() {
            let at = hit.lane_point(lane, vertex.id);
            let u = VertexBatch::pair(&numbers.light, lane);
            light.set_lane(lane, &sample_in_lane::<IS_LAMBERTIAN>(&at, &sphere, u));
        }
    }
}

/// Samples the only light: an emitter that walls cut.
pub(super) struct SampleCutEmitter<'a, const IS_LAMBERTIAN: bool> {
    pub(super) batch: &'a mut VertexBatch,
    pub(super) emitter: Emitter,
    pub(super) sphere: Sphere,
    pub(super) cut: &'a EmitterCut,
}

impl<const IS_LAMBERTIAN: bool> SimdKernel for SampleCutEmitter<'_, IS_LAMBERTIAN> {
    #[inline(always)]
    fn run(self) {
        let Self { batch, emitter, sphere, cut } = self;
        let VertexBatch { hit, light, vertices, numbers, .. } = batch;
        light.sources = [source_of(&emitter); LANES];
        let cut = *cut;
        for (lane, vertex) in vertices.iter().enumerate() {
            let at = hit.lane_point(lane, vertex.id);
            let u = VertexBatch::pair(&numbers.light, lane);
            light.set_lane(lane, &sample_cut_in_lane::<IS_LAMBERTIAN>(&at, &sphere, &cut, u));
        }
    }
}

fn source_of(emitter: &Emitter) -> SampledSource {
    SampledSource { source: LightSource::Emitter(emitter.id), radiance: emitter.emission }
}

/// Finds the pairs of a polished ball and a light that are worth a connection.
pub(super) struct ChoosePairs<'a> {
    pub(super) batch: &'a mut VertexBatch,
    pub(super) worths: &'a [PairWorth],
}

impl SimdKernel for ChoosePairs<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { batch: VertexBatch { hit, numbers, pairs, .. }, worths } = self;
        let u = &numbers.connection[1];
        pairs.0 = [0; LANES];
        for (n, pair) in (0..).zip(worths) {
            let pair = *pair;
            if pair.is_dielectric() {
                for lane in 0..LANES {
                    let worth = pair.at::<true>(hit.point.get(lane));
                    pairs.0[lane] |= u32::from(is_accepted(u.0[lane], n, worth)) << n;
                }
            } else {
                for lane in 0..LANES {
                    let worth = pair.at::<false>(hit.point.get(lane));
                    pairs.0[lane] |= u32::from(is_accepted(u.0[lane], n, worth)) << n;
                }
            }
        }
    }
}

/// Weights the light samples of Lambertian surfaces and samples directions.
pub(super) struct ScatterDiffuse<'a> {
    pub(super) batch: &'a mut VertexBatch,
    pub(super) estimator: Estimator,
}

impl SimdKernel for ScatterDiffuse<'_> {
    #[inline(always)]
    fn run(self) {
        let VertexBatch { numbers, hit, light, bsdf, .. } = self.batch;
        for lane in 0..LANES {
            let normal = hit.facing_normal.get(lane);
            let wi = DVec3::new(0.0, 0.0, normal.dot(light.direction.get(lane)));
            let (pdf, pdf_bsdf) = (light.pdf.0[lane], Diffuse::pdf_cosine(wi));
            let weight = light_weight(self.estimator, light.is_exact.0[lane], pdf, pdf_bsdf);
            let cos = if fault!(DirectCosineMissing) { 1.0 } else { wi.z };
            let factor = (weight * cos / pdf) as f32;
            light.mis_factor.0[lane] = if wi.z > 0.0 { factor } else { 0.0 };
        }
        for lane in 0..LANES {
            let u = VertexBatch::pair(&numbers.direction, lane);
            let u = if fault!(RandomNumberReused) { [u[0]; 2] } else { u };
            let (wi, pdf) = Diffuse::sample_cosine(u);
            let frame = Frame::from_z(hit.facing_normal.get(lane));
            bsdf.direction.set(lane, renormalize(frame.to_world(wi)));
            bsdf.pdf.0[lane] = pdf;
        }
    }
}

/// Reflects paths at mirrors.
pub(super) struct ReflectAtMirror<'a> {
    pub(super) batch: &'a mut VertexBatch,
}

impl SimdKernel for ReflectAtMirror<'_> {
    #[inline(always)]
    fn run(self) {
        let VertexBatch { rays, hit, bsdf, .. } = self.batch;
        for lane in 0..LANES {
            let frame = Frame::from_z(hit.facing_normal.get(lane));
            let wi = Mirror::reflect(frame.to_local(-rays.direction.get(lane)));
            bsdf.direction.set(lane, renormalize(frame.to_world(wi)));
            bsdf.pdf.0[lane] = 1.0;
        }
    }
}
