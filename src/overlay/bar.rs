//! The colour bar.

use crate::appearance::{ColorMap, Ticks, ValueRange};

use super::canvas::{Area, Canvas, Ink};
use super::text::{Align, TextFont};

/// A colour bar: its title, map and range.
pub(super) struct Bar<'a> {
    pub(super) title: &'a str,
    pub(super) map: ColorMap,
    pub(super) range: ValueRange,
    /// True for each end that is pointed: the lower and the upper one.
    pub(super) exceeded: [bool; 2],
}

/// Height of the point of an end, in widths of the bar.
const POINT: f64 = 0.9;

impl Bar<'_> {
    /// Draws the bar, whose ticks are to its right, into an area. The title stands above it.
    pub(super) fn draw(&self, canvas: &mut Canvas, area: Area, font: &TextFont, ink: Ink) {
        let height = area.bottom - area.top;
        // The lower end of the range is below, also if it is the larger number.
        let color = |y: i64| {
            let position = 1.0 - (y as f64 + 0.5 - area.top) / height;
            self.map.srgb(position)
        };
        canvas.fill_rows(area, color);
        let line = (0.06 * font.em()).max(1.0).round();
        canvas.frame(area, line, ink);
        let point = (POINT * (area.right - area.left)).round();
        let [is_below, is_above] = self.exceeded;
        if is_below {
            draw_point(canvas, area, area.bottom + point, line, [self.map.srgb(0.0), ink]);
        }
        if is_above {
            draw_point(canvas, area, area.top - point, line, [self.map.srgb(1.0), ink]);
        }
        let ValueRange { low, high, log } = self.range;
        let intervals = ((height / (2.2 * font.em())) as usize).clamp(1, 9);
        let ticks = match log {
            true => Ticks::logarithmic(low, high, intervals),
            false => Ticks::linear(low, high, intervals),
        };
        for (value, label) in ticks.values.iter().zip(ticks.labels()) {
            let y = area.bottom - self.range.position(*value) * height;
            let y = y.clamp(area.top + 0.5 * line, area.bottom - 0.5 * line).round();
            let right = area.right + 0.3 * font.em();
            let tick =
                Area { left: area.right, right, top: y - 0.5 * line, bottom: y + 0.5 * line };
            canvas.fill(tick, ink);
            let baseline = y + 0.5 * font.cap_height();
            let x = right + 0.25 * font.em();
            font.draw(canvas, &label, [x, baseline], Align::Left, ink);
        }
        let above = if is_above { point } else { 0.0 };
        let baseline = area.top - above - 0.85 * font.em();
        font.draw(canvas, self.title, [area.left, baseline], Align::Left, ink);
    }

    /// Width that bar, ticks, labels and title take beside each other.
    pub(super) fn width(&self, bar: f64, height: f64, font: &TextFont) -> f64 {
        let ValueRange { low, high, log } = self.range;
        let intervals = ((height / (2.2 * font.em())) as usize).clamp(1, 9);
        let ticks = match log {
            true => Ticks::logarithmic(low, high, intervals),
            false => Ticks::linear(low, high, intervals),
        };
        let labels = ticks.labels();
        let widest = labels.iter().map(|label| font.width(label)).fold(0.0, f64::max);
        (bar + 0.55 * font.em() + widest).max(font.width(self.title))
    }
}

/// Draws the point of an end, up or down to `tip`, in a colour with an outline.
fn draw_point(canvas: &mut Canvas, area: Area, tip: f64, line: f64, [color, ink]: [Ink; 2]) {
    let base = if tip < area.top { area.top } else { area.bottom };
    let middle = 0.5 * (area.left + area.right);
    let rows = base.min(tip) as i64..base.max(tip) as i64;
    for row in rows {
        let half = 0.5 * (area.right - area.left) * (tip - (row as f64 + 0.5)) / (tip - base);
        let (left, right) = (middle - half, middle + half);
        canvas.fill(Area { left, right, top: row as f64, bottom: row as f64 + 1.0 }, color);
    }
    for side in [area.left + 0.5 * line, area.right - 0.5 * line] {
        canvas.line([side, base], [middle, tip], line, ink);
    }
}
