//! The axes as arrows from one point.

use super::canvas::{Canvas, Ink};
use super::text::{Align, TextFont};

/// Names and sRGB colours of the axes.
const AXES: [(&str, Ink); 3] =
    [("x", [0.78, 0.16, 0.16]), ("y", [0.18, 0.55, 0.20]), ("z", [0.16, 0.35, 0.80])];

/// Draws the axes; each is given as its share of `length` to the right and up.
pub(super) fn draw_tripod(
    canvas: &mut Canvas,
    axes: &[[f64; 2]; 3],
    origin: [f64; 2],
    length: f64,
    font: &TextFont,
) {
    let width = (0.13 * font.em()).max(1.5);
    let at = |[right, up]: [f64; 2], share: f64| {
        [origin[0] + right * length * share, origin[1] - up * length * share]
    };
    for ((name, ink), axis) in AXES.iter().zip(axes) {
        let size = axis[0].hypot(axis[1]);
        canvas.line(origin, at(*axis, 1.0), width, *ink);
        if size < 0.15 {
            continue;
        }
        let (along, across) = ([axis[0] / size, axis[1] / size], [-axis[1] / size, axis[0] / size]);
        let head = (0.16 * size.max(0.4)).min(0.2);
        for side in [-1.0, 1.0] {
            let barb = [0, 1].map(|i| axis[i] - head * (along[i] + 0.55 * side * across[i]));
            canvas.line(at(barb, 1.0), at(*axis, 1.0), width, *ink);
        }
        let beyond = [0, 1].map(|i| axis[i] + along[i] * 0.75 * font.em() / length);
        let [x, y] = at(beyond, 1.0);
        font.draw(canvas, name, [x, y + 0.28 * font.em()], Align::Center, *ink);
    }
}
