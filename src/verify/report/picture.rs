//! Figures as pictures inside the page: PNG as `data:` addresses.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use crate::color::srgb_from_linear;
use crate::image_io::rgba_png;
use crate::verify::check::{Figure, Scale};

use super::html::{element, escape};

/// Screen pixels that a figure is at least wide.
const WIDTH: usize = 192;

/// A figure with its caption.
pub(super) fn figure(figure: &Figure) -> String {
    let Some(png) = png(figure) else { return String::new() };
    let height = figure.values.len() / figure.width;
    let zoom = (WIDTH / figure.width).max(1);
    let image = format!(
        "<img src=\"data:image/png;base64,{}\" width={} height={} alt=\"{}\">",
        STANDARD.encode(png),
        figure.width * zoom,
        height * zoom,
        escape(&figure.caption)
    );
    element("figure", "", &(image + &element("figcaption", "", &escape(&figure.caption))))
}

/// `None` for a figure without cells.
fn png(figure: &Figure) -> Option<Vec<u8>> {
    let height = figure.values.len().checked_div(figure.width)?;
    let bytes: Vec<u8> =
        figure.values.iter().flat_map(|&value| color(value, figure.scale)).collect();
    let (width, height) = (u32::try_from(figure.width).ok()?, u32::try_from(height).ok()?);
    rgba_png(width, height, &bytes)
}

/// Red, green, blue and opacity. Cells without a value are clear.
fn color(value: f64, scale: Scale) -> [u8; 4] {
    if value.is_nan() {
        return [0; 4];
    }
    let byte = |x: f64| (x.clamp(0.0, 1.0) * 255.0).round() as u8;
    match scale {
        Scale::Light(white) => {
            let grey = byte(f64::from(srgb_from_linear((value / white) as f32)));
            [grey, grey, grey, 255]
        }
        Scale::Signed(most) => {
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
        assert_eq!(color(0.0, Scale::Signed(4.0)), [255; 4]);
        let [r, _, b, _] = color(9.0, Scale::Signed(4.0));
        assert!(r > b);
        let [r, _, b, _] = color(-2.0, Scale::Signed(4.0));
        assert!(r < b);
        assert_eq!(color(f64::NAN, Scale::Light(1.0)), [0; 4]);
        assert_eq!(color(2.0, Scale::Light(2.0)), [255; 4]);
    }

    #[test]
    fn a_figure_without_cells_is_left_out() {
        let empty =
            Figure { caption: "c".into(), width: 0, values: Vec::new(), scale: Scale::Light(1.0) };
        assert_eq!(figure(&empty), "");
        let one = Figure { width: 1, values: vec![0.5], ..empty };
        assert!(figure(&one).contains("data:image/png;base64,iVBOR"));
    }
}
