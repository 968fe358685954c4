//! Vertices on matt surfaces, many at a time.
//!
//! Most vertices of most pictures are alike: an opaque matt surface, met from outside, lit by lamps
//! that are seen from outside. They gather in a [`Block`], field by field, and go through its stages,
//! whose loops over the lanes become vector instructions (see [`crate::math::Isa`]). The bodies of the
//! loops are the functions that [`Batch::turn`] calls for one path, so both give the same bits. A
//! vertex that turns out to be unlike the others goes to [`Batch::turn`].

mod block;

use crate::color::Rgb;
use crate::fault::fault;
use crate::geometry::{PathRay, Side, SurfaceHit};
use crate::light::{Receiver, Source};
use crate::material::{Diffuse, Model};
use crate::math::{DVec3, Hit, Isa};
use crate::sampling::{Hemisphere, SamplerKind};
use crate::scene::settings::Estimator;

use super::super::trace::Recorder;
use super::batch::Batch;
use super::paths::{Aims, Drawn, Gain, LONGEST, Path, Paths};

pub(in super::super) use block::Block;
use block::{AimAtLamp, Light, Meet, Turn, Waiting};

/// A matt surface. What a stage passes on for every path is kept small, and not written and read again
/// in pieces of other sizes, for which processors wait.
#[derive(Clone, Copy)]
pub(super) struct Matt<'a> {
    albedo: Rgb,
    emission: &'a Rgb,
}

impl<'a, R: Recorder> Batch<'a, R> {
    /// Whether matt surfaces are worked on many at a time: not where somebody listens, and not where
    /// the scene or the integrator makes their vertices unlike each other.
    pub(super) fn has_blocks(&self) -> bool {
        let (scene, transport) = (self.world.scene, self.transport);
        !R::LISTENS
            && !scene.has_opacity()
            && transport.hemisphere == Hemisphere::Cosine
            && transport.most_scatterings == u32::MAX
            && self.world.shot.render().sampler == SamplerKind::Sobol
    }

    /// The surface that a path meets, if it is one of those that a block takes.
    #[inline(always)]
    pub(super) fn matt(&self, paths: &Paths, index: usize, hit: Hit) -> Option<Matt<'a>> {
        let sample = paths.states[index].sample as usize;
        let is_in_medium = || self.media.get(sample).is_some_and(|media| !media.is_vacuum());
        if hit.is_miss() || paths.rays.goes_in(index) || is_in_medium() {
            return None;
        }
        let (material, color) = self.world.scene.material(hit.id);
        match &material.model {
            Model::Diffuse(matt) => {
                Some(Matt { albedo: matt.colored(color).albedo, emission: &material.emission })
            }
            _ => None,
        }
    }

    /// Adds the light that shines at a vertex, and puts the vertex into the block unless the path
    /// ends there.
    #[inline(always)]
    pub(super) fn wait(
        &mut self,
        block: &mut Block,
        paths: &Paths,
        index: usize,
        id: u32,
        Matt { albedo, emission }: Matt<'_>,
    ) {
        let state = &paths.states[index];
        if emission.max_element() > 0.0 {
            self.gather(&paths.get(index), Source::Lamp(id), *emission, true);
        }
        if self.is_at_its_end(state) {
            return;
        }
        if state.depth >= LONGEST {
            self.cut_off();
            return;
        }
        let waiting = Waiting { path: index as u32, id, albedo };
        let sphere = self.world.scene.spheres().sphere(id);
        let sampler = self.samplers[state.sample as usize];
        block.push(waiting, &paths.rays.get(index), &sphere, sampler, state.depth);
    }

    /// Works on the vertices of a block and empties it. What goes on is put behind `next`.
    pub(super) fn work(
        &mut self,
        isa: Isa,
        block: &mut Block,
        paths: &Paths,
        next: &mut Paths,
        aims: &mut Aims<'_>,
    ) {
        if block.count == 0 {
            return;
        }
        let scene = self.world.scene;
        let lights = self.world.shot.lights();
        let estimator = self.transport.estimator;
        isa.run(Meet { block, has_choice: lights.has_choice() });
        if estimator == Estimator::Bsdf {
            block.aim.pdf.0.fill(0.0);
        } else if let Some(&lamp) = lights.only_lamp() {
            let sphere = scene.spheres().sphere(lamp.id);
            isa.run(AimAtLamp { block, lamp, sphere });
        } else {
            for lane in 0..block.count {
                let receiver = Receiver { hit: met(block, lane), is_two_sided: false };
                let u = [block.aim.u[0].0[lane], block.aim.u[1].0[lane]];
                let choose = block.aim.choose.0[lane];
                let sample = lights.sample(scene.spheres(), &receiver, choose, u);
                block.aim.put(lane, sample);
            }
        }
        isa.run(Turn { block, estimator });
        for lane in 0..block.count {
            self.go_on(block, lane, paths, next, aims);
        }
        block.count = 0;
    }

    /// Takes the outcome of a lane.
    #[inline(always)]
    fn go_on(
        &mut self,
        block: &Block,
        lane: usize,
        paths: &Paths,
        next: &mut Paths,
        aims: &mut Aims<'_>,
    ) {
        let Waiting { path, id, albedo } = block.vertices[lane];
        let Light { radiance, sphere: lamp } = block.aim.lights[lane];
        let (pdf_aim, pdf) = (block.aim.pdf.0[lane], block.next.pdf.0[lane]);
        let is_own_lamp = lamp == id;
        let is_within_lamp = pdf_aim < 0.0 && !is_own_lamp;
        if block.met.cos.0[lane] > 0.0 || is_within_lamp || block.next.cos.0[lane] < 0.0 {
            return self.go_on_alone(id, paths.get(path as usize), next, aims);
        }
        let mut state = paths.states[path as usize];
        let (point, normal) = (block.met.point.get(lane), block.met.normal.get(lane));
        if pdf_aim > 0.0 && !is_own_lamp {
            let f = Diffuse { albedo }.eval(DVec3::Z);
            let light = state.throughput * f * radiance * block.aim.factor.0[lane];
            if light != Rgb::ZERO {
                let (direction, t_max) =
                    (block.aim.direction.get(lane), block.aim.distance.0[lane]);
                let free = PathRay::free(point, direction);
                let ray = PathRay { leaves: id, aims_at: lamp, t_max, ..free };
                let is_direct = state.aims_directly();
                aims.shadows.push(&ray, Gain { sample: state.sample, light, is_direct });
            }
        }
        let cos = if fault!(CosineTwice) { block.next.cos.0[lane] as f32 } else { 1.0 };
        state.throughput *= albedo * cos;
        state.scatterings += 1;
        state.is_drawn = true;
        if pdf > 0.0 && self.survives(&mut state) {
            state.depth += 1;
            let free = PathRay::free(point, block.next.direction.get(lane));
            next.rays.push(&PathRay { leaves: id, ..free });
            next.states.push(state);
            let (side, is_two_sided) = (Side::Outside, false);
            self.drawn[state.sample as usize] =
                Drawn { pdf, point, normal, id, side, is_two_sided };
        }
    }

    /// A vertex that is unlike the others of its block.
    #[inline(never)]
    fn go_on_alone(&mut self, id: u32, mut path: Path, next: &mut Paths, aims: &mut Aims<'_>) {
        let scene = self.world.scene;
        let Some(hit) = scene.spheres().answer(&path.ray, Hit { t: 0.0, id }) else { return };
        if self.turn(&mut path, &hit, &scene.surface(id), 1.0, None, aims) {
            next.push(&path);
        }
    }
}

/// Where a lane's ray met its sphere, from outside.
fn met(block: &Block, lane: usize) -> SurfaceHit {
    let Waiting { id, .. } = block.vertices[lane];
    SurfaceHit {
        id,
        t: 0.0,
        point: block.met.point.get(lane),
        normal: block.met.normal.get(lane),
        radius: 0.0,
        side: Side::Outside,
    }
}
