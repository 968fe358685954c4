//! A smooth interface between two transparent media, such as glass and air.

use crate::color::Rgb;
use crate::fault::fault;
use crate::math::DVec3;

use super::mirror::reflected;
use super::{BsdfSample, Lobe};

/// Smooth glass.
#[derive(Clone, Copy, Debug)]
pub struct Dielectric {
    /// Index of refraction relative to vacuum.
    pub ior: f64,
    /// Where dielectric spheres overlap, the higher priority fills the common part.
    pub priority: i32,
}

/// What a smooth interface does with unpolarised light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fresnel {
    /// The share that is reflected.
    pub reflectance: f64,
    /// Cosine of the refracted direction; 0 where all is reflected.
    pub cos_transmitted: f64,
}

/// The Fresnel equations for light arriving at the cosine `cos >= 0`, where `eta` is the index of
/// refraction beyond the interface over the index on this side (Born and Wolf, section 1.5.2).
pub fn fresnel(cos: f64, eta: f64) -> Fresnel {
    let sin_squared = (1.0 - cos) * (1.0 + cos) / (eta * eta);
    if sin_squared >= 1.0 {
        return Fresnel { reflectance: 1.0, cos_transmitted: 0.0 };
    }
    let cos_transmitted = (1.0 - sin_squared).sqrt();
    let parallel = (eta * cos - cos_transmitted) / (eta * cos + cos_transmitted);
    let perpendicular = (cos - eta * cos_transmitted) / (cos + eta * cos_transmitted);
    let perpendicular = if fault!(OnePolarization) { parallel } else { perpendicular };
    let reflectance = (parallel * parallel + perpendicular * perpendicular) / 2.0;
    Fresnel { reflectance, cos_transmitted }
}

impl Dielectric {
    /// Reflects with the Fresnel probability and refracts otherwise, so that the weight is 1 but
    /// for the change of radiance between media: radiance over the squared index is what an
    /// interface conserves (Veach 1997, section 5.2), so going from here to beyond, a path that
    /// carries importance from the camera is divided by `eta^2`.
    pub(super) fn sample(&self, eta: f64, wo: DVec3, lobe: f64) -> BsdfSample {
        let Fresnel { reflectance, cos_transmitted } = fresnel(wo.z.min(1.0), eta);
        if lobe < reflectance {
            let wi = reflected(wo);
            return BsdfSample {
                wi,
                weight: Rgb::ONE,
                pdf: reflectance,
                lobe: Lobe::Delta,
                eta: 1.0,
            };
        }
        let squared = if fault!(EtaSquaredDropped) { 1.0 } else { eta * eta };
        BsdfSample {
            wi: DVec3::new(-wo.x / eta, -wo.y / eta, -cos_transmitted).normalize(),
            weight: Rgb::splat((1.0 / squared) as f32),
            pdf: 1.0 - reflectance,
            lobe: Lobe::Delta,
            eta,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn fresnel_at_its_known_points() {
        assert_relative_eq!(fresnel(1.0, 1.5).reflectance, 0.04, max_relative = 1e-12);
        assert_relative_eq!(fresnel(1.0, 1.0 / 1.5).reflectance, 0.04, max_relative = 1e-12);
        assert!(fresnel(0.3, 1.0).reflectance < 1e-30, "no interface, no reflection");
        assert_relative_eq!(fresnel(0.0, 1.5).reflectance, 1.0, max_relative = 1e-12);
        // Beyond the critical angle, asin(1 / 1.5) = 41.8 degrees, all is reflected.
        assert_eq!(fresnel(0.7, 1.0 / 1.5).reflectance, 1.0);
        assert!(fresnel(0.75, 1.0 / 1.5).reflectance < 1.0);
    }

    #[test]
    fn at_brewsters_angle_only_one_polarisation_is_reflected() {
        let eta: f64 = 1.5;
        let cos = 1.0 / (1.0 + eta * eta).sqrt();
        let expected = ((1.0 - eta * eta) / (1.0 + eta * eta)).powi(2) / 2.0;
        assert_relative_eq!(fresnel(cos, eta).reflectance, expected, max_relative = 1e-12);
    }

    #[test]
    fn refraction_obeys_snells_law_both_ways() {
        let glass = Dielectric { ior: 1.5, priority: 0 };
        let wo = DVec3::new(0.6, 0.0, 0.8);
        let into = glass.sample(1.5, wo, 0.999).wi;
        assert_relative_eq!(into.x, -0.4, max_relative = 1e-12);
        let back = glass.sample(1.0 / 1.5, DVec3::new(into.x, into.y, -into.z), 0.999).wi;
        assert_relative_eq!(back.x, 0.6, max_relative = 1e-12);
    }
}
