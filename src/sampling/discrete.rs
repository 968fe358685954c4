//! Sampling of discrete distributions.

use crate::fault::fault;

/// A discrete distribution over `0..n`.
#[derive(Clone, Debug)]
pub struct DiscreteDistribution {
    /// `cumulative[i]` is the probability of all indices up to and including `i`; the last is 1.
    cumulative: Vec<f64>,
}

impl DiscreteDistribution {
    /// Creates a distribution proportional to `weights`; `None` unless they are finite, not
    /// negative and not all 0.
    pub fn new(weights: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut total = 0.0;
        let mut cumulative: Vec<f64> = weights
            .into_iter()
            .map(|weight| {
                total += weight;
                total
            })
            .collect();
        let valid = total > 0.0 && total.is_finite() && cumulative.is_sorted();
        cumulative.iter_mut().for_each(|sum| *sum /= total);
        valid.then_some(Self { cumulative })
    }

    /// Samples an index by `u` in `[0, 1)`.
    pub fn sample(&self, u: f64) -> usize {
        self.cumulative.partition_point(|&sum| sum <= u).min(self.cumulative.len() - 1)
    }

    /// Returns the probability of an index.
    pub fn pmf(&self, index: usize) -> f64 {
        let index = if fault!(PmfOffByOne) { index.saturating_sub(1) } else { index };
        let below = if index == 0 { 0.0 } else { self.cumulative[index - 1] };
        self.cumulative[index] - below
    }

    /// Remaps `u` within the interval that selects `index`, to a number uniform in `[0, 1)`.
    pub fn remap(&self, index: usize, u: f64) -> f64 {
        let below = if index == 0 { 0.0 } else { self.cumulative[index - 1] };
        ((u - below) / self.pmf(index)).clamp(0.0, 1.0 - f64::EPSILON)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn indices_come_with_their_probabilities() {
        let distribution = DiscreteDistribution::new([1.0, 0.0, 3.0]).expect("valid");
        assert_relative_eq!(distribution.pmf(0), 0.25);
        assert_relative_eq!(distribution.pmf(1), 0.0);
        assert_relative_eq!(distribution.pmf(2), 0.75);
        assert_eq!([0.0, 0.2499, 0.25, 0.999_999].map(|u| distribution.sample(u)), [0, 0, 2, 2]);
        assert_relative_eq!(distribution.remap(2, 0.625), 0.5);
        // Rounding may bring a number to the end of its interval, and no further.
        assert_eq!(distribution.sample(1.0), 2);
        assert_eq!([(0, 0.25), (2, 1.0)].map(|(i, u)| distribution.remap(i, u) < 1.0), [true; 2]);
    }

    #[test]
    fn impossible_weights_are_refused() {
        assert!(DiscreteDistribution::new([]).is_none());
        assert!(DiscreteDistribution::new([0.0, 0.0]).is_none());
        assert!(DiscreteDistribution::new([1.0, -1.0]).is_none());
        assert!(DiscreteDistribution::new([f64::NAN]).is_none());
        assert!(DiscreteDistribution::new([f64::INFINITY]).is_none());
    }
}
