//! Path tracing, stage by stage over a batch of paths.
//!
//! The recursion of the rendering equation, written as a loop: a path carries its `throughput`, the
//! product of `f cos / pdf` so far, and adds `throughput x emission` to its sample wherever it meets
//! light. [`super::path`], [`super::direct`] and [`super::paper`] are this loop with different choices.
//! A [`super::trace::Recorder`] may listen to it.
//!
//! The stages of one edge, a file each where they are more than a loop: camera rays ([`start`]),
//! closest hits ([`batch`]), surfaces and their emission ([`shade`]), light samples ([`aim`]), the
//! next directions and who goes on ([`scatter`]), occlusion ([`batch`]).

mod aim;
mod batch;
mod choices;
mod matt;
mod opacity;
mod paths;
mod scatter;
mod see;
mod shade;
mod start;
mod weight;

use std::mem::take;

use crate::color::Radiance;

use super::estimate::Integrator;
use super::sample::{SampleAddress, Tally};
use super::trace::{Silent, Step, Trace};
use super::workspace::Workspace;
use super::world::World;

use batch::Batch;

pub(super) use choices::Transport;
pub(super) use matt::Block;
pub(super) use paths::{Drawn, Paths, Shadows};
pub(super) use start::StartBlock;

impl Integrator for Transport {
    fn estimate(
        &self,
        world: World<'_>,
        samples: &[SampleAddress],
        radiance: &mut [Radiance],
        workspace: &mut Workspace,
    ) -> Tally {
        let tally = Tally::default();
        let recorder = &mut Silent;
        workspace.begin_seen(samples.len());
        let Workspace { media, seen, samplers, drawn, .. } = workspace;
        let (media, seen, samplers, drawn) = (take(media), take(seen), take(samplers), take(drawn));
        let transport = self;
        Batch { transport, world, samples, radiance, media, seen, samplers, drawn, tally, recorder }
            .run(workspace)
    }

    fn trace(&self, world: World<'_>, address: SampleAddress) -> Option<Trace> {
        let mut steps: Vec<Step> = Vec::new();
        let mut radiance = [Radiance::default()];
        let batch = Batch {
            transport: self,
            world,
            samples: &[address],
            radiance: &mut radiance,
            media: Vec::new(),
            seen: Vec::new(),
            samplers: Vec::new(),
            drawn: Vec::new(),
            tally: Tally::default(),
            recorder: &mut steps,
        };
        let tally = batch.run(&mut Workspace::default());
        let [radiance] = radiance;
        Some(Trace { address, steps, radiance, tally })
    }
}
