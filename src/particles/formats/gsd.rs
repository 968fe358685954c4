//! GSD, the format of HOOMD-blue: chunks of numbers with names, found through an index.
//!
//! A chunk that a frame lacks is that of frame 0 if both have equally many particles, and a default
//! otherwise. The box is centred at the origin.

use std::collections::HashMap;
use std::sync::Arc;

use crate::math::DVec3;
use crate::particles::binary::{Data, Number, NumberKind, Slot, Slots, named, read_plan};
use crate::particles::budget::Budget;
use crate::particles::column::{Categories, Column, ColumnData, component_name};
use crate::particles::format::Format;
use crate::particles::model::{Cell, Particles};
use crate::particles::request::{ColumnInfo, ColumnKind, ReadRequest, Survey, Wanted};
use crate::particles::source::Source;
use crate::particles::trouble::{Outcome, Trouble, plural};

const HEADER_BYTES: u64 = 256;
const ENTRY_BYTES: u64 = 32;

/// Bytes that a name takes, on average, in the list of names.
const NAME_BYTES: u64 = 64;

/// The most bytes of the index and of the names.
const MAX_INDEX_BYTES: u64 = 4 << 30;

/// The most columns that a chunk may have.
const MAX_WIDTH: u32 = 64;

/// A chunk of numbers.
#[derive(Clone, Copy, Debug)]
struct Chunk {
    rows: u64,
    width: u32,
    location: u64,
    kind: NumberKind,
}

/// The chunks of one frame, and of frame 0.
struct Frame {
    frames: u64,
    chunks: HashMap<String, Chunk>,
    first: HashMap<String, Chunk>,
    count: u64,
}

/// Chunks that become columns, in this order. Others of `log/particles/` follow.
const COLUMNS: [&str; 9] = [
    "mass",
    "charge",
    "diameter",
    "body",
    "velocity",
    "image",
    "orientation",
    "angmom",
    "moment_inertia",
];

/// Reads a frame.
pub(in crate::particles) fn read(
    source: Source,
    frame: u64,
    request: &ReadRequest,
) -> Outcome<Particles> {
    let path = source.path.clone();
    let budget = Budget::new(request.memory_limit);
    let data = Data::new(source, budget)?;
    let found = find(&data, frame, budget)?;
    let rows = found.count;
    let infos = infos(&found);
    request.columns.check(infos.iter().map(|info| &*info.name))?;
    let Some(position) = found.chunk("particles/position") else {
        return Err(Trouble::new("its frame has no `particles/position`").into());
    };
    let (plan, _) = slots("", position, Some(3))?.plan(rows, &Wanted::Only(Vec::new()))?;
    let (positions, _) = read_plan(&data, &plan, budget)?;
    let mut columns = Vec::new();
    if request.columns.has("type") {
        columns.push(types(&data, &found, budget)?);
    }
    for (name, chunk) in found.columns() {
        let all = slots(&name, chunk, None)?;
        let own = all.slots.iter().map(|slot| slot.name.clone());
        let own: Vec<String> = own.filter(|name| request.columns.has(name)).collect();
        if own.is_empty() {
            continue;
        }
        let (plan, names) = all.plan(rows, &Wanted::Only(own))?;
        let (_, values) = read_plan(&data, &plan, budget)?;
        columns.extend(named(names, values));
    }
    if found.chunk("particles/diameter").is_none() && request.columns.has("diameter") {
        let ones = ColumnData::F32(vec![1.0; positions.len()]);
        columns.push(Column { name: "diameter".to_owned(), data: ones });
    }
    Ok(Particles {
        columns,
        cell: cell(&data, &found)?,
        frame,
        time: step(&data, &found)?,
        ..Particles::new(path, Format::Gsd, positions)
    })
}

/// Tells what is in a frame.
pub(in crate::particles) fn survey(
    source: Source,
    frame: u64,
    request: &ReadRequest,
) -> Outcome<Survey> {
    let survey = Survey::new(&source, Format::Gsd);
    let budget = Budget::new(request.memory_limit);
    let data = Data::new(source, budget)?;
    let found = find(&data, frame, budget)?;
    let position = found.chunk("particles/position");
    let fits = position.is_none_or(|chunk| chunk.kind.fits_f32());
    Ok(Survey {
        frames: Some(found.frames),
        count: Some(found.count),
        columns: infos(&found),
        cell: cell(&data, &found)?,
        time: step(&data, &found)?,
        position_bytes: if fits { 12 } else { 24 },
        ..survey
    })
}

/// Counts the frames.
pub(in crate::particles) fn count(source: Source, request: &ReadRequest) -> Outcome<u64> {
    let budget = Budget::new(request.memory_limit);
    let data = Data::new(source, budget)?;
    Ok(find(&data, 0, budget)?.frames)
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    let mut number = [0; 8];
    number.copy_from_slice(&bytes[at..at + 8]);
    u64::from_le_bytes(number)
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    let mut number = [0; 4];
    number.copy_from_slice(&bytes[at..at + 4]);
    u32::from_le_bytes(number)
}

/// Reads the index, and finds the chunks of a frame.
fn find(data: &Data, frame: u64, budget: Budget) -> Outcome<Frame> {
    let header = data.bytes(0, HEADER_BYTES, "the header")?;
    let [index, entries, names, name_entries] = [8, 16, 24, 32].map(|at| u64_at(&header, at));
    let version = u32_at(&header, 44) >> 16;
    let index_bytes = entries.saturating_mul(ENTRY_BYTES);
    let names_bytes = name_entries.saturating_mul(NAME_BYTES);
    if index_bytes.max(names_bytes) > MAX_INDEX_BYTES {
        return Err(Trouble::new("its index has more than 4 GiB").into());
    }
    budget.check(index_bytes.saturating_add(names_bytes))?;
    let names = self::names(&data.bytes(names, names_bytes, "the list of names")?, version);
    let index = data.bytes(index, index_bytes, "the index")?;
    let mut found = Frame { frames: 0, chunks: HashMap::new(), first: HashMap::new(), count: 0 };
    for entry in index.chunks_exact(ENTRY_BYTES as usize) {
        let location = u64_at(entry, 16);
        // The rest is not in use.
        if location == 0 {
            break;
        }
        let at = u64_at(entry, 0);
        found.frames = found.frames.max(at.saturating_add(1));
        if at != 0 && at != frame {
            continue;
        }
        let id = usize::from(u16::from_le_bytes([entry[28], entry[29]]));
        let (Some(name), Some(kind)) = (names.get(id), number_kind(entry[30])) else { continue };
        let chunk = Chunk { rows: u64_at(entry, 8), width: u32_at(entry, 24), location, kind };
        if at == 0 {
            found.first.insert(name.clone(), chunk);
        }
        if at == frame {
            found.chunks.insert(name.clone(), chunk);
        }
    }
    if found.frames <= frame {
        let has = plural(found.frames, "frame");
        return Err(
            Trouble::new(format!("it has {has}, and no frame {frame} (the first is 0)")).into()
        );
    }
    found.count = found.particle_count(data)?;
    Ok(found)
}

/// The names of all chunks: in 64 bytes each in version 1, one after the other from version 2 on.
fn names(bytes: &[u8], version: u32) -> Vec<String> {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    if version < 2 {
        let name = |bytes: &[u8]| text(bytes.split(|&byte| byte == 0).next().unwrap_or_default());
        return bytes.chunks_exact(NAME_BYTES as usize).map(name).collect();
    }
    bytes.split(|&byte| byte == 0).take_while(|name| !name.is_empty()).map(text).collect()
}

fn number_kind(code: u8) -> Option<NumberKind> {
    Some(match code {
        1 | 11 => NumberKind::U8,
        2 => NumberKind::U16,
        3 => NumberKind::U32,
        4 => NumberKind::U64,
        5 => NumberKind::I8,
        6 => NumberKind::I16,
        7 => NumberKind::I32,
        8 => NumberKind::I64,
        9 => NumberKind::F32,
        10 => NumberKind::F64,
        _ => return None,
    })
}

impl Frame {
    /// The chunk of this frame, or that of frame 0.
    fn any(&self, name: &str) -> Option<Chunk> {
        self.chunks.get(name).or_else(|| self.first.get(name)).copied()
    }

    /// The chunk with a row for each particle.
    fn chunk(&self, name: &str) -> Option<Chunk> {
        let chunk = self.any(name)?;
        (chunk.rows == self.count && chunk.width <= MAX_WIDTH && chunk.width > 0).then_some(chunk)
    }

    /// The chunks that become columns, with their names.
    fn columns(&self) -> Vec<(String, Chunk)> {
        let known = COLUMNS.iter().map(|name| ((*name).to_owned(), format!("particles/{name}")));
        let logged = |name: &String| {
            let short = name.strip_prefix("log/particles/")?;
            Some((short.to_owned(), name.clone()))
        };
        let all = self.chunks.keys().chain(self.first.keys()).filter_map(logged);
        let mut all: Vec<(String, String)> = all.collect();
        all.sort();
        all.dedup();
        let all = known.chain(all);
        all.filter_map(|(name, path)| Some((name, self.chunk(&path)?))).collect()
    }

    fn particle_count(&self, data: &Data) -> Outcome<u64> {
        match self.any("particles/N") {
            Some(chunk) if chunk.rows == 1 && chunk.width == 1 => {
                let bytes = data.bytes(chunk.location, chunk.kind.bytes(), "`particles/N`")?;
                let mut number = [0; 8];
                number[..bytes.len()].copy_from_slice(&bytes);
                Ok(u64::from_le_bytes(number))
            }
            _ => Ok(0),
        }
    }
}

/// Describes the columns.
fn infos(found: &Frame) -> Vec<ColumnInfo> {
    let info = |name: String, kind: ColumnKind| ColumnInfo { name, kind, range: None };
    let mut infos = vec![info("type".to_owned(), ColumnKind::Text)];
    for (name, chunk) in found.columns() {
        let kind = if chunk.kind.is_float() { ColumnKind::Float } else { ColumnKind::Integer };
        let width = chunk.width as usize;
        infos.extend((0..width).map(|at| info(component_name(&name, at, width), kind)));
    }
    if found.chunk("particles/diameter").is_none() {
        infos.push(info("diameter".to_owned(), ColumnKind::Float));
    }
    infos
}

/// The columns of a chunk; positions, which have three, if `width` is given.
fn slots(name: &str, chunk: Chunk, width: Option<u32>) -> Outcome<Slots> {
    if width.is_some_and(|width| width != chunk.width) {
        return Err(Trouble::new("its positions do not have three coordinates").into());
    }
    let (number, size) = (Number::little(chunk.kind), chunk.kind.bytes());
    let columns = chunk.width as usize;
    let slot = |at: usize| Slot {
        name: component_name(name, at, columns),
        number,
        group: 0,
        offset: at as u64 * size,
        axis: width.map(|_| at),
    };
    let groups = vec![(chunk.location, columns as u64 * size)];
    Ok(Slots { groups, slots: (0..columns).map(slot).collect() })
}

/// The names of the types of all particles.
fn types(data: &Data, found: &Frame, budget: Budget) -> Outcome<Column> {
    let mut names: Vec<Arc<str>> = Vec::new();
    if let Some(chunk) = found.any("particles/types") {
        let bytes = chunk.rows.saturating_mul(u64::from(chunk.width));
        if bytes > 1 << 24 {
            return Err(Trouble::new("its names of types have more than 16 MiB").into());
        }
        let text = data.bytes(chunk.location, bytes, "the names of types")?;
        for name in text.chunks(chunk.width.max(1) as usize) {
            let name = name.split(|&byte| byte == 0).next().unwrap_or_default();
            names.push(Arc::from(&*String::from_utf8_lossy(name)));
        }
    }
    if names.is_empty() {
        names.push(Arc::from("A"));
    }
    let codes = match found.chunk("particles/typeid") {
        Some(chunk) if chunk.width == 1 => {
            let (plan, _) = slots("typeid", chunk, None)?.plan(found.count, &Wanted::All)?;
            let (_, mut values) = read_plan(data, &plan, budget)?;
            let values = values.pop().unwrap_or(ColumnData::I64(Vec::new()));
            let codes = (0..values.len()).map(|row| values.number(row) as u32);
            codes.collect::<Vec<u32>>()
        }
        _ => {
            budget.check(4 * found.count)?;
            vec![0; found.count as usize]
        }
    };
    if let Some(row) = codes.iter().position(|&code| code as usize >= names.len()) {
        let (code, has) = (codes[row], plural(names.len() as u64, "type"));
        let message = format!("row {row} (the first is 0) has type {code}, but there are {has}");
        return Err(Trouble::new(message).into());
    }
    Ok(Column { name: "type".to_owned(), data: ColumnData::Text(Categories { codes, names }) })
}

/// The numbers of a short chunk.
fn numbers(data: &Data, chunk: Chunk, count: u64) -> Outcome<Option<Vec<f64>>> {
    if chunk.rows.saturating_mul(u64::from(chunk.width)) != count {
        return Ok(None);
    }
    let size = chunk.kind.bytes();
    let slot = |at: u64| Slot {
        name: at.to_string(),
        number: Number::little(chunk.kind),
        group: 0,
        offset: at * size,
        axis: None,
    };
    let groups = vec![(chunk.location, count * size)];
    let slots = Slots { groups, slots: (0..count).map(slot).collect() };
    let (plan, _) = slots.plan(1, &Wanted::All)?;
    let (_, values) = read_plan(data, &plan, Budget::new(None))?;
    Ok(Some(values.iter().map(|value| value.number(0)).collect()))
}

/// The box.
fn cell(data: &Data, found: &Frame) -> Outcome<Option<Cell>> {
    let Some(chunk) = found.any("configuration/box") else { return Ok(None) };
    let Some(numbers) = self::numbers(data, chunk, 6)? else { return Ok(None) };
    let [lx, ly, lz, xy, xz, yz] = numbers[..] else { return Ok(None) };
    if !numbers.iter().all(|x| x.is_finite()) {
        return Err(Trouble::new("its box has numbers that are not finite").into());
    }
    let vectors =
        [DVec3::new(lx, 0.0, 0.0), DVec3::new(xy * ly, ly, 0.0), DVec3::new(xz * lz, yz * lz, lz)];
    let dimensions = match found.any("configuration/dimensions") {
        Some(chunk) => self::numbers(data, chunk, 1)?.map_or(3.0, |numbers| numbers[0]),
        None => 3.0,
    };
    let origin = -0.5 * (vectors[0] + vectors[1] + vectors[2]);
    Ok(Some(Cell { origin, vectors, periodic: [true, true, dimensions != 2.0] }))
}

/// The time step, 0 by default.
fn step(data: &Data, found: &Frame) -> Outcome<Option<f64>> {
    match found.any("configuration/step") {
        Some(chunk) => Ok(numbers(data, chunk, 1)?.map(|numbers| numbers[0])),
        None => Ok(Some(0.0)),
    }
}
