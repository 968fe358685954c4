//! Sampling of directions over the hemisphere around +z, each method next to its pdf.
//!
//! All take `u` in `[0, 1)^2`; the second number becomes the azimuth. Pdfs are per solid angle and
//! are given as functions of `cos`, the direction's z, which must not be negative.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI, TAU};

use crate::fault::fault;
use crate::math::DVec3;
use crate::names::named_enum;

use super::{atan2, powf, safe_acos, sin_cos, sin_cos_2pi};

/// Method for sampling directions over the hemisphere.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hemisphere {
    /// Density `cos / pi`.
    #[default]
    Cosine,
    /// Density `1 / (2 pi)`.
    UniformSolidAngle,
    /// Azimuth and elevation both uniform, as in the paper: density `1 / (pi^2 cos e)` with the
    /// elevation `e` measured from the tangent plane.
    UniformAngle,
}

named_enum! {
    Hemisphere {
        Cosine = "cosine",
        UniformSolidAngle = "uniform-solid-angle",
        UniformAngle = "uniform-angle",
    }
}

impl Hemisphere {
    /// Samples a direction.
    #[inline(always)]
    pub fn sample(self, u: [f64; 2]) -> DVec3 {
        match self {
            Self::Cosine => {
                // Malley's method: the height of a point sampled uniformly on the disc.
                spherical_direction(u[0].sqrt(), (1.0 - u[0]).sqrt(), u[1])
            }
            Self::UniformSolidAngle => spherical_direction(sin_from_cos(u[0]), u[0], u[1]),
            Self::UniformAngle => {
                let (sin_elevation, cos_elevation) = sin_cos(FRAC_PI_2 * u[0]);
                spherical_direction(cos_elevation, sin_elevation, u[1])
            }
        }
    }

    /// Returns the pdf of [`Self::sample`].
    #[inline(always)]
    pub fn pdf(self, cos: f64) -> f64 {
        match self {
            Self::Cosine if fault!(CosinePdfUniform) => 1.0 / TAU,
            Self::Cosine => cos * FRAC_1_PI,
            Self::UniformSolidAngle => 1.0 / TAU,
            Self::UniformAngle if fault!(AngleJacobianMissing) => 1.0 / (PI * PI),
            // The elevation's cosine is the sine of the angle from the normal.
            Self::UniformAngle => 1.0 / (PI * PI * sin_from_cos(cos)),
        }
    }

    /// Returns the `u` that maps to a direction.
    pub fn invert(self, direction: DVec3) -> [f64; 2] {
        let u = match self {
            Self::Cosine => 1.0 - direction.z * direction.z,
            Self::UniformSolidAngle => direction.z,
            Self::UniformAngle => 1.0 - safe_acos(direction.z) / FRAC_PI_2,
        };
        [u, azimuth(direction)]
    }
}

/// Samples a direction uniformly over the cone (spherical cap) around +z with the given `1 -
/// cos_max`, up to the whole sphere. The pdf is `1 / (2 pi (1 - cos))`.
pub fn sample_uniform_cone(one_minus_cos_max: f64, u: [f64; 2]) -> DVec3 {
    let one_minus_cos = u[0] * one_minus_cos_max;
    let sin = (one_minus_cos * (2.0 - one_minus_cos)).max(0.0).sqrt();
    spherical_direction(sin, 1.0 - one_minus_cos, u[1])
}

/// Samples a direction with density `(n + 1) / (2 pi) cos^n`, the lobe of the Phong model.
pub fn sample_power_cosine(exponent: f64, u: [f64; 2]) -> DVec3 {
    let cos = powf(u[0], 1.0 / (exponent + 1.0));
    spherical_direction(sin_from_cos(cos), cos, u[1])
}

/// Returns the pdf of [`sample_power_cosine`].
pub fn power_cosine_pdf(exponent: f64, cos: f64) -> f64 {
    let one = if fault!(PowerCosineNorm) { 2.0 } else { 1.0 };
    (exponent + one) / TAU * powf(cos, exponent)
}

/// Returns the `u` that [`sample_power_cosine`] maps to a direction.
pub fn invert_power_cosine(exponent: f64, direction: DVec3) -> [f64; 2] {
    [powf(direction.z, exponent + 1.0), azimuth(direction)]
}

#[inline(always)]
fn spherical_direction(sin: f64, cos: f64, u: f64) -> DVec3 {
    let (sin_phi, cos_phi) = sin_cos_2pi(u);
    DVec3::new(sin * cos_phi, sin * sin_phi, cos)
}

fn azimuth(direction: DVec3) -> f64 {
    let turns = atan2(direction.y, direction.x) / TAU;
    if turns < 0.0 { turns + 1.0 } else { turns }
}

fn sin_from_cos(cos: f64) -> f64 {
    ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverting_a_sample_gives_its_numbers_back() {
        for hemisphere in
            [Hemisphere::Cosine, Hemisphere::UniformSolidAngle, Hemisphere::UniformAngle]
        {
            for i in 1..50 {
                let u = [f64::from(i) / 50.0, f64::from(i * 7 % 50) / 50.0];
                let back = hemisphere.invert(hemisphere.sample(u));
                assert!((back[0] - u[0]).abs() < 1e-12 && (back[1] - u[1]).abs() < 1e-12);
                let lobe = invert_power_cosine(20.0, sample_power_cosine(20.0, u));
                assert!((lobe[0] - u[0]).abs() < 1e-12 && (lobe[1] - u[1]).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn an_azimuth_is_never_a_whole_turn() {
        for (x, y, turns) in
            [(1.0, 0.0, 0.0), (0.0, 1.0, 0.25), (-1.0, 0.0, 0.5), (0.0, -1.0, 0.75)]
        {
            assert_eq!(Hemisphere::Cosine.invert(DVec3::new(x, y, 0.0))[1], turns);
        }
    }

    #[test]
    fn points_of_a_cap_lie_at_their_share_of_its_height() {
        // From a tiny cap to the whole sphere.
        for rim in [1e-12, 0.3, 1.0, 2.0] {
            for i in 0..50 {
                let u = [f64::from(i) / 50.0, f64::from(i * 7 % 50) / 50.0];
                let direction = sample_uniform_cone(rim, u);
                assert!((direction.length() - 1.0).abs() < 1e-15);
                let chord_squared = direction.distance_squared(DVec3::Z);
                let expected = 2.0 * u[0] * rim;
                assert!((chord_squared - expected).abs() <= 1e-14 * expected.max(1e-3 * rim));
                if i > 0 && rim < 2.0 {
                    let turns = Hemisphere::Cosine.invert(direction)[1];
                    assert!((turns - u[1]).abs() < 1e-12, "{turns} {}", u[1]);
                }
            }
        }
    }
}
