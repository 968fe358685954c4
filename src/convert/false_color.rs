//! Colours for numbers, ids and coordinates. They are display values: no view transform applies.

use crate::appearance::{ColorMap, ValueRange, palette};
use crate::color::{Rgb, linear_from_srgb};
use crate::error::{Error, Result};
use crate::image_io::OverlayImage;
use crate::overlay::{LegendSpec, OverlaySpec, font_pixels};

use super::options::ConvertOptions;

/// A picture of numbers.
pub(super) struct FalseColorPicture {
    /// Linear colours whose sRGB values are those of the map; black where nothing is.
    pub(super) pixels: Vec<Rgb>,
    /// 0 where there is no number to show, else 1.
    pub(super) alpha: Option<Vec<f32>>,
    /// The colour bar.
    pub(super) overlay: Option<OverlaySpec>,
    /// What was done, for the record.
    pub(super) done: String,
}

/// Shows numbers by a colour map, with a colour bar.
///
/// # Errors
/// If no pixel has a number that the range could be taken from.
pub(super) fn numbers(
    layer: &str,
    values: &[f64],
    [width, height]: [usize; 2],
    options: &ConvertOptions,
) -> Result<FalseColorPicture> {
    let colors = &options.false_colors;
    let range =
        colors.range.resolve(values, colors.log).ok_or_else(|| no_numbers(layer, colors.log))?;
    let map = colors.map.unwrap_or_default();
    // Infinite depths are where there is nothing.
    let is_shown = |value: &f64| value.is_finite() && (!range.log || *value > 0.0);
    let pixel = |value: &f64| match is_shown(value) {
        true => map.linear(range.position(*value)),
        false => Rgb::ZERO,
    };
    let pixels: Vec<Rgb> = values.iter().map(pixel).collect();
    let alpha = coverage(values.iter().map(is_shown));
    let ends = [range.low, range.high];
    let legend = LegendSpec::Bar {
        title: options.overlay.title.clone().unwrap_or_else(|| layer.replace('_', " ")),
        map,
        ends,
        log: range.log,
        exceeded: range.exceeded_by(values, |value| is_shown(&value)),
    };
    let overlay = options.overlay.legend.then(|| OverlaySpec {
        size: [width as u32, height as u32],
        font_pixels: font_pixels(&options.overlay, height as u32, options.dpi),
        // On the plate.
        light_ink: false,
        legend,
        scale_bar: None,
        tripod: None,
    });
    Ok(FalseColorPicture { pixels, alpha, overlay, done: description(map, &range) })
}

fn description(map: ColorMap, range: &ValueRange) -> String {
    let log = if range.log { ", logarithmic" } else { "" };
    format!("colour map {} from {} to {}{log}", map.name(), rounded(range.low), rounded(range.high))
}

fn no_numbers(layer: &str, log: bool) -> Error {
    let (which, help) = match log {
        true => ("positive ", "a logarithm needs positive numbers, also at the ends of the range"),
        false => ("", "nothing is seen there"),
    };
    Error::input(format!("the layer `{layer}` has no {which}number")).with_help(help)
}

/// Shows ids by colours that differ from those of their neighbours' in most cases.
pub(super) fn ids(values: &[f64]) -> FalseColorPicture {
    /// Colours of the palette, each in so many degrees of brightness.
    const SHADES: usize = 4;
    let color = |id: &f64| {
        // Fibonacci hashing spreads neighbouring ids over all colours.
        let mixed = (*id as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40;
        let shade = 1.0 - 0.2 * ((mixed as usize / 10) % SHADES) as f32;
        palette(mixed as usize % 10) * shade
    };
    let pixel = |id: &f64| if id.is_finite() { color(id) } else { Rgb::ZERO };
    FalseColorPicture {
        pixels: values.iter().map(pixel).collect(),
        alpha: coverage(values.iter().map(|id| id.is_finite())),
        overlay: None,
        done: "a colour for each id".to_owned(),
    }
}

/// Shows coordinates as red, green and blue: unit vectors from -1 to 1, others from the least to
/// the greatest value of each axis.
pub(super) fn vectors(values: &[Rgb], are_unit: bool) -> FalseColorPicture {
    let finite = || values.iter().filter(|value| value.is_finite());
    let (low, high) = match are_unit {
        true => (Rgb::NEG_ONE, Rgb::ONE),
        false => (
            finite().copied().fold(Rgb::INFINITY, Rgb::min),
            finite().copied().fold(Rgb::NEG_INFINITY, Rgb::max),
        ),
    };
    // A unit vector is never 0.
    let is_shown = |value: &Rgb| value.is_finite() && !(are_unit && *value == Rgb::ZERO);
    let pixel = |value: &Rgb| match is_shown(value) {
        true => {
            // A mean over the edge of a surface is shorter.
            let value = if are_unit { value.normalize_or_zero() } else { *value };
            let position = (value - low) / (high - low).max(Rgb::splat(f32::MIN_POSITIVE));
            position.clamp(Rgb::ZERO, Rgb::ONE).map(linear_from_srgb)
        }
        false => Rgb::ZERO,
    };
    FalseColorPicture {
        pixels: values.iter().map(pixel).collect(),
        alpha: coverage(values.iter().map(is_shown)),
        overlay: None,
        done: "coordinates as red, green and blue".to_owned(),
    }
}

/// The opacities; `None` if all pixels show something.
fn coverage(is_shown: impl Iterator<Item = bool>) -> Option<Vec<f32>> {
    let alpha: Vec<f32> = is_shown.map(|is_shown| if is_shown { 1.0 } else { 0.0 }).collect();
    alpha.contains(&0.0).then_some(alpha)
}

/// Puts a light plate under what is drawn, so that dark texts can be read on all colours.
pub(super) fn with_plate(mut bar: OverlayImage, margin: usize) -> OverlayImage {
    /// White, premultiplied with an opacity of four fifths.
    const PLATE: u32 = 204;
    let width = bar.width.max(1);
    let drawn: Vec<[usize; 2]> = (0..bar.pixels.len())
        .filter(|&at| bar.pixels[at][3] > 0)
        .map(|at| [at % width, at / width])
        .collect();
    let ends = |axis: usize| {
        let places = drawn.iter().map(|place| place[axis]);
        let (low, high) = (places.clone().min()?, places.max()?);
        Some(low.saturating_sub(margin)..high + margin + 1)
    };
    let (Some(columns), Some(rows)) = (ends(0), ends(1)) else { return bar };
    for (at, pixel) in bar.pixels.iter_mut().enumerate() {
        if columns.contains(&(at % width)) && rows.contains(&(at / width)) {
            let under = PLATE * (255 - u32::from(pixel[3])) / 255;
            *pixel = pixel.map(|value| (u32::from(value) + under).min(255) as u8);
        }
    }
    bar
}

/// Five digits of a number, enough for a record.
fn rounded(value: f64) -> f64 {
    format!("{value:.4e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plate_lies_under_the_bar_alone() {
        let mut pixels = vec![[0; 4]; 20 * 10];
        (pixels[5 * 20 + 8], pixels[7 * 20 + 9]) = ([10, 20, 30, 255], [0, 0, 0, 128]);
        let bar = with_plate(OverlayImage { width: 20, pixels }, 2);
        let at = |x: usize, y: usize| bar.pixels[y * 20 + x];
        assert_eq!(at(8, 5), [10, 20, 30, 255]);
        assert_eq!((at(6, 3), at(11, 9)), ([204; 4], [204; 4]));
        assert_eq!((at(5, 3), at(12, 9), at(6, 2)), ([0; 4], [0; 4], [0; 4]));
        assert_eq!(at(9, 7), [101, 101, 101, 229]);
        let none = OverlayImage { width: 3, pixels: vec![[0; 4]; 6] };
        assert_eq!(with_plate(none.clone(), 5), none);
    }

    #[test]
    fn what_has_no_number_is_transparent() {
        let options = ConvertOptions::default();
        let values = [1.0, f64::INFINITY, 3.0, f64::NAN];
        let shown = numbers("depth", &values, [2, 2], &options).unwrap();
        assert_eq!(shown.alpha, Some(vec![1.0, 0.0, 1.0, 0.0]));
        assert_eq!(shown.pixels[2], ColorMap::Viridis.linear(1.0));
        assert_eq!(shown.done, "colour map viridis from 1 to 3");
        assert!(numbers("depth", &[f64::NAN; 4], [2, 2], &options).is_err());
        // At a silhouette, a mean of unit vectors is shorter, and is shown as if it were not.
        let edge = vectors(&[Rgb::new(0.0, 0.5, 0.0), Rgb::ZERO], true);
        assert_eq!(edge.alpha, Some(vec![1.0, 0.0]));
        assert!((edge.pixels[0].y - 1.0).abs() < 1e-6);
    }
}
