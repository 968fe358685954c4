//! An image with alpha, and anti-aliased shapes on it.

/// A colour of ink in sRGB, each channel in `[0, 1]`.
pub(super) type Ink = [f32; 3];

/// Premultiplied sRGB colours with alpha. Rows run from the top.
pub(super) struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<[f32; 4]>,
}

/// A rectangle in pixels; edges need not be whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Area {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

impl Canvas {
    /// A transparent canvas.
    pub(super) fn new([width, height]: [u32; 2]) -> Self {
        let (width, height) = (width as usize, height as usize);
        Self { width, height, pixels: vec![[0.0; 4]; width * height] }
    }

    /// Lays ink over a pixel; `coverage` is the part of it that is covered. Pixels outside of the
    /// canvas are ignored.
    pub(super) fn blend(&mut self, x: i64, y: i64, ink: Ink, coverage: f32) {
        let is_inside = (0..self.width as i64).contains(&x) && (0..self.height as i64).contains(&y);
        if !is_inside || coverage <= 0.0 {
            return;
        }
        let pixel = &mut self.pixels[y as usize * self.width + x as usize];
        let coverage = coverage.min(1.0);
        for (channel, value) in pixel.iter_mut().enumerate() {
            let ink = if channel < 3 { ink[channel] } else { 1.0 };
            *value += (ink - *value) * coverage;
        }
    }

    /// Fills a rectangle. `ink` is asked for each row.
    pub(super) fn fill_rows(&mut self, area: Area, ink: impl Fn(i64) -> Ink) {
        let overlap = |low: f64, high: f64, pixel: i64| {
            let pixel = pixel as f64;
            (high.min(pixel + 1.0) - low.max(pixel)).max(0.0)
        };
        for y in area.top.floor() as i64..area.bottom.ceil() as i64 {
            let down = overlap(area.top, area.bottom, y);
            for x in area.left.floor() as i64..area.right.ceil() as i64 {
                let across = overlap(area.left, area.right, x);
                self.blend(x, y, ink(y), (across * down) as f32);
            }
        }
    }

    /// Fills a rectangle with one ink.
    pub(super) fn fill(&mut self, area: Area, ink: Ink) {
        self.fill_rows(area, |_| ink);
    }

    /// Draws the frame of a rectangle, inside of it.
    pub(super) fn frame(&mut self, area: Area, width: f64, ink: Ink) {
        let Area { left, top, right, bottom } = area;
        self.fill(Area { bottom: top + width, ..area }, ink);
        self.fill(Area { top: bottom - width, ..area }, ink);
        let sides = Area { top: top + width, bottom: bottom - width, left, right };
        self.fill(Area { right: left + width, ..sides }, ink);
        self.fill(Area { left: right - width, ..sides }, ink);
    }

    /// Draws a line with round ends.
    pub(super) fn line(&mut self, from: [f64; 2], to: [f64; 2], width: f64, ink: Ink) {
        let half = 0.5 * width;
        let along = [to[0] - from[0], to[1] - from[1]];
        let squared = along[0] * along[0] + along[1] * along[1];
        let range = |axis: usize| {
            let (low, high) = (from[axis].min(to[axis]), from[axis].max(to[axis]));
            (low - half - 1.0).floor() as i64..(high + half + 1.0).ceil() as i64
        };
        for y in range(1) {
            for x in range(0) {
                let at = [x as f64 + 0.5 - from[0], y as f64 + 0.5 - from[1]];
                let dot = at[0] * along[0] + at[1] * along[1];
                let share = if squared > 0.0 { (dot / squared).clamp(0.0, 1.0) } else { 0.0 };
                let [dx, dy] = [at[0] - share * along[0], at[1] - share * along[1]];
                let distance = (dx * dx + dy * dy).sqrt();
                self.blend(x, y, ink, (half + 0.5 - distance) as f32);
            }
        }
    }

    /// Fills a disk.
    pub(super) fn disk(&mut self, center: [f64; 2], radius: f64, ink: Ink) {
        self.line(center, center, 2.0 * radius, ink);
    }

    /// The pixels, rounded to 8 bits; premultiplied.
    pub(super) fn into_bytes(self) -> Vec<[u8; 4]> {
        let round = |value: f32| (value * 255.0).round() as u8;
        self.pixels.into_iter().map(|pixel| pixel.map(round)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_pixels_are_filled_and_parts_are_shared() {
        let mut canvas = Canvas::new([4, 3]);
        canvas.fill(Area { left: 1.0, top: 0.5, right: 2.5, bottom: 2.0 }, [1.0, 0.5, 0.0]);
        let bytes = canvas.into_bytes();
        let row = |y: usize| &bytes[4 * y..][..4];
        assert_eq!(row(0), [[0; 4], [128, 64, 0, 128], [64, 32, 0, 64], [0; 4]]);
        assert_eq!(row(1), [[0; 4], [255, 128, 0, 255], [128, 64, 0, 128], [0; 4]]);
        assert_eq!(row(2), [[0; 4]; 4]);
    }

    #[test]
    fn shapes_beyond_the_canvas_are_cut() {
        let mut canvas = Canvas::new([3, 3]);
        canvas.line([-10.0, 1.5], [10.0, 1.5], 1.0, [1.0; 3]);
        let bytes = canvas.into_bytes();
        assert_eq!(bytes[3..6], [[255; 4]; 3]);
        assert!(bytes[..3].iter().all(|pixel| *pixel == [0; 4]), "{bytes:?}");
    }
}
