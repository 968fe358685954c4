//! What connects a vertex with a pair of a ball and a light.

use crate::geometry::Sphere;
use crate::light::specular::{
    CasterPair, ConnectedLight, Connection, PairSampler, RootLanes, SpecularPath,
};
use crate::light::{ConnectedPoint, Lights};
use crate::math::DVec3;

/// What a vertex is connected with: a pair, by paths of these kinds.
pub(super) struct PairSite<'a> {
    pub(super) pairs: &'a PairSampler,
    pub(super) pair: &'a CasterPair,
    /// The ball that the vertex is in, by its index.
    pub(super) inside: Option<u32>,
    pub(super) kinds: &'static [SpecularPath],
    pub(super) x: DVec3,
    /// Edges that are left.
    pub(super) room: u32,
}

impl PairSite<'_> {
    /// The ball, and its index of refraction, which reflection does not use.
    fn ball(&self) -> (&Sphere, f64) {
        let (casters, caster) = (self.pairs.casters(), self.pair.caster);
        (&casters.all()[caster as usize].ball, casters.ior(caster).unwrap_or(1.0))
    }

    /// The kinds for which edges are left, in order.
    fn kinds(&self) -> impl Iterator<Item = SpecularPath> + '_ {
        self.kinds.iter().copied().filter(|kind| kind.edges() <= self.room)
    }

    /// Draws a point of the light by `u`, and hands `found` every connection to it. Returns false
    /// if the light does not face the ball.
    pub(super) fn connect(
        &self,
        lights: &Lights,
        u: [f64; 2],
        mut found: impl FnMut(&ConnectedPoint, SpecularPath, &Connection),
    ) -> bool {
        let Some(point) = lights.sample_connected_point(self.pairs, self.pair, self.x, u) else {
            return false;
        };
        let (ball, ior) = self.ball();
        for kind in self.kinds() {
            kind.connect_each(ball, ior, self.x, point.target, |connection| {
                found(&point, kind, &connection);
            });
        }
        true
    }

    /// As [`Self::connect`], with a point and roots that a lane found.
    pub(super) fn connect_lane(
        &self,
        point: &ConnectedPoint,
        (roots, lane): (&[RootLanes], usize),
        mut found: impl FnMut(&ConnectedPoint, SpecularPath, &Connection),
    ) {
        let ends = (self.x, point.target);
        // The filter of kinds leaves out the last ones.
        for (kind, roots) in self.kinds().zip(roots) {
            roots.connect_each(lane, kind, self.ball(), ends, |connection| {
                found(point, kind, &connection);
            });
        }
    }
}

/// Returns the kinds of connections over the ball of a pair from a point with this normal: none if
/// all of the ball is below its horizon.
pub(super) fn connected_kinds(
    pairs: &PairSampler,
    (caster, light): (u32, ConnectedLight),
    inside: Option<u32>,
    (x, normal): (DVec3, DVec3),
) -> &'static [SpecularPath] {
    let ball = &pairs.casters().all()[caster as usize].ball;
    if inside.is_none() && (ball.center - x).dot(normal) <= -ball.radius {
        return &[];
    }
    pairs.kinds(caster, inside.is_some(), light)
}
