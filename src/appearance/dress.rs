//! Gives particles radii and colours.

use crate::particles::{Cell, Particles};

use super::arrange::{copies, move_particles};
use super::colors::{Coloring, Colors, UnknownColors, colors};
use super::doubts::Places;
use super::dressed::Dressed;
use super::elements::particle_elements;
use super::expression::Expression;
use super::failure::AppearanceError;
use super::keep_rows::{keep_rows, retain};
use super::more_spheres::{draw_cell, repeat};
use super::options::{Appearance, ColorChoice, RadiusChoice};
use super::particle_columns::ParticleColumns;
use super::radii::{Radii, radii};
use super::value_range::{RangeChoice, RangeEnd};

/// Gives particles radii and colours.
///
/// # Errors
/// If an option is wrong for these particles.
pub fn dress(mut particles: Particles, options: &Appearance) -> Result<Dressed, AppearanceError> {
    let path = particles.path.display().to_string();
    move_particles(&mut particles, options)?;
    let mut rows = None;
    if let Some(text) = &options.select {
        let chosen = condition(&particles, "select", text)?;
        rows = Some(keep_rows(&mut particles, &chosen));
        if particles.is_empty() {
            return Err(AppearanceError::new("select", "no particle fulfils the condition"));
        }
    }
    let (mut radii, radius) = radii(&particles, options)?;
    let mut coloring = colors(&particles, options)?;
    let warnings = warnings(&particles, rows.as_deref(), &radius, &coloring);
    let mut hidden = Vec::new();
    if let Some(text) = &options.slice {
        let cut = condition(&particles, "slice", text)?;
        let visible: Vec<bool> = cut.iter().map(|cut| !cut).collect();
        if !visible.contains(&true) {
            return Err(AppearanceError::new("slice", "all particles are hidden"));
        }
        let rows_of_cut = (0..cut.len()).filter(|row| cut[*row]);
        hidden = rows_of_cut.map(|row| (particles.positions.get(row), radii.get(row))).collect();
        match &mut radii {
            Radii::Constant(_) => {}
            Radii::F32(values) => retain(values, &visible),
            Radii::F64(values) => retain(values, &visible),
        }
        if let Colors::Each(colors) = &mut coloring.colors {
            retain(colors, &visible);
        }
        particles.columns.clear();
        let kept = keep_rows(&mut particles, &visible);
        rows = Some(match rows {
            None => kept,
            Some(rows) => kept.iter().map(|row| rows[*row as usize]).collect(),
        });
    }
    let shifts = copies(&particles, options)?;
    let [i, j, k] = options.replicate;
    let cell = particles.cell.map(|cell| {
        let [a, b, c] = cell.vectors;
        Cell { vectors: [a * f64::from(i), b * f64::from(j), c * f64::from(k)], ..cell }
    });
    let mut choices = Vec::new();
    if options.radius != radius {
        choices.push(("radius", radius.to_string()));
    }
    if options.color != coloring.choice {
        choices.push(("color", coloring.choice.to_string()));
    }
    if let Some(range) = coloring.range.filter(|range| *range != options.range) {
        choices.push(("range", range_text(&range)));
    }
    let mut dressed = Dressed {
        positions: particles.positions,
        radii,
        colors: coloring.colors,
        rows,
        edges: 0,
        copies: shifts.len(),
        hidden,
        cell,
        legend: coloring.legend,
        choices,
        unit: particles.unit.map(|unit| unit.symbol()),
        notes: particles.notes,
        warnings,
        first_line: particles.first_line,
    };
    repeat(&mut dressed, &shifts);
    if options.cell {
        draw_cell(&mut dressed, &path)?;
    }
    Ok(dressed)
}

/// Tells of values that are missing. `rows` are those of the particles in the file.
fn warnings(
    particles: &Particles,
    rows: Option<&[u32]>,
    radius: &RadiusChoice,
    coloring: &Coloring,
) -> Vec<String> {
    let (path, count) = (&*particles.path, particles.len());
    let places = Places { path, first_line: particles.first_line, rows, count };
    let is_colored = coloring.choice == ColorChoice::Element;
    let is_sized = matches!(radius, RadiusChoice::Vdw | RadiusChoice::Covalent);
    let elements = (is_colored || is_sized).then(|| particle_elements(particles)).flatten();
    let of_elements = elements
        .and_then(|found| places.unknown_elements(particles, &found, [is_colored, is_sized]));
    let of_colors = coloring.unknown.as_ref().map(|UnknownColors { missing, what, flaw }| {
        places.missing(*missing, what, flaw, "drawn in grey")
    });
    of_elements.into_iter().chain(of_colors).collect()
}

/// A range as an option.
pub fn range_text(range: &RangeChoice) -> String {
    let end = |end: RangeEnd| match end {
        RangeEnd::Number(number) => number.to_string(),
        RangeEnd::Percentile(percent) => format!("p{percent}"),
    };
    format!("{},{}", end(range.low), end(range.high))
}

fn condition(
    particles: &Particles,
    key: &'static str,
    text: &str,
) -> Result<Vec<bool>, AppearanceError> {
    let failed = |error| AppearanceError::of_expression(key, error);
    let expression = Expression::parse(text).map_err(failed)?;
    expression.select(&ParticleColumns(particles), particles.len()).map_err(failed)
}

#[cfg(test)]
mod tests;
