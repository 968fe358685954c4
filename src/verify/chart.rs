//! The two drawings of `photosphere bench`: bars of a few figures side by side, and lines of figures
//! against the number of spheres.

use plotters::prelude::*;

use crate::error::{Error, Result};

use super::drawing::{
    Area, COLORS, Drawn, FAINT, FAINTER, FONT, INK, SCALE, decimal, marker, range, sized, words,
};

const WIDTH: u32 = 960 * SCALE;
const TITLE_HEIGHT: u32 = 60 * SCALE;
const GROUP_HEIGHT: u32 = 30 * SCALE;
const BAR_HEIGHT: u32 = 20 * SCALE;
/// Where bars begin and, if they are the longest, end.
const BARS: [u32; 2] = [150 * SCALE, 800 * SCALE];

/// One bar.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// What it is called, before the bar.
    pub name: String,
    /// Its length.
    pub value: f64,
    /// How far it may be off, as a share of the value; drawn as a thin line.
    pub spread: f64,
    /// The value in words, behind the bar.
    pub words: String,
    /// Which colour it has; equal numbers have equal colours.
    pub color: usize,
}

/// Bars that are drawn under one heading, to one scale.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// What is compared.
    pub name: String,
    /// From above to below.
    pub bars: Vec<Bar>,
}

/// Draws groups of bars, each to its own scale.
///
/// # Errors
/// When the drawing fails.
pub fn bars(title: &str, subtitle: &str, groups: &[Group]) -> Result<String> {
    let rows: usize = groups.iter().map(|group| group.bars.len()).sum();
    let height = TITLE_HEIGHT
        + groups.len() as u32 * (GROUP_HEIGHT + BAR_HEIGHT / 2)
        + rows as u32 * BAR_HEIGHT
        + GROUP_HEIGHT / 2;
    drawn(height, |root| {
        headline(root, title, subtitle)?;
        let mut top = TITLE_HEIGHT as i32;
        for group in groups {
            let middle = top + GROUP_HEIGHT as i32 / 2;
            root.draw(&words(&group.name, (margin(), middle), 14, INK))?;
            top += GROUP_HEIGHT as i32;
            let longest =
                group.bars.iter().map(|bar| bar.value * (1.0 + bar.spread)).fold(0.0, f64::max);
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
    let corners = [(place(0.0), top + gap), (place(bar.value), top + BAR_HEIGHT as i32 - gap)];
    root.draw(&Rectangle::new(corners, color.filled()))?;
    let ends = [1.0 - bar.spread, 1.0 + bar.spread].map(|share| (place(bar.value * share), middle));
    root.draw(&PathElement::new(ends.to_vec(), INK.stroke_width(SCALE)))?;
    root.draw(&words(&bar.name, (margin() + 12 * SCALE as i32, middle), 12, INK))?;
    let behind = ends[1].0 + 8 * SCALE as i32;
    root.draw(&words(&bar.words, (behind, middle), 12, INK))
}

/// A line through points.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// What it is called.
    pub name: String,
    /// Positive places and values.
    pub points: Vec<(f64, f64)>,
    /// Which colour and mark it has.
    pub color: usize,
}

/// Draws lines with both axes logarithmic.
///
/// # Errors
/// When there is no positive point at all.
pub fn lines(title: &str, x_name: &str, y_name: &str, lines: &[Line]) -> Result<String> {
    let points = || lines.iter().flat_map(|line| line.points.iter().copied());
    let (Some(x), Some(y)) = (range(points().map(|p| p.0)), range(points().map(|p| p.1))) else {
        return Err(Error::input("there is nothing to draw"));
    };
    let font = |size: u32| (FONT, size * SCALE).into_font().color(&INK);
    drawn(400 * SCALE, |root| {
        let (head, body) = root.split_vertically(TITLE_HEIGHT);
        headline(&head, title, "")?;
        for (i, line) in lines.iter().enumerate() {
            let at = (margin() + i as i32 * 150 * SCALE as i32, 42 * SCALE as i32);
            head.draw(&marker(line.color, at))?;
            head.draw(&words(&line.name, (at.0 + 10 * SCALE as i32, at.1), 13, INK))?;
        }
        let mut chart = ChartBuilder::on(&body)
            .margin(14 * SCALE)
            .x_label_area_size(40 * SCALE)
            .y_label_area_size(64 * SCALE)
            .build_cartesian_2d(x.clone().log_scale(), y.clone().log_scale())?;
        chart
            .configure_mesh()
            .x_desc(x_name)
            .y_desc(y_name)
            .x_labels(10)
            .y_labels(6)
            .max_light_lines(10)
            .label_style(font(13))
            .axis_desc_style(font(14))
            .x_label_formatter(&|value| decimal(*value))
            .y_label_formatter(&|value| decimal(*value))
            .axis_style(INK)
            .bold_line_style(FAINT)
            .light_line_style(FAINTER)
            .draw()?;
        for line in lines {
            let style = COLORS[line.color % COLORS.len()].stroke_width(SCALE + 1);
            chart.draw_series([PathElement::new(line.points.clone(), style)])?;
            chart.draw_series(line.points.iter().map(|&point| marker(line.color, point)))?;
        }
        Ok(())
    })
}

type Root<'a> = Area<SVGBackend<'a>>;

/// A whole drawing of this height.
fn drawn(height: u32, content: impl Fn(&Root<'_>) -> Drawn<SVGBackend<'static>>) -> Result<String> {
    let mut text = String::new();
    let root = SVGBackend::with_string(&mut text, (WIDTH, height)).into_drawing_area();
    root.fill(&WHITE)
        .and_then(|()| content(&root))
        .and_then(|()| root.present())
        .map_err(|e| Error::input(format!("the plot cannot be drawn: {e}")))?;
    drop(root);
    Ok(sized(&text, WIDTH, height))
}

fn margin() -> i32 {
    16 * SCALE as i32
}

fn headline<DB: DrawingBackend>(root: &Area<DB>, title: &str, subtitle: &str) -> Drawn<DB> {
    let line = |number: i32| 18 * SCALE as i32 + number * 22 * SCALE as i32;
    root.draw(&words(title, (margin(), line(0)), 17, INK))?;
    root.draw(&words(subtitle, (margin(), line(1)), 12, INK))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_have_names_words_and_lengths_in_proportion() {
        let bar = |name: &str, value: f64| Bar {
            name: name.into(),
            value,
            spread: 0.0,
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
        let line = Line { name: "native".into(), points: vec![(3.0, 1e7), (1e6, 2e5)], color: 1 };
        let svg = lines("gas", "spheres", "rays/s", &[line]).unwrap();
        for text in ["gas", "native", "spheres", "rays/s", "<polyline"] {
            assert!(svg.contains(text), "{text}");
        }
        assert!(lines("gas", "spheres", "rays/s", &[]).is_err());
    }
}
