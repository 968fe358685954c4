//! Shared parts of all charts: sheet, headline, logarithmic axes, markers and colors.

use std::io;
use std::ops::{Add, Range};

use plotters::coord::Shift;
use plotters::coord::combinators::LogCoord;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::error::{Error, Result};

/// Charts are drawn in integer units of half a pixel.
pub(super) const SCALE: u32 = 2;
const FONT: &str = "sans-serif";
/// What plotters calls the size of a font, over the size that it writes into an SVG.
const FONT_HEIGHT: f64 = 1.24;

pub(super) const INK: RGBColor = RGBColor(34, 34, 34);
const FAINT: RGBColor = RGBColor(228, 228, 228);
const FAINTER: RGBColor = RGBColor(243, 243, 243);
/// Colors that color-blind readers can distinguish (Okabe and Ito 2008).
const COLORS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
];

/// Distance from the edge of the sheet to its text.
pub(super) const MARGIN: i32 = 16 * SCALE as i32;

pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(super) type DrawResult<T = ()> = std::result::Result<T, DrawingAreaErrorKind<io::Error>>;
pub(super) type LogChart<'b, 'a> =
    ChartContext<'b, SVGBackend<'a>, Cartesian2d<LogCoord<f64>, LogCoord<f64>>>;
/// The marker of a series, for any coordinate type.
pub(super) type Marker<'a, C> =
    <EmptyElement<C, SVGBackend<'a>> as Add<Polygon<(i32, i32)>>>::Output;

/// A number with an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value {
    /// The number itself.
    pub middle: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl Value {
    /// Creates a number without an interval.
    pub fn exact(middle: f64) -> Self {
        Self { middle, low: middle, high: middle }
    }
}

/// Logarithmic axes; charts can share them to be comparable.
#[derive(Clone, Debug, PartialEq)]
pub struct Axes {
    /// Axis names: horizontal, vertical.
    pub names: [&'static str; 2],
    pub(super) x: Range<f64>,
    pub(super) y: Range<f64>,
    /// Numbers that the horizontal axis names, in ascending order; none for the powers of ten.
    pub(super) x_ticks: Vec<f64>,
}

impl Axes {
    /// Axes that contain all points; `None` without a positive and finite one.
    pub fn around(
        names: [&'static str; 2],
        xs: impl Iterator<Item = f64> + Clone,
        ys: impl Iterator<Item = f64> + Clone,
    ) -> Option<Self> {
        Some(Self { names, x: range(xs)?, y: range(ys)?, x_ticks: Vec::new() })
    }

    /// With these numbers on the horizontal axis, as far as there is room for them.
    #[must_use]
    pub fn with_x_ticks(self, ticks: impl Iterator<Item = f64>) -> Self {
        let mut x_ticks: Vec<f64> = ticks.filter(|x| x.is_finite() && *x > 0.0).collect();
        x_ticks.sort_by(f64::total_cmp);
        x_ticks.dedup();
        Self { x_ticks, ..self }
    }

    /// Draws the ticks of the horizontal axis, each far enough from the one before.
    fn draw_x_ticks(&self, chart: &mut LogChart<'_, '_>) -> DrawResult {
        let mut free_from = i32::MIN;
        for &x in &self.x_ticks {
            let label = tick_label(x);
            let half_width = 4 * SCALE as i32 * label.len() as i32;
            let middle = chart.backend_coord(&(x, self.y.start)).0;
            if middle - half_width < free_from {
                continue;
            }
            free_from = middle + half_width;
            let style = font(12).pos(Pos::new(HPos::Center, VPos::Top));
            let below = |y: i32| (0, y * SCALE as i32);
            let line = PathElement::new(vec![below(0), below(4)], INK);
            let text = Text::new(label, below(6), style);
            chart
                .draw_series(std::iter::once(EmptyElement::at((x, self.y.start)) + line + text))?;
        }
        Ok(())
    }

    pub(super) fn draw<'b, 'a>(&self, area: &'b Area<'a>) -> DrawResult<LogChart<'b, 'a>> {
        let mut chart = ChartBuilder::on(area)
            .margin(12 * SCALE)
            .x_label_area_size(40 * SCALE)
            .y_label_area_size(60 * SCALE)
            .build_cartesian_2d(self.x.clone().log_scale(), self.y.clone().log_scale())?;
        chart
            .configure_mesh()
            .x_desc(self.names[0])
            .y_desc(self.names[1])
            .x_labels(10)
            .y_labels(6)
            .max_light_lines(10)
            .label_style(font(12))
            .axis_desc_style(font(13))
            .x_label_formatter(&|value| match self.x_ticks.is_empty() {
                true => decimal(*value),
                false => String::new(),
            })
            .y_label_formatter(&|value| decimal(*value))
            .axis_style(INK)
            .bold_line_style(FAINT)
            .light_line_style(FAINTER)
            .draw()?;
        self.draw_x_ticks(&mut chart)?;
        Ok(chart)
    }
}

/// Draws a complete chart of this size as SVG.
///
/// # Errors
/// When drawing fails.
pub(super) fn drawn(size: [u32; 2], content: impl Fn(&Area<'_>) -> DrawResult) -> Result<String> {
    let mut text = String::new();
    let root = SVGBackend::with_string(&mut text, size.into()).into_drawing_area();
    root.fill(&WHITE)
        .and_then(|()| content(&root))
        .and_then(|()| root.present())
        .map_err(|e| Error::input(format!("the plot cannot be drawn: {e}")))?;
    drop(root);
    Ok(sized(&text, size))
}

/// Draws title and subtitle at the top of the sheet.
pub(super) fn headline(area: &Area<'_>, title: &str, subtitle: &str) -> DrawResult {
    let unit = SCALE as i32;
    area.draw(&words(title, (MARGIN, 18 * unit), 17))?;
    area.draw(&words(subtitle, (MARGIN, 40 * unit), 12))
}

/// Halves the displayed size of an SVG and keeps its internal units.
fn sized(svg: &str, [width, height]: [u32; 2]) -> String {
    let size = |width, height| format!("<svg width=\"{width}\" height=\"{height}\"");
    svg.replacen(&size(width, height), &size(width / SCALE, height / SCALE), 1)
}

/// The color of a series.
pub(super) fn color_of(series: usize) -> RGBColor {
    COLORS[series % COLORS.len()]
}

/// Text with its middle left anchor at `at`.
pub(super) fn words(text: &str, at: (i32, i32), size: u32) -> Text<'_, (i32, i32), &str> {
    Text::new(text, at, font(size).pos(Pos::new(HPos::Left, VPos::Center)))
}

/// A font whose letters have this size in pixels, as in a style sheet.
fn font(size: u32) -> TextStyle<'static> {
    (FONT, f64::from(size * SCALE) * FONT_HEIGHT).into_font().color(&INK)
}

/// The marker of a series, distinguished by both shape and color.
pub(super) fn marker<'a, C>(series: usize, at: C) -> Marker<'a, C> {
    let radius = 3.6 * f64::from(SCALE);
    let (corners, turn) = [(24, 0.0), (3, 0.25), (4, 0.125), (4, 0.0)][series % 4];
    let corner = |i: u32| {
        let turns = turn + f64::from(i) / f64::from(corners);
        let (sin, cos) = crate::sampling::sin_cos(std::f64::consts::TAU * turns);
        ((radius * cos).round() as i32, (-radius * sin).round() as i32)
    };
    let outline: Vec<(i32, i32)> = (0..corners).map(corner).collect();
    EmptyElement::at(at) + Polygon::new(outline, color_of(series).filled())
}

/// A range with a margin around the values. Contains at least two powers of ten, neither so near an
/// end that its label is clipped.
fn range(values: impl Iterator<Item = f64> + Clone) -> Option<Range<f64>> {
    let low = libm::log10(values.clone().fold(f64::INFINITY, f64::min)) - 0.12;
    let high = libm::log10(values.fold(0.0, f64::max)) + 0.12;
    if !(low.is_finite() && high.is_finite()) {
        return None;
    }
    let has_two = high.floor() - low.ceil() >= 1.0;
    let (low, high) = if has_two { (low, high) } else { (low.floor() - 0.06, high.ceil() + 0.06) };
    Some(libm::exp10(low)..libm::exp10(high))
}

/// Formats a number of an axis, which is a count or has few digits.
fn tick_label(value: f64) -> String {
    if value < 1e5 { format!("{value}") } else { format!("{value:e}") }
}

/// Formats a power of ten for people.
fn decimal(value: f64) -> String {
    let exponent = libm::log10(value).round() as i32;
    if (-3..=4).contains(&exponent) {
        format!("{:.*}", (-exponent).max(0) as usize, value)
    } else {
        format!("1e{exponent}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_hold_two_powers_of_ten() {
        let narrow = range([0.02, 0.3].into_iter()).unwrap();
        assert!((0.008..0.01).contains(&narrow.start) && (1.0..1.2).contains(&narrow.end));
        let wide = range([1.0, 64.0].into_iter()).unwrap();
        assert!(wide.start < 1.0 && wide.end > 64.0 && wide.end < 100.0);
        assert_eq!(range(std::iter::empty()), None);
        assert_eq!([1e-3, 1.0, 100.0, 1e5].map(decimal), ["0.001", "1", "100", "1e5"]);
    }
}
