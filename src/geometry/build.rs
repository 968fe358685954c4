//! Builds a [`SphereSet`] from the user's rows: chooses the origin, separates the giants, sorts the
//! rest along a Morton curve, and removes duplicates.
//!
//! Sorting takes 8 bytes per sphere for the keys, then 4 for the row of each id and 16 or 32 for
//! the reordered spheres: less than any BVH that is built afterwards, so this is never the peak.
//! Only two arrays are kept, the spheres and their rows.

use std::collections::HashSet;

use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::math::{DVec3, NO_SPHERE};

use super::morton::{SortableSpheres, morton_order};
use super::storage::{SphereStorage, bits, to_f32, to_f64};
use super::{Sphere, SphereRows, SphereSet, giants::Shells, origin};

/// The spheres during the build, by index.
struct Unsorted {
    spheres: SphereStorage,
    /// Number of spheres given in f32, whose indices precede those of the others.
    from_table: usize,
    origin: DVec3,
    /// Indices of the giants, ascending.
    giants: Vec<u32>,
}

/// A giant and its row.
type Giant = (u32, Sphere);

impl SphereSet {
    /// Builds the set: moves the origin, sorts and removes duplicates. Every sphere must be finite,
    /// with a positive radius, and within [`crate::math::MAX_COORDINATE`].
    ///
    /// # Errors
    /// If there are more spheres than ids.
    pub fn new(rows: SphereRows) -> Result<Self> {
        let unsorted = Unsorted::new(rows)?;
        let mut giants = unsorted.giants_by_row();
        let (mut indices, curve) = morton_order(&unsorted);
        indices.truncate(unsorted.len() - giants.len());
        let rows = indices.par_iter().map(|&index| unsorted.row_of(index));
        let mut rows: Vec<u32> = rows.collect();
        let Unsorted { spheres, origin, .. } = unsorted;
        let mut spheres = spheres.select(indices.par_iter().map(|&index| index as usize));
        drop(indices);
        let duplicates =
            remove_duplicates(&mut spheres, &mut rows) + remove_duplicate_giants(&mut giants);
        rows.extend(giants.iter().map(|(row, _)| *row));
        let giants: Vec<Sphere> = giants.into_iter().map(|(_, sphere)| sphere).collect();
        let is_exact_in_f32 = (0..spheres.len()).into_par_iter().all(|index| {
            let sphere = spheres.sphere(index).relative_to(origin);
            to_f64(&to_f32(&sphere)) == sphere
        });
        Ok(Self { origin, spheres, giants, rows, curve, duplicates, is_exact_in_f32 })
    }
}

impl Unsorted {
    fn new(rows: SphereRows) -> Result<Self> {
        let from_table = rows.table.len();
        let count = from_table + rows.exact.len();
        if count >= NO_SPHERE as usize {
            let message = format!("{count} spheres are more than the {NO_SPHERE} that fit");
            return Err(Error::input(message).with_help("split the scene, or thin the table out"));
        }
        let spheres = SphereStorage::new(rows);
        let origin = origin::choose_origin(&spheres);
        let mut unsorted = Self { spheres, from_table, origin, giants: Vec::new() };
        unsorted.giants = unsorted.find_giants();
        Ok(unsorted)
    }

    /// Returns the sphere relative to the origin.
    fn relative(&self, index: usize) -> Sphere {
        self.spheres.sphere(index).relative_to(self.origin)
    }

    /// Returns the row of an index: rows count the exact spheres first.
    fn row_of(&self, index: u32) -> u32 {
        match (index as usize).checked_sub(self.from_table) {
            Some(exact) => exact as u32,
            None => index + (self.len() - self.from_table) as u32,
        }
    }

    fn find_giants(&self) -> Vec<u32> {
        let shells = Shells::new(self.len(), |i| self.relative(i));
        let is_giant = |&index: &u32| shells.is_giant(&self.relative(index as usize));
        (0..self.len() as u32).into_par_iter().filter(is_giant).collect()
    }

    fn giants_by_row(&self) -> Vec<Giant> {
        let giant = |&index: &u32| (self.row_of(index), self.spheres.sphere(index as usize));
        let mut giants: Vec<Giant> = self.giants.iter().map(giant).collect();
        giants.sort_unstable_by_key(|(row, _)| *row);
        giants
    }
}

impl SortableSpheres for Unsorted {
    fn len(&self) -> usize {
        self.spheres.len()
    }

    fn rounded(&self, index: usize) -> [f32; 4] {
        to_f32(&self.relative(index))
    }

    fn rank(&self, index: usize) -> ([u64; 4], u32) {
        (bits(self.spheres.sphere(index)), self.row_of(index as u32))
    }

    fn is_last(&self, index: usize) -> bool {
        self.giants.binary_search(&(index as u32)).is_ok()
    }
}

/// Keeps the first of each run of equal spheres; returns the number removed.
fn remove_duplicates(spheres: &mut SphereStorage, rows: &mut Vec<u32>) -> usize {
    let count = spheres.len();
    let is_equal = |index: usize, earlier: usize| spheres.sphere(index) == spheres.sphere(earlier);
    let first = (1..count).into_par_iter().position_first(|index| is_equal(index, index - 1));
    let Some(first) = first.map(|position| position + 1) else { return 0 };
    let mut kept = first;
    for index in first + 1..count {
        if spheres.sphere(index) == spheres.sphere(kept - 1) {
            continue;
        }
        spheres.overwrite(kept, index);
        rows[kept] = rows[index];
        kept += 1;
    }
    spheres.truncate(kept);
    rows.truncate(kept);
    count - kept
}

/// Keeps the first row of equal giants; returns the number removed.
fn remove_duplicate_giants(giants: &mut Vec<Giant>) -> usize {
    let mut seen = HashSet::new();
    let before = giants.len();
    giants.retain(|(_, sphere)| seen.insert(bits(*sphere)));
    before - giants.len()
}
