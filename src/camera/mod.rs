//! From a place in the picture to a ray.

use crate::geometry::PathRay;
use crate::math::DVec3;

/// A pinhole camera.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    position: DVec3,
    /// Unit view axis.
    forward: DVec3,
    /// From the middle of the picture to its right edge, at distance 1 along the axis.
    right: DVec3,
    /// From the middle of the picture to its upper edge, at distance 1 along the axis.
    up: DVec3,
    width: f64,
    height: f64,
    near: f64,
}

/// What a pinhole camera is made from.
#[derive(Clone, Copy, Debug)]
pub struct Pinhole {
    /// Where the pinhole is, relative to the spheres' origin.
    pub position: DVec3,
    /// The direction of the view axis, any length.
    pub towards: DVec3,
    /// The direction that is up in the picture; not parallel to the axis.
    pub up: DVec3,
    /// Angle from the bottom to the top of the picture, in radians.
    pub vertical_fov: f64,
    /// Rays start where their depth along the view axis is this.
    pub near: f64,
    /// Pixels across and down.
    pub size: [u32; 2],
}

impl Camera {
    /// A pinhole camera with square pixels.
    pub fn pinhole(pinhole: &Pinhole) -> Self {
        let [width, height] = pinhole.size.map(f64::from);
        let forward = pinhole.towards.normalize();
        let right = forward.cross(pinhole.up).normalize();
        let up = right.cross(forward);
        let half_height = libm::tan(pinhole.vertical_fov / 2.0);
        Self {
            position: pinhole.position,
            forward,
            right: right * (half_height * width / height),
            up: up * half_height,
            width,
            height,
            near: pinhole.near,
        }
    }

    /// The ray through a place in the picture, in pixels from its upper left corner.
    pub fn ray(&self, x: f64, y: f64) -> PathRay {
        let right = self.right * (2.0 * x / self.width - 1.0);
        let up = self.up * (1.0 - 2.0 * y / self.height);
        let direction = (self.forward + right + up).normalize();
        let t_min = self.near / direction.dot(self.forward);
        PathRay { t_min, ..PathRay::free(self.position, direction) }
    }

    /// Where the pinhole is, relative to the spheres' origin.
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// The farthest from the pinhole that a ray can start which passes the picture at most `margin`
    /// pixels outside.
    pub fn farthest_start(&self, margin: f64) -> f64 {
        let right = self.right * (1.0 + 2.0 * margin / self.width);
        let up = self.up * (1.0 + 2.0 * margin / self.height);
        self.near * (1.0 + right.length_squared() + up.length_squared()).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn camera(near: f64) -> Camera {
        Camera::pinhole(&Pinhole {
            position: DVec3::new(0.0, 0.0, 5.0),
            towards: DVec3::new(0.0, 0.0, -2.0),
            up: DVec3::Y,
            vertical_fov: std::f64::consts::FRAC_PI_2,
            near,
            size: [200, 100],
        })
    }

    #[test]
    fn the_middle_of_the_picture_is_the_view_axis_and_the_corners_are_symmetric() {
        let camera = camera(0.0);
        assert_eq!(camera.ray(100.0, 50.0).direction, -DVec3::Z);
        let corner = camera.ray(200.0, 0.0).direction;
        assert_relative_eq!(corner.x / -corner.z, 2.0, max_relative = 1e-12);
        assert_relative_eq!(corner.y / -corner.z, 1.0, max_relative = 1e-12);
    }

    #[test]
    fn near_is_a_depth_along_the_axis() {
        let camera = camera(2.0);
        for (x, y) in [(100.0, 50.0), (0.0, 0.0), (13.0, 87.0)] {
            let ray = camera.ray(x, y);
            assert_relative_eq!(ray.at(ray.t_min).z, 3.0, max_relative = 1e-12);
            assert!(ray.t_min <= camera.farthest_start(0.0) * (1.0 + 1e-12));
        }
    }
}
