//! Reads rows of binary numbers in parallel.

use rayon::prelude::*;

use crate::particles::budget::Budget;
use crate::particles::column::ColumnData;
use crate::particles::model::Positions;
use crate::particles::trouble::{Failure, Outcome, Trouble, plural};

use super::data::{Data, DataReader};
use super::number::{Number, NumberKind};
use super::output::{PositionsMut, ValuesMut};

/// Bytes that a task reads, about; they stay in the cache of a core.
const TASK_BYTES: u64 = 1 << 19;

/// Longest row.
const MAX_STRIDE: u64 = 1 << 20;

/// What to read.
#[derive(Clone, Debug, Default)]
pub(in crate::particles) struct Plan {
    /// Number of rows.
    pub(in crate::particles) rows: u64,
    /// The columns.
    pub(in crate::particles) columns: Vec<Number>,
    /// Where the numbers are.
    pub(in crate::particles) groups: Vec<Group>,
}

/// Numbers that lie in rows of their own.
#[derive(Clone, Debug)]
pub(in crate::particles) struct Group {
    /// Position of the first row.
    pub(in crate::particles) start: u64,
    /// Bytes from one row to the next.
    pub(in crate::particles) stride: u64,
    pub(in crate::particles) fields: Vec<BinaryField>,
}

/// One number of a row.
#[derive(Clone, Copy, Debug)]
pub(in crate::particles) struct BinaryField {
    /// Position in the row.
    pub(in crate::particles) offset: u64,
    pub(in crate::particles) number: Number,
    pub(in crate::particles) target: Target,
}

/// Where a number goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::particles) enum Target {
    /// A coordinate: 0 for x, 1 for y, 2 for z.
    Position(usize),
    /// A column.
    Column(usize),
}

impl Plan {
    fn fields(&self) -> impl Iterator<Item = &BinaryField> {
        self.groups.iter().flat_map(|group| &group.fields)
    }

    /// Returns true if the positions are read in f32.
    fn fits_f32(&self) -> bool {
        let is_position = |field: &&BinaryField| matches!(field.target, Target::Position(_));
        self.fields().filter(is_position).all(|field| field.number.kind.fits_f32())
    }

    fn has_positions(&self) -> bool {
        self.fields().any(|field| matches!(field.target, Target::Position(_)))
    }

    /// Refuses rows that the file cannot have, before any memory is taken for them.
    fn check(&self, data: &Data) -> Outcome<()> {
        for group in &self.groups {
            let Group { start, stride, fields } = group;
            let row = fields.iter().map(|field| field.offset + field.number.kind.bytes()).max();
            let row = row.unwrap_or(0);
            if row > *stride || *stride > MAX_STRIDE {
                let message = format!("it has rows of {stride} bytes, more than {MAX_STRIDE}");
                return Err(Trouble::new(message).into());
            }
            let what = plural(self.rows, "row");
            let bytes = self.rows.saturating_mul(*stride);
            data.part(*start, bytes, &format!("{what} of {stride} bytes"))?;
        }
        Ok(())
    }
}

/// Reads what the plan says. Coordinates that are not finite are an error.
pub(in crate::particles) fn read_plan(
    data: &Data,
    plan: &Plan,
    budget: Budget,
) -> Outcome<(Positions, Vec<ColumnData>)> {
    plan.check(data)?;
    let held: u64 = plan.columns.iter().map(|number| number.kind.held_bytes()).sum();
    let position = if plan.fits_f32() { 12 } else { 24 };
    budget.check(plan.rows.saturating_mul(held + position))?;
    let rows = plan.rows as usize;
    let centers = if plan.has_positions() { rows } else { 0 };
    let mut positions = match plan.fits_f32() {
        true => Positions::F32(vec![[0.0; 3]; centers]),
        false => Positions::F64(vec![[0.0; 3]; centers]),
    };
    let mut columns: Vec<_> = plan.columns.iter().map(|number| empty(number.kind, rows)).collect();
    for group in &plan.groups {
        read_group(data, group, rows, &mut positions, &mut columns)?;
    }
    Ok((positions.finite()?, columns))
}

/// A column for numbers of a type.
fn empty(kind: NumberKind, rows: usize) -> ColumnData {
    match kind {
        NumberKind::U8 => ColumnData::U8(vec![0; rows]),
        NumberKind::I8 | NumberKind::U16 | NumberKind::I16 | NumberKind::I32 => {
            ColumnData::I32(vec![0; rows])
        }
        NumberKind::U32 | NumberKind::I64 | NumberKind::U64 => ColumnData::I64(vec![0; rows]),
        NumberKind::F16 | NumberKind::F32 => ColumnData::F32(vec![0.0; rows]),
        NumberKind::F64 => ColumnData::F64(vec![0.0; rows]),
    }
}

/// The part of the output that a task fills.
struct Part<'a> {
    first_row: usize,
    rows: usize,
    positions: Option<PositionsMut<'a>>,
    /// Columns with the index of their field.
    columns: Vec<(usize, ValuesMut<'a>)>,
}

fn read_group(
    data: &Data,
    group: &Group,
    rows: usize,
    positions: &mut Positions,
    columns: &mut [ColumnData],
) -> Outcome<()> {
    let task_rows = (TASK_BYTES / group.stride.max(1)).max(1) as usize;
    let mut parts = Vec::new();
    let mut rest = whole(group, rows, positions, columns);
    while rest.rows > task_rows {
        let (part, more) = rest.split_at(task_rows);
        parts.push(part);
        rest = more;
    }
    if rest.rows > 0 {
        parts.push(rest);
    }
    let state = || (None, Vec::new());
    parts
        .into_par_iter()
        .try_for_each_init(state, |(reader, buffer), part| fill(data, group, part, reader, buffer))
}

fn whole<'a>(
    group: &Group,
    rows: usize,
    positions: &'a mut Positions,
    columns: &'a mut [ColumnData],
) -> Part<'a> {
    let has_position = group.fields.iter().any(|f| matches!(f.target, Target::Position(_)));
    let field_of = |column: usize| {
        group.fields.iter().position(|field| field.target == Target::Column(column))
    };
    let columns = columns.iter_mut().enumerate();
    let columns = columns.filter_map(|(at, data)| Some((field_of(at)?, ValuesMut::new(data)?)));
    Part {
        first_row: 0,
        rows,
        columns: columns.collect(),
        positions: has_position.then(|| PositionsMut::new(positions)),
    }
}

impl<'a> Part<'a> {
    fn split_at(self, rows: usize) -> (Self, Self) {
        let (positions, more_positions) = match self.positions {
            Some(positions) => {
                let (first, rest) = positions.split_at(rows);
                (Some(first), Some(rest))
            }
            None => (None, None),
        };
        let split = |(field, values): (usize, ValuesMut<'a>)| {
            let (first, rest) = values.split_at(rows);
            ((field, first), (field, rest))
        };
        let (columns, more_columns) = self.columns.into_iter().map(split).unzip();
        let first = Self { first_row: self.first_row, rows, positions, columns };
        let rest = Self {
            first_row: self.first_row + rows,
            rows: self.rows - rows,
            positions: more_positions,
            columns: more_columns,
        };
        (first, rest)
    }
}

fn fill(
    data: &Data,
    group: &Group,
    mut part: Part<'_>,
    reader: &mut Option<DataReader>,
    buffer: &mut Vec<u8>,
) -> Outcome<()> {
    let stride = group.stride as usize;
    let failure = |error| -> Failure { data.failure(error) };
    let reader = match reader {
        Some(reader) => reader,
        None => reader.insert(data.reader().map_err(failure)?),
    };
    buffer.resize(part.rows * stride, 0);
    let start = group.start + part.first_row as u64 * group.stride;
    reader.read_at(start, buffer).map_err(failure)?;
    for field in &group.fields {
        if let (Target::Position(axis), Some(positions)) = (field.target, &mut part.positions) {
            positions.fill(axis, &buffer[field.offset as usize..], stride, field.number);
        }
    }
    for (field, values) in &mut part.columns {
        let field = group.fields[*field];
        values.fill(&buffer[field.offset as usize..], stride, field.number);
    }
    Ok(())
}
