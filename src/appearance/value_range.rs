//! The range of numbers that a colour map covers.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Most numbers that are sorted for a percentile; of more, evenly spaced ones are taken.
const MAX_SORTED: usize = 1 << 21;

/// One end of a range.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum RangeEnd {
    /// A number.
    Number(f64),
    /// The number that this percentage of the values do not exceed.
    Percentile(f64),
}

/// How a range is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RangeChoice {
    /// The lower end.
    pub low: RangeEnd,
    /// The upper end.
    pub high: RangeEnd,
}

impl Default for RangeChoice {
    /// From the least to the greatest value.
    fn default() -> Self {
        Self { low: RangeEnd::Percentile(0.0), high: RangeEnd::Percentile(100.0) }
    }
}

/// A range of numbers that a colour map covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValueRange {
    /// The number of the map's first colour.
    pub low: f64,
    /// The number of the map's last colour; may be below `low`, which reverses the map.
    pub high: f64,
    /// True if positions go with the logarithm.
    pub log: bool,
}

impl RangeChoice {
    /// Parses `LO,HI`; each end is a number, or a percentile such as `p1`.
    pub fn parse(text: &str) -> Option<Self> {
        let (low, high) = text.split_once(',')?;
        let end = |text: &str| {
            let text = text.trim();
            match text.strip_prefix('p') {
                Some(percent) => {
                    let percent: f64 = percent.parse().ok()?;
                    (0.0..=100.0).contains(&percent).then_some(RangeEnd::Percentile(percent))
                }
                None => {
                    let number: f64 = text.parse().ok()?;
                    number.is_finite().then_some(RangeEnd::Number(number))
                }
            }
        };
        Some(Self { low: end(low)?, high: end(high)? })
    }

    /// The range for these values. With `log`, only positive values count. `None` if no value
    /// counts, or a logarithmic range has an end that is not positive.
    pub fn resolve(&self, values: &[f64], log: bool) -> Option<ValueRange> {
        let counts = |x: &f64| x.is_finite() && (!log || *x > 0.0);
        let needs_values = |end: RangeEnd| matches!(end, RangeEnd::Percentile(_));
        let mut sorted = Vec::new();
        let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
        if needs_values(self.low) || needs_values(self.high) {
            let valid = values.par_iter().copied().filter(counts);
            ends = valid
                .fold(|| ends, |[low, high], x| [low.min(x), high.max(x)])
                .reduce(|| ends, |[a, b], [c, d]| [a.min(c), b.max(d)]);
            if ends[0] > ends[1] {
                return None;
            }
            let step = values.len().div_ceil(MAX_SORTED).max(1);
            sorted = values.iter().step_by(step).copied().filter(counts).collect();
            sorted.par_sort_unstable_by(f64::total_cmp);
        }
        let number = |end: RangeEnd| match end {
            RangeEnd::Number(number) => number,
            RangeEnd::Percentile(0.0) => ends[0],
            RangeEnd::Percentile(100.0) => ends[1],
            RangeEnd::Percentile(percent) => percentile(&sorted, percent).unwrap_or(ends[0]),
        };
        let range = ValueRange { low: number(self.low), high: number(self.high), log };
        (!log || range.low > 0.0 && range.high > 0.0).then_some(range)
    }
}

/// A percentile of sorted numbers, interpolated linearly.
fn percentile(sorted: &[f64], percent: f64) -> Option<f64> {
    let at = percent / 100.0 * (sorted.len().checked_sub(1)?) as f64;
    let (low, rest) = (at as usize, at.fract());
    let high = (low + 1).min(sorted.len() - 1);
    Some(sorted[low] + (sorted[high] - sorted[low]) * rest)
}

impl ValueRange {
    /// The position of a number in the range: 0 at the lower end, 1 at the upper. NaN where there
    /// is none; 0.5 if the range is one number.
    pub fn position(&self, value: f64) -> f64 {
        let scale = |x: f64| if self.log { libm::log(x) } else { x };
        let (low, high) = (scale(self.low), scale(self.high));
        if low == high {
            return if value.is_nan() { f64::NAN } else { 0.5 };
        }
        (scale(value) - low) / (high - low)
    }

    /// Which ends some of the values are beyond: the lower and the upper end of the map.
    pub fn exceeded_by(&self, values: &[f64], counts: impl Fn(f64) -> bool + Sync) -> [bool; 2] {
        let positions =
            || values.par_iter().filter(|value| counts(**value)).map(|value| self.position(*value));
        [positions().any(|position| position < 0.0), positions().any(|position| position > 1.0)]
    }

    /// The number at a position: the inverse of [`Self::position`].
    pub fn value(&self, position: f64) -> f64 {
        match self.log {
            true => self.low * libm::pow(self.high / self.low, position),
            false => self.low + (self.high - self.low) * position,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_numbers_or_percentiles() {
        let parsed = RangeChoice::parse("-1.5, p99").unwrap();
        assert_eq!(parsed.low, RangeEnd::Number(-1.5));
        assert_eq!(parsed.high, RangeEnd::Percentile(99.0));
        for wrong in ["", "1", "1,", "a,b", "p101,2", "p-1,3", "nan,1", "1,2,3", "inf,1"] {
            assert_eq!(RangeChoice::parse(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn percentiles_leave_outliers_out() {
        let mut values: Vec<f64> = (0..=1000).map(f64::from).collect();
        values.extend([f64::NAN, f64::INFINITY]);
        let range = |text: &str| {
            let range = RangeChoice::parse(text).unwrap().resolve(&values, false).unwrap();
            [range.low, range.high]
        };
        assert_eq!(range("p1,p99"), [10.0, 990.0]);
        assert_eq!(range("p50,7"), [500.0, 7.0]);
        let all = RangeChoice::default().resolve(&values, false).unwrap();
        assert_eq!([all.low, all.high], [0.0, 1000.0]);
        assert_eq!(RangeChoice::default().resolve(&[f64::NAN], false), None);
        assert_eq!(RangeChoice::default().resolve(&[], false), None);
    }

    #[test]
    fn logarithms_take_positive_numbers() {
        let range = RangeChoice::default().resolve(&[-5.0, 0.0, 0.01, 100.0], true).unwrap();
        assert_eq!([range.low, range.high], [0.01, 100.0]);
        assert!((range.position(1.0) - 0.5).abs() < 1e-12);
        assert!((range.value(0.5) - 1.0).abs() < 1e-12);
        assert!(range.position(-1.0).is_nan());
        assert_eq!(RangeChoice::parse("0,1").unwrap().resolve(&[1.0], true), None);
    }

    #[test]
    fn values_beyond_the_ends_are_found() {
        let range = ValueRange { low: 10.0, high: 0.0, log: false };
        let all = |_| true;
        assert_eq!(range.exceeded_by(&[0.0, 5.0, 10.0, f64::NAN], all), [false, false]);
        assert_eq!(range.exceeded_by(&[-1.0, 5.0], all), [false, true]);
        assert_eq!(range.exceeded_by(&[11.0, -f64::INFINITY], f64::is_finite), [true, false]);
        let log = ValueRange { low: 0.1, high: 10.0, log: true };
        assert_eq!(log.exceeded_by(&[0.1, 10.0], all), [false, false]);
        assert_eq!(log.exceeded_by(&[0.01, 10.1], all), [true, true]);
    }

    #[test]
    fn positions_are_linear_and_may_be_reversed() {
        let range = ValueRange { low: 10.0, high: 0.0, log: false };
        assert_eq!([10.0, 5.0, 0.0].map(|x| range.position(x)), [0.0, 0.5, 1.0]);
        assert_eq!(range.value(0.25), 7.5);
        let one = ValueRange { low: 3.0, high: 3.0, log: false };
        assert_eq!(one.position(3.0), 0.5);
    }
}
