//! Finds the numbers of a table file: in raw rows as `columns` describes them, or in a NumPy array
//! as its header does. Every length is checked against that of the file, before anything is
//! allocated.

use std::fs::File;

use super::columns::{FileColumn, NumberType};
use super::complaint::{layout_help, read_error};
use super::npy::read_header;
use super::table_layout::{FileTable, LayoutError, RowShape, TableLayout, plural};

impl FileTable<'_> {
    /// Finds the numbers of the table. If `columns` are not listed, the second value lists them.
    pub(super) fn layout(&self) -> Result<(TableLayout, Option<Vec<FileColumn>>), LayoutError> {
        let (file, bytes) = self.open()?;
        match read_header(&file).map_err(|error| read_error(self.path, &error))? {
            None => Ok((self.raw(bytes)?, None)),
            Some(Err(why)) => {
                let help = "save a two-dimensional array with `.astype(\"<f4\")` or `\"<f8\"`";
                Err(self.error("file", format!("is a NumPy file {why}"), help))
            }
            Some(Ok(header)) => self.npy(header, bytes),
        }
    }

    fn open(&self) -> Result<(File, u64), LayoutError> {
        let trouble = |error| LayoutError::from(read_error(self.path, &error));
        let metadata = self.path.metadata().map_err(trouble)?;
        if metadata.is_dir() {
            return Err(self.error("file", "is a folder", "name the file with the rows"));
        }
        if !metadata.is_file() {
            let help = "the length must be known in advance: write the rows to a file";
            return Err(self.error("file", "is not a regular file", help));
        }
        if metadata.len() == 0 {
            return Err(self.error("file", "is empty", "a table has at least one row"));
        }
        Ok((File::open(self.path).map_err(trouble)?, metadata.len()))
    }

    /// Rows of raw numbers.
    fn raw(&self, bytes: u64) -> Result<TableLayout, LayoutError> {
        if self.columns.is_empty() {
            let message = format!("`{}.columns` is missing", self.at);
            let help =
                "add `columns = [\"x\", \"y\", \"z\", \"radius\"]`, or what else the numbers \
                        of a row are"
                    .to_owned();
            return Err(LayoutError { key: "columns", message, help: Some(help) });
        }
        let mut row_bytes = 0;
        let mut place = |&column: &FileColumn| {
            let number = column.number.unwrap_or(NumberType::F32);
            row_bytes += number.bytes() as u64;
            (column, row_bytes - number.bytes() as u64, number)
        };
        let columns = self.columns.iter().map(&mut place).collect();
        let help = layout_help(self.columns.len(), row_bytes);
        let Some(bytes) = bytes.checked_sub(self.skip_bytes).filter(|&bytes| bytes > 0) else {
            let skipped = self.skip_bytes;
            let says =
                format!("has {}, and `skip_bytes` leaves out {skipped}", plural(bytes, "byte"));
            return Err(self.error("skip_bytes", says, "a table has at least one row"));
        };
        let (rows, over) = (bytes / row_bytes, bytes % row_bytes);
        if over > 0 {
            let says = format!(
                "has {}, which is not a whole number of rows: {} of {row_bytes} bytes and {} left over",
                plural(bytes, "byte"),
                plural(rows, "row"),
                plural(over, "byte"),
            );
            return Err(self.error("file", says, &help));
        }
        self.interleaved(RowShape { columns, row_bytes }, self.skip_bytes, rows, help)
    }
}
