//! A ray traced by the laws of reflection and refraction, with its derivatives by the direction in
//! which it started (Igehy 1999, "Tracing Ray Differentials").

use crate::geometry::Sphere;
use crate::math::{DVec3, Frame};

use super::super::{Connection, Target};

/// What happens to a ray at the ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Event {
    Reflect,
    /// The ray enters or leaves, by its side.
    Refract,
}

/// A ray, with the derivatives of its origin and direction by two components of its first
/// direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct TracedRay {
    pub(super) origin: DVec3,
    pub(super) direction: DVec3,
    d_origin: [DVec3; 2],
    d_direction: [DVec3; 2],
}

impl TracedRay {
    pub(super) fn new(origin: DVec3, direction: DVec3) -> Self {
        let frame = Frame::from_z(direction);
        Self { origin, direction, d_origin: [DVec3::ZERO; 2], d_direction: [frame.x, frame.y] }
    }

    /// Moves to the ball and turns there; `None` if it misses or is reflected totally.
    pub(super) fn meet(&self, ball: &Sphere, ior: f64, event: Event) -> Option<Self> {
        let is_inside = self.origin.distance(ball.center) < ball.radius * (1.0 + 1e-9)
            && (self.origin - ball.center).dot(self.direction) < 1e-9 * ball.radius
            || self.origin.distance(ball.center) < ball.radius * (1.0 - 1e-9);
        let roots = ball.roots(self.origin, self.direction)?;
        let t = if is_inside { roots.far } else { roots.near };
        let (origin, outward) = ball.reproject(self.origin, self.direction, t);
        let normal = if is_inside { -outward } else { outward };
        let cos = self.direction.dot(normal);
        let eta = if is_inside { ior } else { 1.0 / ior };
        let mut next = *self;
        next.origin = origin;
        let cos_after = -(1.0 - eta * eta * (1.0 - cos * cos)).sqrt();
        let mu = eta * cos - cos_after;
        next.direction = match event {
            Event::Reflect => self.direction - normal * (2.0 * cos),
            Event::Refract => self.direction * eta - normal * mu,
        };
        next.direction = next.direction.normalize();
        for k in 0..2 {
            let moved = self.d_origin[k] + self.d_direction[k] * t;
            let d_origin = moved - self.direction * (moved.dot(normal) / cos);
            let d_normal = d_origin / if is_inside { -ball.radius } else { ball.radius };
            let d_cos = self.d_direction[k].dot(normal) + self.direction.dot(d_normal);
            next.d_origin[k] = d_origin;
            next.d_direction[k] = match event {
                Event::Reflect => self.d_direction[k] - (d_normal * cos + normal * d_cos) * 2.0,
                Event::Refract => {
                    let d_mu = (eta - eta * eta * cos / cos_after) * d_cos;
                    self.d_direction[k] * eta - (d_normal * mu + normal * d_mu)
                }
            };
        }
        next.direction.is_finite().then_some(next)
    }

    /// Traces a connection.
    pub(super) fn along(
        connection: &Connection,
        ball: &Sphere,
        ior: f64,
        x: DVec3,
        events: &[Event],
    ) -> Option<Self> {
        let start = Self::new(x, connection.direction_at_x);
        events.iter().try_fold(start, |ray, &event| ray.meet(ball, ior, event))
    }

    /// Distance by which the ray misses a point, over the distance of that point from the centre
    /// of the ball; for a direction, the angle.
    pub(super) fn miss(&self, ball: &Sphere, target: Target) -> f64 {
        match target {
            Target::Direction(direction) => self.direction.distance(direction),
            Target::Point(y) => {
                let to_y = y - self.origin;
                to_y.cross(self.direction).length() / y.distance(ball.center)
            }
        }
    }

    /// Area across the ray per solid angle at its start, at the target.
    pub(super) fn spread(&self, target: Target) -> f64 {
        let edges = match target {
            Target::Direction(_) => self.d_direction,
            Target::Point(y) => {
                let t = (y - self.origin).dot(self.direction);
                [0, 1].map(|k| self.d_origin[k] + self.d_direction[k] * t)
            }
        };
        edges[0].cross(edges[1]).dot(self.direction).abs()
    }
}
