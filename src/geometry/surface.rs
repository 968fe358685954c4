//! A path's own ray, and the point on a sphere where it ends.

use crate::fault::fault;
use crate::math::{DVec3, NO_SPHERE};

/// An f64 ray of a path, as it leaves the camera or a sphere.
///
/// Coordinates are relative to [`super::SphereSet::origin`].
#[derive(Clone, Copy, Debug)]
pub struct PathRay {
    /// Where it starts.
    pub origin: DVec3,
    /// Where it goes: unit length within f64 rounding.
    pub direction: DVec3,
    /// Hits at or before this distance do not count; 0 except for camera rays.
    pub t_min: f64,
    /// Hits at or beyond this distance do not count.
    pub t_max: f64,
    /// The sphere whose surface it starts on, which it cannot hit except at `far_wall`.
    pub leaves: u32,
    /// The sphere that a shadow ray aims at, which cannot block it.
    pub aims_at: u32,
    /// Where a ray going into the sphere it leaves meets that sphere again; infinite otherwise.
    pub far_wall: f64,
}

/// The side of a sphere that a ray arrives at, or leaves to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The side that the outward normal points to.
    Outside,
    /// The side of the centre.
    Inside,
}

/// A point on a sphere, found by [`super::SphereSet::answer`].
#[derive(Clone, Copy, Debug)]
pub struct SurfaceHit {
    /// Which sphere.
    pub id: u32,
    /// Distance along the ray, in scene units.
    pub t: f64,
    /// The point, on the sphere to f64 rounding; relative to [`super::SphereSet::origin`].
    pub point: DVec3,
    /// Unit normal, always pointing away from the sphere's centre.
    pub normal: DVec3,
    /// Radius of the sphere.
    pub radius: f64,
    /// The side that the ray arrived from.
    pub side: Side,
}

impl PathRay {
    /// A ray from a point in space that belongs to no sphere, such as a camera's.
    pub fn free(origin: DVec3, direction: DVec3) -> Self {
        Self {
            origin,
            direction,
            t_min: 0.0,
            t_max: f64::INFINITY,
            leaves: NO_SPHERE,
            aims_at: NO_SPHERE,
            far_wall: f64::INFINITY,
        }
    }

    /// The point at distance `t`.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

impl Side {
    /// The side that a direction leads to.
    pub fn of_leaving(direction: DVec3, normal: DVec3) -> Self {
        if direction.dot(normal) < 0.0 { Self::Inside } else { Self::Outside }
    }

    /// The side that a direction comes from.
    pub fn of_arriving(direction: DVec3, normal: DVec3) -> Self {
        if direction.dot(normal) > 0.0 { Self::Inside } else { Self::Outside }
    }
}

impl SurfaceHit {
    /// The unit normal on the side that the ray arrived from.
    pub fn facing_normal(&self) -> DVec3 {
        match self.side {
            Side::Outside => self.normal,
            Side::Inside if fault!(NormalFacesAway) => self.normal,
            Side::Inside => -self.normal,
        }
    }

    /// The ray that leaves this point. Leaving outwards it cannot meet its own sphere again;
    /// going inwards it meets the far wall at `-2 d.(p-c) / d.d`, in closed form. `None` where that
    /// chord has no length, which ends a path.
    pub fn leave(&self, direction: DVec3) -> Option<PathRay> {
        let mut ray = PathRay { leaves: self.id, ..PathRay::free(self.point, direction) };
        let cosine = direction.dot(self.normal);
        if cosine < 0.0 && !fault!(FarWallIgnored) {
            ray.far_wall = -2.0 * self.radius * cosine / direction.length_squared();
            if ray.far_wall <= 0.0 {
                return None;
            }
        }
        Some(ray)
    }

    /// The shadow ray from this point to a lamp `distance` away in this direction, or infinitely far
    /// to no sphere; `None` where the sphere itself stands in the way.
    pub fn leave_towards(&self, direction: DVec3, distance: f64, lamp: u32) -> Option<PathRay> {
        let ray = self.leave_up_to(direction, distance, lamp)?;
        let goes_in = ray.far_wall < f64::INFINITY;
        let own_wall_blocks = goes_in && lamp != self.id && ray.far_wall <= distance;
        (!own_wall_blocks).then_some(ray)
    }

    /// Like [`Self::leave_towards`], but for light that may pass through the sphere's far wall.
    pub fn leave_up_to(&self, direction: DVec3, distance: f64, lamp: u32) -> Option<PathRay> {
        self.leave(direction).map(|ray| PathRay { t_max: distance, aims_at: lamp, ..ray })
    }
}
