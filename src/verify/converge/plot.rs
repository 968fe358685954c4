//! The plot of [`super`] as SVG: error against samples on the left, against seconds on the right, both
//! in log-log, with the interval of every point and the fitted lines.

use crate::draw::{Axes, Course, Line, Mark, Panel, Panels, Value, panels};
use crate::error::{Error, Result};

use super::super::statistics::Estimate;
use super::{Axis, Fit, Metric, Series};

/// What is written above the plots.
pub struct Heading<'a> {
    /// What was rendered.
    pub title: &'a str,
    /// What it was held against.
    pub subtitle: &'a str,
}

/// Draws the series.
///
/// # Errors
/// When nothing can be drawn: no error is positive and finite.
pub fn svg(series: &[Series], metric: Metric, heading: &Heading<'_>) -> Result<String> {
    let of = |axis| panel(series, metric, axis);
    let (Some(left), Some(right)) = (of(Axis::Samples), of(Axis::Seconds)) else {
        return Err(Error::input("there is no error above the reference's own noise to plot"));
    };
    let slopes = |one: &Series| {
        [Axis::Samples, Axis::Seconds].map(|axis| match one.fit(metric, axis) {
            Some(Fit { slope, .. }) => format!("{:.3} ± {:.3}", slope.mean, slope.margin(0.95)),
            None => "—".to_owned(),
        })
    };
    panels(&Panels {
        title: heading.title,
        subtitle: heading.subtitle,
        panels: [left, right],
        heads: ["slope against samples (95 %)", "slope against seconds (95 %)"],
        rows: series.iter().map(slopes).collect(),
    })
}

/// One of the two plots; `None` where there is nothing to draw.
fn panel(series: &[Series], metric: Metric, axis: Axis) -> Option<Panel> {
    let line = |(color, one): (usize, &Series)| Line {
        name: one.name.clone(),
        marks: marks(one, metric, axis),
        course: Course::Fitted(fitted(one, metric, axis)),
        color,
    };
    let lines: Vec<Line> = series.iter().enumerate().map(line).collect();
    let marks = lines.iter().flat_map(|line| &line.marks);
    // Intervals are shown whole, but for those that come near 0, which no such axis has.
    let shown = |value: Value| [value.low.max(value.middle / 4.0), value.middle, value.high];
    let x_name = match axis {
        Axis::Samples => "samples per pixel",
        Axis::Seconds => "seconds",
    };
    let names = [x_name, metric.name()];
    let xs = marks.clone().flat_map(|mark| shown(mark.x));
    let axes = Axes::around(names, xs, marks.clone().flat_map(|mark| shown(mark.y)))?;
    Some(Panel { axes, lines })
}

fn marks(series: &Series, metric: Metric, axis: Axis) -> Vec<Mark> {
    let with_interval = |estimate: Estimate| {
        let (middle, margin) = (estimate.mean, estimate.margin(0.95));
        Value { middle, low: middle - margin, high: middle + margin }
    };
    let mark = |point: &super::Point| Mark {
        x: match axis {
            Axis::Samples => Value::exact(f64::from(point.samples)),
            Axis::Seconds => with_interval(point.seconds()),
        },
        y: with_interval(point.error(metric)),
    };
    let is_shown = |Mark { x, y }: &Mark| x.middle > 0.0 && y.middle > 0.0 && y.high.is_finite();
    series.points.iter().map(mark).filter(is_shown).collect()
}

/// The ends of the fitted line.
fn fitted(series: &Series, metric: Metric, axis: Axis) -> Option<[(f64, f64); 2]> {
    let Fit { slope, intercept } = series.fit(metric, axis)?;
    let y = |x: f64| libm::exp10(intercept + slope.mean * libm::log10(x));
    let xs = series.points.iter().map(|point| point.place(axis));
    let (low, high) = (xs.clone().fold(f64::INFINITY, f64::min), xs.fold(0.0, f64::max));
    Some([(low, y(low)), (high, y(high))])
}

#[cfg(test)]
mod tests {
    use super::super::{Point, Run};
    use super::*;

    fn series(name: &str, factor: f64) -> Series {
        let point = |samples: u32| {
            let run = |seed: u32| {
                let mse = factor * (1.0 + 0.1 * f64::from(seed)) / f64::from(samples);
                Run { mse, relmse: mse, seconds: 1e-3 * f64::from(samples) }
            };
            Point { samples, runs: (0..4).map(run).collect() }
        };
        Series { name: name.into(), points: [1, 10, 100].map(point).into() }
    }

    #[test]
    fn the_plot_names_every_series_and_its_slope_and_escapes_names() {
        let all = [series("path", 1.0), series("a < b", 10.0)];
        let heading = Heading { title: "a title", subtitle: "against \"that\"" };
        let svg = svg(&all, Metric::Rmse, &heading).unwrap();
        assert!(svg.starts_with("<svg width=\"1120\""), "{}", &svg[..80]);
        for text in ["path", "a &lt; b", "-0.500 ± 0.000", "samples per pixel", "seconds"] {
            assert!(svg.contains(text), "{text}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn nothing_to_draw_is_an_error() {
        let heading = Heading { title: "", subtitle: "" };
        assert!(svg(&[series("path", -1.0)], Metric::Rmse, &heading).is_err());
    }
}
