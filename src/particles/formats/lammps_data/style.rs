//! The columns of atoms in each style.

use crate::particles::text::{float, integer};

/// Styles with their columns.
const STYLES: [(&str, &str); 16] = [
    ("atomic", "id type x y z"),
    ("charge", "id type q x y z"),
    ("bond", "id mol type x y z"),
    ("angle", "id mol type x y z"),
    ("molecular", "id mol type x y z"),
    ("full", "id mol type q x y z"),
    ("sphere", "id type diameter density x y z"),
    ("bpm/sphere", "id mol type diameter density x y z"),
    ("ellipsoid", "id type ellipsoidflag density x y z"),
    ("dipole", "id type q x y z mux muy muz"),
    ("body", "id type bodyflag mass x y z"),
    ("line", "id mol type lineflag density x y z"),
    ("tri", "id mol type triangleflag density x y z"),
    ("peri", "id type volume density x y z"),
    ("electron", "id type q espin eradius x y z"),
    ("hybrid", "id type x y z"),
];

/// The columns of a style, without image flags.
pub(super) fn columns(style: &str) -> Option<Vec<&'static str>> {
    let found = STYLES.iter().find(|(name, _)| *name == style);
    found.map(|(_, columns)| columns.split(' ').collect())
}

/// All names of styles.
pub(super) fn names() -> Vec<&'static str> {
    STYLES.iter().map(|(name, _)| *name).collect()
}

/// Guesses the style by the first atom: its number of values, and which of them are integers.
pub(super) fn guess(values: &[&[u8]]) -> Option<&'static str> {
    let is_integer = |at: usize| values.get(at).is_some_and(|value| integer(value).is_some());
    let is_number = values.iter().skip(2).all(|value| float(value).is_some());
    let count = values.len();
    // Image flags are three integers at the end.
    let has_images = count >= 8 && (count - 3..count).all(is_integer);
    match count - if has_images { 3 } else { 0 } {
        _ if !is_number => None,
        5 => Some("atomic"),
        6 if is_integer(2) => Some("molecular"),
        6 => Some("charge"),
        7 if is_integer(2) => Some("full"),
        7 => Some("sphere"),
        8 if is_integer(2) => Some("bpm/sphere"),
        _ => None,
    }
}
