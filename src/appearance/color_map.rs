//! Colour maps: tables of 256 sRGB colours, converted to linear Rec. 709 for rendering.
//!
//! The tables are written by `scripts/make-appearance-data.py`, which names their authors and
//! licences. A map drawn without the conversion would look washed out, and its numbers could not be
//! read off a colour bar.

use crate::color::{Rgb, linear_from_srgb};
use crate::names::named_enum;

/// A colour map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorMap {
    /// matplotlib's default.
    #[default]
    Viridis,
    /// From blue to yellow over magenta.
    Plasma,
    /// From black to yellow over red.
    Inferno,
    /// From black to white over purple.
    Magma,
    /// From blue to yellow, alike to most people with colour vision deficiencies.
    Cividis,
    /// A rainbow whose lightness is smooth.
    Turbo,
    /// Diverging, from blue to red over grey.
    Coolwarm,
    /// Cyclic.
    Twilight,
    /// From black to white.
    Gray,
    /// Crameri's default.
    Batlow,
    /// Diverging, from blue to brown over white.
    Vik,
    /// Diverging, from red to blue over yellow.
    Roma,
    /// From wine red to light blue.
    Hawaii,
    /// From light yellow to black.
    Lajolla,
    /// From black to white over blue.
    Oslo,
    /// Cyclic.
    RomaO,
    /// For temperatures.
    Thermal,
    /// For salinities.
    Haline,
    /// From light yellow to dark blue.
    Deep,
    /// Diverging, from blue to red over white.
    Balance,
}

named_enum! {
    ColorMap {
        Viridis = "viridis",
        Plasma = "plasma",
        Inferno = "inferno",
        Magma = "magma",
        Cividis = "cividis",
        Turbo = "turbo",
        Coolwarm = "coolwarm",
        Twilight = "twilight",
        Gray = "gray",
        Batlow = "batlow",
        Vik = "vik",
        Roma = "roma",
        Hawaii = "hawaii",
        Lajolla = "lajolla",
        Oslo = "oslo",
        RomaO = "romaO",
        Thermal = "thermal",
        Haline = "haline",
        Deep = "deep",
        Balance = "balance",
    }
}

/// Colours of a map.
const STEPS: usize = 256;

/// The maps in the order of [`ColorMap::NAMES`].
static TABLES: &[u8] = include_bytes!("data/colormaps.bin");

impl ColorMap {
    fn table(self) -> &'static [u8] {
        let bytes = 3 * STEPS;
        &TABLES[self as usize * bytes..][..bytes]
    }

    /// The sRGB colour at a position in `[0, 1]`, with channels in `[0, 1]`, interpolated between
    /// the steps of the table. Positions outside are clamped; NaN is 0.
    pub fn srgb(self, position: f64) -> [f32; 3] {
        let at = position.clamp(0.0, 1.0).max(0.0) * (STEPS - 1) as f64;
        let low = (at as usize).min(STEPS - 2);
        let rest = (at - low as f64) as f32;
        let table = self.table();
        std::array::from_fn(|channel| {
            let [low, high] = [low, low + 1].map(|step| f32::from(table[3 * step + channel]));
            (low + (high - low) * rest) / 255.0
        })
    }

    /// The colour at a position in `[0, 1]`, in linear Rec. 709.
    pub fn linear(self, position: f64) -> Rgb {
        Rgb::from_array(self.srgb(position).map(linear_from_srgb))
    }

    /// The linear colours at evenly spaced positions from 0 to 1.
    pub fn linear_table(self, steps: usize) -> Vec<[f32; 3]> {
        let last = steps.saturating_sub(1).max(1) as f64;
        (0..steps).map(|step| self.linear(step as f64 / last).to_array()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::{luminance, srgb_from_linear};

    fn bytes(map: ColorMap, position: f64) -> [u8; 3] {
        map.srgb(position).map(|value| (value * 255.0).round() as u8)
    }

    /// Values that the packages that define the maps print.
    #[test]
    fn ends_and_middles_are_as_published() {
        for (map, expected) in [
            (ColorMap::Viridis, [[68, 1, 84], [253, 231, 37]]),
            (ColorMap::Plasma, [[13, 8, 135], [240, 249, 33]]),
            (ColorMap::Inferno, [[0, 0, 4], [252, 255, 164]]),
            (ColorMap::Magma, [[0, 0, 4], [252, 253, 191]]),
            (ColorMap::Cividis, [[0, 34, 78], [254, 232, 56]]),
            (ColorMap::Turbo, [[48, 18, 59], [122, 4, 3]]),
            (ColorMap::Coolwarm, [[59, 76, 192], [180, 4, 38]]),
            (ColorMap::Gray, [[0, 0, 0], [255, 255, 255]]),
        ] {
            assert_eq!([bytes(map, 0.0), bytes(map, 1.0)], expected, "{map:?}");
        }
        // Step 127 of the table.
        assert_eq!(bytes(ColorMap::Viridis, 127.0 / 255.0), [33, 144, 141]);
        assert_eq!(TABLES.len(), ColorMap::NAMES.len() * 3 * STEPS);
    }

    #[test]
    fn conversion_is_undone_by_the_srgb_curve() {
        for (name, map) in ColorMap::NAMES {
            for step in 0..=100 {
                let position = f64::from(step) / 100.0;
                let srgb = map.srgb(position);
                let back = map.linear(position).to_array().map(srgb_from_linear);
                for (given, found) in srgb.into_iter().zip(back) {
                    assert!((given - found).abs() < 1e-5, "{name} at {position}");
                }
            }
        }
    }

    #[test]
    fn sequential_maps_become_lighter_in_one_direction() {
        use ColorMap::{Batlow, Cividis, Gray, Inferno, Magma, Viridis};
        for map in [Viridis, Inferno, Magma, Cividis, Gray, Batlow] {
            let light: Vec<f32> =
                map.linear_table(64).into_iter().map(|c| luminance(Rgb::from_array(c))).collect();
            assert!(light.windows(2).all(|pair| pair[1] > pair[0] - 1e-3), "{map:?}");
        }
    }

    #[test]
    fn positions_outside_are_clamped() {
        let map = ColorMap::Viridis;
        assert_eq!(map.srgb(-3.0), map.srgb(0.0));
        assert_eq!(map.srgb(f64::INFINITY), map.srgb(1.0));
        assert_eq!(map.srgb(f64::NAN), map.srgb(0.0));
    }
}
