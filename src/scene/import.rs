//! Imports sphere tables (files of rows, or arrays in memory) into one array.
//!
//! A table may be larger than half the memory, so nothing is ever held twice: the array is
//! allocated once, in its final size, from the actual lengths of files and arrays.

use std::path::Path;
use std::sync::Arc;

use rayon::prelude::*;

use crate::appearance::Dressed;
use crate::color::Rgb;
use crate::error::{Error, Result};
use crate::geometry::{Sphere, SphereRows};
use crate::math::{DVec3, NO_SPHERE};
use crate::particles::Particles;

use super::arrays;
use super::colors::SphereColors;
use super::complaint::TableDiagnostic;
use super::data::{SphereArrays, SphereData};
use super::description::{EnvironmentDescription, SceneDescription, SphereTable};
use super::environment::{self, EnvironmentPixels};
use super::particle_table::{self, ParticleError};
use super::storage::try_with_capacity;
use super::table_layout::{FileTable, LayoutError, TableLayout};
use super::table_path::table_path;
use super::table_reader::{Row, RowColors, TableReader};
use super::validate::check_columns;
use super::validation_errors::{KeyPath, ValidationErrors};

/// Maximum number of spheres, so that rows and ids fit in 32 bits.
const MAX_SPHERES: u64 = NO_SPHERE as u64 - 2;

/// The rows of one table within a scene.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RowGroup {
    /// Index of the first row, counted over all spheres of the scene.
    pub(super) first_row: u32,
    /// Number of rows.
    pub(super) count: u32,
    /// Index into [`SceneDescription::materials`].
    pub(super) material: usize,
    /// Linear colour of each row in `[0, 1]`, if the table has colours.
    pub(super) colors: Option<SphereColors>,
    /// Emitted radiance of each row, if the table has emission.
    pub(super) emission: Option<Vec<[f32; 3]>>,
    /// Id of each row, if the table has ids.
    pub(super) ids: Option<Vec<u32>>,
}

impl RowGroup {
    /// The colour of a row, counted within the table.
    #[inline(always)]
    pub(super) fn color(&self, row: usize) -> Option<Rgb> {
        self.colors.as_ref().map(|colors| colors.get(row))
    }

    /// The emission of a row, counted within the table.
    #[inline(always)]
    pub(super) fn emission(&self, row: usize) -> Option<Rgb> {
        self.emission.as_ref().map(|emission| Rgb::from_array(emission[row]))
    }

    /// The largest emission of a row in any channel.
    pub(super) fn max_emission(&self) -> f32 {
        let rows = self.emission.as_deref().unwrap_or_default();
        rows.par_iter().flatten_iter().copied().reduce(|| 0.0, f32::max)
    }
}

/// Facts about a scene's files and arrays before table data is read.
#[derive(Clone, Debug, Default)]
pub(super) struct ImportPlan {
    /// The tables.
    pub(super) tables: Vec<TablePlan>,
    /// Pixels of the environment map.
    pub(super) environment: Option<EnvironmentPixels>,
}

/// Facts about one table.
#[derive(Clone, Debug, Default)]
pub(super) struct TablePlan {
    /// Number of rows.
    pub(super) rows: u64,
    /// True if centres or radii need more than f32.
    is_f64: bool,
    /// Where the numbers of a file are.
    layout: Option<TableLayout>,
    /// The particles of a file, which are read at once.
    pub(super) particles: Option<PlannedParticles>,
    /// What a program gives in place of the file.
    pub(super) given: Option<GivenTable>,
}

/// What a program gives in place of a table's file.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "there are a few, each moved once")]
pub(super) enum GivenTable {
    /// Particles, for `[[particles]]`.
    Particles(Arc<Particles>),
    /// Spheres, for `[[sphere_tables]]`.
    Arrays(SphereArrays),
}

/// Particles that have been read.
#[derive(Clone, Debug)]
pub(super) struct PlannedParticles {
    /// Their numbers.
    pub(super) arrays: SphereArrays,
    /// How they look, without the numbers.
    pub(super) look: Dressed,
}

impl ImportPlan {
    /// Examines the files of a description, and lists the columns of files that name them. Errors
    /// are added to `problems`.
    pub(super) fn scan(
        description: &mut SceneDescription,
        problems: &mut ValidationErrors,
    ) -> Self {
        Self::scan_with(description, Vec::new(), problems)
    }

    /// Examines the files of a description. Particles of tables that an earlier plan has are taken
    /// from there.
    pub(super) fn scan_with(
        description: &mut SceneDescription,
        mut earlier: Vec<TablePlan>,
        problems: &mut ValidationErrors,
    ) -> Self {
        let environment = match &description.background.dome {
            EnvironmentDescription::Image { file, .. } => read_environment(file, problems),
            _ => None,
        };
        let paths: Vec<KeyPath> = (0..description.tables.len())
            .map(|index| table_path(&description.tables, index))
            .collect();
        earlier.resize_with(description.tables.len(), TablePlan::default);
        let tables = description.tables.iter_mut().zip(paths).zip(earlier);
        let tables = tables.map(|((table, at), earlier)| match earlier.particles {
            Some(_) => earlier,
            None => TablePlan::scan(&at, table, earlier.given, problems),
        });
        Self { tables: tables.collect(), environment }
    }

    /// Number of spheres, including duplicates.
    pub(super) fn sphere_count(&self, description: &SceneDescription) -> u64 {
        // Arrays may claim any length, for example if all spheres share one number.
        self.tables
            .iter()
            .fold(description.spheres.len() as u64, |sum, table| sum.saturating_add(table.rows))
    }

    /// Number of tables that are read in f64. Spheres in f64 come first in row order, so these are
    /// all up to the last f64 table.
    fn f64_tables(&self) -> usize {
        self.tables.iter().rposition(|table| table.is_f64).map_or(0, |last| last + 1)
    }

    /// Number of table rows that are read in f64.
    pub(super) fn f64_rows(&self) -> u64 {
        self.tables[..self.f64_tables()].iter().map(|table| table.rows).sum()
    }
}

impl TablePlan {
    /// A table that is not examined yet.
    pub(super) fn of_given(given: GivenTable) -> Self {
        Self { given: Some(given), ..Self::default() }
    }

    fn scan(
        at: &KeyPath,
        table: &mut SphereTable,
        given: Option<GivenTable>,
        problems: &mut ValidationErrors,
    ) -> Self {
        let is_moved = table.offset != DVec3::ZERO;
        let given = match (given, &table.data) {
            (Some(GivenTable::Arrays(arrays)), SphereData::File { path, .. }) => {
                // The name stays that of the file.
                let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
                table.name = table.name.take().or(name);
                table.data = SphereData::Memory(arrays);
                None
            }
            (Some(GivenTable::Particles(particles)), _) => Some(particles),
            (Some(GivenTable::Arrays(_)) | None, _) => None,
        };
        let (path, columns, skip_rows, skip_bytes) = match &mut table.data {
            SphereData::Memory(arrays) => {
                let is_f64 = is_moved || arrays.is_f64();
                return Self { rows: arrays.len() as u64, is_f64, ..Self::default() };
            }
            SphereData::Particles(particles) => {
                let appearance = &particles.appearance;
                let dressed = match given.map(Arc::unwrap_or_clone) {
                    Some(given) => particles.dress_particles(given),
                    None => particles.dress(),
                };
                let mut look = match dressed {
                    Ok(dressed) => dressed,
                    Err(error) => {
                        add_particle_error(at, error, problems);
                        return Self::default();
                    }
                };
                let (glow, shade) = (appearance.glow, appearance.shade);
                let arrays = particle_table::arrays(&mut look, table.colors, glow, shade);
                let (rows, is_f64) = (arrays.len() as u64, arrays.is_f64());
                let particles = Some(PlannedParticles { arrays, look });
                return Self { rows, is_f64, particles, ..Self::default() };
            }
            SphereData::File { path, columns, skip_rows, skip_bytes } => {
                (path, columns, *skip_rows, *skip_bytes)
            }
        };
        let file = FileTable { at: at.to_string(), path, columns, skip_rows, skip_bytes };
        match file.layout() {
            Ok((layout, unlisted)) => {
                if let Some(unlisted) = unlisted {
                    check_columns(at, &unlisted, problems);
                    *columns = unlisted;
                }
                let is_f64 = is_moved || layout.is_f64();
                Self { rows: layout.rows, is_f64, layout: Some(layout), ..Self::default() }
            }
            Err(LayoutError { key, message, help }) => {
                let problem = problems.add(at.key(key), message).with_help(help);
                problem.with_related(at.key("file")).with_related(at.key("columns"));
                Self::default()
            }
        }
    }
}

fn add_particle_error(at: &KeyPath, error: ParticleError, problems: &mut ValidationErrors) {
    match error {
        ParticleError::File(error) => {
            let help = error.help().map(str::to_owned);
            problems.add(at.key("file"), error.to_string()).with_help(help);
        }
        ParticleError::Option(error) => {
            let problem = problems.add(at.key(error.key), error.message);
            problem.with_help(error.help).within(error.span);
        }
    }
}

fn read_environment(file: &Path, problems: &mut ValidationErrors) -> Option<EnvironmentPixels> {
    environment::read(file)
        .map_err(|trouble| {
            let message = format!("cannot use `{}` as background: {trouble}", file.display());
            let at = KeyPath::root("background").key("image").key("file");
            problems.add(at, message);
        })
        .ok()
}

/// Reads all tables and releases each array in memory as soon as it is read. Errors in their rows
/// are added to `problems`.
///
/// # Errors
/// If there are too many spheres, or too little memory.
pub(super) fn load_tables(
    description: &mut SceneDescription,
    survey: ImportPlan,
    problems: &mut ValidationErrors,
) -> Result<(SphereRows, Vec<RowGroup>)> {
    check_count(survey.sphere_count(description))?;
    let wide = survey.f64_tables();
    let f64_count = description.spheres.len() as u64 + survey.f64_rows();
    let mut exact: Vec<Sphere> = try_with_capacity(f64_count)?;
    exact.extend(
        description.spheres.iter().map(|row| Sphere { center: row.center, radius: row.radius }),
    );
    // The exact spheres will be appended to this array.
    let mut all = try_with_capacity(survey.sphere_count(description))?;
    let mut groups = Vec::with_capacity(description.tables.len());
    let paths: Vec<KeyPath> =
        (0..description.tables.len()).map(|index| table_path(&description.tables, index)).collect();
    for (index, (table, plan)) in description.tables.iter_mut().zip(survey.tables).enumerate() {
        let first_row = (exact.len() + all.len()) as u32;
        let brightest = description.materials[table.material].surface.max_row_color();
        let read = match index < wide {
            true => read_table(table, &plan, brightest, &mut exact)?,
            false => read_table(table, &plan, brightest, &mut all)?,
        };
        let is_file = !matches!(table.data, SphereData::Memory(_));
        table.data.let_go();
        match read {
            Err((message, help)) => {
                let key = if is_file { "file" } else { "data" };
                problems.add(paths[index].key(key), message).with_help(help);
            }
            Ok((RowColors { albedo: colors, emission }, ids)) => {
                let (count, material) = (plan.rows as u32, table.material);
                groups.push(RowGroup { first_row, count, material, colors, emission, ids });
            }
        }
    }
    Ok((SphereRows { exact, table: all }, groups))
}

/// Optional colours and ids of a table's spheres.
type OwnValues = (RowColors, Option<Vec<u32>>);

/// Appends the spheres of one table, and returns their colours and ids, or a diagnostic.
fn read_table<T: Row>(
    table: &SphereTable,
    plan: &TablePlan,
    brightest: [f32; 3],
    to: &mut Vec<T>,
) -> Result<std::result::Result<OwnValues, TableDiagnostic>> {
    let SphereTable { data, colors, color_space, offset, .. } = table;
    let space = *color_space;
    Ok(match (data, &plan.layout) {
        (SphereData::File { path, .. }, Some(layout)) => {
            let mut reader = TableReader::new(layout, *colors, space, *offset, brightest, to)?;
            reader.read(path).map(|()| (reader.colors, None))
        }
        (SphereData::File { path, .. }, None) => {
            let message = format!("`{}` has not been examined", path.display());
            Err((message, None))
        }
        (SphereData::Particles(particles), _) => match &plan.particles {
            Some(PlannedParticles { arrays, .. }) => {
                arrays::read_spheres(arrays, *colors, space, *offset, brightest, to)
                    .map(|colors| (colors, None))
            }
            None => {
                let message = format!("`{}` has not been read", particles.path.display());
                Err((message, None))
            }
        },
        (SphereData::Memory(arrays), _) => {
            arrays::read_spheres(arrays, *colors, space, *offset, brightest, to)
                .and_then(|colors| Ok((colors, arrays::read_ids(arrays)?)))
        }
    })
}

/// Checks that the scene does not have too many spheres.
///
/// # Errors
/// If there are more spheres than ids.
pub(super) fn check_count(spheres: u64) -> Result<()> {
    if spheres > MAX_SPHERES {
        return Err(Error::input(format!(
            "{spheres} spheres are more than the {MAX_SPHERES} that a scene can hold, because ids \
             have 32 bits"
        ))
        .with_help("remove tables or rows"));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
