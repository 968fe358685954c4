//! Draws the points of an emissive sphere that connections over a ball go to.
//!
//! All points from which some of the ball is above the horizon form a cap around the direction to
//! the ball. The density on the cap rises linearly from its rim, in the height along its axis: far
//! from the ball that is the projected area, as in a cone from the ball's centre, but unlike there
//! it does not vanish where the ball is still seen. An emitter inside the ball faces x instead:
//! there, the cap is around the points where the connections of x to its centre cross the boundary.

use crate::geometry::Sphere;
use crate::math::{DVec3, Frame};
use crate::sampling;

use super::connection::MAX_CONNECTIONS;
use super::path_kind::SpecularPath;
use super::plane::Target;

/// The caps of an emissive sphere from which its points are drawn.
#[derive(Clone, Copy, Debug)]
pub struct EmitterView {
    emitter: Sphere,
    caps: [ViewCap; MAX_CONNECTIONS],
    count: usize,
}

/// A cap of an emissive sphere, in radii.
#[derive(Clone, Copy, Debug)]
struct ViewCap {
    /// Unit vector from the centre of the emitter.
    axis: DVec3,
    /// Height of the rim along the axis, at least -1 and below 1.
    rim: f64,
}

/// A point of an emissive sphere.
#[derive(Clone, Copy, Debug)]
pub struct EmitterPoint {
    /// The point.
    pub point: DVec3,
    /// Outward unit normal.
    pub normal: DVec3,
}

impl EmitterView {
    /// Returns the emitter as seen from all points of a ball; `None` if it does not emit towards
    /// the ball, which is inside of it.
    #[inline]
    pub fn from_ball(ball: &Sphere, emitter: &Sphere) -> Option<Self> {
        let mut view = Self::new(emitter);
        view.push(ball.center, emitter.radius - ball.radius);
        (view.count > 0).then_some(view)
    }

    /// Returns an emitter that is inside a ball, as seen from a point outside of the ball; `None`
    /// if no light from its centre arrives there.
    pub fn through_boundary(ball: &Sphere, ior: f64, x: DVec3, emitter: &Sphere) -> Option<Self> {
        let mut view = Self::new(emitter);
        let to_center = SpecularPath::Inward.connect(ball, ior, x, Target::Point(emitter.center));
        // The points of the boundary move about as far as those of the emitter.
        to_center.iter().for_each(|found| view.push(found.points()[0], -emitter.radius));
        (view.count > 0).then_some(view)
    }

    fn new(emitter: &Sphere) -> Self {
        let none = ViewCap { axis: DVec3::Z, rim: -1.0 };
        Self { emitter: *emitter, caps: [none; MAX_CONNECTIONS], count: 0 }
    }

    /// Adds the cap around the direction to a point. Its rim is at `height` over the distance.
    #[inline(always)]
    fn push(&mut self, viewpoint: DVec3, height: f64) {
        let to_view = viewpoint - self.emitter.center;
        let distance = to_view.length();
        let rim = (height / distance).max(-1.0);
        if rim < 1.0 {
            self.caps[self.count] = ViewCap { axis: to_view / distance, rim };
            self.count += 1;
        }
    }

    /// Draws a point from `u` in `[0, 1)^2`.
    #[inline]
    pub fn sample(&self, u: [f64; 2]) -> EmitterPoint {
        let scaled = u[0] * self.count as f64;
        let index = (scaled as usize).min(self.count - 1);
        let ViewCap { axis, rim } = self.caps[index];
        // 1 - z, which keeps its precision near the axis.
        let depth = (1.0 - rim) * (1.0 - (scaled - index as f64).clamp(0.0, 1.0).sqrt());
        let sin = (depth * (2.0 - depth)).max(0.0).sqrt();
        let (sin_phi, cos_phi) = sampling::sin_cos_2pi(u[1]);
        let local = DVec3::new(sin * cos_phi, sin * sin_phi, 1.0 - depth);
        let normal = Frame::from_z(axis).to_world(local).normalize();
        EmitterPoint { point: self.emitter.center + normal * self.emitter.radius, normal }
    }

    /// Returns the pdf of [`Self::sample`] per area of the emitter.
    #[inline]
    pub fn pdf(&self, normal: DVec3) -> f64 {
        let per_radius_squared = |cap: &ViewCap| {
            let width = 1.0 - cap.rim;
            (normal.dot(cap.axis) - cap.rim).max(0.0) / (std::f64::consts::PI * width * width)
        };
        let sum: f64 = self.caps[..self.count].iter().map(per_radius_squared).sum();
        sum / (self.count as f64 * self.emitter.radius * self.emitter.radius)
    }

    /// Returns the density per solid angle at x of a connection to a point with this normal, from
    /// its unit direction at the point and its spread; 0 if the point faces away.
    #[inline]
    pub fn density(&self, normal: DVec3, direction_at_y: DVec3, spread: f64) -> f64 {
        let cos = normal.dot(direction_at_y);
        if cos <= 0.0 {
            return 0.0;
        }
        self.pdf(normal) * spread / cos
    }
}
