//! Formats whose frames follow each other as text, each with a head that says how many lines its
//! particles take.

use super::budget::Budget;
use super::column::{Column, ColumnData};
use super::format::Format;
use super::model::{Cell, LengthUnit, Particles};
use super::request::{ColumnInfo, ColumnKind, ReadRequest, Survey};
use super::source::Source;
use super::text::{Batch, Fields, Input, LineParser, Section, Words, read_rows};
use super::trouble::{Outcome, Trouble, plural};

/// A format with frames.
pub(super) trait FrameFormat {
    /// The format.
    const FORMAT: Format;

    /// True if the first line with a particle tells words from numbers.
    const IS_REFINED: bool = true;

    /// Reads the head of the next frame; `None` at the end of the file.
    fn head(&mut self, input: &mut Input) -> Outcome<Option<FrameHead>>;

    /// The parser of the lines with particles.
    fn parser(&self, head: &FrameHead, fields: &Fields) -> Box<dyn LineParser>;

    /// Reads what follows the particles.
    fn tail(&mut self, _input: &mut Input, _head: &mut FrameHead) -> Outcome<()> {
        Ok(())
    }

    /// Checks that another frame follows, or the end: a count that is too small must not lose
    /// particles.
    fn check_end(&self, _input: &mut Input, _head: &FrameHead) -> Outcome<()> {
        Ok(())
    }

    /// What a mistake in a frame with this head may come from.
    fn advice(&self, _head: &FrameHead) -> Option<String> {
        None
    }

    /// Turns positions as they are in the file into Cartesian ones; false if they are already.
    fn finish(&self, _head: &FrameHead, _batch: &mut Batch) -> bool {
        false
    }
}

/// The head of a frame.
#[derive(Clone, Debug, Default)]
pub(super) struct FrameHead {
    /// Number of particles, each on a line.
    pub(super) count: u64,
    /// What is on a line.
    pub(super) fields: Fields,
    pub(super) cell: Option<Cell>,
    pub(super) time: Option<f64>,
    pub(super) title: Option<String>,
    pub(super) unit: Option<LengthUnit>,
    /// A column of words that are not in the lines, each with the number of particles that it is
    /// for, one group after the other.
    pub(super) words: Option<(&'static str, Vec<(String, u64)>)>,
    /// Line of the number of particles.
    pub(super) count_line: u64,
    /// What the format keeps for itself.
    pub(super) variant: usize,
}

/// Reads one frame; the first is 0.
pub(super) fn read<F: FrameFormat>(
    mut format: F,
    source: Source,
    frame: u64,
    request: &ReadRequest,
) -> Outcome<Particles> {
    let path = source.path.clone();
    let budget = Budget::new(request.memory_limit);
    let mut input = Input::new(source);
    let mut head = find(&mut format, &mut input, frame)?;
    refine::<F>(&mut head, &mut input)?;
    let words = head.words.iter().map(|(name, _)| *name);
    let infos = head.fields.infos();
    request.columns.check(infos.iter().map(|info| &*info.name).chain(words.clone()))?;
    let fields = head.fields.clone().select(&request.columns.without(words))?;
    let parser = format.parser(&head, &fields);
    let mut batch = Batch::new(fields.kinds());
    let first_line = input.line_number();
    let advice =
        |trouble: Trouble| Trouble { help: trouble.help.or(format.advice(&head)), ..trouble };
    let lines = read_rows(&mut input, &*parser, Section::Lines(head.count), budget, &mut batch)
        .map_err(|failure| failure.map(advice))?;
    check_lines(&input, lines, &head).map_err(|failure| failure.map(advice))?;
    let notes = format.advice(&head).into_iter().collect();
    format.tail(&mut input, &mut head)?;
    format.check_end(&mut input, &head)?;
    let is_changed = format.finish(&head, &mut batch);
    // A line each, in order.
    if let Some(row) =
        Some(&batch.positions[..]).filter(|_| is_changed).and_then(first_beyond_numbers)
    {
        let message = "the coordinates times the cell's edges are beyond all numbers";
        return Err(Trouble::at(first_line + row as u64, message).into());
    }
    let (positions, mut columns) = batch.finish(fields.names());
    if let Some((name, runs)) = head.words.filter(|(name, _)| request.columns.has(name)) {
        columns.push(Column { name: name.to_owned(), data: expand(&runs) });
    }
    Ok(Particles {
        path,
        format: F::FORMAT,
        positions,
        columns,
        cell: head.cell,
        frame,
        time: head.time,
        title: head.title,
        unit: head.unit,
        first_line: Some(first_line),
        notes,
    })
}

/// The first position that is not finite.
fn first_beyond_numbers(positions: &[[f64; 3]]) -> Option<usize> {
    let is_finite = |at: &[f64; 3]| at.iter().fold(true, |all, x| all & x.is_finite());
    // Many are looked at together, because a branch for each takes longer than to read them.
    let many = |some: &[[f64; 3]]| some.iter().fold(true, |all, at| all & is_finite(at));
    match positions.chunks(64).all(many) {
        true => None,
        false => positions.iter().position(|at| !is_finite(at)),
    }
}

/// Tells what is in one frame.
pub(super) fn survey<F: FrameFormat>(mut format: F, source: Source, frame: u64) -> Outcome<Survey> {
    let (path, compression) = (source.path.clone(), source.compression);
    let mut input = Input::new(source);
    let mut head = find(&mut format, &mut input, frame)?;
    refine::<F>(&mut head, &mut input)?;
    let mut columns = head.fields.infos();
    columns.extend(head.words.iter().map(|(name, _)| ColumnInfo {
        name: (*name).to_owned(),
        kind: ColumnKind::Text,
        range: None,
    }));
    Ok(Survey {
        path,
        format: F::FORMAT,
        compression,
        frames: None,
        count: Some(head.count),
        columns,
        cell: head.cell,
        time: head.time,
        title: head.title,
        unit: head.unit,
        position_bytes: 24,
    })
}

/// Counts the frames.
pub(super) fn count<F: FrameFormat>(mut format: F, source: Source) -> Outcome<u64> {
    let mut input = Input::new(source);
    let mut count = 0;
    while let Some(mut head) = format.head(&mut input)? {
        skip(&mut format, &mut input, &mut head)?;
        count += 1;
    }
    Ok(count)
}

/// The head of a frame, after all frames before it.
fn find<F: FrameFormat>(format: &mut F, input: &mut Input, frame: u64) -> Outcome<FrameHead> {
    let mut at = 0;
    while let Some(mut head) = format.head(input)? {
        if at == frame {
            return Ok(head);
        }
        skip(format, input, &mut head)?;
        at += 1;
    }
    if at == 0 {
        return Err(Trouble::new("it has no particles").into());
    }
    let has = plural(at, "frame");
    Err(Trouble::new(format!("it has {has}, and no frame {frame} (the first is 0)")).into())
}

fn skip<F: FrameFormat>(format: &mut F, input: &mut Input, head: &mut FrameHead) -> Outcome<()> {
    let lines = input.skip_lines(head.count)?;
    check_lines(input, lines, head)?;
    format.tail(input, head)?;
    format.check_end(input, head)
}

/// A column of words from groups that follow each other.
fn expand(runs: &[(String, u64)]) -> ColumnData {
    let mut words = Words::default();
    for (word, count) in runs {
        for _ in 0..*count {
            words.push(word.as_bytes());
        }
    }
    ColumnData::Text(words.finish())
}

fn check_lines(input: &Input, lines: u64, head: &FrameHead) -> Outcome<()> {
    if lines == head.count {
        return Ok(());
    }
    let (expected, found) = (plural(head.count, "line"), lines);
    let message = format!("expected {expected} with particles, found {found} and the end");
    Err(Trouble::at(input.line_number(), message).into())
}

/// Looks at the first particle to tell words from numbers.
fn refine<F: FrameFormat>(head: &mut FrameHead, input: &mut Input) -> Outcome<()> {
    if head.count > 0 && F::IS_REFINED {
        if let Some(line) = input.peek_line()? {
            head.fields.refine(line);
        }
    }
    Ok(())
}
