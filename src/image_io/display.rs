//! The pixels of a picture for the screen: through the view transform, under the overlay, rounded.

use std::ops::Range;

use crate::color::Rgb;
use crate::task::parallel;

use super::notes::{CropWindow, WriteOptions};
use super::overlay_image::OverlayImage;
use super::picture::Picture;

/// Rows encoded by one task.
const ROWS_PER_TASK: usize = 16;

/// The pixels of a PNG file in 8 bits, row by row: red, green and blue, and alpha if the picture
/// has it.
pub fn display_pixels(picture: &Picture, notes: &WriteOptions) -> Vec<u8> {
    by_rows(picture, |rows| encode_rows(picture, notes, rows))
}

/// The pixels of a PNG file in 16 bits, the high byte first. Nothing is dithered: the steps are
/// finer than any screen's.
pub(super) fn deep_pixels(picture: &Picture, notes: &WriteOptions) -> Vec<u8> {
    by_rows(picture, |rows| encode_deep_rows(picture, notes, rows))
}

/// Encodes some rows at a time, in parallel.
fn by_rows(picture: &Picture, encode: impl Fn(Range<usize>) -> Vec<u8> + Send + Sync) -> Vec<u8> {
    let rows = (0..picture.height)
        .step_by(ROWS_PER_TASK)
        .map(|row| row..(row + ROWS_PER_TASK).min(picture.height));
    parallel::map(rows.collect(), encode).concat()
}

/// A pixel to encode.
struct Source {
    /// Light, not premultiplied.
    light: Rgb,
    alpha: Option<f32>,
    /// What lies over the pixel.
    over: Option<[u8; 4]>,
    /// Column and row in the full picture.
    place: [usize; 2],
}

fn sources<'a>(
    picture: &'a Picture,
    notes: &'a WriteOptions,
    rows: Range<usize>,
) -> impl Iterator<Item = Source> + 'a {
    let [left, top] = notes.crop_window.map_or([0; 2], |CropWindow { offset: corner, .. }| corner);
    let pixels = rows.start * picture.width..rows.end * picture.width;
    pixels.map(move |pixel| {
        let place = [left + pixel % picture.width, top + pixel / picture.width];
        let alpha = picture.alpha.as_ref().map(|alpha| alpha[pixel]);
        let covered = match alpha {
            None => 1.0,
            Some(alpha) if alpha > 0.0 => 1.0 / alpha,
            Some(_) => 0.0,
        };
        let over = notes.overlay.as_ref().map(|overlay| overlay.get(place[0], place[1]));
        Source {
            light: picture.finite_beauty(pixel) * covered,
            alpha,
            over: over.filter(|over| over[3] > 0),
            place,
        }
    })
}

fn encode_rows(picture: &Picture, notes: &WriteOptions, rows: Range<usize>) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(4 * rows.len() * picture.width);
    for Source { light, alpha, over, place: [x, y] } in sources(picture, notes, rows) {
        let color = notes.view_transform.to_display_8bit(light, x, y);
        let alpha = alpha.map(|alpha| (alpha * 255.0).round() as u8);
        match (over, alpha) {
            (None, alpha) => {
                bytes.extend(color);
                bytes.extend(alpha);
            }
            (Some(over), None) => bytes.extend(OverlayImage::over(over, color)),
            (Some(over), Some(alpha)) => {
                bytes.extend(OverlayImage::over_alpha(over, color, alpha));
            }
        }
    }
    bytes
}

fn encode_deep_rows(picture: &Picture, notes: &WriteOptions, rows: Range<usize>) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(8 * rows.len() * picture.width);
    for Source { light, alpha, over, .. } in sources(picture, notes, rows) {
        let below = notes.view_transform.to_display(light);
        let [color @ .., alpha_over] = over.unwrap_or_default().map(|v| f32::from(v) / 255.0);
        let rest = alpha.unwrap_or(1.0) * (1.0 - alpha_over);
        let all = alpha_over + rest;
        let blend = |c: usize| if all > 0.0 { (color[c] + below[c] * rest) / all } else { 0.0 };
        let level = |value: f32| ((value * 65535.0).round() as u16).to_be_bytes();
        let channels = [blend(0), blend(1), blend(2)].into_iter().chain(alpha.map(|_| all));
        bytes.extend(channels.flat_map(level));
    }
    bytes
}
