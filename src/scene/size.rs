//! The size of a scene, known before its tables are read.

use crate::error::Result;

use super::description::{ColorStorage, SceneDescription};
use super::import::ImportPlan;

/// Numbers that decide how much memory a scene takes, known before its tables are read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SceneSize {
    /// All spheres, including duplicates.
    pub spheres: u64,
    /// Spheres that are listed one by one, outside tables.
    pub listed_spheres: u64,
    /// Spheres that are stored in f64: the listed ones and those of f64 tables.
    pub f64_spheres: u64,
    /// Emissive spheres, if every row with its own emission shines.
    pub emitters: u64,
    /// Spheres of tables with an emission for each row.
    pub emissive_rows: u64,
    /// Spheres of tables with a colour for each row.
    pub colors: u64,
    /// Bytes that these colours take.
    pub color_bytes: u64,
    /// Pixels of the environment map.
    pub environment_pixels: u64,
    /// True if the background is transparent.
    pub is_transparent: bool,
}

impl SceneSize {
    pub(super) fn new(description: &SceneDescription, plan: &ImportPlan) -> Self {
        let SceneDescription { materials, spheres, tables, background, .. } = description;
        let shines = |material: usize| materials[material].emission.max_element() > 0.0;
        let rows = || tables.iter().zip(plan.tables.iter().map(|table| table.rows));
        let colored = || rows().filter(|(table, _)| table.data.has_colors());
        let own_emission = || rows().filter(|(table, _)| table.data.has_emission());
        let emissive =
            rows().filter(|(table, _)| table.data.has_emission() || shines(table.material));
        let listed = spheres.iter().filter(|sphere| shines(sphere.material)).count() as u64;
        Self {
            spheres: plan.sphere_count(description),
            listed_spheres: spheres.len() as u64,
            f64_spheres: spheres.len() as u64 + plan.f64_rows(),
            emissive_rows: own_emission().map(|(_, rows)| rows).sum(),
            emitters: listed + emissive.map(|(_, rows)| rows).sum::<u64>(),
            colors: colored().map(|(_, rows)| rows).sum(),
            color_bytes: colored()
                .map(|(table, rows)| rows * table.colors.bytes_per_color() as u64)
                .sum(),
            environment_pixels: plan.environment.as_ref().map_or(0, |map| map.len() as u64),
            is_transparent: background.transparent,
        }
    }

    /// Returns the size with the colours of all tables packed.
    #[must_use]
    pub fn with_packed_colors(self) -> Self {
        let color_bytes = self.colors * ColorStorage::Packed.bytes_per_color() as u64;
        Self { color_bytes, ..self }
    }
}

impl SceneDescription {
    /// Returns the size of the scene. Looks up the lengths of table files, and reads the
    /// environment map.
    ///
    /// # Errors
    /// Reports all errors in the description and its files at once.
    pub fn size(&self) -> Result<SceneSize> {
        let mut problems = self.validate();
        if problems.0.is_empty() {
            // The headers of NumPy files complete their columns.
            let mut complete = self.clone();
            let plan = ImportPlan::scan(&mut complete, &mut problems);
            if problems.0.is_empty() {
                return Ok(SceneSize::new(&complete, &plan));
            }
        }
        problems.into_result().map(|()| SceneSize::default())
    }
}
