//! PLY: the vertices are the particles, their properties the columns.
//!
//! Elements before the vertices are skipped, also those with lists. 3D Gaussian splats become
//! spheres: [`super::splats`].

use std::io::{BufReader, Read};

use crate::particles::binary::{Data, Number, NumberKind, Slot, Slots, named, read_plan};
use crate::particles::budget::Budget;
use crate::particles::format::Format;
use crate::particles::formats::table::axis_of;
use crate::particles::model::Particles;
use crate::particles::request::{ReadRequest, Survey};
use crate::particles::source::Source;
use crate::particles::text::{Batch, Field, Fields, Input, Kind, Section, SpacedRows, read_rows};
use crate::particles::trouble::{Outcome, Trouble, plural, shown, uncounted};

use super::splats;

/// Longest header.
const MAX_HEADER_BYTES: usize = 1 << 16;

/// How the numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Encoding {
    Text,
    Binary { is_big_endian: bool },
}

/// The header of a PLY file.
#[derive(Debug)]
struct Header {
    encoding: Encoding,
    elements: Vec<Element>,
    title: Option<String>,
    /// Bytes of the header, and its lines.
    bytes: usize,
    lines: u64,
}

#[derive(Debug)]
struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

#[derive(Debug)]
struct Property {
    name: String,
    kind: NumberKind,
    /// The type of the length, for a list.
    list: Option<NumberKind>,
}

/// Reads the vertices.
pub(in crate::particles) fn read(source: Source, request: &ReadRequest) -> Outcome<Particles> {
    let path = source.path.clone();
    let budget = Budget::new(request.memory_limit);
    let header = header(&source.head)?;
    let at = vertices(&header)?;
    let vertex = &header.elements[at];
    let splats = splats::Splats::find(vertex.properties.iter().map(|property| &*property.name));
    let wanted = match &splats {
        Some(splats) => splats.needs(&request.columns),
        None => request.columns.clone(),
    };
    let (positions, columns, first_line) = match header.encoding {
        Encoding::Text => {
            let fields = text_fields(vertex)?.select(&wanted)?;
            let before = header.elements[..at].iter().map(|element| element.count);
            let skipped = before.fold(header.lines, u64::saturating_add);
            let mut input = Input::new(source);
            input.skip_lines(skipped)?;
            let first_line = input.line_number();
            let mut batch = Batch::new(fields.kinds());
            let rows = SpacedRows::new(&fields, false);
            let lines =
                read_rows(&mut input, &rows, Section::Lines(vertex.count), budget, &mut batch)?;
            if lines < vertex.count {
                let expected = plural(vertex.count, "line");
                let message = format!("expected {expected} with vertices, found {lines}");
                return Err(Trouble::at(input.line_number(), message).into());
            }
            let is_last = at + 1 == header.elements.len();
            let next = input.peek_filled_line()?.filter(|_| is_last).map(<[u8]>::to_vec);
            if let Some(next) = next {
                let what = if vertex.count == 1 { "vertex" } else { "vertices" };
                let counted = format!("the header counts {} {what}", vertex.count);
                let (line, expected) = (input.line_number(), "the end of the file");
                return Err(uncounted(line, expected, &next, &counted));
            }
            let (positions, columns) = batch.finish(fields.names());
            (positions, columns, Some(first_line))
        }
        Encoding::Binary { is_big_endian } => {
            let data = Data::new(source, budget)?;
            let start = skip_elements(&data, &header, at, is_big_endian)?;
            let slots = slots(vertex, start, is_big_endian)?;
            let (plan, names) = slots.plan(vertex.count, &wanted)?;
            let (positions, columns) = read_plan(&data, &plan, budget)?;
            (positions, named(names, columns), None)
        }
    };
    let mut particles = Particles {
        columns,
        title: header.title,
        first_line,
        ..Particles::new(path, Format::Ply, positions)
    };
    if let Some(splats) = splats {
        splats.convert(&mut particles, &request.columns);
    }
    Ok(particles)
}

/// Tells what the vertices are.
pub(in crate::particles) fn survey(source: &Source) -> Outcome<Survey> {
    let header = header(&source.head)?;
    let vertex = &header.elements[vertices(&header)?];
    let slots = slots(vertex, 0, false)?;
    let mut columns = slots.infos();
    if let Some(splats) = splats::Splats::find(vertex.properties.iter().map(|p| &*p.name)) {
        columns = splats.infos(columns);
    }
    let is_text = header.encoding == Encoding::Text;
    Ok(Survey {
        frames: Some(1),
        count: Some(vertex.count),
        columns,
        title: header.title,
        position_bytes: if is_text { 24 } else { slots.position_bytes() },
        ..Survey::new(source, Format::Ply)
    })
}

fn header(head: &[u8]) -> Outcome<Header> {
    let head = &head[..head.len().min(MAX_HEADER_BYTES)];
    let (mut rest, mut line_number) = (head, 0);
    let mut header =
        Header { encoding: Encoding::Text, elements: Vec::new(), title: None, bytes: 0, lines: 0 };
    let mut has_encoding = false;
    loop {
        line_number += 1;
        let Some(end) = memchr::memchr(b'\n', rest) else {
            return Err(
                Trouble::at(line_number, "expected `end_header` in the first 64 KiB").into()
            );
        };
        let line = String::from_utf8_lossy(rest[..end].trim_ascii_end()).into_owned();
        rest = &rest[end + 1..];
        let words: Vec<&str> = line.split_whitespace().collect();
        let wrong = || {
            let message =
                format!("expected a line of a PLY header, found {}", shown(line.as_bytes()));
            Trouble::at(line_number, message)
        };
        match words[..] {
            ["ply"] if line_number == 1 => {}
            _ if line_number == 1 => return Err(wrong().into()),
            ["format", encoding, _] => {
                header.encoding = match encoding {
                    "ascii" => Encoding::Text,
                    "binary_little_endian" => Encoding::Binary { is_big_endian: false },
                    "binary_big_endian" => Encoding::Binary { is_big_endian: true },
                    _ => return Err(wrong().into()),
                };
                has_encoding = true;
            }
            ["comment" | "obj_info", ..] => {
                let text = line.trim_start_matches(char::is_alphabetic).trim();
                if header.title.is_none() && !text.is_empty() && words[0] == "comment" {
                    header.title = Some(text.to_owned());
                }
            }
            ["element", name, count] => {
                let count = count.parse().map_err(|_| wrong())?;
                let properties = Vec::new();
                header.elements.push(Element { name: name.to_owned(), count, properties });
            }
            ["property", ref words @ ..] => {
                let element = header.elements.last_mut().ok_or_else(wrong)?;
                element.properties.push(property(words).ok_or_else(wrong)?);
            }
            ["end_header"] if has_encoding => break,
            [] => {}
            _ => return Err(wrong().into()),
        }
    }
    header.bytes = head.len() - rest.len();
    header.lines = line_number;
    Ok(header)
}

fn property(words: &[&str]) -> Option<Property> {
    let (list, kind, name) = match *words {
        ["list", length, kind, name] => {
            (Some(number_kind(length).filter(|kind| !kind.is_float())?), kind, name)
        }
        [kind, name] => (None, kind, name),
        _ => return None,
    };
    Some(Property { name: name.to_owned(), kind: number_kind(kind)?, list })
}

fn number_kind(name: &str) -> Option<NumberKind> {
    Some(match name {
        "char" | "int8" => NumberKind::I8,
        "uchar" | "uint8" => NumberKind::U8,
        "short" | "int16" => NumberKind::I16,
        "ushort" | "uint16" => NumberKind::U16,
        "int" | "int32" => NumberKind::I32,
        "uint" | "uint32" => NumberKind::U32,
        "int64" | "long" => NumberKind::I64,
        "uint64" | "ulong" => NumberKind::U64,
        "float" | "float32" => NumberKind::F32,
        "double" | "float64" => NumberKind::F64,
        _ => return None,
    })
}

/// Index of the element with the vertices.
fn vertices(header: &Header) -> Outcome<usize> {
    let is_vertex = |element: &Element| matches!(&*element.name, "vertex" | "point" | "vertices");
    let at = header.elements.iter().position(is_vertex);
    let Some(at) = at else {
        return Err(Trouble::new("there is no `element vertex` in its header").into());
    };
    if let Some(list) = header.elements[at].properties.iter().find(|p| p.list.is_some()) {
        let message = format!("its vertices have a list, `{}`, which cannot be read", list.name);
        return Err(Trouble::new(message).into());
    }
    Ok(at)
}

/// The places of x, y and z among the properties.
fn axes(vertex: &Element) -> Outcome<[usize; 3]> {
    let names: Vec<&str> = vertex.properties.iter().map(|property| &*property.name).collect();
    let message = || format!("its vertices have no x, y and z among {}", names.join(", "));
    Ok(axis_of(&names).ok_or_else(|| Trouble::new(message()))?)
}

fn slots(vertex: &Element, start: u64, is_big_endian: bool) -> Outcome<Slots> {
    let places = axes(vertex)?;
    let mut offset = 0;
    let slot = |(at, property): (usize, &Property)| {
        let number = Number { kind: property.kind, is_big_endian };
        let axis = places.iter().position(|&place| place == at);
        let slot = Slot { name: property.name.clone(), number, group: 0, offset, axis };
        offset += property.kind.bytes();
        slot
    };
    let slots = vertex.properties.iter().enumerate().map(slot).collect();
    Ok(Slots { groups: vec![(start, offset)], slots })
}

fn text_fields(vertex: &Element) -> Outcome<Fields> {
    let places = axes(vertex)?;
    let field = |(at, property): (usize, &Property)| match places.iter().position(|&p| p == at) {
        Some(axis) => Field::position(axis),
        None => {
            let kind = if property.kind.is_float() { Kind::F64 } else { Kind::I32 };
            Field::column(property.name.clone(), kind)
        }
    };
    Ok(Fields(vertex.properties.iter().enumerate().map(field).collect()))
}

/// Position of the first vertex.
fn skip_elements(data: &Data, header: &Header, at: usize, is_big_endian: bool) -> Outcome<u64> {
    let mut place = header.bytes as u64;
    for element in &header.elements[..at] {
        let size = element.properties.iter().map(|property| property.kind.bytes()).sum::<u64>();
        if element.properties.iter().all(|property| property.list.is_none()) {
            place = place.saturating_add(element.count.saturating_mul(size));
            continue;
        }
        let rest = data.len().saturating_sub(place);
        let part = data.part(place, rest, &element.name)?;
        let reader = part.reader().map_err(|error| data.failure(error))?;
        let mut reader = BufReader::with_capacity(1 << 18, reader.take(rest));
        for _ in 0..element.count {
            place += skip_row(&mut reader, element, is_big_endian)
                .map_err(|error| data.failure(error))?;
        }
    }
    Ok(place)
}

/// Moves past one row with lists; returns its bytes.
fn skip_row(
    reader: &mut impl Read,
    element: &Element,
    is_big_endian: bool,
) -> std::io::Result<u64> {
    let mut bytes = 0;
    for property in &element.properties {
        let mut length = 1;
        if let Some(kind) = property.list {
            let mut number = [0; 8];
            let size = kind.bytes() as usize;
            reader.read_exact(&mut number[..size])?;
            if is_big_endian {
                number[..size].reverse();
            }
            length = u64::from_le_bytes(number);
            bytes += size as u64;
        }
        let size = length.saturating_mul(property.kind.bytes());
        let skipped = std::io::copy(&mut reader.by_ref().take(size), &mut std::io::sink())?;
        if skipped < size {
            return Err(std::io::ErrorKind::UnexpectedEof.into());
        }
        bytes += size;
    }
    Ok(bytes)
}
