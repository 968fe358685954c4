//! What all rows of a particle file hold, column by column.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use crate::math::DVec3;
use crate::particles::{Column, ColumnData, Particles, Survey};

/// Most words that are shown of a column.
const MAX_WORDS: usize = 8;

/// What all rows hold.
pub(super) struct FileColumns {
    /// The least and the greatest coordinates.
    pub(super) positions: [DVec3; 2],
    columns: Vec<ColumnValues>,
}

/// The values of a column beyond its range.
#[derive(Default)]
struct ColumnValues {
    /// Number of rows without a number.
    missing: usize,
    /// Each word with its number of rows.
    words: BTreeMap<String, usize>,
}

impl FileColumns {
    /// Adds to the survey what only the rows tell: their number, and the ranges of numbers.
    pub(super) fn read(survey: &mut Survey, particles: &Particles) -> Self {
        survey.count = Some(particles.len() as u64);
        let mut columns = Vec::new();
        for info in &mut survey.columns {
            let column = particles.columns.iter().find(|column| column.name == info.name);
            info.range = column.and_then(Column::range).or(info.range);
            columns.push(column.map(ColumnValues::of).unwrap_or_default());
        }
        let places = (0..particles.len()).map(|row| particles.positions.get(row));
        let nothing = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let positions = places.fold(nothing, |[low, high], at| [low.min(at), high.max(at)]);
        Self { positions, columns }
    }

    /// What is said of a column by its index, after its range.
    pub(super) fn more(&self, index: usize) -> String {
        let ColumnValues { missing, words } = &self.columns[index];
        let mut text = match missing {
            0 => String::new(),
            1 => ", 1 row without a number".to_owned(),
            count => format!(", {count} rows without a number"),
        };
        let shown = words.iter().take(MAX_WORDS).map(|(word, rows)| format!("`{word}` ({rows})"));
        let shown: Vec<String> = shown.collect();
        if !shown.is_empty() {
            text += &format!(": {}", shown.join(", "));
        }
        if let more @ 1.. = words.len().saturating_sub(MAX_WORDS) {
            text += &format!(" and {more} more");
        }
        text
    }

    /// Adds the same to the columns of a JSON object.
    pub(super) fn add_to(&self, value: &mut Value) {
        value["positions"] = json!(self.positions.map(|at| at.to_array()));
        for (index, ColumnValues { missing, words }) in self.columns.iter().enumerate() {
            value["columns"][index]["missing"] = json!(missing);
            if !words.is_empty() {
                value["columns"][index]["words"] = json!(words);
            }
        }
    }
}

impl ColumnValues {
    fn of(column: &Column) -> Self {
        let rows = 0..column.data.len();
        let ColumnData::Text(words) = &column.data else {
            let missing = rows.filter(|row| column.number(*row).is_nan()).count();
            return Self { missing, ..Self::default() };
        };
        let mut rows_of = vec![0; words.names.len()];
        words.codes.iter().for_each(|code| rows_of[*code as usize] += 1);
        let words = words.names.iter().map(ToString::to_string).zip(rows_of).collect();
        Self { missing: 0, words }
    }
}
