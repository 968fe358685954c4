//! Questions about particles that are no scene yet: which rows fulfil a condition, and what an
//! expression is for each.

use std::borrow::Cow;

use crate::particles::Particles;

use super::arrange::move_particles;
use super::expression::Expression;
use super::failure::AppearanceError;
use super::options::Appearance;
use super::particle_columns::ParticleColumns;

/// Rows, from 0, of the particles that `options.select` keeps once they have moved as `unwrap`,
/// `center` and `wrap` say; all rows if there is no condition.
///
/// # Errors
/// If the condition is wrong for these particles.
pub fn selected_rows(
    particles: &Particles,
    options: &Appearance,
) -> Result<Vec<u32>, AppearanceError> {
    let Some(text) = &options.select else { return Ok((0..particles.len() as u32).collect()) };
    let mut particles = Cow::Borrowed(particles);
    if options.unwrap || options.center || options.wrap {
        move_particles(particles.to_mut(), options)?;
    }
    let failed = |error| AppearanceError::of_expression("select", error);
    let condition = Expression::parse(text).map_err(failed)?;
    let chosen = condition.select(&ParticleColumns(&particles), particles.len());
    let chosen = chosen.map_err(failed)?;
    Ok((0..chosen.len() as u32).filter(|row| chosen[*row as usize]).collect())
}

/// The number that an expression, such as the name of a column, has for each particle. `key` names
/// the option that the expression belongs to.
///
/// # Errors
/// If a column is missing, or the expression is no number.
pub fn numbers_of(
    particles: &Particles,
    key: &'static str,
    text: &str,
) -> Result<Vec<f64>, AppearanceError> {
    let failed = |error| AppearanceError::of_expression(key, error);
    let expression = Expression::parse(text).map_err(failed)?;
    expression.values(&ParticleColumns(particles), particles.len()).map_err(failed)
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::math::DVec3;
    use crate::particles::{Cell, Column, ColumnData, Format, Positions};

    fn three() -> Particles {
        let e = Column { name: "e".to_owned(), data: ColumnData::I32(vec![5, 6, 7]) };
        Particles {
            path: PathBuf::from("a"),
            format: Format::Npy,
            positions: Positions::F64(vec![[0.5, 0.0, 0.0], [3.5, 0.0, 0.0], [1.5, 0.0, 0.0]]),
            columns: vec![e],
            cell: Some(Cell {
                origin: DVec3::ZERO,
                vectors: [DVec3::X * 3.0, DVec3::Y, DVec3::Z],
                periodic: [true; 3],
            }),
            frame: 0,
            time: None,
            title: None,
            unit: None,
            first_line: None,
            notes: Vec::new(),
        }
    }

    #[test]
    fn rows_are_those_of_the_particles_where_they_move_to() {
        let select = |text: &str| Some(text.to_owned());
        let all = Appearance::default();
        assert_eq!(selected_rows(&three(), &all).unwrap(), [0, 1, 2]);
        let right = Appearance { select: select("x > 1 && e > 5"), ..Appearance::default() };
        assert_eq!(selected_rows(&three(), &right).unwrap(), [1, 2]);
        let wrapped = Appearance { wrap: true, ..right };
        assert_eq!(selected_rows(&three(), &wrapped).unwrap(), [2]);
        let wrong = Appearance { select: select("ee > 5"), ..Appearance::default() };
        assert!(selected_rows(&three(), &wrong).unwrap_err().message.contains("ee"));
    }

    #[test]
    fn numbers_follow_from_columns_and_coordinates() {
        assert_eq!(numbers_of(&three(), "radius", "e + 2 * x").unwrap(), [6.0, 13.0, 10.0]);
        let error = numbers_of(&three(), "radius", "size").unwrap_err();
        assert_eq!((error.key, error.message.contains("size")), ("radius", true));
    }
}
