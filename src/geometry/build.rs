//! Builds a [`SphereSet`] from the user's rows: chooses the origin, separates the giants, rounds
//! and sorts the rest along a Morton curve, and removes duplicates.
//!
//! Sorting takes 8 bytes per sphere for the keys, then 4 for the row of each id and 16 for the
//! reordered spheres: less than any tree that is built afterwards, so this is never the peak. Only
//! two arrays are kept, the spheres and their rows.

use std::collections::HashSet;

use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::math::{DVec3, NO_SPHERE};

use super::set::to_f64;
use super::{Sphere, SphereRows, SphereSet, giants::Shells, morton, morton::MortonCurve, origin};

/// Relative displacement by rounding, as a fraction of the radius, above which a sphere is
/// reported.
const MAX_RELATIVE_DISPLACEMENT: f64 = 0.01;

/// The spheres during the build. Index `i` is a row of the table or, past its end, an exact sphere.
struct Unsorted {
    exact: Vec<Sphere>,
    table: Vec<[f32; 4]>,
    from_table: usize,
    origin: DVec3,
}

/// A giant, by its index or row.
type Giant = (u32, Sphere);

impl SphereSet {
    /// Builds the set: moves the origin, rounds, sorts and removes duplicates. Every sphere must be
    /// finite, with a positive radius, and within [`crate::math::MAX_COORDINATE`].
    ///
    /// # Errors
    /// If there are more spheres than ids.
    pub fn new(rows: SphereRows) -> Result<Self> {
        let mut unsorted = Unsorted::new(rows)?;
        let mut giants = unsorted.find_giants();
        let coarse = unsorted.round_except(&giants);
        let (mut rows, mut duplicates, curve) = unsorted.sort_except(&giants);

        giants.iter_mut().for_each(|(index, _)| *index = unsorted.row_of(*index));
        giants.sort_unstable_by_key(|(row, _)| *row);
        duplicates += remove_duplicate_giants(&mut giants);
        rows.extend(giants.iter().map(|(row, _)| *row));
        let giants = giants.into_iter().map(|(_, sphere)| sphere).collect();
        let Unsorted { table: particles, origin, .. } = unsorted;
        Ok(Self { origin, particles, giants, rows, curve, duplicates, displaced: coarse })
    }
}

impl Unsorted {
    fn new(SphereRows { exact, mut table }: SphereRows) -> Result<Self> {
        let from_table = table.len();
        let count = from_table + exact.len();
        if count >= NO_SPHERE as usize {
            let message = format!("{count} spheres are more than the {NO_SPHERE} that fit");
            return Err(Error::input(message).with_help("split the scene, or thin the table out"));
        }
        table.reserve_exact(exact.len());
        table.extend(exact.iter().map(to_f32));
        let origin = origin::choose_origin(&table);
        Ok(Self { exact, table, from_table, origin })
    }

    /// Returns the sphere as given, relative to the origin; valid only before rounding.
    fn original(&self, index: usize) -> Sphere {
        relative_to_origin(self.origin, &self.exact, self.from_table, index, &self.table[index])
    }

    fn row_of(&self, index: u32) -> u32 {
        match (index as usize).checked_sub(self.from_table) {
            Some(exact) => exact as u32,
            None => index + self.exact.len() as u32,
        }
    }

    /// Returns the index of a row.
    fn index_of(&self, row: u32) -> usize {
        match (row as usize).checked_sub(self.exact.len()) {
            Some(in_table) => in_table,
            None => self.from_table + row as usize,
        }
    }

    /// Finds the giants; returns them in the order of their indices.
    fn find_giants(&self) -> Vec<Giant> {
        let shells = Shells::new(self.table.len(), |i| self.original(i));
        let giant = |index: u32| {
            let sphere = self.original(index as usize);
            shells.is_giant(&sphere).then_some((index, sphere))
        };
        (0..self.table.len() as u32).into_par_iter().filter_map(giant).collect()
    }

    /// Translates and rounds every sphere; returns how many, not counting giants, moved by more
    /// than [`MAX_RELATIVE_DISPLACEMENT`].
    fn round_except(&mut self, giants: &[Giant]) -> usize {
        let Self { exact, table, from_table, origin } = self;
        let round = |(index, slot): (usize, &mut [f32; 4])| {
            let given = relative_to_origin(*origin, exact, *from_table, index, slot);
            *slot = to_f32(&given);
            let is_giant = || contains_index(giants, index as u32);
            usize::from(
                displacement(&given, slot) > MAX_RELATIVE_DISPLACEMENT * given.radius
                    && !is_giant(),
            )
        };
        table.par_iter_mut().enumerate().map(round).sum()
    }

    /// Sorts the spheres, without giants and duplicates; returns their rows, the number of
    /// duplicates, and the curve.
    fn sort_except(&mut self, giants: &[Giant]) -> (Vec<u32>, usize, MortonCurve) {
        let (mut rows, curve) = morton::morton_order(
            &self.table,
            |i| self.row_of(i),
            |index| contains_index(giants, index),
        );
        rows.truncate(self.table.len() - giants.len());
        // Out of place, because in-place cycles incur one cache miss after another on one thread.
        self.table = rows.par_iter().map(|&row| self.table[self.index_of(row)]).collect();
        let repeated = remove_duplicates(&mut self.table, &mut rows);
        (rows, repeated, curve)
    }
}

fn contains_index(giants: &[Giant], index: u32) -> bool {
    giants.binary_search_by_key(&index, |(giant, _)| *giant).is_ok()
}

fn relative_to_origin(
    origin: DVec3,
    exact: &[Sphere],
    from_table: usize,
    index: usize,
    slot: &[f32; 4],
) -> Sphere {
    let given = index.checked_sub(from_table).map_or_else(|| to_f64(slot), |i| exact[i]);
    Sphere { center: given.center - origin, ..given }
}

fn to_f32(sphere: &Sphere) -> [f32; 4] {
    let [x, y, z] = sphere.center.as_vec3().to_array();
    // Adding 0 turns -0 into 0, so that equal spheres have equal bits.
    [x + 0.0, y + 0.0, z + 0.0, sphere.radius as f32]
}

/// Returns how far rounding moved the surface.
fn displacement(exact: &Sphere, stored: &[f32; 4]) -> f64 {
    let stored = to_f64(stored);
    stored.center.distance(exact.center) + (stored.radius - exact.radius).abs()
}

/// Keeps the first of each run of equal spheres; returns the number removed.
fn remove_duplicates(table: &mut Vec<[f32; 4]>, rows: &mut Vec<u32>) -> usize {
    let are_equal = |a: &[f32; 4], b: &[f32; 4]| a.map(f32::to_bits) == b.map(f32::to_bits);
    let Some(first) = table.par_windows(2).position_first(|pair| are_equal(&pair[0], &pair[1]))
    else {
        return 0;
    };
    let mut kept = first + 1;
    for i in first + 1..table.len() {
        if are_equal(&table[i], &table[kept - 1]) {
            continue;
        }
        table[kept] = table[i];
        rows[kept] = rows[i];
        kept += 1;
    }
    let gone = table.len() - kept;
    table.truncate(kept);
    rows.truncate(kept);
    gone
}

/// Keeps the first row of equal giants; returns the number removed.
fn remove_duplicate_giants(giants: &mut Vec<Giant>) -> usize {
    let mut seen = HashSet::new();
    let before = giants.len();
    giants.retain(|(_, sphere)| {
        let [x, y, z] = sphere.center.to_array();
        seen.insert([x, y, z, sphere.radius].map(|v| (v + 0.0).to_bits()))
    });
    before - giants.len()
}
