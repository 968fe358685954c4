//! Test rays for the backends: through and past the spheres of a scene, from outside, inside and on
//! their surfaces, and secondary rays of given rays.

use rand::{Rng, RngExt, SeedableRng, rngs::StdRng};

use crate::accel::Accel;
use crate::geometry::{Cone, PathRay, Side, SphereSet, SurfaceHit};
use crate::math::{DVec3, Frame, Hit, MAX_COORDINATE, Ray};
use crate::sampling;

/// Rays in a coherent group.
const GROUP_SIZE: usize = 16;

/// Bound on the coordinates of ray origins: less than backends accept, and beyond every surface.
const MAX_POSITION: f64 = 3.5 * MAX_COORDINATE;

/// Generates random rays through a scene with at least one sphere: towards sphere centres and
/// silhouettes, from inside, axis-parallel, leaving surfaces in all directions, towards emitters,
/// and clipped at both ends. All rays are [traceable](is_traceable). Reproducible from the seed.
pub fn random(spheres: &SphereSet, count: usize, seed: u64) -> Vec<PathRay> {
    let mut generator = RayGenerator { spheres, rng: StdRng::seed_from_u64(seed) };
    let generators = RayGenerator::GENERATORS.iter().cycle().take(count);
    let rays = generators.map(|generate| {
        let ray = generate(&mut generator).filter(|ray| is_traceable(spheres, ray));
        ray.unwrap_or_else(|| generator.fallback())
    });
    rays.collect()
}

/// Generates groups of coherent rays, each as large as a block of samples: from one point or nearby
/// points, in nearly the same direction. Returns as many whole groups as fit into `count`.
/// Reproducible from the seed.
pub fn coherent(spheres: &SphereSet, count: usize, seed: u64) -> Vec<PathRay> {
    let mut generator = RayGenerator { spheres, rng: StdRng::seed_from_u64(seed) };
    (0..count / GROUP_SIZE).flat_map(|number| generator.coherent_group(number)).collect()
}

/// Returns true if a backend accepts the ray. Scenes of the largest possible size contain points
/// beyond a backend's range.
pub fn is_traceable(spheres: &SphereSet, ray: &PathRay) -> bool {
    spheres.to_query(ray).is_valid()
}

/// Generates diffuse bounces: one ray per hit of `rays`, cosine-distributed about the normal that
/// faces the ray. Reproducible from the seed.
pub fn secondary(
    spheres: &SphereSet,
    accel: &dyn Accel,
    rays: &[PathRay],
    seed: u64,
) -> Vec<PathRay> {
    let mut rng = StdRng::seed_from_u64(seed);
    let mut bounce = |(ray, hit): (&PathRay, Hit)| {
        let hit = spheres.resolve_hit(ray, hit)?;
        hit.spawn_ray(cosine_direction(hit.facing_normal(), &mut rng))
    };
    rays.iter().zip(first_hits(spheres, accel, rays)).filter_map(&mut bounce).collect()
}

/// Generates shadow rays from the hits of `rays`, each towards a random sphere of the scene as if
/// that were an emitter. Skips rays occluded by their origin sphere. Reproducible from the seed.
pub fn shadow(spheres: &SphereSet, accel: &dyn Accel, rays: &[PathRay], seed: u64) -> Vec<PathRay> {
    let mut rng = StdRng::seed_from_u64(seed);
    let mut shadow = |(ray, hit): (&PathRay, Hit)| {
        let hit = spheres.resolve_hit(ray, hit)?;
        let emitter = rng.random_range(0..spheres.len() as u32);
        let cone = Cone::subtending(hit.point, &spheres.sphere(emitter))?;
        let sample = cone.sample([rng.random(), rng.random()]);
        hit.spawn_shadow_ray(sample.direction, sample.distance, emitter)
    };
    rays.iter().zip(first_hits(spheres, accel, rays)).filter_map(&mut shadow).collect()
}

fn first_hits(spheres: &SphereSet, accel: &dyn Accel, rays: &[PathRay]) -> Vec<Hit> {
    let queries: Vec<Ray> = rays.iter().map(|ray| spheres.to_query(ray)).collect();
    let mut hits = vec![Hit::MISS; rays.len()];
    accel.closest(&queries, &mut hits);
    hits
}

/// Draws a uniform direction on the unit sphere.
pub fn uniform_direction(rng: &mut impl Rng) -> DVec3 {
    let z: f64 = rng.random_range(-1.0..1.0);
    let (sin, cos) = sampling::sin_cos(rng.random_range(0.0..std::f64::consts::TAU));
    let r = (1.0 - z * z).sqrt();
    DVec3::new(r * cos, r * sin, z)
}

fn cosine_direction(normal: DVec3, rng: &mut impl Rng) -> DVec3 {
    (normal + uniform_direction(rng)).try_normalize().unwrap_or(normal)
}

struct RayGenerator<'a> {
    spheres: &'a SphereSet,
    rng: StdRng,
}

impl RayGenerator<'_> {
    /// Generators of random rays, used in turn.
    const GENERATORS: [fn(&mut Self) -> Option<PathRay>; 9] = [
        Self::towards_sphere,
        Self::silhouette,
        Self::ray_from_inside,
        Self::axis_parallel,
        Self::ray_from_surface,
        Self::grazing,
        Self::towards_neighbour,
        Self::towards_emitter,
        Self::clipped,
    ];

    fn random_id(&mut self) -> u32 {
        self.rng.random_range(0..self.spheres.len() as u32)
    }

    /// A point on a random sphere, as if a ray had arrived there from this side.
    fn random_hit(&mut self, side: Side) -> SurfaceHit {
        let id = self.random_id();
        let sphere = self.spheres.sphere(id);
        let normal = uniform_direction(&mut self.rng);
        let point = sphere.center + normal * sphere.radius;
        SurfaceHit { id, t: 0.0, point, normal, radius: sphere.radius, side }
    }

    /// Draws a number whose logarithm is uniform between those of the bounds.
    fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        low * libm::pow(high / low, self.rng.random())
    }

    /// A point near a sphere or between two spheres, at any of the scene's scales.
    fn random_point(&mut self) -> DVec3 {
        let limit = DVec3::splat(MAX_POSITION);
        self.unclamped_point().clamp(-limit, limit)
    }

    fn unclamped_point(&mut self) -> DVec3 {
        let a = self.spheres.sphere(self.random_id());
        if self.rng.random() {
            let distance = a.radius * self.log_uniform(1e-2, 1e4);
            return a.center + uniform_direction(&mut self.rng) * distance;
        }
        let b = self.spheres.sphere(self.random_id());
        a.center.lerp(b.center, self.rng.random_range(-1.0..2.0))
            + uniform_direction(&mut self.rng) * a.radius
    }

    fn towards(&mut self, origin: DVec3, target: DVec3) -> PathRay {
        let any = uniform_direction(&mut self.rng);
        PathRay::new(origin, (target - origin).try_normalize().unwrap_or(any))
    }

    /// A ray that always exists, used where another generator fails.
    fn fallback(&mut self) -> PathRay {
        let (origin, towards) = (self.random_point(), uniform_direction(&mut self.rng));
        PathRay::new(origin, towards)
    }

    fn towards_sphere(&mut self) -> Option<PathRay> {
        let (origin, target) = (self.random_point(), self.random_hit(Side::Outside));
        Some(self.towards(origin, target.point))
    }

    /// Passes a sphere at `R (1 +- 10^-u)`, down to f64 precision and below.
    fn silhouette(&mut self) -> Option<PathRay> {
        let origin = self.random_point();
        let sphere = self.spheres.sphere(self.random_id());
        let offset = self.log_uniform(1e-16, 1e-1);
        let offset = if self.rng.random() { offset } else { -offset };
        let distance = origin.distance(sphere.center);
        let sin = sphere.radius * (1.0 + offset) / distance;
        let frame = Frame::from_z((sphere.center - origin).try_normalize()?);
        let (sin_phi, cos_phi) = sampling::sin_cos(self.rng.random_range(0.0..6.3));
        let cos = (1.0 - sin * sin).max(0.0).sqrt();
        let local = DVec3::new(sin * cos_phi, sin * sin_phi, cos);
        (sin < 1.0).then(|| PathRay::new(origin, frame.to_world(local).normalize()))
    }

    fn ray_from_inside(&mut self) -> Option<PathRay> {
        let hit = self.random_hit(Side::Inside);
        let depth = self.log_uniform(1e-9, 2.0);
        let origin = hit.point - hit.normal * (depth * hit.radius);
        Some(PathRay::new(origin, uniform_direction(&mut self.rng)))
    }

    /// Directions with exact zeros, whose reciprocals are infinite.
    fn axis_parallel(&mut self) -> Option<PathRay> {
        let axis = DVec3::AXES[self.rng.random_range(0..3)];
        let axis = if self.rng.random() { axis } else { -axis };
        let target = self.random_hit(Side::Outside);
        let back = target.radius * self.log_uniform(1e-2, 1e4);
        Some(PathRay::new(target.point - axis * back, axis))
    }

    fn ray_from_surface(&mut self) -> Option<PathRay> {
        let towards = uniform_direction(&mut self.rng);
        self.random_hit(Side::Outside).spawn_ray(towards)
    }

    fn grazing(&mut self) -> Option<PathRay> {
        let hit = self.random_hit(Side::Outside);
        let tilt = self.log_uniform(1e-16, 1e-2);
        let tilt = if self.rng.random() { tilt } else { -tilt };
        let tangent = Frame::from_z(hit.normal).x;
        hit.spawn_ray((tangent + hit.normal * tilt).normalize())
    }

    fn towards_neighbour(&mut self) -> Option<PathRay> {
        let (from, to) = (self.random_hit(Side::Outside), self.random_hit(Side::Outside));
        from.spawn_ray((to.point - from.point).try_normalize()?)
    }

    fn towards_emitter(&mut self) -> Option<PathRay> {
        let from = self.random_hit(Side::Outside);
        let emitter = self.random_id();
        let cone = Cone::subtending(from.point, &self.spheres.sphere(emitter))?;
        let sample = cone.sample([self.rng.random(), self.rng.random()]);
        from.spawn_shadow_ray(sample.direction, sample.distance, emitter)
    }

    /// Rays around a central ray, within an angle and a distance from it.
    fn coherent_group(&mut self, number: usize) -> Vec<PathRay> {
        let generators =
            [Self::towards_sphere, Self::axis_parallel, Self::ray_from_surface, Self::clipped];
        let central = generators[number % generators.len()](self)
            .filter(|ray| is_traceable(self.spheres, ray));
        let central = central.unwrap_or_else(|| self.fallback());
        let angle = self.log_uniform(1e-9, 1e-1);
        let sphere = self.spheres.sphere(self.random_id());
        let distance =
            if number % 2 == 0 { 0.0 } else { sphere.radius * self.log_uniform(1e-6, 1.0) };
        let is_straight = number % 3 == 0;
        let member = |_| {
            let direction = central.direction + uniform_direction(&mut self.rng) * angle;
            let direction = if is_straight { central.direction } else { direction.normalize() };
            let origin = central.origin + uniform_direction(&mut self.rng) * distance;
            let ray = PathRay { origin, direction, ..central };
            if is_traceable(self.spheres, &ray) { ray } else { central }
        };
        (0..GROUP_SIZE).map(member).collect()
    }

    /// A ray with both ends clipped, as by a camera's near plane or a limited range.
    fn clipped(&mut self) -> Option<PathRay> {
        let (origin, target) = (self.random_point(), self.random_hit(Side::Outside));
        let distance = origin.distance(target.point);
        let t_min = distance * self.rng.random_range(0.0..1.0);
        let t_max = distance * self.rng.random_range(1.0..2.0);
        Some(PathRay { t_min, t_max, ..self.towards(origin, target.point) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{Backend, BuildOptions};
    use crate::geometry::{Sphere, SphereRows};
    use crate::task::CancelToken;
    use crate::verify::crosscheck::{TestedBackend, compare};
    use std::sync::Arc;

    #[test]
    fn every_ray_can_be_traced_in_the_largest_scenes() {
        let ball = |x: f64, radius: f64| Sphere { center: DVec3::X * x, radius };
        let largest = ball(MAX_COORDINATE, MAX_COORDINATE);
        let pair = vec![largest, ball(-MAX_COORDINATE, MAX_COORDINATE)];
        for exact in [vec![ball(0.0, MAX_COORDINATE)], pair, vec![largest, ball(0.0, 1.0)]] {
            let rows = SphereRows { exact, table: Vec::new() };
            let spheres = Arc::new(SphereSet::new(rows).expect("few spheres"));
            let rays = random(&spheres, 2000, 3);
            assert!(rays.iter().all(|ray| is_traceable(&spheres, ray)));
            for backend in Backend::AVAILABLE {
                let accel = backend.build(&spheres, &BuildOptions::default()).expect("builds");
                let tested = TestedBackend { name: backend.name(), accel: accel.as_ref() };
                let result = compare(&spheres, &[tested], &rays, &CancelToken::default());
                let result = result.expect("nobody cancels").remove(0);
                assert_eq!(result.failures(), 0, "{result:?}");
            }
        }
    }
}
