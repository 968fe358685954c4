//! View transforms: exposure, tone curve, and rounding to 8 bits.
//!
//! Every curve maps linear Rec. 709 to display values in `[0, 1]`. They are for viewing only;
//! measure on linear image files.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::names::named_enum;

use super::{Rgb, srgb_from_linear, srgb8_from_linear};

/// A transform from linear radiance to display values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ViewTransform {
    /// Exposure in stops: light is multiplied by 2 to this power.
    pub exposure: f32,
    /// The tone curve.
    pub tone: ToneCurve,
    /// True if rounding to 8 bits is dithered, which hides steps in smooth gradients.
    pub dither: bool,
}

/// A tone curve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ToneCurve {
    /// The sRGB curve; values above 1 are clipped to white.
    #[default]
    Srgb,
    /// Hable's curve: a toe, a long shoulder, white at 11.2.
    Filmic,
    /// Sobotka's AgX: bright colours desaturate on the way to white, as on film.
    AgX,
}

/// A linear colour transform, row by row.
type Matrix = [[f32; 3]; 3];

named_enum! { ToneCurve { Srgb = "srgb", Filmic = "filmic", AgX = "agx" } }

/// Lists what differs from the defaults, as in "agx, exposure 1.5, dithered".
impl fmt::Display for ViewTransform {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let usual = Self::default();
        let tone = (self.tone != usual.tone).then(|| self.tone.name().to_owned());
        let exposure =
            (self.exposure != usual.exposure).then(|| format!("exposure {}", self.exposure));
        let dithered = self.dither.then(|| "dithered".to_owned());
        let words: Vec<String> = [tone, exposure, dithered].into_iter().flatten().collect();
        f.write_str(&words.join(", "))
    }
}

impl ViewTransform {
    /// Returns the display value of each channel, in `[0, 1]`; light must be finite.
    pub fn to_display(&self, light: Rgb) -> [f32; 3] {
        let light = self.apply_exposure(light);
        match self.tone {
            ToneCurve::Srgb => light.to_array().map(srgb_from_linear),
            ToneCurve::Filmic => light.to_array().map(|value| srgb_from_linear(filmic(value))),
            ToneCurve::AgX => agx(light),
        }
    }

    fn apply_exposure(&self, light: Rgb) -> Rgb {
        match self.exposure {
            0.0 => light,
            stops => (light * libm::exp2f(stops)).clamp(Rgb::splat(f32::MIN), Rgb::splat(f32::MAX)),
        }
    }

    /// Returns 8-bit display values for the pixel in this column and row of the full picture.
    pub fn to_display_8bit(&self, light: Rgb, column: usize, row: usize) -> [u8; 3] {
        if self.tone == ToneCurve::Srgb && !self.dither {
            return self.apply_exposure(light).to_array().map(srgb8_from_linear);
        }
        let screen = self.to_display(light).map(|value| value * 255.0);
        if self.dither {
            let shift = gradient_noise(column, row);
            screen.map(|value| (value + shift).floor() as u8)
        } else {
            screen.map(|value| value.round() as u8)
        }
    }
}

/// Hable's curve (J. Hable, "Filmic Tonemapping Operators", 2010, and GDC 2010, "Uncharted 2: HDR
/// Lighting"), with his constants: shoulder 0.15, linear 0.5 at angle 0.1, toe 0.2, 0.02 over 0.3,
/// twice the exposure, and linear white 11.2. Linear light to linear light in `[0, 1]`.
fn filmic(value: f32) -> f32 {
    let curve = |x: f32| {
        let (a, b, c, d, e, f) = (0.15, 0.5, 0.1, 0.2, 0.02, 0.3);
        (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f
    };
    // Clamped at white, which also keeps squares finite.
    let white = 11.2;
    curve((2.0 * value.max(0.0)).min(white)) / curve(white)
}

/// AgX (T. Sobotka 2022, the OpenColorIO configuration "AgX"; its numbers as in B. Wrensch,
/// "Minimal AgX Implementation", 2023): mix the channels slightly, take the logarithm from 10 stops
/// below middle grey to 6.5 above, apply a contrast curve, and unmix. Returns display values.
fn agx(light: Rgb) -> [f32; 3] {
    const INSET: Matrix = [
        [0.842_479_06, 0.078_433_6, 0.079_223_745],
        [0.042_328_242, 0.878_468_64, 0.079_166_13],
        [0.042_375_655, 0.078_433_6, 0.879_142_94],
    ];
    const OUTSET: Matrix = [
        [1.196_879, -0.098_020_88, -0.099_029_74],
        [-0.052_896_85, 1.151_903_1, -0.098_961_18],
        [-0.052_971_635, -0.098_043_45, 1.151_073_7],
    ];
    let bent = mul_matrix(&INSET, light.to_array()).map(|value| {
        let stops = libm::log2f(value.max(f32::MIN_POSITIVE) / MIDDLE_GREY);
        agx_contrast(stops.clamp(-STOPS_BELOW, STOPS_ABOVE))
    });
    mul_matrix(&OUTSET, bent).map(|value| value.clamp(0.0, 1.0))
}

const MIDDLE_GREY: f32 = 0.18;
/// Stops below middle grey at which AgX reaches black.
const STOPS_BELOW: f32 = 10.0;
/// Stops above middle grey at which AgX reaches white.
const STOPS_ABOVE: f32 = 6.5;

/// Sobotka's contrast curve over the stops from middle grey, which maps to 0.5: the straight line
/// of slope 2 (over the whole interval), bent by `t / (1 + t^p)^(1/p)` so that it ends at 0 and 1;
/// p is 3 below and 3.25 above.
fn agx_contrast(stops: f32) -> f32 {
    const SLOPE: f32 = 2.0 / (STOPS_BELOW + STOPS_ABOVE);
    let (end, power) = if stops < 0.0 { (STOPS_BELOW, 3.0) } else { (STOPS_ABOVE, 3.25) };
    // In units of the distance from the middle to the end, on both axes.
    let line = |stops: f32| SLOPE * stops / 0.5;
    let bend = libm::powf(line(end), power) - 1.0;
    let t = libm::powf(bend, 1.0 / power) * stops.abs() / end;
    let way = line(stops.abs()) / libm::powf(1.0 + libm::powf(t, power), 1.0 / power);
    0.5 + 0.5 * way.copysign(stops)
}

fn mul_matrix(matrix: &Matrix, [r, g, b]: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| row[0] * r + row[1] * g + row[2] * b)
}

/// Interleaved gradient noise in `[0, 1)` (J. Jimenez, "Next Generation Post Processing in Call of
/// Duty: Advanced Warfare", SIGGRAPH 2014): neighbours differ much, small groups cover the
/// interval.
fn gradient_noise(column: usize, row: usize) -> f32 {
    let slope = 0.067_110_56 * column as f64 + 0.005_837_15 * row as f64;
    let noise = (52.982_918_9 * slope.fract()).fract() as f32;
    // Rounding to f32 may give 1.
    noise.min(1.0 - f32::EPSILON)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    fn grey(tone: ToneCurve, value: f32) -> f32 {
        ViewTransform { tone, ..ViewTransform::default() }.to_display(Rgb::splat(value))[1]
    }

    #[test]
    fn every_curve_rises_from_black_to_white() {
        for &(name, tone) in ToneCurve::NAMES {
            assert_eq!(tone.name(), name);
            assert_abs_diff_eq!(grey(tone, 0.0), 0.0, epsilon = 0.5 / 255.0);
            assert_eq!(grey(tone, -1.0), grey(tone, 0.0), "{name}");
            assert_abs_diff_eq!(grey(tone, f32::MAX), 1.0, epsilon = 1.5 / 255.0);
            let values = (-60..40).map(|step| grey(tone, 2.0f32.powf(step as f32 / 4.0)));
            let values: Vec<f32> = values.collect();
            assert!(values.windows(2).all(|pair| pair[0] <= pair[1] + 1e-5), "{name}: {values:?}");
            assert!(values.iter().all(|value| (0.0..=1.0).contains(value)));
        }
    }

    #[test]
    fn known_points_lie_on_the_curves() {
        // By hand: x = 0.36 gives (0.36 * 0.104 + 0.004) / (0.36 * 0.554 + 0.06) - 1/15 = 0.093062,
        // and x = 11.2 gives 0.725128.
        assert_abs_diff_eq!(filmic(0.18), 0.128_34, epsilon = 2e-5);
        assert_eq!(filmic(5.6), 1.0);
        // Mixing the channels changes grey by less than 2e-4.
        assert_abs_diff_eq!(grey(ToneCurve::AgX, 0.18), 0.5, epsilon = 5e-4);
        // Wrensch's polynomial over the interval of stops, fitted with a mean squared error of
        // 3.7e-6.
        let fitted = [15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.00232];
        for step in 0..=100 {
            let x = step as f32 / 100.0;
            let value = agx_contrast(16.5 * x - 10.0);
            let fitted = fitted.iter().fold(0.0, |sum, coefficient| sum * x + coefficient);
            assert_abs_diff_eq!(value, fitted, epsilon = 7e-3);
        }
        assert_abs_diff_eq!(agx_contrast(-10.0), 0.0, epsilon = 1e-6);
        assert_abs_diff_eq!(agx_contrast(6.5), 1.0, epsilon = 1e-6);
    }

    #[test]
    fn agx_takes_the_colour_from_bright_light_alone() {
        let look = ViewTransform { tone: ToneCurve::AgX, ..ViewTransform::default() };
        let spread = |light: f32| {
            let [r, _, b] = look.to_display(Rgb::new(light, 0.1 * light, 0.1 * light));
            r - b
        };
        assert!(spread(0.5) > 3.0 * spread(50.0));
    }

    #[test]
    fn a_stop_doubles_the_light() {
        let brighter = ViewTransform { exposure: 1.0, ..ViewTransform::default() };
        let light = Rgb::new(0.1, 0.2, 0.3);
        assert_eq!(brighter.to_display(light), ViewTransform::default().to_display(light * 2.0));
        let much = ViewTransform { exposure: 20.0, tone: ToneCurve::AgX, dither: false };
        assert!(much.to_display(Rgb::splat(f32::MAX)).iter().all(|value| value.is_finite()));
    }

    #[test]
    fn dithering_keeps_the_mean_and_stays_within_a_step() {
        let look = ViewTransform { dither: true, ..ViewTransform::default() };
        let light = Rgb::new(0.2, 0.021, 0.7);
        let exact = look.to_display(light).map(|value| f64::from(value) * 255.0);
        let side = 128;
        let mut sums = [0.0; 3];
        for pixel in 0..side * side {
            for (axis, step) in
                look.to_display_8bit(light, pixel % side, pixel / side).into_iter().enumerate()
            {
                assert!((f64::from(step) - exact[axis]).abs() < 1.0);
                sums[axis] += f64::from(step);
            }
        }
        for (sum, exact) in sums.into_iter().zip(exact) {
            // The pattern is more uniform than random numbers, where this would be 5 standard
            // errors.
            assert_abs_diff_eq!(sum / (side * side) as f64, exact, epsilon = 0.02);
        }
        assert_eq!(look.to_display_8bit(Rgb::splat(9.0), 5, 7), [255; 3]);
        assert_eq!(look.to_display_8bit(Rgb::ZERO, 5, 7), [0; 3]);
    }
}
