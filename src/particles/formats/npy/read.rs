//! Reads arrays of particles (`.npy`).

use crate::particles::binary::{Data, named, read_plan};
use crate::particles::budget::Budget;
use crate::particles::column::{Column, ColumnData};
use crate::particles::format::Format;
use crate::particles::model::Particles;
use crate::particles::request::{ColumnInfo, ColumnKind, ReadRequest, Survey};
use crate::particles::source::Source;
use crate::particles::text::Words;
use crate::particles::trouble::{Outcome, Trouble, plural};

use super::array::{Array, TextSlot, particles};
use super::header::{NpyHeader, read_header};

/// Reads a frame of an array.
pub(in crate::particles) fn read_npy(
    source: Source,
    frame: u64,
    request: &ReadRequest,
) -> Outcome<Particles> {
    let path = source.path.clone();
    let budget = Budget::new(request.memory_limit);
    let mut array = layout(&source.head, request)?;
    let data = Data::new(source, budget)?;
    check_frame(&array, frame)?;
    let skipped = array.frame_bytes.saturating_mul(frame);
    for (start, _) in &mut array.slots.groups {
        *start = start.saturating_add(skipped);
    }
    let all = array.slots.slots.iter().map(|slot| &slot.name);
    let all = all.chain(array.texts.iter().map(|text| &text.name));
    request.columns.check(all.map(|name| &**name))?;
    let wanted = request.columns.without(array.texts.iter().map(|text| &*text.name));
    let (plan, names) = array.slots.plan(array.rows, &wanted)?;
    let (positions, columns) = read_plan(&data, &plan, budget)?;
    let mut columns = named(names, columns);
    for text in array.texts.iter().filter(|text| request.columns.has(&text.name)) {
        columns.push(read_text(&data, text, array.rows, budget)?);
    }
    Ok(Particles { columns, frame, ..Particles::new(path, Format::Npy, positions) })
}

/// Tells what is in an array.
pub(in crate::particles) fn survey_npy(
    source: &Source,
    frame: u64,
    request: &ReadRequest,
) -> Outcome<Survey> {
    let array = layout(&source.head, request)?;
    check_frame(&array, frame)?;
    let mut columns = array.slots.infos();
    columns.extend(array.texts.iter().map(|text| ColumnInfo {
        name: text.name.clone(),
        kind: ColumnKind::Text,
        range: None,
    }));
    Ok(Survey {
        frames: Some(array.frames),
        count: Some(array.rows),
        columns,
        position_bytes: array.slots.position_bytes(),
        ..Survey::new(source, Format::Npy)
    })
}

/// Counts the frames of an array.
pub(in crate::particles) fn count_npy(source: &Source, request: &ReadRequest) -> Outcome<u64> {
    Ok(layout(&source.head, request)?.frames)
}

fn check_frame(array: &Array, frame: u64) -> Outcome<()> {
    if frame < array.frames {
        return Ok(());
    }
    let has = plural(array.frames, "frame");
    Err(Trouble::new(format!("it has {has}, and no frame {frame} (the first is 0)")).into())
}

/// What an array is.
fn layout(head: &[u8], request: &ReadRequest) -> Outcome<Array> {
    Ok(particles(&header(head)?, &request.names)?)
}

/// The header of a NumPy file.
pub(super) fn header(head: &[u8]) -> Outcome<NpyHeader> {
    match read_header(head) {
        Ok(Some(Ok(header))) => Ok(header),
        Ok(Some(Err(why))) => Err(Trouble::new(format!("it is a NumPy file {why}")).into()),
        Ok(None) | Err(_) => Err(Trouble::new("it is not a NumPy file").into()),
    }
}

/// Reads a column of words.
pub(super) fn read_text(
    data: &Data,
    text: &TextSlot,
    rows: u64,
    budget: Budget,
) -> Outcome<Column> {
    /// Bytes that are read at a time, about.
    const STEP: u64 = 1 << 20;
    let mut words = Words::default();
    let step = (STEP / text.stride.max(1)).max(1);
    let mut row = 0;
    while row < rows {
        let count = step.min(rows - row);
        let start = text.start.saturating_add(row.saturating_mul(text.stride));
        let length = (count - 1).saturating_mul(text.stride) + text.bytes;
        let bytes = data.bytes(start, length, "a column of words")?;
        for at in 0..count {
            let word = &bytes[(at * text.stride) as usize..][..text.bytes as usize];
            words.push(decoded(word, text).as_bytes());
        }
        budget.check(words.bytes())?;
        row += count;
    }
    Ok(Column { name: text.name.clone(), data: ColumnData::Text(words.finish()) })
}

/// A word without the zeros that fill it up.
fn decoded(word: &[u8], text: &TextSlot) -> String {
    if !text.is_wide {
        return String::from_utf8_lossy(word).trim_end_matches('\0').to_owned();
    }
    let character = |bytes: &[u8]| {
        let mut four = [0; 4];
        four.copy_from_slice(bytes);
        let code =
            if text.is_big_endian { u32::from_be_bytes(four) } else { u32::from_le_bytes(four) };
        char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER)
    };
    let all: String = word.chunks_exact(4).map(character).collect();
    all.trim_end_matches('\0').to_owned()
}
