//! Some rows of a table file in memory: the numbers of the columns that are read.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};

use super::columns::NumberType;
use super::table_layout::{CHUNK_BYTES, TableLayout};

/// Rows of the file in memory.
#[derive(Default)]
pub(super) struct Chunk {
    bytes: Vec<u8>,
    /// Number of rows.
    pub(super) rows: usize,
    /// The columns that are read, in the order of the layout.
    pub(super) columns: Vec<ChunkColumn>,
}

/// The numbers of a column in a chunk.
#[derive(Clone, Copy)]
pub(super) struct ChunkColumn {
    number: NumberType,
    first: usize,
    stride: usize,
}

impl Chunk {
    /// Number of rows that are read at a time.
    pub(super) fn max_rows(layout: &TableLayout) -> usize {
        let row_bytes = match layout.interleaved {
            Some((_, row_bytes)) => row_bytes,
            None => layout.columns.iter().map(|column| column.number.bytes()).sum(),
        };
        (CHUNK_BYTES / row_bytes.max(1)).max(1)
    }

    /// Reads rows of the table, counted without those that are left out at its beginning.
    ///
    /// # Errors
    /// If the file cannot be read, or has become shorter.
    pub(super) fn load(
        &mut self,
        layout: &TableLayout,
        file: &mut File,
        first_row: u64,
        rows: usize,
    ) -> io::Result<()> {
        let first_row = layout.skip_rows + first_row;
        self.rows = rows;
        self.columns.clear();
        match layout.interleaved {
            _ if rows == 0 => Ok(()),
            Some((data_start, row_bytes)) => {
                let start = data_start + first_row * row_bytes as u64;
                self.bytes.resize(rows * row_bytes, 0);
                self.columns.extend(layout.columns.iter().map(|column| ChunkColumn {
                    number: column.number,
                    first: (column.first - data_start) as usize,
                    stride: row_bytes,
                }));
                file.seek(SeekFrom::Start(start))?;
                file.read_exact(&mut self.bytes)
            }
            None => self.load_columns(layout, file, first_row, rows),
        }
    }

    /// Reads the numbers of each column from its own place in the file.
    fn load_columns(
        &mut self,
        layout: &TableLayout,
        file: &mut File,
        first_row: u64,
        rows: usize,
    ) -> io::Result<()> {
        let bytes_of = |number: NumberType| rows * number.bytes();
        self.bytes.resize(layout.columns.iter().map(|column| bytes_of(column.number)).sum(), 0);
        let mut first = 0;
        for column in &layout.columns {
            let number = column.number;
            let end = first + bytes_of(number);
            file.seek(SeekFrom::Start(column.position(first_row)))?;
            file.read_exact(&mut self.bytes[first..end])?;
            self.columns.push(ChunkColumn { number, first, stride: number.bytes() });
            first = end;
        }
        Ok(())
    }

    /// The number of a row; -0 becomes 0.
    #[inline]
    pub(super) fn get(
        &self,
        ChunkColumn { number, first, stride }: ChunkColumn,
        row: usize,
    ) -> f64 {
        let bytes = &self.bytes[first + row * stride..];
        0.0 + match number {
            NumberType::F32 => f64::from(f32::from_le_bytes(leading(bytes))),
            NumberType::F64 => f64::from_le_bytes(leading(bytes)),
        }
    }

    /// The columns with these positions in the layout.
    pub(super) fn select<const N: usize>(&self, positions: [usize; N]) -> [ChunkColumn; N] {
        positions.map(|position| self.columns[position])
    }
}

fn leading<const N: usize>(bytes: &[u8]) -> [u8; N] {
    let mut number = [0; N];
    number.copy_from_slice(&bytes[..N]);
    number
}
