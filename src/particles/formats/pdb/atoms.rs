//! The lines with atoms: columns of fixed width in PDB, white space between values in PQR.

use crate::particles::elements::{of_atom_name, symbol};
use crate::particles::text::{Batch, Kind, LineParser, float, integer, tokens};
use crate::particles::trouble::shown;

/// The columns of a PDB file, in the order of its lines, with the position first.
pub(super) const PDB: [&str; 11] = [
    "record",
    "serial",
    "name",
    "altloc",
    "resname",
    "chain",
    "resid",
    "icode",
    "occupancy",
    "bfactor",
    "element",
];

/// The columns of a PQR file.
pub(super) const PQR: [&str; 8] =
    ["record", "serial", "name", "resname", "chain", "resid", "charge", "radius"];

/// Returns true for a line with an atom.
pub(super) fn is_atom(line: &[u8]) -> bool {
    line.starts_with(b"ATOM  ") || line.starts_with(b"HETATM")
}

/// Returns true if the line of an atom is that of a PQR file: occupancy and temperature factor of a
/// PDB file have their points at fixed places.
pub(super) fn is_pqr(line: &[u8]) -> bool {
    let has_point = |at: usize| line.get(at) == Some(&b'.');
    let are_placed = [34, 42, 50].into_iter().all(has_point);
    let has_occupancy = has_point(57) && (has_point(63) || line.len() < 64);
    let numbers = tokens(line).collect::<Vec<_>>();
    let ends_with_numbers =
        numbers.len() >= 10 && numbers[numbers.len() - 5..].iter().all(|t| float(t).is_some());
    ends_with_numbers && !(are_placed && (has_occupancy || line.trim_ascii_end().len() <= 54))
}

/// Parses lines with atoms; others are left out.
pub(super) struct PdbRows {
    /// Each column that is read, by its index in [`PDB`].
    pub(super) columns: Vec<usize>,
}

/// Parses lines of PQR files.
pub(super) struct PqrRows {
    /// Each column that is read, by its index in [`PQR`].
    pub(super) columns: Vec<usize>,
}

/// A part of a line, without space around it; empty beyond the end.
fn part(line: &[u8], start: usize, end: usize) -> &[u8] {
    line.get(start..end.min(line.len())).unwrap_or_default().trim_ascii()
}

impl LineParser for PdbRows {
    fn parse(&self, line: &[u8], to: &mut Batch) -> Result<(), String> {
        if !is_atom(line) {
            return Ok(());
        }
        let mut position = [0.0; 3];
        for (axis, start) in [30, 38, 46].into_iter().enumerate() {
            let text = part(line, start, start + 8);
            position[axis] = float(text).filter(|x| x.is_finite()).ok_or_else(|| {
                let name = ["x", "y", "z"][axis];
                let (from, to) = (start + 1, start + 8);
                format!("expected {name} in columns {from} to {to}, found {}", shown(text))
            })?;
        }
        to.positions.push(position);
        for (column, &which) in to.columns.iter_mut().zip(&self.columns) {
            match which {
                0 => column.push(part(line, 0, 6)),
                1 => {
                    column.push_integer(serial(part(line, 6, 12)));
                    true
                }
                2 => column.push(part(line, 12, 16)),
                3 => column.push(part(line, 16, 17)),
                4 => column.push(part(line, 17, 21)),
                5 => column.push(part(line, 21, 22)),
                6 => {
                    column.push_integer(serial(part(line, 22, 26)));
                    true
                }
                7 => column.push(part(line, 26, 27)),
                8 | 9 => {
                    let start = if which == 8 { 54 } else { 60 };
                    column.push_float(float(part(line, start, start + 6)).unwrap_or(f64::NAN));
                    true
                }
                _ => column.push(element(line).as_bytes()),
            };
        }
        Ok(())
    }
}

/// The element: in its own columns, or else by the name of the atom.
fn element(line: &[u8]) -> String {
    let own = String::from_utf8_lossy(part(line, 76, 78)).into_owned();
    let named = || of_atom_name(line.get(12..16.min(line.len())).unwrap_or_default());
    let known = symbol(&own).or_else(|| own.is_empty().then(named).flatten());
    known.map_or(own, str::to_owned)
}

/// A serial or residue number: decimal, hybrid-36, or hexadecimal; -1 if it is none of them, such
/// as `*****`.
pub(super) fn serial(text: &[u8]) -> i64 {
    integer(text).or_else(|| hybrid36(text)).unwrap_or_else(|| {
        let text = std::str::from_utf8(text).unwrap_or_default();
        i64::from_str_radix(text, 16).unwrap_or(-1)
    })
}

/// Hybrid-36: after 9999 or 99999 come numbers of base 36 whose first digit is a letter, in upper
/// case, then in lower case.
fn hybrid36(text: &[u8]) -> Option<i64> {
    let width = text.len() as u32;
    let first = *text.first()?;
    if !(4..=5).contains(&width) || !first.is_ascii_alphabetic() {
        return None;
    }
    let is_lower = first.is_ascii_lowercase();
    let digit = |&c: &u8| match c {
        b'0'..=b'9' => Some(i64::from(c - b'0')),
        b'A'..=b'Z' if !is_lower => Some(i64::from(c - b'A') + 10),
        b'a'..=b'z' if is_lower => Some(i64::from(c - b'a') + 10),
        _ => None,
    };
    let value = text.iter().try_fold(0, |sum, c| Some(sum * 36 + digit(c)?))?;
    let block = 26 * 36i64.pow(width - 1);
    let start = 10i64.pow(width) - 10 * 36i64.pow(width - 1);
    Some(value + start + if is_lower { block } else { 0 })
}

impl LineParser for PqrRows {
    fn parse(&self, line: &[u8], to: &mut Batch) -> Result<(), String> {
        if !is_atom(line) {
            return Ok(());
        }
        let values: Vec<&[u8]> = tokens(line).collect();
        let wrong = || {
            "expected an atom of a PQR file: serial, name, residue, an optional chain, residue \
             number, x y z, charge and radius"
                .to_owned()
        };
        let (names, numbers) = values.split_at(values.len().checked_sub(5).ok_or_else(wrong)?);
        let mut all = [0.0; 5];
        for (number, text) in all.iter_mut().zip(numbers) {
            *number = float(text).filter(|x| x.is_finite()).ok_or_else(wrong)?;
        }
        let [x, y, z, charge, radius] = all;
        let (record, serial_text, name, residue, chain, number) = match *names {
            [record, serial, name, residue, number] => {
                (record, serial, name, residue, &b""[..], number)
            }
            [record, serial, name, residue, chain, number] => {
                (record, serial, name, residue, chain, number)
            }
            _ => return Err(wrong()),
        };
        to.positions.push([x, y, z]);
        for (column, &which) in to.columns.iter_mut().zip(&self.columns) {
            match which {
                1 => column.push_integer(serial(serial_text)),
                5 => column.push_integer(serial(number)),
                6 => column.push_float(charge),
                7 => column.push_float(radius),
                _ => {
                    column.push([record, &b""[..], name, residue, chain][which]);
                }
            }
        }
        Ok(())
    }
}

/// What a column holds.
pub(super) fn kind(name: &str) -> Kind {
    match name {
        "serial" | "resid" => Kind::I32,
        "occupancy" | "bfactor" | "charge" | "radius" => Kind::F64,
        _ => Kind::Text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn serials_go_on_after_their_columns_are_full() {
        for (text, value) in [
            ("99999", 99_999),
            ("A0000", 100_000),
            ("A0001", 100_001),
            ("ZZZZZ", 43_770_015),
            ("a0000", 43_770_016),
            ("A000", 10_000),
            ("-5", -5),
            ("*****", -1),
            ("", -1),
            ("186a0", 100_000),
        ] {
            assert_eq!(serial(text.as_bytes()), value, "{text}");
        }
    }
}
