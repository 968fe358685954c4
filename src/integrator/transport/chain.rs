//! What a path has met since it last scattered light in more than one direction.
//!
//! Connections find light over one polished ball, and so does chance: a path that is scattered
//! towards the ball and led on by it. Where both can find the same path, multiple importance
//! sampling weights them. This is the record that says whether connections could have found a path,
//! and with which density.

use crate::fault::fault;
use crate::geometry::{Side, SurfaceHit};
use crate::light::LightSampleContext;
use crate::light::specular::{PairSampler, SpecularPath, Target};
use crate::material::{BsdfSample, Lobe};
use crate::math::DVec3;

use super::super::trace::PathRecorder;
use super::batch::PathBatch;
use super::paths::PathState;

/// No ball.
const NO_CASTER: u32 = u32::MAX;

/// The polished balls that a path has met since it last scattered in more than one direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Chain {
    /// What no connection finds.
    Other,
    /// None: the path is on its first edge since.
    AtVertex,
    /// Reflected off the outside of a ball.
    Reflected,
    /// Entered a ball.
    Entered,
    /// Entered a ball and was reflected inside.
    EnteredReflected,
    /// Went through a ball.
    Through,
    /// Went through a ball with one reflection inside.
    ThroughReflected,
    /// Left the ball in which it was scattered.
    Left,
}

/// Where a path last scattered in more than one direction, and what has happened since.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrator) struct ChainRecord {
    /// Unit direction in which it was scattered.
    direction: DVec3,
    /// Index of the ball that it is over; [`NO_CASTER`] before it has met one.
    caster: u32,
    /// Index of the ball in which it was scattered, or [`NO_CASTER`].
    inside: u32,
    /// Probability of all choices at the ball.
    choices: f64,
}

/// A light that a path has found.
pub(super) enum FoundLight<'a> {
    /// The emitter that it hits.
    Emitter(&'a SurfaceHit),
    /// The sun.
    Sun,
}

/// The densities per solid angle of a path that was found by chance over a ball.
pub(super) struct ChainPdfs {
    /// By chance.
    pub(super) chance: f64,
    /// By connections.
    pub(super) connection: f64,
}

impl Chain {
    /// Returns the kind of connection that finds light now.
    fn kind(self) -> Option<SpecularPath> {
        match self {
            Self::Other | Self::AtVertex | Self::EnteredReflected => None,
            Self::Reflected => Some(SpecularPath::Reflection),
            Self::Entered => Some(SpecularPath::Inward),
            Self::Through => Some(SpecularPath::Through),
            Self::ThroughReflected => Some(SpecularPath::ThroughReflected),
            Self::Left => Some(SpecularPath::Outward),
        }
    }
}

impl ChainRecord {
    /// The empty record.
    pub(super) const NONE: Self =
        Self { direction: DVec3::ZERO, caster: NO_CASTER, inside: NO_CASTER, choices: 1.0 };

    fn inside(&self) -> Option<u32> {
        (self.inside != NO_CASTER).then_some(self.inside)
    }
}

impl<R: PathRecorder> PathBatch<'_, R> {
    /// Returns where a path is, if connections are made there: in vacuum (`Some(None)`) or inside
    /// exactly one of the balls.
    pub(super) fn connection_place(
        &self,
        pairs: &PairSampler,
        state: &PathState,
    ) -> Option<Option<u32>> {
        let media = self.media_of(state);
        if media.is_vacuum() {
            return Some(None);
        }
        media.only_sphere().and_then(|sphere| pairs.casters().index_of(sphere)).map(Some)
    }

    /// Notes that a path is scattered at a vertex, before it crosses the boundary there.
    #[inline(never)]
    pub(super) fn advance_chain(
        &mut self,
        pairs: &PairSampler,
        state: &mut PathState,
        from: &LightSampleContext,
        sample: &BsdfSample,
        direction: DVec3,
    ) {
        let index = state.batch_index as usize;
        let is_reflected = sample.wi.z > 0.0;
        if sample.lobe != Lobe::Delta {
            // What goes through a rough surface may be in another medium: left to chance.
            let place = if is_reflected { self.connection_place(pairs, state) } else { None };
            state.chain = if place.is_some() { Chain::AtVertex } else { Chain::Other };
            if let Some(inside) = place {
                let inside = inside.unwrap_or(NO_CASTER);
                self.chain_records[index] =
                    ChainRecord { direction, caster: NO_CASTER, inside, choices: 1.0 };
            }
            return;
        }
        if state.chain == Chain::Other {
            return;
        }
        let record = &mut self.chain_records[index];
        let SurfaceHit { id, side, .. } = from.hit;
        if state.chain == Chain::AtVertex {
            record.caster = pairs.casters().index_of(id).unwrap_or(NO_CASTER);
        }
        record.choices *= sample.pdf;
        let caster = record.caster;
        let is_same = caster != NO_CASTER && pairs.casters().all()[caster as usize].id == id;
        let is_outside = record.inside == NO_CASTER;
        state.chain = match (state.chain, side, is_reflected) {
            _ if !is_same => Chain::Other,
            (Chain::AtVertex, Side::Outside, true) if is_outside => Chain::Reflected,
            (Chain::AtVertex, Side::Outside, false) if is_outside => Chain::Entered,
            (Chain::AtVertex, Side::Inside, false) if record.inside == caster => Chain::Left,
            (Chain::Entered, Side::Inside, false) => Chain::Through,
            (Chain::Entered, Side::Inside, true) => Chain::EnteredReflected,
            (Chain::EnteredReflected, Side::Inside, false) => Chain::ThroughReflected,
            _ => Chain::Other,
        };
    }

    /// Returns the densities of the path on which light is found, arriving in this unit direction;
    /// `None` if connections do not find it.
    #[inline(never)]
    pub(super) fn chain_pdfs(
        &self,
        state: &PathState,
        direction: DVec3,
        light: &FoundLight<'_>,
    ) -> Option<ChainPdfs> {
        let pairs = self.context.prepared.connections()?;
        let kind = state.chain.kind()?;
        let lights = self.context.prepared.lights();
        let record = &self.chain_records[state.batch_index as usize];
        let (target, normal, light) = match light {
            FoundLight::Emitter(hit) => {
                let light = lights.connected_emitter(hit.id)?;
                (Target::Point(hit.point), hit.normal, light)
            }
            FoundLight::Sun => {
                let light = crate::light::specular::ConnectedLight::Sun;
                (Target::Direction(direction), DVec3::ZERO, light)
            }
        };
        let is_inside = record.inside != NO_CASTER;
        if !pairs.kinds(record.caster, is_inside, light).contains(&kind) {
            return None;
        }
        let prev = &self.prev_vertices[state.batch_index as usize];
        let ctx = prev.light_sample_context(self.context.scene.spheres());
        let pair = (record.caster, light);
        let pmf = pairs.pmf(&ctx, record.inside(), pair);
        let pdf = lights.connection_pdf(
            pairs,
            (record.caster, light),
            kind,
            (prev.point, record.direction),
            (target, -direction, normal),
        );
        let connection = if fault!(ConnectionMisForgotten) { 0.0 } else { pmf * pdf };
        let chance = prev.pdf * record.choices;
        (connection > 0.0).then_some(ChainPdfs { chance, connection })
    }
}
