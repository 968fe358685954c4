//! Sphere tables: raw files of little-endian f32 rows, read into one array.
//!
//! A table may be larger than half the memory, so nothing of it is ever held twice: the array is
//! made once, in its final size, from the lengths that the files really have, and the bytes pass
//! through a small buffer.

use std::fs::File;
use std::io::{self, Read};
use std::ops::RangeInclusive;
use std::path::Path;

use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::geometry::{Sphere, SphereRows};
use crate::math::{MAX_COORDINATE, NO_SPHERE};

use super::description::{Column, Description, SphereTable, Surface};
use super::document::Table;
use super::read::{SHARE_ROUNDING, SMALLEST_RADIUS};
use super::report::{Report, Span, Wrong};

/// Bytes of one f32.
const VALUE: usize = size_of::<f32>();

/// Bytes read at a time, or a little less: whole rows.
const CHUNK: usize = 4 << 20;

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
    pub colors: Option<Vec<[f32; 3]>>,
}

/// What is known of a table's file before it is read.
#[derive(Clone, Debug)]
pub(super) struct Survey {
    /// Where the scene names the file.
    span: Span,
    rows: u64,
    /// The largest colour that a row may have.
    brightest: [f32; 3],
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
    if count > MOST_SPHERES {
        return Err(Error::input(format!(
            "{count} spheres are more than the {MOST_SPHERES} that a scene can hold"
        )));
    }
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
type Complaint = (String, Option<String>);

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

fn unreadable(path: &Path, error: &io::Error) -> Complaint {
    let help = match error.kind() {
        io::ErrorKind::NotFound => Some("a relative path starts at the scene's folder".to_owned()),
        _ => None,
    };
    (format!("cannot read `{}`: {error}", path.display()), help)
}

/// What to look at where the rows are not what was expected.
fn layout_help(columns: u64) -> String {
    format!(
        "a row is {columns} little-endian f32 numbers, as `columns` says, and there is no header: \
         mend `columns` or the file"
    )
}

/// The shortest number that reads back as the same f32.
fn in_words(x: f32) -> String {
    let is_handy = x == 0.0 || (1e-4..1e6).contains(&x.abs());
    if is_handy { x.to_string() } else { format!("{x:e}") }
}

/// `1 row`, `2 rows`.
fn counted(number: u64, singular: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{number} {singular}{plural}")
}

fn with_capacity<T>(count: u64) -> Result<Vec<T>> {
    let mut vec = Vec::new();
    vec.try_reserve_exact(count as usize).map_err(|_| {
        Error::input(format!("there is not enough memory for {count} spheres"))
            .with_help("leave some sphere tables out")
    })?;
    Ok(vec)
}

/// Where the values of a row stand, as numbers of columns.
struct Layout {
    columns: usize,
    sphere: [usize; 4],
    color: Option<[usize; 3]>,
}

impl Layout {
    /// `columns` has x, y, z and radius once each, and all of r, g, b or none.
    fn new(columns: &[Column]) -> Self {
        let of = |column: Column| columns.iter().position(|&c| c == column);
        let required = |column: Column| of(column).unwrap_or_default();
        let sphere = [Column::X, Column::Y, Column::Z, Column::Radius].map(required);
        let color = [Column::Red, Column::Green, Column::Blue];
        let color = of(Column::Red).map(|_| color.map(required));
        Self { columns: columns.len(), sphere, color }
    }

    fn bytes(&self) -> usize {
        self.columns * VALUE
    }
}

/// One value of a row.
fn value(row: &[u8], column: usize) -> f32 {
    let mut bytes = [0; VALUE];
    bytes.copy_from_slice(&row[column * VALUE..][..VALUE]);
    f32::from_le_bytes(bytes)
}

/// The rows of one table on their way into the array of all.
struct TableRows<'r> {
    columns: &'r [Column],
    layout: Layout,
    survey: &'r Survey,
    all: &'r mut Vec<[f32; 4]>,
    colors: Option<Vec<[f32; 3]>>,
}

/// The rows that cannot be spheres.
#[derive(Clone, Copy, Default)]
struct Flaws {
    first: Option<usize>,
    count: usize,
}

impl Flaws {
    fn of_row(number: usize, is_wrong: bool) -> Self {
        Self { first: is_wrong.then_some(number), count: usize::from(is_wrong) }
    }

    fn join(self, later: Self) -> Self {
        Self { first: self.first.or(later.first), count: self.count + later.count }
    }
}

impl<'r> TableRows<'r> {
    fn new(table: &'r SphereTable, survey: &'r Survey, all: &'r mut Vec<[f32; 4]>) -> Result<Self> {
        let layout = Layout::new(&table.columns);
        let colors = layout.color.map(|_| with_capacity(survey.rows)).transpose()?;
        Ok(Self { columns: &table.columns, layout, survey, all, colors })
    }

    fn read(&mut self, path: &Path) -> std::result::Result<(), Complaint> {
        let trouble = |error| unreadable(path, &error);
        let mut file = File::open(path).map_err(trouble)?;
        let rows_at_once = CHUNK / self.layout.bytes();
        let mut buffer = vec![0; rows_at_once * self.layout.bytes()];
        let (mut flaws, mut first_flaw) = (Flaws::default(), None);
        let mut done = 0;
        let rows = self.survey.rows as usize;
        while done < rows {
            let count = rows_at_once.min(rows - done);
            let chunk = &mut buffer[..count * self.layout.bytes()];
            file.read_exact(chunk).map_err(trouble)?;
            let found = self.take(chunk);
            if let (None, Some(at)) = (flaws.first, found.first) {
                first_flaw = Some(self.tell(&chunk[at * self.layout.bytes()..], done + at));
            }
            flaws = flaws.join(found);
            done += count;
        }
        let Some(first) = first_flaw else {
            return Ok(());
        };
        let others = match flaws.count - 1 {
            0 => String::new(),
            1 => "; 1 more row is wrong".to_owned(),
            count => format!("; {count} more rows are wrong"),
        };
        let help = layout_help(self.layout.columns as u64);
        Err((format!("`{}`: {first}{others}", path.display()), Some(help)))
    }

    /// Appends the rows; says which of them are wrong.
    fn take(&mut self, chunk: &[u8]) -> Flaws {
        let rows = chunk.par_chunks_exact(self.layout.bytes());
        let sphere = self.layout.sphere;
        self.all.par_extend(rows.clone().map(|row| sphere.map(|column| value(row, column))));
        if let (Some(colors), Some(color)) = (&mut self.colors, self.layout.color) {
            colors.par_extend(rows.clone().map(|row| color.map(|column| value(row, column))));
        }
        let flaw = |(number, row)| Flaws::of_row(number, self.flaw_in(row).is_some());
        rows.enumerate().map(flaw).reduce(Flaws::default, Flaws::join)
    }

    /// The first column whose value cannot be.
    fn flaw_in(&self, row: &[u8]) -> Option<usize> {
        (0..self.layout.columns).find(|&column| !self.allows(column, value(row, column)))
    }

    fn allows(&self, column: usize, value: f32) -> bool {
        self.allowed(column).contains(&value)
    }

    /// What the values of a column may be.
    fn allowed(&self, column: usize) -> RangeInclusive<f32> {
        let largest = MAX_COORDINATE as f32;
        let [red, green, blue] = self.survey.brightest;
        match self.columns[column] {
            Column::X | Column::Y | Column::Z => -largest..=largest,
            Column::Radius => SMALLEST_RADIUS as f32..=largest,
            Column::Red => 0.0..=red,
            Column::Green => 0.0..=green,
            Column::Blue => 0.0..=blue,
        }
    }

    /// Tells of the flaw in a row.
    fn tell(&self, row: &[u8], number: usize) -> String {
        let column = self.flaw_in(row).unwrap_or_default();
        let is_this = |(_, known): &&(_, Column)| *known == self.columns[column];
        let name = Column::NAMES.iter().find(is_this).map_or("?", |(name, _)| name);
        let offset = (number * self.layout.columns + column) * VALUE;
        let allowed = self.allowed(column);
        format!(
            "row {number} (the first is 0) has {name} = {:?} at byte {offset}; it must be from {} to \
             {}",
            value(row, column),
            in_words(*allowed.start()),
            in_words(*allowed.end()),
        )
    }
}
