//! Exact pictures: for each pixel the mean of a function of its rays.
//!
//! Nothing of the renderer is used here but its vectors: the camera, the nearest sphere and the
//! pixel's integral are worked out again, plainly.

use crate::geometry::Sphere;
use crate::math::DVec3;
use crate::scene::PreparedScene;
use crate::scene::description::ProjectionDescription;
use crate::verify::quadrature::gauss_legendre;

/// A straight line from a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChartLine {
    pub(super) origin: DVec3,
    /// Unit.
    pub(super) direction: DVec3,
}

/// What a ray sees: which piece of the scene, and its radiance there. Within a piece the radiance
/// changes smoothly.
pub(super) type SurfaceRadiance = Option<(usize, f64)>;

/// How far beyond its edge a pixel is searched for other pieces, as a share of its side.
const MARGIN: f64 = 0.05;
/// Places along each edge that are looked at for that.
const ALONG_EDGE: usize = 12;

impl ChartLine {
    pub(super) fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }

    /// The line from here in another direction.
    pub(super) fn reflected(&self, at: DVec3, normal: DVec3) -> Self {
        let direction = self.direction - normal * (2.0 * self.direction.dot(normal));
        Self { origin: at, direction }
    }

    /// Where the line meets a sphere, at the near wall from outside and the far wall from inside.
    pub(super) fn hit_distance(&self, sphere: &Sphere) -> Option<f64> {
        let to_center = sphere.center - self.origin;
        let along = to_center.dot(self.direction);
        let off = (to_center - self.direction * along).length_squared();
        let half = (sphere.radius * sphere.radius - off).sqrt();
        let is_inside = to_center.length_squared() < sphere.radius * sphere.radius;
        let t = if is_inside { along + half } else { along - half };
        (t > 0.0).then_some(t) // not a number where the line misses
    }

    /// The first of the spheres, but for the one that the line leaves.
    pub(super) fn nearest_hit(
        &self,
        spheres: &[Sphere],
        leaves: Option<usize>,
    ) -> Option<(usize, f64)> {
        let others = spheres.iter().enumerate().filter(|(i, _)| Some(*i) != leaves);
        let hits = others.filter_map(|(i, sphere)| Some((i, self.hit_distance(sphere)?)));
        hits.min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// The outward normal of a sphere at a point.
pub(super) fn normal(sphere: &Sphere, at: DVec3) -> DVec3 {
    (at - sphere.center).normalize()
}

/// The spheres of a scene, in the order of the file.
pub(super) fn spheres(shot: &PreparedScene) -> Vec<Sphere> {
    let sphere = |row: &crate::scene::description::SphereDescription| Sphere {
        center: row.center,
        radius: row.radius,
    };
    shot.description().spheres.iter().map(sphere).collect()
}

/// The rays of a pinhole, parallel ones or those of a panorama, by places in the picture in pixels from its upper left
/// corner; those of other cameras see nothing.
pub(super) fn rays(shot: &PreparedScene) -> impl Fn(f64, f64) -> ChartLine {
    let camera = &shot.description().camera;
    let [width, height] =
        [shot.image_settings().width, shot.image_settings().height].map(f64::from);
    let forward = (camera.look_at - camera.position).normalize();
    let right = forward.cross(camera.up).normalize();
    let up = right.cross(forward);
    // Half the picture's height, at distance 1 or at any.
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
        if let Some([around, upwards]) = extents {
            // Equal steps of longitude and latitude from the middle.
            let (longitude, latitude) = (around * (x / width - 0.5), upwards * (0.5 - y / height));
            let level = forward * libm::cos(longitude) + right * libm::sin(longitude);
            let direction = level * libm::cos(latitude) + up * libm::sin(latitude);
            return ChartLine { origin: position, direction };
        }
        let across = right * (half * (2.0 * x - width) / height);
        let aside = across + up * (half * (height - 2.0 * y) / height);
        if is_parallel {
            ChartLine { origin: position + aside, direction: forward }
        } else {
            ChartLine { origin: position, direction: (forward + aside).normalize() }
        }
    }
}

/// The mean of what is seen over each pixel, by `nodes` squared places of a Gaussian rule; `None`
/// for a pixel with more than one piece in it, or with what has no answer.
pub(super) fn pixel_means(
    shot: &PreparedScene,
    nodes: usize,
    ray: impl Fn(f64, f64) -> ChartLine,
    seen: impl Fn(ChartLine) -> SurfaceRadiance,
) -> Vec<Option<f64>> {
    let rule = gauss_legendre(nodes);
    let pixel = |x: u32, y: u32| {
        let look = |u: f64, v: f64| seen(ray(f64::from(x) + u, f64::from(y) + v));
        let (piece, _) = look(0.5, 0.5)?;
        let alone = |(u, v)| look(u, v).is_some_and(|(other, _)| other == piece);
        if !edge_points().all(alone) {
            return None;
        }
        let row = |&(u, weight): &(f64, f64)| {
            rule.iter().map(move |&(v, w)| weight * w * look(u, v).map_or(f64::NAN, |s| s.1))
        };
        Some(rule.iter().flat_map(row).sum())
    };
    let rows = 0..shot.image_settings().height;
    rows.flat_map(|y| (0..shot.image_settings().width).map(move |x| (x, y)))
        .map(|(x, y)| pixel(x, y))
        .collect()
}

/// Places along the edges of a pixel that is a little larger than it is.
fn edge_points() -> impl Iterator<Item = (f64, f64)> {
    let (low, high) = (-MARGIN, 1.0 + MARGIN);
    (0..ALONG_EDGE).flat_map(move |i| {
        let at = low + (high - low) * i as f64 / (ALONG_EDGE - 1) as f64;
        [(at, low), (at, high), (low, at), (high, at)]
    })
}
