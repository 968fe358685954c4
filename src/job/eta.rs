//! Estimates the remaining render time.
//!
//! Passes go over the whole picture and cost about the same, so the remaining samples take as long
//! as those already done. The rate is averaged over the whole run: a window of the last seconds
//! would follow the cheap and expensive regions of a single pass.

use std::ops::Range;
use std::time::Duration;

/// Upper limit of an estimate, in seconds.
const MAX_SECONDS: f64 = 1e9;

/// Progress of a render, from which the remaining time is estimated.
#[derive(Clone, Debug, PartialEq)]
pub struct Eta {
    /// Time since the render started or resumed.
    pub elapsed: Duration,
    /// Samples rendered in that time.
    pub samples: u64,
    /// Lower and upper bound of the samples left; they differ if the total is only an estimate.
    pub samples_left: Range<u64>,
}

impl Eta {
    /// Samples per second; 0 before the first sample.
    pub fn rate(&self) -> f64 {
        self.samples as f64 / self.elapsed.as_secs_f64().max(1e-9)
    }

    /// Lower and upper bound of the remaining time; `None` before the first sample.
    pub fn time_left(&self) -> Option<Range<Duration>> {
        let rate = self.rate();
        let time = |samples: u64| Duration::from_secs_f64((samples as f64 / rate).min(MAX_SECONDS));
        (self.samples > 0).then(|| time(self.samples_left.start)..time(self.samples_left.end))
    }
}

/// Samples expected within `time`, at the rate of `samples` per `elapsed`.
pub fn expected_samples(time: Duration, samples: u64, elapsed: Duration) -> u64 {
    (samples as f64 * time.as_secs_f64() / elapsed.as_secs_f64().max(1e-9)) as u64
}

/// Total number of samples when the time limit expires: `expected`, but at least `min_samples`, and
/// within `total`.
pub fn total_at_deadline(total: &Range<u64>, expected: u64, min_samples: u64) -> Range<u64> {
    let max_total = expected.max(min_samples);
    total.start.min(max_total)..total.end.min(max_total)
}

/// Formats a time range, as in `3 min` or `50 to 80 s`, with two digits in the unit that suits the
/// upper bound.
pub fn format_time_range(left: &Range<Duration>) -> String {
    let (unit, name) = [(86400.0, "d"), (3600.0, "h"), (60.0, "min"), (1.0, "s")]
        .into_iter()
        .find(|(unit, _)| left.end.as_secs_f64() >= 1.95 * unit)
        .unwrap_or((1.0, "s"));
    let [low, high] = [left.start, left.end].map(|time| format_number(time.as_secs_f64() / unit));
    if low == high { format!("{high} {name}") } else { format!("{low} to {high} {name}") }
}

/// Formats a number without decimals from ten on, otherwise with one decimal unless that is 0.
fn format_number(x: f64) -> String {
    if x >= 9.95 { format!("{x:.0}") } else { format!("{x:.1}").trim_end_matches(".0").to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn eta(elapsed: f64, samples: u64, left: u64) -> Eta {
        Eta { elapsed: Duration::from_secs_f64(elapsed), samples, samples_left: left..left }
    }

    #[test]
    fn a_range_is_told_in_the_unit_of_its_end() {
        let text = |low: f64, high: f64| {
            format_time_range(&(Duration::from_secs_f64(low)..Duration::from_secs_f64(high)))
        };
        let ranges = [(0.0, 0.0), (3.0, 3.0), (12.4, 118.0), (50.0, 150.0), (9e3, 9e3), (1e5, 1e6)];
        assert_eq!(
            ranges.map(|(low, high)| text(low, high)),
            ["0 s", "3 s", "0.2 to 2 min", "0.8 to 2.5 min", "2.5 h", "1.2 to 12 d"]
        );
    }

    /// Recorded processor time in seconds and samples done: the nine-sphere box in three passes,
    /// and a sky above a ground in a single pass.
    #[rustfmt::skip]
    const TRACES: [&[(f64, u64)]; 2] = [
        &[
            (0.14, 45_056), (0.28, 91_136), (0.42, 138_240), (0.55, 182_272), (0.69, 227_328),
            (0.83, 274_432), (0.96, 318_464), (1.10, 362_496), (1.24, 407_552), (1.38, 454_656),
            (1.52, 501_760), (1.65, 547_840), (1.79, 595_968), (1.93, 640_000), (2.07, 685_056),
            (2.20, 733_184), (2.34, 779_264), (2.48, 828_416), (2.62, 876_544), (2.75, 921_600),
        ],
        &[
            (0.08, 51_200), (0.16, 115_712), (0.23, 177_152), (0.31, 241_664), (0.39, 301_056),
            (0.46, 361_472), (0.54, 427_008), (0.61, 488_448), (0.69, 548_864), (0.77, 609_280),
            (0.84, 672_768), (0.92, 730_112), (0.99, 792_576), (1.07, 854_016), (1.15, 912_384),
            (1.23, 976_896), (1.30, 1_039_360), (1.38, 1_101_824), (1.45, 1_165_312),
            (1.53, 1_228_800),
        ],
    ];

    #[test]
    fn the_time_left_of_renders_as_they_went_is_right_at_half_way() {
        for trace in TRACES {
            let (end, total) = trace[trace.len() - 1];
            for &(at, samples) in &trace[trace.len() / 2 - 2..trace.len() / 2 + 2] {
                let left = eta(at, samples, total - samples).time_left().unwrap().start;
                let ratio = left.as_secs_f64() / (end - at);
                assert!((ratio - 1.0).abs() < 0.1, "{ratio} at {at} of {end}");
            }
        }
    }

    #[test]
    fn a_time_that_is_up_does_not_end_a_render_before_its_first_block() {
        let endless = u64::MAX..u64::MAX;
        // The time is up after 300 of 1000 required samples: the rest takes as long as it takes.
        let total = total_at_deadline(&endless, 300, 1000);
        assert_eq!(total, 1000..1000);
        let left = eta(3.0, 300, total.end - 300).time_left().unwrap();
        assert_eq!(left, Duration::from_secs(7)..Duration::from_secs(7));
        assert_eq!(total_at_deadline(&endless, 5000, 1000), 5000..5000);
        assert_eq!(total_at_deadline(&(2000..6000), 5000, 1000), 2000..5000);
    }

    #[test]
    fn nothing_is_told_before_the_first_sample() {
        assert_eq!(eta(3.0, 0, 100).time_left(), None);
        let left = eta(2.0, 100, 300).time_left().unwrap();
        assert_eq!(left, Duration::from_secs(6)..Duration::from_secs(6));
    }
}
