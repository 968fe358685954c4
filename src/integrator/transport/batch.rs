//! A batch of samples, and the intersector queries for one edge of all their paths.

use crate::color::{PathRadiance, Rgb, VisibleSurface};
use crate::geometry::PathRay;
use crate::material::MediumStack;
use crate::math::{Hit, Isa};
use crate::sampling::Sampler;

use super::super::context::RenderContext;
use super::super::profile::{Stage, StageClock};
use super::super::sample::{RenderStats, SampleAddress};
use super::super::trace::{Contribution, PathEvent, PathRecorder, Termination};
use super::super::workspace::Workspace;
use super::chain::ChainRecord;
use super::lanes::VertexBatches;
use super::opacity::ShadowWalk;
use super::path_tracer::PathTracer;
use super::paths::{Path, PathState, PendingDirect, PrevVertex, ShadowQueue, StageQueues};

/// A batch of samples that are estimated together.
pub(super) struct PathBatch<'a, R> {
    pub(super) integrator: &'a PathTracer,
    pub(super) context: RenderContext<'a>,
    pub(super) samples: &'a [SampleAddress],
    pub(super) radiance: &'a mut [PathRadiance],
    /// The media that each sample's path is in; empty in scenes without dielectrics.
    pub(super) media: Vec<MediumStack>,
    /// Each sample's first visible surface; empty unless recorded.
    pub(super) visible_surfaces: Vec<VisibleSurface>,
    /// Each sample's sampler.
    pub(super) samplers: Vec<Sampler>,
    /// The MIS record of the previous vertex of each sample's path.
    pub(super) prev_vertices: Vec<PrevVertex>,
    /// Where each sample's path last scattered in more than one direction, and what has happened
    /// since; empty in scenes without connections.
    pub(super) chain_records: Vec<ChainRecord>,
    pub(super) stats: RenderStats,
    pub(super) clock: StageClock,
    pub(super) recorder: &'a mut R,
}

impl<R: PathRecorder> PathBatch<'_, R> {
    /// Traces all paths from the camera to their ends.
    pub(super) fn run(mut self, workspace: &mut Workspace) -> RenderStats {
        self.radiance.fill(PathRadiance { alpha: 1.0, ..PathRadiance::default() });
        // A path reads only entries that it has written, so stale ones are harmless.
        if self.context.scene.has_media() {
            let room = self.samples.len().max(self.media.len());
            self.media.resize(room, MediumStack::VACUUM);
        } else {
            self.media.clear();
        }
        let room = self.samples.len().max(self.prev_vertices.len());
        self.prev_vertices.resize(room, PrevVertex::NONE);
        if self.context.prepared.connections().is_some() {
            let room = self.samples.len().max(self.chain_records.len());
            self.chain_records.resize(room, ChainRecord::NONE);
        }
        self.clock.begin();
        self.generate_camera_paths(workspace);
        self.clock.end(Stage::CameraRays);
        while !workspace.path_queue.states.is_empty() && !self.context.cancel.is_cancelled() {
            self.advance(workspace);
        }
        workspace.media = self.media;
        workspace.visible_surfaces = self.visible_surfaces;
        workspace.samplers = self.samplers;
        workspace.prev_vertices = self.prev_vertices;
        workspace.chain_records = self.chain_records;
        workspace.clock = self.clock;
        self.stats
    }

    /// Returns the sampler of a path.
    pub(super) fn sampler(&self, state: &PathState) -> Sampler {
        self.samplers[state.batch_index as usize]
    }

    /// Returns the previous-vertex record of a path, if its ray was sampled from a density.
    pub(super) fn prev_vertex(&self, state: &PathState) -> Option<&PrevVertex> {
        state.has_prev_vertex.then(|| &self.prev_vertices[state.batch_index as usize])
    }

    /// Returns the media that a path is in.
    pub(super) fn media_of(&self, state: &PathState) -> &MediumStack {
        static VACUUM: MediumStack = MediumStack::VACUUM;
        self.media.get(state.batch_index as usize).unwrap_or(&VACUUM)
    }

    /// Advances every path by one edge: closest hits, shading, shadow rays. Paths that end are
    /// dropped.
    fn advance(&mut self, workspace: &mut Workspace) {
        let isa = workspace.isa;
        let Workspace {
            path_queue: paths,
            next_path_queue: next,
            vertex_batches,
            shadow_rays,
            shadow_media,
            rays,
            hits,
            occluded,
            visibility,
            ..
        } = workspace;
        let spheres = self.context.scene.spheres();

        // Find the closest hits.
        hits.clear();
        hits.resize(paths.states.len(), Hit::MISS);
        self.context.accel.closest_path_rays(spheres, &paths.rays, rays, hits);
        self.stats.count_path_rays(&paths.rays, isa);
        self.clock.end(Stage::ClosestHits);
        self.context.scene.prefetch(hits);

        // Shade: add emission, sample a light, scatter.
        shadow_rays.clear();
        shadow_media.clear();
        next.clear();
        let shadow = ShadowQueue { shadow_rays, media: shadow_media };
        let mut queues = StageQueues { paths, next, shadow };
        self.shade(isa, vertex_batches, &mut queues, hits);
        std::mem::swap(paths, next);

        // Trace the shadow rays.
        occluded.clear();
        occluded.resize(shadow_rays.pending.len(), false);
        if !self.context.scene.has_opacity() {
            self.context.accel.occluded_path_rays(spheres, &shadow_rays.rays, rays, occluded);
            self.stats.count_path_rays(&shadow_rays.rays, isa);
        }
        self.clock.end(Stage::Occlusion);
        if self.context.scene.has_passable_surfaces() {
            visibility.clear();
            visibility.resize(shadow_rays.pending.len(), Rgb::ONE);
            let (context, stats) = (self.context, RenderStats::default());
            let media = shadow_media;
            let mut walk = ShadowWalk { context, shadow_rays, media, visibility, stats };
            walk.run(occluded, rays, hits);
            self.stats = self.stats + walk.stats;
            self.clock.end(Stage::Occlusion);
            self.add_all_direct(&shadow_rays.pending, visibility.iter().copied());
        } else {
            let visibility =
                occluded.iter().map(|&is_occluded| if is_occluded { Rgb::ZERO } else { Rgb::ONE });
            self.add_all_direct(&shadow_rays.pending, visibility);
        }
        self.clock.end(Stage::AddingLight);
    }

    /// Shades all paths of a stage where they hit or miss.
    fn shade(
        &mut self,
        isa: Isa,
        batches: &mut VertexBatches,
        queues: &mut StageQueues<'_>,
        hits: &[Hit],
    ) {
        let use_lanes = self.uses_lanes();
        let has_catchers = self.context.scene.has_shadow_catchers();
        let constant_radiance = self.constant_environment();
        for (index, &hit) in hits.iter().enumerate() {
            if !self.visible_surfaces.is_empty() {
                self.record_visible_surface(&queues.paths.get(index), hit);
            }
            let escapes = hit.is_miss() && !queues.paths.rays.is_inward(index);
            match constant_radiance.filter(|_| escapes) {
                Some(radiance) => self.shade_constant_miss(&queues.paths.states[index], radiance),
                None if has_catchers && self.is_caught(&queues.paths.states[index], hit) => {
                    self.shade_scalar(queues, index, hit);
                }
                None if use_lanes && !escapes && self.enqueue(isa, batches, queues, index, hit) => {
                }
                None => self.shade_scalar(queues, index, hit),
            }
        }
        self.flush_all(isa, batches, queues);
        self.clock.end(Stage::Sorting);
    }

    /// Returns true if a path comes straight from the camera and hits a shadow catcher.
    fn is_caught(&self, state: &PathState, hit: Hit) -> bool {
        state.depth == 1 && !hit.is_miss() && self.context.scene.is_shadow_catcher(hit.id)
    }

    /// Shades a single path.
    #[inline(never)]
    pub(super) fn shade_scalar(&mut self, queues: &mut StageQueues<'_>, index: usize, hit: Hit) {
        let mut path = queues.paths.get(index);
        let ray = match self.context.scene.spheres().resolve_hit(&path.ray, hit) {
            Some(surface) if self.is_caught(&path.state, hit) => {
                self.shade_shadow_catcher(&path, &surface, &mut queues.shadow)
            }
            Some(surface) => {
                self.clock.count(1, 1);
                self.shade_hit(&mut path, surface, &mut queues.shadow)
            }
            None => self.shade_miss(&mut path),
        };
        if let Some(ray) = ray {
            queues.next.push(&Path { ray, state: path.state });
        }
    }

    /// Adds the unoccluded parts of the pending contributions, given the fraction of light that
    /// each shadow ray transmits.
    #[inline(always)]
    fn add_all_direct(
        &mut self,
        pending: &[PendingDirect],
        transmitted: impl Iterator<Item = Rgb>,
    ) {
        let mut visibility = Rgb::ONE;
        for (pending, transmitted) in pending.iter().zip(transmitted) {
            visibility *= transmitted;
            if !pending.has_more {
                self.add_direct(pending, visibility);
                visibility = Rgb::ONE;
            }
        }
    }

    /// Adds the unoccluded part of a pending direct contribution.
    #[inline(always)]
    pub(super) fn add_direct(&mut self, pending: &PendingDirect, visibility: Rgb) {
        if visibility == Rgb::ZERO && !R::ENABLED {
            return;
        }
        let contribution =
            self.clamp_contribution(pending.radiance * visibility, pending.is_direct);
        self.add_contribution(pending.batch_index, contribution);
        if pending.is_caught {
            self.radiance[pending.batch_index as usize].alpha = 1.0 - visibility.max_element();
        }
        let connection = pending.connection;
        self.recorder.record(|| PathEvent::ShadowRay { connection, visibility, contribution });
    }

    /// Adds a contribution to a sample.
    pub(super) fn add_contribution(&mut self, sample: u32, contribution: Contribution) {
        let radiance = &mut self.radiance[sample as usize];
        let layer =
            if contribution.is_direct { &mut radiance.direct } else { &mut radiance.indirect };
        *layer += contribution.radiance;
    }

    /// Terminates a path: there is no ray on which it continues.
    pub(super) fn terminate(&mut self, reason: Termination) -> Option<PathRay> {
        self.recorder.record(|| PathEvent::End(reason));
        None
    }

    /// Terminates a path at the hard length limit.
    pub(super) fn terminate_at_length_limit(&mut self) -> Option<PathRay> {
        self.stats.truncated_paths += 1;
        self.terminate(Termination::LengthLimit)
    }

    /// Applies `clamp_indirect` to light that reaches the camera, if the scene sets it.
    pub(super) fn clamp_contribution(&self, light: Rgb, is_direct: bool) -> Contribution {
        let brightest = light.max_element();
        match self.integrator.clamp_indirect {
            Some(limit) if !is_direct && brightest > limit => {
                let clamp = limit / brightest;
                Contribution { radiance: light * clamp, clamp, is_direct }
            }
            _ => Contribution { radiance: light, clamp: 1.0, is_direct },
        }
    }

    /// Records that the ray of a path missed.
    pub(super) fn record_miss(&mut self, path: &Path) {
        self.recorder.record(|| PathEvent::Miss {
            depth: path.state.depth,
            wo: -path.ray.direction,
            throughput: path.state.throughput,
        });
    }
}
