//! Reads the rows of one table file in chunks, checks them, and appends them to the scene's array.

use std::fs::File;
use std::io::Read;
use std::ops::RangeInclusive;
use std::path::Path;

use rayon::prelude::*;

use crate::error::Result;
use crate::geometry::Sphere;
use crate::math::{DVec3, MAX_COORDINATE};

use super::colors::SphereColors;
use super::complaint::{TableDiagnostic, layout_help, read_error};
use super::data::Column;
use super::description::ColorStorage;
use super::keys::MIN_RADIUS;
use super::storage::reserve_colors;

/// Bytes of one f32.
pub(super) const VALUE_BYTES: usize = size_of::<f32>();

/// Bytes read at a time, or a little less: whole rows.
const CHUNK_BYTES: usize = 4 << 20;

/// Column indices of the values in a row.
pub(super) struct RowLayout {
    columns: usize,
    sphere: [usize; 4],
    color: Option<[usize; 3]>,
}

impl RowLayout {
    /// Requires x, y, z and radius exactly once in `columns`, and either all or none of r, g, b.
    pub(super) fn new(columns: &[Column]) -> Self {
        let of = |column: Column| columns.iter().position(|&c| c == column);
        let required = |column: Column| of(column).unwrap_or_default();
        let sphere = [Column::X, Column::Y, Column::Z, Column::Radius].map(required);
        let color = [Column::Red, Column::Green, Column::Blue];
        let color = of(Column::Red).map(|_| color.map(required));
        Self { columns: columns.len(), sphere, color }
    }

    /// Bytes per row.
    pub(super) fn row_bytes(&self) -> usize {
        self.columns * VALUE_BYTES
    }
}

/// One value of a row.
fn read_value(row: &[u8], column: usize) -> f32 {
    let mut bytes = [0; VALUE_BYTES];
    bytes.copy_from_slice(&row[column * VALUE_BYTES..][..VALUE_BYTES]);
    f32::from_le_bytes(bytes)
}

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

/// Reads the rows of one table into the array of all spheres.
pub(super) struct TableReader<'r, T> {
    columns: &'r [Column],
    layout: RowLayout,
    /// Allowed range of each column.
    ranges: Vec<RangeInclusive<f32>>,
    rows: u64,
    /// Maximum colour of a row.
    max_color: [f32; 3],
    all: &'r mut Vec<T>,
    pub(super) colors: Option<SphereColors>,
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
    /// A reader for `rows` rows with these columns, and colours up to `brightest`.
    pub(super) fn new(
        columns: &'r [Column],
        colors: ColorStorage,
        rows: u64,
        brightest: [f32; 3],
        all: &'r mut Vec<T>,
    ) -> Result<Self> {
        let layout = RowLayout::new(columns);
        let colors = layout.color.map(|_| reserve_colors(colors, rows)).transpose()?;
        let allowed = columns.iter().map(|&column| column_range(column, brightest)).collect();
        Ok(Self { columns, layout, ranges: allowed, rows, max_color: brightest, all, colors })
    }

    /// Reads the file. The error describes a problem with the file or its rows.
    pub(super) fn read(&mut self, path: &Path) -> std::result::Result<(), TableDiagnostic> {
        let trouble = |error| read_error(path, &error);
        let mut file = File::open(path).map_err(trouble)?;
        let row = self.layout.row_bytes();
        let rows_per_chunk = (CHUNK_BYTES / row).min(self.rows as usize);
        let [mut current, mut upcoming] = [(); 2].map(|()| vec![0; rows_per_chunk * row]);
        let (mut flaws, mut first_flaw) = (InvalidRows::default(), None);
        let (mut done, mut left) = (0, self.rows as usize - rows_per_chunk);
        file.read_exact(&mut upcoming).map_err(trouble)?;
        while !upcoming.is_empty() {
            std::mem::swap(&mut current, &mut upcoming);
            let next = rows_per_chunk.min(left);
            upcoming.resize(next * row, 0);
            // Reads the next rows from disk while the current ones are checked.
            let (came, found) =
                rayon::join(|| file.read_exact(&mut upcoming), || self.append_chunk(&current));
            came.map_err(trouble)?;
            if let (None, Some(at)) = (flaws.first, found.first) {
                first_flaw = Some(self.describe_invalid_row(&current[at * row..], done + at));
            }
            flaws = flaws.merge(found);
            done += current.len() / row;
            left -= next;
        }
        let Some(first) = first_flaw else {
            return Ok(());
        };
        let others = match flaws.count - 1 {
            0 => String::new(),
            1 => "; 1 more row is invalid".to_owned(),
            count => format!("; {count} more rows are invalid"),
        };
        let help = layout_help(self.layout.columns as u64);
        Err((format!("`{}`: {first}{others}", path.display()), Some(help)))
    }

    /// Appends the rows and returns the invalid ones.
    fn append_chunk(&mut self, chunk: &[u8]) -> InvalidRows {
        let rows = chunk.par_chunks_exact(self.layout.row_bytes()).with_min_len(1024);
        let flaw =
            |(number, row)| InvalidRows::from_row(number, self.invalid_column(row).is_some());
        let flaws =
            rows.clone().enumerate().map(flaw).reduce(InvalidRows::default, InvalidRows::merge);
        let sphere = self.layout.sphere;
        // Adding 0 turns -0 into 0.
        let numbers = |row| sphere.map(|column| f64::from(read_value(row, column) + 0.0));
        self.all.par_extend(rows.clone().map(|row| T::of(numbers(row))));
        // Only valid colours can be packed.
        if let (Some(colors), Some(color), 0) = (&mut self.colors, self.layout.color, flaws.count) {
            let given = rows.map(|row| color.map(|column| read_value(row, column) + 0.0));
            colors.extend(given, self.max_color);
        }
        flaws
    }

    /// The first column with an invalid value.
    fn invalid_column(&self, row: &[u8]) -> Option<usize> {
        let is_wrong = |(column, allowed): (usize, &RangeInclusive<f32>)| {
            !allowed.contains(&read_value(row, column))
        };
        self.ranges.iter().enumerate().position(is_wrong)
    }

    /// Describes the invalid value of a row.
    fn describe_invalid_row(&self, row: &[u8], number: usize) -> String {
        let column = self.invalid_column(row).unwrap_or_default();
        let name = self.columns[column].name();
        let offset = (number * self.layout.columns + column) * VALUE_BYTES;
        let allowed = &self.ranges[column];
        format!(
            "row {number} (the first is 0) has {name} = {:?} at byte {offset}; it must be from {} to \
             {}",
            read_value(row, column),
            format_f32(*allowed.start()),
            format_f32(*allowed.end()),
        )
    }
}

/// Allowed values of a column.
pub(super) fn column_range(column: Column, brightest: [f32; 3]) -> RangeInclusive<f32> {
    let largest = MAX_COORDINATE as f32;
    let [red, green, blue] = brightest;
    match column {
        Column::X | Column::Y | Column::Z => -largest..=largest,
        Column::Radius => MIN_RADIUS as f32..=largest,
        Column::Red => 0.0..=red,
        Column::Green => 0.0..=green,
        Column::Blue => 0.0..=blue,
    }
}

/// The shortest number that reads back as the same f32.
pub(super) fn format_f32(x: f32) -> String {
    let is_handy = x == 0.0 || (1e-4..1e6).contains(&x.abs());
    if is_handy { x.to_string() } else { format!("{x:e}") }
}
