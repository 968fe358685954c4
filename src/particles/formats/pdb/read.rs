//! Reads PDB and PQR files. Models are frames.

use crate::particles::budget::Budget;
use crate::particles::format::Format;
use crate::particles::model::{Cell, LengthUnit, Particles};
use crate::particles::request::{ColumnInfo, ColumnKind, ReadRequest, Survey, Wanted};
use crate::particles::source::Source;
use crate::particles::text::{
    Batch, Input, Kind, LineParser, Section, float, read_rows, skip_section,
};
use crate::particles::trouble::{Outcome, Trouble, plural, shown};

use super::altloc::{AtomColumns, keep_best};
use super::atoms::{PDB, PQR, PdbRows, PqrRows, is_atom, is_pqr, kind};

/// The columns that tell atoms with alternate locations apart.
const ATOM: AtomColumns<'static> = AtomColumns {
    location: "altloc",
    occupancy: "occupancy",
    keys: &["chain", "resid", "icode", "name"],
};

/// What stands before the atoms.
#[derive(Default)]
struct Head {
    title: Option<String>,
    cell: Option<Cell>,
}

/// Reads a model.
pub(in crate::particles) fn read(
    source: Source,
    frame: u64,
    request: &ReadRequest,
) -> Outcome<Particles> {
    let path = source.path.clone();
    let budget = Budget::new(request.memory_limit);
    let mut input = Input::new(source);
    let (head, is_pqr) = find(&mut input, frame)?;
    let names = if is_pqr { &PQR[..] } else { &PDB[..] };
    request.columns.check(names.iter().copied())?;
    let needed = |name: &str| {
        request.columns.has(name)
            || (!is_pqr && (ATOM.keys.contains(&name) || name == "altloc" || name == "occupancy"))
    };
    let columns: Vec<usize> = (0..names.len()).filter(|&at| needed(names[at])).collect();
    let mut batch = Batch::new(columns.iter().map(|&at| kind(names[at])));
    let parser: Box<dyn LineParser> = match is_pqr {
        true => Box::new(PqrRows { columns: columns.clone() }),
        false => Box::new(PdbRows { columns: columns.clone() }),
    };
    let first_line = input.line_number();
    let end = Section::Until(end_of_model);
    let lines = read_rows(&mut input, &*parser, end, budget, &mut batch)?;
    let (positions, columns) = batch.finish(columns.iter().map(|&at| names[at]));
    let is_dense = lines == positions.len() as u64;
    let mut particles = Particles {
        columns,
        cell: head.cell,
        frame,
        title: head.title,
        unit: Some(LengthUnit::Angstrom),
        first_line: is_dense.then_some(first_line),
        ..Particles::new(path, Format::Pdb, positions)
    };
    keep_best(&mut particles, &ATOM);
    if request.columns != Wanted::All {
        particles.columns.retain(|column| request.columns.has(&column.name));
    }
    Ok(particles)
}

/// Tells what is in a model.
pub(in crate::particles) fn survey(source: Source, frame: u64) -> Outcome<Survey> {
    let survey = Survey::new(&source, Format::Pdb);
    let (head, is_pqr) = find(&mut Input::new(source), frame)?;
    let names = if is_pqr { &PQR[..] } else { &PDB[..] };
    let info = |name: &&str| {
        let kind = match kind(name) {
            Kind::I32 | Kind::I64 => ColumnKind::Integer,
            Kind::F64 => ColumnKind::Float,
            Kind::Text => ColumnKind::Text,
        };
        ColumnInfo { name: (*name).to_owned(), kind, range: None }
    };
    Ok(Survey {
        columns: names.iter().map(info).collect(),
        cell: head.cell,
        title: head.title,
        unit: Some(LengthUnit::Angstrom),
        ..survey
    })
}

/// Counts the models.
pub(in crate::particles) fn count(source: Source) -> Outcome<u64> {
    let mut input = Input::new(source);
    let mut count = 0;
    while read_head(&mut input, &mut Head::default())? {
        skip_section(&mut input, Section::Until(end_of_model))?;
        count += 1;
    }
    Ok(count)
}

/// Finds the atoms of a model. Also returns true for a PQR file.
fn find(input: &mut Input, frame: u64) -> Outcome<(Head, bool)> {
    let (mut head, mut at) = (Head::default(), 0);
    while read_head(input, &mut head)? {
        if at == frame {
            let is_pqr = input.peek_line()?.is_some_and(is_pqr);
            return Ok((head, is_pqr));
        }
        skip_section(input, Section::Until(end_of_model))?;
        at += 1;
    }
    if at == 0 {
        return Err(Trouble::new("it has no atoms").into());
    }
    let has = plural(at, "model");
    Err(Trouble::new(format!("it has {has}, and no frame {frame} (the first is 0)")).into())
}

/// Reads up to the first atom of the next model; false if there is none.
fn read_head(input: &mut Input, head: &mut Head) -> Outcome<bool> {
    loop {
        let Some(line) = input.peek_line()? else { return Ok(false) };
        if is_atom(line) {
            return Ok(true);
        }
        if line.starts_with(b"CRYST1") {
            let cell = crystal(line);
            let found = shown(line);
            let message = || format!("expected lengths and angles of the cell, found {found}");
            head.cell = cell.ok_or_else(|| Trouble::at(input.line_number(), message()))?;
        } else if line.starts_with(b"TITLE") && head.title.is_none() {
            let text = String::from_utf8_lossy(line.get(10..).unwrap_or_default());
            head.title = Some(text.trim().to_owned()).filter(|title| !title.is_empty());
        }
        input.skip_lines(1)?;
    }
}

/// The cell; the inner value is `None` for the cube of side 1 that stands for no cell.
fn crystal(line: &[u8]) -> Option<Option<Cell>> {
    let number = |start: usize, end: usize| {
        let text = line.get(start..end.min(line.len()))?.trim_ascii();
        float(text).filter(|x| x.is_finite())
    };
    let lengths = [number(6, 15)?, number(15, 24)?, number(24, 33)?];
    let angles = [number(33, 40)?, number(40, 47)?, number(47, 54)?];
    let is_dummy = lengths.iter().all(|&length| length <= 1.0);
    Some((!is_dummy).then(|| Cell::from_lengths_and_angles(lengths, angles)))
}

/// Where a line begins with `END` or `ENDMDL`.
fn end_of_model(text: &[u8]) -> Option<usize> {
    if text.starts_with(b"END") {
        return Some(0);
    }
    memchr::memmem::find(text, b"\nEND").map(|at| at + 1)
}
