//! Grids of numbers as an image embedded in a page: PNG in a `data:` URL.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use crate::color::srgb_from_linear;
use crate::image_io::rgba_png;

use super::page::{element, escape};

/// Minimum image width in screen pixels.
const WIDTH: usize = 192;

/// An image with one number per cell.
#[derive(Clone, Debug)]
pub struct Cells {
    /// A short caption.
    pub caption: String,
    /// Number of columns.
    pub width: usize,
    /// Values row by row from the top; NaN for empty cells.
    pub values: Vec<f64>,
    /// The color map.
    pub colors: CellColors,
}

/// Color map for cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CellColors {
    /// From black at 0 to white at this value, through the sRGB curve.
    Light(f64),
    /// Diverging colors: blue at minus this value, white at 0, red at this value.
    Signed(f64),
}

impl Cells {
    /// The image with its caption as HTML; empty without cells.
    pub fn figure(&self) -> String {
        let Some(png) = self.png() else { return String::new() };
        let height = self.values.len() / self.width;
        let zoom = (WIDTH / self.width).max(1);
        let caption = escape(&self.caption);
        let image = format!(
            "<img src=\"data:image/png;base64,{}\" width={} height={} alt=\"{caption}\">",
            STANDARD.encode(png),
            self.width * zoom,
            height * zoom,
        );
        element("figure", "", &(image + &element("figcaption", "", &caption)))
    }

    fn png(&self) -> Option<Vec<u8>> {
        let height = self.values.len().checked_div(self.width)?;
        let bytes: Vec<u8> =
            self.values.iter().flat_map(|&value| color(value, self.colors)).collect();
        rgba_png(u32::try_from(self.width).ok()?, u32::try_from(height).ok()?, &bytes)
    }
}

/// RGBA color of a value. Cells without a value are transparent.
fn color(value: f64, colors: CellColors) -> [u8; 4] {
    if value.is_nan() {
        return [0; 4];
    }
    let byte = |x: f64| (x.clamp(0.0, 1.0) * 255.0).round() as u8;
    match colors {
        CellColors::Light(white) => {
            let grey = byte(f64::from(srgb_from_linear((value / white) as f32)));
            [grey, grey, grey, 255]
        }
        CellColors::Signed(most) => {
            // White at 0; red above, blue below.
            let share = (value / most).clamp(-1.0, 1.0);
            let fade = |least: f64| byte(1.0 - (1.0 - least) * share.abs());
            let strong = if share > 0.0 { [0.75, 0.1, 0.1] } else { [0.1, 0.25, 0.75] };
            let [r, g, b] = strong.map(fade);
            [r, g, b, 255]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_have_colours_and_nothing_is_clear() {
        assert_eq!(color(0.0, CellColors::Signed(4.0)), [255; 4]);
        let [r, _, b, _] = color(9.0, CellColors::Signed(4.0));
        assert!(r > b);
        let [r, _, b, _] = color(-2.0, CellColors::Signed(4.0));
        assert!(r < b);
        assert_eq!(color(f64::NAN, CellColors::Light(1.0)), [0; 4]);
        assert_eq!(color(2.0, CellColors::Light(2.0)), [255; 4]);
    }

    #[test]
    fn a_figure_without_cells_is_left_out() {
        let (caption, colors) = ("c".to_owned(), CellColors::Light(1.0));
        let empty = Cells { caption, width: 0, values: Vec::new(), colors };
        assert_eq!(empty.figure(), "");
        let one = Cells { width: 1, values: vec![0.5], ..empty };
        assert!(one.figure().contains("data:image/png;base64,iVBOR"));
    }
}
