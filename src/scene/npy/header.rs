//! Finds the rows of sphere tables in the header of a NumPy file (`.npy`). The numbers themselves
//! are read in chunks like those of any other table.

use std::io::{self, Read};

use crate::particles::npy::{self, Dtype, NpyField};
use crate::scene::columns::NumberType;

/// What the header of a NumPy file says.
#[derive(Debug, PartialEq)]
pub(in crate::scene) struct NpyHeader {
    /// Position of the first number in the file.
    pub(in crate::scene) data_start: u64,
    /// Number of rows.
    pub(in crate::scene) rows: u64,
    /// What a row is.
    pub(in crate::scene) row: NpyRow,
}

/// A row of a NumPy array.
#[derive(Debug, PartialEq)]
pub(in crate::scene) enum NpyRow {
    /// A row of a two-dimensional array.
    Numbers {
        number: NumberType,
        /// Numbers in a row.
        count: u64,
        /// True if the numbers of a column follow each other ("Fortran order").
        is_column_major: bool,
    },
    /// An entry of a one-dimensional array of records.
    Record(Vec<NpyField>),
}

/// The type of the values of a field, if a table can read them.
pub(in crate::scene) fn number_of(field: &NpyField) -> Option<NumberType> {
    number_type(&field.dtype)
}

/// Reads the header at the beginning of a file; `None` if it is not a NumPy file. The inner error
/// completes "the file is a NumPy file ...".
///
/// # Errors
/// If the file cannot be read.
pub(in crate::scene) fn read_header(
    file: impl Read,
) -> io::Result<Option<Result<NpyHeader, String>>> {
    let header = npy::read_header(file)?;
    Ok(header.map(|header| header.and_then(rows_of)))
}

/// The rows of an array.
fn rows_of(header: npy::NpyHeader) -> Result<NpyHeader, String> {
    let npy::NpyHeader { data_start, shape, is_column_major, dtype } = header;
    let (rows, row) = match (dtype, &shape[..]) {
        (Dtype::Simple(dtype), &[rows, count]) => {
            let number = number_type(&dtype).ok_or_else(|| wrong_type(&dtype))?;
            (rows, NpyRow::Numbers { number, count, is_column_major })
        }
        (Dtype::Record(fields), &[rows]) => {
            (rows, NpyRow::Record(fields.ok_or("whose header has fields of an unknown type")?))
        }
        _ => {
            let shape: Vec<String> = shape.iter().map(u64::to_string).collect();
            return Err(format!(
                "of shape ({}), but a table has rows and columns",
                shape.join(", ")
            ));
        }
    };
    Ok(NpyHeader { data_start, rows, row })
}

fn wrong_type(dtype: &str) -> String {
    format!("of type `{dtype}`, not `<f4` or `<f8`")
}

/// The type of numbers that a table can read.
fn number_type(dtype: &str) -> Option<NumberType> {
    match dtype {
        "<f4" => Some(NumberType::F32),
        "<f8" => Some(NumberType::F64),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(version: [u8; 2], size_bytes: usize, text: &str) -> Vec<u8> {
        let size = (text.len() as u32).to_le_bytes();
        [&b"\x93NUMPY"[..], &version, &size[..size_bytes], text.as_bytes()].concat()
    }

    fn read(bytes: &[u8]) -> Option<Result<NpyHeader, String>> {
        read_header(bytes).expect("memory can be read")
    }

    fn told(text: &str) -> String {
        read(&header([1, 0], 2, text)).expect("a NumPy file").expect_err("a mistake")
    }

    #[test]
    fn all_versions_are_read() {
        let text = "{'descr': '<f8', 'fortran_order': True, 'shape': (5, 4), }\n";
        let row = |count| NpyRow::Numbers { number: NumberType::F64, count, is_column_major: true };
        for (version, size_bytes) in [([1, 0], 2), ([2, 0], 4), ([3, 0], 4)] {
            let bytes = header(version, size_bytes, text);
            let data_start = bytes.len() as u64;
            let expected = NpyHeader { data_start, rows: 5, row: row(4) };
            assert_eq!(read(&[&bytes[..], &[0; 9]].concat()), Some(Ok(expected)));
            // Cut short anywhere, an error and no panic.
            for end in 6..bytes.len() {
                assert!(matches!(read(&bytes[..end]), Some(Err(_))), "{end}");
            }
        }
        assert_eq!(read(b""), None);
        assert_eq!(read(b"\x93NUMP"), None);
    }

    #[test]
    fn records_have_fields() {
        let text = "{'descr': [('x', '<f8'), (('title', 'at'), '<f4', (2, 3)), ('name', '<U5'), \
                    ('', '|V3')], 'fortran_order': False, 'shape': (7,)}";
        let Some(Ok(NpyHeader { rows: 7, row: NpyRow::Record(fields), .. })) =
            read(&header([1, 0], 2, text))
        else {
            panic!("a record");
        };
        let found: Vec<_> =
            fields.iter().map(|f| (&*f.name, number_of(f), f.value_bytes, f.count)).collect();
        let (f32, f64) = (Some(NumberType::F32), Some(NumberType::F64));
        let expected =
            [("x", f64, 8, 1), ("at", f32, 4, 6), ("name", None, 20, 1), ("", None, 3, 1)];
        assert_eq!(found, expected);
    }

    #[test]
    fn mistakes_are_told() {
        let of = |descr: &str, shape: &str| {
            told(&format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}}}"))
        };
        assert_eq!(of("'>f4'", "(5, 4)"), "of type `>f4`, not `<f4` or `<f8`");
        assert_eq!(of("'<i8'", "(5, 4)"), "of type `<i8`, not `<f4` or `<f8`");
        assert_eq!(of("'<f4'", "(5,)"), "of shape (5), but a table has rows and columns");
        assert_eq!(
            of("[('x', '<f4')]", "(5, 2)"),
            "of shape (5, 2), but a table has rows and columns"
        );
        let nested = "[('x', [('y', '<f4')])]";
        assert_eq!(of(nested, "(5,)"), "whose header has fields of an unknown type");
        let huge = "[('x', '<f4', (9999999999, 9999999999))]";
        assert_eq!(of(huge, "(5,)"), "whose header has fields of an unknown type");
        let incomplete = "whose header does not give `descr`, `fortran_order` and `shape`";
        assert_eq!(told("{'descr': '<f4', 'shape': (5, 4)}"), incomplete);
        assert_eq!(told("import os"), incomplete);
        let version = read(&header([4, 0], 4, "")).expect("a NumPy file");
        assert_eq!(version, Err("of version 4.0, not 1.0, 2.0 or 3.0".to_owned()));
        let mut long = header([2, 0], 4, "");
        long[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
        let long = read(&long).expect("a NumPy file");
        assert_eq!(long, Err("with a header of 4294967295 bytes, more than 64 KiB".to_owned()));
    }
}
