//! Reads tables.

use crate::particles::budget::Budget;
use crate::particles::format::Format;
use crate::particles::model::Particles;
use crate::particles::request::{ReadRequest, Survey};
use crate::particles::source::Source;
use crate::particles::text::{
    Batch, FieldUse, Fields, Input, Kind, LineParser, Section, SpacedRows, read_rows,
};
use crate::particles::trouble::{Outcome, Trouble};

use super::rows::{Commented, DelimitedRows};
use super::sniff::{Dialect, sniff};

/// Reads a table. A column that turns out to have words after the rows that were looked at is read
/// once more, as words, if `open` can.
pub(in crate::particles) fn read(
    mut source: Source,
    open: &dyn Fn() -> Outcome<Source>,
    can_reopen: bool,
    request: &ReadRequest,
) -> Outcome<Particles> {
    let dialect = sniff(&source.head, source.is_short(), request)?;
    let format = format_of(&dialect);
    let path = source.path.clone();
    let mut fields = dialect.fields.clone().select(&request.columns)?;
    loop {
        let parser = parser(&dialect, &fields);
        let mut batch = Batch::new(fields.kinds());
        let mut input = Input::new(source);
        input.skip_lines(dialect.skipped_lines)?;
        let first_line = input.line_number();
        let budget = Budget::new(request.memory_limit);
        let lines = match read_rows(
            &mut input,
            parser.lines(),
            Section::Lines(u64::MAX),
            budget,
            &mut batch,
        ) {
            Ok(lines) => lines,
            Err(failure) => match parser.wrong_field() {
                Some(wrong) if can_reopen => {
                    fields.0[wrong].is = FieldUse::Column(Kind::Text);
                    source = open()?;
                    continue;
                }
                _ => return Err(failure),
            },
        };
        if batch.positions.is_empty() {
            return Err(Trouble::new("it has no rows").into());
        }
        let (positions, columns) = batch.finish(fields.names());
        let is_dense = positions.len() as u64 == lines;
        return Ok(Particles {
            columns,
            first_line: is_dense.then_some(first_line),
            ..Particles::new(path, format, positions)
        });
    }
}

/// Tells what is in a table.
pub(in crate::particles) fn survey(source: &Source, request: &ReadRequest) -> Outcome<Survey> {
    let dialect = sniff(&source.head, source.is_short(), request)?;
    Ok(Survey {
        frames: Some(1),
        columns: dialect.fields.infos(),
        ..Survey::new(source, format_of(&dialect))
    })
}

fn format_of(dialect: &Dialect) -> Format {
    if dialect.delimiter.is_some() { Format::Csv } else { Format::Table }
}

enum Parser {
    Delimited(DelimitedRows),
    Spaced(Commented<SpacedRows>),
}

fn parser(dialect: &Dialect, fields: &Fields) -> Parser {
    match dialect.delimiter {
        Some(delimiter) => {
            Parser::Delimited(DelimitedRows::new(fields, delimiter, dialect.has_decimal_comma))
        }
        None if dialect.has_decimal_comma => {
            Parser::Delimited(DelimitedRows::new(fields, b' ', true))
        }
        None => Parser::Spaced(Commented(SpacedRows::new(fields, false))),
    }
}

impl Parser {
    fn lines(&self) -> &dyn LineParser {
        match self {
            Self::Delimited(rows) => rows,
            Self::Spaced(rows) => rows,
        }
    }

    fn wrong_field(&self) -> Option<usize> {
        match self {
            Self::Delimited(rows) => rows.wrong_field(),
            Self::Spaced(rows) => rows.0.wrong_field(),
        }
    }
}
