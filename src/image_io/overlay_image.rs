//! An image that is laid over a picture for display.

use crate::color::linear_from_srgb;

/// Premultiplied 8-bit sRGB with alpha, as large as the full picture. Rows run from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OverlayImage {
    /// Width in pixels.
    pub width: usize,
    /// Red, green, blue and alpha of each pixel.
    pub pixels: Vec<[u8; 4]>,
}

impl OverlayImage {
    /// The pixel at a position of the full picture; transparent beyond the image.
    pub(super) fn get(&self, x: usize, y: usize) -> [u8; 4] {
        let is_inside = x < self.width;
        self.pixels.get(y * self.width + x).copied().filter(|_| is_inside).unwrap_or_default()
    }

    /// Lays a pixel over an opaque one.
    pub(super) fn over([over @ .., alpha]: [u8; 4], below: [u8; 3]) -> [u8; 3] {
        let rest = 255 - u32::from(alpha);
        std::array::from_fn(|c| over[c] + div_255(u32::from(below[c]) * rest) as u8)
    }

    /// Lays a pixel over one that is not opaque and not premultiplied.
    pub(super) fn over_alpha(
        [over @ .., alpha]: [u8; 4],
        below: [u8; 3],
        below_alpha: u8,
    ) -> [u8; 4] {
        let rest = div_255(u32::from(below_alpha) * (255 - u32::from(alpha)));
        let all = u32::from(alpha) + rest;
        let color = |c: usize| {
            let sum = u32::from(over[c]) * 255 + u32::from(below[c]) * rest;
            (sum + all / 2).checked_div(all).map_or(0, |color| color.min(255) as u8)
        };
        [color(0), color(1), color(2), all as u8]
    }

    /// The channels of a file of this size in linear light: red, green, blue, premultiplied, and
    /// alpha. `left` and `top` say where the file is in the full picture.
    pub(super) fn linear_channels(
        &self,
        [width, height]: [usize; 2],
        [left, top]: [usize; 2],
    ) -> [(&'static str, Vec<f32>); 4] {
        let position = |pixel: usize| (left + pixel % width, top + pixel / width);
        let value = |pixel: usize, channel: usize| {
            let (x, y) = position(pixel);
            let pixel = self.get(x, y).map(|value| f32::from(value) / 255.0);
            match (channel, pixel[3]) {
                (3, alpha) => alpha,
                (_, 0.0) => 0.0,
                (_, alpha) => linear_from_srgb((pixel[channel] / alpha).min(1.0)) * alpha,
            }
        };
        let channel = |channel| (0..width * height).map(|pixel| value(pixel, channel)).collect();
        [
            ("overlay.R", channel(0)),
            ("overlay.G", channel(1)),
            ("overlay.B", channel(2)),
            ("overlay.A", channel(3)),
        ]
    }
}

/// Division by 255, rounded.
fn div_255(x: u32) -> u32 {
    (x + 127) / 255
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transparent_pixels_change_nothing_and_opaque_ones_replace() {
        for value in [0, 1, 127, 254, 255] {
            let below = [value, 255 - value, 7];
            assert_eq!(OverlayImage::over([0; 4], below), below);
            assert_eq!(OverlayImage::over([9, 8, 7, 255], below), [9, 8, 7]);
            let [r, g, b] = below;
            assert_eq!(OverlayImage::over_alpha([0; 4], below, 200), [r, g, b, 200]);
            assert_eq!(OverlayImage::over_alpha([9, 8, 7, 255], below, 3), [9, 8, 7, 255]);
        }
        assert_eq!(OverlayImage::over_alpha([0; 4], [5; 3], 0)[3], 0);
    }

    #[test]
    fn no_blend_leaves_its_range() {
        for alpha in 0..=255u8 {
            for below in [0, 100, 255] {
                let [r, _, _] = OverlayImage::over([alpha, 0, 0, alpha], [below; 3]);
                assert!(r >= below.min(alpha), "{alpha} {below}");
            }
        }
    }
}
