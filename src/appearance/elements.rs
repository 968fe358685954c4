//! The elements of particles.

use crate::particles::{Categories, Column, ColumnData, Format, Particles, Role};

use super::element::Element;

/// The column with names of atoms.
pub(super) const ATOM_NAME: &str = "name";

/// The element of each particle, as an index into the distinct kinds.
pub(super) struct ParticleElements<'a> {
    /// The kinds; `None` where a label names no element.
    pub(super) kinds: Vec<Option<&'static Element>>,
    codes: Codes<'a>,
}

enum Codes<'a> {
    Words(&'a Categories),
    Numbers(&'a Column),
}

impl ParticleElements<'_> {
    /// What the file calls a particle's element.
    pub(super) fn label(&self, row: usize) -> String {
        match &self.codes {
            Codes::Words(words) => words.word(row).to_owned(),
            Codes::Numbers(column) => column.data.show(row),
        }
    }

    /// Index of a particle's kind.
    #[inline]
    pub(super) fn kind(&self, row: usize) -> usize {
        match &self.codes {
            Codes::Words(words) => words.codes[row] as usize,
            Codes::Numbers(column) => number_kind(column.number(row)),
        }
    }
}

/// Atomic numbers are their own kinds; anything else is kind 0.
fn number_kind(number: f64) -> usize {
    if (1.0..=118.0).contains(&number) { number as usize } else { 0 }
}

/// The elements of particles, from labels, atomic numbers, or types that are labels. `None` if
/// fewer than half of the labels name elements.
pub(super) fn particle_elements(particles: &Particles) -> Option<ParticleElements<'_>> {
    let labels = |role| {
        let column = particles.role(role)?;
        let ColumnData::Text(words) = &column.data else { return None };
        let kinds: Vec<_> = words.names.iter().map(|name| Element::of_label(name)).collect();
        let known = kinds.iter().flatten().count();
        (known > 0 && 2 * known >= kinds.len())
            .then_some(ParticleElements { kinds, codes: Codes::Words(words) })
    };
    let numbers = || {
        let column = particles.role(Role::AtomicNumber)?;
        let kinds = (0..=118).map(Element::with_number).collect();
        Some(ParticleElements { kinds, codes: Codes::Numbers(column) })
    };
    let names = || {
        // GROMACS files tell the element by the name of the atom alone.
        let ColumnData::Text(words) = &particles.column(ATOM_NAME)?.data else { return None };
        let kinds: Vec<_> = words.names.iter().map(|name| of_gromacs_name(name)).collect();
        let codes = Codes::Words(words);
        Some(ParticleElements { kinds, codes }).filter(|_| particles.format == Format::Gro)
    };
    labels(Role::Element).or_else(numbers).or_else(|| labels(Role::Type)).or_else(names)
}

/// The element of an atom such as `OW`, `HB2` or `CL`: that of its first letter, but for names of
/// ions.
fn of_gromacs_name(name: &str) -> Option<&'static Element> {
    const TWO_LETTERS: [&str; 9] = ["CL", "NA", "MG", "ZN", "BR", "FE", "LI", "CU", "MN"];
    let letters: String = name.chars().filter(char::is_ascii_alphabetic).collect();
    let is_ion = TWO_LETTERS.iter().any(|ion| ion.eq_ignore_ascii_case(&letters));
    Element::with_symbol(letters.get(..if is_ion { 2 } else { 1 })?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gromacs_names_begin_with_the_element() {
        for (name, symbol) in [("OW", "O"), ("HW1", "H"), ("CA", "C"), ("CL-", "Cl"), ("1HB", "H")]
        {
            assert_eq!(of_gromacs_name(name), Element::with_symbol(symbol), "{name}");
        }
        assert_eq!(of_gromacs_name("12"), None);
    }
}
