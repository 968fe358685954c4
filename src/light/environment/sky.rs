//! A clear sky, after Preetham, Shirley and Smits 1999, "A Practical Analytic Model for Daylight".
//!
//! Luminance and chromaticity over the upper hemisphere are functions of the sun's elevation and of
//! the air's turbidity: 2 is very clear, 3 clear, 6 warm and moist, 10 hazy. Coefficients and
//! formulas are those of the paper's appendix A.2. Below the horizon is diffuse ground, uniformly
//! lit by sky and sun.
//!
//! The model is tabulated once: a row every 0.7 degrees of elevation, and columns at the same
//! spacing.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI, TAU};

use crate::color::Rgb;
use crate::math::DVec3;
use crate::sampling::{exp, safe_acos, sin_cos, tan};

use super::EnvironmentMap;

const COLUMNS: usize = 512;
/// Rows from the zenith to the horizon, both included.
const ROWS: usize = 129;
/// cd/m^2 per 1 W/(sr m^2) in every channel: Radiance's luminous efficacy of white light, in lm/W
/// (Ward 1994, "The RADIANCE Lighting Simulation and Rendering System").
const LUMINOUS_EFFICACY: f64 = 179.0;

/// Parameters of the sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// The air's turbidity, from 2 to 10.
    pub turbidity: f64,
    /// Unit direction to the sun, y up; above the horizon.
    pub sun: DVec3,
    /// The sun's irradiance on a surface facing it; affects the ground only.
    pub sun_irradiance: Rgb,
    /// The ground's albedo.
    pub ground: Rgb,
    /// Scale factor on the sky's radiance.
    pub scale: f64,
}

impl Sky {
    /// Tabulates the sky and the ground as an environment map.
    pub fn environment_map(&self) -> EnvironmentMap {
        let model = Perez::new(self.turbidity, safe_acos(self.sun.y));
        let mut heights = Vec::new();
        let mut radiance = Vec::new();
        for row in 0..ROWS {
            let (sin, cos) = sin_cos(row as f64 / (ROWS - 1) as f64 * FRAC_PI_2);
            let height = if row == ROWS - 1 { 0.0 } else { cos };
            heights.push(height);
            for column in 0..COLUMNS {
                let (left, back) = sin_cos((column as f64 + 0.5) / COLUMNS as f64 * TAU);
                let direction = DVec3::new(-sin * left, height, sin * back);
                let color = model.radiance(height, safe_acos(direction.dot(self.sun)));
                radiance.push((color * self.scale).as_vec3());
            }
        }
        let ground_irradiance =
            irradiance(&heights, &radiance) + self.sun_irradiance.as_dvec3() * self.sun.y.max(0.0);
        let ground = self.ground.as_dvec3() * ground_irradiance * FRAC_1_PI;
        heights.extend([0.0, -1.0]);
        radiance.extend(vec![ground.as_vec3(); 2 * COLUMNS]);
        EnvironmentMap::from_rows(COLUMNS, heights, radiance)
    }
}

/// Irradiance on level ground: radiance times height, integrated over the hemisphere. Between two
/// rows radiance is linear in the height, so the integrand is a parabola.
fn irradiance(heights: &[f64], radiance: &[Rgb]) -> DVec3 {
    let mean =
        |row: &[Rgb]| row.iter().map(|color| color.as_dvec3()).sum::<DVec3>() / row.len() as f64;
    let rows: Vec<DVec3> = radiance.chunks(COLUMNS).map(mean).collect();
    let band = |i: usize| {
        let (top, d) = (heights[i], heights[i] - heights[i + 1]);
        TAU * d * (rows[i] * (top / 2.0 - d / 6.0) + rows[i + 1] * (top / 2.0 - d / 3.0))
    };
    (0..heights.len() - 1).map(band).sum()
}

/// The formula of Perez et al. 1993 with Preetham's coefficients, for luminance Y and the
/// chromaticities x and y.
struct Perez {
    coefficients: [[f64; 5]; 3],
    /// Zenith values divided by the formula's value there.
    scales: [f64; 3],
}

impl Perez {
    fn new(turbidity: f64, sun_angle: f64) -> Self {
        let t = turbidity;
        let coefficients = [
            [
                0.1787 * t - 1.4630,
                -0.3554 * t + 0.4275,
                -0.0227 * t + 5.3251,
                0.1206 * t - 2.5771,
                -0.0670 * t + 0.3703,
            ],
            [
                -0.0193 * t - 0.2592,
                -0.0665 * t + 0.0008,
                -0.0004 * t + 0.2125,
                -0.0641 * t - 0.8989,
                -0.0033 * t + 0.0452,
            ],
            [
                -0.0167 * t - 0.2608,
                -0.0950 * t + 0.0092,
                -0.0079 * t + 0.2102,
                -0.0441 * t - 1.6537,
                -0.0109 * t + 0.0529,
            ],
        ];
        let zenith = zenith(t, sun_angle);
        let scale = |i: usize| zenith[i] / perez(&coefficients[i], 1.0, sun_angle);
        Self { coefficients, scales: [0, 1, 2].map(scale) }
    }

    /// Returns linear Rec. 709 radiance in W/(sr m^2), at a height and an angle from the sun.
    fn radiance(&self, height: f64, sun_angle: f64) -> DVec3 {
        let [luminance, x, y] =
            [0, 1, 2].map(|i| self.scales[i] * perez(&self.coefficients[i], height, sun_angle));
        let [x_, y_, z_] =
            [x / y, 1.0, (1.0 - x - y) / y].map(|v| v * luminance / LUMINOUS_EFFICACY);
        // XYZ to linear Rec. 709, IEC 61966-2-1.
        let color = DVec3::new(
            3.240_454_2 * x_ - 1.537_138_5 * y_ - 0.498_531_4 * z_,
            -0.969_266_0 * x_ + 1.876_010_8 * y_ + 0.041_556_0 * z_,
            0.055_643_4 * x_ - 0.204_025_9 * y_ + 1.057_225_2 * z_,
        );
        color.max(DVec3::ZERO)
    }
}

/// `(1 + A e^(B / cos)) (1 + C e^(D g) + E cos^2 g)`: equation 3 of Preetham et al.
fn perez(&[a, b, c, d, e]: &[f64; 5], height: f64, sun_angle: f64) -> f64 {
    let (_, cos) = sin_cos(sun_angle);
    (1.0 + a * exp(b / height)) * (1.0 + c * exp(d * sun_angle) + e * cos * cos)
}

/// Zenith luminance in cd/m^2, and chromaticities.
fn zenith(t: f64, sun: f64) -> [f64; 3] {
    let chi = (4.0 / 9.0 - t / 120.0) * (PI - 2.0 * sun);
    let luminance = (4.0453 * t - 4.9710) * tan(chi) - 0.2155 * t + 2.4192;
    let polynomial = |rows: [[f64; 4]; 3]| {
        let row = |[c3, c2, c1, c0]: [f64; 4]| ((c3 * sun + c2) * sun + c1) * sun + c0;
        let [c2, c1, c0] = rows.map(row);
        (c2 * t + c1) * t + c0
    };
    let x = polynomial([
        [0.00166, -0.00375, 0.00209, 0.0],
        [-0.02903, 0.06377, -0.03202, 0.00394],
        [0.11693, -0.21196, 0.06052, 0.25886],
    ]);
    let y = polynomial([
        [0.00275, -0.00610, 0.00317, 0.0],
        [-0.04214, 0.08970, -0.04153, 0.00516],
        [0.15346, -0.26756, 0.06670, 0.26688],
    ]);
    [1000.0 * luminance.max(0.0), x, y]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sky(turbidity: f64, elevation: f64) -> Sky {
        let (sin, cos) = sin_cos(elevation.to_radians());
        let sun = DVec3::new(0.0, sin, -cos);
        Sky { turbidity, sun, sun_irradiance: Rgb::ZERO, ground: Rgb::ZERO, scale: 1.0 }
    }

    #[test]
    fn the_zenith_has_the_value_that_the_paper_gives_it() {
        // T = 3 and the sun at 45 degrees, computed by hand: chi = (4/9 - 1/40) pi/2, Y = 7.1649 x
        // 0.77423 + 1.7727 = 7.3200 kcd/m^2.
        let [luminance, x, y] = zenith(3.0, PI / 4.0);
        assert!((luminance - 7320.0).abs() < 1.0, "{luminance}");
        assert!((0.24..0.28).contains(&x) && (0.24..0.28).contains(&y), "{x} {y}");
        let zenith = sky(3.0, 45.0).environment_map().radiance(DVec3::Y);
        assert!(
            (f64::from(crate::color::luminance(zenith)) * LUMINOUS_EFFICACY / luminance - 1.0)
                .abs()
                < 0.01
        );
    }

    #[test]
    fn skies_are_positive_blue_and_brightest_at_the_sun() {
        for (turbidity, elevation) in [(2.0, 5.0), (3.0, 40.0), (6.0, 20.0), (10.0, 80.0)] {
            let sky = sky(turbidity, elevation);
            let map = sky.environment_map();
            let at_sun = crate::color::luminance(map.radiance(sky.sun));
            for i in 0..200 {
                let (sin, cos) = sin_cos(f64::from(i) * 2.4);
                let height = f64::from(i) / 200.0;
                let horizontal = (1.0 - height * height).sqrt();
                let color = map.radiance(DVec3::new(horizontal * sin, height, horizontal * cos));
                assert!(color.is_finite() && color.min_element() >= 0.0);
                assert!(crate::color::luminance(color) <= at_sun * 1.05);
            }
        }
        let opposite = sky(2.5, 30.0).environment_map().radiance(DVec3::new(0.0, 0.6, 0.8));
        assert!(opposite.z > 1.3 * opposite.x, "{opposite}");
    }

    #[test]
    fn ground_is_lit_by_all_of_the_sky_and_the_sun() {
        // A sky of constant radiance gives pi times that irradiance.
        let heights = [1.0, 0.7, 0.2, 0.0];
        let uniform = irradiance(&heights, &vec![Rgb::ONE; 4 * COLUMNS]);
        assert!((uniform - PI).length() < 1e-12);
        let sky = Sky {
            sun_irradiance: Rgb::splat(10.0),
            ground: Rgb::ONE,
            scale: 0.0,
            ..sky(3.0, 30.0)
        };
        let ground = sky.environment_map().radiance(-DVec3::Y);
        assert!((f64::from(ground.x) - 10.0 * 0.5 / PI).abs() < 1e-6);
    }
}
