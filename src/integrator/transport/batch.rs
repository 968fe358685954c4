//! The samples that are estimated together, and one edge of all their paths: the questions to the
//! intersector.

use crate::color::{Radiance, Rgb, Seen};
use crate::material::Media;
use crate::math::Hit;
use crate::sampling::Sampler;

use super::super::sample::{SampleAddress, Tally};
use super::super::trace::{Added, End, Recorder, Step};
use super::super::workspace::Workspace;
use super::super::world::World;
use super::choices::Transport;
use super::opacity;
use super::paths::{Aims, Drawn, Gain, Path};

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
    /// Each sample's random numbers.
    pub(super) samplers: Vec<Sampler>,
    /// How the ray of each sample's path was drawn, where it was.
    pub(super) drawn: Vec<Drawn>,
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
        // A path asks only for what it has drawn; so what is old may stay.
        let room = self.samples.len().max(self.drawn.len());
        self.drawn.resize(room, Drawn::NOTHING);
        self.start_all(workspace);
        while !workspace.paths.states.is_empty() && !self.world.cancel.is_cancelled() {
            self.advance(workspace);
        }
        workspace.media = self.media;
        workspace.seen = self.seen;
        workspace.samplers = self.samplers;
        workspace.drawn = self.drawn;
        self.tally
    }

    /// The random numbers of a path.
    pub(super) fn sampler(&self, path: &Path) -> Sampler {
        self.samplers[path.state.sample as usize]
    }

    /// How the ray of a path was drawn, if it was.
    pub(super) fn drawn(&self, path: &Path) -> Option<&Drawn> {
        path.state.is_drawn.then(|| &self.drawn[path.state.sample as usize])
    }

    /// The media that a path is in.
    pub(super) fn media_of(&self, path: &Path) -> &Media {
        self.media.get(path.state.sample as usize).unwrap_or(&Media::VACUUM)
    }

    /// One edge for every path: closest hits, shading, shadow rays. Paths that end are dropped.
    fn advance(&mut self, workspace: &mut Workspace) {
        let (has_blocks, isa) = (self.has_blocks(), workspace.isa);
        let even_background = self.even_background();
        let Workspace {
            paths,
            next_paths,
            block,
            shadows,
            shadow_media,
            rays,
            hits,
            blocked,
            passed,
            ..
        } = workspace;
        let spheres = self.world.scene.spheres();

        // Ask for the closest hits.
        hits.clear();
        hits.resize(paths.states.len(), Hit::MISS);
        self.world.accel.closest_of(spheres, &paths.rays, rays, hits);
        self.tally.count_of(&paths.rays, isa);
        self.world.scene.warm(hits);

        // Shade: gather emission, aim at a light, scatter.
        shadows.clear();
        shadow_media.clear();
        let mut aims = Aims { shadows, media: shadow_media };
        next_paths.clear();
        for (index, &hit) in hits.iter().enumerate() {
            if !self.seen.is_empty() {
                self.see(&paths.get(index), hit);
            }
            if hit.is_miss() && !paths.rays.goes_in(index) {
                if let Some(radiance) = even_background {
                    self.miss_evenly(&paths.states[index], radiance);
                    continue;
                }
            }
            if let Some(matt) = self.matt(paths, index, hit).filter(|_| has_blocks) {
                self.wait(block, paths, index, hit.id, matt);
                if block.is_full() {
                    self.work(isa, block, paths, next_paths, &mut aims);
                }
                continue;
            }
            let mut path = paths.get(index);
            let goes_on = match spheres.answer(&path.ray, hit) {
                Some(surface) => self.shade(&mut path, surface, &mut aims),
                None => self.miss(&mut path),
            };
            if goes_on {
                next_paths.push(&path);
            }
        }
        self.work(isa, block, paths, next_paths, &mut aims);
        std::mem::swap(paths, next_paths);

        // Ask for the shadows.
        if self.world.scene.has_opacity() {
            let walked = opacity::walk(self.world, shadows, shadow_media, rays, hits, passed);
            self.tally = self.tally + walked;
            shadows.gains.iter().zip(&*passed).for_each(|(gain, &share)| self.gain(gain, share));
        } else {
            blocked.clear();
            blocked.resize(shadows.gains.len(), false);
            self.world.accel.occluded_of(spheres, &shadows.rays, rays, blocked);
            self.tally.count_of(&shadows.rays, isa);
            for (gain, &is_blocked) in shadows.gains.iter().zip(&*blocked) {
                self.gain(gain, if is_blocked { 0.0 } else { 1.0 });
            }
        }
    }

    /// Adds what arrives of light that was aimed at.
    #[inline(always)]
    fn gain(&mut self, gain: &Gain, passed: f32) {
        if passed == 0.0 && !R::LISTENS {
            return;
        }
        let added = self.arriving(gain.light * passed, gain.is_direct);
        self.add(gain.sample, added);
        self.recorder.note(|| Step::Shadow { passed, added });
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

    /// Light that reaches the camera; clamped where the scene asks for that.
    pub(super) fn arriving(&self, light: Rgb, is_direct: bool) -> Added {
        let brightest = light.max_element();
        match self.transport.clamp_indirect {
            Some(limit) if !is_direct && brightest > limit => {
                let clamp = limit / brightest;
                Added { light: light * clamp, clamp, is_direct }
            }
            _ => Added { light, clamp: 1.0, is_direct },
        }
    }

    /// Tells what the ray of a path met.
    pub(super) fn tell_miss(&mut self, path: &Path) {
        self.recorder.note(|| Step::Miss {
            depth: path.state.depth,
            wo: -path.ray.direction,
            throughput: path.state.throughput,
        });
    }
}
