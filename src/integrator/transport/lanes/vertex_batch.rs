//! Vertices in lanes (structure of arrays).

use crate::color::Rgb;
use crate::geometry::{PathRay, Side, Sphere, SurfaceHit};
use crate::light::{
    CategoryPmf, LaneHorizon, LaneLightSample, LanePoint, LightSample, LightSource,
};
use crate::math::{DVec3, Hit, LANES, Lanes, Lanes3, NO_SPHERE};
use crate::sampling::{Sampler, SobolLanes};

use super::connection_lanes::ConnectionLanes;
use super::vertex_kind::VertexKind;

/// The vertices that are shaded together: all of one kind.
#[derive(Default)]
pub(in super::super) struct VertexBatch {
    /// Number of lanes in use; the remaining lanes hold stale data.
    pub(super) count: usize,
    pub(super) vertices: [Vertex; LANES],
    pub(super) sobol: SobolLanes,
    /// Number of edges of the paths.
    pub(super) depth: Lanes<u32>,
    pub(super) rays: ArrivingRays,
    pub(super) hit: HitLanes,
    pub(super) numbers: NumberLanes,
    pub(super) light: LightSampleLanes,
    pub(super) bsdf: BsdfSampleLanes,
    /// The pairs of a polished ball and a light that are worth a connection from outside of all
    /// balls, as a set of bits, where all pairs are tried.
    pub(super) pairs: Lanes<u32>,
    pub(super) connections: ConnectionLanes,
}

/// A batch for each kind. Not on the stack: rayon's tasks, of which each has batches, nest.
pub(in super::super::super) struct VertexBatches {
    batches: Vec<VertexBatch>,
}

/// Per-vertex data that no vector stage computes with.
#[derive(Clone, Copy, Default)]
pub(super) struct Vertex {
    /// Index of the path in its queue.
    pub(super) path: u32,
    /// The sphere.
    pub(super) id: u32,
    /// Albedo of a diffuse surface, reflectance of a mirror.
    pub(super) color: Rgb,
    /// True if the path has something to do before it is scattered: to be dimmed by the medium
    /// behind it, to find emission, or to cross a boundary.
    pub(super) has_arrival: bool,
}

/// The rays that arrive, and the spheres that they hit.
#[derive(Default)]
pub(super) struct ArrivingRays {
    pub(super) direction: Lanes3,
    pub(super) origin: Lanes3,
    pub(super) t_min: Lanes<f64>,
    pub(super) t_exit: Lanes<f64>,
    /// True if the ray hits the exit point of the sphere that it went into.
    pub(super) is_exit: Lanes<bool>,
    pub(super) center: Lanes3,
    pub(super) radius: Lanes<f64>,
}

/// Hit points.
#[derive(Default)]
pub(super) struct HitLanes {
    pub(super) t: Lanes<f64>,
    pub(super) point: Lanes3,
    pub(super) normal: Lanes3,
    /// The normal on the side that the ray arrives from.
    pub(super) facing_normal: Lanes3,
    pub(super) is_inside: Lanes<bool>,
    /// True if the sphere lies behind the ray's exit point after all.
    pub(super) is_lost: Lanes<bool>,
}

/// Random numbers.
#[derive(Default)]
pub(super) struct NumberLanes {
    pub(super) light: [Lanes<f64>; 2],
    pub(super) light_selection: Lanes<f64>,
    pub(super) direction: [Lanes<f64>; 2],
    pub(super) lobe: Lanes<f64>,
    pub(super) roulette: Lanes<f64>,
    pub(super) connection: [Lanes<f64>; 2],
}

/// Light samples.
pub(super) struct LightSampleLanes {
    pub(super) direction: Lanes3,
    pub(super) distance: Lanes<f64>,
    /// 0 where there is no sample.
    pub(super) pdf: Lanes<f64>,
    /// True where BSDF sampling need not find the emitter as well.
    pub(super) is_exact: Lanes<bool>,
    /// True where the scalar code has to sample.
    pub(super) is_missing: Lanes<bool>,
    /// True where the horizon cuts the emitter and no sample is drawn yet, and where its centre is
    /// below the horizon.
    pub(super) is_cut: Lanes<bool>,
    pub(super) is_lune: Lanes<bool>,
    /// `weight cos / pdf`.
    pub(super) mis_factor: Lanes<f32>,
    pub(super) sources: [SampledSource; LANES],
    /// The probabilities of each category of lights.
    pub(super) categories: [CategoryPmf; LANES],
}

/// The light of a light sample.
#[derive(Clone, Copy)]
pub(super) struct SampledSource {
    pub(super) source: LightSource,
    pub(super) radiance: Rgb,
}

/// The sampled directions in which paths continue.
#[derive(Default)]
pub(super) struct BsdfSampleLanes {
    pub(super) direction: Lanes3,
    pub(super) pdf: Lanes<f64>,
}

impl Default for VertexBatches {
    fn default() -> Self {
        Self { batches: (0..VertexKind::COUNT).map(|_| VertexBatch::default()).collect() }
    }
}

impl Default for LightSampleLanes {
    fn default() -> Self {
        Self {
            direction: Lanes3::default(),
            distance: Lanes::default(),
            pdf: Lanes::default(),
            is_exact: Lanes::default(),
            is_missing: Lanes::default(),
            is_cut: Lanes::default(),
            is_lune: Lanes::default(),
            mis_factor: Lanes::default(),
            sources: [SampledSource::default(); LANES],
            categories: [CategoryPmf::NONE; LANES],
        }
    }
}

impl Default for SampledSource {
    fn default() -> Self {
        Self { source: LightSource::Environment, radiance: Rgb::ZERO }
    }
}

impl VertexBatches {
    /// Returns the batch of a kind.
    #[inline(always)]
    pub(super) fn of_kind(&mut self, kind: VertexKind) -> &mut VertexBatch {
        &mut self.batches[kind as usize]
    }
}

impl VertexBatch {
    /// Returns true if the batch is full.
    pub(super) fn is_full(&self) -> bool {
        self.count == LANES
    }

    /// Adds a vertex at the end of edge `depth`, where a ray hits a sphere, or its exit point
    /// there.
    #[inline(always)]
    pub(super) fn push(
        &mut self,
        vertex: Vertex,
        ray: &PathRay,
        (sphere, is_exit): (&Sphere, bool),
        sampler: Sampler,
        depth: u32,
    ) {
        let lane = self.count;
        if lane >= LANES {
            return;
        }
        self.vertices[lane] = vertex;
        self.rays.origin.set(lane, ray.origin);
        self.rays.direction.set(lane, ray.direction);
        self.rays.t_min.0[lane] = ray.t_min;
        self.rays.t_exit.0[lane] = ray.t_exit;
        self.rays.is_exit.0[lane] = is_exit;
        self.rays.center.set(lane, sphere.center);
        self.rays.radius.0[lane] = sphere.radius;
        sampler.store_in_lane(&mut self.sobol, lane);
        self.depth.0[lane] = depth;
        self.count += 1;
    }

    /// Returns the hit of a lane.
    #[inline(always)]
    pub(super) fn hit(&self, lane: usize) -> SurfaceHit {
        SurfaceHit {
            id: self.vertices[lane].id,
            t: self.hit.t.0[lane],
            point: self.hit.point.get(lane),
            normal: self.hit.normal.get(lane),
            radius: self.rays.radius.0[lane],
            side: side_of(self.hit.is_inside.0[lane]),
        }
    }

    /// Returns the hit as the backend found it.
    pub(super) fn backend_hit(&self, lane: usize) -> Hit {
        let id = if self.rays.is_exit.0[lane] { NO_SPHERE } else { self.vertices[lane].id };
        if id == NO_SPHERE { Hit::MISS } else { Hit { t: 0.0, id } }
    }

    /// Returns two random numbers of a lane.
    #[inline(always)]
    pub(super) fn pair(pair: &[Lanes<f64>; 2], lane: usize) -> [f64; 2] {
        [pair[0].0[lane], pair[1].0[lane]]
    }
}

impl LightSampleLanes {
    /// Stores a sample of an emitter.
    #[inline(always)]
    pub(super) fn set_lane(&mut self, lane: usize, light: &LaneLightSample) {
        self.direction.set(lane, light.sample.direction);
        self.distance.0[lane] = light.sample.distance;
        self.pdf.0[lane] = light.sample.pdf;
        self.is_exact.0[lane] = light.is_projected;
        self.is_missing.0[lane] = light.is_missing;
        let LaneHorizon { is_cut, is_lune } = light.horizon;
        self.is_cut.0[lane] = is_cut;
        self.is_lune.0[lane] = is_lune;
    }

    /// Stores a light sample that was drawn by the scalar code.
    pub(super) fn set(&mut self, lane: usize, sample: Option<LightSample>) {
        self.pdf.0[lane] = sample.map_or(0.0, |sample| sample.pdf);
        self.is_exact.0[lane] = sample.is_some_and(|sample| sample.is_exact);
        let Some(LightSample { source, direction, distance, radiance, .. }) = sample else {
            return;
        };
        self.direction.set(lane, direction);
        self.distance.0[lane] = distance;
        self.sources[lane] = SampledSource { source, radiance };
    }

    /// Returns the sample of a lane.
    #[inline(always)]
    pub(super) fn get(&self, lane: usize) -> LightSample {
        let SampledSource { source, radiance } = self.sources[lane];
        LightSample {
            source,
            direction: self.direction.get(lane),
            distance: self.distance.0[lane],
            radiance,
            pdf: self.pdf.0[lane],
            is_exact: self.is_exact.0[lane],
        }
    }
}

impl HitLanes {
    /// Returns the point of a hit on a sphere.
    #[inline(always)]
    pub(super) fn lane_point(&self, lane: usize, id: u32) -> LanePoint {
        LanePoint {
            id,
            point: self.point.get(lane),
            facing_normal: self.facing_normal.get(lane),
            side: side_of(self.is_inside.0[lane]),
        }
    }

    /// Stores a hit.
    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, t: f64, point: DVec3, normal: DVec3, inside: bool) {
        self.t.0[lane] = t;
        self.point.set(lane, point);
        self.normal.set(lane, normal);
        self.is_inside.0[lane] = inside;
    }
}

/// Returns the side of a hit.
#[inline(always)]
fn side_of(is_inside: bool) -> Side {
    if is_inside { Side::Inside } else { Side::Outside }
}
