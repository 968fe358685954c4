//! What is said of atoms whose element is unknown.

use rayon::prelude::*;

use crate::particles::Particles;

use super::elements::particle_elements;
use super::options::{ColorChoice, RadiusChoice};
use super::radii::UNKNOWN_ELEMENT_RADIUS;

/// Says where the first atom with an unknown element is, how many there are, and how they look, if
/// radii or colours follow from elements. `rows` are those of the file, unless all are there.
pub(super) fn note(
    particles: &Particles,
    rows: Option<&[u32]>,
    radius: &RadiusChoice,
    color: &ColorChoice,
) -> Option<String> {
    let has_radius = matches!(radius, RadiusChoice::Vdw | RadiusChoice::Covalent);
    let has_color = matches!(color, ColorChoice::Element);
    if !has_radius && !has_color {
        return None;
    }
    let elements = particle_elements(particles)?;
    let is_unknown = |row: &usize| elements.kinds[elements.kind(*row)].is_none();
    if elements.kinds.iter().all(Option::is_some) {
        return None;
    }
    let first = (0..particles.len()).into_par_iter().find_first(is_unknown)?;
    let count = (0..particles.len()).into_par_iter().filter(is_unknown).count();
    let path = particles.path.display();
    let row = rows.map_or(first as u64, |rows| u64::from(rows[first]));
    let place = match particles.first_line {
        Some(line) => format!("{path}:{}", line + row),
        None => format!("{path}: row {row}"),
    };
    let radius = format!("a radius of {UNKNOWN_ELEMENT_RADIUS} angstrom");
    let look = match (has_color, has_radius) {
        (true, true) => format!("grey, with {radius}"),
        (true, false) => "grey".to_owned(),
        _ => format!("drawn with {radius}"),
    };
    let label = elements.label(first);
    let others = match count - 1 {
        0 => String::new(),
        others => format!(", like {others} more"),
    };
    Some(format!(
        "{place}: unknown element `{label}`: it is {look}{others} (`radius` and `color` choose \
         otherwise)"
    ))
}
