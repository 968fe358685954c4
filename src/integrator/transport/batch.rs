//! The samples that are estimated together, and one edge of all their paths: the questions to the
//! intersector.

use crate::color::{Radiance, Rgb};
use crate::math::Hit;

use super::super::trace::{Added, End, Recorder, Step};
use super::super::{SampleAddress, Tally, Workspace, World};
use super::{Aims, Path, Transport, opacity};

/// The samples that are estimated together.
pub(super) struct Batch<'a, R> {
    pub(super) transport: &'a Transport,
    pub(super) world: World<'a>,
    pub(super) samples: &'a [SampleAddress],
    pub(super) radiance: &'a mut [Radiance],
    pub(super) tally: Tally,
    pub(super) recorder: &'a mut R,
}

impl<R: Recorder> Batch<'_, R> {
    /// All the paths from the camera to their ends.
    pub(super) fn run(mut self, workspace: &mut Workspace) -> Tally {
        self.radiance.fill(Radiance { alpha: 1.0, ..Radiance::default() });
        workspace.paths.clear();
        for sample in 0..self.samples.len() {
            workspace.paths.push(self.start(sample));
        }
        while !workspace.paths.is_empty() && !self.world.cancel.is_cancelled() {
            self.advance(workspace);
        }
        self.tally
    }

    /// One edge for every path: closest hits, shading, shadow rays. Paths that end are dropped, the
    /// others keep their order.
    fn advance(&mut self, workspace: &mut Workspace) {
        let Workspace { paths, shadows, shadow_media, rays, hits, blocked } = workspace;
        let spheres = self.world.scene.spheres();

        // Ask for the closest hits.
        rays.clear();
        rays.extend(paths.iter().map(|path| spheres.ask(&path.ray)));
        hits.clear();
        hits.resize(rays.len(), Hit::MISS);
        self.world.accel.closest(rays, hits);
        self.tally.count(rays);

        // Shade: gather emission, aim at a light, scatter.
        shadows.clear();
        shadow_media.clear();
        let mut aims = Aims { shadows, media: shadow_media };
        let mut answers = hits.iter();
        paths.retain_mut(|path| {
            let hit = answers.next().copied().unwrap_or(Hit::MISS);
            match spheres.answer(&path.ray, hit) {
                Some(surface) => self.shade(path, &surface, &mut aims),
                None => self.miss(path),
            }
        });

        // Ask for the shadows.
        blocked.clear();
        if self.world.scene.has_opacity() {
            let walked = opacity::walk(self.world, shadows, shadow_media, rays, hits);
            self.tally = self.tally + walked;
            blocked.extend(shadows.iter().map(|shadow| shadow.light == Rgb::ZERO));
        } else {
            rays.clear();
            rays.extend(shadows.iter().map(|shadow| spheres.ask(&shadow.ray)));
            blocked.resize(rays.len(), false);
            self.world.accel.occluded(rays, blocked);
            self.tally.count(rays);
        }
        for (shadow, &is_blocked) in shadows.iter().zip(&*blocked) {
            let light = if is_blocked { Rgb::ZERO } else { shadow.light };
            let added = Added { light, is_direct: shadow.is_direct };
            if !is_blocked {
                self.add(shadow.sample, added);
            }
            self.recorder.note(|| Step::Shadow { is_blocked, added });
        }
    }

    /// Adds light to a sample.
    pub(super) fn add(&mut self, sample: u32, added: Added) {
        let radiance = &mut self.radiance[sample as usize];
        let layer = if added.is_direct { &mut radiance.direct } else { &mut radiance.indirect };
        *layer += added.light;
    }

    /// Ends a path.
    pub(super) fn end(&mut self, why: End) -> bool {
        self.recorder.note(|| Step::End(why));
        false
    }

    /// Ends a path that is longer than any may be.
    pub(super) fn cut_off(&mut self) -> bool {
        self.tally.cut_off += 1;
        self.end(End::CutOff)
    }

    /// Light that reaches the camera along a path which scattered it so many times; clamped where
    /// the scene asks for that.
    pub(super) fn arriving(&self, light: Rgb, scatterings: u32) -> Added {
        let is_direct = scatterings <= 1;
        let brightest = light.max_element();
        match self.transport.clamp_indirect {
            Some(limit) if !is_direct && brightest > limit => {
                Added { light: light * (limit / brightest), is_direct }
            }
            _ => Added { light, is_direct },
        }
    }

    /// Tells what the ray of a path met.
    pub(super) fn tell_miss(&mut self, path: &Path) {
        self.recorder.note(|| Step::Miss {
            depth: path.depth,
            wo: -path.ray.direction,
            throughput: path.throughput,
        });
    }
}
