//! Imports sphere tables (raw files of little-endian f32 rows, or arrays in memory) into one array.
//!
//! A table may be larger than half the memory, so nothing is ever held twice: the array is
//! allocated once, in its final size, from the actual lengths of files and arrays.

use std::path::Path;

use crate::error::{Error, Result};
use crate::geometry::{Sphere, SphereRows};
use crate::math::NO_SPHERE;

use super::arrays;
use super::colors::SphereColors;
use super::complaint::{TableDiagnostic, layout_help, read_error};
use super::data::SphereData;
use super::description::{EnvironmentDescription, SceneDescription, SphereTable};
use super::environment::{self, EnvironmentPixels};
use super::storage::try_with_capacity;
use super::table_reader::{Row, RowLayout, TableReader, VALUE_BYTES};
use super::validation_errors::{self, ValidationErrors};

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
    /// Id of each row, if the table has ids.
    pub(super) ids: Option<Vec<u32>>,
}

/// Facts about a scene's files and arrays before table data is read.
#[derive(Clone, Debug, Default)]
pub(super) struct ImportPlan {
    /// Number of rows of each table.
    pub(super) rows: Vec<u64>,
    /// Pixels of the environment map.
    pub(super) environment: Option<EnvironmentPixels>,
}

impl ImportPlan {
    /// Examines the files of a description. Errors are added to `problems`.
    pub(super) fn scan(description: &SceneDescription, problems: &mut ValidationErrors) -> Self {
        let environment = match &description.background.dome {
            EnvironmentDescription::Image { file, .. } => read_environment(file, problems),
            _ => None,
        };
        let mut count = |(index, table): (usize, &SphereTable)| match &table.data {
            SphereData::Memory(arrays) => arrays.len() as u64,
            SphereData::File { path, columns } => {
                let counted = count_rows(path, RowLayout::new(columns).row_bytes());
                counted.unwrap_or_else(|(message, help)| {
                    problems.add(table_path(index).key("file"), message).with_help(help);
                    0
                })
            }
        };
        let rows = description.tables.iter().enumerate().map(&mut count).collect();
        Self { rows, environment }
    }

    /// Number of spheres, including duplicates.
    pub(super) fn sphere_count(&self, description: &SceneDescription) -> u64 {
        // Arrays may claim any length, for example if all spheres share one number.
        self.rows
            .iter()
            .fold(description.spheres.len() as u64, |sum, &rows| sum.saturating_add(rows))
    }
}

fn table_path(index: usize) -> validation_errors::KeyPath {
    validation_errors::KeyPath::root("sphere_tables").entry(index, None)
}

fn read_environment(file: &Path, problems: &mut ValidationErrors) -> Option<EnvironmentPixels> {
    environment::read(file)
        .map_err(|trouble| {
            let message = format!("cannot use `{}` as background: {trouble}", file.display());
            let at = validation_errors::KeyPath::root("background").key("image").key("file");
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
    survey: &ImportPlan,
    problems: &mut ValidationErrors,
) -> Result<(SphereRows, Vec<RowGroup>)> {
    check_count(survey.sphere_count(description))?;
    // Spheres in f64 come first in row order, so all tables up to the last f64 table are read as
    // f64.
    let f64_tables = description.tables.iter().rposition(|table| table.data.is_f64());
    let wide = f64_tables.map_or(0, |last| last + 1);
    let listed = description.spheres.len() as u64;
    let f64_count = listed + survey.rows[..wide].iter().sum::<u64>();
    let mut exact: Vec<Sphere> = try_with_capacity(f64_count)?;
    exact.extend(
        description.spheres.iter().map(|row| Sphere { center: row.center, radius: row.radius }),
    );
    // The exact spheres will be appended to this array.
    let mut all = try_with_capacity(survey.sphere_count(description))?;
    let mut groups = Vec::with_capacity(description.tables.len());
    for (index, (table, &rows)) in description.tables.iter_mut().zip(&survey.rows).enumerate() {
        let first_row = (exact.len() + all.len()) as u32;
        let brightest = description.materials[table.material].surface.max_row_color();
        let read = match index < wide {
            true => read_table(table, rows, brightest, &mut exact)?,
            false => read_table(table, rows, brightest, &mut all)?,
        };
        let is_file = matches!(table.data, SphereData::File { .. });
        table.data.let_go();
        match read {
            Err((message, help)) => {
                let key = if is_file { "file" } else { "data" };
                problems.add(table_path(index).key(key), message).with_help(help);
            }
            Ok((colors, ids)) => {
                let (count, material) = (rows as u32, table.material);
                groups.push(RowGroup { first_row, count, material, colors, ids });
            }
        }
    }
    Ok((SphereRows { exact, table: all }, groups))
}

/// Optional colours and ids of a table's spheres.
type OwnValues = (Option<SphereColors>, Option<Vec<u32>>);

/// Appends the spheres of one table, and returns their colours and ids, or a diagnostic.
fn read_table<T: Row>(
    table: &SphereTable,
    rows: u64,
    brightest: [f32; 3],
    to: &mut Vec<T>,
) -> Result<std::result::Result<OwnValues, TableDiagnostic>> {
    Ok(match &table.data {
        SphereData::File { path, columns } => {
            let mut reader = TableReader::new(columns, table.colors, rows, brightest, to)?;
            reader.read(path).map(|()| (reader.colors, None))
        }
        SphereData::Memory(arrays) => arrays::read_f32(arrays, table.colors, brightest, to)
            .and_then(|colors| Ok((colors, arrays::read_ids(arrays)?))),
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

/// How many whole rows the file has, or what is wrong with it.
fn count_rows(path: &Path, row: usize) -> std::result::Result<u64, TableDiagnostic> {
    let shown = path.display();
    let metadata = path.metadata().map_err(|error| read_error(path, &error))?;
    let refused = |why: String, help: &str| Err((format!("`{shown}` {why}"), Some(help.into())));
    if metadata.is_dir() {
        return refused("is a folder".into(), "name the file with the rows");
    }
    if !metadata.is_file() {
        let help = "the length must be known in advance: write the rows to a file";
        return refused("is not a regular file".into(), help);
    }
    let (bytes, row) = (metadata.len(), row as u64);
    match (bytes / row, bytes % row) {
        (0, 0) => refused("is empty".into(), "a table has at least one row"),
        (rows, 0) => Ok(rows),
        (rows, over) => refused(
            format!(
                "has {}, which is not a whole number of rows: {} of {row} bytes and {} left over",
                pluralize(bytes, "byte"),
                pluralize(rows, "row"),
                pluralize(over, "byte"),
            ),
            &layout_help(row / VALUE_BYTES as u64),
        ),
    }
}

/// Formats a count, as in `1 row` or `2 rows`.
fn pluralize(number: u64, singular: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{number} {singular}{plural}")
}

#[cfg(test)]
mod tests;
