//! GROMACS XTC: frames of compressed coordinates, without names. Lengths are in nanometres.
//!
//! Coordinates are integers, in steps that the frame names. They are packed into as few bits as
//! their range needs; neighbours that are close together are stored as small differences, in runs.
//! The reader is our own because a damaged file must be an error and never a panic.

use crate::math::DVec3;
use crate::particles::binary::Data;
use crate::particles::budget::Budget;
use crate::particles::format::Format;
use crate::particles::model::{Cell, LengthUnit, Particles, Positions};
use crate::particles::request::{ReadRequest, Survey};
use crate::particles::source::Source;
use crate::particles::trouble::{Failure, Outcome, Trouble, plural};

/// Bytes up to the coordinates.
const HEADER_BYTES: u64 = 56;

/// Up to so many atoms, coordinates are not compressed.
const FEW: u64 = 9;

/// Sizes of small differences; each third one is twice as large.
const SIZES: [u32; 73] = [
    0, 0, 0, 0, 0, 0, 0, 0, 0, 8, 10, 12, 16, 20, 25, 32, 40, 50, 64, 80, 101, 128, 161, 203, 256,
    322, 406, 512, 645, 812, 1024, 1290, 1625, 2048, 2580, 3250, 4096, 5060, 6501, 8192, 10321,
    13003, 16384, 20642, 26007, 32768, 41285, 52015, 65536, 82570, 104031, 131072, 165140, 208063,
    262144, 330280, 416127, 524287, 660561, 832255, 1048576, 1321122, 1664510, 2097152, 2642245,
    3329021, 4194304, 5284491, 6658042, 8388607, 10568983, 13316085, 16777216,
];

/// Index of the least size.
const FIRST_SIZE: usize = 9;

/// The head of a frame.
struct Head {
    count: u64,
    time: f32,
    cell: Option<Cell>,
    /// Position of what follows the head, and bytes of the whole frame.
    body: u64,
    bytes: u64,
    /// Bytes of the length of the packed coordinates.
    length_bytes: u64,
}

/// Reads a frame.
pub(in crate::particles) fn read(
    source: Source,
    frame: u64,
    request: &ReadRequest,
) -> Outcome<Particles> {
    let path = source.path.clone();
    let budget = Budget::new(request.memory_limit);
    let data = Data::new(source, budget)?;
    let head = find(&data, frame)?;
    let body = data.bytes(head.body, head.bytes - HEADER_BYTES, "the frame")?;
    budget.check(head.count.saturating_mul(12))?;
    let positions = if head.count <= FEW {
        let number = |bytes: &[u8]| f32::from_bits(be(bytes));
        let row = |row: &[u8]| [number(row), number(&row[4..]), number(&row[8..])];
        body.chunks_exact(12).map(row).collect()
    } else {
        unpack(&body, &head).ok_or_else(damaged)?
    };
    Ok(Particles {
        cell: head.cell,
        frame,
        time: Some(f64::from(head.time)),
        unit: Some(LengthUnit::Nanometre),
        ..Particles::new(path, Format::Xtc, Positions::F32(positions).finite()?)
    })
}

/// Tells what is in a frame.
pub(in crate::particles) fn survey(
    source: Source,
    frame: u64,
    request: &ReadRequest,
) -> Outcome<Survey> {
    let survey = Survey::new(&source, Format::Xtc);
    let data = Data::new(source, Budget::new(request.memory_limit))?;
    let head = find(&data, frame)?;
    Ok(Survey {
        count: Some(head.count),
        cell: head.cell,
        time: Some(f64::from(head.time)),
        unit: Some(LengthUnit::Nanometre),
        position_bytes: 12,
        ..survey
    })
}

/// Counts the frames.
pub(in crate::particles) fn count(source: Source, request: &ReadRequest) -> Outcome<u64> {
    let data = Data::new(source, Budget::new(request.memory_limit))?;
    let (mut at, mut count) = (0, 0);
    while at < data.len() {
        at += head(&data, at)?.bytes;
        count += 1;
    }
    Ok(count)
}

fn damaged() -> Failure {
    Trouble::new("the compressed coordinates are damaged").into()
}

/// Finds a frame.
fn find(data: &Data, frame: u64) -> Outcome<Head> {
    let (mut at, mut count) = (0, 0);
    while at < data.len() {
        let head = head(data, at)?;
        if count == frame {
            return Ok(head);
        }
        at += head.bytes;
        count += 1;
    }
    let has = plural(count, "frame");
    Err(Trouble::new(format!("it has {has}, and no frame {frame} (the first is 0)")).into())
}

/// Four bytes as a number.
fn be(bytes: &[u8]) -> u32 {
    let mut number = [0; 4];
    number.copy_from_slice(&bytes[..4]);
    u32::from_be_bytes(number)
}

/// Reads the head of the frame at a place.
fn head(data: &Data, at: u64) -> Outcome<Head> {
    let bytes = data.bytes(at, HEADER_BYTES, "the head of a frame")?;
    let word = |index: usize| be(&bytes[4 * index..]);
    let length_bytes = match word(0) {
        1995 => 4,
        2023 => 8,
        other => {
            let message = format!("expected a frame at byte {at}, found the number {other}");
            return Err(Trouble::new(message).into());
        }
    };
    let count = u64::from(word(1));
    if word(13) != word(1) {
        let message =
            format!("expected {count} atoms in the frame at byte {at}, found {}", word(13));
        return Err(Trouble::new(message).into());
    }
    let float = |index: usize| f32::from_bits(word(index));
    let vector = |index: usize| {
        DVec3::new(
            f64::from(float(index)),
            f64::from(float(index + 1)),
            f64::from(float(index + 2)),
        )
    };
    let vectors = [vector(4), vector(7), vector(10)];
    let is_cell =
        vectors.iter().all(|v| v.is_finite()) && vectors.iter().any(|v| *v != DVec3::ZERO);
    let cell = Cell { origin: DVec3::ZERO, vectors, periodic: [true; 3] };
    let body = at + HEADER_BYTES;
    let body_bytes = if count <= FEW {
        12 * count
    } else {
        let before = 32 + length_bytes;
        let lead = data.bytes(body, before, "the coordinates of a frame")?;
        let length = lead[32..].iter().fold(0, |sum: u64, &byte| sum << 8 | u64::from(byte));
        let padded = length.checked_next_multiple_of(4).ok_or_else(damaged)?;
        // An atom takes a bit at least.
        if count > length.saturating_mul(8) {
            let message = format!("{count} atoms are promised in {length} bytes at byte {body}");
            return Err(Trouble::new(message).into());
        }
        before.saturating_add(padded)
    };
    data.part(body, body_bytes, "the coordinates of a frame")?;
    Ok(Head {
        count,
        time: float(3),
        cell: is_cell.then_some(cell),
        body,
        bytes: HEADER_BYTES + body_bytes,
        length_bytes,
    })
}

/// Reads bits, the first one counting most.
struct Bits<'b> {
    bytes: &'b [u8],
    at: usize,
    held: u64,
    count: u32,
}

impl Bits<'_> {
    /// The next bits, at most 32; `None` at the end.
    #[inline]
    fn take(&mut self, count: u32) -> Option<u32> {
        while self.count < count {
            self.held = self.held << 8 | u64::from(*self.bytes.get(self.at)?);
            self.at += 1;
            self.count += 8;
        }
        self.count -= count;
        let mask = (1u64 << count) - 1;
        Some(((self.held >> self.count) & mask) as u32)
    }

    /// A number of `count` bits whose bytes come in little-endian order.
    #[inline]
    fn take_wide(&mut self, count: u32) -> Option<u128> {
        let (mut value, mut shift) = (0, 0);
        while count - shift > 8 {
            value |= u128::from(self.take(8)?) << shift;
            shift += 8;
        }
        Some(value | u128::from(self.take(count - shift)?) << shift)
    }

    /// Three numbers below their sizes, packed into one of `count` bits.
    #[inline]
    fn take_three(&mut self, count: u32, sizes: [u32; 3]) -> Option<[i32; 3]> {
        let packed = self.take_wide(count)?;
        if let Ok(packed) = u64::try_from(packed) {
            let [_, y, z] = sizes.map(u64::from);
            let (rest, last) = (packed / z, packed % z);
            return Some([(rest / y) as i32, (rest % y) as i32, last as i32]);
        }
        let [_, y, z] = sizes.map(u128::from);
        let (rest, last) = (packed / z, packed % z);
        Some([(rest / y) as i32, (rest % y) as i32, last as i32])
    }
}

fn bit_length(number: u128) -> u32 {
    128 - number.leading_zeros()
}

/// Unpacks the coordinates; `None` if they are damaged.
fn unpack(body: &[u8], head: &Head) -> Option<Vec<[f32; 3]>> {
    let word = |index: usize| be(&body[4 * index..]) as i32;
    let step = 1.0 / f32::from_bits(word(0) as u32);
    let (least, most) = ([word(1), word(2), word(3)], [word(4), word(5), word(6)]);
    let mut size_index = usize::try_from(word(7)).ok().filter(|&index| index < SIZES.len())?;
    let mut sizes = [0u32; 3];
    for axis in 0..3 {
        let size = i64::from(most[axis]) - i64::from(least[axis]) + 1;
        sizes[axis] = u32::try_from(size).ok().filter(|&size| size > 0)?;
    }
    let is_wide = sizes.iter().any(|&size| size > 0xff_ffff);
    let all_bits = bit_length(sizes.iter().map(|&size| u128::from(size)).product());
    let axis_bits = sizes.map(|size| bit_length(u128::from(size)));
    let start = 32 + head.length_bytes as usize;
    let mut bits = Bits { bytes: &body[start..], at: 0, held: 0, count: 0 };
    let half = |index: usize| (SIZES[index] / 2) as i32;
    let mut smaller = half(size_index.saturating_sub(1).max(FIRST_SIZE));
    let mut small = half(size_index);
    let count = head.count as usize;
    let mut positions = Vec::with_capacity(count);
    let place = |at: [i32; 3]| at.map(|x| x as f32 * step);
    let add = |a: [i32; 3], b: [i32; 3]| -> [i32; 3] {
        std::array::from_fn(|axis| a[axis].wrapping_add(b[axis]))
    };
    let mut run = 0;
    while positions.len() < count {
        let from_least = if is_wide {
            let mut all = [0; 3];
            for (axis, value) in all.iter_mut().enumerate() {
                *value = bits.take(axis_bits[axis])? as i32;
            }
            all
        } else {
            bits.take_three(all_bits, sizes)?
        };
        let mut previous = add(from_least, least);
        let mut change = 0;
        if bits.take(1)? == 1 {
            run = bits.take(5)? as usize;
            change = (run % 3) as i32 - 1;
            run -= run % 3;
        }
        if run == 0 {
            positions.push(place(previous));
        }
        if run > 0 && SIZES[size_index] == 0 {
            return None;
        }
        for at in 0..run / 3 {
            let near = bits.take_three(size_index as u32, [SIZES[size_index]; 3])?;
            let mut this = add(near, previous.map(|x| x.wrapping_sub(small)));
            if at == 0 {
                // The first two are swapped, so that the oxygen of water is between its hydrogens.
                std::mem::swap(&mut this, &mut previous);
                positions.push(place(previous));
                positions.push(place(this));
                continue;
            }
            previous = this;
            positions.push(place(this));
        }
        if positions.len() > count {
            return None;
        }
        size_index = size_index.checked_add_signed(change as isize)?;
        let size = *SIZES.get(size_index)?;
        match change {
            -1 => {
                small = smaller;
                smaller = if size_index > FIRST_SIZE { half(size_index - 1) } else { 0 };
            }
            1 => {
                smaller = small;
                small = (size / 2) as i32;
            }
            _ => {}
        }
        if change != 0 && size == 0 {
            return None;
        }
    }
    Some(positions)
}
