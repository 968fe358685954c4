//! Heat map of the difference between two images: dark where they agree, bright where they differ,
//! with a scale below.

use crate::color::Rgb;
use crate::draw::heat_color;
use crate::image_io::Picture;

/// Minimum width in pixels. Smaller maps are drawn with larger pixels.
const MIN_WIDTH: usize = 256;
/// Rows of the scale.
const SCALE_ROWS: usize = 12;
/// Rows between the map and its scale.
const GAP: usize = 4;

/// Draws `values`, in rows of `width`, from 0 to `max` (clamped), with a scale below: black at the
/// left is 0, light yellow at the right is `max`.
pub fn draw(values: &[f64], width: usize, max: f64) -> Picture {
    let height = values.len() / width;
    let zoom = MIN_WIDTH.div_ceil(width).max(1);
    let (zoomed_width, zoomed_height) = (width * zoom, height * zoom);
    let total = zoomed_height + GAP + SCALE_ROWS;
    let fraction = |value: f64| if max > 0.0 { (value / max).clamp(0.0, 1.0) } else { 0.0 };
    let pixel = |i: usize| {
        let (x, y) = (i % zoomed_width, i / zoomed_width);
        match y.checked_sub(zoomed_height) {
            None => heat_color(fraction(values[y / zoom * width + x / zoom])),
            Some(below) if below < GAP => Rgb::ONE,
            Some(_) => heat_color(x as f64 / (zoomed_width - 1) as f64),
        }
    };
    let direct: Vec<Rgb> = (0..zoomed_width * total).map(pixel).collect();
    let indirect = vec![Rgb::ZERO; direct.len()];
    Picture { width: zoomed_width, height: total, direct, indirect, ..Picture::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_map_is_enlarged_and_has_its_scale_below() {
        let values = [0.0, 0.25, 0.5, 1.0, 2.0, 0.0];
        let map = draw(&values, 3, 1.0);
        assert_eq!((map.width, map.height), (86 * 3, 86 * 2 + GAP + SCALE_ROWS));
        let at = |x: usize, y: usize| map.beauty(y * map.width + x);
        assert_eq!(at(85, 85), heat_color(0.0));
        assert_eq!(at(86, 0), heat_color(0.25));
        assert_eq!(at(0, 86), heat_color(1.0));
        assert_eq!(at(86, 171), heat_color(1.0));
        assert_eq!(at(0, 171 + GAP), Rgb::ONE);
        assert_eq!(at(0, map.height - 1), heat_color(0.0));
        assert_eq!(at(map.width - 1, map.height - 1), heat_color(1.0));
    }
}
