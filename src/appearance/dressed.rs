//! Particles with radii and colours: everything that a scene needs to know of them.

use crate::math::DVec3;
use crate::particles::{Cell, Positions};

use super::colors::{Colors, Legend};
use super::radii::Radii;

/// Particles as they look.
#[derive(Clone, Debug, PartialEq)]
pub struct Dressed {
    /// Centres of the visible particles.
    pub positions: Positions,
    /// Their radii.
    pub radii: Radii,
    /// Their colours.
    pub colors: Colors,
    /// Rows of the visible particles in the file, without periodic copies; `None` for all.
    pub rows: Option<Vec<u32>>,
    /// Number of spheres that are edges of the cell; they come last.
    pub edges: usize,
    /// Number of periodic copies, one behind the other in the arrays.
    pub copies: usize,
    /// Centres and radii of the particles that are hidden.
    pub hidden: Vec<(DVec3, f64)>,
    /// The cell with all copies.
    pub cell: Option<Cell>,
    /// What the colours mean.
    pub legend: Legend,
    /// The options that were chosen automatically: key and value.
    pub choices: Vec<(&'static str, String)>,
    /// The symbol of the unit of length.
    pub unit: Option<&'static str>,
    /// What the user should know.
    pub notes: Vec<String>,
    /// What is probably a mistake in the file: values that colours or radii need are missing.
    pub warnings: Vec<String>,
    /// Line of the first particle of the file, the first line being 1, if the particles are on
    /// consecutive lines.
    pub first_line: Option<u64>,
}

impl Dressed {
    /// Number of visible spheres.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Returns true if no particle is visible.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Number of visible particles with their copies, without edges of the cell.
    pub fn particle_count(&self) -> usize {
        self.len() - self.edges
    }
}
