//! Arrays in memory, read once into the scene's own storage.

use rayon::prelude::*;

use crate::geometry::Sphere;
use crate::math::DVec3;

use super::colors::Colors;
use super::complaint::Complaint;
use super::data::{Column, SphereArrays};
use super::description::ColorStorage;
use super::rows::{allowed, in_words};
use super::storage::room_for_colors;

/// Appends `[x, y, z, radius]` of every sphere.
///
/// # Errors
/// With the first number that cannot be.
pub(super) fn read(arrays: &SphereArrays, all: &mut Vec<[f32; 4]>) -> Result<(), Complaint> {
    check(arrays, [1.0; 3])?;
    let SphereArrays { center: [x, y, z], radius, .. } = arrays;
    let row = |row: usize| [x, y, z, radius].map(|array| array.get(row) as f32);
    all.par_extend((0..arrays.len()).into_par_iter().map(row));
    Ok(())
}

/// Appends every sphere in f64.
///
/// # Errors
/// As [`read`].
pub(super) fn read_exact(arrays: &SphereArrays, all: &mut Vec<Sphere>) -> Result<(), Complaint> {
    check(arrays, [1.0; 3])?;
    let SphereArrays { center: [x, y, z], radius, .. } = arrays;
    let row = |row: usize| Sphere {
        center: DVec3::new(x.get(row), y.get(row), z.get(row)),
        radius: radius.get(row),
    };
    all.par_extend((0..arrays.len()).into_par_iter().map(row));
    Ok(())
}

/// The colours, where there are some; none brighter than `brightest`.
///
/// # Errors
/// With the first number that cannot be, or that there is no memory.
pub(super) fn read_colors(
    arrays: &SphereArrays,
    storage: ColorStorage,
    brightest: [f32; 3],
) -> Result<Option<Colors>, Complaint> {
    let Some(color) = &arrays.color else { return Ok(None) };
    check(arrays, brightest)?;
    let mut colors = room_for_colors(storage, arrays.len() as u64)
        .map_err(|error| (error.to_string(), error.help().map(str::to_owned)))?;
    let rows = (0..arrays.len()).into_par_iter();
    let row = |row: usize| color.each_ref().map(|array| array.get(row) as f32);
    colors.extend(rows.map(row), brightest);
    Ok(Some(colors))
}

/// Whether every number is one that a file may have as well.
fn check(arrays: &SphereArrays, brightest: [f32; 3]) -> Result<(), Complaint> {
    for (column, array) in arrays.columns() {
        let allowed = allowed(column, brightest);
        let wide = f64::from(*allowed.start())..=f64::from(*allowed.end());
        let is_wrong = |row: &usize| !wide.contains(&array.get(*row));
        let wrong = (0..arrays.len()).into_par_iter().find_first(is_wrong);
        if let Some(row) = wrong {
            let help = (column == Column::Radius).then(|| "radii are positive".to_owned());
            return Err((
                format!(
                    "row {row} (the first is 0) has {} = {:?}; it must be from {} to {}",
                    column.name(),
                    array.get(row),
                    in_words(*allowed.start()),
                    in_words(*allowed.end()),
                ),
                help,
            ));
        }
    }
    Ok(())
}
