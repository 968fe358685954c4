//! The plane through the centre of a ball and the two points to connect, in radii of the ball.

use crate::fault::fault;
use crate::geometry::Sphere;
use crate::math::{DVec3, Frame};

/// What a point is to be connected to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// A point.
    Point(DVec3),
    /// Infinitely far away in a unit direction, such as a point of the sun.
    Direction(DVec3),
}

/// The plane, with its axes, and where x and y are in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    pub(super) ball: Sphere,
    /// Unit vector from the centre to x.
    pub(super) x_axis: DVec3,
    /// Unit vector at right angles to it, on the side of y.
    across: DVec3,
    /// Distances `d1` and `d2` of x and y from the centre; infinite for a direction.
    pub(super) distances: [f64; 2],
    /// Cosine and sine of `theta` in `[0, pi]`, the angle between x and y at the centre.
    pub(super) cos_theta: f64,
    pub(super) sin_theta: f64,
}

/// Where two points are, as seen from the centre of a ball.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    x_axis: DVec3,
    /// Normal of the plane, of length `sin_theta`.
    normal: DVec3,
    /// Distances of x and y; that of a direction is infinite.
    pub(super) distances: [f64; 2],
    pub(super) cos_theta: f64,
    /// Not negative.
    pub(super) sin_theta: f64,
}

impl Triangle {
    #[inline(always)]
    pub(super) fn new(ball: &Sphere, x: DVec3, y: Target) -> Self {
        let [from_center, y_from_center] = match y {
            Target::Point(y) => [x - ball.center, y - ball.center],
            Target::Direction(direction) => [x - ball.center, direction],
        };
        let per_radius = 1.0 / ball.radius;
        let [d1, length] = [from_center, y_from_center].map(|v| v.length());
        let d2 = if let Target::Direction(_) = y { f64::INFINITY } else { length * per_radius };
        let y_axis = unit_or(y_from_center, length, DVec3::Z);
        // In the centre, every axis is one; along y, the two do not differ.
        let x_axis = unit_or(from_center, d1, y_axis);
        let normal = x_axis.cross(y_axis);
        Self {
            x_axis,
            normal,
            distances: [d1 * per_radius, d2],
            cos_theta: x_axis.dot(y_axis),
            sin_theta: normal.length(),
        }
    }
}

impl Plane {
    #[inline(always)]
    pub(super) fn new(ball: Sphere, x: DVec3, y: Target) -> Self {
        let Triangle { x_axis, normal, distances, cos_theta, sin_theta } =
            Triangle::new(&ball, x, y);
        let across = normal.cross(x_axis);
        let across = if sin_theta > 0.0 { across / sin_theta } else { Frame::from_z(x_axis).x };
        Self { ball, x_axis, across, distances, cos_theta, sin_theta }
    }

    /// Returns the vector with these components along the axis through x and across it.
    #[inline(always)]
    pub(super) fn vector(&self, along: f64, across: f64) -> DVec3 {
        let across = if fault!(ConnectionSideSwapped) { -across } else { across };
        self.x_axis * along + self.across * across
    }

    /// Returns the point of the ball at the angle with this cosine and sine from x.
    #[inline(always)]
    pub(super) fn point(&self, cos: f64, sin: f64) -> DVec3 {
        self.ball.center + self.vector(cos, sin) * self.ball.radius
    }

    /// Returns the direction at y that leads to the ball at the angle with this cosine and sine
    /// from the direction to the centre, on the side of x.
    #[inline(always)]
    pub(super) fn direction_at_y(&self, cos: f64, sin: f64) -> DVec3 {
        let (c, s) = (self.cos_theta, self.sin_theta);
        self.vector(-cos * c + sin * s, -cos * s - sin * c)
    }
}

/// Returns true if both points are outside of the ball, or on it, given their distances.
#[inline(always)]
pub(super) fn are_outside([d1, d2]: [f64; 2]) -> bool {
    (d1 >= 1.0) & (d2 >= 1.0)
}

/// Returns the unit vector along one of this length, or another one for no length.
#[inline(always)]
fn unit_or(v: DVec3, length: f64, other: DVec3) -> DVec3 {
    if length > 0.0 { v / length } else { other }
}
