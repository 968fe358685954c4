//! Checks the radii of the particles of a file.

use rayon::prelude::*;

use crate::appearance::{AppearanceError, Dressed, Radii};
use crate::math::DVec3;

use super::column_limits::ColumnLimits;
use super::columns::Column;
use super::particle_file::ParticleTable;

/// Refuses radii that no sphere may have.
///
/// # Errors
/// Says where in the file the first one is, and which option chose it.
pub(super) fn check_radii(
    particles: &ParticleTable,
    dressed: &Dressed,
) -> Result<(), AppearanceError> {
    let limits = ColumnLimits::new(Column::Radius, DVec3::ZERO, [0.0; 3]);
    // A constant is checked where it stands in the scene.
    let is_constant = matches!(dressed.radii, Radii::Constant(_));
    let count = if is_constant { 0 } else { dressed.particle_count() / dressed.copies };
    let is_wrong = |row: &usize| !limits.allow(dressed.radii.get(*row));
    let Some(row) = (0..count).into_par_iter().find_first(is_wrong) else { return Ok(()) };
    let radius = dressed.radii.get(row);
    let row = dressed.rows.as_ref().map_or(row as u64, |rows| u64::from(rows[row]));
    let path = particles.path.display();
    let place = match dressed.first_line {
        Some(first) => format!("{path}:{}", first + row),
        None => path.to_string(),
    };
    let automatic = dressed.choices.iter().find(|(key, _)| *key == "radius");
    let given = || particles.appearance.radius.to_string();
    let choice = automatic.map_or_else(given, |(_, choice)| choice.clone());
    let message = format!(
        "{place}: the radius `{choice}` of row {row} (the first is 0) is {radius}{}",
        limits.describe(radius)
    );
    let help = format!("choose another radius, or leave such particles out: {choice} > 0");
    Err(AppearanceError { key: "radius", message, span: None, help: Some(help) })
}
