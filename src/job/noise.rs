//! Error statistics that decide when a tile of the picture has converged.
//!
//! All statistics are here, from the estimate of each value (one channel of a pixel) to the
//! decision. `docs/stopping.md` derives them and shows measurements.
//!
//! The mean of a value over `k` blocks of 16 samples has the variance `v` estimated from the
//! blocks, with `k - 1` degrees of freedom. If light arrives by rare bright paths, a pixel that has
//! not sampled one yet looks quiet, but its neighbours reveal the variance. A sixteenth of the
//! tile's mean variance `V` is therefore mixed in: `w = 15/16 v + 1/16 V`. The degrees of freedom
//! follow (Welch 1947, Satterthwaite 1946; `V` is treated as exact): `f = (k - 1) (w / (15/16
//! v))^2`. The true value lies within `t_f sqrt(w)` of the mean with the requested confidence.
//!
//! A tile of 256 pixels decides as a whole. If pixels stopped individually, those that happened to
//! look quiet or bright would stop too early, and the picture would be biased; over a tile such
//! errors cancel.

use std::fmt;

use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, Normal};

use crate::color::ViewTransform;
use crate::error::{Error, Result};
use crate::film::PixelEstimate;

use super::display_scale::DisplayScale;

/// Weight of the tile's mean variance in the variance of each value.
const SHARED_VARIANCE_WEIGHT: f64 = 1.0 / 16.0;

/// Minimum brightness used for relative errors, as a fraction of the tile's mean brightness. Darker
/// pixels need no higher absolute accuracy.
const MIN_RELATIVE_BRIGHTNESS: f64 = 0.1;

/// A noise target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NoiseTarget {
    /// The largest error of a value, relative to its pixel's brightness; or with `display`, that of
    /// the displayed value, of which white is 1. In (0, 1).
    pub error: f64,
    /// The fraction of values that must have a smaller error than that; in (0, 1).
    pub confidence: f64,
    /// How the picture is looked at, if errors are those of displayed values.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub display: Option<ViewTransform>,
}

impl NoiseTarget {
    /// The default fraction of values.
    pub const CONFIDENCE: f64 = 0.95;

    /// A relative error, such as 0.01, for 95 % of the values.
    pub fn new(error: f64) -> Self {
        Self { error, confidence: Self::CONFIDENCE, display: None }
    }

    /// The scale of errors in displayed values, if they are those.
    pub(super) fn display_scale(&self) -> Option<DisplayScale> {
        self.display.map(|view| DisplayScale::new(view, self.error))
    }

    /// An error in the unit of the target: `1.23 %`, or `3.1 of 255` of displayed values.
    pub fn format_error(&self, error: f64) -> String {
        match self.display {
            None => format_percent(error),
            Some(_) => format!("{:.1} of 255", 255.0 * error),
        }
    }

    /// Checks that both numbers are in (0, 1).
    ///
    /// # Errors
    /// States the two numbers.
    pub(super) fn validate(self) -> Result<()> {
        let Self { error, confidence, display: _ } = self;
        let is_fraction = |x: f64| x > 0.0 && x < 1.0;
        if is_fraction(error) && is_fraction(confidence) {
            return Ok(());
        }
        Err(Error::input(format!(
            "the noise target of {error} for {confidence} of the values is not in (0, 1)"
        )))
    }
}

/// Formats a fraction as a percentage with three digits: `1.23 %`.
fn format_percent(fraction: f64) -> String {
    let decimals = match 100.0 * fraction {
        x if x < 9.995 => 2,
        x if x < 99.95 => 1,
        _ => 0,
    };
    format!("{:.decimals$} %", 100.0 * fraction)
}

/// As in "0.01 for 0.95 of the values", and "2 of 255 shown for 0.95 of the values".
impl fmt::Display for NoiseTarget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.display {
            None => write!(f, "{} for {} of the values", self.error, self.confidence),
            Some(view) => {
                let view = view.to_string();
                let through = if view.is_empty() { String::new() } else { format!(" ({view})") };
                let steps = 255.0 * self.error;
                write!(f, "{steps:.3} of 255 shown{through} for {} of the values", self.confidence)
            }
        }
    }
}

/// Standard error of a mean.
#[derive(Clone, Copy, Debug, PartialEq)]
struct StandardError {
    /// Standard deviation of the mean.
    std_dev: f64,
    /// Degrees of freedom of that estimate.
    degrees_of_freedom: f64,
}

/// The weighted mean variance of a tile, per channel, which all of its values share.
struct PooledVariance([f64; 3]);

/// Noise statistics of one tile.
#[derive(Debug, Default)]
pub(super) struct TileNoise {
    channels: Vec<ChannelNoise>,
}

/// One channel of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ChannelNoise {
    /// Reference brightness for the relative error.
    brightness: f64,
    standard_error: StandardError,
}

impl PooledVariance {
    fn new(pixels: &[&PixelEstimate]) -> Self {
        Self(std::array::from_fn(|axis| {
            SHARED_VARIANCE_WEIGHT * mean(pixels, |pixel| pixel.variance[axis])
        }))
    }

    /// Standard errors of a pixel's channels.
    fn standard_errors(&self, pixel: &PixelEstimate) -> [StandardError; 3] {
        std::array::from_fn(|axis| {
            let own = (1.0 - SHARED_VARIANCE_WEIGHT) * pixel.variance[axis];
            let variance = own + self.0[axis];
            let ratio = variance / own;
            let blocks = f64::from(pixel.blocks);
            // A pixel without variance of its own has only the shared one, which is treated as
            // exact.
            let degrees_of_freedom =
                if ratio < 1e6 { (blocks - 1.0) * ratio * ratio } else { f64::INFINITY };
            StandardError { std_dev: variance.sqrt(), degrees_of_freedom }
        })
    }
}

/// Half-width of the confidence interval around each pixel's mean in a tile, per channel. Infinite
/// where the error is unknown.
pub(super) fn confidence_half_widths(pixels: &[PixelEstimate], confidence: f64) -> Vec<[f64; 3]> {
    let known: Vec<&PixelEstimate> = pixels.iter().filter(|pixel| pixel.is_known()).collect();
    let pooled = PooledVariance::new(&known);
    let sigmas = Normal::standard().inverse_cdf(0.5 + 0.5 * confidence);
    let pixel_noise = |pixel: &PixelEstimate| match pixel.is_known() {
        true => {
            pooled.standard_errors(pixel).map(|standard_error| standard_error.half_width(sigmas))
        }
        false => [f64::INFINITY; 3],
    };
    pixels.iter().map(pixel_noise).collect()
}

impl TileNoise {
    /// Builds the statistics from the estimates of a tile's pixels. Pixels with fewer than two
    /// blocks and non-finite pixels are left out. With a `scale`, errors are those of displayed
    /// values.
    pub(super) fn new(pixels: &[PixelEstimate], scale: Option<&DisplayScale>) -> Self {
        Self::with_stride(pixels, scale, 1)
    }

    /// Builds the statistics from every `stride`-th pixel. The pooled variance still uses all
    /// pixels.
    pub(super) fn with_stride(
        pixels: &[PixelEstimate],
        scale: Option<&DisplayScale>,
        stride: usize,
    ) -> Self {
        let known: Vec<&PixelEstimate> = pixels.iter().filter(|pixel| pixel.is_known()).collect();
        let min_brightness = MIN_RELATIVE_BRIGHTNESS * mean(&known, brightness);
        let pooled = PooledVariance::new(&known);
        let pixel_noise = |pixel: &&PixelEstimate| {
            let relative = brightness(pixel).max(min_brightness);
            let errors = pooled.standard_errors(pixel);
            std::array::from_fn::<_, 3, _>(|axis| ChannelNoise {
                brightness: scale.map_or(relative, |scale| scale.brightness(pixel.mean[axis])),
                standard_error: errors[axis],
            })
        };
        Self { channels: known.iter().step_by(stride).flat_map(pixel_noise).collect() }
    }

    /// Returns true if the target is met.
    pub(super) fn meets(&self, target: NoiseTarget) -> bool {
        self.fraction_above(target.error) <= 1.0 - target.confidence
    }

    /// Expected fraction of values whose error exceeds `error`.
    pub(super) fn fraction_above(&self, error: f64) -> f64 {
        let sum: f64 = self.channels.iter().map(|value| value.exceedance_probability(error)).sum();
        sum / self.channels.len().max(1) as f64
    }

    /// The error that a fraction `confidence` of the values stay below, to three digits; `None` if
    /// nothing is known.
    pub(super) fn error_quantile(&self, confidence: f64) -> Option<f64> {
        error_quantile(std::slice::from_ref(self), confidence)
    }
}

/// The error that a fraction `confidence` of the values of all tiles stay below, to three digits;
/// `None` while nothing is known of a tile: the first tiles to be known may be plain sky.
pub(super) fn error_quantile(tiles: &[TileNoise], confidence: f64) -> Option<f64> {
    if tiles.is_empty() || tiles.iter().any(|tile| tile.channels.is_empty()) {
        return None;
    }
    let values: usize = tiles.iter().map(|tile| tile.channels.len()).sum();
    let fraction_above = |error: f64| {
        let exceeding = |tile: &TileNoise| tile.fraction_above(error) * tile.channels.len() as f64;
        tiles.iter().map(exceeding).sum::<f64>() / values as f64
    };
    let channels = tiles.iter().flat_map(|tile| &tile.channels);
    let largest = channels.map(|value| value.relative_error()).fold(0.0, f64::max);
    if !(largest > 0.0 && largest.is_finite()) {
        return Some(largest);
    }
    // The bounds are far below and far above any possible result; the fraction decreases with the
    // error.
    let (mut low, mut high) = (1e-9 * largest, 1e3 * largest);
    while high / low > 1.0005 {
        let middle = (low * high).sqrt();
        if fraction_above(middle) > 1.0 - confidence { low = middle } else { high = middle }
    }
    Some(high)
}

impl StandardError {
    /// Half-width of the confidence interval that corresponds to `sigmas` standard deviations of a
    /// normal distribution.
    fn half_width(self, sigmas: f64) -> f64 {
        student_t_from_normal(sigmas, self.degrees_of_freedom) * self.std_dev
    }
}

impl ChannelNoise {
    fn relative_error(&self) -> f64 {
        let deviation = self.standard_error.std_dev;
        if deviation == 0.0 { 0.0 } else { deviation / self.brightness }
    }

    /// Probability that the error exceeds `error` times the brightness.
    fn exceedance_probability(&self, error: f64) -> f64 {
        let StandardError { std_dev: deviation, degrees_of_freedom } = self.standard_error;
        if deviation == 0.0 {
            return 0.0;
        }
        let sigmas = normal_from_student_t(error * self.brightness / deviation, degrees_of_freedom);
        libm::erfc(sigmas * std::f64::consts::FRAC_1_SQRT_2)
    }
}

fn mean(pixels: &[&PixelEstimate], of: impl Fn(&PixelEstimate) -> f64) -> f64 {
    pixels.iter().map(|pixel| of(pixel)).sum::<f64>() / pixels.len().max(1) as f64
}

/// Reference brightness for the relative error: the mean of the channels, never negative.
fn brightness(pixel: &PixelEstimate) -> f64 {
    let [red, green, blue] = pixel.mean;
    ((red + green + blue) / 3.0).max(0.0)
}

/// The normal deviate with the same tail probability as `t` under Student's distribution. Accurate
/// to a few hundredths from three degrees of freedom on (Wallace 1959, "Bounds on normal
/// approximations to Student's and the chi-square distributions"). Uses a closed form and the
/// `libm` crate so that decisions are identical on every machine.
fn normal_from_student_t(t: f64, degrees_of_freedom: f64) -> f64 {
    if degrees_of_freedom.is_infinite() {
        return t;
    }
    wallace_factor(degrees_of_freedom)
        * (degrees_of_freedom * libm::log1p(t * t / degrees_of_freedom)).sqrt()
}

/// The inverse of [`normal_from_student_t`].
fn student_t_from_normal(sigmas: f64, degrees_of_freedom: f64) -> f64 {
    if degrees_of_freedom.is_infinite() {
        return sigmas;
    }
    let u = sigmas / wallace_factor(degrees_of_freedom);
    (degrees_of_freedom * libm::expm1(u * u / degrees_of_freedom)).sqrt()
}

fn wallace_factor(degrees_of_freedom: f64) -> f64 {
    (8.0 * degrees_of_freedom + 1.0) / (8.0 * degrees_of_freedom + 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use statrs::distribution::StudentsT;

    fn pixel(mean: f64, deviation: f64, blocks: u32) -> PixelEstimate {
        PixelEstimate { mean: [mean; 3], variance: [deviation * deviation; 3], blocks }
    }

    #[test]
    fn the_closed_form_is_near_students_distribution() {
        for degrees_of_freedom in [3.0, 7.0, 15.0, 63.0, 1023.0] {
            let student = StudentsT::new(0.0, 1.0, degrees_of_freedom).unwrap();
            for (confidence, tolerance) in [(0.8, 0.01), (0.95, 0.013), (0.99, 0.04)] {
                let p = 0.5 + 0.5 * confidence;
                let sigmas = Normal::standard().inverse_cdf(p);
                let t = student_t_from_normal(sigmas, degrees_of_freedom);
                assert_relative_eq!(t, student.inverse_cdf(p), max_relative = tolerance);
                assert_relative_eq!(
                    normal_from_student_t(t, degrees_of_freedom),
                    sigmas,
                    max_relative = 1e-12
                );
            }
        }
        assert_eq!(normal_from_student_t(1.5, f64::INFINITY), 1.5);
    }

    #[test]
    fn equal_pixels_are_done_when_their_interval_is_as_narrow_as_the_target() {
        let tile = |deviation| TileNoise::new(&[pixel(2.0, deviation, 1 << 20); 256], None);
        let target = NoiseTarget { error: 0.01, confidence: 0.95, display: None };
        // 1.96 standard deviations are 1 % of 2.
        let edge = 0.02 / 1.959964;
        assert!(tile(0.999 * edge).meets(target));
        assert!(!tile(1.001 * edge).meets(target));
        assert_relative_eq!(tile(edge).error_quantile(0.95).unwrap(), 0.01, max_relative = 1e-3);
        let both = [tile(edge), tile(edge)];
        assert_relative_eq!(error_quantile(&both, 0.95).unwrap(), 0.01, max_relative = 1e-3);
        assert_eq!(error_quantile(&[tile(edge), TileNoise::default()], 0.95), None);
    }

    #[test]
    fn a_twentieth_of_the_values_may_be_noisy() {
        let with_noisy = |count: usize| {
            let mut pixels = vec![pixel(1.0, 0.0, 1 << 20); 1000];
            pixels[..count].fill(pixel(1.0, 1e-3, 1 << 20));
            TileNoise::new(&pixels, None)
        };
        // A third of a standard deviation of the noisy pixels, and many of the shared one.
        let target = NoiseTarget { error: 3.3e-4, confidence: 0.95, display: None };
        assert!(with_noisy(50).meets(target));
        assert!(!with_noisy(100).meets(target));
        let difference = with_noisy(50).fraction_above(target.error) - 0.05 * 0.74;
        assert!(difference.abs() < 1e-3, "{difference}");
    }

    #[test]
    fn a_pixel_without_spread_has_that_of_its_square() {
        let mut pixels = vec![pixel(1.0, 0.1, 4); 255];
        pixels.push(pixel(1.0, 0.0, 4));
        let widths = confidence_half_widths(&pixels, 0.95);
        let pooled = 0.1 * (SHARED_VARIANCE_WEIGHT * 255.0 / 256.0).sqrt();
        assert_relative_eq!(widths[255][0], 1.959964 * pooled, max_relative = 1e-5);
        // The other pixels have slightly more than 3 degrees of freedom.
        assert!((0.29..0.322).contains(&widths[0][0]), "{:?}", widths[0]);
    }

    #[test]
    fn darkness_is_seen_against_the_square_and_the_unknown_is_left_out() {
        let mut pixels = vec![pixel(1.0, 0.0, 8); 100];
        pixels[0] = pixel(1e-6, 0.0, 8);
        assert_eq!(
            TileNoise::new(&pixels, None).channels[0].brightness,
            MIN_RELATIVE_BRIGHTNESS * mean(&pixels.iter().collect::<Vec<_>>(), brightness)
        );
        pixels[0] = pixel(f64::NAN, f64::NAN, 8);
        pixels[1] = pixel(1.0, f64::NAN, 1);
        let tile = TileNoise::new(&pixels, None);
        assert_eq!((tile.channels.len(), tile.error_quantile(0.95)), (3 * 98, Some(0.0)));
        assert_eq!(confidence_half_widths(&pixels, 0.95)[1], [f64::INFINITY; 3]);
        assert_eq!(TileNoise::new(&[], None).error_quantile(0.95), None);
        let black = TileNoise::new(&[pixel(0.0, 0.0, 4); 4], None);
        assert!(black.meets(NoiseTarget { error: 1e-6, confidence: 0.99, display: None }));
    }
}
