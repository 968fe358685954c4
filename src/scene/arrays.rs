//! Reads sphere arrays in memory into the scene's own storage.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::colors::SphereColors;
use super::complaint::TableDiagnostic;
use super::data::{Column, SphereArrays, StridedArray};
use super::description::ColorStorage;
use super::storage::{reserve_colors, try_with_capacity};
use super::table_reader::{Row, column_range, format_f32};

/// Appends every sphere to `all`, and returns the colours if the arrays have any. No colour may
/// exceed `brightest`. Every number is read and checked in one pass.
///
/// # Errors
/// Names the first invalid number, or if the colours do not fit into memory.
pub(super) fn read_f32<T: Row>(
    arrays: &SphereArrays,
    storage: ColorStorage,
    brightest: [f32; 3],
    all: &mut Vec<T>,
) -> Result<Option<SphereColors>, TableDiagnostic> {
    let SphereArrays { center: [x, y, z], radius, color, .. } = arrays;
    let first_wrong = AtomicUsize::new(usize::MAX);
    let numbers = {
        use Column::{Radius, X, Y, Z};
        let is_allowed = within([X, Y, Z, Radius], brightest);
        let columns = [x, y, z, radius].map(StridedArray::reader);
        move |row: usize| {
            let numbers = columns.each_ref().map(|column| column.get(row));
            (numbers, is_allowed(&numbers))
        }
    };
    let sphere = |row: usize| {
        let (numbers, is_allowed) = numbers(row);
        if !is_allowed {
            first_wrong.fetch_min(row, Ordering::Relaxed);
        }
        T::of(numbers)
    };
    all.par_extend((0..arrays.len()).into_par_iter().map(sphere));
    let colors = match color {
        None => None,
        Some(color) => {
            use Column::{Blue, Green, Red};
            let is_allowed = within([Red, Green, Blue], brightest);
            let columns = color.each_ref().map(StridedArray::reader);
            let mut colors = reserve_colors(storage, arrays.len() as u64).map_err(complaint)?;
            let color = |row: usize| {
                let numbers = columns.each_ref().map(|column| column.get(row));
                if is_allowed(&numbers) {
                    return numbers.map(|number| number as f32);
                }
                first_wrong.fetch_min(row, Ordering::Relaxed);
                // Only valid colours can be packed.
                [0.0; 3]
            };
            colors.extend((0..arrays.len()).into_par_iter().map(color), brightest);
            Some(colors)
        }
    };
    match first_wrong.into_inner() {
        usize::MAX => Ok(colors),
        row => Err(tell(arrays, brightest, row)),
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

/// Returns a predicate that is true for numbers these columns may hold. Files have the same limits.
fn within<const N: usize>(
    columns: [Column; N],
    brightest: [f32; 3],
) -> impl Fn(&[f64; N]) -> bool + Sync {
    let limits = columns.map(|column| {
        let allowed = column_range(column, brightest);
        f64::from(*allowed.start())..=f64::from(*allowed.end())
    });
    move |numbers| limits.iter().zip(numbers).all(|(limits, number)| limits.contains(number))
}

/// Describes the first invalid number of a row.
fn tell(arrays: &SphereArrays, brightest: [f32; 3], row: usize) -> TableDiagnostic {
    let wrong = arrays.columns().find_map(|(column, array)| {
        let number = array.reader().get(row);
        (!within([column], brightest)(&[number])).then_some((column, number))
    });
    let (column, number) = wrong.expect("the row has a number that is not allowed");
    let allowed = column_range(column, brightest);
    let message = format!(
        "row {row} (the first is 0) has {} = {number:?}; it must be from {} to {}",
        column.name(),
        format_f32(*allowed.start()),
        format_f32(*allowed.end()),
    );
    (message, (column == Column::Radius).then(|| "radii are positive".to_owned()))
}

fn complaint(error: crate::error::Error) -> TableDiagnostic {
    (error.to_string(), error.help().map(str::to_owned))
}
