//! Where the numbers of a table file are.

use std::path::Path;

use super::columns::{Column, FileColumn, NumberType};
use super::complaint::TableDiagnostic;

/// Bytes read at a time, or a little less: whole rows.
pub(super) const CHUNK_BYTES: usize = 4 << 20;

/// The numbers of a table file.
#[derive(Clone, Debug)]
pub(super) struct TableLayout {
    /// The columns that are read.
    pub(super) columns: Vec<ColumnLayout>,
    /// Number of rows that are read.
    pub(super) rows: u64,
    /// Number of rows before them.
    pub(super) skip_rows: u64,
    /// Position of the file's first row, and bytes of a row; `None` if the numbers of each column
    /// follow each other.
    pub(super) interleaved: Option<(u64, usize)>,
    /// Describes the expected rows.
    pub(super) help: String,
}

/// The numbers of one column.
#[derive(Clone, Copy, Debug)]
pub(super) struct ColumnLayout {
    pub(super) column: Column,
    pub(super) number: NumberType,
    /// Position in the file of the number in its first row.
    pub(super) first: u64,
    /// Bytes from one row to the next.
    pub(super) stride: u64,
}

/// An error in a table's file, and the key that it concerns.
pub(super) struct LayoutError {
    pub(super) key: &'static str,
    pub(super) message: String,
    pub(super) help: Option<String>,
}

/// The file of a table, as the scene describes it.
pub(super) struct FileTable<'a> {
    /// Path of the table's keys, for messages.
    pub(super) at: String,
    pub(super) path: &'a Path,
    pub(super) columns: &'a [FileColumn],
    pub(super) skip_rows: u64,
    pub(super) skip_bytes: u64,
}

impl ColumnLayout {
    /// Position in the file of the number in a row of the file.
    pub(super) fn position(&self, row: u64) -> u64 {
        self.first + row * self.stride
    }
}

impl TableLayout {
    /// The position of a column among those that are read.
    pub(super) fn find(&self, column: Column) -> Option<usize> {
        self.columns.iter().position(|found| found.column == column)
    }

    /// Returns true if centres or radii are in f64.
    pub(super) fn is_f64(&self) -> bool {
        let is_wide = |layout: &ColumnLayout| {
            Column::SPHERE.contains(&layout.column) && layout.number == NumberType::F64
        };
        self.columns.iter().any(is_wide)
    }
}

impl From<TableDiagnostic> for LayoutError {
    fn from((message, help): TableDiagnostic) -> Self {
        Self { key: "file", message, help }
    }
}

/// A row whose numbers follow each other, and its length.
pub(super) struct RowShape {
    /// Each column with the place of its number in the row.
    pub(super) columns: Vec<(FileColumn, u64, NumberType)>,
    pub(super) row_bytes: u64,
}

impl FileTable<'_> {
    /// An error that says something of the file.
    pub(super) fn error(
        &self,
        key: &'static str,
        says: impl AsRef<str>,
        help: &str,
    ) -> LayoutError {
        let message = format!("`{}` {}", self.path.display(), says.as_ref());
        LayoutError { key, message, help: Some(help.to_owned()) }
    }

    /// The layout of rows that follow each other from `data_start` on.
    pub(super) fn interleaved(
        &self,
        row: RowShape,
        data_start: u64,
        rows: u64,
        help: String,
    ) -> Result<TableLayout, LayoutError> {
        let RowShape { columns, row_bytes } = row;
        if row_bytes > CHUNK_BYTES as u64 {
            let says = format!("has rows of {row_bytes} bytes, more than {CHUNK_BYTES}");
            return Err(self.error("file", says, "write what a table needs into a smaller file"));
        }
        let column = |(column, offset, number): (FileColumn, u64, NumberType)| {
            let (first, stride) = (data_start + offset, row_bytes);
            Some(ColumnLayout { column: column.column?, number, first, stride })
        };
        let columns = columns.into_iter().filter_map(column).collect();
        self.skip_rows(columns, rows, Some((data_start, row_bytes as usize)), help)
    }

    /// The layout without the rows that are left out at the beginning.
    pub(super) fn skip_rows(
        &self,
        columns: Vec<ColumnLayout>,
        rows: u64,
        interleaved: Option<(u64, usize)>,
        help: String,
    ) -> Result<TableLayout, LayoutError> {
        let skip_rows = self.skip_rows;
        match rows.checked_sub(skip_rows) {
            None | Some(0) => {
                let rows = plural(rows, "row");
                let says = format!("has {rows}, and `skip_rows` leaves out {skip_rows}");
                Err(self.error("skip_rows", says, "a table has at least one row"))
            }
            Some(rows) => Ok(TableLayout { columns, rows, skip_rows, interleaved, help }),
        }
    }
}

/// Formats a count, as in `1 row` or `2 rows`.
pub(super) fn plural(number: u64, singular: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{number} {singular}{plural}")
}
