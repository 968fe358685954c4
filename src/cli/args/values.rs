//! Parsers for option values, with their error messages.

use std::ops::{Range, RangeInclusive};
use std::time::Duration;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use crate::cli::system::MAX_THREADS;
use crate::math::Rect;
use crate::names::Named;
use crate::scene::Override;

/// An image size, written `WxH`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    pub width: u32,
    pub height: u32,
}

impl Size {
    /// Returns the overrides that `--size` stands for.
    pub fn overrides(self) -> [Override; 2] {
        let Self { width, height } = self;
        let size = format!("{width}x{height}");
        [("image.width", width), ("image.height", height)].map(|(key, pixels)| {
            Override::new(key, pixels.to_string()).with_option(["--size", &size])
        })
    }
}

/// Parses one of these names into the value it stands for.
pub fn one_of<T: Clone + Send + Sync + 'static>(
    choices: impl IntoIterator<Item = (PossibleValue, T)>,
) -> impl TypedValueParser<Value = T> {
    let (names, values): (Vec<PossibleValue>, Vec<T>) = choices.into_iter().unzip();
    PossibleValuesParser::new(names.clone()).try_map(move |given| {
        let place = names.iter().position(|name| name.matches(&given, false));
        place.map(|place| values[place].clone()).ok_or("unknown name")
    })
}

/// Lists yes and no.
pub fn yes_or_no() -> [(PossibleValue, bool); 2] {
    let named = |name, also: [&'static str; 2]| PossibleValue::new(name).aliases(also);
    [(named("true", ["yes", "on"]), true), (named("false", ["no", "off"]), false)]
}

/// Lists the names of all variants.
pub fn named<T: Named>() -> impl Iterator<Item = (PossibleValue, T)> {
    T::NAMES.iter().map(|&(name, value)| (PossibleValue::new(name), value))
}

/// Lists the names of all variants, each with its description in `--help`.
pub fn explained<T: Named>(
    meaning: fn(T) -> &'static str,
) -> impl Iterator<Item = (PossibleValue, T)> {
    named().map(move |(name, value)| (name.help(meaning(value)), value))
}

/// Parses any integer. The scene checks the range.
pub fn whole(text: &str) -> Result<i128, String> {
    text.parse().map_err(|_| "expected a whole number".to_owned())
}

pub fn size(text: &str) -> Result<Size, String> {
    let read = || {
        let (width, height) = text.split_once(['x', 'X'])?;
        Some(Size { width: width.parse().ok()?, height: height.parse().ok()? })
    };
    read().ok_or_else(|| "expected WIDTHxHEIGHT, such as 640x480".to_owned())
}

/// Parses a number of threads. More threads than any machine has cores are a typing error, and
/// would not start.
pub fn threads() -> impl TypedValueParser<Value = usize> {
    clap::value_parser!(u16).range(1..=i64::from(MAX_THREADS)).map(usize::from)
}

/// Parses a seed, with the range of the scene's seed.
pub fn seed() -> impl TypedValueParser<Value = u64> {
    clap::value_parser!(i64).range(0..=i64::MAX).map(i64::unsigned_abs)
}

/// Parses a duration: `90s`, `5m`, `1.5h`, or plain seconds.
pub fn duration(text: &str) -> Result<Duration, String> {
    let units = [("ms", 1e-3), ("s", 1.0), ("m", 60.0), ("h", 3600.0)];
    let with_unit = |(unit, seconds): (&str, f64)| {
        Some(text.strip_suffix(unit)?.trim_end().parse::<f64>().ok()? * seconds)
    };
    let seconds = units.into_iter().find_map(with_unit).or_else(|| text.parse().ok());
    match seconds {
        Some(seconds) if (0.001..1e9).contains(&seconds) => Ok(Duration::from_secs_f64(seconds)),
        _ => Err("expected a time, such as 30s, 5m or 1h".to_owned()),
    }
}

/// Parses an exposure in stops.
pub fn exposure(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(stops) if (-100.0..=100.0).contains(&stops) => Ok(stops),
        _ => Err("expected a number of stops from -100 to 100".to_owned()),
    }
}

/// Parses a pixel rectangle `X0,Y0,X1,Y1`.
pub fn window(text: &str) -> Result<Rect, String> {
    let corners = || {
        let corners: Option<Vec<u32>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
        let [x, y, right, bottom] = corners?.try_into().ok()?;
        let (width, height) = (right.checked_sub(x)?, bottom.checked_sub(y)?);
        (width > 0 && height > 0).then_some(Rect { x, y, width, height })
    };
    corners().ok_or_else(|| {
        "expected X0,Y0,X1,Y1, columns X0 to X1 - 1 and rows Y0 to Y1 - 1, such as 0,0,320,240"
            .to_owned()
    })
}

/// Parses a sample range `A..B`.
pub fn samples(text: &str) -> Result<Range<u32>, String> {
    let range = || {
        let (first, end) = text.split_once("..")?;
        Some(first.trim().parse().ok()?..end.trim().parse().ok()?)
    };
    let range: Option<Range<u32>> = range();
    range
        .filter(|range| !range.is_empty())
        .ok_or_else(|| "expected A..B, samples A to B - 1, such as 0..64".to_owned())
}

/// Parses a count: an integer, optionally with an exponent.
pub fn count(text: &str) -> Result<u64, String> {
    let whole = || text.parse::<u64>().ok();
    let with_exponent = || {
        let number = text.parse::<f64>().ok()?;
        // Above 2^53, not every integer is representable as f64.
        ((0.0..9e15).contains(&number) && number.fract() == 0.0).then_some(number as u64)
    };
    let refused = "expected a whole number, such as 250000 or 1e6";
    whole().or_else(with_exponent).ok_or_else(|| refused.to_owned())
}

/// Parses a number of bytes with a unit.
pub fn bytes(text: &str) -> Result<u64, String> {
    const UNITS: [(&str, f64); 9] = [
        ("KiB", 1024.0),
        ("MiB", 1_048_576.0),
        ("GiB", 1_073_741_824.0),
        ("TiB", 1_099_511_627_776.0),
        ("kB", 1e3),
        ("MB", 1e6),
        ("GB", 1e9),
        ("TB", 1e12),
        ("B", 1.0),
    ];
    let refused = || "expected a size with its unit, such as 8GiB or 500MB".to_owned();
    let (number, unit) = UNITS
        .iter()
        .find_map(|(name, unit)| Some((text.strip_suffix(name)?, unit)))
        .ok_or_else(refused)?;
    let number: f64 = number.trim().parse().map_err(|_| refused())?;
    let size = number * unit;
    if (1.0..1e18).contains(&size) { Ok(size as u64) } else { Err(refused()) }
}

pub fn noise(text: &str) -> Result<f64, String> {
    share(text, 1e-6..=0.5)
        .ok_or_else(|| "expected a fraction up to 50%, such as 1% or 0.01".to_owned())
}

pub fn confidence(text: &str) -> Result<f64, String> {
    share(text, 0.5..=0.9999)
        .ok_or_else(|| "expected a fraction from 50% to 99.99%, such as 95% or 0.95".to_owned())
}

/// Parses a fraction: `1%` or `0.01`.
fn share(text: &str, allowed: RangeInclusive<f64>) -> Option<f64> {
    let share = match text.trim().strip_suffix('%') {
        Some(percent) => percent.trim_end().parse::<f64>().ok()? / 100.0,
        None => text.trim().parse().ok()?,
    };
    allowed.contains(&share).then_some(share)
}

pub fn positive(text: &str) -> Result<f64, String> {
    number(text, |value| value > 0.0).ok_or_else(|| "expected a number above 0".to_owned())
}

pub fn positive_or_zero(text: &str) -> Result<f64, String> {
    number(text, |value| value >= 0.0).ok_or_else(|| "expected a number not below 0".to_owned())
}

fn number(text: &str, is_allowed: impl Fn(f64) -> bool) -> Option<f64> {
    text.parse().ok().filter(|&value: &f64| value.is_finite() && is_allowed(value))
}

pub fn pixel(text: &str) -> Result<(u32, u32), String> {
    let read = || {
        let (x, y) = text.split_once(',')?;
        Some((x.trim().parse().ok()?, y.trim().parse().ok()?))
    };
    read().ok_or_else(|| "expected X,Y, such as 320,240".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_units() {
        for (text, seconds) in
            [("30s", 30.0), ("1.5h", 5400.0), ("250ms", 0.25), ("2m", 120.0), ("7", 7.0)]
        {
            assert_eq!(duration(text), Ok(Duration::from_secs_f64(seconds)), "{text}");
        }
        for text in ["", "s", "-3s", "0", "nan", "1e99h", "3 days"] {
            assert!(duration(text).is_err(), "{text}");
        }
    }

    #[test]
    fn windows_have_two_corners() {
        assert_eq!(window("3,4,10,6"), Ok(Rect { x: 3, y: 4, width: 7, height: 2 }));
        for text in ["", "1,2,3", "0,0,0,5", "5,0,4,9", "-1,0,4,9", "0,0,4,9,9", "a,b,c,d"] {
            assert!(window(text).is_err(), "{text}");
        }
    }

    #[test]
    fn ranges_have_two_ends() {
        assert_eq!(samples("16..48"), Ok(16..48));
        for text in ["", "16", "48..16", "16..16", "-1..3", "a..b", "0..=3", "0..99999999999"] {
            assert!(samples(text).is_err(), "{text}");
        }
    }

    #[test]
    fn counts_may_have_exponents_but_no_fractions() {
        assert_eq!(count("1e6"), Ok(1_000_000));
        assert_eq!(count("250000"), Ok(250_000));
        assert_eq!(count("2.5e3"), Ok(2500));
        assert_eq!(count("4294967295"), Ok(4_294_967_295));
        for wrong in ["-1", "1.5", "1e40", "nan", "many", ""] {
            assert!(count(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn sizes_have_a_number_and_a_unit() {
        assert_eq!(bytes("8GiB"), Ok(8 << 30));
        assert_eq!(bytes("1.5 MiB"), Ok(3 << 19));
        assert_eq!(bytes("500MB"), Ok(500_000_000));
        assert_eq!(bytes("42B"), Ok(42));
        for wrong in ["8", "GiB", "-1GiB", "0B", "1e30GiB", "nanGB", "8 gigabytes"] {
            assert!(bytes(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn shares_are_percentages_or_fractions() {
        assert_eq!(noise("1%"), Ok(0.01));
        assert_eq!(noise("0.01"), Ok(0.01));
        assert_eq!(confidence("99.5 %"), Ok(0.995));
        for wrong in ["1", "0", "0%", "-1%", "60%", "nan", "NaN%", "", "%", "1 percent"] {
            assert!(noise(wrong).is_err(), "{wrong}");
        }
        assert!(confidence("100%").is_err() && confidence("5%").is_err());
    }
}
