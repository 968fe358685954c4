//! Path rays, their surface hits, and the rays spawned there.

use crate::fault::fault;
use crate::math::{DVec3, NO_SPHERE};

/// An f64 ray of a path, as spawned at the camera or a sphere.
///
/// Coordinates are relative to [`super::SphereSet::origin`].
#[derive(Clone, Copy, Debug)]
pub struct PathRay {
    /// Origin of the ray.
    pub origin: DVec3,
    /// Direction: unit length within f64 rounding.
    pub direction: DVec3,
    /// Hits at or before this distance do not count; 0 except for camera rays.
    pub t_min: f64,
    /// Hits at or beyond this distance do not count.
    pub t_max: f64,
    /// The sphere whose surface it starts on, which it cannot hit except at `t_exit`.
    pub origin_sphere: u32,
    /// The target sphere of a shadow ray, which cannot occlude it.
    pub target_sphere: u32,
    /// For a ray into its origin sphere, the distance at which it hits that sphere again; infinite
    /// otherwise.
    pub t_exit: f64,
}

/// The side of a sphere that a ray arrives at, or leaves to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The side that the outward normal points to.
    Outside,
    /// The side of the centre.
    Inside,
}

/// A point on a sphere, returned by [`super::SphereSet::resolve_hit`].
#[derive(Clone, Copy, Debug)]
pub struct SurfaceHit {
    /// Id of the sphere.
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
    /// Creates a ray from a point that belongs to no sphere, such as a camera's.
    #[inline(always)]
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self {
            origin,
            direction,
            t_min: 0.0,
            t_max: f64::INFINITY,
            origin_sphere: NO_SPHERE,
            target_sphere: NO_SPHERE,
            t_exit: f64::INFINITY,
        }
    }

    /// Returns the point at distance `t`.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

impl Side {
    /// Returns the side that a direction leads to.
    pub fn of_outgoing(direction: DVec3, normal: DVec3) -> Self {
        if direction.dot(normal) < 0.0 { Self::Inside } else { Self::Outside }
    }

    /// Returns the side that a direction comes from.
    pub fn of_incoming(direction: DVec3, normal: DVec3) -> Self {
        if direction.dot(normal) > 0.0 { Self::Inside } else { Self::Outside }
    }
}

impl SurfaceHit {
    /// Returns the unit normal on the side that the ray arrived from.
    #[inline(always)]
    pub fn facing_normal(&self) -> DVec3 {
        match self.side {
            Side::Outside => self.normal,
            Side::Inside if fault!(NormalFacesAway) => self.normal,
            Side::Inside => -self.normal,
        }
    }

    /// Spawns a ray from this point. An outward ray cannot hit its own sphere again; an inward ray
    /// hits the exit point at `-2 d.(p-c) / d.d`, in closed form. `None` if that chord has no
    /// length, which ends a path.
    #[inline(always)]
    pub fn spawn_ray(&self, direction: DVec3) -> Option<PathRay> {
        let mut ray = PathRay { origin_sphere: self.id, ..PathRay::new(self.point, direction) };
        let cosine = direction.dot(self.normal);
        if cosine < 0.0 && !fault!(ExitDistanceIgnored) {
            ray.t_exit = -2.0 * self.radius * cosine / direction.length_squared();
            if ray.t_exit <= 0.0 {
                return None;
            }
        }
        Some(ray)
    }

    /// Spawns a shadow ray from this point to an emitter `distance` away in this direction, or to
    /// infinity and no sphere; `None` if the sphere itself occludes it.
    #[inline(always)]
    pub fn spawn_shadow_ray(
        &self,
        direction: DVec3,
        distance: f64,
        emitter: u32,
    ) -> Option<PathRay> {
        let ray = self.spawn_ray_to(direction, distance, emitter)?;
        let is_inward = ray.t_exit < f64::INFINITY;
        let is_self_occluded = is_inward && emitter != self.id && ray.t_exit <= distance;
        (!is_self_occluded).then_some(ray)
    }

    /// Spawns a shadow ray like [`Self::spawn_shadow_ray`], but one that may pass through the
    /// sphere's exit point.
    #[inline(always)]
    pub fn spawn_ray_to(&self, direction: DVec3, distance: f64, emitter: u32) -> Option<PathRay> {
        self.spawn_ray(direction).map(|ray| PathRay {
            t_max: distance,
            target_sphere: emitter,
            ..ray
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At the left end of a ball of radius 2 around the origin.
    const LEFT: SurfaceHit = SurfaceHit {
        id: 7,
        t: 1.0,
        point: DVec3::new(-2.0, 0.0, 0.0),
        normal: DVec3::NEG_X,
        radius: 2.0,
        side: Side::Outside,
    };

    #[test]
    fn a_point_along_a_ray_is_that_far_away() {
        let ray = PathRay::new(DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.0, 0.6, 0.8));
        assert_eq!(ray.at(10.0), DVec3::new(1.0, 8.0, 11.0));
    }

    #[test]
    fn a_side_is_the_sign_of_a_cosine_and_along_the_surface_it_is_outside() {
        for (x, outgoing, incoming) in [
            (1.0, Side::Outside, Side::Inside),
            (0.0, Side::Outside, Side::Outside),
            (-1.0, Side::Inside, Side::Outside),
        ] {
            let direction = DVec3::new(x, 1.0, 0.0);
            assert_eq!(Side::of_outgoing(direction, DVec3::X), outgoing, "{x}");
            assert_eq!(Side::of_incoming(direction, DVec3::X), incoming, "{x}");
        }
        assert_eq!(LEFT.facing_normal(), DVec3::NEG_X);
        assert_eq!(SurfaceHit { side: Side::Inside, ..LEFT }.facing_normal(), DVec3::X);
    }

    #[test]
    fn an_inward_ray_has_an_exit_point_and_an_outward_one_has_none() {
        let spawn = |x: f64, y: f64| LEFT.spawn_ray(DVec3::new(x, y, 0.0)).expect("a ray");
        let inwards = spawn(1.0, 0.0);
        assert_eq!((inwards.origin, inwards.origin_sphere, inwards.t_exit), (LEFT.point, 7, 4.0));
        // A chord at an angle, and a direction that is no unit vector.
        assert!((spawn(0.6, 0.8).t_exit - 2.4).abs() < 1e-15);
        assert_eq!(spawn(4.0, 0.0).t_exit, 1.0);
        assert_eq!([spawn(-1.0, 0.0), spawn(0.0, 1.0)].map(|r| r.t_exit), [f64::INFINITY; 2]);
        assert!(LEFT.spawn_ray(DVec3::new(5e-324, 1.0, 0.0)).is_some(), "the shortest chord");
        let speck = SurfaceHit { radius: 0.1, ..LEFT };
        assert!(speck.spawn_ray(DVec3::new(5e-324, 1.0, 0.0)).is_none(), "a chord without length");
    }

    #[test]
    fn a_sphere_occludes_itself_up_to_its_exit_point() {
        let [inwards, outwards] = [DVec3::X, DVec3::NEG_X];
        // Another emitter: inside the sphere, at the exit point, beyond it, and on the other side.
        let reaches = |direction, distance| LEFT.spawn_shadow_ray(direction, distance, 3).is_some();
        assert!(reaches(inwards, 3.9));
        assert!(!reaches(inwards, 4.0) && !reaches(inwards, 4.1));
        assert!(!reaches(inwards, f64::INFINITY));
        assert!(reaches(outwards, 4.1) && reaches(outwards, f64::INFINITY));
        // The sphere itself as the emitter, and light that may pass through.
        let own = LEFT.spawn_shadow_ray(inwards, 4.0, 7).expect("its own light");
        let through = LEFT.spawn_ray_to(inwards, 9.0, 3).expect("a ray");
        assert_eq!((own.t_max, own.target_sphere, own.origin_sphere), (4.0, 7, 7));
        assert_eq!((through.t_max, through.target_sphere, through.t_exit), (9.0, 3, 4.0));
    }
}
