//! Convergence: error against samples and against seconds, with the slope of a line fitted in
//! log-log space.
//!
//! Images of several independent seeds are compared with one reference. Results are means over the
//! seeds with their confidence intervals (Student's t). The slope is fitted for each seed by least
//! squares and treated the same way, so it needs no model of how errors scatter.
//!
//! A reference has noise of its own, which adds to every squared error. A reference made of two
//! independent halves reveals how much: the variance of their mean is a quarter of their squared
//! difference. That noise is subtracted, so a curve does not flatten out at the noise level of the
//! reference.

mod study;

use crate::color::Rgb;

use super::metrics::{mean_error, relative_squared, squared};
use super::statistics::MeanEstimate;

pub use study::{ReferenceSource, Study, Variant};

/// Error metric.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorMetric {
    /// Root mean squared error. Independent samples give a slope of -1/2.
    Rmse,
    /// Mean relative squared error; see [`relative_squared`]. Independent samples give a slope of
    /// -1.
    Relmse,
}

/// Horizontal axis of a convergence curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Samples per pixel.
    Samples,
    /// Render time in seconds.
    Seconds,
}

/// Reference image.
#[derive(Clone, Debug)]
pub struct Reference {
    pixels: Vec<Rgb>,
    /// Mean squared and mean relative squared error of the reference itself, if known.
    noise: Option<[f64; 2]>,
}

/// How few pixels carry half of a sum of squared errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Concentration {
    /// The number of the worst pixels that carry half of it.
    pub pixels: usize,
    /// The index of the worst pixel.
    pub worst: usize,
    /// The number of all pixels.
    pub of: usize,
}

/// Errors and time of one image.
#[derive(Clone, Copy, Debug)]
pub struct RunErrors {
    /// Mean squared error, with the reference's own subtracted.
    pub mse: f64,
    /// Mean relative squared error, with the reference's own subtracted.
    pub relmse: f64,
    /// Render time in seconds.
    pub seconds: f64,
    /// Which pixels carry the squared and the relative squared error.
    pub concentration: [Concentration; 2],
}

/// All seeds at one sample count.
#[derive(Clone, Debug)]
pub struct ConvergencePoint {
    /// Samples per pixel.
    pub samples: u32,
    /// Runs, one per seed.
    pub runs: Vec<RunErrors>,
}

/// Convergence of one variant over several sample counts.
#[derive(Clone, Debug)]
pub struct Series {
    /// Name of the variant.
    pub name: String,
    /// Points in order of increasing samples, at least one. All have the same number of seeds, at
    /// least two.
    pub points: Vec<ConvergencePoint>,
}

/// A straight line in log-log space.
#[derive(Clone, Copy, Debug)]
pub struct LogLogFit {
    /// Slope, estimated over the seeds.
    pub slope: MeanEstimate,
    /// log10 of the error where log10 of the axis is 0.
    pub intercept: f64,
}

impl ErrorMetric {
    /// Returns the name used in options and plots.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rmse => "RMSE",
            Self::Relmse => "relMSE",
        }
    }

    fn value(self, mse: f64, relmse: f64) -> f64 {
        match self {
            Self::Rmse => mse.sqrt(),
            Self::Relmse => relmse,
        }
    }
}

impl Reference {
    /// Averages two images with independent seeds.
    pub fn from_halves(a: &[Rgb], b: &[Rgb]) -> Self {
        let pixels: Vec<Rgb> = a.iter().zip(b).map(|(&a, &b)| 0.5 * (a + b)).collect();
        // a - mean is half of a - b, and its square estimates the variance of the mean.
        let noise = [mean_error(a, &pixels, squared), mean_error(a, &pixels, relative_squared)];
        Self { pixels, noise: Some(noise) }
    }

    /// Uses an existing image, with the variance of its pixels if known.
    pub fn from_picture(pixels: Vec<Rgb>, variance: Option<&[Rgb]>) -> Self {
        let noise = variance.map(|variance| {
            let offset_pixels: Vec<Rgb> = pixels
                .iter()
                .zip(variance)
                .map(|(&value, v)| value + v.max(Rgb::ZERO).map(f32::sqrt))
                .collect();
            [
                mean_error(&offset_pixels, &pixels, squared),
                mean_error(&offset_pixels, &pixels, relative_squared),
            ]
        });
        Self { pixels, noise }
    }

    /// Error of the reference itself in this metric; `None` if unknown.
    pub fn noise(&self, metric: ErrorMetric) -> Option<f64> {
        self.noise.map(|[mse, relmse]| metric.value(mse, relmse))
    }

    /// Measures an image of the same size that took this many seconds.
    pub fn measure(&self, picture: &[Rgb], seconds: f64) -> RunErrors {
        let [noise, relative_noise] = self.noise.unwrap_or_default();
        let of = |error: fn(Rgb, Rgb) -> f64| Concentration::of(picture, &self.pixels, error);
        RunErrors {
            mse: mean_error(picture, &self.pixels, squared) - noise,
            relmse: mean_error(picture, &self.pixels, relative_squared) - relative_noise,
            seconds,
            concentration: [of(squared), of(relative_squared)],
        }
    }
}

impl Concentration {
    /// One pixel of so many is few.
    const FEW: usize = 500;

    fn of(a: &[Rgb], b: &[Rgb], error: impl Fn(Rgb, Rgb) -> f64) -> Self {
        let errors = a.iter().zip(b).map(|(&a, &b)| error(a, b)).enumerate();
        let mut errors: Vec<(usize, f64)> = errors.collect();
        errors.sort_by(|a, b| b.1.total_cmp(&a.1));
        let half = 0.5 * errors.iter().map(|(_, error)| error).sum::<f64>();
        let mut sum = 0.0;
        let below_half = errors.iter().take_while(|(_, error)| {
            sum += error;
            sum < half
        });
        let pixels = (below_half.count() + 1).min(errors.len());
        Self { pixels, worst: errors.first().map_or(0, |(pixel, _)| *pixel), of: errors.len() }
    }

    /// Returns true if so few pixels carry half of the error that a mean over all pixels says
    /// little.
    pub fn is_high(&self) -> bool {
        self.pixels * Self::FEW <= self.of
    }
}

impl RunErrors {
    /// Error in this metric; NaN if the reference is noisier than the image.
    pub fn error(&self, metric: ErrorMetric) -> f64 {
        metric.value(self.mse, self.relmse)
    }
}

impl ConvergencePoint {
    /// Error over the seeds.
    pub fn error(&self, metric: ErrorMetric) -> MeanEstimate {
        self.estimate(|run| run.error(metric))
    }

    /// Which pixels carry the error, in the run in which most do.
    pub fn concentration(&self, metric: ErrorMetric) -> Concentration {
        let of = |run: &RunErrors| match metric {
            ErrorMetric::Rmse => run.concentration[0],
            ErrorMetric::Relmse => run.concentration[1],
        };
        self.runs.iter().map(of).max_by_key(|one| one.pixels).unwrap_or_default()
    }

    /// Render time in seconds over the seeds.
    pub fn seconds(&self) -> MeanEstimate {
        self.estimate(|run| run.seconds)
    }

    /// Squared error times seconds: the cost of a method, constant in the number of independent
    /// samples. For [`ErrorMetric::Relmse`] the relative squared error.
    pub fn cost(&self, metric: ErrorMetric) -> MeanEstimate {
        self.estimate(|run| match metric {
            ErrorMetric::Rmse => run.mse * run.seconds,
            ErrorMetric::Relmse => run.relmse * run.seconds,
        })
    }

    fn estimate(&self, value: impl Fn(&RunErrors) -> f64) -> MeanEstimate {
        MeanEstimate::from_values(&self.runs.iter().map(value).collect::<Vec<_>>())
    }
}

impl Series {
    /// Returns true if the error of any point exceeds the reference's own.
    pub fn has_error(&self, metric: ErrorMetric) -> bool {
        self.points.iter().any(|point| point.error(metric).mean > 0.0)
    }

    /// Fits a line through all points; `None` for a single point, or if an error is not positive
    /// because the reference is too noisy.
    pub fn fit(&self, metric: ErrorMetric, axis: Axis) -> Option<LogLogFit> {
        if self.points.len() < 2 {
            return None;
        }
        // Use each seed's own seconds, so that timing noise enters the interval.
        let fit_seed = |seed: usize| {
            let x = |point: &ConvergencePoint| match axis {
                Axis::Samples => f64::from(point.samples),
                Axis::Seconds => point.runs[seed].seconds,
            };
            let xs: Vec<f64> = self.points.iter().map(|point| libm::log10(x(point))).collect();
            let y = |point: &ConvergencePoint| libm::log10(point.runs[seed].error(metric));
            line(&xs, &self.points.iter().map(y).collect::<Vec<_>>())
        };
        let lines: Vec<(f64, f64)> = (0..self.points[0].runs.len()).map(fit_seed).collect();
        let slope = MeanEstimate::from_values(&lines.iter().map(|line| line.0).collect::<Vec<_>>());
        let intercept =
            MeanEstimate::from_values(&lines.iter().map(|line| line.1).collect::<Vec<_>>()).mean;
        let is_finite = slope.mean.is_finite() && intercept.is_finite();
        is_finite.then_some(LogLogFit { slope, intercept })
    }
}

/// Slope and intercept of the least-squares line.
fn line(xs: &[f64], ys: &[f64]) -> (f64, f64) {
    let n = xs.len() as f64;
    let (x, y) = (xs.iter().sum::<f64>() / n, ys.iter().sum::<f64>() / n);
    let covariance: f64 = xs.iter().zip(ys).map(|(a, b)| (a - x) * (b - y)).sum();
    let variance: f64 = xs.iter().map(|a| (a - x) * (a - x)).sum();
    let slope = covariance / variance;
    (slope, y - slope * x)
}

#[cfg(test)]
mod tests {
    use rand::rngs::StdRng;
    use rand::{RngExt, SeedableRng};

    use super::*;

    /// 1000 pixels, each the mean of `n` uniform random numbers.
    fn noisy(n: u32, random: &mut StdRng) -> Vec<Rgb> {
        let mut mean = || (0..n).map(|_| random.random::<f32>()).sum::<f32>() / n as f32;
        (0..1000).map(|_| Rgb::new(mean(), mean(), mean())).collect()
    }

    fn series(reference: &Reference, random: &mut StdRng) -> Series {
        let runs = |n, random: &mut StdRng| -> Vec<RunErrors> {
            (0..16).map(|_| reference.measure(&noisy(n, random), f64::from(n) * 1e-3)).collect()
        };
        let points = [4, 8, 16, 32];
        let points =
            points.map(|samples| ConvergencePoint { samples, runs: runs(samples, random) });
        Series { name: "uniform".into(), points: points.into() }
    }

    /// The reference has only four times the samples of the last point. Without subtracting its
    /// noise the error there would be 12 % too large, and the slope -0.47. Five standard errors are
    /// allowed (Student's t with 15 degrees of freedom: significance 2e-4 each).
    #[test]
    fn independent_samples_have_a_slope_of_one_half_whatever_the_reference() {
        let mut random = StdRng::seed_from_u64(5);
        let halves = [64, 64].map(|n| noisy(n, &mut random));
        let reference = Reference::from_halves(&halves[0], &halves[1]);
        let noise = reference.noise(ErrorMetric::Rmse).unwrap();
        assert!((noise / (1.0f64 / 12.0 / 128.0).sqrt() - 1.0).abs() < 0.05, "{noise}");
        let series = series(&reference, &mut random);
        for (metric, expected) in [(ErrorMetric::Rmse, -0.5), (ErrorMetric::Relmse, -1.0)] {
            for axis in [Axis::Samples, Axis::Seconds] {
                let slope = series.fit(metric, axis).unwrap().slope;
                let allowed = 5.0 * slope.standard_error;
                assert!((slope.mean - expected).abs() < allowed, "{slope:?}");
                assert!(allowed < 0.05);
            }
        }
        let last = series.points[3].error(ErrorMetric::Rmse);
        let expected = (1.0f64 / 12.0 / 32.0).sqrt();
        assert!((last.mean - expected).abs() < 5.0 * last.standard_error, "{last:?}");
        let cost = series.points[0].cost(ErrorMetric::Rmse);
        assert!((cost.mean - 1e-3 / 12.0).abs() < 5.0 * cost.standard_error, "{cost:?}");
    }

    #[test]
    fn a_line_goes_through_its_points_and_bad_errors_give_none() {
        let (slope, intercept) = line(&[0.0, 1.0, 2.0], &[1.0, 0.5, 0.0]);
        assert!((slope + 0.5).abs() < 1e-15 && (intercept - 1.0).abs() < 1e-15);
        let concentration = Default::default();
        let run = RunErrors { mse: -1.0, relmse: 1.0, seconds: 1.0, concentration };
        let point = |samples| ConvergencePoint { samples, runs: vec![run; 3] };
        let series = Series { name: String::new(), points: vec![point(1), point(2)] };
        assert!(series.fit(ErrorMetric::Rmse, Axis::Samples).is_none());
        assert!(series.fit(ErrorMetric::Relmse, Axis::Samples).is_some());
    }

    #[test]
    fn a_few_pixels_that_carry_the_error_are_found() {
        let mut random = StdRng::seed_from_u64(6);
        let reference = Reference::from_picture(vec![Rgb::splat(0.5); 1000], None);
        let mut picture = noisy(4, &mut random);
        let even = reference.measure(&picture, 1.0).concentration[0];
        assert!(!even.is_high() && even.pixels > 50 && even.of == 1000, "{even:?}");
        picture[321] = Rgb::splat(100.0);
        let odd = reference.measure(&picture, 1.0).concentration;
        assert_eq!(odd, [Concentration { pixels: 1, worst: 321, of: 1000 }; 2]);
        assert!(odd[0].is_high());
    }

    #[test]
    fn a_variance_layer_tells_the_noise_of_a_reference() {
        let pixels = vec![Rgb::splat(1.0); 4];
        let reference = Reference::from_picture(pixels.clone(), Some(&[Rgb::splat(0.04); 4]));
        assert!((reference.noise(ErrorMetric::Rmse).unwrap() - 0.2).abs() < 1e-7);
        assert_eq!(Reference::from_picture(pixels, None).noise(ErrorMetric::Rmse), None);
    }
}
