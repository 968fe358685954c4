//! Tick marks as matplotlib's `AutoLocator` places them: multiples of 1, 2, 2.5 or 5 times a power
//! of ten, at most as many as fit.

/// Tick marks of an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Ticks {
    /// The numbers at the ticks, in ascending order.
    pub values: Vec<f64>,
    /// Distance between ticks; 0 on a logarithmic axis.
    pub step: f64,
}

/// Steps of an axis, times a power of ten.
const STEPS: [f64; 5] = [1.0, 2.0, 2.5, 5.0, 10.0];

impl Ticks {
    /// Ticks of a linear axis, with at most `max_intervals` between them.
    pub fn linear(low: f64, high: f64, max_intervals: usize) -> Self {
        let (low, high) = (low.min(high), low.max(high));
        let span = high - low;
        // Also true for numbers that are not finite.
        if !(span > 0.0 && span.is_finite()) {
            return Self { values: vec![low], step: 0.0 };
        }
        let raw = span / max_intervals.max(1) as f64;
        let power = libm::pow(10.0, libm::floor(libm::log10(raw)));
        let mut steps = STEPS.iter().map(|step| step * power);
        let step = steps.find(|step| *step >= raw * (1.0 - 1e-10)).unwrap_or(10.0 * power);
        let slack = 1e-10 * span / step;
        let first = (low / step - slack).ceil() as i64;
        let last = (high / step + slack).floor() as i64;
        let values = (first..=last).take(1000).map(|index| index as f64 * step).collect();
        Self { values, step }
    }

    /// Ticks of a logarithmic axis from `low` to `high`, both positive: powers of ten, or where
    /// there are fewer than three, also 2 and 5 times as much.
    pub fn logarithmic(low: f64, high: f64, max_intervals: usize) -> Self {
        let (low, high) = (low.min(high), low.max(high));
        let exponents =
            [low, high].map(|x| libm::log10(x).clamp(-400.0, 400.0)).map(|x| x.floor() as i32);
        let is_within = |x: &f64| *x >= low * (1.0 - 1e-10) && *x <= high * (1.0 + 1e-10);
        let every = |stride: usize, factors: &[f64]| -> Vec<f64> {
            let powers = (exponents[0]..=exponents[1]).filter(|e| e.rem_euclid(stride as i32) == 0);
            let values = powers.flat_map(|e| {
                let power = libm::pow(10.0, f64::from(e));
                factors.iter().map(move |factor| factor * power).collect::<Vec<_>>()
            });
            values.filter(is_within).collect()
        };
        let decades = (exponents[1] - exponents[0]) as usize;
        let stride = decades.div_ceil(max_intervals.max(1)).max(1);
        let mut values = every(stride, &[1.0]);
        if values.len() < 3 {
            values = every(1, &[1.0, 2.0, 5.0]);
        }
        if values.len() < 2 {
            return Self::linear(low, high, max_intervals);
        }
        Self { values, step: 0.0 }
    }

    /// The labels of all ticks, with equally many decimals.
    pub fn labels(&self) -> Vec<String> {
        let largest = self.values.iter().fold(0.0f64, |most, x| most.max(x.abs()));
        let is_plain = self.step > 0.0 && largest < 1e6 && self.step >= 1e-4;
        if !is_plain {
            return self.values.iter().map(|value| label(*value)).collect();
        }
        let decimals = (0..8).find(|&decimals| {
            let shifted = self.step * libm::pow(10.0, f64::from(decimals));
            (shifted - shifted.round()).abs() < 1e-6 * shifted
        });
        let decimals = decimals.unwrap_or(8) as usize;
        self.values.iter().map(|value| with_minus(format!("{:.decimals$}", value + 0.0))).collect()
    }
}

/// A number as a label: plain, or with a power of ten where that is shorter.
pub fn label(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || (1e-3..1e5).contains(&size) {
        let shown = format!("{value:.6}");
        let short = if shown.contains('.') { shown.trim_end_matches('0') } else { &shown };
        return with_minus(short.trim_end_matches('.').to_owned());
    }
    let shown = format!("{value:e}");
    let (mantissa, exponent) = shown.split_once('e').unwrap_or((&shown, "0"));
    let mantissa: f64 = mantissa.parse().unwrap_or(1.0);
    let mantissa = format!("{:.3}", mantissa);
    let mantissa = mantissa.trim_end_matches('0').trim_end_matches('.');
    let power: String = exponent.chars().map(superscript).collect();
    with_minus(match mantissa {
        "1" => format!("10{power}"),
        "-1" => format!("-10{power}"),
        _ => format!("{mantissa}×10{power}"),
    })
}

fn superscript(c: char) -> char {
    match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => {
            let value = digit.to_digit(10).unwrap_or(0);
            char::from_u32('⁰' as u32 + value).unwrap_or(digit)
        }
    }
}

/// Replaces a hyphen at the beginning by a minus sign.
fn with_minus(text: String) -> String {
    match text.strip_prefix('-') {
        Some(rest) => format!("\u{2212}{rest}"),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As `matplotlib.ticker.AutoLocator().tick_values` within the range, for nine intervals.
    #[test]
    fn steps_are_round() {
        for (low, high, expected) in [
            (0.0, 1.0, vec!["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]),
            (
                -3.41,
                -3.19,
                vec![
                    "−3.400", "−3.375", "−3.350", "−3.325", "−3.300", "−3.275", "−3.250", "−3.225",
                    "−3.200",
                ],
            ),
            (0.0, 87.0, vec!["0", "10", "20", "30", "40", "50", "60", "70", "80"]),
            (
                -1.0,
                1.0,
                vec!["−1.00", "−0.75", "−0.50", "−0.25", "0.00", "0.25", "0.50", "0.75", "1.00"],
            ),
        ] {
            let intervals = if low == 0.0 && high == 1.0 { 5 } else { 9 };
            assert_eq!(Ticks::linear(low, high, intervals).labels(), expected, "{low} {high}");
        }
    }

    #[test]
    fn a_range_of_one_number_and_wild_ranges_have_ticks() {
        assert_eq!(Ticks::linear(3.0, 3.0, 5).values, [3.0]);
        assert_eq!(Ticks::linear(5.0, 0.0, 5).values, Ticks::linear(0.0, 5.0, 5).values);
        for (low, high) in [(-1e300, 1e300), (0.0, 1e-300), (1e15, 1e15 + 1.0), (f64::NAN, 1.0)] {
            let ticks = Ticks::linear(low, high, 6);
            assert!((1..=8).contains(&ticks.values.len()), "{low} {high}: {ticks:?}");
            assert_eq!(ticks.labels().len(), ticks.values.len());
        }
    }

    #[test]
    fn logarithmic_ticks_are_powers_of_ten() {
        assert_eq!(Ticks::logarithmic(0.01, 100.0, 9).labels(), ["0.01", "0.1", "1", "10", "100"]);
        let few = Ticks::logarithmic(1.5, 60.0, 9);
        assert_eq!(few.labels(), ["2", "5", "10", "20", "50"]);
        assert_eq!(Ticks::logarithmic(1e-10, 1e10, 5).labels().len(), 5);
    }

    #[test]
    fn labels_are_short() {
        for (value, expected) in [
            (0.0, "0"),
            (0.25, "0.25"),
            (-12.5, "−12.5"),
            (1e7, "10⁷"),
            (-2.5e-9, "−2.5×10⁻⁹"),
            (123_456.0, "1.235×10⁵"),
            (99_999.0, "99999"),
        ] {
            assert_eq!(label(value), expected);
        }
    }
}
