//! The scale bar.

use crate::appearance::label;

use super::canvas::{Area, Canvas, Ink};
use super::spec::ScaleBarSpec;
use super::text::{Align, TextFont};

/// Longest bar in widths of the picture.
const MAX_SHARE: f64 = 0.22;

impl ScaleBarSpec {
    /// Length of the bar: 1, 2 or 5 times a power of ten, as long as fits into `pixels`.
    fn length(&self, pixels: f64) -> f64 {
        let most = pixels / self.pixels_per_unit;
        let power = libm::pow(10.0, libm::floor(libm::log10(most)));
        let steps = [5.0, 2.0, 1.0].map(|step| step * power);
        steps.into_iter().find(|length| *length <= most * (1.0 + 1e-9)).unwrap_or(power)
    }

    /// Draws the bar with its label, its lower left corner at a point.
    pub(super) fn draw(
        &self,
        canvas: &mut Canvas,
        [x, bottom]: [f64; 2],
        width: f64,
        font: &TextFont,
        ink: Ink,
    ) {
        let length = self.length(MAX_SHARE * width);
        // Also true for numbers that are not finite.
        if !(length > 0.0 && length.is_finite()) {
            return;
        }
        let pixels = length * self.pixels_per_unit;
        let thickness = (0.22 * font.em()).round().max(2.0);
        let bar = Area { left: x, right: x + pixels, top: bottom - thickness, bottom };
        canvas.fill(bar, ink);
        let text = format!("{} {}", label(length), self.unit);
        let baseline = bottom - thickness - 0.4 * font.em();
        let middle = x + 0.5 * pixels;
        font.draw(canvas, text.trim_end(), [middle, baseline], Align::Center, ink);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_length_is_round_and_fits() {
        for (pixels_per_unit, expected) in [(1.0, 100.0), (0.9, 200.0), (7.0, 20.0), (1e-9, 1e11)] {
            let bar = ScaleBarSpec { pixels_per_unit, unit: String::new() };
            let length = bar.length(199.0);
            assert!((length / expected - 1.0).abs() < 1e-9, "{pixels_per_unit}: {length}");
        }
    }
}
