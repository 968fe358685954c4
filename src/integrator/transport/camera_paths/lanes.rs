//! Camera ray generation in lanes. The loop bodies are the functions that generate a single ray.

use crate::fault::fault;
use crate::geometry::RayBlock;
use crate::math::{Isa, LANES, Lanes, SimdKernel};
use crate::sampling::{Sampler, SamplerKind, SobolLanes, sample_box};
use crate::scene::PreparedScene;

use super::super::super::dimension;
use super::super::super::sample::SampleAddress;
use super::super::path_tracer::PathTracer;

/// Returns true if the camera rays of a scene can be generated in lanes.
pub(super) fn supports_lanes(prepared: &PreparedScene, tracer: &PathTracer) -> bool {
    tracer.strata.is_unstratified() && prepared.render_settings().sampler == SamplerKind::Sobol
}

/// A block of samples whose camera rays are generated together.
#[derive(Default)]
pub(in super::super::super) struct CameraRayBatch {
    pixel: [Lanes<u32>; 2],
    sample: Lanes<u32>,
    sobol: SobolLanes,
    u: [Lanes<f64>; 2],
    lens: [Lanes<f64>; 2],
    /// Offset from the pixel's centre.
    offset: [Lanes<f64>; 2],
}

impl CameraRayBatch {
    /// Generates the camera rays of at most `LANES` samples.
    pub(super) fn run(
        &mut self,
        isa: Isa,
        prepared: &PreparedScene,
        samples: &[SampleAddress],
        rays: &mut RayBlock,
    ) {
        for (lane, address) in samples.iter().enumerate().take(LANES) {
            self.pixel[0].0[lane] = address.x;
            self.pixel[1].0[lane] = address.y;
            self.sample.0[lane] = address.sample;
        }
        isa.run(SamplePixel { batch: self, prepared });
        if prepared.filter().box_radius().is_none() {
            for lane in 0..LANES {
                let u = [0, 1].map(|axis| self.u[axis].0[lane]);
                let offset = prepared.filter().sample(u);
                (0..2).for_each(|axis| self.offset[axis].0[lane] = offset[axis]);
            }
        }
        if prepared.camera().is_pinhole() {
            isa.run(GenerateRays { batch: self, prepared, rays });
        } else {
            (0..samples.len()).for_each(|lane| self.generate_ray(prepared, lane, rays));
        }
    }

    /// Generates a ray of any other camera.
    fn generate_ray(&self, prepared: &PreparedScene, lane: usize, rays: &mut RayBlock) {
        let camera = prepared.camera();
        let [x, y] = self.position(lane);
        let lens = if camera.has_lens() { self.lens.map(|u| u.0[lane]) } else { [0.5; 2] };
        let ray = camera.generate_ray(x, y, lens);
        rays.origin.set(lane, ray.origin);
        rays.direction.set(lane, ray.direction);
        rays.t_min.0[lane] = ray.t_min;
    }

    /// Returns the position in the picture of a lane, in pixels.
    #[inline(always)]
    fn position(&self, lane: usize) -> [f64; 2] {
        let half = if fault!(PixelCornerForCenter) { 0.0 } else { 0.5 };
        [0, 1].map(|axis| f64::from(self.pixel[axis].0[lane]) + half + self.offset[axis].0[lane])
    }

    /// Returns the sampler of a lane.
    pub(super) fn sampler(&self, lane: usize) -> Sampler {
        Sampler::from_lane(&self.sobol, lane)
    }
}

/// Samples pixel positions.
struct SamplePixel<'a> {
    batch: &'a mut CameraRayBatch,
    prepared: &'a PreparedScene,
}

impl SimdKernel for SamplePixel<'_> {
    #[inline(always)]
    fn run(self) {
        let CameraRayBatch { pixel: [x, y], sample, sobol, u, lens, offset } = self.batch;
        let width = u64::from(self.prepared.image_settings().width);
        let pixel = |lane: usize| u64::from(y.0[lane]) * width + u64::from(x.0[lane]);
        sobol.start_pixel_samples(self.prepared.render_settings().seed, pixel, |lane| {
            sample.0[lane]
        });
        sobol.select_set(|_| dimension::PIXEL / SobolLanes::SET_SIZE);
        for (dimension, u) in (dimension::PIXEL % SobolLanes::SET_SIZE..).zip(&mut *u) {
            sobol.get(dimension, u);
        }
        if self.prepared.camera().has_lens() {
            sobol.select_set(|_| dimension::LENS / SobolLanes::SET_SIZE);
            for (dimension, u) in (dimension::LENS % SobolLanes::SET_SIZE..).zip(lens) {
                sobol.get(dimension, u);
            }
        }
        if let Some(radius) = self.prepared.filter().box_radius() {
            for (u, offset) in u.iter().zip(offset) {
                for lane in 0..LANES {
                    offset.0[lane] = sample_box(u.0[lane]) * radius;
                }
            }
        }
    }
}

/// Generates the rays.
struct GenerateRays<'a> {
    batch: &'a CameraRayBatch,
    prepared: &'a PreparedScene,
    rays: &'a mut RayBlock,
}

impl SimdKernel for GenerateRays<'_> {
    #[inline(always)]
    fn run(self) {
        let RayBlock { origin, direction, t_min, .. } = self.rays;
        let camera = *self.prepared.camera();
        for lane in 0..LANES {
            let [x, y] = self.batch.position(lane);
            let ray = camera.generate_pinhole_ray(x, y);
            origin.set(lane, ray.origin);
            direction.set(lane, ray.direction);
            t_min.0[lane] = ray.t_min;
        }
    }
}
