//! The samples that are estimated together, and one edge of all their paths: the questions to the
//! intersector.

use crate::color::{Radiance, Rgb, Seen};
use crate::material::Media;
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
    /// The media that each sample's path is in; none where nothing is a dielectric.
    pub(super) media: Vec<Media>,
    /// What each sample sees first; none where nobody wants to know.
    pub(super) seen: Vec<Seen>,
    pub(super) tally: Tally,
    pub(super) recorder: &'a mut R,
}

impl<R: Recorder> Batch<'_, R> {
    /// All the paths from the camera to their ends.
    pub(super) fn run(mut self, workspace: &mut Workspace) -> Tally {
        self.radiance.fill(Radiance { alpha: 1.0, ..Radiance::default() });
        let with_media = if self.world.scene.has_media() { self.samples.len() } else { 0 };
        self.media.clear();
        self.media.resize(with_media, Media::VACUUM);
        workspace.paths.clear();
        for sample in 0..self.samples.len() {
            workspace.paths.push(self.start(sample));
        }
        while !workspace.paths.is_empty() && !self.world.cancel.is_cancelled() {
            self.advance(workspace);
        }
        workspace.media = self.media;
        workspace.seen = self.seen;
        self.tally
    }

    /// The media that a path is in.
    pub(super) fn media_of(&self, path: &Path) -> &Media {
        self.media.get(path.sample as usize).unwrap_or(&Media::VACUUM)
    }

    /// One edge for every path: closest hits, shading, shadow rays. Paths that end are dropped.
    fn advance(&mut self, workspace: &mut Workspace) {
        let has_blocks = self.has_blocks();
        let Workspace { paths, next_paths, block, shadows, shadow_media, rays, hits, .. } =
            workspace;
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
        next_paths.clear();
        for index in 0..paths.len() {
            let (path, hit) = (&mut paths[index], hits[index]);
            self.see(path, hit);
            if let Some(matt) = self.matt(path, hit).filter(|_| has_blocks) {
                self.wait(block, index, path, hit.id, matt);
                if block.is_full() {
                    self.work(workspace.isa, block, paths, next_paths, &mut aims);
                }
                continue;
            }
            let goes_on = match spheres.answer(&path.ray, hit) {
                Some(surface) => self.shade(path, &surface, &mut aims),
                None => self.miss(path),
            };
            if goes_on {
                next_paths.push(*path);
            }
        }
        self.work(workspace.isa, block, paths, next_paths, &mut aims);
        std::mem::swap(paths, next_paths);

        // Ask for the shadows.
        let blocked = &mut workspace.blocked;
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
