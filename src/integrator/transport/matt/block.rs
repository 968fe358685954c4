//! Vertices side by side, and what is computed for all of them at once.

use crate::color::Rgb;
use crate::fault::fault;
use crate::geometry::{Cone, PathRay, Sphere};
use crate::light::{Lamp, LightSample};
use crate::material::Diffuse;
use crate::math::{DVec3, Frame, LANES, Lanes, Lanes3, NO_SPHERE, Stage, nearly_unit};
use crate::sampling::{Sampler, SobolLanes};
use crate::scene::settings::Estimator;

use super::super::super::dimension::Vertex;
use super::super::weight::weight;

/// Vertices that wait to be worked on together.
#[derive(Default)]
pub(in super::super::super) struct Block {
    /// How many; the lanes behind them hold what was there before.
    pub(super) count: usize,
    /// What is not computed with: which path of the batch, on which sphere, of which colour.
    pub(super) vertices: [Waiting; LANES],
    numbers: SobolLanes,
    depth: Lanes<u32>,
    origin: Lanes3,
    direction: Lanes3,
    t_min: Lanes<f64>,
    center: Lanes3,
    radius: Lanes<f64>,
    pub(super) met: Met,
    pub(super) aim: Aims,
    pub(super) next: Next,
}

/// Which path of the batch, on which sphere, of which colour.
#[derive(Clone, Copy, Default)]
pub(super) struct Waiting {
    pub(super) path: u32,
    pub(super) id: u32,
    pub(super) albedo: Rgb,
}

/// Where the rays meet their spheres.
#[derive(Default)]
pub(super) struct Met {
    pub(super) point: Lanes3,
    pub(super) normal: Lanes3,
    /// Of the ray and the outward normal: positive from inside.
    pub(super) cos: Lanes<f64>,
}

/// Light samples.
#[derive(Default)]
pub(super) struct Aims {
    pub(super) choose: Lanes<f64>,
    pub(super) u: [Lanes<f64>; 2],
    pub(super) direction: Lanes3,
    pub(super) distance: Lanes<f64>,
    /// 0 where nothing can be seen; negative within a lamp.
    pub(super) pdf: Lanes<f64>,
    /// `weight cos / pdf`.
    pub(super) factor: Lanes<f32>,
    pub(super) lights: [Light; LANES],
}

/// What a light sample brings, and the sphere that it aims at.
#[derive(Clone, Copy)]
pub(super) struct Light {
    pub(super) radiance: Rgb,
    pub(super) sphere: u32,
}

/// The directions in which paths go on.
#[derive(Default)]
pub(super) struct Next {
    u: [Lanes<f64>; 2],
    pub(super) direction: Lanes3,
    pub(super) pdf: Lanes<f64>,
    /// Of the direction and the outward normal.
    pub(super) cos: Lanes<f64>,
}

impl Default for Light {
    fn default() -> Self {
        Self { radiance: Rgb::ZERO, sphere: NO_SPHERE }
    }
}

impl Block {
    /// Whether there is no room left.
    pub(in super::super) fn is_full(&self) -> bool {
        self.count == LANES
    }

    /// Adds a vertex, where this ray meets a sphere at the end of edge number `depth`.
    #[inline(always)]
    pub(super) fn push(
        &mut self,
        waiting: Waiting,
        ray: &PathRay,
        sphere: &Sphere,
        sampler: Sampler,
        depth: u32,
    ) {
        let lane = self.count;
        if lane >= LANES {
            return;
        }
        self.vertices[lane] = waiting;
        self.origin.set(lane, ray.origin);
        self.direction.set(lane, ray.direction);
        self.t_min.0[lane] = ray.t_min;
        self.center.set(lane, sphere.center);
        self.radius.0[lane] = sphere.radius;
        sampler.put_into(&mut self.numbers, lane);
        self.depth.0[lane] = depth;
        self.count += 1;
    }
}

impl Aims {
    /// Takes note of a light sample that was drawn by itself.
    pub(super) fn put(&mut self, lane: usize, sample: Option<LightSample>) {
        self.pdf.0[lane] = sample.map_or(0.0, |sample| sample.pdf);
        let Some(sample) = sample else { return };
        self.direction.set(lane, sample.direction);
        self.distance.0[lane] = sample.distance;
        self.lights[lane] = Light { radiance: sample.radiance, sphere: sample.source.sphere() };
    }
}

/// Finds out where the vertices are, and draws the numbers to aim with.
pub(super) struct Meet<'a> {
    pub(super) block: &'a mut Block,
    pub(super) has_choice: bool,
}

impl Stage for Meet<'_> {
    #[inline(always)]
    fn run(self) {
        let Block { numbers, depth, origin, direction, t_min, center, radius, met, aim, .. } =
            self.block;
        for lane in 0..LANES {
            let sphere = Sphere { center: center.get(lane), radius: radius.0[lane] };
            let (origin, direction) = (origin.get(lane), direction.get(lane));
            let t = sphere.resolve(origin, direction, t_min.0[lane]);
            let (point, normal) = sphere.touched(origin, direction, t);
            met.point.set(lane, point);
            met.normal.set(lane, normal);
            met.cos.0[lane] = direction.dot(normal);
        }
        draw(numbers, depth, &mut aim.u, |vertex| vertex.towards_lamp());
        if self.has_choice {
            numbers.turn_to(|lane| Vertex::at(depth.0[lane]).lamp() / SobolLanes::SET);
            numbers.get(Vertex::at(1).lamp() % SobolLanes::SET, &mut aim.choose);
        }
    }
}

/// The numbers of two dimensions in a row; of which set depends on a path's depth.
#[inline(always)]
fn draw(
    numbers: &mut SobolLanes,
    depth: &Lanes<u32>,
    [first, second]: &mut [Lanes<f64>; 2],
    dimension: impl Fn(Vertex) -> u32,
) {
    let in_set = dimension(Vertex::at(1)) % SobolLanes::SET;
    numbers.turn_to(|lane| dimension(Vertex::at(depth.0[lane])) / SobolLanes::SET);
    numbers.get(in_set, first);
    numbers.get(in_set + 1, second);
}

/// Aims at the only lamp.
pub(super) struct AimAtLamp<'a> {
    pub(super) block: &'a mut Block,
    pub(super) lamp: Lamp,
    pub(super) sphere: Sphere,
}

impl Stage for AimAtLamp<'_> {
    #[inline(always)]
    fn run(self) {
        let Block { met, aim, .. } = self.block;
        aim.lights = [Light { radiance: self.lamp.emission, sphere: self.lamp.id }; LANES];
        let Sphere { center, radius } = self.sphere;
        for lane in 0..LANES {
            let to_center = center - met.point.get(lane);
            let distance = to_center.length();
            let cone = Cone::along(to_center, distance, radius);
            let sample = cone.sample([aim.u[0].0[lane], aim.u[1].0[lane]]);
            aim.direction.set(lane, sample.direction);
            aim.distance.0[lane] = sample.distance;
            aim.pdf.0[lane] = if radius < distance { sample.pdf } else { -1.0 };
        }
    }
}

/// Weighs the light samples, and draws the directions in which the paths go on.
pub(super) struct Turn<'a> {
    pub(super) block: &'a mut Block,
    pub(super) estimator: Estimator,
}

impl Stage for Turn<'_> {
    #[inline(always)]
    fn run(self) {
        let Block { numbers, depth, met, aim, next, .. } = self.block;
        draw(numbers, depth, &mut next.u, |vertex| vertex.direction());
        for lane in 0..LANES {
            let normal = met.normal.get(lane);
            let wi = DVec3::new(0.0, 0.0, normal.dot(aim.direction.get(lane)));
            let (pdf, pdf_bsdf) = (aim.pdf.0[lane], Diffuse::pdf_cosine(wi));
            let weight = weight(self.estimator, pdf, pdf_bsdf);
            let cos = if fault!(CosineMissing) { 1.0 } else { wi.z };
            let factor = (weight * cos / pdf) as f32;
            aim.factor.0[lane] = if wi.z > 0.0 { factor } else { 0.0 };
        }
        for lane in 0..LANES {
            let normal = met.normal.get(lane);
            let u = [next.u[0].0[lane], next.u[1].0[lane]];
            let u = if fault!(NumberReused) { [u[0]; 2] } else { u };
            let (wi, pdf) = Diffuse::sample_cosine(u);
            let direction = nearly_unit(Frame::around(normal).to_world(wi));
            next.direction.set(lane, direction);
            next.pdf.0[lane] = pdf;
            next.cos.0[lane] = direction.dot(normal);
        }
    }
}
