//! GROMACS GRO: a title, the number of atoms, atoms in columns of fixed width, and the box. Lengths
//! are in nanometres. The width of the coordinates follows from the first atom.

use crate::math::DVec3;
use crate::particles::format::Format;
use crate::particles::frames::{FrameFormat, FrameHead};
use crate::particles::model::{Cell, LengthUnit};
use crate::particles::text::{
    Batch, Field, FieldUse, Fields, Input, Kind, LineParser, float, integer, tokens,
};
use crate::particles::trouble::{Outcome, Trouble, plural, shown};

/// Bytes before the coordinates: residue number, residue name, atom name, atom number, five each.
const NAMES_WIDTH: usize = 20;

/// GRO files.
pub(in crate::particles) struct Gro;

impl FrameFormat for Gro {
    const FORMAT: Format = Format::Gro;
    const IS_REFINED: bool = false;

    fn head(&mut self, input: &mut Input) -> Outcome<Option<FrameHead>> {
        let Some(title) = input.next_line()? else { return Ok(None) };
        let is_last = input.peek_line()?.is_none();
        if is_last && title.trim().is_empty() {
            return Ok(None);
        }
        let count = input.expect_line("the number of atoms")?;
        let line = input.line_number() - 1;
        let number = integer(count.trim().as_bytes()).and_then(|n| u64::try_from(n).ok());
        let found = shown(count.as_bytes());
        let wrong = || Trouble::at(line, format!("expected the number of atoms, found {found}"));
        let count = number.ok_or_else(wrong)?;
        let atom = if count > 0 { input.peek_line()?.map(<[u8]>::to_vec) } else { None };
        let (width, has_velocities) = match atom {
            Some(atom) => widths(&atom).map_err(|message| Trouble::at(line + 1, message))?,
            None => (8, false),
        };
        let mut fields = vec![
            Field::column("resid", Kind::I32),
            Field::column("resname", Kind::Text),
            Field::column("name", Kind::Text),
            Field::column("atom_id", Kind::I32),
        ];
        fields.extend([0, 1, 2].map(Field::position));
        if has_velocities {
            fields.extend(["vx", "vy", "vz"].map(|name| Field::column(name, Kind::F64)));
        }
        Ok(Some(FrameHead {
            count,
            fields: Fields(fields),
            time: time_of(&title),
            title: Some(title.trim().to_owned()).filter(|title| !title.is_empty()),
            unit: Some(LengthUnit::Nanometre),
            count_line: line,
            variant: width,
            ..FrameHead::default()
        }))
    }

    fn parser(&self, head: &FrameHead, fields: &Fields) -> Box<dyn LineParser> {
        let uses = fields.0.iter().map(|field| field.is).collect();
        Box::new(GroRows { uses, width: head.variant })
    }

    fn tail(&mut self, input: &mut Input, head: &mut FrameHead) -> Outcome<()> {
        let line = input.expect_line("the box")?;
        let numbers: Option<Vec<f64>> =
            tokens(line.as_bytes()).map(|token| float(token).filter(|x| x.is_finite())).collect();
        let numbers = numbers.unwrap_or_default();
        let vectors = match numbers[..] {
            [x, y, z] => [DVec3::X * x, DVec3::Y * y, DVec3::Z * z],
            [ax, by, cz, ay, az, bx, bz, cx, cy] => {
                [DVec3::new(ax, ay, az), DVec3::new(bx, by, bz), DVec3::new(cx, cy, cz)]
            }
            _ => {
                let message =
                    format!("expected a box of 3 or 9 numbers, found {}", shown(line.as_bytes()));
                let counted = plural(head.count, "atom");
                let help = format!("line {} counts {counted}: are there more?", head.count_line);
                return Err(Trouble::at(input.line_number() - 1, message).with_help(help).into());
            }
        };
        let is_empty = vectors.iter().all(|vector| *vector == DVec3::ZERO);
        let cell = Cell { origin: DVec3::ZERO, vectors, periodic: [true; 3] };
        head.cell = (!is_empty).then_some(cell);
        Ok(())
    }
}

/// The width of a coordinate, which is that between two decimal points, and whether velocities
/// follow.
fn widths(atom: &[u8]) -> Result<(usize, bool), String> {
    let wrong = || format!("expected an atom in the columns of a GRO file, found {}", shown(atom));
    let numbers = atom.get(NAMES_WIDTH..).ok_or_else(wrong)?;
    let mut points = numbers.iter().enumerate().filter(|(_, byte)| **byte == b'.');
    let mut next = || points.next().map(|(at, _)| at).ok_or_else(wrong);
    let (first, second, third) = (next()?, next()?, next()?);
    let width = second - first;
    if third - second != width || width < 3 || numbers.len() < 3 * width {
        return Err(wrong());
    }
    // A velocity has one more decimal, in as many columns.
    Ok((width, numbers.len() >= 6 * width && points.next().is_some()))
}

/// The time in a title such as `Water t= 1.50000 step= 3`.
fn time_of(title: &str) -> Option<f64> {
    let (_, after) = title.rsplit_once("t=")?;
    float(after.split_whitespace().next()?.as_bytes())
}

struct GroRows {
    uses: Vec<FieldUse>,
    width: usize,
}

/// Names of the parts of a line, for messages.
const NAMES: [&str; 10] = [
    "the residue number",
    "a residue name",
    "an atom name",
    "the atom number",
    "x",
    "y",
    "z",
    "vx",
    "vy",
    "vz",
];

impl GroRows {
    fn part<'l>(&self, line: &'l [u8], at: usize) -> Option<&'l [u8]> {
        let (start, width) = match at {
            0..4 => (5 * at, 5),
            _ => (NAMES_WIDTH + (at - 4) * self.width, self.width),
        };
        let end = (start + width).min(line.len());
        Some(line.get(start..end)?.trim_ascii())
    }
}

impl LineParser for GroRows {
    fn parse(&self, line: &[u8], to: &mut Batch) -> Result<(), String> {
        let mut position = [0.0; 3];
        let mut columns = to.columns.iter_mut();
        for (at, is) in self.uses.iter().enumerate() {
            let part = self.part(line, at).unwrap_or_default();
            let is_right = match is {
                FieldUse::Skipped => true,
                FieldUse::Position(axis) => {
                    position[*axis] = float(part).unwrap_or(f64::NAN);
                    position[*axis].is_finite()
                }
                // Numbers wrap at 99,999, and other programs leave them out.
                FieldUse::Column(Kind::I32) => columns.next().is_some_and(|column| {
                    column.push_integer(integer(part).unwrap_or(-1));
                    true
                }),
                FieldUse::Column(_) => columns.next().is_some_and(|column| column.push(part)),
            };
            if !is_right {
                let place = 1 + if at < 4 { 5 * at } else { NAMES_WIDTH + (at - 4) * self.width };
                let found = shown(part);
                return Err(format!("expected {} in column {place}, found {found}", NAMES[at]));
            }
        }
        to.positions.push(position);
        Ok(())
    }
}
