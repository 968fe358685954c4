//! Reads LAMMPS data files.

use crate::particles::budget::Budget;
use crate::particles::column::{Column, ColumnData};
use crate::particles::elements::symbol;
use crate::particles::format::Format;
use crate::particles::model::Particles;
use crate::particles::request::{ColumnInfo, ColumnKind, ReadRequest, Survey};
use crate::particles::source::Source;
use crate::particles::text::{
    Batch, Field, FieldUse, Fields, Input, Kind, LineParser, MarkedRow, Section, Separator,
    SpacedRows, Words, integer, read_rows,
};
use crate::particles::trouble::{Outcome, Trouble, plural, uncounted};

use super::head::{Head, read_head, values};
use super::style;

/// Reads the atoms.
pub(in crate::particles) fn read(source: Source, request: &ReadRequest) -> Outcome<Particles> {
    let path = source.path.clone();
    let budget = Budget::new(request.memory_limit);
    let mut input = Input::new(source);
    let head = read_head(&mut input)?;
    let (all, notes) = fields(&head, &mut input, request)?;
    let made = made_columns(&head);
    let infos = all.infos();
    let names = infos.iter().map(|info| &*info.name).chain(made.iter().copied());
    request.columns.check(names)?;
    let mut fields = all.select(&request.columns.without(made.iter().copied()))?;
    // Types give masses and elements.
    let needs_type = made.iter().any(|name| request.columns.has(name));
    if let (true, Some(field)) = (needs_type, fields.0.iter_mut().find(|f| f.name == "type")) {
        if field.is == FieldUse::Skipped {
            field.is = FieldUse::Column(Kind::Text);
        }
    }
    let rows = Uncommented(SpacedRows::new(&fields, false));
    let mut batch = Batch::new(fields.kinds());
    let first_line = input.line_number();
    let section = Section::Lines(head.count);
    let lines = read_rows(&mut input, &rows, section, budget, &mut batch)?;
    if lines < head.count {
        let expected = plural(head.count, "atom");
        let message = format!("expected {expected}, found {lines} and the end of the file");
        return Err(Trouble::at(input.line_number(), message).into());
    }
    let is_row = |line: &[u8]| line.trim_ascii_start().first().is_some_and(u8::is_ascii_digit);
    if let Some(next) = input.peek_filled_line()?.filter(|line| is_row(line)).map(<[u8]>::to_vec) {
        let counted = format!("the header counts {}", plural(head.count, "atom"));
        return Err(uncounted(
            input.line_number(),
            "the name of a section or the end",
            &next,
            &counted,
        ));
    }
    let (positions, mut columns) = batch.finish(fields.names());
    let kinds = columns.iter().find(|column| column.name == "type");
    let made = kinds.map(|kinds| make_columns(&head, &kinds.data)).unwrap_or_default();
    columns.extend(made);
    columns.retain(|column| request.columns.has(&column.name));
    Ok(Particles {
        columns,
        cell: head.cell,
        title: head.title,
        first_line: Some(first_line),
        notes,
        ..Particles::new(path, Format::LammpsData, positions)
    })
}

/// Tells what the atoms are.
pub(in crate::particles) fn survey(source: Source, request: &ReadRequest) -> Outcome<Survey> {
    let survey = Survey::new(&source, Format::LammpsData);
    let mut input = Input::new(source);
    let head = read_head(&mut input)?;
    let mut columns = fields(&head, &mut input, request)?.0.infos();
    columns.extend(made_columns(&head).iter().map(|name| ColumnInfo {
        name: (*name).to_owned(),
        kind: if *name == "mass" { ColumnKind::Float } else { ColumnKind::Text },
        range: None,
    }));
    Ok(Survey {
        frames: Some(1),
        count: Some(head.count),
        columns,
        cell: head.cell,
        title: head.title,
        ..survey
    })
}

/// A row that may end with a comment.
struct Uncommented(SpacedRows);

impl LineParser for Uncommented {
    fn parse(&self, line: &[u8], to: &mut Batch) -> Result<(), String> {
        let end = memchr::memchr(b'#', line).unwrap_or(line.len());
        self.0.parse(&line[..end], to)
    }

    fn separator(&self) -> Option<Separator> {
        self.0.separator()
    }

    fn parse_quickly(&self, row: MarkedRow<'_>, to: &mut Batch) -> Option<usize> {
        let lines = row.lines();
        let end = memchr::memchr2(b'#', b'\n', lines)?;
        if lines[end] == b'#' { None } else { self.0.parse_quickly(row, to) }
    }
}

/// The values of a row: named by the user, by the style of the section, or guessed. Also says what
/// was guessed.
fn fields(head: &Head, input: &mut Input, request: &ReadRequest) -> Outcome<(Fields, Vec<String>)> {
    let line = input.line_number();
    let first = match head.count {
        0 => Vec::new(),
        _ => input.peek_line()?.unwrap_or_default().to_vec(),
    };
    let first = values(&first);
    let own: Vec<&str> = request.names.iter().map(|name| &**name).collect();
    let mut notes = Vec::new();
    let mut names = if !own.is_empty() {
        own
    } else if let Some(style) = &head.style {
        style::columns(style).ok_or_else(|| {
            let known = style::names().join(", ");
            let message = format!("the style `{style}` of the atoms is not known");
            let help = format!("known are {known}; for others, name the columns");
            Trouble::at(line, message).with_help(help)
        })?
    } else if first.is_empty() {
        vec!["id", "type", "x", "y", "z"]
    } else {
        let style = style::guess(&first).ok_or_else(|| {
            let count = first.len();
            let message =
                format!("the style of the atoms is not named, and {count} values fit none");
            Trouble::at(line, message).with_help("name the columns, such as `id,type,x,y,z`")
        })?;
        notes.push(format!("the style of the atoms is not named; taken for `{style}`"));
        style::columns(style).unwrap_or_default()
    };
    let is_integer = |at: usize| first.get(at).is_some_and(|value| integer(value).is_some());
    if first.len() == names.len() + 3 && (names.len()..first.len()).all(is_integer) {
        names.extend(["ix", "iy", "iz"]);
    } else if head.style.as_deref() == Some("hybrid") {
        let more = (names.len()..first.len()).map(|_| "_");
        names.extend(more.collect::<Vec<_>>());
    }
    let field = |name: &&str| match *name {
        "x" => Field::position(0),
        "y" => Field::position(1),
        "z" => Field::position(2),
        "_" => Field { name: String::new(), is: FieldUse::Skipped },
        name => Field::column(name, Kind::I32),
    };
    let mut fields = Fields(names.iter().map(field).collect());
    let axes = fields.0.iter().filter(|field| matches!(field.is, FieldUse::Position(_))).count();
    if axes != 3 {
        return Err(Trouble::new("the named columns lack x, y or z").into());
    }
    fields.refine(&first.join(&b' '));
    Ok((fields, notes))
}

/// The columns that follow from types.
fn made_columns(head: &Head) -> Vec<&'static str> {
    let mut made = Vec::new();
    if !head.masses.is_empty() {
        made.push("mass");
    }
    let is_symbol = |(_, label): &(String, String)| symbol(label).is_some();
    if !head.labels.is_empty() && head.labels.iter().all(is_symbol) {
        made.push("element");
    }
    made
}

fn make_columns(head: &Head, kinds: &ColumnData) -> Vec<Column> {
    let column = |name: &'static str| {
        let data = match name {
            "mass" => {
                let mass = |kind: &str| head.masses.iter().find(|(known, _)| known == kind);
                let of = |kind: &str| mass(kind).map_or(f64::NAN, |(_, mass)| *mass);
                ColumnData::F64(each(kinds, of))
            }
            _ => {
                let label = |kind: &str| {
                    let label =
                        head.labels.iter().find(|(known, own)| known == kind || own == kind);
                    label.map_or(String::new(), |(_, label)| label.clone())
                };
                let mut words = Words::default();
                each(kinds, label).iter().for_each(|word| words.push(word.as_bytes()));
                ColumnData::Text(words.finish())
            }
        };
        Column { name: name.to_owned(), data }
    };
    made_columns(head).into_iter().map(column).collect()
}

/// A value for the type of each atom; the last type is remembered.
fn each<T: Clone>(kinds: &ColumnData, of: impl Fn(&str) -> T) -> Vec<T> {
    let mut last: Option<(String, T)> = None;
    let mut value = |row: usize| {
        let kind = kinds.show(row);
        if let Some((known, value)) = &last {
            if *known == kind {
                return value.clone();
            }
        }
        let value = of(&kind);
        last = Some((kind, value.clone()));
        value
    };
    (0..kinds.len()).map(&mut value).collect()
}
