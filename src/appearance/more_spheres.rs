//! Spheres besides the particles of a file: periodic copies, and the edges of the cell.

use crate::math::DVec3;
use crate::particles::{Cell, Positions};

use super::cell_edges::cell_edges;
use super::colors::Colors;
use super::dressed::Dressed;
use super::failure::AppearanceError;
use super::radii::Radii;

/// Colour of the edges of the cell: sRGB 90.
const EDGE: [f32; 3] = [0.102; 3];

/// Radius of the edges in diagonals of the cell.
const EDGE_RADIUS: f64 = 0.0018;

/// Appends the edges of the cell, as spheres.
///
/// # Errors
/// If the file, with this path, has no cell.
pub(super) fn draw_cell(dressed: &mut Dressed, path: &str) -> Result<(), AppearanceError> {
    let Some(Cell { origin, vectors, .. }) = dressed.cell else {
        return Err(AppearanceError::new("cell", format!("`{path}` has no cell")));
    };
    let [a, b, c] = vectors;
    let radius = EDGE_RADIUS * (a + b + c).length();
    let edges = cell_edges(origin, vectors, radius);
    let (count, added) = (dressed.len(), edges.len());
    dressed.edges = added;
    match &mut dressed.radii {
        Radii::Constant(all) => {
            let mut radii = vec![*all; count];
            radii.resize(count + added, radius);
            dressed.radii = Radii::F64(radii);
        }
        Radii::F32(radii) => radii.resize(count + added, radius as f32),
        Radii::F64(radii) => radii.resize(count + added, radius),
    }
    match &mut dressed.colors {
        Colors::Constant(all) => {
            let mut colors = vec![all.to_array(); count];
            colors.resize(count + added, EDGE);
            dressed.colors = Colors::Each(colors);
        }
        Colors::Each(colors) => colors.resize(count + added, EDGE),
    }
    match &mut dressed.positions {
        Positions::F32(centers) => {
            centers.extend(edges.iter().map(|edge| edge.to_array().map(|x| x as f32)));
        }
        Positions::F64(centers) => centers.extend(edges.iter().map(|edge| edge.to_array())),
    }
    Ok(())
}

/// Appends the periodic copies; the first shift is 0.
pub(super) fn repeat(dressed: &mut Dressed, shifts: &[DVec3]) {
    let count = dressed.len();
    for shift in &shifts[1..] {
        match &mut dressed.positions {
            Positions::F32(centers) => {
                centers.extend_from_within(..count);
                let first = centers.len() - count;
                for center in &mut centers[first..] {
                    let moved = DVec3::from_array(center.map(f64::from)) + *shift;
                    *center = moved.to_array().map(|x| x as f32);
                }
            }
            Positions::F64(centers) => {
                centers.extend_from_within(..count);
                let first = centers.len() - count;
                for center in &mut centers[first..] {
                    *center = (DVec3::from_array(*center) + *shift).to_array();
                }
            }
        }
        match &mut dressed.radii {
            Radii::Constant(_) => {}
            Radii::F32(values) => values.extend_from_within(..count),
            Radii::F64(values) => values.extend_from_within(..count),
        }
        if let Colors::Each(colors) = &mut dressed.colors {
            colors.extend_from_within(..count);
        }
    }
    let hidden = dressed.hidden.clone();
    for shift in &shifts[1..] {
        dressed.hidden.extend(hidden.iter().map(|(center, radius)| (*center + *shift, *radius)));
    }
}
