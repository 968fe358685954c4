//! The values of a picture's record in words: short, without JSON, errors as percent.

use serde_json::Value;

use crate::draw::text::{percent, si};
use crate::job::diff::format_json;
use crate::job::{MergedSamples, NoiseTarget, SampleRange, TileSampleCounts, WindowSamples};
use crate::overlay::{LegendSpec, OverlaySpec};

/// Longer lists are not written out.
const MAX_LIST_LENGTH: usize = 100;

/// More lines of one text are not shown.
const MAX_LINES: usize = 120;

/// A noise target: `5.00 % for 95 % of the values`.
pub(super) fn noise(target: &NoiseTarget) -> String {
    // A confidence such as 99.9 % keeps its digits.
    let share = rounded(100.0 * target.confidence);
    match target.display {
        None => format!("{} for {share} % of the values", percent(target.error)),
        Some(_) => {
            format!("{} shown, for {share} % of the values", target.format_error(target.error))
        }
    }
}

/// Digits without those that only the binary form has.
fn rounded(value: f64) -> f64 {
    (1e6 * value).round() / 1e6
}

/// A number with five digits.
fn five_digits(value: f64) -> f64 {
    format!("{value:.4e}").parse().unwrap_or(value)
}

/// The error that a render reached, for the fraction of the values of its target.
pub(super) fn error(error: f64, target: &NoiseTarget) -> String {
    let share = rounded(100.0 * target.confidence);
    match target.display {
        None => format!("{} of the brightness, for {share} % of the values", percent(error)),
        Some(_) => format!("{} shown, for {share} % of the values", target.format_error(error)),
    }
}

/// Rays: `12.3 million`.
pub(super) fn rays(rays: u64) -> String {
    let text = si(rays as f64);
    let words = [(" T", " trillion"), (" G", " billion"), (" M", " million"), (" k", " thousand")];
    match words
        .into_iter()
        .find_map(|(unit, word)| Some(text.strip_suffix(unit)?.to_owned() + word))
    {
        Some(text) => text,
        None => rays.to_string(),
    }
}

/// A time: `0.52`, as the name of the record says in seconds, with hours and minutes if it has any.
pub(super) fn seconds(seconds: f64) -> String {
    let digits = if seconds < 10.0 { 2 } else { 0 };
    let plain = format!("{seconds:.digits$}");
    let whole = seconds.round().max(0.0) as u64;
    match (whole / 3600, whole / 60 % 60) {
        (0, 0) => plain,
        (0, minutes) => format!("{plain} ({minutes} min {} s)", whole % 60),
        (hours, minutes) => format!("{plain} ({hours} h {minutes} min)"),
    }
}

/// Samples per tile: how many tiles differ, and by how much.
pub(super) fn counts(counts: &TileSampleCounts) -> String {
    let counts = &counts.0;
    let mean = counts.iter().map(|&count| f64::from(count)).sum::<f64>() / counts.len() as f64;
    let ends = (counts.iter().min(), counts.iter().max());
    let (Some(min), Some(max)) = ends else { return "the same in all tiles".to_owned() };
    let tiles = counts.len();
    format!("{min} to {max} in {tiles} tiles of 16 x 4 pixels, {mean:.1} on average")
}

/// The parts of a merged picture, one a line.
pub(super) fn parts(parts: &MergedSamples) -> String {
    let line = |WindowSamples { window, samples, counts: each }: &WindowSamples| {
        let SampleRange { first, min_count, max_count } = *samples;
        let range = format!("pixels {window}: samples {first} to {}", first + max_count);
        match each.is_uniform() || min_count == max_count {
            true => format!("{range}\n"),
            false => format!("{range}, {}\n", counts(each)),
        }
    };
    parts.0.iter().map(line).collect()
}

/// What is drawn over a picture.
pub(super) fn overlay(overlay: &OverlaySpec) -> String {
    let titled = |what: &str, title: &str| match title {
        "" => what.to_owned(),
        title => format!("{what} `{title}`"),
    };
    let legend = match &overlay.legend {
        LegendSpec::Nothing => None,
        LegendSpec::Bar { title, map, ends: [low, high], log, exceeded } => {
            let log = if *log { ", logarithmic" } else { "" };
            let beyond = match exceeded {
                [false, false] => "",
                [true, false] => ", numbers beyond the lower end",
                [false, true] => ", numbers beyond the upper end",
                [true, true] => ", numbers beyond both ends",
            };
            let (bar, map) = (titled("colour bar", title), map.name());
            let [low, high] = [*low, *high].map(five_digits);
            Some(format!("{bar} ({map} from {low} to {high}{log}{beyond})"))
        }
        LegendSpec::Categories { title, entries } => {
            Some(format!("{} of {} entries", titled("legend", title), entries.len()))
        }
    };
    let bar = overlay.scale_bar.as_ref().map(|_| "scale bar".to_owned());
    let axes = overlay.tripod.map(|_| "axes".to_owned());
    let drawn: Vec<String> = [legend, bar, axes].into_iter().flatten().collect();
    drawn.join(", ")
}

/// A text of many lines, without most of a very long one.
pub(super) fn shortened(text: &str) -> String {
    let count = text.lines().count();
    if count <= MAX_LINES {
        return text.to_owned();
    }
    let shown: Vec<&str> = text.lines().take(MAX_LINES).collect();
    format!("{}\n... and {} more lines\n", shown.join("\n"), count - MAX_LINES)
}

/// The texts of a list.
pub(super) fn join_list(value: &Value) -> Option<String> {
    let texts: Option<Vec<&str>> = value.as_array()?.iter().map(Value::as_str).collect();
    Some(texts?.join(","))
}

/// One line per value: `image.width = 16`.
pub(super) fn line_by_line(value: &Value) -> String {
    let mut lines = String::new();
    add_lines("", value, &mut lines);
    lines
}

fn add_lines(path: &str, value: &Value, lines: &mut String) {
    let inner = |key: &str| match path {
        "" => key.to_owned(),
        _ => format!("{path}.{key}"),
    };
    match value {
        Value::Null => {}
        Value::Object(fields) => {
            fields.iter().for_each(|(name, value)| add_lines(&inner(name), value, lines));
        }
        Value::Array(list) if list.len() > MAX_LIST_LENGTH => {
            *lines += &format!("{path} = a list of {}\n", list.len());
        }
        Value::Array(list) if list.iter().any(Value::is_object) => {
            let numbered = list.iter().enumerate();
            numbered.for_each(|(index, value)| add_lines(&inner(&index.to_string()), value, lines));
        }
        Value::Array(list) if list.is_empty() => {}
        other => *lines += &format!("{path} = {}\n", format_json(other)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::appearance::ColorMap;
    use crate::math::Rect;

    #[test]
    fn errors_are_percentages() {
        assert_eq!(noise(&NoiseTarget::new(0.05)), "5.00 % for 95 % of the values");
        let strict = NoiseTarget { error: 0.002, confidence: 0.999, display: None };
        assert_eq!(noise(&strict), "0.20 % for 99.9 % of the values");
        assert_eq!(
            error(0.0493, &NoiseTarget::new(0.1)),
            "4.93 % of the brightness, for 95 % of the values"
        );
    }

    #[test]
    fn long_counts_are_one_line() {
        let many: Vec<u32> = (0..5000).map(|tile| 64 + 16 * (tile % 3)).collect();
        let text = counts(&TileSampleCounts(many.clone()));
        assert_eq!(text, "64 to 96 in 5000 tiles of 16 x 4 pixels, 80.0 on average");
        let window = Rect { x: 0, y: 2, width: 9, height: 12 };
        let samples = SampleRange { first: 32, min_count: 64, max_count: 96 };
        let part = WindowSamples { window, samples, counts: TileSampleCounts(many) };
        let text = parts(&MergedSamples(vec![part]));
        assert!(
            text.starts_with("pixels 0,2,9,14: samples 32 to 128, 64 to 96 in 5000 tiles"),
            "{text}"
        );
    }

    #[test]
    fn times_and_rays_are_read_at_a_glance() {
        assert_eq!(
            [0.123, 42.4, 75.0, 7500.0].map(seconds),
            ["0.12", "42", "75 (1 min 15 s)", "7500 (2 h 5 min)"]
        );
        assert_eq!([999, 12_345_678].map(rays), ["999", "12.3 million"]);
    }

    #[test]
    fn what_is_drawn_over_a_picture_is_named() {
        let legend = LegendSpec::Bar {
            title: "energy".to_owned(),
            map: ColorMap::Viridis,
            ends: [0.0, 2.500001],
            log: true,
            exceeded: [false, true],
        };
        let mut spec = OverlaySpec {
            size: [4, 4],
            font_pixels: 2.0,
            light_ink: false,
            legend,
            scale_bar: None,
            tripod: Some([[0.0; 2]; 3]),
        };
        let bar = "colour bar `energy` (viridis from 0 to 2.5, logarithmic, numbers beyond the \
                   upper end), axes";
        assert_eq!(overlay(&spec), bar);
        spec.legend = LegendSpec::Nothing;
        assert_eq!(overlay(&spec), "axes");
    }

    #[test]
    fn very_long_texts_are_cut() {
        let text = "a = 1\n".repeat(1000);
        let short = shortened(&text);
        assert!(short.ends_with("a = 1\n... and 880 more lines\n"), "{short}");
        assert_eq!(shortened("a\nb\n"), "a\nb\n");
    }
}
