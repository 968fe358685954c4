//! What the values of a NumPy array are, as columns.

use crate::particles::binary::{Number, NumberKind, Slot, Slots};
use crate::particles::column::component_name;
use crate::particles::formats::table::axis_of;
use crate::particles::trouble::Trouble;

use super::header::{Dtype, NpyField, NpyHeader, type_bytes};

/// The most columns that an array may have.
const MAX_COLUMNS: u64 = 4096;

/// Names of positions with three numbers each.
const POSITIONS: [&str; 11] = [
    "positions",
    "position",
    "pos",
    "xyz",
    "points",
    "point",
    "coords",
    "coordinates",
    "centers",
    "center",
    "r",
];

/// An array as columns.
#[derive(Clone, Debug)]
pub(super) struct Array {
    pub(super) frames: u64,
    pub(super) rows: u64,
    /// Bytes of a frame.
    pub(super) frame_bytes: u64,
    /// Columns of numbers, those of the first frame.
    pub(super) slots: Slots,
    /// Columns of words.
    pub(super) texts: Vec<TextSlot>,
}

/// A column of words of fixed length.
#[derive(Clone, Debug)]
pub(super) struct TextSlot {
    pub(super) name: String,
    pub(super) start: u64,
    pub(super) stride: u64,
    pub(super) bytes: u64,
    /// True if a character has four bytes.
    pub(super) is_wide: bool,
    pub(super) is_big_endian: bool,
}

/// Returns true if an array with this name holds positions.
pub(super) fn is_position(name: &str) -> bool {
    POSITIONS.contains(&&*name.to_ascii_lowercase())
}

/// The type of numbers that NumPy calls `dtype`.
pub(super) fn number(dtype: &str) -> Option<Number> {
    let (order, name) = dtype.split_at_checked(1)?;
    let kind = match name {
        "b1" | "u1" => NumberKind::U8,
        "i1" => NumberKind::I8,
        "u2" => NumberKind::U16,
        "i2" => NumberKind::I16,
        "u4" => NumberKind::U32,
        "i4" => NumberKind::I32,
        "u8" => NumberKind::U64,
        "i8" => NumberKind::I64,
        "f2" => NumberKind::F16,
        "f4" => NumberKind::F32,
        "f8" => NumberKind::F64,
        _ => return None,
    };
    match order {
        "<" | "|" | "=" => Some(Number { kind, is_big_endian: false }),
        ">" => Some(Number { kind, is_big_endian: true }),
        _ => None,
    }
}

/// Bytes of a text, whether its characters have four bytes, and whether they are big-endian.
fn text(dtype: &str) -> Option<(u64, bool, bool)> {
    let letter = dtype.trim_start_matches(['<', '>', '|', '=']).chars().next()?;
    let is_text = matches!(letter, 'S' | 'U' | 'a');
    let bytes = type_bytes(dtype).filter(|bytes| (1..=4096).contains(bytes))?;
    is_text.then_some((bytes, letter == 'U', dtype.starts_with('>')))
}

/// The columns of an array of particles. `names` are those of the user, if any.
pub(super) fn particles(header: &NpyHeader, names: &[String]) -> Result<Array, Trouble> {
    match &header.dtype {
        Dtype::Record(fields) => {
            let fields = fields
                .as_ref()
                .ok_or_else(|| Trouble::new("its header has fields of an unknown type"))?;
            record(header, fields)
        }
        Dtype::Simple(dtype) => numbers(header, dtype, names),
    }
}

fn wrong_shape(shape: &[u64]) -> Trouble {
    let shape: Vec<String> = shape.iter().map(u64::to_string).collect();
    let message = format!("its array has the shape ({})", shape.join(", "));
    Trouble::new(message).with_help(
        "expected rows with at least three columns (n, 3), frames of them (frames, n, 3), or a \
         one-dimensional array with named fields",
    )
}

/// The type of an array that can be read.
fn checked_number(dtype: &str) -> Result<Number, Trouble> {
    number(dtype).ok_or_else(|| {
        let message = format!("its array has the type `{dtype}`, which is not a number");
        Trouble::new(message).with_help("save an array of integers or floats")
    })
}

fn numbers(header: &NpyHeader, dtype: &str, names: &[String]) -> Result<Array, Trouble> {
    let number = checked_number(dtype)?;
    let (frames, rows, columns) = match header.shape[..] {
        [rows, columns @ 3..=MAX_COLUMNS] => (1, rows, columns),
        [frames, rows, columns @ 3..=MAX_COLUMNS] if !header.is_column_major => {
            (frames, rows, columns)
        }
        _ => return Err(wrong_shape(&header.shape)),
    };
    let usual = (0..columns).map(|at| match at {
        0..=2 => ["x", "y", "z"][at as usize].to_owned(),
        _ => format!("column_{}", at + 1),
    });
    let names: Vec<String> = if names.is_empty() { usual.collect() } else { names.to_vec() };
    if names.len() as u64 != columns {
        let message = format!("{} columns are named, but its rows have {columns}", names.len());
        return Err(Trouble::new(message));
    }
    let size = number.kind.bytes();
    let start = header.data_start;
    let column_bytes = rows.saturating_mul(size);
    let groups = match header.is_column_major {
        true => (0..columns).map(|at| (start + at.saturating_mul(column_bytes), size)).collect(),
        false => vec![(start, columns * size)],
    };
    let slots = names.into_iter().enumerate().map(|(at, name)| match header.is_column_major {
        true => Slot { name, number, group: at, offset: 0, axis: None },
        false => Slot { name, number, group: 0, offset: at as u64 * size, axis: None },
    });
    let slots = slots.collect();
    let frame_bytes = column_bytes.saturating_mul(columns);
    let texts = Vec::new();
    with_axes(Array { frames, rows, frame_bytes, slots: Slots { groups, slots }, texts })
}

fn record(header: &NpyHeader, fields: &[NpyField]) -> Result<Array, Trouble> {
    let &[rows] = &header.shape[..] else { return Err(wrong_shape(&header.shape)) };
    let total = fields.iter().fold(0, |sum: u64, field| sum.saturating_add(field.count));
    if total > MAX_COLUMNS {
        return Err(Trouble::new(format!("its rows have more than {MAX_COLUMNS} values")));
    }
    let mut offset = 0u64;
    let (mut slots, mut texts) = (Vec::new(), Vec::new());
    for field in fields {
        for at in 0..field.count {
            let name = component_name(&field.name, at as usize, field.count as usize);
            if let Some(number) = number(&field.dtype) {
                let is_axis = field.count == 3 && is_position(&field.name);
                let axis = is_axis.then_some(at as usize);
                slots.push(Slot { name, number, group: 0, offset, axis });
            } else if let Some((bytes, is_wide, is_big_endian)) = text(&field.dtype) {
                let start = header.data_start + offset;
                texts.push(TextSlot { name, start, stride: 0, bytes, is_wide, is_big_endian });
            }
            offset = offset.saturating_add(field.value_bytes);
        }
    }
    for text in &mut texts {
        text.stride = offset;
    }
    let groups = vec![(header.data_start, offset)];
    let frame_bytes = rows.saturating_mul(offset);
    with_axes(Array { frames: 1, rows, frame_bytes, slots: Slots { groups, slots }, texts })
}

/// Finds the coordinates by their names, unless they are known.
fn with_axes(mut array: Array) -> Result<Array, Trouble> {
    let slots = &mut array.slots.slots;
    if slots.iter().all(|slot| slot.axis.is_none()) {
        let names: Vec<&str> = slots.iter().map(|slot| &*slot.name).collect();
        let Some(places) = axis_of(&names) else {
            let named: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
            let message = format!("there are no columns x, y and z among {}", named.join(", "));
            return Err(Trouble::new(message));
        };
        for (axis, place) in places.into_iter().enumerate() {
            slots[place].axis = Some(axis);
        }
    }
    slots.retain(|slot| slot.name != "_");
    Ok(array)
}
