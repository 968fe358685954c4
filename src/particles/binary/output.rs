//! Where the numbers of a file go: disjoint parts of positions and columns, one for each task.

use crate::particles::column::ColumnData;
use crate::particles::model::Positions;

use super::number::{Number, NumberKind, half};

/// A part of the values of a column.
pub(super) enum ValuesMut<'a> {
    U8(&'a mut [u8]),
    I32(&'a mut [i32]),
    I64(&'a mut [i64]),
    F32(&'a mut [f32]),
    F64(&'a mut [f64]),
}

/// A part of the positions.
pub(super) enum PositionsMut<'a> {
    F32(&'a mut [[f32; 3]]),
    F64(&'a mut [[f64; 3]]),
}

impl<'a> ValuesMut<'a> {
    /// All values of a column of numbers.
    pub(super) fn new(data: &'a mut ColumnData) -> Option<Self> {
        Some(match data {
            ColumnData::U8(values) => Self::U8(values),
            ColumnData::I32(values) => Self::I32(values),
            ColumnData::I64(values) => Self::I64(values),
            ColumnData::F32(values) => Self::F32(values),
            ColumnData::F64(values) => Self::F64(values),
            ColumnData::Text(_) => return None,
        })
    }

    /// The first values, and the others.
    pub(super) fn split_at(self, rows: usize) -> (Self, Self) {
        macro_rules! split {
            ($($kind:ident)+) => {
                match self {
                    $(Self::$kind(values) => {
                        let (first, rest) = values.split_at_mut(rows);
                        (Self::$kind(first), Self::$kind(rest))
                    })+
                }
            };
        }
        split!(U8 I32 I64 F32 F64)
    }

    /// Fills in the numbers that lie `stride` bytes apart.
    pub(super) fn fill(&mut self, bytes: &[u8], stride: usize, number: Number) {
        macro_rules! fill {
            ($values:expr, $from:ty, $to:ty) => {
                each::<{ size_of::<$from>() }, $to>(bytes, stride, number, $values, |bytes| {
                    <$from>::from_le_bytes(bytes) as $to
                })
            };
        }
        match (self, number.kind) {
            (Self::U8(to), NumberKind::U8) => fill!(to, u8, u8),
            (Self::I32(to), NumberKind::I8) => fill!(to, i8, i32),
            (Self::I32(to), NumberKind::U16) => fill!(to, u16, i32),
            (Self::I32(to), NumberKind::I16) => fill!(to, i16, i32),
            (Self::I32(to), NumberKind::I32) => fill!(to, i32, i32),
            (Self::I64(to), NumberKind::U32) => fill!(to, u32, i64),
            (Self::I64(to), NumberKind::I64) => fill!(to, i64, i64),
            (Self::I64(to), NumberKind::U64) => {
                each::<8, i64>(bytes, stride, number, to, |bytes| {
                    i64::try_from(u64::from_le_bytes(bytes)).unwrap_or(i64::MAX)
                })
            }
            (Self::F32(to), NumberKind::F16) => {
                each::<2, f32>(bytes, stride, number, to, |bytes| half(u16::from_le_bytes(bytes)))
            }
            (Self::F32(to), NumberKind::F32) => fill!(to, f32, f32),
            (Self::F64(to), NumberKind::F64) => fill!(to, f64, f64),
            _ => debug_assert!(false, "a column has the type of its numbers"),
        }
    }
}

impl<'a> PositionsMut<'a> {
    /// All positions.
    pub(super) fn new(positions: &'a mut Positions) -> Self {
        match positions {
            Positions::F32(centers) => Self::F32(centers),
            Positions::F64(centers) => Self::F64(centers),
        }
    }

    /// The first positions, and the others.
    pub(super) fn split_at(self, rows: usize) -> (Self, Self) {
        match self {
            Self::F32(centers) => {
                let (first, rest) = centers.split_at_mut(rows);
                (Self::F32(first), Self::F32(rest))
            }
            Self::F64(centers) => {
                let (first, rest) = centers.split_at_mut(rows);
                (Self::F64(first), Self::F64(rest))
            }
        }
    }

    /// Fills in one coordinate from numbers that lie `stride` bytes apart.
    pub(super) fn fill(&mut self, axis: usize, bytes: &[u8], stride: usize, number: Number) {
        macro_rules! fill {
            ($centers:expr, $from:ty, $to:ty) => {{
                let axis = $centers.iter_mut().map(|center| &mut center[axis]);
                each_of::<{ size_of::<$from>() }, $to>(bytes, stride, number, axis, |bytes| {
                    <$from>::from_le_bytes(bytes) as $to
                })
            }};
        }
        match (self, number.kind) {
            (Self::F32(to), NumberKind::U8) => fill!(to, u8, f32),
            (Self::F32(to), NumberKind::I8) => fill!(to, i8, f32),
            (Self::F32(to), NumberKind::U16) => fill!(to, u16, f32),
            (Self::F32(to), NumberKind::I16) => fill!(to, i16, f32),
            (Self::F32(to), NumberKind::F32) => fill!(to, f32, f32),
            (Self::F32(to), NumberKind::F16) => {
                let axis = to.iter_mut().map(|center| &mut center[axis]);
                each_of::<2, f32>(bytes, stride, number, axis, |b| half(u16::from_le_bytes(b)));
            }
            (Self::F64(to), NumberKind::U8) => fill!(to, u8, f64),
            (Self::F64(to), NumberKind::I8) => fill!(to, i8, f64),
            (Self::F64(to), NumberKind::U16) => fill!(to, u16, f64),
            (Self::F64(to), NumberKind::I16) => fill!(to, i16, f64),
            (Self::F64(to), NumberKind::U32) => fill!(to, u32, f64),
            (Self::F64(to), NumberKind::I32) => fill!(to, i32, f64),
            (Self::F64(to), NumberKind::U64) => fill!(to, u64, f64),
            (Self::F64(to), NumberKind::I64) => fill!(to, i64, f64),
            (Self::F64(to), NumberKind::F32) => fill!(to, f32, f64),
            (Self::F64(to), NumberKind::F64) => fill!(to, f64, f64),
            (Self::F64(to), NumberKind::F16) => {
                let axis = to.iter_mut().map(|center| &mut center[axis]);
                let value = |b| f64::from(half(u16::from_le_bytes(b)));
                each_of::<2, f64>(bytes, stride, number, axis, value);
            }
            _ => debug_assert!(false, "positions hold the numbers of the file"),
        }
    }
}

fn each<const N: usize, T>(
    bytes: &[u8],
    stride: usize,
    number: Number,
    to: &mut [T],
    value: impl Fn([u8; N]) -> T,
) {
    each_of::<N, T>(bytes, stride, number, to.iter_mut(), value);
}

/// Fills in numbers of `N` bytes. `value` takes their bytes in little-endian order.
#[inline]
fn each_of<'t, const N: usize, T: 't>(
    bytes: &[u8],
    stride: usize,
    number: Number,
    to: impl Iterator<Item = &'t mut T>,
    value: impl Fn([u8; N]) -> T,
) {
    let numbers = bytes.chunks(stride.max(1)).map(|row| {
        let mut number = [0; N];
        number.copy_from_slice(&row[..N]);
        number
    });
    if number.is_big_endian {
        for (to, mut bytes) in to.zip(numbers) {
            bytes.reverse();
            *to = value(bytes);
        }
    } else {
        for (to, bytes) in to.zip(numbers) {
            *to = value(bytes);
        }
    }
}
