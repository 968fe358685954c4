//! Draws an overlay.

use crate::appearance::ValueRange;
use crate::image_io::OverlayImage;

use super::bar::Bar;
use super::canvas::{Area, Canvas, Ink};
use super::categories::Categories;
use super::spec::{LegendSpec, OverlaySpec};
use super::text::TextFont;
use super::tripod::draw_tripod;

/// Distance of everything from the edge of the picture, in ems.
const MARGIN: f64 = 1.4;

/// Height of the colour bar in heights of the picture.
const BAR_HEIGHT: f64 = 0.52;

impl OverlaySpec {
    /// Draws the overlay.
    pub fn draw(&self) -> OverlayImage {
        let mut canvas = Canvas::new(self.size);
        let [width, height] = self.size.map(f64::from);
        // A record in a picture may say anything.
        let font = TextFont::new(self.font_pixels.clamp(1.0, (0.2 * height).max(1.0)));
        let ink: Ink = if self.light_ink { [0.93; 3] } else { [0.13; 3] };
        let margin = MARGIN * font.em();
        match &self.legend {
            LegendSpec::Nothing => {}
            LegendSpec::Bar { title, map, ends: [low, high], log, exceeded } => {
                let range = ValueRange { low: *low, high: *high, log: *log };
                let bar = Bar { title, map: *map, range, exceeded: *exceeded };
                let (thickness, tall) = (font.em().round(), (BAR_HEIGHT * height).round());
                let left = (width - margin - bar.width(thickness, tall, &font)).round();
                let top = (0.5 * (height - tall) + 0.4 * font.em()).round();
                let area = Area { left, top, right: left + thickness, bottom: top + tall };
                bar.draw(&mut canvas, area, &font, ink);
            }
            LegendSpec::Categories { title, entries } => {
                let legend = Categories { title, entries, max_height: 0.8 * height };
                let [across, down] = legend.size(&font);
                let corner = [width - margin - across, 0.5 * (height - down)];
                legend.draw(&mut canvas, corner.map(f64::round), &font, ink);
            }
        }
        let bottom = (height - margin).round();
        if let Some(axes) = &self.tripod {
            let length = 3.2 * font.em();
            // All arrows and their labels stay within the margins.
            let room = |axis: usize, sign: f64| {
                let reach = axes.iter().map(|a| (sign * a[axis]).max(0.0)).fold(0.0, f64::max);
                reach * length + 1.2 * font.em()
            };
            let origin = [0.4 * margin + room(0, -1.0), height - 0.4 * margin - room(1, -1.0)];
            draw_tripod(&mut canvas, axes, origin, length, &font);
        }
        if let Some(bar) = &self.scale_bar {
            let left = if self.tripod.is_some() { margin + 7.5 * font.em() } else { margin };
            bar.draw(&mut canvas, [left.round(), bottom], width, &font, ink);
        }
        OverlayImage { width: self.size[0] as usize, pixels: canvas.into_bytes() }
    }

    /// Returns true if nothing is drawn.
    pub fn is_empty(&self) -> bool {
        self.legend == LegendSpec::Nothing && self.scale_bar.is_none() && self.tripod.is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::appearance::ColorMap;
    use crate::overlay::ScaleBarSpec;

    fn spec() -> OverlaySpec {
        OverlaySpec {
            size: [320, 240],
            font_pixels: 12.0,
            light_ink: false,
            legend: LegendSpec::Nothing,
            scale_bar: None,
            tripod: None,
        }
    }

    #[test]
    fn nothing_is_transparent() {
        let image = spec().draw();
        assert_eq!(image.pixels.len(), 320 * 240);
        assert!(spec().is_empty() && image.pixels.iter().all(|pixel| *pixel == [0; 4]));
    }

    #[test]
    fn the_bar_shows_the_colours_of_the_map_in_order() {
        let legend = LegendSpec::Bar {
            title: "energy".to_owned(),
            map: ColorMap::Viridis,
            ends: [-3.0, 7.5],
            log: false,
            exceeded: [false; 2],
        };
        let image = OverlaySpec { legend, ..spec() }.draw();
        // A column of pixels through the middle of the bar: the one with most opaque pixels.
        let opaque = |x: &usize| (0..240).filter(|y| image.pixels[y * 320 + x][3] == 255).count();
        let most = (0..320).map(|x| opaque(&x)).max().unwrap();
        let columns: Vec<usize> = (0..320).filter(|x| opaque(x) == most).collect();
        let middle = columns[columns.len() / 2];
        let bar: Vec<[u8; 4]> = (0..240).map(|y| image.pixels[y * 320 + middle]).collect();
        let bar: Vec<[u8; 4]> = bar.into_iter().filter(|p| p[3] == 255).collect();
        assert!(bar.len() > 100, "{}", bar.len());
        // Without the frame, which is dark.
        let inner = &bar[2..bar.len() - 2];
        for (index, pixel) in inner.iter().enumerate() {
            let position = 1.0 - (index as f64 + 2.5) / bar.len() as f64;
            let expected = ColorMap::Viridis.srgb(position);
            for (found, expected) in pixel.iter().zip(expected) {
                assert!((f32::from(*found) - expected * 255.0).abs() < 3.0, "{index}: {pixel:?}");
            }
        }
    }

    #[test]
    fn an_end_with_numbers_beyond_it_is_pointed() {
        let drawn = |exceeded| {
            let (title, map) = (String::new(), ColorMap::Viridis);
            let legend = LegendSpec::Bar { title, map, ends: [0.0, 1.0], log: false, exceeded };
            let pixels = OverlaySpec { legend, ..spec() }.draw().pixels;
            let is_ink = |x: usize, y: usize| pixels[y * 320 + x][3] == 255;
            let middle = (0..320).find(|x| is_ink(*x, 120)).expect("a bar") + 6;
            let rows: Vec<usize> = (0..240).filter(|y| is_ink(middle, *y)).collect();
            let color = |y: usize| pixels[y * 320 + middle].map(f32::from);
            let [top, bottom] = [rows[0], rows[rows.len() - 1]];
            (top, bottom, color(top + 6), color(bottom - 6))
        };
        let (top, bottom, ..) = drawn([false; 2]);
        let (upper, lower, above, below) = drawn([true; 2]);
        assert!((8..12).contains(&(top - upper)) && (8..12).contains(&(lower - bottom)));
        for (found, position) in [(above, 1.0), (below, 0.0)] {
            let expected = ColorMap::Viridis.srgb(position).map(|channel| 255.0 * channel);
            let is_near = |(found, expected): (&f32, &f32)| (found - expected).abs() < 3.0;
            assert!(found.iter().zip(&expected).all(is_near), "{found:?} {expected:?}");
        }
        assert_eq!(drawn([true, false]).0, top);
    }

    #[test]
    fn everything_at_once_stays_inside_and_apart_from_the_middle() {
        let legend = LegendSpec::Categories {
            title: "type".to_owned(),
            entries: (0..40).map(|i| (format!("kind {i}"), [200, 30, 30])).collect(),
        };
        let scale_bar = Some(ScaleBarSpec { pixels_per_unit: 3.0, unit: "Å".to_owned() });
        let tripod = Some([[0.8, -0.2], [-0.5, -0.3], [0.0, 0.9]]);
        let image = OverlaySpec { legend, scale_bar, tripod, ..spec() }.draw();
        let is_drawn = |x: usize, y: usize| image.pixels[y * 320 + x][3] > 0;
        assert!((0..320).all(|x| !is_drawn(x, 239)) && (0..240).all(|y| !is_drawn(319, y)));
        assert!((100..220).all(|x| (60..180).all(|y| !is_drawn(x, y))));
        assert!((0..100).any(|x| (180..240).any(|y| is_drawn(x, y))), "axes and scale bar");
        assert!((230..320).any(|x| (0..240).any(|y| is_drawn(x, y))), "legend");
    }
}
