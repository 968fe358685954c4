//! Finds out how a table is written: its delimiter, its header, and what its columns are.

use crate::particles::request::ReadRequest;
use crate::particles::text::{
    Field, FieldUse, Fields, Kind, float, float_with_comma, integer, is_missing, tokens,
};
use crate::particles::trouble::{Trouble, plural};

use super::names::axis_of;
use super::rows::{Cells, is_comment};

/// Rows that are looked at.
const ROWS: usize = 100;

/// The most columns that a table may have.
const MAX_COLUMNS: usize = 4096;

/// How a table is written.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Dialect {
    /// The delimiter; `None` is white space.
    pub(super) delimiter: Option<u8>,
    pub(super) has_decimal_comma: bool,
    /// Lines before the first row.
    pub(super) skipped_lines: u64,
    pub(super) fields: Fields,
}

/// Looks at the beginning of a table, which is all of it if `is_whole`.
pub(super) fn sniff(
    head: &[u8],
    is_whole: bool,
    request: &ReadRequest,
) -> Result<Dialect, Trouble> {
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    let end =
        if is_whole { head.len() } else { memchr::memrchr(b'\n', head).unwrap_or(head.len()) };
    let lines: Vec<&[u8]> = head[..end].split(|&byte| byte == b'\n').map(trimmed).collect();
    let filled = lines.iter().zip(1u64..).filter(|(line, _)| !is_comment(line));
    let mut filled: Vec<(&[u8], u64)> = filled.map(|(line, at)| (*line, at)).take(ROWS).collect();
    if filled.is_empty() {
        return Err(Trouble::new("it has no rows"));
    }
    // A point cloud may begin with the number of its points.
    if filled.len() > 1 && is_count(filled[0].0) && tokens(filled[1].0).count() > 1 {
        filled.remove(0);
    }
    let (first, first_at) = filled[0];
    let delimiter = delimiter(&filled);
    let split = |line| split(line, delimiter);
    let count = split(first).len();
    if count == 0 {
        // Control characters part values, too.
        return Err(Trouble::at(first_at, "the first row has no values"));
    }
    if count > MAX_COLUMNS {
        let message = format!("it has {count} columns, more than {MAX_COLUMNS}");
        return Err(Trouble::at(first_at, message));
    }
    let table: Vec<Vec<&[u8]>> = filled.iter().map(|(line, _)| split(line)).collect();
    let has_decimal_comma = delimiter != Some(b',') && has_decimal_comma(&table);
    let is_number = |cell: &[u8]| {
        let number = if has_decimal_comma { float_with_comma(cell) } else { float(cell) };
        number.is_some() || is_missing(cell)
    };
    let has_header = has_header(&table, &is_number);
    let rows = &table[usize::from(has_header)..];
    let text = |cell: &[u8]| String::from_utf8_lossy(cell).trim().to_owned();
    let names: Vec<String> = if !request.names.is_empty() {
        request.names.clone()
    } else if has_header {
        table[0].iter().map(|cell| text(cell)).collect()
    } else {
        let before = lines[..first_at as usize - 1].iter().rev();
        let comment = before.clone().find(|line| !line.trim_ascii().is_empty());
        comment_names(comment.copied().unwrap_or_default(), delimiter, count)
            .unwrap_or_else(|| usual_names(rows, &is_number))
    };
    if names.len() != count {
        let (named, has) = (plural(names.len() as u64, "column"), plural(count as u64, "value"));
        return Err(Trouble::at(first_at, format!("{named} named, but its rows have {has}")));
    }
    let mut fields = fields(&names)?;
    for (at, field) in fields.0.iter_mut().enumerate() {
        if let FieldUse::Column(kind) = &mut field.is {
            *kind = kind_of(rows.iter().filter_map(|row| row.get(at).copied()), &is_number);
        }
    }
    let skipped_lines = first_at - 1 + u64::from(has_header);
    Ok(Dialect { delimiter, has_decimal_comma, skipped_lines, fields })
}

fn trimmed(line: &[u8]) -> &[u8] {
    line.strip_suffix(b"\r").unwrap_or(line)
}

fn split(line: &[u8], delimiter: Option<u8>) -> Vec<&[u8]> {
    match delimiter {
        Some(delimiter) => Cells::new(line, delimiter).collect(),
        None => tokens(line).collect(),
    }
}

fn is_count(line: &[u8]) -> bool {
    integer(line.trim_ascii()).is_some_and(|count| count >= 0)
}

/// The byte that parts the values: the first of these that every line has equally often.
fn delimiter(lines: &[(&[u8], u64)]) -> Option<u8> {
    let count = |line: &[u8], delimiter: u8| Cells::new(line, delimiter).count();
    let candidates = || b"\t;|,".iter().copied().filter(|&d| count(lines[0].0, d) > 1);
    let is_even = |d: &u8| {
        let first = count(lines[0].0, *d);
        lines.iter().all(|(line, _)| count(line, *d) == first)
    };
    candidates().find(is_even).or_else(|| candidates().max_by_key(|&d| count(lines[0].0, d)))
}

fn has_decimal_comma(table: &[Vec<&[u8]>]) -> bool {
    let is_one = |cell: &&[u8]| {
        cell.contains(&b',') && float(cell).is_none() && float_with_comma(cell).is_some()
    };
    table.iter().any(|row| row.iter().any(is_one))
}

/// A header has a word where the rows have numbers.
fn has_header(table: &[Vec<&[u8]>], is_number: &dyn Fn(&[u8]) -> bool) -> bool {
    let (first, rows) = (&table[0], &table[1..]);
    if rows.is_empty() {
        return !first.iter().any(|cell| is_number(cell));
    }
    let stands_out = |at: usize, cell: &[u8]| {
        !is_number(cell) && rows.iter().any(|row| row.get(at).is_some_and(|cell| is_number(cell)))
    };
    first.iter().enumerate().any(|(at, cell)| stands_out(at, cell))
}

/// The names in a comment just before the rows, if there is one for each value.
fn comment_names(comment: &[u8], delimiter: Option<u8>, count: usize) -> Option<Vec<String>> {
    let text = comment.trim_ascii_start();
    let text = text.strip_prefix(b"#").or_else(|| text.strip_prefix(b"//"))?;
    let text = text.trim_ascii_start();
    let names = |delimiter| -> Vec<String> {
        let cells = split(text, delimiter).into_iter();
        cells.map(|cell| String::from_utf8_lossy(cell).trim().to_owned()).collect()
    };
    let found = [delimiter, None, Some(b',')].into_iter().map(names);
    let mut found = found.filter(|names| names.len() == count);
    found.find(|names| names.iter().all(|name| float(name.as_bytes()).is_none()))
}

/// Names for values without any: a word first is an element; three numbers are the position; then
/// may follow an intensity and a colour.
fn usual_names(rows: &[Vec<&[u8]>], is_number: &dyn Fn(&[u8]) -> bool) -> Vec<String> {
    let count = rows[0].len();
    let starts_with_word = !is_number(rows[0][0]);
    let is_color = |at: usize| {
        let is_byte = |row: &Vec<&[u8]>| {
            row.get(at).and_then(|cell| integer(cell)).is_some_and(|x| (0..=255).contains(&x))
        };
        rows.iter().all(is_byte)
    };
    let mut names: Vec<String> = Vec::new();
    if starts_with_word {
        names.push("element".to_owned());
    }
    names.extend(["x", "y", "z"].map(str::to_owned));
    let colors = ["red", "green", "blue"].map(str::to_owned);
    match count - names.len().min(count) {
        3 if (0..3).all(|i| is_color(names.len() + i)) => names.extend(colors),
        4 if (1..4).all(|i| is_color(names.len() + i)) => {
            names.push("intensity".to_owned());
            names.extend(colors);
        }
        _ => {}
    }
    let more = names.len()..count;
    names.extend(more.map(|at| format!("column_{}", at + 1)));
    names
}

/// The fields with these names.
fn fields(names: &[String]) -> Result<Fields, Trouble> {
    let short: Vec<&str> = names.iter().map(|name| &**name).collect();
    let Some(places) = axis_of(&short) else {
        let named: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
        let help = "name all columns, such as `x,y,z,radius`, with `_` for one that is left out";
        let message = format!("there are no columns x, y and z among {}", named.join(", "));
        return Err(Trouble::new(message).with_help(help));
    };
    let field = |(at, name): (usize, &String)| match places.iter().position(|&place| place == at) {
        Some(axis) => Field { name: name.clone(), is: FieldUse::Position(axis) },
        None if name.is_empty() || name == "_" => {
            Field { name: String::new(), is: FieldUse::Skipped }
        }
        None => Field::column(name.clone(), Kind::I32),
    };
    Ok(Fields(names.iter().enumerate().map(field).collect()))
}

fn kind_of<'c>(cells: impl Iterator<Item = &'c [u8]>, is_number: &dyn Fn(&[u8]) -> bool) -> Kind {
    let mut kind = Kind::I32;
    for cell in cells {
        if !is_number(cell) {
            return Kind::Text;
        }
        if integer(cell).is_none() {
            kind = Kind::F64;
        }
    }
    kind
}
