//! Moves particles within their periodic cell, and repeats the cell.

use rayon::prelude::*;

use crate::math::DVec3;
use crate::particles::{Cell, Column, Particles, Positions};

use super::failure::AppearanceError;
use super::options::Appearance;

/// Names of the image flags of LAMMPS.
const IMAGE_FLAGS: [&str; 3] = ["ix", "iy", "iz"];

/// Moves the particles as the options say: unwraps, centres, wraps.
///
/// # Errors
/// If an option needs a cell or image flags that the file lacks.
pub(super) fn move_particles(
    particles: &mut Particles,
    options: &Appearance,
) -> Result<(), AppearanceError> {
    if options.unwrap {
        unwrap(particles)?;
    }
    if options.center {
        center(particles);
    }
    if options.wrap {
        let cell = demand_cell(particles, "wrap")?;
        change(&mut particles.positions, |_, point| wrapped(&cell, point));
    }
    Ok(())
}

fn demand_cell(particles: &Particles, key: &'static str) -> Result<Cell, AppearanceError> {
    let usable = particles.cell.filter(|cell| cell.volume().abs() > 0.0);
    usable.ok_or_else(|| {
        AppearanceError::new(key, format!("`{}` has no cell", particles.path.display()))
            .with_help("remove the key, or use a file with a cell".to_owned())
    })
}

fn unwrap(particles: &mut Particles) -> Result<(), AppearanceError> {
    let cell = demand_cell(particles, "unwrap")?;
    let flags: Vec<Column> =
        IMAGE_FLAGS.iter().filter_map(|name| particles.column(name).cloned()).collect();
    let [x, y, z] = &flags[..] else {
        let path = particles.path.display();
        let message = format!("`{path}` lacks the image flags ix, iy and iz");
        return Err(AppearanceError::new("unwrap", message));
    };
    let [a, b, c] = cell.vectors;
    change(&mut particles.positions, |row, point| {
        point + a * x.number(row) + b * y.number(row) + c * z.number(row)
    });
    Ok(())
}

/// Moves the middle of the particles to the middle of the cell or, without one, to the origin.
/// Along periodic edges the middle is the circular mean, so that a cluster across the boundary
/// becomes whole when it is wrapped.
fn center(particles: &mut Particles) {
    let count = particles.len().max(1) as f64;
    let positions = &particles.positions;
    let shift = match particles.cell.filter(|cell| cell.volume().abs() > 0.0) {
        None => {
            let sum: DVec3 = (0..positions.len()).map(|row| positions.get(row)).sum();
            -sum / count
        }
        Some(cell) => {
            let mut sums = [[0.0; 3]; 3];
            for row in 0..positions.len() {
                for (sum, x) in sums.iter_mut().zip(cell.fractions(positions.get(row))) {
                    let (sin, cos) = libm::sincos(std::f64::consts::TAU * x);
                    *sum = [sum[0] + sin, sum[1] + cos, sum[2] + x];
                }
            }
            let [a, b, c] = std::array::from_fn(|edge| {
                let [sin, cos, sum] = sums[edge];
                match cell.periodic[edge] {
                    true => libm::atan2(sin, cos) / std::f64::consts::TAU,
                    false => sum / count,
                }
            });
            cell.point([0.5; 3]) - cell.point([a, b, c])
        }
    };
    change(&mut particles.positions, |_, point| point + shift);
}

/// The image of a point in the cell, along its periodic edges.
fn wrapped(cell: &Cell, point: DVec3) -> DVec3 {
    let fractions = cell.fractions(point);
    let [a, b, c] = std::array::from_fn(|edge| match cell.periodic[edge] {
        true => fractions[edge].floor(),
        false => 0.0,
    });
    let [u, v, w] = cell.vectors;
    point - u * a - v * b - w * c
}

fn change(positions: &mut Positions, new: impl Fn(usize, DVec3) -> DVec3 + Sync) {
    match positions {
        Positions::F32(centers) => centers.par_iter_mut().enumerate().for_each(|(row, at)| {
            let point = DVec3::from_array(at.map(f64::from));
            *at = new(row, point).to_array().map(|x| x as f32);
        }),
        Positions::F64(centers) => centers.par_iter_mut().enumerate().for_each(|(row, at)| {
            *at = new(row, DVec3::from_array(*at)).to_array();
        }),
    }
}

/// The shifts of all copies of the cell; the first is 0.
///
/// # Errors
/// If there are to be copies and the file has no cell.
pub(super) fn copies(
    particles: &Particles,
    options: &Appearance,
) -> Result<Vec<DVec3>, AppearanceError> {
    let [i, j, k] = options.replicate;
    if options.replicate == [1; 3] {
        return Ok(vec![DVec3::ZERO]);
    }
    let [a, b, c] = demand_cell(particles, "replicate")?.vectors;
    let along = |edge: DVec3, count: u32| (0..count).map(move |n| edge * f64::from(n));
    let plane = |from: DVec3| along(b, j).map(move |shift| from + shift);
    let line = |from: DVec3| along(c, k).map(move |shift| from + shift);
    Ok(along(a, i).flat_map(plane).flat_map(line).collect())
}
