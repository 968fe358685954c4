//! Draws the SVG plot: error against samples on the left and against seconds on the right, both in
//! log-log, with the interval of every point and the fitted lines.

use crate::draw::{Axes, Course, Line, Mark, Panel, Panels, Value, panels};
use crate::error::{Error, Result};

use crate::verify::converge::{Axis, ConvergencePoint, ErrorMetric, LogLogFit, Series};
use crate::verify::statistics::MeanEstimate;

/// Draws the series, with a title and a note.
///
/// # Errors
/// If nothing can be drawn because no error is positive and finite.
pub(super) fn svg(
    series: &[Series],
    metric: ErrorMetric,
    title: &str,
    subtitle: &str,
) -> Result<String> {
    let panel_for = |axis| panel(series, metric, axis);
    let (Some(left), Some(right)) = (panel_for(Axis::Samples), panel_for(Axis::Seconds)) else {
        return Err(Error::input("no error exceeds the noise of the reference: nothing to plot"));
    };
    let slopes = |curve: &Series| {
        [Axis::Samples, Axis::Seconds].map(|axis| match curve.fit(metric, axis) {
            Some(LogLogFit { slope, .. }) => {
                format!("{:.3} ± {:.3}", slope.mean, slope.confidence_half_width(0.95))
            }
            None => "—".to_owned(),
        })
    };
    panels(&Panels {
        title,
        subtitle,
        panels: [left, right],
        heads: ["slope against samples (95 %)", "slope against seconds (95 %)"],
        rows: series.iter().map(slopes).collect(),
    })
}

/// One of the two plots; `None` if there is nothing to draw.
fn panel(series: &[Series], metric: ErrorMetric, axis: Axis) -> Option<Panel> {
    let line = |(color, curve): (usize, &Series)| Line {
        name: curve.name.clone(),
        marks: marks(curve, metric, axis),
        course: Course::Fitted(fit_ends(curve, metric, axis)),
        color,
    };
    let lines: Vec<Line> = series.iter().enumerate().map(line).collect();
    let marks = lines.iter().flat_map(|line| &line.marks);
    // Intervals are drawn in full, except where they approach 0, which a logarithmic axis cannot
    // show.
    let bounds = |value: Value| [value.low.max(value.middle / 4.0), value.middle, value.high];
    let x_name = match axis {
        Axis::Samples => "samples per pixel",
        Axis::Seconds => "seconds",
    };
    let names = [x_name, metric.name()];
    let xs = marks.clone().flat_map(|mark| bounds(mark.x));
    let axes = Axes::around(names, xs, marks.clone().flat_map(|mark| bounds(mark.y)))?;
    let axes = match axis {
        Axis::Samples => axes.with_x_ticks(marks.clone().map(|mark| mark.x.middle)),
        Axis::Seconds => axes,
    };
    Some(Panel { axes, lines })
}

fn marks(series: &Series, metric: ErrorMetric, axis: Axis) -> Vec<Mark> {
    let with_interval = |estimate: MeanEstimate| {
        let (middle, margin) = (estimate.mean, estimate.confidence_half_width(0.95));
        Value { middle, low: middle - margin, high: middle + margin }
    };
    let mark = |point: &ConvergencePoint| Mark {
        x: match axis {
            Axis::Samples => Value::exact(position(point, axis)),
            Axis::Seconds => with_interval(point.seconds()),
        },
        y: with_interval(point.error(metric)),
    };
    let is_shown = |Mark { x, y }: &Mark| x.middle > 0.0 && y.middle > 0.0 && y.high.is_finite();
    series.points.iter().map(mark).filter(is_shown).collect()
}

fn position(point: &ConvergencePoint, axis: Axis) -> f64 {
    match axis {
        Axis::Samples => f64::from(point.samples),
        Axis::Seconds => point.seconds().mean,
    }
}

/// End points of the fitted line.
fn fit_ends(series: &Series, metric: ErrorMetric, axis: Axis) -> Option<[(f64, f64); 2]> {
    let LogLogFit { slope, intercept } = series.fit(metric, axis)?;
    let y = |x: f64| libm::exp10(intercept + slope.mean * libm::log10(x));
    let xs = series.points.iter().map(|point| position(point, axis));
    let (low, high) = (xs.clone().fold(f64::INFINITY, f64::min), xs.fold(0.0, f64::max));
    Some([(low, y(low)), (high, y(high))])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::converge::RunErrors;

    fn series(name: &str, factor: f64) -> Series {
        let point = |samples: u32| {
            let run = |seed: u32| {
                let mse = factor * (1.0 + 0.1 * f64::from(seed)) / f64::from(samples);
                let (seconds, concentration) = (1e-3 * f64::from(samples), Default::default());
                RunErrors { mse, relmse: mse, seconds, concentration }
            };
            ConvergencePoint { samples, runs: (0..4).map(run).collect() }
        };
        Series { name: name.into(), points: [1, 10, 100].map(point).into() }
    }

    #[test]
    fn the_plot_names_every_series_and_its_slope_and_escapes_names() {
        let all = [series("path", 1.0), series("a < b", 10.0)];
        let svg = svg(&all, ErrorMetric::Rmse, "a title", "against \"that\"").unwrap();
        assert!(svg.starts_with("<svg width=\"1120\""), "{}", &svg[..80]);
        for text in ["path", "a &lt; b", "-0.500 ± 0.000", "samples per pixel", "seconds"] {
            assert!(svg.contains(text), "{text}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn nothing_to_draw_is_an_error() {
        assert!(svg(&[series("path", -1.0)], ErrorMetric::Rmse, "", "").is_err());
    }
}
