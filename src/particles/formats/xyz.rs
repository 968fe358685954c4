//! XYZ and extended XYZ: a line with the number of atoms, a comment, and a line for each atom.
//!
//! In extended XYZ the comment has keys with values: `Lattice` is the cell, `Properties` says what
//! the columns are.

use crate::particles::format::Format;
use crate::particles::frames::{FrameFormat, FrameHead};
use crate::particles::text::{
    Field, FieldUse, Fields, Input, Kind, LineParser, SpacedRows, float, integer, tokens,
};
use crate::particles::trouble::{Outcome, Trouble, shown};

use super::extended_xyz;

/// XYZ, with names of the columns if the user gives them.
pub(in crate::particles) struct Xyz {
    pub(in crate::particles) names: Vec<String>,
}

impl FrameFormat for Xyz {
    const FORMAT: Format = Format::Xyz;

    fn head(&mut self, input: &mut Input) -> Outcome<Option<FrameHead>> {
        let Some(count) = first_filled_line(input)? else { return Ok(None) };
        let line = input.line_number() - 1;
        let Some(count) = integer(count.trim().as_bytes()).and_then(|n| u64::try_from(n).ok())
        else {
            let found = shown(count.trim().as_bytes());
            let message = format!("expected the number of atoms, found {found}");
            return Err(Trouble::at(line, message).into());
        };
        let comment = input.expect_line("a comment")?;
        let mut head = extended_xyz::head(&comment).map_err(|m| Trouble::at(line + 1, m))?;
        head.count = count;
        if !self.names.is_empty() {
            head.fields = Fields(self.names.iter().map(|name| named(name)).collect());
        } else if head.fields.0.is_empty() {
            let first = if count > 0 { input.peek_line()? } else { None };
            head.fields = plain(first.unwrap_or_default());
        }
        Ok(Some(head))
    }

    fn parser(&self, head: &FrameHead, fields: &Fields) -> Box<dyn LineParser> {
        debug_assert_eq!(head.fields.0.len(), fields.0.len());
        Box::new(SpacedRows::new(fields, true))
    }
}

/// Moves past empty lines.
fn first_filled_line(input: &mut Input) -> Outcome<Option<String>> {
    loop {
        match input.next_line()? {
            Some(line) if line.trim().is_empty() => {}
            other => return Ok(other),
        }
    }
}

/// A field with a name from the user: `x`, `y`, `z` are the position, `_` is left out.
fn named(name: &str) -> Field {
    match name {
        "_" => Field { name: String::new(), is: FieldUse::Skipped },
        "x" => Field::position(0),
        "y" => Field::position(1),
        "z" => Field::position(2),
        _ => Field::column(name, Kind::I32),
    }
}

/// The columns of plain XYZ: an element, or a number for a type, the position, and whatever comes
/// after it.
fn plain(first: &[u8]) -> Fields {
    let values: Vec<&[u8]> = tokens(first).collect();
    let are_numbers = values.iter().all(|value| float(value).is_some());
    let has_first = values.len() != 3 || !are_numbers;
    let mut fields = Vec::new();
    if has_first {
        let is_type = values.first().is_some_and(|value| integer(value).is_some());
        fields.push(match is_type {
            true => Field::column("type", Kind::I32),
            false => Field::column("element", Kind::Text),
        });
    }
    fields.extend([0, 1, 2].map(Field::position));
    let more = fields.len()..values.len();
    fields.extend(more.map(|at| Field::column(format!("column_{}", at + 1), Kind::I32)));
    Fields(fields)
}
