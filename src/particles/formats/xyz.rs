//! XYZ and extended XYZ: a line with the number of atoms, a comment, and a line for each atom.
//!
//! In extended XYZ the comment has keys with values: `Lattice` is the cell, `Properties` says what
//! the columns are.

use crate::particles::elements::symbol;
use crate::particles::format::Format;
use crate::particles::frames::{FrameFormat, FrameHead};
use crate::particles::text::{
    Field, FieldUse, Fields, Input, Kind, LineParser, SpacedRows, float, integer, tokens,
};
use crate::particles::trouble::{Outcome, Trouble, plural, shown, uncounted};

use super::extended_xyz;

/// XYZ, with names of the columns if the user gives them.
pub(in crate::particles) struct Xyz {
    pub(in crate::particles) names: Vec<String>,
}

impl FrameFormat for Xyz {
    const FORMAT: Format = Format::Xyz;

    fn head(&mut self, input: &mut Input) -> Outcome<Option<FrameHead>> {
        input.peek_filled_line()?;
        let Some(count) = input.next_line()? else { return Ok(None) };
        let line = input.line_number() - 1;
        let Some(count) = integer(count.trim().as_bytes()).and_then(|n| u64::try_from(n).ok())
        else {
            let found = shown(count.trim().as_bytes());
            let message = format!("expected the number of atoms, found {found}");
            return Err(Trouble::at(line, message).into());
        };
        let comment = input.expect_line("a comment")?;
        let mut head = extended_xyz::head(&comment).map_err(|m| Trouble::at(line + 1, m))?;
        (head.count, head.count_line) = (count, line);
        head.variant = if is_like_atom(&comment) { ATOM_FOR_COMMENT } else { 0 };
        if !self.names.is_empty() {
            head.fields = Fields(self.names.iter().map(|name| named(name)).collect());
        } else if head.fields.0.is_empty() {
            let first = if count > 0 { input.peek_line()? } else { None };
            head.fields = plain(first.unwrap_or_default());
        }
        Ok(Some(head))
    }

    fn check_end(&self, input: &mut Input, head: &FrameHead) -> Outcome<()> {
        let is_count = |line: &[u8]| integer(line.trim_ascii()).is_some();
        let next = input.peek_filled_line()?.filter(|line| !is_count(line)).map(<[u8]>::to_vec);
        let Some(next) = next else { return Ok(()) };
        let counted = format!("line {} counts {}", head.count_line, plural(head.count, "atom"));
        let expected = "the number of atoms of another frame, or the end of the file";
        Err(uncounted(input.line_number(), expected, &next, &counted))
    }

    fn advice(&self, head: &FrameHead) -> Option<String> {
        (head.variant == ATOM_FOR_COMMENT).then(|| {
            let line = head.count_line + 1;
            format!(
                "line {line} looks like an atom and is read as the comment: in an XYZ file, a \
                 comment, which may be empty, stands between the number of atoms and the first atom"
            )
        })
    }

    fn parser(&self, head: &FrameHead, fields: &Fields) -> Box<dyn LineParser> {
        debug_assert_eq!(head.fields.0.len(), fields.0.len());
        Box::new(SpacedRows::new(fields, true))
    }
}

/// The variant of frames whose comment looks like an atom.
const ATOM_FOR_COMMENT: usize = 1;

/// Returns true if a comment looks like an atom: a symbol or a number, and three coordinates.
fn is_like_atom(comment: &str) -> bool {
    let values: Vec<&[u8]> = tokens(comment.as_bytes()).collect();
    let [first, position @ ..] = &values[..] else { return false };
    let is_kind = integer(first).is_some()
        || std::str::from_utf8(first).is_ok_and(|first| symbol(first).is_some());
    is_kind && position.len() >= 3 && position[..3].iter().all(|value| float(value).is_some())
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
