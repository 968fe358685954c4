//! The columns of particles as an expression sees them.

use crate::particles::{ColumnData, Particles};

use super::expression::{ColumnSource, ColumnValues};

/// Names of the columns that every particle has.
pub(super) const POSITION: [&str; 4] = ["x", "y", "z", "row"];

/// Columns of a file, the coordinates `x`, `y` and `z`, and the `row`, from 0. Columns of the file
/// come first.
pub(super) struct ParticleColumns<'a>(pub(super) &'a Particles);

impl ColumnSource for ParticleColumns<'_> {
    fn names(&self) -> Vec<&str> {
        let of_file = self.0.columns.iter().map(|column| &*column.name);
        POSITION.into_iter().chain(of_file).collect()
    }

    fn column(&self, name: &str) -> Option<ColumnValues<'_>> {
        let Some(column) = self.0.column(name) else {
            return self.position(name);
        };
        if let ColumnData::Text(words) = &column.data {
            let names = words.names.iter().map(|name| &**name).collect();
            return Some(ColumnValues::Texts { words: names, codes: &words.codes });
        }
        let fill = move |first: usize, to: &mut [f64]| {
            for (value, row) in to.iter_mut().zip(first..) {
                *value = column.data.number(row);
            }
        };
        Some(ColumnValues::Numbers(Box::new(fill)))
    }
}

impl ParticleColumns<'_> {
    fn position(&self, name: &str) -> Option<ColumnValues<'_>> {
        let index = POSITION.iter().position(|known| *known == name)?;
        let positions = &self.0.positions;
        let fill = move |first: usize, to: &mut [f64]| {
            for (value, row) in to.iter_mut().zip(first..) {
                *value = if index == 3 { row as f64 } else { positions.get(row)[index] };
            }
        };
        Some(ColumnValues::Numbers(Box::new(fill)))
    }
}
