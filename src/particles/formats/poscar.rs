//! VASP POSCAR, CONTCAR and XDATCAR: a comment, a scale, three vectors, the elements and how many
//! atoms of each there are, then a line for each atom. Lengths are in Å.
//!
//! An XDATCAR has frames, each below a line such as `Direct configuration= 1`.

use crate::math::DVec3;
use crate::particles::format::Format;
use crate::particles::frames::{FrameFormat, FrameHead};
use crate::particles::model::{Cell, LengthUnit};
use crate::particles::text::{
    Batch, Field, Fields, Input, LineParser, SpacedRows, float, integer, tokens,
};
use crate::particles::trouble::{Outcome, Trouble, shown};

/// The most elements that a file may list.
const MAX_SPECIES: usize = 4096;

/// Variants of a frame: fractions of the vectors, or Cartesian coordinates.
const DIRECT: usize = 0;
const CARTESIAN: usize = 1;

/// POSCAR and XDATCAR files.
#[derive(Default)]
pub(in crate::particles) struct Poscar {
    head: Option<FrameHead>,
    scale: f64,
    has_frames: bool,
}

impl FrameFormat for Poscar {
    const FORMAT: Format = Format::Poscar;
    const IS_REFINED: bool = false;

    fn head(&mut self, input: &mut Input) -> Outcome<Option<FrameHead>> {
        let is_next = |line: &[u8]| is_configuration(line);
        let continues = input.peek_line()?.is_some_and(is_next);
        match &self.head {
            // Velocities may follow the atoms of a POSCAR.
            Some(_) if !self.has_frames => return Ok(None),
            Some(head) if continues => {
                let head = head.clone();
                input.skip_lines(1)?;
                return Ok(Some(head));
            }
            _ => {}
        }
        let Some(title) = input.next_line()? else { return Ok(None) };
        if self.head.is_some() && title.trim().is_empty() {
            return Ok(None);
        }
        let mut head = self.first_head(input)?;
        head.title = Some(title.trim().to_owned()).filter(|title| !title.is_empty());
        self.head = Some(head.clone());
        Ok(Some(head))
    }

    fn parser(&self, _: &FrameHead, fields: &Fields) -> Box<dyn LineParser> {
        // Flags or symbols may follow.
        Box::new(SpacedRows::new(fields, true))
    }

    fn finish(&self, head: &FrameHead, batch: &mut Batch) -> bool {
        let Some(cell) = &head.cell else { return false };
        for position in &mut batch.positions {
            *position = match head.variant {
                DIRECT => cell.point(*position).to_array(),
                _ => position.map(|x| x * self.scale),
            };
        }
        true
    }
}

impl Poscar {
    /// Reads from the scale to the line before the atoms.
    fn first_head(&mut self, input: &mut Input) -> Outcome<FrameHead> {
        let scale = numbers(input, 1, "the scale")?[0];
        let mut rows = [DVec3::ZERO; 3];
        for row in &mut rows {
            *row = DVec3::from_slice(&numbers(input, 3, "a vector of the cell")?);
        }
        let unscaled = Cell { origin: DVec3::ZERO, vectors: rows, periodic: [true; 3] };
        // A negative scale is the volume of the cell.
        self.scale = if scale < 0.0 { libm::cbrt(-scale / unscaled.volume().abs()) } else { scale };
        if !self.scale.is_finite() || self.scale == 0.0 {
            let message = format!("expected a scale that is not 0, found {scale}");
            return Err(Trouble::at(input.line_number() - 4, message).into());
        }
        let vectors = rows.map(|row| row * self.scale);
        let (name, groups) = groups(input)?;
        let count = groups.iter().try_fold(0u64, |sum, (_, count)| sum.checked_add(*count));
        let line = input.line_number() - 1;
        let Some(count) = count else {
            return Err(Trouble::at(line, "expected numbers of atoms that fit 64 bits").into());
        };
        let mut mode = input.expect_line("`Direct` or `Cartesian`")?;
        if mode.trim_start().starts_with(['S', 's']) {
            mode = input.expect_line("`Direct` or `Cartesian`")?;
        }
        let variant = match mode.trim_start().bytes().next() {
            Some(b'C' | b'c' | b'K' | b'k') => CARTESIAN,
            Some(b'D' | b'd') => DIRECT,
            _ => {
                let found = shown(mode.as_bytes());
                let message = format!("expected `Direct` or `Cartesian`, found {found}");
                return Err(Trouble::at(input.line_number() - 1, message).into());
            }
        };
        self.has_frames = is_configuration(mode.as_bytes());
        Ok(FrameHead {
            count,
            fields: Fields([0, 1, 2].map(Field::position).to_vec()),
            cell: Some(Cell { vectors, ..unscaled }),
            unit: Some(LengthUnit::Angstrom),
            words: Some((name, groups)),
            variant,
            ..FrameHead::default()
        })
    }
}

fn is_configuration(line: &[u8]) -> bool {
    let line = line.to_ascii_lowercase();
    memchr::memmem::find(&line, b"configuration").is_some()
}

/// A line with this many numbers.
fn numbers(input: &mut Input, count: usize, what: &str) -> Outcome<Vec<f64>> {
    let line = input.expect_line(what)?;
    let all = tokens(line.as_bytes()).map(|token| float(token).filter(|x| x.is_finite()));
    let all: Vec<f64> = all.take(count).map_while(|x| x).collect();
    if all.len() == count {
        return Ok(all);
    }
    let message = format!("expected {what}, found {}", shown(line.as_bytes()));
    Err(Trouble::at(input.line_number() - 1, message).into())
}

/// The elements, or numbers of types where a file of VASP 4 names none, with the number of atoms of
/// each.
fn groups(input: &mut Input) -> Outcome<(&'static str, Vec<(String, u64)>)> {
    let first = input.expect_line("the elements")?;
    let counts_of = |line: &str| -> Option<Vec<u64>> {
        let counts = tokens(line.as_bytes()).map(integer);
        counts.map(|count| u64::try_from(count?).ok()).collect()
    };
    let (name, symbols, counts) = match counts_of(&first).filter(|counts| !counts.is_empty()) {
        Some(counts) => {
            let symbols = (1..=counts.len()).map(|at| at.to_string()).collect();
            ("type", symbols, Some(counts))
        }
        None => {
            let second = input.expect_line("the number of atoms of each element")?;
            // Names of potentials such as `Fe_pv` or `O/1b` begin with the symbol.
            let symbol = |word: &str| word.split(['_', '/']).next().unwrap_or(word).to_owned();
            let symbols: Vec<String> = first.split_whitespace().map(symbol).collect();
            ("element", symbols, counts_of(&second))
        }
    };
    let line = input.line_number() - 1;
    match counts.filter(|counts| counts.len() == symbols.len() && counts.len() <= MAX_SPECIES) {
        Some(counts) => Ok((name, symbols.into_iter().zip(counts).collect())),
        None => {
            let message = "expected the number of atoms of each element";
            Err(Trouble::at(line, message).into())
        }
    }
}
