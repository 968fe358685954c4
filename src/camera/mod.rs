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
    half: [f64; 2],
    /// From the middle of the picture to its right edge, and to its top, at distance 1 or in scene units.
    to_right: DVec3,
    to_top: DVec3,
    projection: Projection,
    size: [f64; 2],
    /// Twice the share of the picture that a pixel takes, across and down.
    per_pixel: [f64; 2],
    near: f64,
}

/// Where a camera is and how it is held.
#[derive(Clone, Copy, Debug)]
pub struct Mount {
    /// The middle of the lens, relative to the spheres' origin.
    pub position: DVec3,
    /// The direction of the view axis, any length.
    pub towards: DVec3,
    /// The direction that is up in the picture; not parallel to the axis.
    pub up: DVec3,
    /// Rays start where their depth along the view axis is this; in a panorama, their distance.
    pub near: f64,
    /// Pixels across and down.
    pub size: [u32; 2],
}

/// How directions become places in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Through one point, or through a thin lens around it.
    Perspective {
        /// Angle from the bottom to the top of the picture, in radians, below pi.
        vertical_fov: f64,
        /// `None` is a pinhole.
        lens: Option<Lens>,
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
pub struct Lens {
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
    pub fn new(mount: &Mount, projection: Projection) -> Self {
        let [width, height] = mount.size.map(f64::from);
        let [right, up, forward] = axes(mount.towards, mount.up);
        let square = |half_height: f64| [half_height * width / height, half_height];
        let half = match projection {
            Projection::Perspective { vertical_fov, .. } => square(libm::tan(vertical_fov / 2.0)),
            Projection::Orthographic { height } => square(height / 2.0),
            Projection::Panoramic { horizontal, vertical } => [horizontal / 2.0, vertical / 2.0],
        };
        Self {
            position: mount.position,
            forward,
            right,
            up,
            half,
            to_right: right * half[0],
            to_top: up * half[1],
            projection,
            size: [width, height],
            per_pixel: [2.0 / width, 2.0 / height],
            near: mount.near,
        }
    }

    /// The ray through a place in the picture, in pixels from its upper left corner, and the place on
    /// the lens that two numbers in `[0, 1)` give.
    pub fn ray(&self, x: f64, y: f64, lens: [f64; 2]) -> PathRay {
        let [across, upwards] = self.off_middle(x, y);
        match self.projection {
            Projection::Perspective { lens: None, .. } => self.pinhole_ray(x, y),
            Projection::Perspective { lens: Some(thin), .. } => {
                let direction = self.forward + self.to_right * across + self.to_top * upwards;
                let [lens_x, lens_y] = thin.aperture.sample(lens);
                let offset = self.right * lens_x + self.up * lens_y;
                self.leave_lens(self.position + offset, direction - offset / thin.focus_distance)
            }
            Projection::Orthographic { .. } => {
                let origin = self.position + self.to_right * across + self.to_top * upwards;
                PathRay { t_min: self.near, ..PathRay::free(origin, self.forward) }
            }
            Projection::Panoramic { .. } => {
                let (sin_longitude, cos_longitude) = sin_cos(self.half[0] * across);
                let (sin_latitude, cos_latitude) = sin_cos(self.half[1] * upwards);
                let level = self.forward * cos_longitude + self.right * sin_longitude;
                let direction = level * cos_latitude + self.up * sin_latitude;
                let free = PathRay::free(self.position, direction.normalize());
                PathRay { t_min: self.near, ..free }
            }
        }
    }

    /// [`Self::ray`] of a pinhole camera.
    #[inline(always)]
    pub fn pinhole_ray(&self, x: f64, y: f64) -> PathRay {
        let [across, upwards] = self.off_middle(x, y);
        let direction = self.forward + self.to_right * across + self.to_top * upwards;
        self.leave_lens(self.position, direction)
    }

    /// A place in the picture, from -1 to 1: to the right, and to the top.
    #[inline(always)]
    fn off_middle(&self, x: f64, y: f64) -> [f64; 2] {
        [self.per_pixel[0] * x - 1.0, 1.0 - self.per_pixel[1] * y]
    }

    /// Whether all rays come from one point, through a picture that is flat.
    pub fn is_pinhole(&self) -> bool {
        matches!(self.projection, Projection::Perspective { lens: None, .. })
    }

    /// Whether [`Self::ray`] heeds the place on the lens.
    pub fn has_lens(&self) -> bool {
        matches!(self.projection, Projection::Perspective { lens: Some(_), .. })
    }

    /// Where the middle of the lens is, relative to the spheres' origin.
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// The farthest from [`Self::position`] that the origin of a ray can be which passes the picture
    /// at most `margin` pixels outside.
    pub fn farthest_origin(&self, margin: f64) -> f64 {
        match self.projection {
            Projection::Perspective { lens, .. } => lens.map_or(0.0, |lens| lens.aperture.radius),
            Projection::Orthographic { .. } => self.half_diagonal(margin),
            Projection::Panoramic { .. } => 0.0,
        }
    }

    /// A distance from [`Self::position`] beyond which no ray can start which passes the picture at
    /// most `margin` pixels outside; no ray's `t_min` is larger.
    pub fn farthest_start(&self, margin: f64) -> f64 {
        let origin = self.farthest_origin(margin);
        match self.projection {
            Projection::Perspective { lens, .. } => {
                let tilt = lens.map_or(0.0, |lens| lens.aperture.radius / lens.focus_distance);
                let slope = self.half_diagonal(margin) + tilt;
                origin + self.near * (1.0 + slope * slope).sqrt()
            }
            Projection::Orthographic { .. } => origin + self.near,
            Projection::Panoramic { .. } => self.near,
        }
    }

    /// Whether a ray may start inside a sphere, which passes the picture at most `margin` pixels
    /// outside. Sometimes true where none can, never false where one does.
    pub fn may_start_in(&self, sphere: &Sphere, margin: f64) -> bool {
        let reach = self.farthest_start(margin);
        let from = sphere.center - self.position;
        let distance = from.length();
        // All rays start at one depth, or in a panorama at one distance. The rest is for rounding.
        let off = match self.projection {
            Projection::Panoramic { .. } => distance - self.near,
            _ => from.dot(self.forward) - self.near,
        };
        let radius = sphere.radius + 1e-12 * (distance + reach);
        off.abs() <= radius && distance <= radius + reach
    }

    /// A ray that starts at the depth `near`, in a direction whose part along the view axis is 1.
    #[inline(always)]
    fn leave_lens(&self, origin: DVec3, direction: DVec3) -> PathRay {
        // Along the axis the direction is 1 long.
        let length = direction.length();
        let direction = direction * (1.0 / length);
        PathRay { t_min: self.near * length, ..PathRay::free(origin, direction) }
    }

    /// From the middle of the picture to a corner that lies `margin` pixels outside.
    fn half_diagonal(&self, margin: f64) -> f64 {
        let axis = |axis: usize| self.half[axis] * (1.0 + 2.0 * margin / self.size[axis]);
        let (across, upwards) = (axis(0), axis(1));
        (across * across + upwards * upwards).sqrt()
    }
}

#[cfg(test)]
mod tests;
