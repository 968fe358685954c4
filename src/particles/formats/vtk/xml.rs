//! VTK files in XML. Arrays are text or base64 in the document, or lie behind it as base64 or as
//! they are; each may be compressed with zlib, in blocks.

use std::io::Read;

use flate2::read::ZlibDecoder;
use roxmltree::{Document, Node, ParsingOptions};

use crate::particles::binary::{Data, NumberKind};
use crate::particles::budget::Budget;
use crate::particles::column::{Column, ColumnData};
use crate::particles::format::Format;
use crate::particles::model::{Particles, Positions};
use crate::particles::request::{ReadRequest, Survey};
use crate::particles::source::Source;
use crate::particles::trouble::{Failure, Outcome, Trouble, shown};

use super::array::{Array, MAX_COMPONENTS, encode};
use super::base64::decode;

/// The start of the arrays behind the document.
const APPENDED: &[u8] = b"<AppendedData";

/// The most nodes of a document.
const MAX_NODES: u32 = 1 << 22;

/// A file: its document, and where the arrays behind it begin.
struct File {
    data: Data,
    text: String,
    /// Start of the arrays behind the document, and true if they are base64.
    appended: Option<(u64, bool)>,
    budget: Budget,
}

/// What the root of the document says of its arrays.
#[derive(Clone, Copy)]
struct Encoding {
    is_big_endian: bool,
    /// Bytes of the lengths before an array.
    length_bytes: usize,
    is_compressed: bool,
}

/// Reads the points of all pieces.
pub(in crate::particles) fn read_xml(
    source: Source,
    format: Format,
    request: &ReadRequest,
) -> Outcome<Particles> {
    let path = source.path.clone();
    let file = File::open(source, request)?;
    let document = file.document()?;
    let encoding = encoding(&document)?;
    let pieces = pieces(&document)?;
    let mut all: Option<(Positions, Vec<Column>)> = None;
    for (index, piece) in pieces.iter().enumerate() {
        if index == 0 {
            let infos = arrays(*piece)?.into_iter().flat_map(|(array, _)| array.infos());
            let names: Vec<String> = infos.map(|info| info.name).collect();
            request.columns.check(names.iter().map(|name| &**name))?;
        }
        let part = file.piece(*piece, encoding, request)?;
        all = Some(match all {
            None => part,
            Some(all) => join(all, part)?,
        });
    }
    let Some((positions, columns)) = all else {
        return Err(Trouble::new("it has no `Piece` with points").into());
    };
    let time = time(&document);
    Ok(Particles { columns, time, ..Particles::new(path, format, positions) })
}

/// Tells what the points are.
pub(in crate::particles) fn survey_xml(
    source: Source,
    format: Format,
    request: &ReadRequest,
) -> Outcome<Survey> {
    let mut survey = Survey::new(&source, format);
    let file = File::open(source, request)?;
    let document = file.document()?;
    let pieces = pieces(&document)?;
    let mut count = 0u64;
    for piece in &pieces {
        count = count.saturating_add(number_of(*piece, "NumberOfPoints")?);
    }
    survey.frames = Some(1);
    survey.count = Some(count);
    survey.time = time(&document);
    if let Some(piece) = pieces.first() {
        let infos = arrays(*piece)?.into_iter().flat_map(|(array, _)| array.infos());
        survey.columns = infos.collect();
        let fits = points(*piece)?.is_none_or(|(array, _)| array.kind.fits_f32());
        survey.position_bytes = if fits { 12 } else { 24 };
    }
    Ok(survey)
}

impl File {
    /// Finds the document, which ends where the arrays behind it begin.
    fn open(source: Source, request: &ReadRequest) -> Outcome<Self> {
        let budget = Budget::new(request.memory_limit);
        let data = Data::new(source, budget)?;
        let mut length = data.len().min(1 << 20);
        loop {
            budget.check(length)?;
            let head = data.bytes(0, length, "the document")?;
            if let Some(at) = memchr::memmem::find(&head, APPENDED) {
                let rest = &head[at..];
                let tag = memchr::memchr(b'>', rest).unwrap_or(0);
                if let Some(start) = memchr::memchr(b'_', &rest[tag..]) {
                    let is_base64 = memchr::memmem::find(&rest[..tag], b"base64").is_some();
                    let start = (at + tag + start + 1) as u64;
                    let text = format!("{}</VTKFile>", utf8(&head[..at])?);
                    return Ok(Self { data, text, appended: Some((start, is_base64)), budget });
                }
            }
            if length == data.len() {
                let text = utf8(&head)?.to_owned();
                return Ok(Self { data, text, appended: None, budget });
            }
            length = length.saturating_mul(8).min(data.len());
        }
    }

    fn document(&self) -> Outcome<Document<'_>> {
        let options = ParsingOptions { nodes_limit: MAX_NODES, ..ParsingOptions::default() };
        Document::parse_with_options(&self.text, options).map_err(|error| {
            let line = u64::from(error.pos().row);
            Trouble::at(line, format!("the XML is damaged: {error}")).into()
        })
    }

    /// Reads the points and the wanted columns of a piece.
    fn piece(
        &self,
        piece: Node<'_, '_>,
        encoding: Encoding,
        request: &ReadRequest,
    ) -> Outcome<(Positions, Vec<Column>)> {
        let rows = number_of(piece, "NumberOfPoints")?;
        let Some((array, node)) = points(piece)? else {
            return Err(Trouble::new("a `Piece` has no `Points`").into());
        };
        if rows == 0 {
            let infos = arrays(piece)?.into_iter().flat_map(|(array, _)| array.infos());
            let wanted = infos.filter(|info| request.columns.has(&info.name));
            let empty = |name| Column { name, data: ColumnData::F64(Vec::new()) };
            let columns = wanted.map(|info| empty(info.name)).collect();
            return Ok((Positions::F32(Vec::new()), columns));
        }
        let (data, is_big) = self.numbers(&array, node, encoding)?;
        let positions = array.positions(&data, is_big, rows, self.budget)?;
        let mut columns = Vec::new();
        for (array, node) in arrays(piece)? {
            if array.names().iter().any(|name| request.columns.has(name)) {
                let (data, is_big) = self.numbers(&array, node, encoding)?;
                columns.extend(array.columns(
                    &data,
                    is_big,
                    rows,
                    &request.columns,
                    self.budget,
                )?);
            }
        }
        Ok((positions, columns))
    }

    /// The numbers of an array, and true if they are big-endian.
    fn numbers(
        &self,
        array: &Array,
        node: Node<'_, '_>,
        encoding: Encoding,
    ) -> Outcome<(Data, bool)> {
        let path = self.data.path().to_owned();
        let is_big = encoding.is_big_endian;
        let text = || -> &[u8] { node.text().unwrap_or_default().trim().as_bytes() };
        match node.attribute("format").unwrap_or("ascii") {
            "ascii" => Ok((Data::from_bytes(path, encode(text(), array.kind)?), false)),
            "binary" => {
                let bytes = decode(text(), usize::MAX);
                let bytes = Data::from_bytes(path, bytes);
                Ok((self.unpack(&bytes, array, encoding)?, is_big))
            }
            "appended" => {
                let offset = number_of(node, "offset")?;
                let Some((start, is_base64)) = self.appended else {
                    return Err(Trouble::new("there is no `AppendedData`").into());
                };
                let start = start.saturating_add(offset);
                let rest = self.data.len().saturating_sub(start);
                let what = format!("the array `{}`", array.name);
                let part = self.data.part(start, rest, &what)?;
                if !is_base64 {
                    return Ok((self.unpack(&part, array, encoding)?, is_big));
                }
                let length = self.encoded_length(&part, encoding)?;
                self.budget.check(length)?;
                let bytes = decode(&part.bytes(0, length, &what)?, usize::MAX);
                let bytes = Data::from_bytes(path, bytes);
                Ok((self.unpack(&bytes, array, encoding)?, is_big))
            }
            other => {
                let found = shown(other.as_bytes());
                let message =
                    format!("expected the format ascii, binary or appended, found {found}");
                Err(Trouble::new(message).into())
            }
        }
    }

    /// The characters of an array in base64, of which the first ones say its length; those of a
    /// compressed array may be any that follow.
    fn encoded_length(&self, part: &Data, encoding: Encoding) -> Outcome<u64> {
        if encoding.is_compressed {
            return Ok(part.len());
        }
        let lead = part.bytes(0, part.len().min(16), "the length of an array")?;
        let length = decode(&lead, encoding.length_bytes);
        // The length may have padding of its own.
        let bytes = encoding.length(&length).saturating_add(16);
        Ok((bytes / 3).saturating_mul(4).saturating_add(16).min(part.len()))
    }

    /// The numbers behind the lengths that come first.
    fn unpack(&self, bytes: &Data, array: &Array, encoding: Encoding) -> Outcome<Data> {
        let what = format!("the array `{}`", array.name);
        let size = encoding.length_bytes;
        let lengths = |start: u64, count: u64| -> Outcome<Vec<u64>> {
            let all = bytes.bytes(start, count.saturating_mul(size as u64), &what)?;
            Ok(all.chunks_exact(size).map(|length| encoding.length(length)).collect())
        };
        if !encoding.is_compressed {
            let length = lengths(0, 1)?[0];
            return bytes.part(size as u64, length, &what);
        }
        let head = lengths(0, 3)?;
        let [blocks, block_bytes, last_bytes] = head[..] else { return Err(self.damaged(array)) };
        if blocks.saturating_mul(size as u64) > bytes.len() {
            return Err(self.damaged(array));
        }
        let packed = lengths(3 * size as u64, blocks)?;
        let mut at = (3 + blocks) * size as u64;
        let mut unpacked = Vec::new();
        for (index, length) in packed.iter().enumerate() {
            let is_last = index as u64 + 1 == blocks;
            let wanted = if is_last && last_bytes > 0 { last_bytes } else { block_bytes };
            let block = bytes.bytes(at, *length, &what)?;
            let read = ZlibDecoder::new(&block[..]).take(wanted).read_to_end(&mut unpacked);
            if read.map_err(|_| self.damaged(array))? as u64 != wanted {
                return Err(self.damaged(array));
            }
            self.budget.check(unpacked.len() as u64)?;
            at += length;
        }
        Ok(Data::from_bytes(self.data.path().to_owned(), unpacked))
    }

    fn damaged(&self, array: &Array) -> Failure {
        Trouble::new(format!("the compressed array `{}` is damaged", array.name)).into()
    }
}

impl Encoding {
    fn length(&self, bytes: &[u8]) -> u64 {
        let mut number = [0; 8];
        number[..bytes.len()].copy_from_slice(bytes);
        if self.is_big_endian {
            number[..bytes.len()].reverse();
        }
        u64::from_le_bytes(number)
    }
}

fn utf8(bytes: &[u8]) -> Outcome<&str> {
    std::str::from_utf8(bytes).map_err(|error| {
        let place = error.valid_up_to();
        Trouble::new(format!("expected UTF-8 in the XML, found another byte at {place}")).into()
    })
}

fn encoding(document: &Document<'_>) -> Outcome<Encoding> {
    let root = document.root_element();
    let is_compressed = match root.attribute("compressor") {
        None => false,
        Some("vtkZLibDataCompressor") => true,
        Some(other) => {
            let message = format!("its arrays are compressed by {}", shown(other.as_bytes()));
            let help = "save it with zlib, or without compression";
            return Err(Trouble::new(message).with_help(help).into());
        }
    };
    Ok(Encoding {
        is_big_endian: root.attribute("byte_order") == Some("BigEndian"),
        length_bytes: if root.attribute("header_type") == Some("UInt64") { 8 } else { 4 },
        is_compressed,
    })
}

fn pieces<'a, 'i>(document: &'a Document<'i>) -> Outcome<Vec<Node<'a, 'i>>> {
    let all = document.descendants().filter(|node| node.has_tag_name("Piece"));
    let mut all: Vec<_> = all.collect();
    if all.iter().any(|piece| piece.attribute("Source").is_some()) {
        let message = "it refers to pieces in other files, which are not read";
        let help = "read the pieces, or save the data as one file";
        return Err(Trouble::new(message).with_help(help).into());
    }
    // Pieces without points may lack their arrays.
    let has_points = |piece: &Node<'_, '_>| piece.attribute("NumberOfPoints") != Some("0");
    if all.iter().any(has_points) {
        all.retain(has_points);
    }
    Ok(all)
}

fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| child.has_tag_name(name))
}

/// The array with the points of a piece.
fn points<'a, 'i>(piece: Node<'a, 'i>) -> Outcome<Option<(Array, Node<'a, 'i>)>> {
    let node = child(piece, "Points").and_then(|points| child(points, "DataArray"));
    match node {
        Some(node) => Ok(array(node, "Points")?.map(|array| (array, node))),
        None => Ok(None),
    }
}

/// The arrays of numbers with one row for each point.
fn arrays<'a, 'i>(piece: Node<'a, 'i>) -> Outcome<Vec<(Array, Node<'a, 'i>)>> {
    let mut all = Vec::new();
    let Some(data) = child(piece, "PointData") else { return Ok(all) };
    for node in data.children().filter(|child| child.has_tag_name("DataArray")) {
        if let Some(array) = array(node, "")? {
            all.push((array, node));
        }
    }
    Ok(all)
}

/// An array; `None` if it has no numbers.
fn array(node: Node<'_, '_>, name: &str) -> Outcome<Option<Array>> {
    let kind = match node.attribute("type") {
        Some("Int8") => NumberKind::I8,
        Some("UInt8") => NumberKind::U8,
        Some("Int16") => NumberKind::I16,
        Some("UInt16") => NumberKind::U16,
        Some("Int32") => NumberKind::I32,
        Some("UInt32") => NumberKind::U32,
        Some("Int64") => NumberKind::I64,
        Some("UInt64") => NumberKind::U64,
        Some("Float32") => NumberKind::F32,
        Some("Float64") => NumberKind::F64,
        _ => return Ok(None),
    };
    let components = match node.attribute("NumberOfComponents") {
        Some(_) => number_of(node, "NumberOfComponents")?,
        None => 1,
    };
    if !(1..=MAX_COMPONENTS).contains(&components) {
        let message = format!("an array has {components} components, more than {MAX_COMPONENTS}");
        return Err(Trouble::new(message).into());
    }
    let bound = |name: &str| node.attribute(name).and_then(|text| text.trim().parse().ok());
    let range = bound("RangeMin").zip(bound("RangeMax")).map(|(low, high)| [low, high]);
    let name = node.attribute("Name").unwrap_or(name).to_owned();
    Ok(Some(Array { name, kind, components, range }))
}

fn number_of(node: Node<'_, '_>, name: &str) -> Outcome<u64> {
    let text = node.attribute(name).unwrap_or_default();
    text.trim().parse().map_err(|_| {
        let line = node.document().text_pos_at(node.range().start).row;
        let message = format!("expected a number for `{name}`, found {}", shown(text.as_bytes()));
        Trouble::at(u64::from(line), message).into()
    })
}

/// The time in the field data, if it is written as text.
fn time(document: &Document<'_>) -> Option<f64> {
    let node = document.descendants().find(|node| {
        node.has_tag_name("DataArray")
            && matches!(node.attribute("Name"), Some("TimeValue" | "TIME"))
    })?;
    let is_text = node.attribute("format").is_none_or(|format| format == "ascii");
    node.text().filter(|_| is_text)?.trim().parse().ok()
}

/// The points of two pieces, one after the other.
fn join(
    (mut positions, mut columns): (Positions, Vec<Column>),
    (more, more_columns): (Positions, Vec<Column>),
) -> Outcome<(Positions, Vec<Column>)> {
    let differs = || Failure::from(Trouble::new("its pieces have different arrays"));
    match (&mut positions, more) {
        (Positions::F32(all), Positions::F32(more)) => all.extend_from_slice(&more),
        (Positions::F64(all), Positions::F64(more)) => all.extend_from_slice(&more),
        _ => return Err(differs()),
    }
    if columns.len() != more_columns.len() {
        return Err(differs());
    }
    for (column, more) in columns.iter_mut().zip(more_columns) {
        if column.name != more.name || !column.data.append(more.data) {
            return Err(differs());
        }
    }
    Ok((positions, columns))
}
