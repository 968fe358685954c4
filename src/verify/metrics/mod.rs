//! Error metrics between an image and a reference, as used in papers.
//!
//! Metrics take linear Rec. 709 and average the three channels unless stated otherwise. The two
//! images must have the same size.

pub mod flip;
pub mod heatmap;

use crate::color::Rgb;
use crate::math::DVec3;

/// Epsilon of [`relative_squared`].
pub const RELATIVE_EPSILON: f64 = 0.01;
/// A normal variable lies within this many standard deviations with probability 95 %.
const NORMAL_95: f64 = 1.959_964;

/// Mean of (a - b)^2 over the channels.
pub fn squared(a: Rgb, b: Rgb) -> f64 {
    (a.as_dvec3() - b.as_dvec3()).length_squared() / 3.0
}

/// Mean of ((a - b) / (|b| + epsilon))^2 over the channels, where b is the reference.
///
/// This is the error of pbrt-v4's `imgtool diff --metric MRSE`, with its epsilon of 0.01, which
/// prevents black pixels from dominating. Others use (a - b)^2 / (b^2 + epsilon) (Rousselle et al.
/// 2011), which differs where b is small.
pub fn relative_squared(a: Rgb, b: Rgb) -> f64 {
    let b = b.as_dvec3();
    ((a.as_dvec3() - b) / (b.abs() + RELATIVE_EPSILON)).length_squared() / 3.0
}

/// Mean of `error` over all pixels.
pub fn mean_error(a: &[Rgb], b: &[Rgb], error: impl Fn(Rgb, Rgb) -> f64) -> f64 {
    a.iter().zip(b).map(|(&a, &b)| error(a, b)).sum::<f64>() / a.len() as f64
}

/// Peak signal-to-noise ratio in decibels, 10 log10(peak^2 / MSE); infinite for equal images.
pub fn psnr(mse: f64, peak: f64) -> f64 {
    10.0 * libm::log10(peak * peak / mse)
}

/// Mean over all pixels, per channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageMean {
    /// Mean value.
    pub value: DVec3,
    /// Standard error of the mean, if the variance of the pixels is given; infinite where it is
    /// unknown for some pixel.
    pub standard_error: Option<DVec3>,
}

impl ImageMean {
    /// Mean of an image with unknown variance.
    pub fn of(picture: &[Rgb]) -> Self {
        let sum: DVec3 = picture.iter().map(|color| color.as_dvec3()).sum();
        Self { value: sum / picture.len() as f64, standard_error: None }
    }

    /// Mean of an image whose pixels have these variances; one that is infinite or NaN is unknown.
    /// Assumes independent pixels, which does not hold for samplers that share numbers between
    /// pixels.
    pub fn with_variance(picture: &[Rgb], variance: &[Rgb]) -> Self {
        let sum: DVec3 = variance.iter().map(|v| v.as_dvec3()).sum();
        let count = picture.len() as f64;
        let known = |sum: f64| if sum.is_finite() { sum.max(0.0).sqrt() } else { f64::INFINITY };
        let error = sum.map(known) / count;
        Self { standard_error: Some(error), ..Self::of(picture) }
    }

    /// Mean of `picture`, with its variance estimated from `twin`, the same image rendered with
    /// different random numbers: half of the squared difference.
    pub fn with_twin(picture: &[Rgb], twin: &[Rgb]) -> Self {
        let half_square = |(&a, &b): (&Rgb, &Rgb)| (a - b) * (a - b) * 0.5;
        let variance: Vec<Rgb> = picture.iter().zip(twin).map(half_square).collect();
        Self::with_variance(picture, &variance)
    }

    /// Half-width of the 95 % confidence interval of the mean (normal, as there are many pixels).
    pub fn half_width_95(&self) -> Option<DVec3> {
        self.standard_error.map(|error| error * NORMAL_95)
    }

    /// Ratio of `self` to `other`, with the half-width of its 95 % interval if at least one error
    /// is given; one that is not counts as zero. The ratio is 1 if both are 0. If only `other` is
    /// 0, or an error is unknown, the interval is infinite.
    pub fn ratio(&self, other: &Self) -> (DVec3, Option<DVec3>) {
        let of = |a: f64, b: f64| if a == b { 1.0 } else { a / b };
        let ratio = DVec3::from_array(std::array::from_fn(|c| of(self.value[c], other.value[c])));
        if self.standard_error.is_none() && other.standard_error.is_none() {
            return (ratio, None);
        }
        let error = |mean: &Self| mean.standard_error.unwrap_or(DVec3::ZERO);
        let half = |c: usize| {
            let (a, b) = (self.value[c], other.value[c]);
            match (a == 0.0, b == 0.0) {
                _ if !(error(self)[c] + error(other)[c]).is_finite() => f64::INFINITY,
                (true, true) => 0.0,
                (false, true) => f64::INFINITY,
                _ => {
                    let (own_term, other_term) = (error(self)[c], ratio[c] * error(other)[c]);
                    NORMAL_95 * (own_term * own_term + other_term * other_term).sqrt() / b.abs()
                }
            }
        };
        (ratio, Some(DVec3::from_array([0, 1, 2].map(half))))
    }
}

#[cfg(test)]
mod tests {
    use rand::rngs::StdRng;
    use rand::{RngExt, SeedableRng};

    use super::*;

    #[test]
    fn errors_are_those_of_their_formulas() {
        let a = [Rgb::new(1.0, 2.0, 3.0), Rgb::ZERO];
        let b = [Rgb::new(1.0, 1.0, 1.0), Rgb::ZERO];
        let mse = mean_error(&a, &b, squared);
        assert!((mse - (0.0 + 1.0 + 4.0) / 6.0).abs() < 1e-12);
        let relative = mean_error(&a, &b, relative_squared);
        assert!((relative - (1.0 + 4.0) / (1.01 * 1.01) / 6.0).abs() < 1e-9);
        assert!((psnr(0.01, 1.0) - 20.0).abs() < 1e-12);
        assert!((psnr(0.01, 10.0) - 40.0).abs() < 1e-12);
        assert_eq!(psnr(0.0, 1.0), f64::INFINITY);
        // The reference matters: where it is black, only epsilon divides.
        assert!((relative_squared(Rgb::ONE, Rgb::ZERO) - 1e4).abs() < 1e-6);
    }

    #[test]
    fn a_ratio_of_means_has_the_interval_of_its_parts() {
        let mean = |value, error| ImageMean {
            value: DVec3::splat(value),
            standard_error: Some(DVec3::splat(error)),
        };
        let (ratio, half) = mean(2.0, 0.02).ratio(&mean(1.0, 0.03));
        assert_eq!(ratio, DVec3::splat(2.0));
        let expected = NORMAL_95 * (0.02f64 * 0.02 + 0.06 * 0.06).sqrt();
        assert!((half.unwrap().x - expected).abs() < 1e-12);
        let zero = ImageMean { value: DVec3::ZERO, standard_error: None };
        assert_eq!(zero.ratio(&zero), (DVec3::ONE, None));
        // Black over black, and light over black.
        let black = mean(0.0, 0.0);
        assert_eq!(black.ratio(&black), (DVec3::ONE, Some(DVec3::ZERO)));
        let (ratio, half) = mean(2.0, 0.02).ratio(&black);
        assert_eq!((ratio, half), (DVec3::INFINITY, Some(DVec3::INFINITY)));
    }

    #[test]
    fn a_variance_that_is_unknown_is_not_none() {
        let picture = [Rgb::ONE, Rgb::ZERO];
        for unknown in [f32::INFINITY, f32::NAN] {
            let variance = [Rgb::new(unknown, 2.0, 0.0), Rgb::ZERO];
            let mean = ImageMean::with_variance(&picture, &variance);
            let expected = DVec3::new(f64::INFINITY, 0.5f64.sqrt(), 0.0);
            assert_eq!(mean.standard_error, Some(expected));
            let half = mean.ratio(&ImageMean::of(&picture)).1.unwrap();
            assert!(half.x == f64::INFINITY && half.y.is_finite() && half.z == 0.0);
        }
        let black = ImageMean::with_variance(&[Rgb::ZERO], &[Rgb::INFINITY]);
        assert_eq!(black.ratio(&black).1, Some(DVec3::INFINITY));
    }

    /// 400 images of 400 pixels with known variance: intervals from twins and from the variance
    /// contain the true mean as often as stated. 95 % of 400 is 380 +- 4.4; five of those
    /// (significance 6e-7) are allowed.
    #[test]
    fn intervals_of_means_hold_what_they_promise() {
        let mut random = StdRng::seed_from_u64(7);
        let mut draw =
            || -> Vec<Rgb> { (0..400).map(|_| Rgb::splat(random.random::<f32>())).collect() };
        let holds = |mean: ImageMean| {
            let half = mean.half_width_95().unwrap().x;
            usize::from((mean.value.x - 0.5).abs() <= half)
        };
        let known = vec![Rgb::splat(1.0 / 12.0); 400];
        let (mut by_twin, mut by_variance) = (0, 0);
        for _ in 0..400 {
            let (a, b) = (draw(), draw());
            by_twin += holds(ImageMean::with_twin(&a, &b));
            by_variance += holds(ImageMean::with_variance(&a, &known));
        }
        assert!((358..=400).contains(&by_twin), "{by_twin}");
        assert!((358..=400).contains(&by_variance), "{by_variance}");
    }
}
