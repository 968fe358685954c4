//! The lights that specular connections go to, and points of them.

use crate::color::Rgb;
use crate::geometry::{Sphere, SphereSet};
use crate::math::DVec3;

use super::Lights;
use super::specular::{
    CasterPair, Casters, ConnectedLight, Connection, EmitterView, PairSampler, SpecularPath, Target,
};

/// A point of an emitter or a direction to the sun, drawn for one ball.
#[derive(Clone, Copy, Debug)]
pub struct ConnectedPoint {
    /// The point or direction.
    pub target: Target,
    /// The radiance that it emits.
    pub radiance: Rgb,
    /// Id of the emitter; `None` for the sun.
    pub emitter: Option<u32>,
    density: TargetDensity,
}

#[derive(Clone, Copy, Debug)]
enum TargetDensity {
    /// Of points of an emitter, with the normal of this one.
    Area(EmitterView, DVec3),
    /// Of directions, per solid angle.
    Direction(f64),
}

impl ConnectedPoint {
    /// Returns the pdf, per solid angle at x, of a path from x to this point; 0 if it arrives from
    /// behind.
    #[inline]
    pub fn pdf(&self, connection: &Connection) -> f64 {
        match &self.density {
            TargetDensity::Area(view, normal) => {
                view.density(*normal, connection.direction_at_y, connection.spread)
            }
            TargetDensity::Direction(pdf) => pdf * connection.spread,
        }
    }
}

impl Lights {
    /// Returns true if there is an emitter or a sun for connections to go to.
    pub fn may_connect(&self) -> bool {
        !self.is_empty() || self.environment.sun().is_some()
    }

    /// Creates the sampler of pairs of these balls with the emitters and the sun. If `is_certain`,
    /// chosen pairs are always connected, as where chance is not to find their light.
    pub fn pairs_with(
        &self,
        casters: Casters,
        spheres: &SphereSet,
        is_certain: bool,
    ) -> PairSampler {
        let sun = self.environment.sun().map(|sun| sun.beam());
        PairSampler::new(casters, &self.emitters, sun, spheres, is_certain)
    }

    /// Draws a point of the light of a pair by `u` in `[0, 1)^2`, to be connected with a point `x`;
    /// `None` if the light does not face the ball.
    pub fn sample_connected_point(
        &self,
        pairs: &PairSampler,
        pair: &CasterPair,
        x: DVec3,
        u: [f64; 2],
    ) -> Option<ConnectedPoint> {
        let ConnectedLight::Emitter(index) = pair.light else {
            let sun = self.environment.sun()?;
            let direction = sun.sample(u);
            return Some(ConnectedPoint {
                target: Target::Direction(direction),
                radiance: sun.radiance(direction),
                emitter: None,
                density: TargetDensity::Direction(sun.pdf(direction)),
            });
        };
        let emitter = self.emitters[index as usize];
        let view = pairs.view(pair.caster, index, x)?;
        let on_emitter = view.sample(u);
        Some(ConnectedPoint {
            target: Target::Point(on_emitter.point),
            radiance: emitter.emission,
            emitter: Some(emitter.id),
            density: TargetDensity::Area(view, on_emitter.normal),
        })
    }

    /// Returns the light that connections know as the emitter with this id.
    pub fn connected_emitter(&self, id: u32) -> Option<ConnectedLight> {
        let index = self.emitters.binary_search_by_key(&id, |emitter| emitter.id).ok()?;
        Some(ConnectedLight::Emitter(index as u32))
    }

    /// Returns the radiance of the sun in a direction: 0 beside it, and without a sun.
    pub fn sun_radiance(&self, direction: DVec3) -> Rgb {
        self.environment.sun().map_or(Rgb::ZERO, |sun| sun.radiance(direction))
    }

    /// Returns the pdf, per solid angle at x, with which connections over a ball of index `ior`
    /// find a path of this `kind` between x and a point of a light, given the directions in which
    /// it leaves both; 0 if they do not. `normal` is that of an emitter.
    pub fn connection_pdf(
        &self,
        pairs: &PairSampler,
        (caster, light): (u32, ConnectedLight),
        kind: SpecularPath,
        (x, direction_at_x): (DVec3, DVec3),
        (y, direction_at_y, normal): (Target, DVec3, DVec3),
    ) -> f64 {
        let ball: &Sphere = &pairs.casters().all()[caster as usize].ball;
        let ior = pairs.casters().ior(caster).unwrap_or(1.0);
        let spread = || kind.spread((ball, ior), (x, direction_at_x), (y, direction_at_y));
        match (light, y) {
            (ConnectedLight::Emitter(index), _) => {
                let Some(view) = pairs.view(caster, index, x) else { return 0.0 };
                spread().map_or(0.0, |spread| view.density(normal, direction_at_y, spread))
            }
            (ConnectedLight::Sun, Target::Direction(direction)) => {
                let pdf = self.environment.sun().map_or(0.0, |sun| sun.pdf(direction));
                if pdf > 0.0 { spread().map_or(0.0, |spread| pdf * spread) } else { 0.0 }
            }
            (ConnectedLight::Sun, Target::Point(_)) => 0.0,
        }
    }
}
