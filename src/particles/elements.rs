//! Symbols of the chemical elements, to tell them from other names.

/// All symbols, in the order of the atomic numbers.
const SYMBOLS: [&str; 118] = [
    "H", "He", "Li", "Be", "B", "C", "N", "O", "F", "Ne", "Na", "Mg", "Al", "Si", "P", "S", "Cl",
    "Ar", "K", "Ca", "Sc", "Ti", "V", "Cr", "Mn", "Fe", "Co", "Ni", "Cu", "Zn", "Ga", "Ge", "As",
    "Se", "Br", "Kr", "Rb", "Sr", "Y", "Zr", "Nb", "Mo", "Tc", "Ru", "Rh", "Pd", "Ag", "Cd", "In",
    "Sn", "Sb", "Te", "I", "Xe", "Cs", "Ba", "La", "Ce", "Pr", "Nd", "Pm", "Sm", "Eu", "Gd", "Tb",
    "Dy", "Ho", "Er", "Tm", "Yb", "Lu", "Hf", "Ta", "W", "Re", "Os", "Ir", "Pt", "Au", "Hg", "Tl",
    "Pb", "Bi", "Po", "At", "Rn", "Fr", "Ra", "Ac", "Th", "Pa", "U", "Np", "Pu", "Am", "Cm", "Bk",
    "Cf", "Es", "Fm", "Md", "No", "Lr", "Rf", "Db", "Sg", "Bh", "Hs", "Mt", "Ds", "Rg", "Cn", "Nh",
    "Fl", "Mc", "Lv", "Ts", "Og",
];

/// The symbol that a word is, regardless of case.
pub(super) fn symbol(word: &str) -> Option<&'static str> {
    SYMBOLS.iter().copied().find(|symbol| symbol.eq_ignore_ascii_case(word))
}

/// The element of an atom by the four columns of its name in a PDB file: a symbol of one letter
/// begins in the second column, one of two letters in the first.
pub(super) fn of_atom_name(name: &[u8]) -> Option<&'static str> {
    let text = String::from_utf8_lossy(name);
    let first = text.chars().next()?;
    let letters: String = text.chars().filter(char::is_ascii_alphabetic).collect();
    let one = letters.get(..1).and_then(symbol);
    let is_full = text.trim_end().chars().count() >= 4;
    // Names of hydrogens with four letters, such as `HG11`, begin in the first column.
    if !first.is_ascii_alphabetic() || (is_full && first == 'H') {
        return one;
    }
    let two = letters.get(..2).filter(|two| text.starts_with(two)).and_then(symbol);
    two.or(one)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_follow_from_the_alignment_of_names() {
        for (name, element) in [
            (" CA ", Some("C")),
            ("CA  ", Some("Ca")),
            ("1HB ", Some("H")),
            ("HG11", Some("H")),
            ("HG  ", Some("Hg")),
            ("FE  ", Some("Fe")),
            (" OXT", Some("O")),
            ("    ", None),
            ("", None),
        ] {
            assert_eq!(of_atom_name(name.as_bytes()), element, "{name}");
        }
        assert_eq!((symbol("SI"), symbol("Xx")), (Some("Si"), None));
    }
}
