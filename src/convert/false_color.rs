//! Colours for numbers, ids and coordinates. They are display values: no view transform applies.

use crate::appearance::{ColorMap, ValueRange, palette};
use crate::color::{Rgb, linear_from_srgb, luminance};
use crate::error::{Error, Result};
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
    };
    let overlay = options.overlay.legend.then(|| OverlaySpec {
        size: [width as u32, height as u32],
        font_pixels: font_pixels(&options.overlay, height as u32, options.dpi),
        light_ink: is_dark_right(&pixels, alpha.as_deref(), width),
        legend,
        scale_bar: None,
        tripod: None,
    });
    Ok(FalseColorPicture { pixels, alpha, overlay, done: description(map, &range) })
}

fn description(map: ColorMap, range: &ValueRange) -> String {
    let log = if range.log { ", logarithmic" } else { "" };
    format!("colour map {} from {} to {}{log}", map.name(), range.low, range.high)
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
            let position = (*value - low) / (high - low).max(Rgb::splat(f32::MIN_POSITIVE));
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

/// Returns true if the right of the picture, where the colour bar is, is dark. What is transparent
/// counts as paper.
fn is_dark_right(pixels: &[Rgb], alpha: Option<&[f32]>, width: usize) -> bool {
    /// The right fifth of the picture.
    const BAR_WIDTH: usize = 5;
    let is_right = |at: &usize| at % width >= width - width.div_ceil(BAR_WIDTH);
    let light = |at: usize| match alpha.map_or(1.0, |alpha| alpha[at]) {
        0.0 => 1.0,
        _ => luminance(pixels[at]),
    };
    let right = (0..pixels.len()).filter(is_right);
    let (sum, count) = right.fold((0.0, 0.0), |(sum, count), at| (sum + light(at), count + 1.0f32));
    sum < 0.18 * count
}
