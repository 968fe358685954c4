//! Irradiance from a spherical emitter, excluding the part below the horizon.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::geometry::Sphere;
use crate::math::DVec3;

/// A spherical emitter as seen from a point: the cosine between the surface normal and the
/// direction to the emitter's centre, and the sine of its angular radius.
#[derive(Clone, Copy, Debug)]
pub(super) struct SubtendedCap {
    pub(super) direction: DVec3,
    pub(super) cos: f64,
    pub(super) sin_radius: f64,
}

impl SubtendedCap {
    /// Cap subtended by a sphere that does not contain the point.
    pub(super) fn new(emitter: &Sphere, point: DVec3, normal: DVec3) -> Self {
        let to_emitter = emitter.center - point;
        let distance = to_emitter.length();
        let direction = to_emitter / distance;
        Self { direction, cos: direction.dot(normal), sin_radius: emitter.radius / distance }
    }

    /// Angular radius in radians.
    pub(super) fn radius(&self) -> f64 {
        libm::asin(self.sin_radius)
    }

    /// The integral of the cosine over the directions above the surface that hit the disc: the
    /// irradiance per unit of radiance, `pi` times the form factor. Entirely above the horizon it
    /// is `pi sin^2(radius) cos`. Cut by the horizon it is the formula of Snyder 1996 (equation 15;
    /// as in Lagarde and de Rousiers 2014, listing 7), for `cos` and `sin` of the inclination:
    ///
    /// ```text
    /// sin^2(radius) (cos acos(y) - x sin sqrt(1 - y^2)) + atan(sin sqrt(1 - y^2) / x)
    /// x = cot(radius),  y = -x cot(inclination)
    /// ```
    pub(super) fn irradiance(&self) -> f64 {
        let squared = self.sin_radius * self.sin_radius;
        let sin = (1.0 - self.cos * self.cos).max(0.0).sqrt();
        if self.cos.abs() >= self.sin_radius {
            return PI * squared * self.cos.max(0.0);
        }
        let x = (1.0 / squared - 1.0).sqrt();
        let y = -x * self.cos / sin;
        let root = sin * (1.0 - y * y).max(0.0).sqrt();
        squared * (self.cos * libm::acos(y) - x * root) + libm::atan(root / x)
    }

    /// The irradiance with another disc in front. `None` if the edges of the two cross, or if the
    /// horizon cuts the one in front.
    pub(super) fn irradiance_occluded_by(&self, front: &Self) -> Option<f64> {
        let separation = libm::acos(self.direction.dot(front.direction).clamp(-1.0, 1.0));
        let (far, near) = (self.radius(), front.radius());
        if separation >= far + near {
            return Some(self.irradiance());
        }
        let is_above_horizon = libm::acos(front.cos.clamp(-1.0, 1.0)) + near <= FRAC_PI_2;
        (separation + near <= far && is_above_horizon)
            .then(|| self.irradiance() - front.irradiance())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::quadrature::integral;
    use approx::assert_relative_eq;

    /// Irradiance by quadrature over the disc: rings around its centre, with the arc above the
    /// horizon of each in closed form.
    fn by_quadrature(disc: &SubtendedCap, nodes: usize) -> f64 {
        let (cos, sin) = (disc.cos, (1.0 - disc.cos * disc.cos).sqrt());
        let ring = |t: f64| {
            // On the ring of angle t the cosine to the normal is cos cos t + sin sin t cos(phi).
            let (a, b) = (cos * t.cos(), sin * t.sin());
            let half = (-a / b).clamp(-1.0, 1.0).acos();
            2.0 * (a * half + b * half.sin()) * t.sin()
        };
        // Kinks lie where a ring touches the horizon.
        let kink = (FRAC_PI_2 - disc.cos.acos()).abs().min(disc.radius());
        integral(0.0, kink, nodes, ring) + integral(kink, disc.radius(), nodes, ring)
    }

    #[test]
    fn the_formula_is_the_integral_at_every_height_above_and_below_the_horizon() {
        for sin_radius in [0.01, 0.3, 0.9] {
            for i in -20..=20 {
                let inclination = FRAC_PI_2 + 1.1 * f64::from(i) / 20.0 * f64::asin(sin_radius);
                let cos = inclination.cos();
                let disc = SubtendedCap { direction: DVec3::Z, cos, sin_radius };
                let [coarse, fine] = [200, 400].map(|nodes| by_quadrature(&disc, nodes));
                let scale = PI * sin_radius * sin_radius;
                assert!((coarse - fine).abs() < 1e-6 * scale, "{coarse} {fine}");
                assert!((disc.irradiance() - fine).abs() < 1e-6 * scale, "{disc:?} {fine}");
            }
        }
    }

    #[test]
    fn a_disc_in_front_takes_its_own_share_away() {
        let disc = |x: f64, sin_radius: f64| {
            let direction = DVec3::new(x, 0.0, (1.0 - x * x).sqrt());
            SubtendedCap { direction, cos: direction.z, sin_radius }
        };
        let emitter = disc(0.0, 0.5);
        assert_relative_eq!(
            emitter.irradiance_occluded_by(&disc(0.1, 0.2)).unwrap(),
            PI * (0.25 - 0.04 * 0.99f64.sqrt()),
            max_relative = 1e-12
        );
        assert_eq!(emitter.irradiance_occluded_by(&disc(0.4, 0.2)), None);
        assert_eq!(emitter.irradiance_occluded_by(&disc(0.8, 0.2)), Some(emitter.irradiance()));
    }
}
