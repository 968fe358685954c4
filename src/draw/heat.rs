//! Colors of heat maps.
//!
//! Lightness increases uniformly, so the map also reads correctly in greyscale. Hue runs from
//! violet through red to yellow: a path through OKLab (B. Ottosson, "A perceptual color space for
//! image processing", 2020).

use crate::color::Rgb;
use crate::math::DVec3;
use crate::sampling::sin_cos;

/// The linear color of a value in [0, 1].
pub fn heat_color(share: f64) -> Rgb {
    // Hue in radians, from blue-violet through red to yellow; low chroma at both ends.
    let hue = -1.2 + 3.1 * share;
    let chroma = 0.62 * share * (1.0 - share);
    let (sin, cos) = sin_cos(hue);
    let lightness = 0.97 * share;
    linear_of_oklab(DVec3::new(lightness, chroma * cos, chroma * sin))
}

/// Converts OKLab to linear Rec. 709, clipped to the displayable range.
fn linear_of_oklab(lab: DVec3) -> Rgb {
    let cone = |a: f64, b: f64| (lab.x + a * lab.y + b * lab.z).powi(3);
    let l = cone(0.396_337_777_4, 0.215_803_757_3);
    let m = cone(-0.105_561_345_8, -0.063_854_172_8);
    let s = cone(-0.089_484_177_5, -1.291_485_548_0);
    DVec3::new(
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    )
    .clamp(DVec3::ZERO, DVec3::ONE)
    .as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::luminance;

    #[test]
    fn lightness_rises_evenly_from_black() {
        assert_eq!(heat_color(0.0), Rgb::ZERO);
        // The cube root of luminance approximates lightness; each of 100 steps adds a similar
        // amount.
        let light: Vec<f32> =
            (0..=100).map(|i| libm::cbrtf(luminance(heat_color(f64::from(i) / 100.0)))).collect();
        let steps: Vec<f32> = light.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(steps.iter().all(|step| (0.003..0.02).contains(step)), "{steps:?}");
        assert!(light[100] > 0.93);
    }
}
