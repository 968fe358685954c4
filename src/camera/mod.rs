//! From a place in the picture, and one on the lens, to a ray.
//!
//! Places in the picture are counted in pixels from its upper left corner; pixels are square except
//! in a panorama, whose pixels are steps of two angles.

mod aperture;

pub use aperture::Aperture;

use crate::geometry::{PathRay, Sphere};
use crate::math::DVec3;
use crate::sampling::sin_cos;

/// A camera.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// The middle of the lens, relative to the spheres' origin.
    position: DVec3,
    /// Unit view axis, and the unit vectors to the right and up in the picture.
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    /// From the middle of the picture to its edge, as the projection measures it: at distance 1 along
    /// the axis, in scene units, or in radians.
    half_extent: [f64; 2],
    /// From the middle of the picture to its right edge, and to its top, at distance 1 or in scene units.
    right_edge: DVec3,
    top_edge: DVec3,
    model: CameraModel,
    resolution: [f64; 2],
    /// Twice the share of the picture that a pixel takes, across and down.
    ndc_per_pixel: [f64; 2],
    near: f64,
}

/// Where a camera is and how it is held.
#[derive(Clone, Copy, Debug)]
pub struct CameraPose {
    /// The middle of the lens, relative to the spheres' origin.
    pub position: DVec3,
    /// The direction of the view axis, any length.
    pub view_direction: DVec3,
    /// The direction that is up in the picture; not parallel to the axis.
    pub up: DVec3,
    /// Rays start where their depth along the view axis is this; in a panorama, their distance.
    pub near: f64,
    /// Pixels across and down.
    pub resolution: [u32; 2],
}

/// How directions become places in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CameraModel {
    /// Through one point, or through a thin lens around it.
    Perspective {
        /// Angle from the bottom to the top of the picture, in radians, below pi.
        vertical_fov: f64,
        /// `None` is a pinhole.
        lens: Option<ThinLens>,
    },
    /// Parallel to the axis.
    Orthographic {
        /// What fits between the bottom and the top of the picture, in scene units.
        height: f64,
    },
    /// All around: columns are longitudes, rows are latitudes.
    Panoramic {
        /// Angle from the left to the right of the picture, in radians, up to 2 pi.
        horizontal: f64,
        /// Angle from the bottom to the top, in radians, up to pi.
        vertical: f64,
    },
}

/// A thin lens: all rays from a point at the focus distance meet in one point of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinLens {
    /// Its opening.
    pub aperture: Aperture,
    /// From the lens to the plane in focus, along the axis; positive.
    pub focus_distance: f64,
}

/// The unit vectors to the right, up and along the view of a camera that looks in the direction
/// `towards`, with `up` upwards in its picture. Neither needs to be a unit vector.
pub fn axes(towards: DVec3, up: DVec3) -> [DVec3; 3] {
    let forward = towards.normalize();
    let right = forward.cross(up).normalize();
    [right, right.cross(forward), forward]
}

impl Camera {
    /// A camera.
    pub fn new(mount: &CameraPose, projection: CameraModel) -> Self {
        let [width, height] = mount.resolution.map(f64::from);
        let [right, up, forward] = axes(mount.view_direction, mount.up);
        let square = |half_height: f64| [half_height * width / height, half_height];
        let half = match projection {
            CameraModel::Perspective { vertical_fov, .. } => square(libm::tan(vertical_fov / 2.0)),
            CameraModel::Orthographic { height } => square(height / 2.0),
            CameraModel::Panoramic { horizontal, vertical } => [horizontal / 2.0, vertical / 2.0],
        };
        Self {
            position: mount.position,
            forward,
            right,
            up,
            half_extent: half,
            right_edge: right * half[0],
            top_edge: up * half[1],
            model: projection,
            resolution: [width, height],
            ndc_per_pixel: [2.0 / width, 2.0 / height],
            near: mount.near,
        }
    }

    /// The ray through a place in the picture, in pixels from its upper left corner, and the place on
    /// the lens that two numbers in `[0, 1)` give.
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
                let level = self.forward * cos_longitude + self.right * sin_longitude;
                let direction = level * cos_latitude + self.up * sin_latitude;
                let free = PathRay::new(self.position, direction.normalize());
                PathRay { t_min: self.near, ..free }
            }
        }
    }

    /// [`Self::generate_ray`] of a pinhole camera.
    #[inline(always)]
    pub fn generate_pinhole_ray(&self, x: f64, y: f64) -> PathRay {
        let [across, upwards] = self.to_ndc(x, y);
        let direction = self.forward + self.right_edge * across + self.top_edge * upwards;
        self.spawn_from_lens(self.position, direction)
    }

    /// A place in the picture, from -1 to 1: to the right, and to the top.
    #[inline(always)]
    fn to_ndc(&self, x: f64, y: f64) -> [f64; 2] {
        [self.ndc_per_pixel[0] * x - 1.0, 1.0 - self.ndc_per_pixel[1] * y]
    }

    /// Whether all rays come from one point, through a picture that is flat.
    pub fn is_pinhole(&self) -> bool {
        matches!(self.model, CameraModel::Perspective { lens: None, .. })
    }

    /// Whether [`Self::generate_ray`] heeds the place on the lens.
    pub fn has_lens(&self) -> bool {
        matches!(self.model, CameraModel::Perspective { lens: Some(_), .. })
    }

    /// Where the middle of the lens is, relative to the spheres' origin.
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// The farthest from [`Self::position`] that the origin of a ray can be which passes the picture
    /// at most `margin` pixels outside.
    pub fn max_origin_distance(&self, margin: f64) -> f64 {
        match self.model {
            CameraModel::Perspective { lens, .. } => lens.map_or(0.0, |lens| lens.aperture.radius),
            CameraModel::Orthographic { .. } => self.half_diagonal(margin),
            CameraModel::Panoramic { .. } => 0.0,
        }
    }

    /// A distance from [`Self::position`] beyond which no ray can start which passes the picture at
    /// most `margin` pixels outside; no ray's `t_min` is larger.
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

    /// Whether a ray may start inside a sphere, which passes the picture at most `margin` pixels
    /// outside. Sometimes true where none can, never false where one does.
    pub fn may_start_inside(&self, sphere: &Sphere, margin: f64) -> bool {
        let reach = self.max_start_distance(margin);
        let from = sphere.center - self.position;
        let distance = from.length();
        // All rays start at one depth, or in a panorama at one distance. The rest is for rounding.
        let off = match self.model {
            CameraModel::Panoramic { .. } => distance - self.near,
            _ => from.dot(self.forward) - self.near,
        };
        let radius = sphere.radius + 1e-12 * (distance + reach);
        off.abs() <= radius && distance <= radius + reach
    }

    /// A ray that starts at the depth `near`, in a direction whose part along the view axis is 1.
    #[inline(always)]
    fn spawn_from_lens(&self, origin: DVec3, direction: DVec3) -> PathRay {
        // Along the axis the direction is 1 long.
        let length = direction.length();
        let direction = direction * (1.0 / length);
        PathRay { t_min: self.near * length, ..PathRay::new(origin, direction) }
    }

    /// From the middle of the picture to a corner that lies `margin` pixels outside.
    fn half_diagonal(&self, margin: f64) -> f64 {
        let axis =
            |axis: usize| self.half_extent[axis] * (1.0 + 2.0 * margin / self.resolution[axis]);
        let (across, upwards) = (axis(0), axis(1));
        (across * across + upwards * upwards).sqrt()
    }
}

#[cfg(test)]
mod tests;
