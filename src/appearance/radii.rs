//! The radii of particles.

use rayon::prelude::*;

use crate::particles::{ColumnData, Format, LengthUnit, Particles, Role};
use crate::task::pages::collect;

use super::element::Element;
use super::elements::particle_elements;
use super::expression::Expression;
use super::failure::AppearanceError;
use super::options::{Appearance, RadiusChoice};
use super::particle_columns::ParticleColumns;
use super::spacing::median_spacing;

/// Radii of all particles.
#[derive(Clone, Debug, PartialEq)]
pub enum Radii {
    /// One for all.
    Constant(f64),
    /// One for each, in f32.
    F32(Vec<f32>),
    /// One for each, in f64.
    F64(Vec<f64>),
}

impl Radii {
    /// The radius of a particle.
    #[inline]
    pub fn get(&self, row: usize) -> f64 {
        match self {
            Self::Constant(radius) => *radius,
            Self::F32(radii) => f64::from(radii[row]),
            Self::F64(radii) => radii[row],
        }
    }
}

/// The radii that the options choose, and the choice with everything automatic resolved.
///
/// # Errors
/// If a column or the elements are missing, or no radius can be found.
pub(super) fn radii(
    particles: &Particles,
    options: &Appearance,
) -> Result<(Radii, RadiusChoice), AppearanceError> {
    let choice = resolve(particles, &options.radius);
    let scale = options.radius_scale;
    let (radii, choice) = match &choice {
        RadiusChoice::Auto | RadiusChoice::Spacing => {
            let radius = from_spacing(particles)?;
            (Radii::Constant(radius * scale), RadiusChoice::Number(radius))
        }
        RadiusChoice::Number(radius) => (Radii::Constant(radius * scale), choice),
        RadiusChoice::Vdw => {
            (of_elements(particles, scale, Element::vdw_radius_or_default)?, choice)
        }
        RadiusChoice::Covalent => {
            (of_elements(particles, scale, |element| element.covalent_radius)?, choice)
        }
        RadiusChoice::Expression(text) => (of_expression(particles, text, scale)?, choice),
    };
    Ok((radii, choice))
}

/// Resolves `auto`: the radii or diameters of the file, then those of its elements.
fn resolve(particles: &Particles, choice: &RadiusChoice) -> RadiusChoice {
    if *choice != RadiusChoice::Auto {
        return choice.clone();
    }
    if let Some(radius) = particles.role(Role::Radius) {
        return RadiusChoice::Expression(quoted(&radius.name));
    }
    if let Some(diameter) = particles.role(Role::Diameter) {
        return RadiusChoice::Expression(format!("{} / 2", quoted(&diameter.name)));
    }
    if particle_elements(particles).is_none() {
        return RadiusChoice::Spacing;
    }
    match particles.format {
        // Biomolecules are shown filling space.
        Format::Pdb | Format::Mmcif | Format::Gro | Format::Xtc => RadiusChoice::Vdw,
        _ => RadiusChoice::Covalent,
    }
}

/// A column name as an expression names it.
pub(super) fn quoted(name: &str) -> String {
    let is_word = Expression::parse(name).is_ok_and(|e| e.columns() == [name]);
    if is_word { name.to_owned() } else { format!("`{name}`") }
}

fn from_spacing(particles: &Particles) -> Result<f64, AppearanceError> {
    let spacing = median_spacing(particles.len(), |row| particles.positions.get(row));
    match (spacing, particles.len()) {
        // Three digits are enough for a look, and easy to type.
        (Some(spacing), _) => Ok(three_digits(0.5 * spacing)),
        (None, 1) => Ok(1.0),
        _ => {
            let message = "the particles coincide, so their distances suggest no radius";
            Err(AppearanceError::new("radius", message).with_help("give a number".to_owned()))
        }
    }
}

fn three_digits(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

fn of_elements(
    particles: &Particles,
    scale: f64,
    radius: impl Fn(&Element) -> f64,
) -> Result<Radii, AppearanceError> {
    let Some(elements) = particle_elements(particles) else {
        let message = format!("`{}` names no elements", particles.path.display());
        let help = "use auto, a number or a column".to_owned();
        return Err(AppearanceError::new("radius", message).with_help(help));
    };
    let unit = match particles.unit {
        Some(LengthUnit::Nanometre) => 0.1,
        Some(LengthUnit::Angstrom) | None => 1.0,
    };
    let known: Vec<f64> = elements
        .kinds
        .iter()
        .map(|kind| scale * unit * kind.map_or(UNKNOWN_ELEMENT_RADIUS, &radius))
        .collect();
    if let [only] = known[..] {
        return Ok(Radii::Constant(only));
    }
    let rows = (0..particles.len()).into_par_iter();
    Ok(Radii::F32(collect(rows.map(|row| known[elements.kind(row)] as f32))))
}

/// Radius of atoms without a known element, such as dummies, in angstrom.
pub(super) const UNKNOWN_ELEMENT_RADIUS: f64 = 0.8;

fn of_expression(particles: &Particles, text: &str, scale: f64) -> Result<Radii, AppearanceError> {
    // A column in f32 stays one.
    if let (Some(column), true) = (particles.column(text), scale == 1.0) {
        if let ColumnData::F32(values) = &column.data {
            return Ok(Radii::F32(values.clone()));
        }
    }
    let failed = |error| AppearanceError::of_expression("radius", error);
    let name = quoted(text);
    let text = if particles.column(text).is_some() { &*name } else { text };
    let expression = Expression::parse(text).map_err(failed)?;
    let mut values =
        expression.values(&ParticleColumns(particles), particles.len()).map_err(failed)?;
    values.par_iter_mut().for_each(|value| *value *= scale);
    Ok(Radii::F64(values))
}
