//! Exact images: for each pixel the mean of a function of its rays.
//!
//! This module shares only vector types with the renderer. The camera, the nearest sphere and the
//! pixel's integral are implemented again, as simply as possible.

use crate::geometry::Sphere;
use crate::math::DVec3;
use crate::scene::PreparedScene;
use crate::scene::description::ProjectionDescription;
use crate::verify::quadrature::gauss_legendre;

/// A ray: an origin and a direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReferenceRay {
    pub(super) origin: DVec3,
    /// Unit vector.
    pub(super) direction: DVec3,
}

/// The region of the image that a ray falls in (a surface or the background), and the radiance
/// there, which varies smoothly within a region.
pub(super) type SurfaceRadiance = Option<(usize, f64)>;

/// Margin around a pixel that is searched for other regions, as a fraction of its side.
const MARGIN: f64 = 0.05;
/// Points tested along each edge.
const ALONG_EDGE: usize = 12;

impl ReferenceRay {
    pub(super) fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }

    /// Returns the line from `at`, reflected about `normal`.
    pub(super) fn reflected(&self, at: DVec3, normal: DVec3) -> Self {
        let direction = self.direction - normal * (2.0 * self.direction.dot(normal));
        Self { origin: at, direction }
    }

    /// Distance to a sphere: the near root from outside, the far root from inside.
    pub(super) fn hit_distance(&self, sphere: &Sphere) -> Option<f64> {
        let to_center = sphere.center - self.origin;
        let along = to_center.dot(self.direction);
        let distance_squared = (to_center - self.direction * along).length_squared();
        let half = (sphere.radius * sphere.radius - distance_squared).sqrt();
        let is_inside = to_center.length_squared() < sphere.radius * sphere.radius;
        let t = if is_inside { along + half } else { along - half };
        (t > 0.0).then_some(t) // not a number where the line misses
    }

    /// Finds the nearest sphere, skipping the origin sphere.
    pub(super) fn nearest_hit(
        &self,
        spheres: &[Sphere],
        origin_sphere: Option<usize>,
    ) -> Option<(usize, f64)> {
        let others = spheres.iter().enumerate().filter(|(i, _)| Some(*i) != origin_sphere);
        let hits = others.filter_map(|(i, sphere)| Some((i, self.hit_distance(sphere)?)));
        hits.min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// Outward normal of a sphere at a point.
pub(super) fn normal(sphere: &Sphere, at: DVec3) -> DVec3 {
    (at - sphere.center).normalize()
}

/// Spheres of a scene, in file order.
pub(super) fn spheres(prepared: &PreparedScene) -> Vec<Sphere> {
    let sphere = |row: &crate::scene::description::SphereDescription| Sphere {
        center: row.center,
        radius: row.radius,
    };
    prepared.description().spheres.iter().map(sphere).collect()
}

/// Rays of a perspective (pinhole), orthographic or panoramic camera, by image position in pixels
/// from the upper left corner. For other cameras the rays hit nothing.
pub(super) fn rays(prepared: &PreparedScene) -> impl Fn(f64, f64) -> ReferenceRay {
    let camera = &prepared.description().camera;
    let [width, height] =
        [prepared.image_settings().width, prepared.image_settings().height].map(f64::from);
    let forward = (camera.look_at - camera.position).normalize();
    let right = forward.cross(camera.up).normalize();
    let up = right.cross(forward);
    // Half the image height, at distance 1 (perspective) or at any (orthographic).
    let (half, is_parallel) = match camera.projection {
        ProjectionDescription::Perspective { vertical_fov_degrees, lens: None } => {
            (libm::tan(vertical_fov_degrees.to_radians() / 2.0), false)
        }
        ProjectionDescription::Orthographic { height } => (height / 2.0, true),
        _ => (f64::NAN, false),
    };
    let position = camera.position;
    let extents = match camera.projection {
        ProjectionDescription::Panoramic { horizontal_degrees, vertical_degrees } => {
            Some([horizontal_degrees, vertical_degrees].map(f64::to_radians))
        }
        _ => None,
    };
    move |x, y| {
        if let Some([horizontal, vertical]) = extents {
            // Longitude and latitude are linear in the image position, relative to the centre.
            let (longitude, latitude) =
                (horizontal * (x / width - 0.5), vertical * (0.5 - y / height));
            let horizontal_direction =
                forward * libm::cos(longitude) + right * libm::sin(longitude);
            let direction = horizontal_direction * libm::cos(latitude) + up * libm::sin(latitude);
            return ReferenceRay { origin: position, direction };
        }
        let across = right * (half * (2.0 * x - width) / height);
        let offset = across + up * (half * (height - 2.0 * y) / height);
        if is_parallel {
            ReferenceRay { origin: position + offset, direction: forward }
        } else {
            ReferenceRay { origin: position, direction: (forward + offset).normalize() }
        }
    }
}

/// Mean of `shade` over each pixel, by Gauss-Legendre quadrature with `nodes` squared points;
/// `None` for a pixel with more than one region or without a closed form.
pub(super) fn pixel_means(
    prepared: &PreparedScene,
    nodes: usize,
    ray: impl Fn(f64, f64) -> ReferenceRay,
    shade: impl Fn(ReferenceRay) -> SurfaceRadiance,
) -> Vec<Option<f64>> {
    let rule = gauss_legendre(nodes);
    let pixel = |x: u32, y: u32| {
        let evaluate = |u: f64, v: f64| shade(ray(f64::from(x) + u, f64::from(y) + v));
        let (region, _) = evaluate(0.5, 0.5)?;
        let is_same_region = |(u, v)| evaluate(u, v).is_some_and(|(other, _)| other == region);
        if !edge_points().all(is_same_region) {
            return None;
        }
        let row = |&(u, weight): &(f64, f64)| {
            rule.iter().map(move |&(v, w)| weight * w * evaluate(u, v).map_or(f64::NAN, |s| s.1))
        };
        Some(rule.iter().flat_map(row).sum())
    };
    let rows = 0..prepared.image_settings().height;
    rows.flat_map(|y| (0..prepared.image_settings().width).map(move |x| (x, y)))
        .map(|(x, y)| pixel(x, y))
        .collect()
}

/// Points along the edges of a slightly enlarged pixel.
fn edge_points() -> impl Iterator<Item = (f64, f64)> {
    let (low, high) = (-MARGIN, 1.0 + MARGIN);
    (0..ALONG_EDGE).flat_map(move |i| {
        let at = low + (high - low) * i as f64 / (ALONG_EDGE - 1) as f64;
        [(at, low), (at, high), (low, at), (high, at)]
    })
}
