//! Heat map of the difference between two images: dark where they agree, bright where they differ,
//! with a scale below.

use crate::color::Rgb;
use crate::draw::heat_color;
use crate::image_io::Picture;

/// Minimum width in pixels. Smaller maps are drawn with larger pixels.
const NARROWEST: usize = 256;
/// Rows of the scale.
const SCALE_ROWS: usize = 12;
/// Rows between the map and its scale.
const GAP: usize = 4;

/// Draws `values`, in rows of `width`, from 0 to `most` (clamped), with a scale below: black at the
/// left is 0, light yellow at the right is `most`.
pub fn draw(values: &[f64], width: usize, most: f64) -> Picture {
    let height = values.len() / width;
    let zoom = NARROWEST.div_ceil(width).max(1);
    let (wide, high) = (width * zoom, height * zoom);
    let total = high + GAP + SCALE_ROWS;
    let share = |value: f64| if most > 0.0 { (value / most).clamp(0.0, 1.0) } else { 0.0 };
    let pixel = |i: usize| {
        let (x, y) = (i % wide, i / wide);
        match y.checked_sub(high) {
            None => heat_color(share(values[y / zoom * width + x / zoom])),
            Some(below) if below < GAP => Rgb::ONE,
            Some(_) => heat_color(x as f64 / (wide - 1) as f64),
        }
    };
    let direct: Vec<Rgb> = (0..wide * total).map(pixel).collect();
    let indirect = vec![Rgb::ZERO; direct.len()];
    Picture { width: wide, height: total, direct, indirect, ..Picture::default() }
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
