//! The two drawings of `photosphere bench`: bars of a few figures side by side, and lines of figures
//! against the number of spheres.

use std::ops::Range;

use plotters::prelude::*;

use crate::error::Result;

use super::Figure;

use crate::verify::drawing::{
    Area, COLORS, Drawn, INK, MARGIN, SCALE, drawn, headline, log_axes, marker, range, words,
};

const WIDTH: u32 = 960 * SCALE;
const TITLE_HEIGHT: u32 = 60 * SCALE;
const GROUP_HEIGHT: u32 = 30 * SCALE;
const BAR_HEIGHT: u32 = 20 * SCALE;
/// Where bars begin and, if they are the longest, end.
const BARS: [u32; 2] = [150 * SCALE, 800 * SCALE];

/// Two of these stand side by side on a page.
const CHART: [u32; 2] = [490 * SCALE, 320 * SCALE];
const LEGEND_HEIGHT: u32 = 50 * SCALE;
/// From one name of a legend to the next.
const LEGEND_STEP: i32 = 112 * SCALE as i32;

/// One bar.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Bar {
    /// What it is called, before the bar.
    pub name: String,
    /// Its length; the middle half is drawn as a thin line.
    pub value: Figure,
    /// The value in words, behind the bar.
    pub words: String,
    /// Which colour it has; equal numbers have equal colours.
    pub color: usize,
}

/// Bars that are drawn under one heading, to one scale.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Group {
    /// What is compared.
    pub name: String,
    /// From above to below.
    pub bars: Vec<Bar>,
}

/// Draws groups of bars, each to its own scale.
///
/// # Errors
/// When the drawing fails.
pub(super) fn bars(title: &str, subtitle: &str, groups: &[Group]) -> Result<String> {
    let rows: usize = groups.iter().map(|group| group.bars.len()).sum();
    let height = TITLE_HEIGHT
        + groups.len() as u32 * (GROUP_HEIGHT + BAR_HEIGHT / 2)
        + rows as u32 * BAR_HEIGHT
        + GROUP_HEIGHT / 2;
    drawn([WIDTH, height], |root| {
        headline(root, title, subtitle)?;
        let mut top = TITLE_HEIGHT as i32;
        for group in groups {
            let middle = top + GROUP_HEIGHT as i32 / 2;
            root.draw(&words(&group.name, (MARGIN, middle), 14, INK))?;
            top += GROUP_HEIGHT as i32;
            let longest = group.bars.iter().map(|bar| bar.value.high).fold(0.0, f64::max);
            for bar in &group.bars {
                draw_bar(root, bar, longest, top)?;
                top += BAR_HEIGHT as i32;
            }
            top += BAR_HEIGHT as i32 / 2;
        }
        Ok(())
    })
}

fn draw_bar<DB: DrawingBackend>(root: &Area<DB>, bar: &Bar, longest: f64, top: i32) -> Drawn<DB> {
    let [begin, end] = BARS.map(f64::from);
    let place = |value: f64| (begin + (end - begin) * value / longest.max(1e-300)).round() as i32;
    let (gap, middle) = (2 * SCALE as i32, top + BAR_HEIGHT as i32 / 2);
    let color = COLORS[bar.color % COLORS.len()];
    let corners =
        [(place(0.0), top + gap), (place(bar.value.median), top + BAR_HEIGHT as i32 - gap)];
    root.draw(&Rectangle::new(corners, color.filled()))?;
    let ends = [bar.value.low, bar.value.high].map(|value| (place(value), middle));
    root.draw(&PathElement::new(ends.to_vec(), INK.stroke_width(SCALE)))?;
    root.draw(&words(&bar.name, (MARGIN + 12 * SCALE as i32, middle), 12, INK))?;
    let behind = ends[1].0 + 8 * SCALE as i32;
    root.draw(&words(&bar.words, (behind, middle), 12, INK))
}

/// A place on a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    /// Positive.
    pub x: f64,
    /// Positive; the middle half is drawn as a thin line.
    pub y: Figure,
}

/// A line through points.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Line {
    /// What it is called.
    pub name: String,
    /// From left to right.
    pub points: Vec<Point>,
    /// Which colour and mark it has.
    pub color: usize,
}

/// The axes of several charts, so that they can be compared.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Axes {
    /// What stands on the right, and what above, is larger.
    pub names: [&'static str; 2],
    x: Range<f64>,
    y: Range<f64>,
}

impl Axes {
    /// Logarithmic axes with room for all the lines; `None` without a positive point.
    pub(super) fn around<'a>(
        names: [&'static str; 2],
        lines: impl Iterator<Item = &'a Line> + Clone,
    ) -> Option<Self> {
        let points = lines.flat_map(|line| &line.points);
        let (x, y) = (range(points.clone().map(|p| p.x))?, range(points.map(|p| p.y.median))?);
        Some(Self { names, x, y })
    }
}

/// Draws lines.
///
/// # Errors
/// When the drawing fails.
pub(super) fn lines(title: &str, axes: &Axes, lines: &[Line]) -> Result<String> {
    drawn(CHART, |root| {
        let (head, body) = root.split_vertically(LEGEND_HEIGHT);
        let unit = SCALE as i32;
        head.draw(&words(title, (MARGIN, 16 * unit), 15, INK))?;
        for (i, line) in lines.iter().enumerate() {
            let at = (MARGIN + 6 * unit + i as i32 * LEGEND_STEP, 38 * unit);
            head.draw(&marker(line.color, at))?;
            head.draw(&words(&line.name, (at.0 + 10 * unit, at.1), 12, INK))?;
        }
        draw_lines(&body, axes, lines)
    })
}

fn draw_lines<DB: DrawingBackend>(area: &Area<DB>, axes: &Axes, lines: &[Line]) -> Drawn<DB> {
    let mut chart = log_axes(area, axes.names, &axes.x, &axes.y)?;
    for line in lines {
        let color = COLORS[line.color % COLORS.len()];
        let places: Vec<(f64, f64)> = line.points.iter().map(|p| (p.x, p.y.median)).collect();
        let off = |p: &Point| {
            let ends = [(p.x, p.y.low), (p.x, p.y.high)];
            PathElement::new(ends.to_vec(), color.stroke_width(SCALE))
        };
        chart.draw_series(line.points.iter().map(off))?;
        let style = color.stroke_width(SCALE + 1);
        chart.draw_series([PathElement::new(places.clone(), style)])?;
        chart.draw_series(places.into_iter().map(|place| marker(line.color, place)))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_have_names_words_and_lengths_in_proportion() {
        let bar = |name: &str, value: f64| Bar {
            name: name.into(),
            value: Figure::once(value),
            words: format!("{value} rays/s"),
            color: 0,
        };
        let group =
            Group { name: "camera <rays>".into(), bars: vec![bar("a", 2.0), bar("b", 1.0)] };
        let svg = bars("a title", "a subtitle", &[group]).unwrap();
        for text in ["a title", "a subtitle", "camera &lt;rays&gt;", "2 rays/s", "1 rays/s"] {
            assert!(svg.contains(text), "{text}");
        }
        let widths: Vec<f64> = svg
            .split("<rect ")
            .skip(2)
            .filter_map(|rect| rect.split("width=\"").nth(1)?.split('"').next()?.parse().ok())
            .collect();
        assert_eq!(widths.len(), 2, "{svg}");
        assert!((widths[0] / widths[1] - 2.0).abs() < 0.01, "{widths:?}");
        assert!(!svg.contains("NaN"));
    }

    #[test]
    fn lines_are_drawn_and_named() {
        let points = [(3.0, 1e7), (1e6, 2e5)].map(|(x, y)| Point { x, y: Figure::once(y) });
        let line = Line { name: "native".into(), points: points.to_vec(), color: 1 };
        let axes = Axes::around(["spheres", "rays/s"], [&line].into_iter()).unwrap();
        assert!(axes.x.start < 3.0 && axes.x.end > 1e6 && axes.y.start < 2e5 && axes.y.end > 1e7);
        let svg = lines("gas", &axes, &[line]).unwrap();
        for text in ["gas", "native", "spheres", "rays/s", "<polyline"] {
            assert!(svg.contains(text), "{text}");
        }
        assert!(!svg.contains("NaN"));
        assert_eq!(Axes::around(["", ""], [].into_iter()), None);
    }
}
