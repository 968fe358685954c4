//! Reads sphere arrays in memory into the scene's own storage.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use crate::math::DVec3;

use super::colors::PackedColor;
use super::column_limits::ColumnLimits;
use super::columns::Column;
use super::complaint::TableDiagnostic;
use super::data::{SphereArrays, StridedArray};
use super::description::{ColorSpace, ColorStorage};
use super::storage::{reserve_colors, try_with_capacity};
use super::table_reader::{Row, RowColors};

/// Appends every sphere, moved by `offset`, to `all`, and returns colours and emission if the
/// arrays have any. No linear colour may exceed `max_color`. Every number is read and checked in
/// one pass.
///
/// # Errors
/// Names the first invalid number, or if the colours do not fit into memory.
pub(super) fn read_spheres<T: Row>(
    arrays: &SphereArrays,
    storage: ColorStorage,
    color_space: ColorSpace,
    offset: DVec3,
    max_color: [f32; 3],
    all: &mut Vec<T>,
) -> Result<RowColors, TableDiagnostic> {
    let SphereArrays { center: [x, y, z], radius, color, emission, .. } = arrays;
    let rows = || (0..arrays.len()).into_par_iter();
    let largest = color_space.largest(max_color);
    let limits = |column| ColumnLimits::new(column, offset, largest);
    let first_wrong = AtomicUsize::new(usize::MAX);
    let numbers = checked(Column::SPHERE.map(limits), [x, y, z, radius], &first_wrong);
    all.par_extend(rows().map(|row| {
        let [x, y, z, radius] = numbers(row);
        let [x, y, z] = (DVec3::new(x, y, z) + offset).to_array();
        T::of([x, y, z, radius])
    }));
    let mut colors = RowColors::default();
    if let Some(color) = color {
        // Rounding may have lifted a colour above the limit; packing it again lowers it.
        let lifted = max_color.map(|most| {
            let most = f64::from(most);
            (most + PackedColor::rounding(most)) as f32
        });
        let max_packed = if color[0].is_packed() { lifted } else { largest };
        let limits = |column| ColumnLimits::new(column, offset, max_packed);
        let given = checked(Column::COLOR.map(limits), color.each_ref(), &first_wrong);
        let mut all = reserve_colors(storage, arrays.len() as u64).map_err(complaint)?;
        let linear = |row| color_space.to_linear(given(row).map(|number| number as f32), max_color);
        all.extend(rows().map(linear), max_color);
        colors.albedo = Some(all);
    }
    if let Some(emission) = emission {
        let given = checked(Column::EMISSION.map(limits), emission.each_ref(), &first_wrong);
        let mut all = try_with_capacity(arrays.len() as u64).map_err(complaint)?;
        all.par_extend(rows().map(|row| given(row).map(|number| number as f32)));
        colors.emission = Some(all);
    }
    match first_wrong.load(Ordering::Relaxed) {
        usize::MAX => Ok(colors),
        row => Err(tell(arrays, limits, row)),
    }
}

/// Returns a function that reads the numbers of a row. If one is not allowed, all are 0, and the
/// row becomes `first_wrong` unless an earlier one is.
fn checked<'a, const N: usize>(
    limits: [ColumnLimits; N],
    columns: [&'a StridedArray; N],
    first_wrong: &'a AtomicUsize,
) -> impl Fn(usize) -> [f64; N] + Sync + 'a {
    let columns = columns.map(StridedArray::reader);
    move |row| {
        let numbers = columns.each_ref().map(|column| column.get(row));
        if limits.iter().zip(numbers).all(|(limits, number)| limits.allow(number)) {
            return numbers;
        }
        first_wrong.fetch_min(row, Ordering::Relaxed);
        // Only valid colours can be packed.
        [0.0; N]
    }
}

/// The ids of the spheres, if the arrays have any.
///
/// # Errors
/// If the ids do not fit into memory.
pub(super) fn read_ids(arrays: &SphereArrays) -> Result<Option<Vec<u32>>, TableDiagnostic> {
    let Some(given) = &arrays.ids else { return Ok(None) };
    let mut ids = try_with_capacity(arrays.len() as u64).map_err(complaint)?;
    ids.extend(given.iter());
    Ok(Some(ids))
}

/// Describes the first invalid number of a row.
fn tell(
    arrays: &SphereArrays,
    limits: impl Fn(Column) -> ColumnLimits,
    row: usize,
) -> TableDiagnostic {
    let wrong = arrays.columns().find_map(|(column, array)| {
        let (number, limits) = (array.reader().get(row), limits(column));
        (!limits.allow(number)).then(|| (column, number, limits.describe(number)))
    });
    let (column, number, limits) = wrong.expect("the row has a number that is not allowed");
    let name = column.name();
    let message = format!("row {row} (the first is 0) has {name} = {number:?}{limits}");
    (message, (column == Column::Radius).then(|| "radii are positive".to_owned()))
}

fn complaint(error: crate::error::Error) -> TableDiagnostic {
    (error.to_string(), error.help().map(str::to_owned))
}
