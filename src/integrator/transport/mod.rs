//! Path tracing, stage by stage over a batch of paths.
//!
//! The recursion of the rendering equation, written as a loop: a path carries its `throughput`, the
//! product of `f cos / pdf` so far, and adds `throughput x emission` to its sample at every emitter
//! it hits. [`super::path`], [`super::direct`] and [`super::paper`] are this loop with different
//! options. A [`super::trace::PathRecorder`] may record it.
//!
//! The stages of one edge, in a file each where they are more than a loop: camera rays
//! ([`camera_paths`]), closest hits ([`batch`]), surfaces ([`shade`]) and their emission
//! ([`emission`]), light sampling ([`next_event`]), connections over polished balls ([`connect`]),
//! BSDF sampling and Russian roulette ([`scatter`]), occlusion ([`batch`]).

mod batch;
mod camera_paths;
mod chain;
mod chances;
mod connect;
mod emission;
mod lanes;
mod next_event;
mod opacity;
mod pair_site;
mod path_tracer;
mod paths;
mod scatter;
mod shade;
mod shadow_catcher;
mod vertex;
mod visible_surface;
mod weight;

use std::mem::take;

use crate::color::PathRadiance;

use super::context::RenderContext;
use super::estimate::Integrator;
use super::profile::StageClock;
use super::sample::{RenderStats, SampleAddress};
use super::trace::{NullRecorder, PathEvent, PathTrace};
use super::workspace::Workspace;

use batch::PathBatch;

pub(super) use camera_paths::CameraRayBatch;
pub(super) use chain::ChainRecord;
pub(super) use lanes::VertexBatches;
pub(super) use path_tracer::PathTracer;
pub(super) use paths::{PathQueue, PrevVertex, ShadowRays};

impl Integrator for PathTracer {
    fn estimate(
        &self,
        context: RenderContext<'_>,
        samples: &[SampleAddress],
        radiance: &mut [PathRadiance],
        workspace: &mut Workspace,
    ) -> RenderStats {
        let stats = RenderStats::default();
        let recorder = &mut NullRecorder;
        workspace.reset_visible_surfaces(samples.len());
        let Workspace { media, visible_surfaces, samplers, prev_vertices, chain_records, .. } =
            workspace;
        let (media, visible_surfaces, samplers, prev_vertices, chain_records) = (
            take(media),
            take(visible_surfaces),
            take(samplers),
            take(prev_vertices),
            take(chain_records),
        );
        let clock = workspace.clock;
        let transport = self;
        PathBatch {
            integrator: transport,
            context,
            samples,
            radiance,
            media,
            visible_surfaces,
            samplers,
            prev_vertices,
            chain_records,
            stats,
            clock,
            recorder,
        }
        .run(workspace)
    }

    fn trace_path(&self, context: RenderContext<'_>, address: SampleAddress) -> Option<PathTrace> {
        let mut events: Vec<PathEvent> = Vec::new();
        let mut radiance = [PathRadiance::default()];
        let batch = PathBatch {
            integrator: self,
            context,
            samples: &[address],
            radiance: &mut radiance,
            media: Vec::new(),
            visible_surfaces: Vec::new(),
            samplers: Vec::new(),
            prev_vertices: Vec::new(),
            chain_records: Vec::new(),
            stats: RenderStats::default(),
            clock: StageClock::default(),
            recorder: &mut events,
        };
        let stats = batch.run(&mut Workspace::default());
        let [radiance] = radiance;
        Some(PathTrace { address, events, radiance, stats })
    }
}
