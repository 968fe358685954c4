//! Rows that were parsed: positions and columns.

use crate::particles::column::Column;
use crate::particles::model::Positions;
use crate::task::pages::try_reserve;

use super::values::{Kind, Values};

/// Parsed rows.
#[derive(Clone, Debug, Default)]
pub(in crate::particles) struct Batch {
    pub(in crate::particles) positions: Vec<[f64; 3]>,
    pub(in crate::particles) columns: Vec<Values>,
}

impl Batch {
    /// No rows, with columns of these kinds.
    pub(in crate::particles) fn new(kinds: impl IntoIterator<Item = Kind>) -> Self {
        Self { positions: Vec::new(), columns: kinds.into_iter().map(Values::new).collect() }
    }

    /// Drops values of a row whose position is missing.
    pub(in crate::particles) fn drop_incomplete_row(&mut self) {
        let rows = self.positions.len();
        self.columns.iter_mut().for_each(|column| column.truncate(rows));
    }

    /// Makes this a batch without rows and with the kinds of columns of another one.
    pub(in crate::particles) fn clear_like(&mut self, other: &Self) {
        self.positions.clear();
        self.columns.truncate(other.columns.len());
        for (column, like) in self.columns.iter_mut().zip(&other.columns) {
            match column.kind() == like.kind() {
                true => column.clear(),
                false => *column = Values::new(like.kind()),
            }
        }
        let missing = other.columns[self.columns.len()..].iter();
        self.columns.extend(missing.map(|column| Values::new(column.kind())));
    }

    /// Takes memory for more rows at once, if there is as much: growing step by step may hold old
    /// and new values.
    pub(in crate::particles) fn reserve(&mut self, rows: usize) {
        let _ = try_reserve(&mut self.positions, rows);
        self.columns.iter_mut().for_each(|column| column.reserve(rows));
    }

    /// No rows, with columns of the same kinds.
    pub(super) fn empty_like(&self) -> Self {
        Self::new(self.columns.iter().map(Values::kind))
    }

    /// Appends all rows of another batch with the same columns.
    pub(super) fn append(&mut self, other: &mut Self) {
        self.positions.extend_from_slice(&other.positions);
        for (column, more) in self.columns.iter_mut().zip(&mut other.columns) {
            column.append(more);
        }
    }

    /// The positions, and the columns with these names.
    pub(in crate::particles) fn finish<'n>(
        mut self,
        names: impl IntoIterator<Item = &'n str>,
    ) -> (Positions, Vec<Column>) {
        let column =
            |(name, data): (&str, Values)| Column { name: name.to_owned(), data: data.finish() };
        let columns = names.into_iter().zip(self.columns).map(column).collect();
        self.positions.shrink_to_fit();
        (Positions::F64(self.positions), columns)
    }

    /// Bytes of memory, about.
    pub(in crate::particles) fn bytes(&self) -> u64 {
        let columns: u64 = self.columns.iter().map(Values::bytes).sum();
        24 * self.positions.len() as u64 + columns
    }
}
