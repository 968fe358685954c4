//! Sampling of discrete distributions.

use crate::fault::fault;

/// A discrete distribution over `0..n`.
#[derive(Clone, Debug)]
pub struct DiscreteDistribution {
    /// `cumulative[i]` is the probability of all indices up to and including `i`; the last is 1.
    cumulative: Vec<f64>,
    /// `guide[k]` is the index that `u = k / (n - 1)` selects, for n guides: where to search.
    guide: Vec<u32>,
}

/// Distributions of fewer indices have no guide.
const MIN_GUIDED: usize = 16;
/// Most intervals of a guide.
const MAX_GUIDES: usize = 1024;

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
        let guide = guide(&cumulative);
        valid.then_some(Self { cumulative, guide })
    }

    /// Samples an index by `u` in `[0, 1)`.
    pub fn sample(&self, u: f64) -> usize {
        let last = self.cumulative.len() - 1;
        let intervals = self.guide.len().max(2) - 1;
        let interval = ((u * intervals as f64) as usize).min(intervals - 1);
        let [first, end] = match self.guide.get(interval..=interval + 1) {
            Some(&[first, end]) => [first as usize, end as usize],
            _ => [0, last],
        };
        (first + self.cumulative[first..end].partition_point(|&sum| sum <= u)).min(last)
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

/// Returns the guide of a cumulative distribution. Multiplying by a power of two is exact, so that
/// a number's interval is that of its guides.
fn guide(cumulative: &[f64]) -> Vec<u32> {
    if cumulative.len() < MIN_GUIDED || u32::try_from(cumulative.len()).is_err() {
        return Vec::new();
    }
    let intervals = cumulative.len().next_power_of_two().min(MAX_GUIDES);
    let mut index = 0;
    let mut guide_at = |k: usize| {
        let u = k as f64 / intervals as f64;
        while cumulative.get(index).is_some_and(|&sum| sum <= u) {
            index += 1;
        }
        index as u32
    };
    (0..=intervals).map(&mut guide_at).collect()
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
    fn a_guide_does_not_change_what_is_sampled() {
        for count in [15, 16, 100, 5000] {
            let weight = |i: usize| if i % 3 == 0 { 0.0 } else { (i % 7) as f64 + 1e-9 };
            let distribution = DiscreteDistribution::new((0..count).map(weight)).expect("valid");
            assert_eq!(distribution.guide.is_empty(), count < MIN_GUIDED);
            let cumulative = &distribution.cumulative;
            let steps = (0..4096).map(|i| f64::from(i) / 4096.0);
            let edges = cumulative.iter().flat_map(|&sum| [sum, sum * (1.0 - 1e-16)]);
            for u in steps.chain(edges) {
                let expected = cumulative.partition_point(|&sum| sum <= u).min(count - 1);
                assert_eq!(distribution.sample(u), expected, "{u} of {count}");
            }
        }
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
