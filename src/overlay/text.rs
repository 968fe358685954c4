//! Text in the embedded font: DejaVu Sans, whose licence is beside it.

use ab_glyph::{Font, FontRef, Glyph, GlyphId, PxScale, ScaleFont, point};

use super::canvas::{Canvas, Ink};

static FONT: &[u8] = include_bytes!("font/DejaVuSans.ttf");

/// The font in one size.
pub(super) struct TextFont {
    font: FontRef<'static>,
    scale: PxScale,
    em: f64,
}

/// Where a text is placed about its point, horizontally.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Align {
    Left,
    Center,
}

impl TextFont {
    /// The font with an em of so many pixels.
    pub(super) fn new(em: f64) -> Self {
        let font = FontRef::try_from_slice(FONT).expect("the embedded font is a font");
        let units = font.units_per_em().unwrap_or(2048.0);
        let scale = PxScale::from(em as f32 * font.height_unscaled() / units);
        Self { font, scale, em }
    }

    /// The em in pixels.
    pub(super) fn em(&self) -> f64 {
        self.em
    }

    /// Height of capital letters.
    pub(super) fn cap_height(&self) -> f64 {
        0.729 * self.em
    }

    /// Width of a text in pixels.
    pub(super) fn width(&self, text: &str) -> f64 {
        self.glyphs(text).1
    }

    /// The glyphs with their horizontal positions, and the width of all.
    fn glyphs(&self, text: &str) -> (Vec<(GlyphId, f32)>, f64) {
        let scaled = self.font.as_scaled(self.scale);
        let mut at = 0.0;
        let mut last = None;
        let mut glyphs = Vec::new();
        for c in text.chars() {
            let id = self.font.glyph_id(c);
            at += last.map_or(0.0, |last| scaled.kern(last, id));
            glyphs.push((id, at));
            at += scaled.h_advance(id);
            last = Some(id);
        }
        (glyphs, f64::from(at))
    }

    /// Draws a text whose baseline starts at or is centred on a point.
    pub(super) fn draw(
        &self,
        canvas: &mut Canvas,
        text: &str,
        [x, baseline]: [f64; 2],
        align: Align,
        ink: Ink,
    ) {
        let (glyphs, width) = self.glyphs(text);
        let left = match align {
            Align::Left => x,
            Align::Center => x - 0.5 * width,
        };
        for (id, offset) in glyphs {
            let position = point(left as f32 + offset, baseline as f32);
            let glyph: Glyph = id.with_scale_and_position(self.scale, position);
            let Some(outline) = self.font.outline_glyph(glyph) else { continue };
            let corner = outline.px_bounds().min;
            outline.draw(|x, y, coverage| {
                let (x, y) = (corner.x as i64 + i64::from(x), corner.y as i64 + i64::from(y));
                canvas.blend(x, y, ink, coverage);
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The characters of tick labels, units and the names of columns.
    #[test]
    fn the_font_has_what_labels_need() {
        let font = TextFont::new(20.0);
        for c in ('!'..='~').chain("Åµ°±×⁻⁰¹²³⁴⁵⁶⁷⁸⁹−αβγεσπΔΩ√·…éüßÅ₂".chars())
        {
            assert_ne!(font.font.glyph_id(c), GlyphId(0), "{c}");
        }
    }

    #[test]
    fn texts_are_drawn_where_they_are_placed() {
        let font = TextFont::new(16.0);
        assert!((font.width("mm") - 2.0 * font.width("m")).abs() < 0.5);
        for (align, expected) in [(Align::Left, 50..78), (Align::Center, 36..64)] {
            let mut canvas = Canvas::new([100, 30]);
            font.draw(&mut canvas, "MM", [50.0, 20.0], align, [1.0; 3]);
            let bytes = canvas.into_bytes();
            let columns = (0..100).filter(|x| (0..30).any(|y| bytes[y * 100 + x][3] > 0));
            let columns: Vec<usize> = columns.collect();
            assert!(
                expected.contains(&columns[0]) && expected.contains(&columns[columns.len() - 1])
            );
            // Capitals stand on the baseline.
            assert!((0..100).all(|x| bytes[20 * 100 + x][3] == 0));
            assert!((0..100).any(|x| bytes[19 * 100 + x][3] > 0));
        }
    }
}
