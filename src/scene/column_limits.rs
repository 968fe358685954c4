//! The numbers that the columns of a table may hold, in files and in memory alike.

use std::ops::RangeInclusive;

use crate::math::{DVec3, MAX_COORDINATE};

use super::columns::Column;
use super::keys::{MAX_RADIANCE, MIN_RADIUS};

/// Allowed values of a column.
#[derive(Clone, Debug)]
pub(super) struct ColumnLimits {
    range: RangeInclusive<f64>,
    /// Added to the value, which must stay in the range.
    offset: f64,
}

impl ColumnLimits {
    /// The limits of a column in a table that is moved by `offset`, with colours up to `max_color`.
    pub(super) fn new(column: Column, offset: DVec3, max_color: [f32; 3]) -> Self {
        let [red, green, blue] = max_color.map(f64::from);
        let coordinate = -MAX_COORDINATE..=MAX_COORDINATE;
        let (range, offset) = match column {
            Column::X => (coordinate, offset.x),
            Column::Y => (coordinate, offset.y),
            Column::Z => (coordinate, offset.z),
            Column::Radius => (MIN_RADIUS..=MAX_COORDINATE, 0.0),
            Column::Red => (0.0..=red, 0.0),
            Column::Green => (0.0..=green, 0.0),
            Column::Blue => (0.0..=blue, 0.0),
            Column::Emission
            | Column::EmissionRed
            | Column::EmissionGreen
            | Column::EmissionBlue => (0.0..=MAX_RADIANCE, 0.0),
        };
        Self { range, offset }
    }

    /// Returns true if the column may hold this value.
    #[inline]
    pub(super) fn allow(&self, value: f64) -> bool {
        self.range.contains(&value) && self.range.contains(&(value + self.offset))
    }

    /// Continues a sentence about a value that is not allowed.
    pub(super) fn describe(&self, value: f64) -> String {
        let moved = match self.range.contains(&value) {
            true => format!(", which `offset` moves to {:?}", value + self.offset),
            false => String::new(),
        };
        let [low, high] = [self.range.start(), self.range.end()].map(|limit| *limit as f32);
        format!("{moved}; it must be from {} to {}", format_f32(low), format_f32(high))
    }
}

/// The shortest number that reads back as the same f32.
fn format_f32(x: f32) -> String {
    let is_handy = x == 0.0 || (1e-4..1e6).contains(&x.abs());
    if is_handy { x.to_string() } else { format!("{x:e}") }
}
