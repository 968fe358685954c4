//! The path of a chance: follows what it meets, and compares its density with that of connections.

use crate::fault::fault;
use crate::geometry::{Side, SurfaceHit};
use crate::light::LightSampleContext;
use crate::light::specular::{ConnectedLight, PairSampler, Target};
use crate::material::{BsdfSample, Lobe};
use crate::math::DVec3;

use super::super::trace::PathRecorder;
use super::batch::PathBatch;
use super::chain::{Chain, ChainPdfs, ChainRecord, FoundLight, NO_CASTER};
use super::paths::PathState;

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
                let light = ConnectedLight::Sun;
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
