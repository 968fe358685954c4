//! An orthonormal frame around a normal.

use super::DVec3;

/// A right-handed frame whose z axis is a given unit vector; BSDFs are evaluated in it.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// First tangent.
    pub x: DVec3,
    /// Second tangent.
    pub y: DVec3,
    /// The given unit vector.
    pub z: DVec3,
}

impl Frame {
    /// Creates a frame around the unit vector `z`, without a branch on its direction except its
    /// sign.
    ///
    /// Duff et al. 2017, "Building an Orthonormal Basis, Revisited", JCGT 6(1).
    #[inline(always)]
    pub fn from_z(z: DVec3) -> Self {
        let sign = 1.0_f64.copysign(z.z);
        let a = -1.0 / (sign + z.z);
        let b = z.x * z.y * a;
        Self {
            x: DVec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x),
            y: DVec3::new(b, sign + z.y * z.y * a, -z.y),
            z,
        }
    }

    /// Transforms a vector from the frame to the world.
    #[inline(always)]
    pub fn to_world(self, v: DVec3) -> DVec3 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }

    /// Transforms a vector from the world to the frame.
    #[inline(always)]
    pub fn to_local(self, v: DVec3) -> DVec3 {
        DVec3::new(self.x.dot(v), self.y.dot(v), self.z.dot(v))
    }
}

/// Renormalises a vector of unit length up to rounding, such as a rotated unit vector: one step of
/// Newton's method for `1 / |v|`, from 1.
#[inline(always)]
pub fn renormalize(v: DVec3) -> DVec3 {
    v * (1.5 - 0.5 * v.length_squared())
}

/// The unit vector of `v`, for any length; `None` if `v` has no direction.
pub(crate) fn normalize_robust(v: DVec3) -> Option<DVec3> {
    (v / v.abs().max_element()).try_normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        let directions = [DVec3::Z, -DVec3::Z, DVec3::X, DVec3::new(0.3, -0.2, -0.9).normalize()];
        for z in directions {
            let frame = Frame::from_z(z);
            assert_abs_diff_eq!(frame.x.dot(frame.y), 0.0, epsilon = 1e-15);
            assert_abs_diff_eq!(frame.x.length(), 1.0, epsilon = 1e-15);
            assert!((frame.x.cross(frame.y) - z).length() < 1e-15);
            let v = DVec3::new(0.1, 0.2, 0.3);
            assert!((frame.to_local(frame.to_world(v)) - v).length() < 1e-15);
        }
    }
}
