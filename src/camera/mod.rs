//! Cameras: map a picture position and a lens position to a ray.
//!
//! Picture positions are in pixels from the upper left corner. Pixels are square, except in a
//! panorama, whose pixels are steps of two angles.

mod aperture;

pub use aperture::Aperture;

use crate::geometry::{PathRay, Sphere};
use crate::math::DVec3;
use crate::sampling::sin_cos;

/// A camera.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// Centre of the lens, relative to the spheres' origin.
    position: DVec3,
    /// Unit view axis; the unit vectors to the right and up in the picture follow.
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    /// From the centre of the picture to its edge, in the projection's units: at distance 1 along
    /// the axis, in scene units, or in radians.
    half_extent: [f64; 2],
    /// From the centre of the picture to its right and top edges, at distance 1 or in scene units.
    right_edge: DVec3,
    top_edge: DVec3,
    model: CameraModel,
    resolution: [f64; 2],
    /// Size of a pixel in normalised device coordinates, across and down.
    ndc_per_pixel: [f64; 2],
    near: f64,
}

/// Position and orientation of a camera.
#[derive(Clone, Copy, Debug)]
pub struct CameraPose {
    /// Centre of the lens, relative to the spheres' origin.
    pub position: DVec3,
    /// The direction of the view axis, any length.
    pub view_direction: DVec3,
    /// The direction that is up in the picture; not parallel to the view axis.
    pub up: DVec3,
    /// Near clipping: rays start at this depth along the view axis; in a panorama, at this
    /// distance.
    pub near: f64,
    /// Resolution in pixels, across and down.
    pub resolution: [u32; 2],
}

/// The projection from directions to picture positions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CameraModel {
    /// Perspective, through a pinhole or a thin lens.
    Perspective {
        /// Angle from the bottom to the top of the picture, in radians, below pi.
        vertical_fov: f64,
        /// The thin lens; `None` is a pinhole.
        lens: Option<ThinLens>,
    },
    /// Orthographic: rays parallel to the axis.
    Orthographic {
        /// Height of the picture, in scene units.
        height: f64,
    },
    /// Panoramic: columns are longitudes, rows are latitudes.
    Panoramic {
        /// Angle from the left to the right of the picture, in radians, up to 2 pi.
        horizontal: f64,
        /// Angle from the bottom to the top, in radians, up to pi.
        vertical: f64,
    },
}

/// A thin lens: all rays from a point in the focal plane converge at one point of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinLens {
    /// The lens aperture.
    pub aperture: Aperture,
    /// Distance from the lens to the plane in focus, along the axis; positive.
    pub focus_distance: f64,
}

/// Returns the unit vectors to the right, up and along the view of a camera that looks in the
/// direction `towards`, with `up` upwards in its picture. Neither needs to be a unit vector.
pub fn axes(towards: DVec3, up: DVec3) -> [DVec3; 3] {
    let forward = towards.normalize();
    let right = forward.cross(up).normalize();
    [right, right.cross(forward), forward]
}

impl Camera {
    /// Creates a camera.
    pub fn new(pose: &CameraPose, model: CameraModel) -> Self {
        let [width, height] = pose.resolution.map(f64::from);
        let [right, up, forward] = axes(pose.view_direction, pose.up);
        let square_pixels = |half_height: f64| [half_height * width / height, half_height];
        let half_extent = match model {
            CameraModel::Perspective { vertical_fov, .. } => {
                square_pixels(libm::tan(vertical_fov / 2.0))
            }
            CameraModel::Orthographic { height } => square_pixels(height / 2.0),
            CameraModel::Panoramic { horizontal, vertical } => [horizontal / 2.0, vertical / 2.0],
        };
        Self {
            position: pose.position,
            forward,
            right,
            up,
            half_extent,
            right_edge: right * half_extent[0],
            top_edge: up * half_extent[1],
            model,
            resolution: [width, height],
            ndc_per_pixel: [2.0 / width, 2.0 / height],
            near: pose.near,
        }
    }

    /// Generates the ray through a picture position, in pixels from the upper left corner, and the
    /// lens position given by two numbers in `[0, 1)`.
    pub fn generate_ray(&self, x: f64, y: f64, lens: [f64; 2]) -> PathRay {
        let [across, upwards] = self.to_ndc(x, y);
        match self.model {
            CameraModel::Perspective { lens: None, .. } => self.generate_pinhole_ray(x, y),
            CameraModel::Perspective { lens: Some(thin), .. } => {
                let direction = self.forward + self.right_edge * across + self.top_edge * upwards;
                let [lens_x, lens_y] = thin.aperture.sample(lens);
                let offset = self.right * lens_x + self.up * lens_y;
                self.spawn_from_lens(
                    self.position + offset,
                    direction - offset / thin.focus_distance,
                )
            }
            CameraModel::Orthographic { .. } => {
                let origin = self.position + self.right_edge * across + self.top_edge * upwards;
                PathRay { t_min: self.near, ..PathRay::new(origin, self.forward) }
            }
            CameraModel::Panoramic { .. } => {
                let (sin_longitude, cos_longitude) = sin_cos(self.half_extent[0] * across);
                let (sin_latitude, cos_latitude) = sin_cos(self.half_extent[1] * upwards);
                let horizontal_direction =
                    self.forward * cos_longitude + self.right * sin_longitude;
                let direction = horizontal_direction * cos_latitude + self.up * sin_latitude;
                let ray = PathRay::new(self.position, direction.normalize());
                PathRay { t_min: self.near, ..ray }
            }
        }
    }

    /// Generates the ray of a pinhole camera, as [`Self::generate_ray`] does.
    #[inline(always)]
    pub fn generate_pinhole_ray(&self, x: f64, y: f64) -> PathRay {
        let [across, upwards] = self.to_ndc(x, y);
        let direction = self.forward + self.right_edge * across + self.top_edge * upwards;
        self.spawn_from_lens(self.position, direction)
    }

    /// Converts a picture position to `[-1, 1]`: to the right, and to the top.
    #[inline(always)]
    fn to_ndc(self, x: f64, y: f64) -> [f64; 2] {
        [self.ndc_per_pixel[0] * x - 1.0, 1.0 - self.ndc_per_pixel[1] * y]
    }

    /// Returns true for a perspective camera without a lens: all rays have the same origin.
    pub fn is_pinhole(&self) -> bool {
        matches!(self.model, CameraModel::Perspective { lens: None, .. })
    }

    /// Returns true if [`Self::generate_ray`] uses the lens position.
    pub fn has_lens(&self) -> bool {
        matches!(self.model, CameraModel::Perspective { lens: Some(_), .. })
    }

    /// Returns the centre of the lens, relative to the spheres' origin.
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// Returns the maximum distance from [`Self::position`] to the origin of a ray that passes the
    /// picture at most `margin` pixels outside.
    pub fn max_origin_distance(&self, margin: f64) -> f64 {
        match self.model {
            CameraModel::Perspective { lens, .. } => lens.map_or(0.0, |lens| lens.aperture.radius),
            CameraModel::Orthographic { .. } => self.half_diagonal(margin),
            CameraModel::Panoramic { .. } => 0.0,
        }
    }

    /// Returns an upper bound on the distance from [`Self::position`] to the start of a ray that
    /// passes the picture at most `margin` pixels outside; no ray's `t_min` is larger.
    pub fn max_start_distance(&self, margin: f64) -> f64 {
        let origin = self.max_origin_distance(margin);
        match self.model {
            CameraModel::Perspective { lens, .. } => {
                let tilt = lens.map_or(0.0, |lens| lens.aperture.radius / lens.focus_distance);
                let slope = self.half_diagonal(margin) + tilt;
                origin + self.near * (1.0 + slope * slope).sqrt()
            }
            CameraModel::Orthographic { .. } => origin + self.near,
            CameraModel::Panoramic { .. } => self.near,
        }
    }

    /// Returns true if a ray that passes the picture at most `margin` pixels outside may meet a
    /// sphere. Conservative: may return true although no ray does, never the reverse.
    pub fn may_see(&self, sphere: &Sphere, margin: f64) -> bool {
        if self.may_start_inside(sphere, margin) {
            return true;
        }
        let to_center = sphere.center - self.position;
        let [x, y, z] = [self.right, self.up, self.forward].map(|axis| to_center.dot(axis));
        let [across, upwards] = self.half_size(margin);
        // Rounding, and what a lens adds to the sides.
        let reach = sphere.radius + self.max_origin_distance(margin) + 1e-9 * to_center.length();
        match self.model {
            CameraModel::Panoramic { .. } => true,
            CameraModel::Orthographic { .. } => {
                z + reach >= self.near
                    && x.abs() <= across + sphere.radius + 1e-9 * across
                    && y.abs() <= upwards + sphere.radius + 1e-9 * upwards
            }
            CameraModel::Perspective { lens, .. } => {
                // A ray through the edge of the lens leaves the picture at another slope.
                let tilt = lens.map_or(0.0, |lens| lens.aperture.radius / lens.focus_distance);
                let is_inside = |side: f64, extent: f64| {
                    let slope = extent + tilt;
                    side.abs() - slope * z <= reach * (1.0 + slope * slope).sqrt()
                };
                z + reach >= self.near && is_inside(x, across) && is_inside(y, upwards)
            }
        }
    }

    /// Returns true if a ray that passes the picture at most `margin` pixels outside may start
    /// inside a sphere. Conservative: may return true although no ray does, never the reverse.
    pub fn may_start_inside(&self, sphere: &Sphere, margin: f64) -> bool {
        let max_start = self.max_start_distance(margin);
        let to_center = sphere.center - self.position;
        let distance = to_center.length();
        // All rays start at one depth, or in a panorama at one distance. The slack is for rounding.
        let offset = match self.model {
            CameraModel::Panoramic { .. } => distance - self.near,
            _ => to_center.dot(self.forward) - self.near,
        };
        let radius = sphere.radius + 1e-12 * (distance + max_start);
        offset.abs() <= radius && distance <= radius + max_start
    }

    /// Returns true if all rays that pass the picture at most `margin` pixels outside start inside
    /// a sphere. Conservative: may return false although all do, never the reverse.
    pub fn must_start_inside(&self, sphere: &Sphere, margin: f64) -> bool {
        let [across, upwards] = self.half_size(margin);
        // All starts lie within `spread` of a rectangle around `center`.
        let (center, scale, spread) = match self.model {
            CameraModel::Perspective { lens, .. } => {
                let spread = |lens: ThinLens| {
                    lens.aperture.radius * (1.0 - self.near / lens.focus_distance).abs()
                };
                (self.position + self.forward * self.near, self.near, lens.map_or(0.0, spread))
            }
            CameraModel::Orthographic { .. } => {
                (self.position + self.forward * self.near, 1.0, 0.0)
            }
            CameraModel::Panoramic { .. } => (self.position, 0.0, self.near),
        };
        let reach = |sign: f64| {
            let (right, up) = (self.right * (across * scale), self.up * (upwards * scale * sign));
            let farther = (center + right + up).distance(sphere.center);
            farther.max((center - right + up).distance(sphere.center)) + spread
        };
        let reach = reach(1.0).max(reach(-1.0));
        reach + 1e-12 * (reach + self.max_start_distance(margin)) < sphere.radius
    }

    /// Spawns a ray that starts at depth `near`, in a direction whose component along the view axis
    /// is 1.
    #[inline(always)]
    fn spawn_from_lens(&self, origin: DVec3, direction: DVec3) -> PathRay {
        let length = direction.length();
        let direction = direction * (1.0 / length);
        PathRay { t_min: self.near * length, ..PathRay::new(origin, direction) }
    }

    /// Returns half the diagonal of a picture extended by `margin` pixels on each side.
    fn half_diagonal(&self, margin: f64) -> f64 {
        let [across, upwards] = self.half_size(margin);
        (across * across + upwards * upwards).sqrt()
    }

    /// Returns half the width and height of a picture extended by `margin` pixels on each side.
    fn half_size(&self, margin: f64) -> [f64; 2] {
        [0, 1].map(|axis| self.half_extent[axis] * (1.0 + 2.0 * margin / self.resolution[axis]))
    }
}

#[cfg(test)]
mod tests;
