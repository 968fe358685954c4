//! The plot of [`super`] as SVG: error against samples on the left, against seconds on the right, both
//! in log-log, with the interval of every point and the fitted lines.

use std::ops::Range;

use plotters::prelude::*;

use crate::error::{Error, Result};

use super::super::drawing::{
    Area, COLORS, Drawn, INK, SCALE, drawn, headline, log_axes, marker, range, words,
};
use super::super::statistics::Estimate;
use super::{Axis, Metric, Series};

const WIDTH: u32 = 1120 * SCALE;
const PLOT_HEIGHT: u32 = 440 * SCALE;
const TITLE_HEIGHT: u32 = 56 * SCALE;
const ROW_HEIGHT: u32 = 24 * SCALE;

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
    let height =
        TITLE_HEIGHT + PLOT_HEIGHT + ROW_HEIGHT * (series.len() as u32 + 1) + TITLE_HEIGHT / 4;
    let panels = [Axis::Samples, Axis::Seconds].map(|axis| Panel::new(series, metric, axis));
    let [Some(left), Some(right)] = &panels else {
        return Err(Error::input("there is no error above the reference's own noise to plot"));
    };
    drawn([WIDTH, height], |root| {
        let (title, rest) = root.split_vertically(TITLE_HEIGHT);
        headline(&title, heading.title, heading.subtitle)?;
        let (plots, legend) = rest.split_vertically(PLOT_HEIGHT);
        let (on_left, on_right) = plots.split_horizontally(WIDTH / 2);
        left.draw(&on_left)?;
        right.draw(&on_right)?;
        draw_legend(&legend, series, left, right)
    })
}

fn draw_legend<DB: DrawingBackend>(
    area: &Area<DB>,
    series: &[Series],
    left: &Panel<'_>,
    right: &Panel<'_>,
) -> Drawn<DB> {
    let unit = SCALE as i32;
    let columns = [64, 460, 760].map(|x| x * unit);
    let heads = ["", "slope against samples (95 %)", "slope against seconds (95 %)"];
    for (x, head) in columns.into_iter().zip(heads) {
        area.draw(&words(head, (x, ROW_HEIGHT as i32 / 2), 12, INK))?;
    }
    for (i, one) in series.iter().enumerate() {
        let y = ROW_HEIGHT as i32 * (i as i32 + 1) + ROW_HEIGHT as i32 / 2;
        let color = COLORS[i % COLORS.len()];
        let line = vec![(20 * unit, y), (52 * unit, y)];
        area.draw(&PathElement::new(line, color.stroke_width(2 * SCALE)))?;
        area.draw(&marker(i, (36 * unit, y)))?;
        let slope = |panel: &Panel<'_>| match one.fit(panel.metric, panel.axis) {
            Some(fit) => format!("{:.3} ± {:.3}", fit.slope.mean, fit.slope.margin(0.95)),
            None => "—".to_owned(),
        };
        let texts = [one.name.clone(), slope(left), slope(right)];
        for (x, text) in columns.into_iter().zip(&texts) {
            area.draw(&words(text, (x, y), 13, INK))?;
        }
    }
    Ok(())
}

/// One of the two plots.
struct Panel<'a> {
    series: &'a [Series],
    metric: Metric,
    axis: Axis,
    x: Range<f64>,
    y: Range<f64>,
}

/// Where a point stands, and from where to where its intervals reach.
struct Mark {
    x: f64,
    y: f64,
    across: Range<f64>,
    along: Range<f64>,
}

impl<'a> Panel<'a> {
    /// `None` where there is nothing to draw.
    fn new(series: &'a [Series], metric: Metric, axis: Axis) -> Option<Self> {
        let mut panel = Self { series, metric, axis, x: 1.0..1.0, y: 1.0..1.0 };
        let marks: Vec<Mark> = series.iter().flat_map(|one| panel.marks(one)).collect();
        // Intervals are shown whole, but for those that come near 0, which no such axis has.
        let shown = |middle: f64, of: &Range<f64>| [of.start.max(middle / 4.0), middle, of.end];
        panel.x = range(marks.iter().flat_map(|mark| shown(mark.x, &mark.across)))?;
        panel.y = range(marks.iter().flat_map(|mark| shown(mark.y, &mark.along)))?;
        Some(panel)
    }

    fn marks(&self, series: &Series) -> Vec<Mark> {
        let interval = |estimate: Estimate| {
            let margin = estimate.margin(0.95);
            estimate.mean - margin..estimate.mean + margin
        };
        let mark = |point: &super::Point| {
            let error = point.error(self.metric);
            let x = point.place(self.axis);
            let across = match self.axis {
                Axis::Samples => x..x,
                Axis::Seconds => interval(point.seconds()),
            };
            Mark { x, y: error.mean, across, along: interval(error) }
        };
        let marks = series.points.iter().map(mark);
        marks.filter(|mark| mark.y > 0.0 && mark.x > 0.0 && mark.along.end.is_finite()).collect()
    }

    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB> {
        let x_name = match self.axis {
            Axis::Samples => "samples per pixel",
            Axis::Seconds => "seconds",
        };
        let mut chart = log_axes(area, [x_name, self.metric.name()], &self.x, &self.y)?;
        for (i, series) in self.series.iter().enumerate() {
            let color = COLORS[i % COLORS.len()];
            if let Some(line) = self.fitted(series) {
                let style = color.mix(0.55).stroke_width(SCALE + 1);
                chart.draw_series([PathElement::new(line, style)])?;
            }
            let marks = self.marks(series);
            let style = color.stroke_width(SCALE + 1);
            let bars = marks.iter().flat_map(|mark| {
                let low = (mark.across.start.max(self.x.start), mark.along.start.max(self.y.start));
                let upright = vec![(mark.x, low.1), (mark.x, mark.along.end)];
                let flat = vec![(low.0, mark.y), (mark.across.end, mark.y)];
                [upright, flat].map(|ends| PathElement::new(ends, style))
            });
            chart.draw_series(bars)?;
            chart.draw_series(marks.iter().map(|mark| marker(i, (mark.x, mark.y))))?;
        }
        Ok(())
    }

    /// The ends of the fitted line.
    fn fitted(&self, series: &Series) -> Option<Vec<(f64, f64)>> {
        let fit = series.fit(self.metric, self.axis)?;
        let y = |x: f64| libm::exp10(fit.intercept + fit.slope.mean * libm::log10(x));
        let xs = series.points.iter().map(|point| point.place(self.axis));
        let (low, high) =
            xs.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), x| (low.min(x), high.max(x)));
        Some(vec![(low, y(low)), (high, y(high))])
    }
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
