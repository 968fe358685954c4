//! A connection: a path from x over one ball to y.

use std::ops::Deref;

use crate::math::DVec3;

/// The most connections of one kind between two points.
///
/// `psi` falls to the fold and rises from it, so each target has at most two roots, and one on the
/// far side of 0 has one. Through the ball with an inner reflection, the targets are `-theta`,
/// `theta - 2 pi` and `theta`; because `psi >= -4 asin(1 / n)`, it cannot fall below `-pi` and also
/// rise above 0.
pub const MAX_CONNECTIONS: usize = 4;
/// The most points of a connection on the ball.
const MAX_POINTS: usize = 3;

/// A path from x over one ball to y. All its points on the ball share the angles of incidence.
#[derive(Clone, Copy, Debug)]
pub struct Connection {
    /// Unit direction at x, which leads to the ball.
    pub direction_at_x: DVec3,
    /// Unit direction at y, which leads to the ball.
    pub direction_at_y: DVec3,
    pub(super) points: [DVec3; MAX_POINTS],
    pub(super) count: u8,
    /// Length of the leg at x.
    pub leg_at_x: f64,
    /// Length of each leg between points on the ball; 0 if there is one point.
    pub chord: f64,
    /// Length of the leg at y; infinite for a direction.
    pub leg_at_y: f64,
    /// Cosine of the angle between normal and ray outside of the ball.
    pub cos_outside: f64,
    /// Cosine of the angle between normal and ray inside the ball; 0 for a reflection off its
    /// outside.
    pub cos_inside: f64,
    /// `|dA / dw|`: area at y across the ray, per solid angle at x; for a direction, solid angle
    /// of y per solid angle at x. Infinite where the ray grazes the ball, 0 at a caustic.
    pub spread: f64,
}

/// All connections of one kind between two points.
#[derive(Clone, Copy, Debug)]
pub struct Connections {
    list: [Connection; MAX_CONNECTIONS],
    count: usize,
}

impl Connection {
    pub(super) const NONE: Self = Self {
        direction_at_x: DVec3::ZERO,
        direction_at_y: DVec3::ZERO,
        points: [DVec3::ZERO; MAX_POINTS],
        count: 0,
        leg_at_x: 0.0,
        chord: 0.0,
        leg_at_y: 0.0,
        cos_outside: 0.0,
        cos_inside: 0.0,
        spread: 0.0,
    };

    /// The points on the ball, from x to y.
    #[inline]
    pub fn points(&self) -> &[DVec3] {
        &self.points[..usize::from(self.count)]
    }

    /// Adds the next point.
    #[inline(always)]
    pub(super) fn push(&mut self, point: DVec3) {
        self.points[usize::from(self.count)] = point;
        self.count += 1;
    }

    /// Returns the same path from y to x, with the spread at its other end.
    #[inline(always)]
    pub(super) fn reversed(mut self, spread: f64) -> Self {
        std::mem::swap(&mut self.direction_at_x, &mut self.direction_at_y);
        std::mem::swap(&mut self.leg_at_x, &mut self.leg_at_y);
        self.points[..usize::from(self.count)].reverse();
        self.spread = spread;
        self
    }
}

impl Connections {
    pub(super) const NONE: Self = Self { list: [Connection::NONE; MAX_CONNECTIONS], count: 0 };

    #[inline(always)]
    pub(super) fn push(&mut self, connection: Connection) {
        if self.count < MAX_CONNECTIONS {
            self.list[self.count] = connection;
            self.count += 1;
        }
    }
}

impl Deref for Connections {
    type Target = [Connection];

    #[inline(always)]
    fn deref(&self) -> &[Connection] {
        &self.list[..self.count]
    }
}
