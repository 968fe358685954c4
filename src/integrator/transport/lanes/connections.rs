//! Connections of the vertices of a batch: the points of lights and the roots, ahead of their
//! shadow rays.

use crate::light::specular::{CasterPair, ConnectedLight, PairSampler, SpecularPath, Target};
use crate::math::{Isa, LANES};

use super::super::super::dimension;
use super::super::super::trace::PathRecorder;
use super::super::batch::PathBatch;
use super::super::pair_site::connected_kinds;
use super::super::paths::StageQueues;
use super::connection_lanes::{ConnectionLanes, PairLanes};
use super::vertex_batch::VertexBatch;

/// Of fewer lanes, each is solved by itself.
const FEWEST: u32 = 6;

impl<R: PathRecorder> PathBatch<'_, R> {
    /// Solves the connections of all vertices in vacuum that were found worth it.
    pub(super) fn solve_connections(
        &self,
        isa: Isa,
        pairs: &PairSampler,
        batch: &mut VertexBatch,
        queues: &StageQueues<'_>,
    ) {
        batch.connections.clear();
        let is_ready = |lane: usize| {
            let state = &queues.paths.states[batch.vertices[lane].path as usize];
            let is_hit = !batch.hit.is_lost.0[lane];
            is_hit && self.may_scatter(state) && self.media_of(state).is_vacuum()
        };
        let ready = set_of(batch.count, is_ready);
        // Where pairs are chosen from many, no worths are known.
        for (n, (caster, light)) in pairs.pairs(None).enumerate().take(pairs.worths().len()) {
            let chosen = ready & set_of(batch.count, |lane| batch.pairs.0[lane] >> n & 1 != 0);
            let is_solved_here = !pairs.kinds(caster, false, light).contains(&SpecularPath::Inward);
            if chosen.count_ones() >= FEWEST && is_solved_here {
                let pair = CasterPair { n: n as u32, caster, light, pmf: 1.0 };
                let all = &mut batch.connections.pairs;
                all.resize_with(all.len().max(n + 1), PairLanes::default);
                self.draw_points(pairs, &pair, chosen, batch, queues);
                self.find_roots(isa, pairs, &pair, batch);
            }
        }
    }

    /// Draws the points of the light of a pair for the chosen lanes.
    fn draw_points(
        &self,
        pairs: &PairSampler,
        pair: &CasterPair,
        chosen: u32,
        batch: &mut VertexBatch,
        queues: &StageQueues<'_>,
    ) {
        let VertexBatch { connections, hit, vertices, .. } = batch;
        let ConnectionLanes { ends, pairs: solved, .. } = connections;
        let solved = &mut solved[pair.n as usize];
        let lights = self.context.prepared.lights();
        ends.is_direction = pair.light == ConnectedLight::Sun;
        for lane in (0..LANES).filter(|lane| chosen >> lane & 1 != 0) {
            let x = hit.point.get(lane);
            let place = (x, hit.facing_normal.get(lane));
            if connected_kinds(pairs, (pair.caster, pair.light), None, place).is_empty() {
                continue;
            }
            let state = &queues.paths.states[vertices[lane].path as usize];
            let u = self.sampler(state).get_2d(dimension::connection(state.depth, pair.n));
            let point = lights.sample_connected_point(pairs, pair, x, u);
            if let Some(point) = &point {
                let (Target::Point(y) | Target::Direction(y)) = point.target;
                ends.x.set(lane, x);
                ends.y.set(lane, y);
            }
            solved.points[lane] = point;
            solved.lanes |= 1 << lane;
        }
    }

    /// Finds the roots of all kinds for the points that were drawn.
    fn find_roots(
        &self,
        isa: Isa,
        pairs: &PairSampler,
        pair: &CasterPair,
        batch: &mut VertexBatch,
    ) {
        let VertexBatch { connections, depth, .. } = batch;
        let ConnectionLanes { finder, ends, pairs: solved } = connections;
        let PairLanes { lanes, points, roots } = &mut solved[pair.n as usize];
        let caster = &pairs.casters().all()[pair.caster as usize];
        let ior = pairs.casters().ior(pair.caster).unwrap_or(1.0);
        for (kind, roots) in pairs.kinds(pair.caster, false, pair.light).iter().zip(roots) {
            for (lane, point) in points.iter().enumerate() {
                let has_point = *lanes >> lane & 1 != 0 && point.is_some();
                let edges = depth.0[lane] + kind.edges();
                ends.is_used.0[lane] = has_point && edges <= self.integrator.max_depth;
            }
            finder.find(isa, *kind, (&caster.ball, ior), ends, roots);
        }
    }
}

/// Returns the set of lanes below `count` that a condition holds for, as bits.
fn set_of(count: usize, condition: impl Fn(usize) -> bool) -> u32 {
    (0..count).filter(|&lane| condition(lane)).fold(0, |set, lane| set | 1 << lane)
}
