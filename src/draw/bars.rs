//! Bar charts with groups, each with its own scale.

use plotters::prelude::*;

use crate::error::Result;

use super::Value;
use super::axes::{Area, DrawResult, INK, MARGIN, SCALE, color_of, drawn, headline, words};

const WIDTH: u32 = 960 * SCALE;
const TITLE_HEIGHT: u32 = 60 * SCALE;
const GROUP_HEIGHT: u32 = 30 * SCALE;
const BAR_HEIGHT: u32 = 20 * SCALE;
/// Left end of all bars, and right end of the longest bar.
const BARS: [u32; 2] = [150 * SCALE, 800 * SCALE];

/// One bar.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// Label in front of the bar.
    pub name: String,
    /// Length; the interval is drawn as a thin line.
    pub value: Value,
    /// Value as text, after the bar.
    pub words: String,
    /// Color index.
    pub color: usize,
}

/// Bars with a common heading and scale.
#[derive(Clone, Debug, PartialEq)]
pub struct BarGroup {
    /// Heading.
    pub name: String,
    /// Bars from top to bottom.
    pub bars: Vec<Bar>,
}

/// Draws groups of bars, each with its own scale.
///
/// # Errors
/// When drawing fails.
pub fn bars(title: &str, subtitle: &str, groups: &[BarGroup]) -> Result<String> {
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
            root.draw(&words(&group.name, (MARGIN, middle), 14))?;
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

fn draw_bar(root: &Area<'_>, bar: &Bar, longest: f64, top: i32) -> DrawResult {
    let [begin, end] = BARS.map(f64::from);
    let place = |value: f64| (begin + (end - begin) * value / longest.max(1e-300)).round() as i32;
    let (gap, middle) = (2 * SCALE as i32, top + BAR_HEIGHT as i32 / 2);
    let corners =
        [(place(0.0), top + gap), (place(bar.value.middle), top + BAR_HEIGHT as i32 - gap)];
    root.draw(&Rectangle::new(corners, color_of(bar.color).filled()))?;
    let ends = [bar.value.low, bar.value.high].map(|value| (place(value), middle));
    root.draw(&PathElement::new(ends.to_vec(), INK.stroke_width(SCALE)))?;
    root.draw(&words(&bar.name, (MARGIN + 12 * SCALE as i32, middle), 12))?;
    let behind = ends[1].0 + 8 * SCALE as i32;
    root.draw(&words(&bar.words, (behind, middle), 12))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_have_names_words_and_lengths_in_proportion() {
        let bar = |name: &str, value: f64| Bar {
            name: name.into(),
            value: Value::exact(value),
            words: format!("{value} rays/s"),
            color: 0,
        };
        let bars_of_both = vec![bar("a", 2.0), bar("b", 1.0)];
        let group = BarGroup { name: "camera <rays>".into(), bars: bars_of_both };
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
}
