//! Sphere tables: raw files of little-endian f32 rows, read into one array.
//!
//! A table may be larger than half the memory, so nothing of it is ever held twice: the array is
//! made once, in its final size, from the lengths that the files really have.

use std::io;
use std::path::Path;

use crate::error::{Error, Result};
use crate::geometry::{Sphere, SphereRows};
use crate::math::NO_SPHERE;

use super::colors::Colors;
use super::description::{Description, SphereTable, Surface};
use super::document::Table;
use super::read::SHARE_ROUNDING;
use super::report::{Report, Span, Wrong};
use super::rows::{Layout, TableRows, VALUE};

/// The most spheres of a scene, so that rows and ids fit in 32 bits.
const MOST_SPHERES: u64 = NO_SPHERE as u64 - 2;

/// The spheres of one table in [`super::Loaded::rows`].
#[derive(Clone, Debug, PartialEq)]
pub struct RowGroup {
    /// The number of the first row, counted through all spheres of the scene.
    pub first_row: u32,
    /// How many rows there are.
    pub count: u32,
    /// Index into [`Description::materials`].
    pub material: usize,
    /// Each row's own linear colour, in `[0, 1]`, where the table has one.
    pub colors: Option<Colors>,
}

/// What is known of a table's file before it is read.
#[derive(Clone, Debug)]
pub(super) struct Survey {
    /// Where the scene names the file.
    span: Span,
    pub(super) rows: u64,
    /// The largest colour that a row may have.
    pub(super) brightest: [f32; 3],
}

/// Looks at the file of a table that is described in `table`; what is wrong goes to its report.
pub(super) fn survey(
    table: &Table<'_>,
    described: &SphereTable,
    surface: &Surface,
) -> Option<Survey> {
    let brightest = brightest_rows(surface);
    let layout = Layout::new(&described.columns);
    match count_rows(&described.file, layout.bytes()) {
        Ok(rows) => Some(Survey { span: table.span_of("file")?, rows, brightest }),
        Err((message, help)) => {
            table.report().add(table.wrong("file", message).help(help));
            None
        }
    }
}

/// Reads all tables. What is wrong with their rows goes to the report.
///
/// # Errors
/// When there are too many spheres, or too little memory.
pub(super) fn import(
    description: &Description,
    surveys: &[Survey],
    report: &Report,
) -> Result<(SphereRows, Vec<RowGroup>)> {
    let exact: Vec<_> = description
        .spheres
        .iter()
        .map(|row| Sphere { center: row.center, radius: row.radius })
        .collect();
    let in_tables: u64 = surveys.iter().map(|survey| survey.rows).sum();
    let count = in_tables + exact.len() as u64;
    check_count(count)?;
    // The exact spheres will be appended to this very array.
    let mut all = with_capacity(count)?;
    let mut groups = Vec::with_capacity(surveys.len());
    for (table, survey) in description.tables.iter().zip(surveys) {
        let first_row = (exact.len() + all.len()) as u32;
        let mut rows = TableRows::new(table, survey, &mut all)?;
        if let Err((message, help)) = rows.read(&table.file) {
            report.add(Wrong::value(survey.span.clone(), message).help(help));
            continue;
        }
        let (material, colors) = (table.material, rows.colors);
        groups.push(RowGroup { first_row, count: survey.rows as u32, material, colors });
    }
    Ok((SphereRows { exact, table: all }, groups))
}

/// # Errors
/// When there are more spheres than ids.
pub(super) fn check_count(spheres: u64) -> Result<()> {
    if spheres > MOST_SPHERES {
        return Err(Error::input(format!(
            "{spheres} spheres are more than the {MOST_SPHERES} that a scene can hold: their numbers \
             have 32 bits"
        ))
        .with_help("leave some tables out, or thin them out"));
    }
    Ok(())
}

/// The largest colour that a row may have.
fn brightest_rows(surface: &Surface) -> [f32; 3] {
    match surface {
        Surface::Diffuse { .. }
        | Surface::Plastic { .. }
        | Surface::Principled(_)
        | Surface::Mirror { .. }
        | Surface::Conductor { .. }
        | Surface::Dielectric { .. }
        | Surface::Phong { normalized: false, .. } => [1.0; 3],
        Surface::Phong { specular, .. } => {
            specular.to_array().map(|share| 1.0 - share + SHARE_ROUNDING)
        }
    }
}

/// What is wrong with a table, and what to do about it.
pub(super) type Complaint = (String, Option<String>);

/// How many whole rows the file has, or what is wrong with it.
fn count_rows(path: &Path, row: usize) -> std::result::Result<u64, Complaint> {
    let shown = path.display();
    let metadata = path.metadata().map_err(|error| unreadable(path, &error))?;
    let refused = |why: String, help: &str| Err((format!("`{shown}` {why}"), Some(help.into())));
    if metadata.is_dir() {
        return refused("is a folder".into(), "name the file with the rows");
    }
    if !metadata.is_file() {
        let help = "its length must be known beforehand: write the rows into a file";
        return refused("is not an ordinary file".into(), help);
    }
    let (bytes, row) = (metadata.len(), row as u64);
    match (bytes / row, bytes % row) {
        (0, 0) => refused("is empty".into(), "a table has at least one row"),
        (rows, 0) => Ok(rows),
        (rows, over) => refused(
            format!(
                "has {}, which is no whole number of rows: {} of {row} bytes and {} over",
                counted(bytes, "byte"),
                counted(rows, "row"),
                counted(over, "byte"),
            ),
            &layout_help(row / VALUE as u64),
        ),
    }
}

pub(super) fn unreadable(path: &Path, error: &io::Error) -> Complaint {
    let help = match error.kind() {
        io::ErrorKind::NotFound => Some("a relative path starts at the scene's folder".to_owned()),
        _ => None,
    };
    (format!("cannot read `{}`: {error}", path.display()), help)
}

/// What to look at where the rows are not what was expected.
pub(super) fn layout_help(columns: u64) -> String {
    format!(
        "a row is {columns} little-endian f32 numbers, as `columns` says, and there is no header: \
         mend `columns` or the file"
    )
}

/// `1 row`, `2 rows`.
fn counted(number: u64, singular: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{number} {singular}{plural}")
}

pub(super) fn with_capacity<T>(count: u64) -> Result<Vec<T>> {
    let mut vec = Vec::new();
    vec.try_reserve_exact(count as usize).map_err(|_| {
        Error::input(format!("there is not enough memory for {count} spheres"))
            .with_help("leave some sphere tables out")
    })?;
    Ok(vec)
}
