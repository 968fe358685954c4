//! Colours: linear Rec. 709 radiance and reflectance, and display transforms.

mod difference;
mod view_transform;
mod visible_surface;

use std::sync::LazyLock;

pub use difference::ciede2000;
pub use view_transform::{ToneCurve, ViewTransform};
pub use visible_surface::{NO_ROW, VisibleSurface};

/// Red, green, blue in linear Rec. 709. Radiance is in W/(sr m^2) per channel.
pub type Rgb = glam::Vec3;

/// The contribution of one sample to its pixel.
#[derive(Clone, Copy, Debug, Default)]
pub struct PathRadiance {
    /// Emission and environment seen by the camera, and light scattered once on its way from an
    /// emitter to the camera. Mirrors and glass in between do not count as scattering.
    pub direct: Rgb,
    /// All other light.
    pub indirect: Rgb,
    /// 0 if the camera ray missed and saw the environment, else 1.
    pub alpha: f32,
}

/// Returns the luminance of a linear Rec. 709 colour (ITU-R BT.709-6, item 3.2).
pub fn luminance(color: Rgb) -> f32 {
    color.dot(Rgb::new(0.2126, 0.7152, 0.0722))
}

/// Applies the sRGB transfer curve to one channel, clamped to `[0, 1]` (IEC 61966-2-1).
pub fn srgb_from_linear(linear: f32) -> f32 {
    let x = linear.clamp(0.0, 1.0);
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * libm::powf(x, 1.0 / 2.4) - 0.055 }
}

/// Applies the sRGB transfer curve and rounds to 8 bits, without computing a power for each value.
pub fn srgb8_from_linear(linear: f32) -> u8 {
    SRGB8_THRESHOLDS.partition_point(|from| *from <= linear) as u8
}

/// The smallest linear value that rounds to each 8-bit value except 0: computed once, to the last
/// bit.
static SRGB8_THRESHOLDS: LazyLock<[f32; 255]> = LazyLock::new(|| {
    std::array::from_fn(|step| {
        let is_there =
            |bits: u32| (srgb_from_linear(f32::from_bits(bits)) * 255.0).round() > step as f32;
        // Non-negative floats have the order of their bits.
        let (mut below, mut there) = (0, 1.0f32.to_bits());
        while there - below > 1 {
            let middle = below + (there - below) / 2;
            if is_there(middle) { there = middle } else { below = middle }
        }
        f32::from_bits(there)
    })
});

/// Inverts [`srgb_from_linear`] for one channel in `[0, 1]`.
pub fn linear_from_srgb(value: f32) -> f32 {
    if value <= 0.040_45 { value / 12.92 } else { libm::powf((value + 0.055) / 1.055, 2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn the_srgb_curve_passes_through_its_known_points() {
        assert_eq!(srgb_from_linear(-1.0), 0.0);
        assert_abs_diff_eq!(srgb_from_linear(2.0), 1.0, epsilon = 1e-6);
        assert_abs_diff_eq!(srgb_from_linear(0.214_041_14), 0.5, epsilon = 1e-5);
    }

    #[test]
    fn steps_are_those_of_the_curve() {
        let by_curve = |light: f32| (srgb_from_linear(light) * 255.0).round() as u8;
        // Every 997th float from 0 to beyond 1, and around each threshold.
        let all = (0..1.5f32.to_bits()).step_by(997);
        let edges =
            SRGB8_THRESHOLDS.iter().flat_map(|edge| edge.to_bits() - 1..=edge.to_bits() + 1);
        for light in all.chain(edges).map(f32::from_bits) {
            assert_eq!(srgb8_from_linear(light), by_curve(light), "{light:e}");
        }
        assert_eq!([-1.0, -0.0, f32::MIN, f32::MAX].map(srgb8_from_linear), [0, 0, 0, 255]);
    }

    #[test]
    fn the_srgb_curve_is_undone() {
        for step in 0..=255u8 {
            let value = f32::from(step) / 255.0;
            assert_abs_diff_eq!(srgb_from_linear(linear_from_srgb(value)), value, epsilon = 1e-6);
        }
    }
}
