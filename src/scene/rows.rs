//! The rows of one table: read in pieces, checked, and put where they belong.

use std::fs::File;
use std::io::Read;
use std::ops::RangeInclusive;
use std::path::Path;

use rayon::prelude::*;

use crate::error::Result;
use crate::geometry::Sphere;
use crate::math::{DVec3, MAX_COORDINATE};

use super::colors::Colors;
use super::complaint::{Complaint, layout_help, unreadable};
use super::data::Column;
use super::description::ColorStorage;
use super::keys::SMALLEST_RADIUS;
use super::storage::room_for_colors;

/// Bytes of one f32.
pub(super) const VALUE: usize = size_of::<f32>();

/// Bytes read at a time, or a little less: whole rows.
const CHUNK: usize = 4 << 20;

/// Where the values of a row stand, as numbers of columns.
pub(super) struct Layout {
    columns: usize,
    sphere: [usize; 4],
    color: Option<[usize; 3]>,
}

impl Layout {
    /// `columns` has x, y, z and radius once each, and all of r, g, b or none.
    pub(super) fn new(columns: &[Column]) -> Self {
        let of = |column: Column| columns.iter().position(|&c| c == column);
        let required = |column: Column| of(column).unwrap_or_default();
        let sphere = [Column::X, Column::Y, Column::Z, Column::Radius].map(required);
        let color = [Column::Red, Column::Green, Column::Blue];
        let color = of(Column::Red).map(|_| color.map(required));
        Self { columns: columns.len(), sphere, color }
    }

    /// Of one row.
    pub(super) fn bytes(&self) -> usize {
        self.columns * VALUE
    }
}

/// One value of a row.
fn value(row: &[u8], column: usize) -> f32 {
    let mut bytes = [0; VALUE];
    bytes.copy_from_slice(&row[column * VALUE..][..VALUE]);
    f32::from_le_bytes(bytes)
}

/// What the four numbers of a sphere are kept as.
pub(super) trait Row: Send + Sync {
    /// From x, y, z and the radius.
    fn of(numbers: [f64; 4]) -> Self;
}

impl Row for [f32; 4] {
    fn of(numbers: [f64; 4]) -> Self {
        numbers.map(|number| number as f32)
    }
}

impl Row for Sphere {
    fn of([x, y, z, radius]: [f64; 4]) -> Self {
        Self { center: DVec3::new(x, y, z), radius }
    }
}

/// The rows of one table on their way into the array of all.
pub(super) struct TableRows<'r, T> {
    columns: &'r [Column],
    layout: Layout,
    /// What the values of each column may be.
    allowed: Vec<RangeInclusive<f32>>,
    rows: u64,
    /// The largest colour that a row may have.
    brightest: [f32; 3],
    all: &'r mut Vec<T>,
    pub(super) colors: Option<Colors>,
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

impl<'r, T: Row> TableRows<'r, T> {
    /// `rows` of a table whose file has these columns, and colours up to `brightest`.
    pub(super) fn new(
        columns: &'r [Column],
        colors: ColorStorage,
        rows: u64,
        brightest: [f32; 3],
        all: &'r mut Vec<T>,
    ) -> Result<Self> {
        let layout = Layout::new(columns);
        let colors = layout.color.map(|_| room_for_colors(colors, rows)).transpose()?;
        let allowed = columns.iter().map(|&column| allowed(column, brightest)).collect();
        Ok(Self { columns, layout, allowed, rows, brightest, all, colors })
    }

    /// Reads the file; what is wrong with it or its rows is the error.
    pub(super) fn read(&mut self, path: &Path) -> std::result::Result<(), Complaint> {
        let trouble = |error| unreadable(path, &error);
        let mut file = File::open(path).map_err(trouble)?;
        let row = self.layout.bytes();
        let at_once = (CHUNK / row).min(self.rows as usize);
        let [mut taken, mut coming] = [(); 2].map(|()| vec![0; at_once * row]);
        let (mut flaws, mut first_flaw) = (Flaws::default(), None);
        let (mut done, mut left) = (0, self.rows as usize - at_once);
        file.read_exact(&mut coming).map_err(trouble)?;
        while !coming.is_empty() {
            std::mem::swap(&mut taken, &mut coming);
            let next = at_once.min(left);
            coming.resize(next * row, 0);
            // The next rows come from the disk while these are looked through.
            let (came, found) = rayon::join(|| file.read_exact(&mut coming), || self.take(&taken));
            came.map_err(trouble)?;
            if let (None, Some(at)) = (flaws.first, found.first) {
                first_flaw = Some(self.tell(&taken[at * row..], done + at));
            }
            flaws = flaws.join(found);
            done += taken.len() / row;
            left -= next;
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
        let rows = chunk.par_chunks_exact(self.layout.bytes()).with_min_len(1024);
        let flaw = |(number, row)| Flaws::of_row(number, self.flaw_in(row).is_some());
        let flaws = rows.clone().enumerate().map(flaw).reduce(Flaws::default, Flaws::join);
        let sphere = self.layout.sphere;
        // Adding 0 turns -0 into 0: they are one place.
        let numbers = |row| sphere.map(|column| f64::from(value(row, column) + 0.0));
        self.all.par_extend(rows.clone().map(|row| T::of(numbers(row))));
        // Only colours that are allowed can be packed.
        if let (Some(colors), Some(color), 0) = (&mut self.colors, self.layout.color, flaws.count) {
            let given = rows.map(|row| color.map(|column| value(row, column) + 0.0));
            colors.extend(given, self.brightest);
        }
        flaws
    }

    /// The first column whose value cannot be.
    fn flaw_in(&self, row: &[u8]) -> Option<usize> {
        let is_wrong = |(column, allowed): (usize, &RangeInclusive<f32>)| {
            !allowed.contains(&value(row, column))
        };
        self.allowed.iter().enumerate().position(is_wrong)
    }

    /// Tells of the flaw in a row.
    fn tell(&self, row: &[u8], number: usize) -> String {
        let column = self.flaw_in(row).unwrap_or_default();
        let name = self.columns[column].name();
        let offset = (number * self.layout.columns + column) * VALUE;
        let allowed = &self.allowed[column];
        format!(
            "row {number} (the first is 0) has {name} = {:?} at byte {offset}; it must be from {} to \
             {}",
            value(row, column),
            in_words(*allowed.start()),
            in_words(*allowed.end()),
        )
    }
}

/// What the values of a column may be.
pub(super) fn allowed(column: Column, brightest: [f32; 3]) -> RangeInclusive<f32> {
    let largest = MAX_COORDINATE as f32;
    let [red, green, blue] = brightest;
    match column {
        Column::X | Column::Y | Column::Z => -largest..=largest,
        Column::Radius => SMALLEST_RADIUS as f32..=largest,
        Column::Red => 0.0..=red,
        Column::Green => 0.0..=green,
        Column::Blue => 0.0..=blue,
    }
}

/// The shortest number that reads back as the same f32.
pub(super) fn in_words(x: f32) -> String {
    let is_handy = x == 0.0 || (1e-4..1e6).contains(&x.abs());
    if is_handy { x.to_string() } else { format!("{x:e}") }
}
