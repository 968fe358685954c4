//! The kinds of connections.

use crate::fault::fault;
use crate::geometry::Sphere;
use crate::math::DVec3;

use super::connection::{Connection, Connections};
use super::plane::{Plane, Target};
use super::reflection::{self, Reflection};
use super::through::{self, Through};
use super::{boundary, equation};

/// A kind of path from x over one ball to y.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpecularPath {
    /// Reflected off the outside.
    Reflection,
    /// Through the ball without a reflection inside.
    Through,
    /// Through the ball with one reflection inside.
    ThroughReflected,
    /// From inside the ball to the outside.
    Outward,
    /// From outside the ball to the inside.
    Inward,
}

impl SpecularPath {
    /// The kinds between two points outside of a dielectric ball.
    pub const OVER_DIELECTRIC: [Self; 3] =
        [Self::Reflection, Self::Through, Self::ThroughReflected];

    /// The number of edges from x to y.
    #[inline]
    pub fn edges(self) -> u32 {
        match self {
            Self::Reflection | Self::Outward | Self::Inward => 2,
            Self::Through => 3,
            Self::ThroughReflected => 4,
        }
    }

    /// Returns all paths of this kind from x to y over a ball. `ior` is its index of refraction
    /// over that of its surroundings, which reflection does not use.
    pub fn connect(self, ball: &Sphere, ior: f64, x: DVec3, y: Target) -> Connections {
        let mut all = Connections::NONE;
        self.connect_each(ball, ior, x, y, |connection| all.push(connection));
        all
    }

    /// As [`Self::connect`], handing each path to `found`.
    #[inline]
    pub fn connect_each(
        self,
        ball: &Sphere,
        ior: f64,
        x: DVec3,
        y: Target,
        found: impl FnMut(Connection),
    ) {
        let found = all_roots(found);
        match self {
            Self::Reflection => equation::connect::<Reflection>(ball, ior, (x, y), found),
            Self::Through => equation::connect::<Through<0>>(ball, ior, (x, y), found),
            Self::ThroughReflected => equation::connect::<Through<1>>(ball, ior, (x, y), found),
            Self::Outward => boundary::connect_outward(ball, ior, (x, y), found),
            Self::Inward => {
                if let Target::Point(y) = y {
                    boundary::connect_inward(ball, ior, (x, y), found);
                }
            }
        }
    }

    /// Returns the spread of one path of this kind that was found by other means, such as by
    /// chance, from the unit directions in which it leaves x and y; `None` if no path of this kind
    /// leads from x to y.
    pub fn spread(
        self,
        (ball, ior): (&Sphere, f64),
        (x, direction_at_x): (DVec3, DVec3),
        (y, direction_at_y): (Target, DVec3),
    ) -> Option<f64> {
        let plane = Plane::new(*ball, x, y);
        let sin_at_x = || plane.x_axis.cross(direction_at_x).length();
        match self {
            Self::Reflection => reflection::spread(&plane, sin_at_x()),
            Self::Through => through::spread::<0>(&plane, ior, sin_at_x()),
            Self::ThroughReflected => through::spread::<1>(&plane, ior, sin_at_x()),
            Self::Outward => {
                let cos = plane.x_axis.dot(direction_at_x);
                boundary::outward_spread(&plane, ior, [cos, sin_at_x()])
            }
            Self::Inward => {
                let Target::Point(y) = y else { return None };
                let ends = ((y, direction_at_y), (Target::Point(x), direction_at_x));
                let outward = Self::Outward.spread((ball, ior), ends.0, ends.1)?;
                Some(boundary::inward_spread(outward, ior))
            }
        }
    }

    /// Returns the product of the Fresnel factors, for a dielectric whose boundary has this
    /// `reflectance` at the connection's angle: the share of light that takes the path, and also
    /// the probability with which chance does.
    #[inline]
    pub fn passage(self, reflectance: f64) -> f64 {
        let transmittance = 1.0 - reflectance;
        match self {
            Self::Reflection => reflectance,
            Self::Through => transmittance * transmittance,
            Self::ThroughReflected => transmittance * transmittance * reflectance,
            Self::Outward | Self::Inward => transmittance,
        }
    }

    /// Returns `(n_x / n_y)^2`, by which the change of medium multiplies radiance.
    #[inline]
    pub fn radiance_scale(self, ior: f64) -> f64 {
        match self {
            Self::Outward => ior * ior,
            Self::Inward => 1.0 / (ior * ior),
            _ => 1.0,
        }
    }
}

/// Hands on every connection, unless a fault is seeded.
#[inline(always)]
pub(super) fn all_roots(mut found: impl FnMut(Connection)) -> impl FnMut(Connection) {
    let mut count = 0;
    move |connection| {
        count += 1;
        if count == 1 || !fault!(ConnectionRootMissing) {
            found(connection);
        }
    }
}
