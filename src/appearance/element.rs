//! Chemical elements: masses, radii and colours.
//!
//! The table is written by `scripts/make-appearance-data.py`, which names the sources: covalent
//! radii of Cordero et al. (2008) and, beyond curium, Pyykkö and Atsumi (2009); van der Waals radii
//! of the CRC Handbook (95th edition); the colours of Jmol.

use std::sync::LazyLock;

use crate::color::{Rgb, linear_from_srgb};

/// A chemical element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Element {
    /// Atomic number.
    pub number: u8,
    /// Symbol.
    pub symbol: &'static str,
    /// Standard atomic weight, in u.
    pub mass: f64,
    /// Covalent radius, in angstrom.
    pub covalent_radius: f64,
    /// Van der Waals radius, in angstrom, where one is known.
    pub vdw_radius: Option<f64>,
    /// Jmol's colour in 8-bit sRGB.
    pub srgb: [u8; 3],
}

static TABLE: LazyLock<Vec<Element>> = LazyLock::new(|| {
    let lines = include_str!("data/elements.txt").lines().skip(1);
    lines.zip(1..).filter_map(|(line, number)| parse_row(line, number)).collect()
});

/// A row of the table; `None` never happens, as a test checks.
fn parse_row(line: &'static str, number: u8) -> Option<Element> {
    let mut cells = line.split(' ');
    let symbol = cells.next()?;
    let mass = cells.next()?.parse().ok()?;
    let covalent_radius = cells.next()?.parse().ok()?;
    let vdw_radius = cells.next()?.parse().ok();
    let color = u32::from_str_radix(cells.next()?, 16).ok()?;
    let [_, srgb @ ..] = color.to_be_bytes();
    Some(Element { number, symbol, mass, covalent_radius, vdw_radius, srgb })
}

impl Element {
    /// All elements in the order of their numbers.
    pub fn all() -> &'static [Self] {
        &TABLE
    }

    /// The element with this atomic number.
    pub fn with_number(number: u32) -> Option<&'static Self> {
        TABLE.get((number as usize).checked_sub(1)?)
    }

    /// The element with this symbol, regardless of case. `D` and `T` are hydrogen.
    pub fn with_symbol(symbol: &str) -> Option<&'static Self> {
        let symbol = match symbol {
            "D" | "T" => "H",
            other => other,
        };
        TABLE.iter().find(|element| element.symbol.eq_ignore_ascii_case(symbol))
    }

    /// The element that a label names: a symbol or a number, also with an index, a charge or a
    /// suffix, as in `Fe3+`, `C12` or `O_w`.
    pub fn of_label(label: &str) -> Option<&'static Self> {
        let label = label.trim();
        if let Ok(number) = label.parse() {
            return Self::with_number(number);
        }
        let letters = label.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(label.len());
        Self::with_symbol(&label[..letters])
    }

    /// The element whose atomic weight is nearest, if it is within 0.3 u.
    pub fn with_mass(mass: f64) -> Option<&'static Self> {
        let distance = |element: &Self| (element.mass - mass).abs();
        let nearest = TABLE.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        (distance(nearest) < 0.3).then_some(nearest)
    }

    /// Jmol's colour in linear Rec. 709.
    pub fn color(&self) -> Rgb {
        Rgb::from_array(self.srgb.map(|value| linear_from_srgb(f32::from(value) / 255.0)))
    }

    /// The van der Waals radius, in angstrom; where none is known, 2 angstrom.
    pub fn vdw_radius_or_default(&self) -> f64 {
        self.vdw_radius.unwrap_or(2.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_complete() {
        assert_eq!(Element::all().len(), 118);
        for (element, number) in Element::all().iter().zip(1..) {
            assert_eq!(element.number, number);
            assert!((0.2..2.7).contains(&element.covalent_radius), "{element:?}");
            assert!((1.0..3.6).contains(&element.vdw_radius_or_default()), "{element:?}");
            assert_eq!(Element::with_symbol(element.symbol), Some(element));
        }
    }

    /// Values from the papers, and colours from Jmol's page on colours.
    #[test]
    fn some_elements_are_as_published() {
        for (symbol, number, covalent, vdw, srgb) in [
            ("H", 1, 0.31, 1.10, [255, 255, 255]),
            ("C", 6, 0.73, 1.70, [144, 144, 144]),
            ("N", 7, 0.71, 1.55, [48, 80, 248]),
            ("O", 8, 0.66, 1.52, [255, 13, 13]),
            ("S", 16, 1.05, 1.80, [255, 255, 48]),
            ("Au", 79, 1.36, 2.14, [255, 209, 35]),
        ] {
            let element = Element::with_symbol(symbol).unwrap();
            assert_eq!(element.number, number);
            assert_eq!((element.covalent_radius, element.vdw_radius), (covalent, Some(vdw)));
            assert_eq!(element.srgb, srgb);
        }
    }

    #[test]
    fn labels_and_masses_name_elements() {
        for (label, symbol) in [
            ("Fe3+", "Fe"),
            ("C12", "C"),
            ("O_w", "O"),
            ("8", "O"),
            (" cl ", "Cl"),
            ("D", "H"),
            ("NA", "Na"),
            ("U", "U"),
        ] {
            assert_eq!(Element::of_label(label).map(|e| e.symbol), Some(symbol), "{label}");
        }
        for label in ["", "0", "119", "Xx", "12a", "A", "-1", "1.5"] {
            assert_eq!(Element::of_label(label), None, "{label}");
        }
        assert_eq!(Element::with_mass(55.85).map(|e| e.symbol), Some("Fe"));
        assert_eq!(Element::with_mass(58.7).map(|e| e.symbol), Some("Ni"));
        assert_eq!(Element::with_mass(5.5), None);
    }
}
