//! Light of a small emitter that reaches a point over one polished ball.

use std::f64::consts::{PI, TAU};

use crate::geometry::Sphere;
use crate::math::DVec3;
use crate::scene::PreparedScene;
use crate::scene::description::SurfaceModel;
use crate::verify::closed_forms::reference_image::{
    ReferenceRay, normal, pixel_means, rays, spheres,
};
use crate::verify::quadrature::gauss_legendre;

use super::refraction::cross;
use super::{albedo, emission, material};

/// Steps of a bisection, to the last bit.
const STEPS: usize = 60;

/// The rays from a point that come near the middle of an emitter: which of them arrive, and the
/// share of light that they keep.
struct Pencil<'a> {
    point: DVec3,
    normal: DVec3,
    /// Where a ray goes in the end, and the share that it keeps.
    follow: &'a dyn Fn(ReferenceRay) -> Option<(ReferenceRay, f64)>,
    lamp: Sphere,
}

impl Pencil<'_> {
    /// Passing distance of the ray in a direction from the lamp's centre.
    fn miss(&self, direction: DVec3) -> f64 {
        let ray = ReferenceRay { origin: self.point, direction: direction.normalize() };
        (self.follow)(ray).map_or(f64::INFINITY, |(ray, _)| {
            let to_center = self.lamp.center - ray.origin;
            let along = to_center.dot(ray.direction).max(0.0);
            (to_center - ray.direction * along).length()
        })
    }

    /// Finds the direction to the lamp's centre, by a pattern search from the one to the ball.
    fn middle(&self, start: DVec3) -> DVec3 {
        let (mut best, mut step) = (start.normalize(), 0.2);
        while step > 1e-15 {
            let (u, v) = best.any_orthonormal_pair();
            let around = (0..8).map(|i| {
                let angle = TAU * f64::from(i) / 8.0;
                (best + (u * libm::cos(angle) + v * libm::sin(angle)) * step).normalize()
            });
            let next = around.min_by(|a, b| self.miss(*a).total_cmp(&self.miss(*b)));
            match next.filter(|next| self.miss(*next) < self.miss(best)) {
                Some(next) => best = next,
                None => step *= 0.5,
            }
        }
        best
    }

    /// Irradiance per radiance of the lamp, by quadrature over the directions that reach it. Around
    /// the one to its centre, its edge is found by bisection on every meridian.
    fn irradiance(&self, start: DVec3, nodes: usize) -> f64 {
        let middle = self.middle(start);
        let (u, v) = middle.any_orthonormal_pair();
        let rule = gauss_legendre(2 * nodes);
        let meridians = 16 * nodes;
        let of_meridian = |i: usize| {
            let angle = TAU * i as f64 / meridians as f64;
            let across = u * libm::cos(angle) + v * libm::sin(angle);
            let is_inside = |r: f64| self.miss(middle + across * r) < self.lamp.radius;
            let (mut low, mut high) = (0.0, 1e-6);
            while is_inside(high) {
                high *= 2.0;
            }
            for _ in 0..STEPS {
                let mid = 0.5 * (low + high);
                if is_inside(mid) { low = mid } else { high = mid }
            }
            // A direction middle + r across has the solid angle r dr / (1 + r^2)^(3/2).
            let at = |r: f64| {
                let direction = (middle + across * r).normalize();
                let ray = ReferenceRay { origin: self.point, direction };
                let kept = (self.follow)(ray).map_or(0.0, |(_, kept)| kept);
                kept * direction.dot(self.normal) * r / ((1.0 + r * r) * (1.0 + r * r).sqrt())
            };
            rule.iter().map(|(x, weight)| weight * low * at(low * x)).sum::<f64>()
        };
        (0..meridians).map(of_meridian).sum::<f64>() * TAU / meridians as f64
    }
}

/// The lamp is seen directly, and in a mirror ball.
pub(super) fn over_a_mirror(prepared: &PreparedScene, nodes: usize) -> Vec<Option<f64>> {
    let [ball, mirror, lamp] = three(prepared);
    let kept = albedo(prepared, "mirror");
    let follow = |ray: ReferenceRay| {
        let at = ray.at(ray.hit_distance(&mirror)?);
        Some((ray.reflected(at, normal(&mirror, at)), kept))
    };
    radiance(prepared, nodes, &follow, [ball, mirror, lamp], |point, normal| {
        let to_lamp = lamp.center - point;
        let square = to_lamp.length_squared();
        PI * lamp.radius * lamp.radius / square * normal.dot(to_lamp) / square.sqrt()
    })
}

/// The lamp is inside a glass ball, and its light leaves it once.
pub(super) fn out_of_glass(prepared: &PreparedScene, nodes: usize) -> Vec<Option<f64>> {
    let [ball, glass, lamp] = three(prepared);
    let n = match &material(prepared, "glass").surface {
        SurfaceModel::Dielectric { ior, .. } => *ior,
        _ => 1.0,
    };
    let follow = |ray: ReferenceRay| {
        let (inside, share) = cross(ray, &glass, n)?;
        Some((inside, share / (n * n)))
    };
    radiance(prepared, nodes, &follow, [ball, glass, lamp], |_, _| 0.0)
}

fn radiance(
    prepared: &PreparedScene,
    nodes: usize,
    follow: &dyn Fn(ReferenceRay) -> Option<(ReferenceRay, f64)>,
    [ball, polished, lamp]: [Sphere; 3],
    direct: impl Fn(DVec3, DVec3) -> f64,
) -> Vec<Option<f64>> {
    let (a, le) = (albedo(prepared, "ball"), emission(prepared, "lamp"));
    pixel_means(prepared, nodes, rays(prepared), |ray| {
        let point = ray.at(ray.hit_distance(&ball)?);
        let normal = normal(&ball, point);
        let pencil = Pencil { point, normal, follow, lamp };
        let over_ball = pencil.irradiance(polished.center - point, nodes);
        Some((0, a * le * (over_ball + direct(point, normal)) / PI))
    })
}

fn three(prepared: &PreparedScene) -> [Sphere; 3] {
    let spheres = spheres(prepared);
    [spheres[0], spheres[1], spheres[2]]
}
