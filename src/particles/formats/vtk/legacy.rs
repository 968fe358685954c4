//! The legacy VTK format: points with their data, as text or big-endian numbers.

use crate::particles::binary::{Data, NumberKind};
use crate::particles::budget::Budget;
use crate::particles::format::Format;
use crate::particles::model::Particles;
use crate::particles::request::{ReadRequest, Survey};
use crate::particles::source::Source;
use crate::particles::trouble::{Outcome, Trouble, shown};

use super::array::{Array, MAX_COMPONENTS};
use super::legacy_text::Cursor;

/// What was found: the points, and the arrays with a row for each of them. The bytes are kept of
/// arrays that are wanted.
#[derive(Default)]
struct Found {
    title: String,
    count: u64,
    points: Option<(Array, Vec<u8>)>,
    arrays: Vec<(Array, Option<Vec<u8>>)>,
    is_binary: bool,
}

/// What the arrays of a section belong to.
#[derive(Clone, Copy, PartialEq)]
enum Owner {
    Mesh,
    Points,
    Cells,
}

/// Reads the points.
pub(in crate::particles) fn read_legacy(
    source: Source,
    request: &ReadRequest,
) -> Outcome<Particles> {
    let path = source.path.clone();
    let budget = Budget::new(request.memory_limit);
    let bytes = load(source, budget)?;
    let found = find(&bytes, &|array| array.names().iter().any(|n| request.columns.has(n)))?;
    drop(bytes);
    let names: Vec<String> = found.arrays.iter().flat_map(|(array, _)| array.names()).collect();
    request.columns.check(names.iter().map(|name| &**name))?;
    let Some((array, bytes)) = found.points else {
        return Err(Trouble::new("it has no `POINTS`").into());
    };
    let (rows, is_big) = (found.count, found.is_binary);
    let data = Data::from_bytes(path.clone(), bytes);
    let positions = array.positions(&data, is_big, rows, budget)?;
    let mut columns = Vec::new();
    for (array, bytes) in found.arrays {
        let Some(bytes) = bytes else { continue };
        let data = Data::from_bytes(path.clone(), bytes);
        columns.extend(array.columns(&data, is_big, rows, &request.columns, budget)?);
    }
    let title = Some(found.title).filter(|title| !title.is_empty());
    Ok(Particles { columns, title, ..Particles::new(path, Format::Vtk, positions) })
}

/// Tells what the points are.
pub(in crate::particles) fn survey_legacy(
    source: Source,
    request: &ReadRequest,
) -> Outcome<Survey> {
    let survey = Survey::new(&source, Format::Vtk);
    let bytes = load(source, Budget::new(request.memory_limit))?;
    let found = find(&bytes, &|_| false)?;
    let fits = found.points.as_ref().is_none_or(|(array, _)| array.kind.fits_f32());
    Ok(Survey {
        frames: Some(1),
        count: Some(found.count),
        columns: found.arrays.iter().flat_map(|(array, _)| array.infos()).collect(),
        title: Some(found.title).filter(|title| !title.is_empty()),
        position_bytes: if fits { 12 } else { 24 },
        ..survey
    })
}

fn load(source: Source, budget: Budget) -> Outcome<Vec<u8>> {
    let Source { path, head, rest, .. } = source;
    Data::collect(&path, head, rest, budget)
}

fn find(bytes: &[u8], is_wanted: &dyn Fn(&Array) -> bool) -> Outcome<Found> {
    let mut cursor = Cursor::new(bytes);
    cursor.line();
    let title = String::from_utf8_lossy(cursor.line().unwrap_or_default()).trim().to_owned();
    let mut found = Found { title, ..Found::default() };
    let encoding = cursor.words().unwrap_or_default();
    match encoding.first().map(String::as_str) {
        Some("ASCII") => {}
        Some("BINARY") => cursor.is_binary = true,
        other => {
            let other = shown(other.unwrap_or_default().as_bytes());
            return Err(Trouble::at(3, format!("expected ASCII or BINARY, found {other}")).into());
        }
    }
    found.is_binary = cursor.is_binary;
    let mut section = Section { owner: Owner::Mesh, rows: 0 };
    while let Some(words) = cursor.words() {
        section.read(&words, &mut cursor, &mut found, is_wanted)?;
    }
    Ok(found)
}

struct Section {
    owner: Owner,
    rows: u64,
}

impl Section {
    /// Reads what a line begins.
    fn read(
        &mut self,
        words: &[String],
        cursor: &mut Cursor<'_>,
        found: &mut Found,
        is_wanted: &dyn Fn(&Array) -> bool,
    ) -> Outcome<()> {
        let short: Vec<&str> = words.iter().map(String::as_str).collect();
        let wrong = |expected: &str, cursor: &Cursor<'_>| {
            let found = shown(words.join(" ").as_bytes());
            let message = format!("expected {expected}, found {found}");
            Trouble::at(cursor.line_number().saturating_sub(1), message)
        };
        let keyword = short[0].to_ascii_uppercase();
        match (&*keyword, &short[1..]) {
            ("DATASET", [kind, ..]) => match kind.to_ascii_uppercase().as_str() {
                "POLYDATA" | "UNSTRUCTURED_GRID" | "STRUCTURED_GRID" => {}
                _ => {
                    return Err(
                        wrong("POLYDATA, UNSTRUCTURED_GRID or STRUCTURED_GRID", cursor).into()
                    );
                }
            },
            ("DIMENSIONS", _) => {}
            ("METADATA", _) => cursor.skip_paragraph(),
            ("POINTS", [count, kind]) => {
                let wrong = || wrong("`POINTS number type`", cursor);
                found.count = count.parse().map_err(|_| wrong())?;
                let kind = number_kind(kind).ok_or_else(wrong)?;
                let name = "Points".to_owned();
                let array = Array { name, kind, components: 3, range: None };
                let numbers = cursor.numbers(found.count.saturating_mul(3), kind)?;
                found.points = Some((array, numbers));
            }
            ("VERTICES" | "LINES" | "POLYGONS" | "TRIANGLE_STRIPS" | "CELLS", [first, second]) => {
                let numbers = [first.parse::<u64>(), second.parse::<u64>()];
                let [Ok(first), Ok(second)] = numbers else {
                    return Err(wrong("two numbers after the name of the cells", cursor).into());
                };
                skip_cells(cursor, first, second)?;
            }
            ("CELL_TYPES", [count]) => {
                let count = count.parse().map_err(|_| wrong("a number of cells", cursor))?;
                cursor.skip(count, NumberKind::I32)?;
            }
            ("POINT_DATA" | "CELL_DATA", [count]) => {
                self.rows = count.parse().map_err(|_| wrong("a number of rows", cursor))?;
                let is_points = keyword == "POINT_DATA";
                self.owner = if is_points { Owner::Points } else { Owner::Cells };
                if is_points && self.rows != found.count {
                    let expected = format!("data for {} points", found.count);
                    return Err(wrong(&expected, cursor).into());
                }
            }
            ("SCALARS", [name, kind, rest @ ..]) => {
                let components = rest.first().map_or(Ok(1), |count| count.parse());
                let components = components.map_err(|_| wrong("a number of components", cursor))?;
                cursor.line_with(b"LOOKUP_TABLE");
                self.array(name, kind, components, cursor, found, is_wanted)?;
            }
            ("VECTORS" | "NORMALS", [name, kind]) => {
                self.array(name, kind, 3, cursor, found, is_wanted)?;
            }
            ("TENSORS", [name, kind]) => self.array(name, kind, 9, cursor, found, is_wanted)?,
            ("TEXTURE_COORDINATES", [name, count, kind]) => {
                let components = count.parse().map_err(|_| wrong("a dimension", cursor))?;
                self.array(name, kind, components, cursor, found, is_wanted)?;
            }
            ("COLOR_SCALARS", [name, count]) => {
                let components = count.parse().map_err(|_| wrong("a number of values", cursor))?;
                let kind = if cursor.is_binary { "unsigned_char" } else { "float" };
                self.array(name, kind, components, cursor, found, is_wanted)?;
            }
            ("LOOKUP_TABLE", [_, count]) => {
                let count: u64 = count.parse().map_err(|_| wrong("a number of colours", cursor))?;
                let kind = if cursor.is_binary { NumberKind::U8 } else { NumberKind::F32 };
                cursor.skip(count.saturating_mul(4), kind)?;
            }
            ("FIELD", [_, count]) => {
                let count: u64 = count.parse().map_err(|_| wrong("a number of arrays", cursor))?;
                self.field(count, cursor, found, is_wanted)?;
            }
            _ => return Err(wrong("a keyword of a VTK file", cursor).into()),
        }
        Ok(())
    }

    /// Reads the arrays of a field.
    fn field(
        &self,
        count: u64,
        cursor: &mut Cursor<'_>,
        found: &mut Found,
        is_wanted: &dyn Fn(&Array) -> bool,
    ) -> Outcome<()> {
        let mut left = count;
        while left > 0 {
            let Some(words) = cursor.words() else {
                let message = format!("expected {left} more arrays, found the end of the file");
                return Err(Trouble::at(cursor.line_number(), message).into());
            };
            if words[0] == "METADATA" {
                cursor.skip_paragraph();
                continue;
            }
            left -= 1;
            let parsed = match &words[..] {
                [name, components, rows, kind] => {
                    components.parse().ok().zip(rows.parse().ok()).map(|both| (name, both, kind))
                }
                _ => None,
            };
            let Some((name, (components, rows), kind)) = parsed else {
                let found = shown(words.join(" ").as_bytes());
                let message =
                    format!("expected name, components, rows and type of an array, found {found}");
                return Err(Trouble::at(cursor.line_number().saturating_sub(1), message).into());
            };
            let own = Self { owner: self.owner, rows };
            if self.owner == Owner::Points && rows == found.count {
                own.array(name, kind, components, cursor, found, is_wanted)?;
            } else {
                Self { owner: Owner::Mesh, rows }
                    .array(name, kind, components, cursor, found, is_wanted)?;
            }
        }
        Ok(())
    }

    /// Reads an array of numbers, or moves past it.
    fn array(
        &self,
        name: &str,
        kind: &str,
        components: u64,
        cursor: &mut Cursor<'_>,
        found: &mut Found,
        is_wanted: &dyn Fn(&Array) -> bool,
    ) -> Outcome<()> {
        let line = cursor.line_number().saturating_sub(1);
        let Some(kind) = number_kind(kind) else {
            let message = format!("expected the type of numbers, found {}", shown(kind.as_bytes()));
            return Err(Trouble::at(line, message).into());
        };
        let count = self.rows.saturating_mul(components);
        let array = Array { name: decoded(name), kind, components, range: None };
        if self.owner != Owner::Points || !(1..=MAX_COMPONENTS).contains(&components) {
            return cursor.skip(count, kind);
        }
        let numbers = if is_wanted(&array) {
            Some(cursor.numbers(count, kind)?)
        } else {
            cursor.skip(count, kind)?;
            None
        };
        found.arrays.push((array, numbers));
        Ok(())
    }
}

/// Moves past cells: numbers of points with the points of each, or, from version 5 on, two arrays.
fn skip_cells(cursor: &mut Cursor<'_>, first: u64, second: u64) -> Outcome<()> {
    let mut arrays = 0;
    for (word, count) in [(&b"OFFSETS"[..], first), (b"CONNECTIVITY", second)] {
        if cursor.line_with(word) {
            arrays += 1;
            // The type is that of 64-bit integers unless the line says otherwise.
            cursor.skip(count, NumberKind::I64)?;
        }
    }
    if arrays == 0 {
        cursor.skip(second, NumberKind::I32)?;
    }
    Ok(())
}

fn number_kind(name: &str) -> Option<NumberKind> {
    Some(match name.to_ascii_lowercase().as_str() {
        "char" | "signed_char" => NumberKind::I8,
        "unsigned_char" => NumberKind::U8,
        "short" => NumberKind::I16,
        "unsigned_short" => NumberKind::U16,
        "int" => NumberKind::I32,
        "unsigned_int" => NumberKind::U32,
        "long" | "vtktypeint64" | "vtkidtype" => NumberKind::I64,
        "unsigned_long" | "vtktypeuint64" => NumberKind::U64,
        "float" => NumberKind::F32,
        "double" => NumberKind::F64,
        _ => return None,
    })
}

/// A name, in which VTK writes some characters as `%20`.
fn decoded(name: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = name.as_bytes();
    while let Some((&first, more)) = rest.split_first() {
        let code = (first == b'%').then(|| more.get(..2)).flatten();
        let code = code.and_then(|hex| std::str::from_utf8(hex).ok());
        let code = code.and_then(|hex| u8::from_str_radix(hex, 16).ok());
        bytes.push(code.unwrap_or(first));
        rest = if code.is_some() { &more[2..] } else { more };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
