//! What a path has met since it last scattered light in more than one direction.
//!
//! Connections find light over one polished ball, and so does chance: a path that is scattered
//! towards the ball and led on by it. Where both can find the same path, multiple importance
//! sampling weights them. This is the record that says whether connections could have found a path,
//! and with which density.

use crate::geometry::SurfaceHit;
use crate::light::specular::SpecularPath;
use crate::math::DVec3;

/// No ball.
pub(super) const NO_CASTER: u32 = u32::MAX;

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
    pub(super) direction: DVec3,
    /// Index of the ball that it is over; [`NO_CASTER`] before it has met one.
    pub(super) caster: u32,
    /// Index of the ball in which it was scattered, or [`NO_CASTER`].
    pub(super) inside: u32,
    /// Probability of all choices at the ball.
    pub(super) choices: f64,
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
    pub(super) fn kind(self) -> Option<SpecularPath> {
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

    pub(super) fn inside(&self) -> Option<u32> {
        (self.inside != NO_CASTER).then_some(self.inside)
    }
}
