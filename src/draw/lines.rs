//! Line charts on logarithmic axes: one chart with a legend above, or two panels side by side with
//! a table below.

use plotters::prelude::*;

use crate::error::Result;

use super::axes::{Area, DrawResult, MARGIN, SCALE, color_of, drawn, headline, marker, words};
use super::{Axes, Value};

/// Two of these charts fit side by side on a page.
const CHART: [u32; 2] = [490 * SCALE, 320 * SCALE];
const LEGEND_HEIGHT: u32 = 50 * SCALE;
/// Distance between legend entries.
const LEGEND_STEP: i32 = 112 * SCALE as i32;

const PANELS_WIDTH: u32 = 1120 * SCALE;
const PANEL_HEIGHT: u32 = 440 * SCALE;
const TITLE_HEIGHT: u32 = 56 * SCALE;
const ROW_HEIGHT: u32 = 24 * SCALE;

/// A data point. Both coordinates are positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// Horizontal coordinate.
    pub x: Value,
    /// Vertical coordinate.
    pub y: Value,
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Course {
    /// From point to point.
    Through,
    /// A straight fitted line between two ends; `None` if there is no fit.
    Fitted(Option<[(f64, f64); 2]>),
}

/// A series: its points and a line.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Name of the series.
    pub name: String,
    /// Points from left to right; their intervals are drawn as thin lines.
    pub marks: Vec<Mark>,
    /// How the line is drawn.
    pub course: Course,
    /// Color and marker index.
    pub color: usize,
}

/// A chart of several series.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// The axes.
    pub axes: Axes,
    /// The series.
    pub lines: Vec<Line>,
}

/// Two charts of the same series with a table below.
#[derive(Clone, Debug)]
pub struct Panels<'a> {
    /// Title.
    pub title: &'a str,
    /// Subtitle.
    pub subtitle: &'a str,
    /// Charts from left to right.
    pub panels: [Panel; 2],
    /// Headers of the two table columns after the name column.
    pub heads: [&'a str; 2],
    /// Contents of these columns for each series.
    pub rows: Vec<[String; 2]>,
}

/// Draws one chart with its legend above.
///
/// # Errors
/// When drawing fails.
pub fn lines(title: &str, panel: &Panel) -> Result<String> {
    drawn(CHART, |root| {
        let (head, body) = root.split_vertically(LEGEND_HEIGHT);
        let unit = SCALE as i32;
        head.draw(&words(title, (MARGIN, 16 * unit), 15))?;
        for (i, line) in panel.lines.iter().enumerate() {
            let at = (MARGIN + 6 * unit + i as i32 * LEGEND_STEP, 38 * unit);
            head.draw(&marker(line.color, at))?;
            head.draw(&words(&line.name, (at.0 + 10 * unit, at.1), 12))?;
        }
        draw_panel(&body, panel)
    })
}

/// Draws two charts side by side, with a table below.
///
/// # Errors
/// When drawing fails.
pub fn panels(sheet: &Panels<'_>) -> Result<String> {
    let rows = sheet.rows.len() as u32;
    let height = TITLE_HEIGHT + PANEL_HEIGHT + ROW_HEIGHT * (rows + 1) + TITLE_HEIGHT / 4;
    drawn([PANELS_WIDTH, height], |root| {
        let (title, rest) = root.split_vertically(TITLE_HEIGHT);
        headline(&title, sheet.title, sheet.subtitle)?;
        let (plots, table) = rest.split_vertically(PANEL_HEIGHT);
        let (left, right) = plots.split_horizontally(PANELS_WIDTH / 2);
        draw_panel(&left, &sheet.panels[0])?;
        draw_panel(&right, &sheet.panels[1])?;
        draw_table(&table, sheet)
    })
}

fn draw_table(area: &Area<'_>, sheet: &Panels<'_>) -> DrawResult {
    let unit = SCALE as i32;
    let [name, first, second] = [64, 460, 760].map(|x| x * unit);
    for (x, head) in [first, second].into_iter().zip(sheet.heads) {
        area.draw(&words(head, (x, ROW_HEIGHT as i32 / 2), 12))?;
    }
    for (i, (line, row)) in sheet.panels[0].lines.iter().zip(&sheet.rows).enumerate() {
        let y = ROW_HEIGHT as i32 * (i as i32 + 1) + ROW_HEIGHT as i32 / 2;
        let sample = vec![(20 * unit, y), (52 * unit, y)];
        area.draw(&PathElement::new(sample, color_of(line.color).stroke_width(2 * SCALE)))?;
        area.draw(&marker(line.color, (36 * unit, y)))?;
        for (x, text) in [(name, &line.name), (first, &row[0]), (second, &row[1])] {
            area.draw(&words(text, (x, y), 13))?;
        }
    }
    Ok(())
}

fn draw_panel(area: &Area<'_>, Panel { axes, lines }: &Panel) -> DrawResult {
    let mut chart = axes.draw(area)?;
    for line in lines {
        let color = color_of(line.color);
        let places: Vec<(f64, f64)> =
            line.marks.iter().map(|mark| (mark.x.middle, mark.y.middle)).collect();
        // Intervals are thinner than a line that crosses them, and stand out from a pale one.
        let (path, style, interval) = match line.course {
            Course::Through => (Some(places.clone()), color.stroke_width(SCALE + 1), SCALE),
            Course::Fitted(ends) => {
                let pale = color.mix(0.55).stroke_width(SCALE + 1);
                (ends.map(Vec::from), pale, SCALE + 1)
            }
        };
        chart.draw_series(path.map(|path| PathElement::new(path, style)))?;
        let intervals = line.marks.iter().flat_map(|Mark { x, y }| {
            // An interval may extend to 0, which a logarithmic axis cannot show.
            let upright = vec![(x.middle, y.low.max(axes.y.start)), (x.middle, y.high)];
            let flat = vec![(x.low.max(axes.x.start), y.middle), (x.high, y.middle)];
            [upright, flat].map(|ends| PathElement::new(ends, color.stroke_width(interval)))
        });
        chart.draw_series(intervals)?;
        chart.draw_series(places.into_iter().map(|place| marker(line.color, place)))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_drawn_and_named() {
        let places = [(3.0, 1e7), (1e6, 2e5)];
        let marks = places.map(|(x, y)| Mark { x: Value::exact(x), y: Value::exact(y) });
        let (xs, ys) = (places.map(|place| place.0), places.map(|place| place.1));
        let axes = Axes::around(["spheres", "rays/s"], xs.into_iter(), ys.into_iter()).unwrap();
        assert!(axes.x.start < 3.0 && axes.x.end > 1e6 && axes.y.start < 2e5 && axes.y.end > 1e7);
        let (name, marks) = ("native".to_owned(), marks.to_vec());
        let line = Line { name, marks, course: Course::Through, color: 1 };
        let svg = lines("gas", &Panel { axes, lines: vec![line] }).unwrap();
        for text in ["gas", "native", "spheres", "rays/s", "<polyline"] {
            assert!(svg.contains(text), "{text}");
        }
        assert!(!svg.contains("NaN"));
        // The sheet has two units per pixel, and no text is smaller than 12 pixels.
        let sizes = svg.split("font-size=\"").skip(1).filter_map(|rest| rest.split('"').next());
        let smallest = sizes.filter_map(|size| size.parse().ok()).fold(f64::INFINITY, f64::min);
        assert!((23.9..30.0).contains(&smallest), "{smallest}");
        assert_eq!(Axes::around(["", ""], [].into_iter(), [].into_iter()), None);
    }
}
