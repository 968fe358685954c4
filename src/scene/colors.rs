//! Storage for the colours of table rows: exact, or packed into a third of the memory.

use rayon::prelude::*;

use crate::color::Rgb;

/// One linear colour in `[0, 1]` per table row.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum SphereColors {
    /// Unrounded, 12 bytes each.
    Exact(Vec<[f32; 3]>),
    /// Rounded, 4 bytes each.
    Packed(Vec<PackedColor>),
}

/// A colour in 32 bits: the square roots of its channels, red and green in 11 bits each, and blue,
/// to which the eye is least sensitive, in 10.
///
/// The error of a channel c is at most `sqrt(c) / 2047 + 2^-24` for red and green, and at most
/// `sqrt(c) / 1023 + 2^-22` for blue; 0 and 1 are exact. From c = 0.01 upwards, the steps of 8-bit
/// sRGB are 12 to 18 times as large for red and green, and 6 to 9 times for blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PackedColor(u32);

/// Maximum value and lowest bit of each channel.
const CHANNELS: [(u32, u32); 3] = [(2047, 21), (2047, 10), (1023, 0)];

impl PackedColor {
    /// The nearest colour that does not exceed `max_color` in any channel.
    pub(super) fn new(color: [f32; 3], max_color: [f32; 3]) -> Self {
        let mut bits = 0;
        for (channel, (most, lowest_bit)) in CHANNELS.into_iter().enumerate() {
            let nearest = (color[channel].sqrt() * most as f32).round() as u32;
            let is_too_bright = unpack(nearest, most) > max_color[channel];
            bits |= (nearest - u32::from(is_too_bright)) << lowest_bit;
        }
        Self(bits)
    }

    /// The most that rounding adds to a channel which is at most `value`.
    pub(super) fn rounding(value: f64) -> f64 {
        value.sqrt() / 1023.0 + 1.0 / f64::from(1 << 22)
    }

    /// The linear colour.
    pub(super) fn get(self) -> [f32; 3] {
        CHANNELS.map(|(most, lowest_bit)| unpack(self.0 >> lowest_bit & most, most))
    }
}

fn unpack(number: u32, most: u32) -> f32 {
    let root = number as f32 / most as f32;
    root * root
}

impl SphereColors {
    /// The colour of a row, counted within its table.
    pub(super) fn get(&self, row: usize) -> Rgb {
        Rgb::from_array(match self {
            Self::Exact(colors) => colors[row],
            Self::Packed(colors) => colors[row].get(),
        })
    }

    /// Number of colours.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Exact(colors) => colors.len(),
            Self::Packed(colors) => colors.len(),
        }
    }

    /// Appends colours, none of which exceeds `brightest`.
    pub(super) fn extend(
        &mut self,
        colors: impl IndexedParallelIterator<Item = [f32; 3]>,
        brightest: [f32; 3],
    ) {
        match self {
            Self::Exact(all) => all.par_extend(colors),
            Self::Packed(all) => {
                all.par_extend(colors.map(|color| PackedColor::new(color, brightest)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn packed(color: [f32; 3]) -> [f32; 3] {
        PackedColor::new(color, [1.0; 3]).get()
    }

    #[test]
    fn packing_is_as_exact_as_it_says() {
        for i in 0..=10_000u16 {
            let c = f32::from(i) / 10_000.0;
            let found = packed([c, 1.0 - c, c * c]);
            let bounds = [c.sqrt() / 2047.0, (1.0 - c).sqrt() / 2047.0, c / 1023.0];
            for (channel, given) in [c, 1.0 - c, c * c].into_iter().enumerate() {
                let bound = bounds[channel] + [1.2e-7, 1.2e-7, 3.6e-7][channel];
                assert!((found[channel] - given).abs() <= bound, "{given}: {found:?}");
                let most = PackedColor::rounding(given.into());
                assert!(f64::from(found[channel] - given) <= most, "{given}: {found:?}");
                assert!((0.0..=1.0).contains(&found[channel]));
            }
            assert_eq!(packed(found), found, "packing twice changes nothing");
        }
        assert_eq!(packed([0.0, 1.0, 0.0]), [0.0, 1.0, 0.0]);
        assert_eq!(packed([1.0, 0.0, 1.0]), [1.0, 0.0, 1.0]);
    }

    #[test]
    fn no_colour_becomes_brighter_than_its_material_allows() {
        for i in 1..1000u16 {
            let brightest = [f32::from(i) / 1000.0; 3];
            let found = PackedColor::new(brightest, brightest).get();
            assert!(found.iter().zip(brightest).all(|(c, most)| *c <= most && most - c < 2e-3));
        }
    }
}
