//! An SVG drawing built shape by shape: a window that clips its content, and space for a legend
//! below.

use crate::math::DVec2;
use crate::sampling::sin_cos;

use super::page::escape;

/// An SVG drawing under construction. Positions are pixels from the upper left corner; classes are
/// those of its style sheet.
#[derive(Clone, Debug)]
pub struct Canvas {
    svg: String,
    window: DVec2,
}

impl Canvas {
    /// Creates an empty drawing with space of height `below` under the window.
    pub fn new(window: DVec2, below: f64, style: &str) -> Self {
        let (width, height) = (window.x, window.y + below);
        let svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\">\n<style>\n{style}</style>\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n\
             <clipPath id=\"view\"><rect width=\"{width}\" height=\"{}\"/></clipPath>\n\
             <g clip-path=\"url(#view)\">\n",
            window.y
        );
        Self { svg, window }
    }

    /// Ends the clipping: later shapes may lie outside the window.
    pub fn leave_window(&mut self) {
        self.svg += "</g>\n";
    }

    /// Returns the finished SVG.
    pub fn finish(self) -> String {
        self.svg + "</svg>\n"
    }

    /// Draws a straight line.
    pub fn line(&mut self, class: &str, from: DVec2, to: DVec2) {
        self.svg += &format!(
            "<path class=\"{class}\" d=\"M{:.2} {:.2}L{:.2} {:.2}\"/>\n",
            from.x, from.y, to.x, to.y
        );
    }

    /// Draws text; `anchor` is `start`, `center` or `end`, and refers to the position `at`.
    pub fn text(&mut self, class: &str, anchor: &str, at: DVec2, text: &str) {
        self.svg += &format!(
            "<text class=\"{class}\" text-anchor=\"{anchor}\" x=\"{:.1}\" y=\"{:.1}\">{}</text>\n",
            at.x,
            at.y,
            escape(text)
        );
    }

    /// Draws a circle with a radius of at least one pixel. SVG viewers use f32, so for a huge
    /// circle only the part in the window is drawn, as a polygon.
    pub fn circle(&mut self, class: &str, center: DVec2, radius: f64) {
        let half = self.window.x + self.window.y;
        if radius < 20.0 * half {
            self.svg += &format!(
                "<circle class=\"{class}\" cx=\"{:.2}\" cy=\"{:.2}\" r=\"{:.2}\"/>\n",
                center.x,
                center.y,
                radius.max(1.0)
            );
            return;
        }
        let to_window = 0.5 * self.window - center;
        let outward = to_window.normalize_or(DVec2::Y);
        let tangent = DVec2::new(-outward.y, outward.x);
        // Relative to the circle's point nearest to the window, which avoids large numbers.
        let nearest = 0.5 * self.window
            + outward * (radius - to_window.length()).clamp(-3.0 * half, 3.0 * half);
        let arc = (-32..=32).map(|i| {
            let (sin, cos) = sin_cos(f64::from(i) / 32.0 * half / radius);
            nearest + radius * sin * tangent + radius * (cos - 1.0) * outward
        });
        let behind = [1.0, -1.0].map(|side| nearest + side * half * tangent - 8.0 * half * outward);
        let outline: Vec<String> =
            arc.chain(behind).map(|point| format!("{:.2},{:.2}", point.x, point.y)).collect();
        self.svg += &format!("<polygon class=\"{class}\" points=\"{}\"/>\n", outline.join(" "));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn huge_circles_are_drawn_with_finite_numbers() {
        let mut canvas = Canvas::new(DVec2::new(1000.0, 300.0), 64.0, "");
        for radius in [1.0, 1e5, 1e12] {
            canvas.circle("met", DVec2::new(500.0, 150.0 + radius), radius);
        }
        canvas.text("", "end", DVec2::ZERO, "a < b");
        let svg = canvas.finish();
        assert!(!svg.contains("NaN") && !svg.contains("inf") && !svg.contains("e+"), "{svg}");
        assert_eq!(svg.matches("<polygon").count(), 2);
        assert!(svg.contains(">a &lt; b</text>"));
    }
}
