//! Vertices on matt surfaces, many at a time.
//!
//! Most vertices of most pictures are alike: an opaque matt surface, met from outside, lit by lamps
//! that are seen from outside. They gather in a [`Block`], field by field, and go through its stages,
//! whose loops over the lanes become vector instructions (see [`crate::math::Isa`]). The bodies of the
//! loops are the functions that [`Batch::turn`] calls for one path, so both give the same bits. A
//! vertex that turns out to be unlike the others goes to [`Batch::turn`].

mod block;

use crate::color::Rgb;
use crate::geometry::{PathRay, Side, SurfaceHit};
use crate::light::{Receiver, Source};
use crate::material::{Diffuse, Model};
use crate::math::{Hit, Isa};
use crate::sampling::{Hemisphere, SamplerKind};
use crate::scene::description::Estimator;

use super::super::trace::Recorder;
use super::batch::Batch;
use super::{Aims, Drawn, LONGEST, Path, Shadow};

pub(in super::super) use block::Block;
use block::{AimAtLamp, Light, Meet, Turn, Waiting};

impl<R: Recorder> Batch<'_, R> {
    /// Whether matt surfaces are worked on many at a time: not where somebody listens, and not where
    /// the scene or the integrator makes their vertices unlike each other.
    pub(super) fn has_blocks(&self) -> bool {
        let (scene, transport) = (self.world.scene, self.transport);
        !R::LISTENS
            && !cfg!(feature = "faults")
            && !scene.has_opacity()
            && transport.hemisphere == Hemisphere::Cosine
            && transport.most_scatterings == u32::MAX
            && scene.description().render.sampler == SamplerKind::Sobol
    }

    /// The colour of the surface that a path meets, if it is one of those that a block takes.
    pub(super) fn matt(&self, path: &Path, hit: Hit) -> Option<(Rgb, Rgb)> {
        let is_in_medium = || self.media.get(path.sample as usize).is_some_and(|m| !m.is_vacuum());
        if hit.is_miss() || path.ray.far_wall < f64::INFINITY || is_in_medium() {
            return None;
        }
        let surface = self.world.scene.surface(hit.id);
        match surface.material.model {
            Model::Diffuse(matt) => {
                Some((matt.colored(surface.albedo).albedo, surface.material.emission))
            }
            _ => None,
        }
    }

    /// Adds the light that shines at a vertex, and puts the vertex into the block unless the path
    /// ends there. Returns whether it goes on in the block.
    pub(super) fn wait(
        &mut self,
        block: &mut Block,
        index: usize,
        path: &Path,
        id: u32,
        (albedo, emission): (Rgb, Rgb),
    ) {
        if emission.max_element() > 0.0 {
            self.gather(path, Source::Lamp(id), emission, true);
        }
        if self.is_at_its_end(path) {
            return;
        }
        if path.depth >= LONGEST {
            self.cut_off();
            return;
        }
        let waiting = Waiting { path: index as u32, id, albedo };
        let sphere = self.world.scene.spheres().sphere(id);
        block.push(waiting, &path.ray, &sphere, path.sampler, path.depth);
    }

    /// Works on the vertices of a block and empties it. What goes on is put behind `next`.
    pub(super) fn work(
        &mut self,
        isa: Isa,
        block: &mut Block,
        paths: &[Path],
        next: &mut Vec<Path>,
        aims: &mut Aims<'_>,
    ) {
        let scene = self.world.scene;
        let lights = scene.lights();
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
            let mut path = paths[block.vertices[lane].path as usize];
            if self.go_on(block, lane, &mut path, aims) {
                next.push(path);
            }
        }
        block.count = 0;
    }

    /// Takes the outcome of a lane. Returns whether the path goes on.
    fn go_on(&mut self, block: &Block, lane: usize, path: &mut Path, aims: &mut Aims<'_>) -> bool {
        let scene = self.world.scene;
        let Waiting { id, albedo, .. } = block.vertices[lane];
        let Light { radiance, sphere: lamp } = block.aim.lights[lane];
        let pdf_aim = block.aim.pdf.0[lane];
        let is_own_lamp = lamp == id;
        let is_from_inside = block.met.cos.0[lane] > 0.0;
        let is_within_lamp = pdf_aim < 0.0 && !is_own_lamp;
        if is_from_inside || is_within_lamp || block.next.cos.0[lane] < 0.0 {
            let Some(hit) = scene.spheres().answer(&path.ray, Hit { t: 0.0, id }) else {
                return false;
            };
            return self.turn(path, &hit, &scene.surface(id), 1.0, None, aims);
        }
        let hit = met(block, lane);
        let matt = Diffuse { albedo };
        if pdf_aim > 0.0 && !is_own_lamp {
            let f = matt.eval(crate::math::DVec3::Z);
            let light = path.throughput * f * radiance * block.aim.factor.0[lane];
            if light != Rgb::ZERO {
                let added = self.arriving(light, path.scatterings + 1);
                let distance = block.aim.distance.0[lane];
                let ray = PathRay {
                    leaves: id,
                    aims_at: lamp,
                    t_max: distance,
                    ..PathRay::free(hit.point, block.aim.direction.get(lane))
                };
                aims.shadows.push(Shadow {
                    sample: path.sample,
                    ray,
                    light: added.light,
                    is_direct: added.is_direct,
                });
            }
        }
        let pdf = block.next.pdf.0[lane];
        if pdf <= 0.0 {
            return false;
        }
        path.throughput *= albedo;
        path.ray =
            PathRay { leaves: id, ..PathRay::free(hit.point, block.next.direction.get(lane)) };
        path.drawn = Some(Drawn::new(&Receiver { hit, is_two_sided: false }, pdf));
        path.scatterings += 1;
        let goes_on = self.survives(path);
        path.depth += 1;
        goes_on
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
