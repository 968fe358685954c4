//! Reads the rows of one table file in chunks, checks them, and appends them to the scene's array.

use std::fs::File;
use std::path::Path;

use rayon::prelude::*;

use crate::error::Result;
use crate::geometry::Sphere;
use crate::math::DVec3;

use super::colors::SphereColors;
use super::column_limits::ColumnLimits;
use super::columns::{Column, NumberType};
use super::complaint::{TableDiagnostic, read_error};
use super::description::{ColorSpace, ColorStorage};
use super::storage::{reserve_colors, try_with_capacity};
use super::table_chunk::{Chunk, ChunkColumn};
use super::table_layout::TableLayout;

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
    color_space: ColorSpace,
    /// Maximum linear colour of a row.
    max_color: [f32; 3],
    all: &'r mut Vec<T>,
    pub(super) colors: RowColors,
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
    /// A reader for rows that are moved by `offset`, with linear colours up to `max_color`.
    pub(super) fn new(
        layout: &'r TableLayout,
        colors: ColorStorage,
        color_space: ColorSpace,
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
        let largest = color_space.largest(max_color);
        let limit = |column: Column| ColumnLimits::new(column, offset, largest);
        Ok(Self {
            limits: layout.columns.iter().map(|layout| limit(layout.column)).collect(),
            sphere: Column::SPHERE.map(required),
            layout,
            color,
            emission,
            offset,
            color_space,
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
        let rows_per_chunk = Chunk::max_rows(layout);
        let [mut current, mut upcoming] = [(); 2].map(|()| Chunk::default());
        let (mut flaws, mut first_flaw) = (InvalidRows::default(), None);
        let (mut done, mut left) = (0, layout.rows as usize);
        let mut next = rows_per_chunk.min(left);
        upcoming.load(layout, &mut file, 0, next).map_err(trouble)?;
        while upcoming.rows > 0 {
            std::mem::swap(&mut current, &mut upcoming);
            left -= current.rows;
            next = rows_per_chunk.min(left);
            let first = layout.rows - left as u64;
            // Reads the next rows from disk while the current ones are checked.
            let (came, found) = rayon::join(
                || upcoming.load(layout, &mut file, first, next),
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
            1 => "; 1 more row is invalid".to_owned(),
            count => format!("; {count} more rows are invalid"),
        };
        Err((format!("`{}`: {first}{others}", path.display()), Some(layout.help.clone())))
    }

    /// Appends the rows and returns the invalid ones.
    fn append_chunk(&mut self, chunk: &Chunk) -> InvalidRows {
        let rows = || (0..chunk.rows).into_par_iter().with_min_len(MIN_ROWS_PER_TASK);
        let flaw = |row| InvalidRows::from_row(row, self.invalid_column(chunk, row).is_some());
        let flaws = rows().map(flaw).reduce(InvalidRows::default, InvalidRows::merge);
        let [center @ .., radius] = chunk.select(self.sphere);
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
            let columns = chunk.select(columns);
            rows().map(move |row| columns.map(|column| chunk.get(column, row) as f32))
        };
        if let (Some(colors), Some(color)) = (albedo, self.color) {
            let (space, most) = (self.color_space, self.max_color);
            colors.extend(values(color).map(|color| space.to_linear(color, most)), most);
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
