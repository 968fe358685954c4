//! Reads the rows of one table file in chunks, checks them, and appends them to the scene's array.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::ops::RangeInclusive;
use std::path::Path;

use rayon::prelude::*;

use crate::error::Result;
use crate::geometry::Sphere;
use crate::math::{DVec3, MAX_COORDINATE};

use super::colors::SphereColors;
use super::columns::{Column, NumberType};
use super::complaint::{TableDiagnostic, read_error};
use super::description::ColorStorage;
use super::keys::{MAX_RADIANCE, MIN_RADIUS};
use super::storage::{reserve_colors, try_with_capacity};
use super::table_layout::{CHUNK_BYTES, TableLayout};

/// Rows that one thread checks at a time, at least.
const MIN_ROWS_PER_TASK: usize = 1024;

/// Storage type of a sphere's four numbers.
pub(super) trait Row: Send + Sync {
    /// From x, y, z and the radius.
    fn of(numbers: [f64; 4]) -> Self;
}

impl Row for [f32; 4] {
    fn of(numbers: [f64; 4]) -> Self {
        numbers.map(|number| number as f32)
    }
}

impl Row for Sphere {
    fn of([x, y, z, radius]: [f64; 4]) -> Self {
        Self { center: DVec3::new(x, y, z), radius }
    }
}

/// Colours and emission of a table's rows, if it has any.
#[derive(Debug, Default)]
pub(super) struct RowColors {
    /// Linear colours in `[0, 1]`.
    pub(super) albedo: Option<SphereColors>,
    /// Emitted radiance, in W/(sr m^2).
    pub(super) emission: Option<Vec<[f32; 3]>>,
}

/// Reads the rows of one table into the array of all spheres.
pub(super) struct TableReader<'r, T> {
    layout: &'r TableLayout,
    limits: Vec<ColumnLimits>,
    /// Positions of the columns in the layout.
    sphere: [usize; 4],
    color: Option<[usize; 3]>,
    emission: Option<[usize; 3]>,
    offset: DVec3,
    /// Maximum colour of a row.
    max_color: [f32; 3],
    all: &'r mut Vec<T>,
    pub(super) colors: RowColors,
}

/// Rows of the file in memory.
#[derive(Default)]
struct Chunk {
    bytes: Vec<u8>,
    rows: usize,
    columns: Vec<ChunkColumn>,
}

/// The numbers of a column in a chunk.
#[derive(Clone, Copy)]
struct ChunkColumn {
    number: NumberType,
    first: usize,
    stride: usize,
}

impl Chunk {
    /// The number of a row; -0 becomes 0.
    #[inline]
    fn get(&self, ChunkColumn { number, first, stride }: ChunkColumn, row: usize) -> f64 {
        let bytes = &self.bytes[first + row * stride..];
        0.0 + match number {
            NumberType::F32 => f64::from(f32::from_le_bytes(leading(bytes))),
            NumberType::F64 => f64::from_le_bytes(leading(bytes)),
        }
    }

    fn columns<const N: usize>(&self, indices: [usize; N]) -> [ChunkColumn; N] {
        indices.map(|index| self.columns[index])
    }
}

fn leading<const N: usize>(bytes: &[u8]) -> [u8; N] {
    let mut number = [0; N];
    number.copy_from_slice(&bytes[..N]);
    number
}

/// Rows with invalid values.
#[derive(Clone, Copy, Default)]
struct InvalidRows {
    first: Option<usize>,
    count: usize,
}

impl InvalidRows {
    fn from_row(number: usize, is_wrong: bool) -> Self {
        Self { first: is_wrong.then_some(number), count: usize::from(is_wrong) }
    }

    fn merge(self, later: Self) -> Self {
        Self { first: self.first.or(later.first), count: self.count + later.count }
    }
}

impl<'r, T: Row> TableReader<'r, T> {
    /// A reader for rows that are moved by `offset`, with colours up to `max_color`.
    pub(super) fn new(
        layout: &'r TableLayout,
        colors: ColorStorage,
        offset: DVec3,
        max_color: [f32; 3],
        all: &'r mut Vec<T>,
    ) -> Result<Self> {
        let required = |column| layout.find(column).unwrap_or_default();
        let three = |columns: [Column; 3]| layout.find(columns[0]).map(|_| columns.map(required));
        let color = three(Column::COLOR);
        let grey = layout.find(Column::Emission).map(|grey| [grey; 3]);
        let emission = grey.or_else(|| three(Column::EMISSION));
        let colors = RowColors {
            albedo: color.map(|_| reserve_colors(colors, layout.rows)).transpose()?,
            emission: emission.map(|_| try_with_capacity(layout.rows)).transpose()?,
        };
        let limit = |column: Column| ColumnLimits::new(column, offset, max_color);
        Ok(Self {
            limits: layout.columns.iter().map(|layout| limit(layout.column)).collect(),
            sphere: Column::SPHERE.map(required),
            layout,
            color,
            emission,
            offset,
            max_color,
            all,
            colors,
        })
    }

    /// Reads the file. The error describes a problem with the file or its rows.
    pub(super) fn read(&mut self, path: &Path) -> std::result::Result<(), TableDiagnostic> {
        let layout = self.layout;
        let trouble = |error| read_error(path, &error);
        let mut file = File::open(path).map_err(trouble)?;
        let rows_per_chunk = rows_per_chunk(layout);
        let [mut current, mut upcoming] = [(); 2].map(|()| Chunk::default());
        let (mut flaws, mut first_flaw) = (InvalidRows::default(), None);
        let (mut done, mut left) = (0, layout.rows as usize);
        let mut next = rows_per_chunk.min(left);
        load(layout, &mut file, 0, next, &mut upcoming).map_err(trouble)?;
        while upcoming.rows > 0 {
            std::mem::swap(&mut current, &mut upcoming);
            left -= current.rows;
            next = rows_per_chunk.min(left);
            let first = layout.rows - left as u64;
            // Reads the next rows from disk while the current ones are checked.
            let (came, found) = rayon::join(
                || load(layout, &mut file, first, next, &mut upcoming),
                || self.append_chunk(&current),
            );
            came.map_err(trouble)?;
            if let (None, Some(at)) = (flaws.first, found.first) {
                first_flaw = Some(self.describe_invalid_row(&current, at, done + at));
            }
            flaws = flaws.merge(found);
            done += current.rows;
        }
        let Some(first) = first_flaw else {
            return Ok(());
        };
        let others = match flaws.count - 1 {
            0 => String::new(),
            1 => "; 1 more row is wrong".to_owned(),
            count => format!("; {count} more rows are wrong"),
        };
        Err((format!("`{}`: {first}{others}", path.display()), Some(layout.help.clone())))
    }

    /// Appends the rows and returns the invalid ones.
    fn append_chunk(&mut self, chunk: &Chunk) -> InvalidRows {
        let rows = || (0..chunk.rows).into_par_iter().with_min_len(MIN_ROWS_PER_TASK);
        let flaw = |row| InvalidRows::from_row(row, self.invalid_column(chunk, row).is_some());
        let flaws = rows().map(flaw).reduce(InvalidRows::default, InvalidRows::merge);
        let [center @ .., radius] = chunk.columns(self.sphere);
        let offset = self.offset;
        let sphere = |row: usize| {
            let center = center.map(|column| chunk.get(column, row));
            let [x, y, z] = (DVec3::from_array(center) + offset).to_array();
            T::of([x, y, z, chunk.get(radius, row)])
        };
        self.all.par_extend(rows().map(sphere));
        // Only valid colours can be packed.
        if flaws.count > 0 {
            return flaws;
        }
        let RowColors { albedo, emission } = &mut self.colors;
        let values = |columns: [usize; 3]| {
            let columns = chunk.columns(columns);
            rows().map(move |row| columns.map(|column| chunk.get(column, row) as f32))
        };
        if let (Some(colors), Some(color)) = (albedo, self.color) {
            colors.extend(values(color), self.max_color);
        }
        if let (Some(all), Some(emission)) = (emission, self.emission) {
            all.par_extend(values(emission));
        }
        flaws
    }

    /// The first column with an invalid value.
    fn invalid_column(&self, chunk: &Chunk, row: usize) -> Option<usize> {
        let is_wrong = |(column, limits): (&ChunkColumn, &ColumnLimits)| {
            !limits.allow(chunk.get(*column, row))
        };
        chunk.columns.iter().zip(&self.limits).position(is_wrong)
    }

    /// Describes the invalid value of a row of a chunk, which has this number in the table.
    fn describe_invalid_row(&self, chunk: &Chunk, row: usize, number: usize) -> String {
        let column = self.invalid_column(chunk, row).unwrap_or_default();
        let value = chunk.get(chunk.columns[column], row);
        let layout = &self.layout.columns[column];
        let number = self.layout.skip_rows + number as u64;
        let (name, position) = (layout.column.name(), layout.position(number));
        let shown = match layout.number {
            NumberType::F32 => format!("{:?}", value as f32),
            NumberType::F64 => format!("{value:?}"),
        };
        let limits = self.limits[column].describe(value);
        format!("row {number} (the first is 0) has {name} = {shown} at byte {position}{limits}")
    }
}

/// Rows that are read at a time.
fn rows_per_chunk(layout: &TableLayout) -> usize {
    let row_bytes = match layout.interleaved {
        Some((_, row_bytes)) => row_bytes,
        None => layout.columns.iter().map(|column| column.number.bytes()).sum(),
    };
    (CHUNK_BYTES / row_bytes.max(1)).max(1)
}

/// Reads rows of the table, counted without those that are left out.
fn load(
    layout: &TableLayout,
    file: &mut File,
    first_row: u64,
    rows: usize,
    chunk: &mut Chunk,
) -> io::Result<()> {
    let Chunk { bytes, rows: held, columns } = chunk;
    let first_row = layout.skip_rows + first_row;
    *held = rows;
    columns.clear();
    if rows == 0 {
        return Ok(());
    }
    if let Some((data_start, row_bytes)) = layout.interleaved {
        bytes.resize(rows * row_bytes, 0);
        file.seek(SeekFrom::Start(data_start + first_row * row_bytes as u64))?;
        file.read_exact(bytes)?;
        columns.extend(layout.columns.iter().map(|column| ChunkColumn {
            number: column.number,
            first: (column.first - data_start) as usize,
            stride: row_bytes,
        }));
        return Ok(());
    }
    bytes.resize(layout.columns.iter().map(|column| rows * column.number.bytes()).sum(), 0);
    let mut rest = &mut bytes[..];
    let mut first = 0;
    for column in &layout.columns {
        let stride = column.number.bytes();
        let (of_column, behind) = rest.split_at_mut(rows * stride);
        file.seek(SeekFrom::Start(column.position(first_row)))?;
        file.read_exact(of_column)?;
        columns.push(ChunkColumn { number: column.number, first, stride });
        first += rows * stride;
        rest = behind;
    }
    Ok(())
}

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
