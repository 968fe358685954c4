//! Reads the header of a NumPy file (`.npy`): the type, shape and order of its values.
//!
//! The format is that of `numpy.lib.format`, versions 1.0 to 3.0.

use std::io::{self, Read};

use super::literal::Literal;

/// The first bytes of every NumPy file.
const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// Maximum length of a header. NumPy's own limit is 10,000 bytes unless a file is trusted.
const MAX_HEADER_BYTES: u64 = 1 << 16;

/// What the header of a NumPy file says.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NpyHeader {
    /// Position of the first value in the file.
    pub(crate) data_start: u64,
    /// Length of each dimension.
    pub(crate) shape: Vec<u64>,
    /// True if the first index runs fastest ("Fortran order").
    pub(crate) is_column_major: bool,
    /// The type of the values.
    pub(crate) dtype: Dtype,
}

/// The type of the values of a NumPy array.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Dtype {
    /// One number or text, as NumPy writes its type.
    Simple(String),
    /// A record; `None` if a field has an unknown type.
    Record(Option<Vec<NpyField>>),
}

/// A field of a record.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NpyField {
    pub(crate) name: String,
    /// The type, as NumPy writes it.
    pub(crate) dtype: String,
    /// Bytes of one value.
    pub(crate) value_bytes: u64,
    /// Number of values.
    pub(crate) count: u64,
}

/// Reads the header at the beginning of a file; `None` if it is not a NumPy file. The inner error
/// completes "the file is a NumPy file ...".
///
/// # Errors
/// If the file cannot be read.
pub(crate) fn read_header(file: impl Read) -> io::Result<Option<Result<NpyHeader, String>>> {
    let mut file = file.take(MAX_HEADER_BYTES);
    let mut start = Vec::new();
    file.by_ref().take(8).read_to_end(&mut start)?;
    let Some(version) = start.strip_prefix(MAGIC) else { return Ok(None) };
    let size_bytes = match version {
        [1, 0] => 2,
        [2 | 3, 0] => 4,
        [major, minor] => {
            return Ok(Some(Err(format!("of version {major}.{minor}, not 1.0, 2.0 or 3.0"))));
        }
        _ => return Ok(Some(Err("without a header".to_owned()))),
    };
    let mut size = Vec::new();
    file.by_ref().take(size_bytes).read_to_end(&mut size)?;
    if (size.len() as u64) < size_bytes {
        return Ok(Some(Err("without a header".to_owned())));
    }
    let length = size.iter().rev().fold(0, |length, &byte| length << 8 | u64::from(byte));
    let data_start = start.len() as u64 + size_bytes + length;
    if data_start > MAX_HEADER_BYTES {
        return Ok(Some(Err(format!("with a header of {length} bytes, more than 64 KiB"))));
    }
    let mut text = Vec::new();
    file.take(length).read_to_end(&mut text)?;
    if (text.len() as u64) < length {
        return Ok(Some(Err("that ends within its header".to_owned())));
    }
    Ok(Some(parse(&text, data_start)))
}

fn parse(text: &[u8], data_start: u64) -> Result<NpyHeader, String> {
    let literal = Literal::parse(text);
    let get = |key: &str| literal.as_ref()?.get(key);
    let shape = get("shape").and_then(dimensions);
    let (Some(descr), Some(&Literal::Boolean(is_column_major)), Some(shape)) =
        (get("descr"), get("fortran_order"), shape)
    else {
        return Err("whose header does not give `descr`, `fortran_order` and `shape`".to_owned());
    };
    let dtype = match descr {
        Literal::Text(dtype) => Dtype::Simple(dtype.clone()),
        Literal::List(fields) => Dtype::Record(fields.iter().map(parse_field).collect()),
        _ => return Err("whose header has a `descr` that is no type".to_owned()),
    };
    Ok(NpyHeader { data_start, shape, is_column_major, dtype })
}

fn dimensions(shape: &Literal) -> Option<Vec<u64>> {
    shape.entries()?.iter().map(Literal::number).collect()
}

/// A field: a name, or a title and a name; a type; and, for an array, its shape.
fn parse_field(field: &Literal) -> Option<NpyField> {
    let (name, dtype, shape) = match field.entries()? {
        [name, dtype] => (name, dtype, Vec::new()),
        [name, dtype, shape] => (name, dtype, dimensions(shape)?),
        _ => return None,
    };
    let name = match name {
        Literal::List(names) => names.last()?,
        name => name,
    };
    let (name, dtype) = (name.text()?.to_owned(), dtype.text()?.to_owned());
    let value_bytes = type_bytes(&dtype)?;
    let count = shape.into_iter().try_fold(1, u64::checked_mul)?;
    Some(NpyField { name, dtype, value_bytes, count })
}

/// Bytes of a value: byte order, one letter, size, and for times a unit in brackets.
pub(super) fn type_bytes(dtype: &str) -> Option<u64> {
    let dtype = dtype.trim_start_matches(['<', '>', '|', '=']);
    let dtype = dtype.split('[').next()?;
    let mut letters = dtype.chars();
    let letter = letters.next().filter(char::is_ascii_alphabetic)?;
    let size: u64 = letters.as_str().parse().ok()?;
    // Strings count characters of 32 bits.
    size.checked_mul(if letter == 'U' { 4 } else { 1 })
}
