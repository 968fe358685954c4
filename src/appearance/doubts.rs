//! Values that colours and radii need and that are missing: which particles they are, in words.

use std::path::Path;

use rayon::prelude::*;

use crate::particles::{LengthUnit, Particles};

use super::elements::ParticleElements;
use super::radii::UNKNOWN_ELEMENT_RADIUS;

/// Most labels that a message names.
const MAX_LABELS: usize = 3;

/// Rows without a value: the first of them, and how many there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Missing {
    first: usize,
    count: usize,
}

impl Missing {
    /// Finds the rows for which `is_missing` is true; `None` if there are none.
    pub(super) fn find(rows: usize, is_missing: impl Fn(usize) -> bool + Sync) -> Option<Self> {
        let nothing = || (usize::MAX, 0);
        let join = |(a, m): (usize, usize), (b, n): (usize, usize)| (a.min(b), m + n);
        let rows = (0..rows).into_par_iter().filter(|row| is_missing(*row));
        let (first, count) =
            rows.fold(nothing, |all, row| join(all, (row, 1))).reduce(nothing, join);
        (count > 0).then_some(Self { first, count })
    }
}

/// Where particles are in their file.
pub(super) struct Places<'a> {
    pub(super) path: &'a Path,
    /// Line of the first particle of the file.
    pub(super) first_line: Option<u64>,
    /// Rows of the particles in the file; `None` for all.
    pub(super) rows: Option<&'a [u32]>,
    /// Number of particles.
    pub(super) count: usize,
}

impl Places<'_> {
    /// Says that the value called `what` of some particles is `flaw`, and what becomes of them.
    pub(super) fn missing(&self, missing: Missing, what: &str, flaw: &str, fate: &str) -> String {
        let (place, many) = (self.of(missing.first), self.many(missing));
        format!("{place}: {what} is {flaw}{many}: {fate}")
    }

    /// Says which labels name no element; `None` if all do. `is_colored` and `is_sized` are true if
    /// elements give colours and radii.
    pub(super) fn unknown_elements(
        &self,
        particles: &Particles,
        elements: &ParticleElements<'_>,
        [is_colored, is_sized]: [bool; 2],
    ) -> Option<String> {
        if elements.kinds.iter().all(Option::is_some) {
            return None;
        }
        let is_unknown = |row: usize| elements.kinds[elements.kind(row)].is_none();
        let missing = Missing::find(self.count, is_unknown)?;
        let mut labels: Vec<String> = Vec::new();
        for row in (missing.first..self.count).filter(|row| is_unknown(*row)) {
            let label = format!("`{}`", elements.label(row));
            if !labels.contains(&label) {
                labels.push(label);
            }
            if labels.len() == MAX_LABELS {
                break;
            }
        }
        let radius = match particles.unit {
            Some(LengthUnit::Nanometre) => format!("{} nm", 0.1 * UNKNOWN_ELEMENT_RADIUS),
            _ => format!("{UNKNOWN_ELEMENT_RADIUS} Å"),
        };
        let fates = [
            is_colored.then(|| "grey".to_owned()),
            is_sized.then(|| format!("drawn with a radius of {radius}")),
        ];
        let fates: Vec<String> = fates.into_iter().flatten().collect();
        let (place, many) = (self.of(missing.first), self.many(missing));
        let (labels, fates) = (labels.join(" or "), fates.join(" and "));
        let who = if missing.count == 1 { "it is" } else { "they are" };
        Some(format!("{place}: no element is called {labels}{many}: {who} {fates}"))
    }

    /// How many particles are concerned, if it is more than one.
    fn many(&self, missing: Missing) -> String {
        match missing.count {
            1 => String::new(),
            count => format!(", like {count} of {} particles", self.count),
        }
    }

    /// The file with the line of a particle, or with its row.
    fn of(&self, row: usize) -> String {
        let row = self.rows.map_or(row as u64, |rows| u64::from(rows[row]));
        let path = self.path.display();
        match self.first_line {
            Some(first) => format!("{path}:{}", first + row),
            None => format!("{path}, row {row} (the first is 0)"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_and_the_number_of_missing_values_are_found() {
        assert_eq!(Missing::find(1000, |_| false), None);
        let found = Missing::find(1000, |row| row % 100 == 7);
        assert_eq!(found, Some(Missing { first: 7, count: 10 }));
    }

    #[test]
    fn places_are_lines_or_rows_of_the_file() {
        let path = Path::new("a.csv");
        let all = Places { path, first_line: Some(2), rows: None, count: 9 };
        assert_eq!(all.of(3), "a.csv:5");
        let selected = Places { rows: Some(&[4, 6, 8]), ..all };
        assert_eq!(selected.of(1), "a.csv:8");
        let binary = Places { first_line: None, ..selected };
        assert_eq!(binary.of(2), "a.csv, row 8 (the first is 0)");
        let one = Missing { first: 0, count: 1 };
        let text = binary.missing(one, "`mass`", "no number", "the particle is grey");
        assert_eq!(
            text,
            "a.csv, row 4 (the first is 0): `mass` is no number: the particle is grey"
        );
    }
}
