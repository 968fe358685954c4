//! Camera rays, many at a time: loops over lanes whose bodies are the functions that serve one ray.

use crate::fault::fault;
use crate::geometry::RayBlock;
use crate::math::{Isa, LANES, Lanes, Stage};
use crate::sampling::{Sampler, SamplerKind, SobolLanes, box_sample};
use crate::scene::Shot;

use super::super::super::dimension;
use super::super::super::sample::SampleAddress;
use super::super::choices::Transport;

/// Whether the camera rays of a scene can be drawn many at a time.
pub(super) fn can_start(shot: &Shot, transport: &Transport) -> bool {
    shot.camera().is_pinhole()
        && transport.strata.is_none()
        && shot.render().sampler == SamplerKind::Sobol
}

/// Samples that leave the camera together.
#[derive(Default)]
pub(in super::super::super) struct StartBlock {
    pixel: [Lanes<u32>; 2],
    sample: Lanes<u32>,
    numbers: SobolLanes,
    u: [Lanes<f64>; 2],
    /// From the middle of the pixel.
    offset: [Lanes<f64>; 2],
}

impl StartBlock {
    /// The camera rays of at most `LANES` samples.
    pub(super) fn run(
        &mut self,
        isa: Isa,
        shot: &Shot,
        samples: &[SampleAddress],
        rays: &mut RayBlock,
    ) {
        for (lane, address) in samples.iter().enumerate().take(LANES) {
            self.pixel[0].0[lane] = address.x;
            self.pixel[1].0[lane] = address.y;
            self.sample.0[lane] = address.sample;
        }
        isa.run(Place { block: self, shot });
        if shot.filter().radius_of_box().is_none() {
            for lane in 0..LANES {
                let u = [0, 1].map(|axis| self.u[axis].0[lane]);
                let offset = shot.filter().sample(u);
                (0..2).for_each(|axis| self.offset[axis].0[lane] = offset[axis]);
            }
        }
        isa.run(Leave { block: self, shot, rays });
    }

    /// The random numbers of a sample.
    pub(super) fn sampler(&self, lane: usize) -> Sampler {
        Sampler::of_lane(&self.numbers, lane)
    }
}

/// Draws places in the pixels.
struct Place<'a> {
    block: &'a mut StartBlock,
    shot: &'a Shot,
}

impl Stage for Place<'_> {
    #[inline(always)]
    fn run(self) {
        let StartBlock { pixel: [x, y], sample, numbers, u, offset, .. } = self.block;
        let width = u64::from(self.shot.image().width);
        let pixel = |lane: usize| u64::from(y.0[lane]) * width + u64::from(x.0[lane]);
        numbers.begin(self.shot.render().seed, pixel, |lane| sample.0[lane]);
        numbers.turn_to(|_| dimension::PIXEL / SobolLanes::SET);
        for (dimension, u) in (dimension::PIXEL % SobolLanes::SET..).zip(&mut *u) {
            numbers.get(dimension, u);
        }
        if let Some(radius) = self.shot.filter().radius_of_box() {
            for (u, offset) in u.iter().zip(offset) {
                for lane in 0..LANES {
                    offset.0[lane] = box_sample(u.0[lane]) * radius;
                }
            }
        }
    }
}

/// Sends the rays off.
struct Leave<'a> {
    block: &'a StartBlock,
    shot: &'a Shot,
    rays: &'a mut RayBlock,
}

impl Stage for Leave<'_> {
    #[inline(always)]
    fn run(self) {
        let StartBlock { pixel, offset, .. } = self.block;
        let RayBlock { origin, direction, t_min, .. } = self.rays;
        let camera = *self.shot.camera();
        let half = if fault!(CornerForCentre) { 0.0 } else { 0.5 };
        for lane in 0..LANES {
            let [x, y] =
                [0, 1].map(|axis| f64::from(pixel[axis].0[lane]) + half + offset[axis].0[lane]);
            let ray = camera.pinhole_ray(x, y);
            origin.set(lane, ray.origin);
            direction.set(lane, ray.direction);
            t_min.0[lane] = ray.t_min;
        }
    }
}
