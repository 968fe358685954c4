//! Finds the columns of a sphere table in a NumPy array.

use crate::particles::npy::NpyField;
use crate::scene::columns::{Column, FileColumn, NumberType};
use crate::scene::table_layout::{
    ColumnLayout, FileTable, LayoutError, RowShape, TableLayout, plural,
};

use super::header::{NpyHeader, NpyRow, number_of};

/// Maximum numbers in a record whose columns are not listed.
const MAX_UNLISTED_COLUMNS: u64 = 4096;

impl FileTable<'_> {
    /// The rows of a NumPy array.
    pub(in crate::scene) fn npy(
        &self,
        header: NpyHeader,
        bytes: u64,
    ) -> Result<(TableLayout, Option<Vec<FileColumn>>), LayoutError> {
        let NpyHeader { data_start, rows, row } = header;
        if self.skip_bytes > 0 {
            let says = "is a NumPy file, whose header says where its rows begin";
            return Err(self.error("skip_bytes", says, "remove `skip_bytes`"));
        }
        let row_bytes = match &row {
            NpyRow::Numbers { number, count, .. } => count.checked_mul(number.bytes() as u64),
            NpyRow::Record(fields) => fields.iter().try_fold(0, |sum: u64, field| {
                sum.checked_add(field.value_bytes.checked_mul(field.count)?)
            }),
        };
        let held = bytes.saturating_sub(data_start);
        if row_bytes.and_then(|row| row.checked_mul(rows)) != Some(held) {
            let row_bytes = row_bytes.map_or("too many".to_owned(), |bytes| bytes.to_string());
            let says = format!(
                "has {} after its header, which promises {} of {row_bytes} bytes",
                plural(held, "byte"),
                plural(rows, "row"),
            );
            return Err(self.error("file", says, "the file is damaged: save it again"));
        }
        if held == 0 {
            return Err(self.error("file", "has no rows", "a table has at least one row"));
        }
        let help =
            "`columns` says what each number of a row is: correct it, or the file".to_owned();
        match row {
            NpyRow::Numbers { number, count, is_column_major } => {
                self.check_types(count, |_| (Some(number), number.name().to_owned()))?;
                let size = number.bytes() as u64;
                if is_column_major {
                    let first = |at: usize| data_start + at as u64 * rows * size;
                    let column = |(at, column): (usize, &FileColumn)| {
                        let (first, stride) = (first(at), size);
                        Some(ColumnLayout { column: column.column?, number, first, stride })
                    };
                    let columns = self.columns.iter().enumerate().filter_map(column).collect();
                    return Ok((self.skip_rows(columns, rows, None, help)?, None));
                }
                let place =
                    |(at, &column): (usize, &FileColumn)| (column, at as u64 * size, number);
                let columns = self.columns.iter().enumerate().map(place).collect();
                let row = RowShape { columns, row_bytes: count * size };
                Ok((self.interleaved(row, data_start, rows, help)?, None))
            }
            NpyRow::Record(fields) => {
                let unlisted =
                    self.columns.is_empty().then(|| self.unlisted(&fields)).transpose()?;
                let row = match &unlisted {
                    Some(columns) => {
                        FileTable { columns, at: String::new(), ..*self }.record(&fields)?
                    }
                    None => self.record(&fields)?,
                };
                Ok((self.interleaved(row, data_start, rows, help)?, unlisted))
            }
        }
    }

    /// The columns that the names of the fields say.
    fn unlisted(&self, fields: &[NpyField]) -> Result<Vec<FileColumn>, LayoutError> {
        let total = fields.iter().fold(0, |sum: u64, field| sum.saturating_add(field.count));
        if total > MAX_UNLISTED_COLUMNS {
            let says = format!("has {total} numbers in a row, too many to go by their names");
            return Err(self.error("columns", says, "list them in `columns`"));
        }
        let of_field = |field: &NpyField| {
            let column = Column::named(&field.name).filter(|_| field.count == 1);
            std::iter::repeat_n(FileColumn { column, number: None }, field.count as usize)
        };
        Ok(fields.iter().flat_map(of_field).collect())
    }

    /// The columns of a record, in the order of its fields.
    fn record(&self, fields: &[NpyField]) -> Result<RowShape, LayoutError> {
        let total = fields.iter().fold(0, |sum: u64, field| sum.saturating_add(field.count));
        let field_of = |at: usize| {
            let mut end = 0;
            fields.iter().find(|field| {
                end += field.count;
                (at as u64) < end
            })
        };
        self.check_types(total, |at| {
            let field = field_of(at);
            (field.and_then(number_of), field.map_or("", |field| &field.dtype).to_owned())
        })?;
        let mut place = 0;
        let mut columns = Vec::new();
        for field in fields {
            for _ in 0..field.count {
                if let (Some(number), Some(&column)) =
                    (number_of(field), self.columns.get(columns.len()))
                {
                    columns.push((column, place, number));
                } else {
                    let skipped = FileColumn { column: None, number: None };
                    columns.push((skipped, place, NumberType::F32));
                }
                place += field.value_bytes;
            }
        }
        Ok(RowShape { columns, row_bytes: place })
    }

    /// Checks the number of columns of a NumPy file, and their types, which `of` returns with their
    /// names.
    fn check_types(
        &self,
        count: u64,
        of: impl Fn(usize) -> (Option<NumberType>, String),
    ) -> Result<(), LayoutError> {
        let listed = self.columns.len() as u64;
        if listed != count {
            let listed =
                if listed == 0 { "does not list them".into() } else { format!("lists {listed}") };
            let says = format!("has {} in a row, but `columns` {listed}", plural(count, "number"));
            let help = "give one entry for each number, `\"_\"` for those that are not read";
            return Err(self.error("columns", says, help));
        }
        for (at, column) in self.columns.iter().enumerate() {
            let (number, name) = of(at);
            let is_right = match column {
                FileColumn { column: None, number: None } => true,
                column => number.is_some_and(|n| column.number.is_none_or(|given| given == n)),
            };
            if !is_right {
                let says =
                    format!("holds numbers of type `{name}` in its column {at}, not `{column}`");
                let help = "columns are counted from 0, and their numbers are `<f4` or `<f8`; a NumPy \
                            file says which, so that `columns` needs no types";
                return Err(self.error("columns", says, help));
            }
        }
        Ok(())
    }
}
