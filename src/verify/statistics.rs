//! Means over independent seeds with their standard errors, and statistical tests on them.
//!
//! A mean over `n` seeds with standard error `s` is compared with a value by Student's t-test: if
//! the program is correct, `(mean - value) / s` follows the t distribution with `n - 1` degrees of
//! freedom (Student 1908). Two means are compared by Welch's test (Welch 1947). Multiple tests
//! share one significance, which bounds the false-alarm probability of the whole family.

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Relative error allowed for f32 radiance and its sums. A mean this close to the exact value
/// counts as equal, however small its standard error.
pub const ROUNDING: f64 = 1e-5;

/// A mean over independent seeds, with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanEstimate {
    /// Mean over the seeds.
    pub mean: f64,
    /// Standard error of the mean, estimated from the seeds.
    pub standard_error: f64,
    /// Number of independent values, at least 2.
    pub seeds: usize,
}

impl MeanEstimate {
    /// Estimates from one value per independent seed; at least two values are required.
    pub fn from_values(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let sum_of_squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
        let standard_error = (sum_of_squares / (n - 1.0) / n).sqrt();
        Self { mean, standard_error, seeds: values.len() }
    }

    /// Student's t against `expected`: the deviation in standard errors; 0 if there is none.
    pub fn t(&self, expected: f64) -> f64 {
        let deviation = self.mean - expected;
        if deviation == 0.0 { 0.0 } else { deviation / self.standard_error }
    }

    /// Probability that a correct program misses `expected` by at least this much, beyond
    /// [`ROUNDING`]; 0 if the mean is NaN.
    pub fn p_value(&self, expected: f64) -> f64 {
        let deviation = (self.mean - expected).abs() - ROUNDING * expected.abs();
        two_sided(deviation, self.standard_error, self.seeds as f64 - 1.0)
    }

    /// Probability that two estimates of the same value differ by at least this much, beyond
    /// [`ROUNDING`].
    pub fn welch_p_value(&self, other: &Self) -> f64 {
        let largest = self.mean.abs().max(other.mean.abs());
        let deviation = (self.mean - other.mean).abs() - ROUNDING * largest;
        let [a, b] = [self, other].map(|e| e.standard_error * e.standard_error);
        // Welch-Satterthwaite degrees of freedom; any value will do if nothing varies.
        let [m, n] = [self, other].map(|e| e.seeds as f64 - 1.0);
        let degrees_of_freedom = (a + b) * (a + b) / (a * a / m + b * b / n);
        two_sided(
            deviation,
            (a + b).sqrt(),
            if degrees_of_freedom.is_finite() { degrees_of_freedom } else { m + n },
        )
    }

    /// Half-width of the interval that contains the true mean with probability `confidence`, in (0,
    /// 1).
    pub fn confidence_half_width(&self, confidence: f64) -> f64 {
        student_t_quantile(0.5 + 0.5 * confidence, self.seeds as f64 - 1.0) * self.standard_error
    }
}

/// Probability of `|t| >= off / standard_error`.
fn two_sided(deviation: f64, standard_error: f64, degrees_of_freedom: f64) -> f64 {
    if deviation.is_nan() || standard_error.is_nan() {
        return 0.0;
    }
    if deviation <= 0.0 {
        return 1.0;
    }
    if standard_error == 0.0 {
        return 0.0;
    }
    (2.0 * student_t(degrees_of_freedom).sf(deviation / standard_error)).min(1.0)
}

/// Quantile of Student's t distribution for a probability `p` in (0, 1); `degrees_of_freedom` is
/// positive.
pub fn student_t_quantile(p: f64, degrees_of_freedom: f64) -> f64 {
    student_t(degrees_of_freedom).inverse_cdf(p)
}

fn student_t(degrees_of_freedom: f64) -> StudentsT {
    StudentsT::new(0.0, 1.0, degrees_of_freedom).expect("positive degrees of freedom")
}

/// Converts a two-sided p-value to standard deviations of a normal distribution: 0.05 is 1.96, 1e-6
/// is 4.89. At most 38, the limit of f64.
pub fn sigmas(p: f64) -> f64 {
    let normal = Normal::standard();
    // Adding 0 takes the sign from -0.
    (-normal.inverse_cdf((p / 2.0).clamp(1e-315, 0.5))).max(0.0) + 0.0
}

/// Significance of each of `tests` tests so that the family has significance `family`, in (0, 1).
/// Valid for dependent tests (Bonferroni).
pub fn bonferroni(family: f64, tests: usize) -> f64 {
    family / tests.max(1) as f64
}

/// Significance of each of `tests` tests, like [`bonferroni`] but exact for independent tests
/// (Sidak 1967).
pub fn sidak(family: f64, tests: usize) -> f64 {
    -libm::expm1(libm::log1p(-family) / tests.max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn quantiles_and_probabilities_are_those_of_the_tables() {
        // Two-sided 5 % for 31 degrees of freedom, and one-sided 1e-3 for 4.
        assert_relative_eq!(student_t_quantile(0.975, 31.0), 2.039513, max_relative = 1e-6);
        assert_relative_eq!(student_t_quantile(0.999, 4.0), 7.173182, max_relative = 1e-6);
        assert_relative_eq!(sigmas(0.05), 1.959964, max_relative = 1e-6);
        assert_relative_eq!(sigmas(1e-6), 4.891638, max_relative = 1e-6);
        assert_eq!(sigmas(1.0), 0.0);
        assert!((37.0..39.0).contains(&sigmas(0.0)));
        let estimate = MeanEstimate { mean: 1.0, standard_error: 0.1, seeds: 32 };
        assert_relative_eq!(estimate.confidence_half_width(0.95), 0.2039513, max_relative = 1e-6);
        let p = estimate.p_value(1.2039513 / (1.0 + ROUNDING));
        assert_relative_eq!(p, 0.05, max_relative = 1e-3);
    }

    #[test]
    fn an_estimate_has_the_mean_and_its_standard_error() {
        let estimate = MeanEstimate::from_values(&[1.0, 2.0, 3.0, 6.0]);
        assert_eq!((estimate.mean, estimate.seeds), (3.0, 4));
        assert_relative_eq!(estimate.standard_error, (14.0f64 / 3.0 / 4.0).sqrt());
    }

    #[test]
    fn what_never_varies_must_be_equal_up_to_rounding() {
        let constant = MeanEstimate::from_values(&[2.0, 2.0, 2.0]);
        assert_eq!(constant.p_value(2.0 * (1.0 + 0.9 * ROUNDING)), 1.0);
        assert_eq!(constant.p_value(2.0 * (1.0 + 2.0 * ROUNDING)), 0.0);
        assert_eq!(constant.welch_p_value(&constant), 1.0);
        assert_eq!(constant.welch_p_value(&MeanEstimate { mean: 2.1, ..constant }), 0.0);
        assert_eq!(MeanEstimate::from_values(&[f64::NAN, 1.0]).p_value(1.0), 0.0);
        assert_eq!(MeanEstimate::from_values(&[f64::INFINITY, 1.0]).p_value(1.0), 0.0);
    }

    #[test]
    fn welchs_test_has_the_textbook_degrees_of_freedom() {
        // Equal errors and sample sizes: the degrees of freedom add up.
        let a = MeanEstimate { mean: 0.0, standard_error: 3.0, seeds: 11 };
        let b = MeanEstimate { mean: 10.0, standard_error: 3.0, seeds: 11 };
        let t = (10.0 - 10.0 * ROUNDING) / 18.0f64.sqrt();
        let expected = 2.0 * student_t(20.0).sf(t);
        assert_relative_eq!(a.welch_p_value(&b), expected, max_relative = 1e-9);
    }

    #[test]
    fn a_family_shares_its_significance() {
        assert_relative_eq!(bonferroni(0.01, 100), 1e-4);
        let each = sidak(0.01, 100);
        assert_relative_eq!(1.0 - (1.0 - each).powi(100), 0.01, max_relative = 1e-9);
        assert!(each > 1e-4);
    }
}
