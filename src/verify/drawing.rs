//! What the plots of this room share: colours, marks, axes, and the size of the page.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Everything is drawn in whole units, half a pixel wide each.
pub(super) const SCALE: u32 = 2;
pub(super) const FONT: &str = "sans-serif";

pub(super) const INK: RGBColor = RGBColor(34, 34, 34);
pub(super) const FAINT: RGBColor = RGBColor(228, 228, 228);
pub(super) const FAINTER: RGBColor = RGBColor(243, 243, 243);
/// Colours that the colour-blind can tell apart (Okabe and Ito 2008).
pub(super) const COLORS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
];

pub(super) type Area<DB> = DrawingArea<DB, Shift>;
pub(super) type Drawn<DB> =
    std::result::Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;
pub(super) type Marker<C, DB> = <EmptyElement<C, DB> as std::ops::Add<Polygon<(i32, i32)>>>::Output;

/// The drawing at its size on the page: its units stay, and are halved by the viewer.
pub(super) fn sized(svg: &str, width: u32, height: u32) -> String {
    svg.replacen(&size(width, height), &size(width / SCALE, height / SCALE), 1)
}

fn size(width: u32, height: u32) -> String {
    format!("<svg width=\"{width}\" height=\"{height}\"")
}

/// Text whose middle left end is at `at`.
pub(super) fn words<'a>(
    text: &'a str,
    at: (i32, i32),
    size: u32,
    color: RGBColor,
) -> Text<'a, (i32, i32), &'a str> {
    let style = (FONT, size * SCALE).into_font().color(&color);
    Text::new(text, at, style.pos(Pos::new(HPos::Left, VPos::Center)))
}

/// The mark of a series: its shape tells it apart as well as its colour.
pub(super) fn marker<C, DB: DrawingBackend>(series: usize, at: C) -> Marker<C, DB> {
    let radius = 3.6 * f64::from(SCALE);
    let (corners, turn) = [(24, 0.0), (3, 0.25), (4, 0.125), (4, 0.0)][series % 4];
    let corner = |i: u32| {
        let turns = turn + f64::from(i) / f64::from(corners);
        let (sin, cos) = crate::sampling::sin_cos(std::f64::consts::TAU * turns);
        ((radius * cos).round() as i32, (-radius * sin).round() as i32)
    };
    let outline: Vec<(i32, i32)> = (0..corners).map(corner).collect();
    EmptyElement::at(at) + Polygon::new(outline, COLORS[series % COLORS.len()].filled())
}

/// A range with some air around the values, in which two powers of ten lie at least.
pub(super) fn range(values: impl Iterator<Item = f64> + Clone) -> Option<Range<f64>> {
    let low = libm::log10(values.clone().fold(f64::INFINITY, f64::min)) - 0.12;
    let high = libm::log10(values.fold(0.0, f64::max)) + 0.12;
    if !(low.is_finite() && high.is_finite()) {
        return None;
    }
    let has_two = high.floor() - low.ceil() >= 1.0;
    let (low, high) = if has_two { (low, high) } else { (low.floor(), high.ceil()) };
    Some(libm::exp10(low)..libm::exp10(high))
}

/// A power of ten as a person writes it.
pub(super) fn decimal(value: f64) -> String {
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
        assert_eq!(range([0.02, 0.3].into_iter()).unwrap(), 0.01..1.0);
        let wide = range([1.0, 64.0].into_iter()).unwrap();
        assert!(wide.start < 1.0 && wide.end > 64.0 && wide.end < 100.0);
        assert_eq!(range(std::iter::empty()), None);
        assert_eq!([1e-3, 1.0, 100.0, 1e5].map(decimal), ["0.001", "1", "100", "1e5"]);
    }
}
