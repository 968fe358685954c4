//! Rows of the usual form, many at once.

use crate::math::bytes::{ByteKernel, ByteOps, WORD};

use super::batch::Batch;
use super::fields::FieldUse;
use super::lanes::{LANES, Lanes, Places};
use super::marks::MarkedRow;
use super::values::Values;

/// Appends rows as long as each has these values, with one byte between them, and all of them are
/// common ones. Columns may have values more than that.
pub(super) struct UsualRows<'a, 't> {
    pub(super) uses: &'a [FieldUse],
    pub(super) row: MarkedRow<'t>,
    pub(super) to: &'a mut Batch,
    /// Number of rows.
    pub(super) rows: &'a mut usize,
    /// Where the last line ends.
    pub(super) end: &'a mut usize,
}

impl ByteKernel for UsualRows<'_, '_> {
    #[inline(always)]
    fn run(self, ops: impl ByteOps) {
        let Self { uses, mut row, to, rows, end } = self;
        while let Some(next) = parse_rows(uses, row, to, ops) {
            *rows += LANES;
            *end = next;
            row = MarkedRow { start: next, marks: &row.marks[LANES * uses.len()..], ..row };
        }
    }
}

/// Appends [`LANES`] rows, and returns where the last line ends.
#[inline(always)]
fn parse_rows(
    uses: &[FieldUse],
    row: MarkedRow<'_>,
    to: &mut Batch,
    ops: impl ByteOps,
) -> Option<usize> {
    let MarkedRow { text, start, marks } = row;
    let end = *marks.get(LANES * uses.len())? as usize;
    if marks[0] as usize != start || !have_ends(uses.len(), row, end, ops) {
        return None;
    }
    let mut positions = [[0.0; LANES]; 3];
    let mut columns = to.columns.iter_mut();
    for (at, is) in uses.iter().enumerate() {
        let places = Places { text, marks, stride: uses.len(), at };
        match is {
            FieldUse::Skipped => places.are_plain(at == 0)?,
            FieldUse::Position(axis) => positions[*axis] = places.floats(ops)?,
            FieldUse::Column(_) => push(columns.next()?, &places, at == 0, ops)?,
        }
    }
    let mut rows = [[0.0; 3]; LANES];
    for (row, to) in rows.iter_mut().enumerate() {
        *to = [positions[0][row], positions[1][row], positions[2][row]];
    }
    to.positions.extend_from_slice(&rows);
    Some(end)
}

/// Returns true if a line ends after each row, and no other one.
#[inline(always)]
fn have_ends(values: usize, row: MarkedRow<'_>, end: usize, ops: impl ByteOps) -> bool {
    let mut all = true;
    for at in 1..=LANES {
        all &= row.text[row.marks[at * values] as usize - 1] == b'\n';
    }
    all && count_of_ends(&row.text[row.start..end], ops) == LANES
}

#[inline(always)]
fn count_of_ends(text: &[u8], ops: impl ByteOps) -> usize {
    let words = text.chunks_exact(WORD);
    let mut last = [0; WORD];
    last[..words.remainder().len()].copy_from_slice(words.remainder());
    let mut count = ops.equal(&last, b'\n').count_ones();
    for word in words {
        let Some(word) = word.first_chunk() else { break };
        count += ops.equal(word, b'\n').count_ones();
    }
    count as usize
}

#[inline(always)]
fn push(column: &mut Values, places: &Places<'_>, is_first: bool, ops: impl ByteOps) -> Option<()> {
    match column {
        Values::F64(values) => values.extend_from_slice(&places.floats(ops)?),
        Values::I64(values) => values.extend_from_slice(&places.integers(ops)?),
        Values::I32(values) => {
            let wide: Lanes<i64> = places.integers(ops)?;
            let mut narrow = [0; LANES];
            let mut has_wide = false;
            for (narrow, &wide) in narrow.iter_mut().zip(&wide) {
                *narrow = wide as i32;
                has_wide |= i64::from(*narrow) != wide;
            }
            if has_wide {
                return None;
            }
            values.extend_from_slice(&narrow);
        }
        Values::Text(words) => {
            places.are_plain(is_first)?;
            for row in 0..LANES {
                let (start, end) = places.of(row);
                words.push_part(places.text, start..end);
            }
        }
    }
    Some(())
}

impl Places<'_> {
    /// `None` if there is white space or a quote at the end of a value, or a comment may begin.
    #[inline(always)]
    fn are_plain(&self, is_first: bool) -> Option<()> {
        let mut are_plain = true;
        for row in 0..LANES {
            let (start, end) = self.of(row);
            let (first, last) = (self.text[start], self.text[end.max(1) - 1]);
            let may_be_comment = is_first & ((first == b'#') | (first == b'/'));
            let is_blank = (start >= end) | (first <= b' ') | (last <= b' ');
            are_plain &= !(is_blank | (first == b'"') | may_be_comment);
        }
        are_plain.then_some(())
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::particles::{Particles, ReadRequest, read_bytes};

    fn read(text: &str) -> Particles {
        let particles = read_bytes(Path::new("a"), text.as_bytes(), &ReadRequest::default());
        particles.expect("it can be read")
    }

    /// Rows of a table, some with values of other kinds.
    fn rows() -> Vec<[String; 6]> {
        let row = |row: i64| {
            let x = match row % 97 {
                96 => "1.25e-3".to_owned(),
                95 => "7".to_owned(),
                _ => format!("{:.6}", (row * 37 % 1000) as f64 / 7.0 - 50.0),
            };
            let y = format!("{}", (row as f64).sqrt() - 9.0);
            let id = if row == 400 { 5_000_000_000 } else { row - 3 };
            let energy = if row == 500 { "nan".to_owned() } else { format!("{:.3}", row as f64) };
            let z = format!("{}", row as f64 / 8.0 + 0.0625);
            [["O", "H", "Si"][row as usize % 3].to_owned(), id.to_string(), x, y, z, energy]
        };
        (0..1000).map(row).collect()
    }

    #[test]
    fn rows_are_those_that_are_parsed_one_by_one() {
        let xyz = |separator: &str| {
            let lines = rows().iter().map(|row| row.join(separator) + "\n").collect::<String>();
            let properties = "species:S:1:id:I:1:pos:R:3:c_pe:R:1";
            read(&format!("1000\nProperties={properties}\n{lines}"))
        };
        let (usual, padded) = (xyz(" "), xyz("  "));
        assert_eq!(usual.positions, padded.positions);
        assert_eq!(format!("{:?}", usual.columns), format!("{:?}", padded.columns));
        assert_eq!(usual.len(), 1000);
        let csv = |separator: &str, end: &str| {
            let line = |row: &[String; 6]| row.join(separator) + end;
            let lines = rows().iter().map(line).collect::<String>();
            read(&format!("name,id,x,y,z,c{end}# a comment{end}{lines}"))
        };
        let (usual, padded, dos) = (csv(",", "\n"), csv(" , ", "\n"), csv(",", "\r\n"));
        for other in [padded, dos] {
            assert_eq!(usual.positions, other.positions);
            assert_eq!(format!("{:?}", usual.columns), format!("{:?}", other.columns));
        }
    }
}
