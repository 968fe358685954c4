//! Makes spheres of the particles in a file.

use rayon::prelude::*;

use crate::appearance::{AppearanceError, Colors, Dressed, Radii, dress, needed_columns};
use crate::error::{Error, Result};
use crate::particles::{Particles, Positions, Wanted, read, survey};
use crate::task::pages::collect;

use super::colors::PackedColor;
use super::data::{SphereArrays, StridedArray};
use super::description::ColorStorage;
use super::particle_file::ParticleTable;
use super::particle_radii::check_radii;

/// Why particles cannot become spheres.
pub(super) enum ParticleError {
    /// The file cannot be read.
    File(Error),
    /// An option is wrong.
    Option(AppearanceError),
}

impl ParticleTable {
    /// Reads the particles and gives them radii and colours.
    pub(super) fn dress(&self) -> std::result::Result<Dressed, ParticleError> {
        let particles = self.wanted().and_then(|wanted| read(&self.path, &self.request(wanted)));
        self.dress_particles(particles.map_err(ParticleError::File)?)
    }

    /// Gives particles, which stand for those of the file, radii and colours.
    pub(super) fn dress_particles(
        &self,
        particles: Particles,
    ) -> std::result::Result<Dressed, ParticleError> {
        if particles.is_empty() {
            let message = format!("`{}` has no particles", self.path.display());
            return Err(ParticleError::File(Error::input(message)));
        }
        let dressed = dress(particles, &self.appearance).map_err(ParticleError::Option)?;
        check_radii(self, &dressed).map_err(ParticleError::Option)?;
        Ok(dressed)
    }

    /// Which row of the file each row of the table shows.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn file_rows(&self) -> Result<FileRows> {
        let dressed = self.dress().map_err(|error| match error {
            ParticleError::File(error) => error,
            ParticleError::Option(error) => Error::input(error.message),
        })?;
        let particles = dressed.particle_count();
        Ok(FileRows { rows: dressed.rows, copies: dressed.copies, particles })
    }

    /// The columns to read. Standard input can be read only once, so all of its columns are.
    fn wanted(&self) -> Result<Wanted> {
        if self.path.as_os_str() == "-" {
            return Ok(Wanted::All);
        }
        let survey = survey(&self.path, &self.request(Wanted::All))?;
        let names: Vec<&str> = survey.columns.iter().map(|column| &*column.name).collect();
        Ok(needed_columns(&self.appearance, &names).map_or(Wanted::All, Wanted::Only))
    }
}

/// Which row of a file each row of a table shows.
#[derive(Clone, Debug, Default)]
pub struct FileRows {
    /// Rows of the file without periodic copies; `None` for all.
    pub(super) rows: Option<Vec<u32>>,
    /// Number of periodic copies, one behind the other.
    pub(super) copies: usize,
    /// Number of particles with their copies; edges of the cell follow.
    pub(super) particles: usize,
}

impl FileRows {
    /// The row of the file, from 0, that a row of the table shows; `None` for an edge of the cell.
    pub fn row_in_file(&self, row: u32) -> Option<u32> {
        let row = Some(row as usize).filter(|row| *row < self.particles)?;
        let original = row % (self.particles / self.copies);
        Some(self.rows.as_ref().map_or(original as u32, |rows| rows[original]))
    }
}

/// The arrays of visible particles, with colours as the scene will store them. White ones emit
/// `glow`, and reflect `shade`.
pub(super) fn arrays(
    dressed: &mut Dressed,
    storage: ColorStorage,
    glow: f64,
    shade: f64,
) -> SphereArrays {
    let len = dressed.len();
    let is_f32 = matches!(dressed.positions, Positions::F32(_));
    let center = match std::mem::replace(&mut dressed.positions, Positions::F32(Vec::new())) {
        Positions::F32(centers) => StridedArray::columns_from(centers),
        Positions::F64(centers) => StridedArray::columns_from(centers),
    };
    let radius = match std::mem::replace(&mut dressed.radii, Radii::Constant(0.0)) {
        // One number that f32 holds must not double the memory of all others.
        Radii::Constant(radius) if is_f32 && f64::from(radius as f32) == radius => {
            StridedArray::constant(radius as f32, len)
        }
        Radii::Constant(radius) => StridedArray::constant(radius, len),
        Radii::F32(radii) => StridedArray::from_vec(radii),
        Radii::F64(radii) => StridedArray::from_vec(radii),
    };
    let colors = std::mem::replace(&mut dressed.colors, Colors::Each(Vec::new()));
    let emission = (glow > 0.0).then(|| in_columns(scaled(&colors, glow), len));
    let color = match (colors, storage) {
        (Colors::Each(colors), ColorStorage::Packed) => {
            StridedArray::packed(packed(&colors, shade))
        }
        (colors, _) if shade < 1.0 => in_columns(scaled(&colors, shade), len),
        (colors, _) => in_columns(colors, len),
    };
    SphereArrays { center, radius, color: Some(color), emission, ids: None }
}

fn scaled(colors: &Colors, factor: f64) -> Colors {
    match colors {
        Colors::Constant(color) => Colors::Constant(*color * factor as f32),
        Colors::Each(colors) => {
            let scale = |color: &[f32; 3]| color.map(|c| c * factor as f32);
            Colors::Each(colors.par_iter().map(scale).collect())
        }
    }
}

/// Particles may be kept for many renders, so they take no more memory than in a scene.
fn packed(colors: &[[f32; 3]], shade: f64) -> Vec<PackedColor> {
    let shade = shade.min(1.0) as f32;
    let pack = |color: &[f32; 3]| PackedColor::new(color.map(|c| c * shade), [1.0; 3]);
    collect(colors.par_iter().map(pack))
}

fn in_columns(colors: Colors, len: usize) -> [StridedArray; 3] {
    match colors {
        Colors::Constant(color) => color.to_array().map(|c| StridedArray::constant(c, len)),
        Colors::Each(colors) => StridedArray::columns_from(colors),
    }
}
