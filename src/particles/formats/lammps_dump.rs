//! LAMMPS dumps as text.
//!
//! Coordinates are `x`, scaled `xs`, unwrapped `xu`, or scaled and unwrapped `xsu`; scaled ones
//! become Cartesian ones. Image flags stay columns.

use crate::math::DVec3;
use crate::particles::format::Format;
use crate::particles::frames::{FrameFormat, FrameHead};
use crate::particles::model::Cell;
use crate::particles::text::{
    Batch, Field, FieldUse, Fields, Input, Kind, LineParser, SpacedRows, float, integer, tokens,
};
use crate::particles::trouble::{Outcome, Trouble, plural, shown, uncounted};

/// The names of coordinates, in order of preference, and true for scaled ones.
const CONVENTIONS: [([&str; 3], bool); 4] = [
    (["x", "y", "z"], false),
    (["xs", "ys", "zs"], true),
    (["xu", "yu", "zu"], false),
    (["xsu", "ysu", "zsu"], true),
];

/// A dump, with names of the columns if the user gives them.
pub(in crate::particles) struct LammpsDump {
    pub(in crate::particles) names: Vec<String>,
}

impl FrameFormat for LammpsDump {
    const FORMAT: Format = Format::LammpsDump;

    fn head(&mut self, input: &mut Input) -> Outcome<Option<FrameHead>> {
        let (mut count, mut head, mut has_time) = (None, FrameHead::default(), false);
        let mut is_first = true;
        loop {
            let Some(line) = input.next_line()? else {
                if is_first {
                    return Ok(None);
                }
                let message = "expected `ITEM: ATOMS`, found the end of the file";
                return Err(Trouble::at(input.line_number(), message).into());
            };
            let number = input.line_number() - 1;
            if line.trim().is_empty() {
                continue;
            }
            is_first = false;
            let Some(item) = line.strip_prefix("ITEM: ") else {
                let found = shown(line.as_bytes());
                return Err(
                    Trouble::at(number, format!("expected `ITEM: ...`, found {found}")).into()
                );
            };
            let words: Vec<&str> = item.split_whitespace().collect();
            match words[..] {
                ["TIMESTEP"] => {
                    let step = number_of(input, "the time step")?;
                    if !has_time {
                        head.time = Some(step);
                    }
                }
                ["TIME"] => {
                    head.time = Some(number_of(input, "the time")?);
                    has_time = true;
                }
                ["UNITS"] => {
                    input.expect_line("the name of the units")?;
                }
                ["NUMBER", "OF", "ATOMS"] => {
                    count = Some(count_of(input)?);
                    head.count_line = input.line_number() - 1;
                }
                ["BOX", "BOUNDS", ref labels @ ..] => head.cell = Some(read_box(input, labels)?),
                ["ATOMS", ref names @ ..] => {
                    let Some(count) = count else {
                        let message = "expected `ITEM: NUMBER OF ATOMS` before `ITEM: ATOMS`";
                        return Err(Trouble::at(number, message).into());
                    };
                    head.count = count;
                    let own = || self.names.iter().map(|name| &**name).collect();
                    let names = if self.names.is_empty() { names.to_vec() } else { own() };
                    (head.fields, head.variant) =
                        fields(&names).map_err(|message| Trouble::at(number, message))?;
                    if head.variant == SCALED && head.cell.is_none() {
                        let message = "expected `ITEM: BOX BOUNDS` before scaled coordinates";
                        return Err(Trouble::at(number, message).into());
                    }
                    return Ok(Some(head));
                }
                _ => {
                    let expected = "TIMESTEP, UNITS, TIME, NUMBER OF ATOMS, BOX BOUNDS or ATOMS";
                    let message = format!("expected {expected}, found {}", shown(item.as_bytes()));
                    return Err(Trouble::at(number, message).into());
                }
            }
        }
    }

    fn check_end(&self, input: &mut Input, head: &FrameHead) -> Outcome<()> {
        let is_item = |line: &[u8]| line.starts_with(b"ITEM:");
        let next = input.peek_filled_line()?.filter(|line| !is_item(line)).map(<[u8]>::to_vec);
        let Some(next) = next else { return Ok(()) };
        let counted = format!("line {} counts {}", head.count_line, plural(head.count, "atom"));
        Err(uncounted(input.line_number(), "`ITEM: ...` or the end of the file", &next, &counted))
    }

    fn parser(&self, _: &FrameHead, fields: &Fields) -> Box<dyn LineParser> {
        Box::new(SpacedRows::new(fields, false))
    }

    fn finish(&self, head: &FrameHead, batch: &mut Batch) -> bool {
        let (SCALED, Some(cell)) = (head.variant, &head.cell) else { return false };
        for position in &mut batch.positions {
            *position = cell.point(*position).to_array();
        }
        true
    }
}

/// The variant of frames with scaled coordinates.
const SCALED: usize = 1;

fn number_of(input: &mut Input, what: &str) -> Outcome<f64> {
    let line = input.expect_line(what)?;
    let found = shown(line.as_bytes());
    let message = || format!("expected {what}, found {found}");
    let number = float(line.trim().as_bytes());
    Ok(number.ok_or_else(|| Trouble::at(input.line_number() - 1, message()))?)
}

fn count_of(input: &mut Input) -> Outcome<u64> {
    let line = input.expect_line("the number of atoms")?;
    let count = integer(line.trim().as_bytes()).and_then(|count| u64::try_from(count).ok());
    let found = shown(line.as_bytes());
    let message = || format!("expected the number of atoms, found {found}");
    Ok(count.ok_or_else(|| Trouble::at(input.line_number() - 1, message()))?)
}

/// The box: bounds along the axes, with three tilts if it is triclinic, whose bounds are those of
/// the tilted box; or, in a general triclinic box, three vectors and the origin.
fn read_box(input: &mut Input, labels: &[&str]) -> Outcome<Cell> {
    let is_general = labels.first() == Some(&"abc");
    let tilts = ["xy", "xz", "yz"].map(|tilt| labels.iter().position(|label| *label == tilt));
    let is_tilted = tilts.iter().all(Option::is_some);
    let width = if is_general {
        4
    } else if is_tilted {
        3
    } else {
        2
    };
    let mut rows = [[0.0; 4]; 3];
    for row in &mut rows {
        let line = input.expect_line("the bounds of the box")?;
        let numbers: Option<Vec<f64>> =
            tokens(line.as_bytes()).map(|token| float(token).filter(|x| x.is_finite())).collect();
        let numbers = numbers.filter(|numbers| numbers.len() == width).ok_or_else(|| {
            let expected = plural(width as u64, "number");
            let found = shown(line.as_bytes());
            let message = format!("expected {expected} that bound the box, found {found}");
            Trouble::at(input.line_number() - 1, message)
        })?;
        row[..width].copy_from_slice(&numbers);
    }
    let flags: Vec<bool> = labels
        .iter()
        .filter(|label| label.len() == 2 && label.bytes().all(|b| b"pfsm".contains(&b)))
        .map(|label| label.starts_with('p'))
        .collect();
    let periodic = match flags[..] {
        [a, b, c] => [a, b, c],
        _ => [true; 3],
    };
    if is_general {
        let vectors = rows.map(|[x, y, z, _]| DVec3::new(x, y, z));
        let origin = DVec3::from_array(rows.map(|[.., origin]| origin));
        return Ok(Cell { origin, vectors, periodic });
    }
    let tilt = |which: usize| tilts[which].and_then(|at| rows.get(at)).map_or(0.0, |row| row[2]);
    let [xy, xz, yz] = [0, 1, 2].map(tilt);
    let [[x_low, x_high, ..], [y_low, y_high, ..], [z_low, z_high, ..]] = rows;
    let least = |a: f64, b: f64| a.min(0.0) + b.min(0.0);
    let most = |a: f64, b: f64| a.max(0.0) + b.max(0.0);
    let origin = DVec3::new(x_low - least(xy, xz), y_low - least(yz, 0.0), z_low);
    let high = DVec3::new(x_high - most(xy, xz), y_high - most(yz, 0.0), z_high);
    let size = high - origin;
    let vectors =
        [DVec3::new(size.x, 0.0, 0.0), DVec3::new(xy, size.y, 0.0), DVec3::new(xz, yz, size.z)];
    Ok(Cell { origin, vectors, periodic })
}

/// The fields of a row, and whether its coordinates are scaled.
fn fields(names: &[&str]) -> Result<(Fields, usize), String> {
    let place = |name: &str| names.iter().position(|found| *found == name);
    let found = CONVENTIONS.iter().find_map(|(triple, is_scaled)| {
        let [x, y, z] = triple.map(place);
        Some(([x?, y?, z?], *is_scaled))
    });
    let Some((places, is_scaled)) = found else {
        let found = shown(names.join(" ").as_bytes());
        let expected = "x y z, xs ys zs, xu yu zu or xsu ysu zsu";
        return Err(format!("expected coordinates {expected} among the columns, found {found}"));
    };
    let field = |(at, name): (usize, &&str)| match places.iter().position(|&place| place == at) {
        Some(axis) => Field { is: FieldUse::Position(axis), name: (*name).to_owned() },
        None => Field::column(if *name == "_" { "" } else { name }, Kind::I32),
    };
    let mut fields: Vec<Field> = names.iter().enumerate().map(field).collect();
    for field in fields.iter_mut().filter(|field| field.name.is_empty()) {
        field.is = FieldUse::Skipped;
    }
    Ok((Fields(fields), if is_scaled { SCALED } else { 0 }))
}
