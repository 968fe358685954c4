//! Memory that is used again.

use crate::color::Seen;
use crate::material::Media;
use crate::math::{Hit, Isa, Ray};
use crate::sampling::Sampler;

use super::transport::{Block, Drawn, Paths, Shadows, StartBlock};

/// Memory that one thread uses again for every batch.
#[derive(Default)]
pub struct Workspace {
    pub(super) isa: Isa,
    pub(super) paths: Paths,
    pub(super) next_paths: Paths,
    pub(super) start: StartBlock,
    pub(super) block: Block,
    pub(super) shadows: Shadows,
    pub(super) samplers: Vec<Sampler>,
    pub(super) drawn: Vec<Drawn>,
    /// The media that each sample's path is in, where something is a dielectric.
    pub(super) media: Vec<Media>,
    /// The media that shadow rays start in, where something is not opaque.
    pub(super) shadow_media: Vec<Media>,
    pub(super) rays: Vec<Ray>,
    pub(super) hits: Vec<Hit>,
    pub(super) blocked: Vec<bool>,
    /// The share of the light of each shadow ray that arrives.
    pub(super) passed: Vec<f32>,
    pub(super) records_seen: bool,
    /// What each sample sees first, where that is recorded.
    pub(super) seen: Vec<Seen>,
}

impl Workspace {
    /// With a choice of the instructions that vectors are computed with, which changes no bit.
    pub fn with(isa: Isa) -> Self {
        Self { isa, ..Self::default() }
    }

    /// Whether estimates from here on record what each sample sees first.
    pub fn record_seen(&mut self, wanted: bool) {
        self.records_seen = wanted;
    }

    /// What each sample of the last estimate sees first; empty where that is not recorded.
    pub fn seen(&self) -> &[Seen] {
        &self.seen
    }

    /// Forgets the records of the last estimate, and makes room for so many where they are wanted.
    pub(super) fn begin_seen(&mut self, samples: usize) {
        self.seen.clear();
        self.seen.resize(if self.records_seen { samples } else { 0 }, Seen::NOTHING);
    }
}
