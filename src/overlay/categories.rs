//! The legend of categories: names with disks of their colours.

use super::canvas::{Canvas, Ink};
use super::text::{Align, TextFont};

/// Distance of lines in ems.
const LINE: f64 = 1.5;

/// Radius of a disk in ems.
const DISK: f64 = 0.42;

/// A legend of categories.
pub(super) struct Categories<'a> {
    pub(super) title: &'a str,
    pub(super) entries: &'a [(String, [u8; 3])],
    /// Height that the legend may have, in pixels.
    pub(super) max_height: f64,
}

impl Categories<'_> {
    /// The lines, each with the colour of its disk.
    fn lines(&self, font: &TextFont) -> Vec<(String, Option<[u8; 3]>)> {
        let most = (self.max_height / (LINE * font.em())) as usize;
        // One line for the title, and one for those that are left out.
        let most = most.saturating_sub(2).max(1);
        let title = (!self.title.is_empty()).then(|| (self.title.to_owned(), None));
        let shown = self.entries.iter().take(most);
        let more = self.entries.len().saturating_sub(most);
        let rest = (more > 0).then(|| (format!("and {more} more"), None));
        let names = shown.map(|(name, color)| (name.clone(), Some(*color)));
        title.into_iter().chain(names).chain(rest).collect()
    }

    /// Width and height.
    pub(super) fn size(&self, font: &TextFont) -> [f64; 2] {
        let lines = self.lines(font);
        let indent = |color: &Option<[u8; 3]>| if color.is_some() { indent(font) } else { 0.0 };
        let widths = lines.iter().map(|(text, color)| indent(color) + font.width(text));
        [widths.fold(0.0, f64::max), LINE * font.em() * lines.len() as f64]
    }

    /// Draws the legend with its upper left corner at a point.
    pub(super) fn draw(&self, canvas: &mut Canvas, [x, y]: [f64; 2], font: &TextFont, ink: Ink) {
        for (index, (text, color)) in self.lines(font).into_iter().enumerate() {
            let middle = y + LINE * font.em() * (index as f64 + 0.5);
            let baseline = middle + 0.5 * font.cap_height();
            let mut left = x;
            if let Some(color) = color {
                let radius = DISK * font.em();
                let center = [x + radius, middle];
                // A rim shows white and black disks on any picture.
                let rim = color.map(|c| 0.6 * f32::from(c) / 255.0 + 0.4 * ink[0]);
                canvas.disk(center, radius, rim);
                let line = (0.07 * font.em()).max(1.0);
                canvas.disk(center, radius - line, color.map(|c| f32::from(c) / 255.0));
                left += indent(font);
            }
            font.draw(canvas, &text, [left, baseline], Align::Left, ink);
        }
    }
}

fn indent(font: &TextFont) -> f64 {
    (2.0 * DISK + 0.45) * font.em()
}
