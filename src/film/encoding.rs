//! Serialisation of a film, tile by tile.
//!
//! Integers are written without leading and trailing zero bytes. Reading validates everything: data
//! that cannot be the sums of a render is rejected, and the memory allocated is proportional to the
//! bytes read.

use super::exact_sum::{ExactSum, U192};
use super::tile::{FilmLayout, Tile};
use super::{BLOCK_SIZE, Film, Layer};

/// Bits of a number's first byte that hold the number of bytes that follow.
const LENGTH: u8 = 0x3f;
/// Bit of that byte that is set for a negative number.
const NEGATIVE: u8 = 0x80;

/// Encodings of the counts of a tile's pixels.
const EMPTY: u8 = 0;
const UNIFORM: u8 = 1;
const PER_PIXEL: u8 = 2;

impl Film {
    /// Appends the bytes of a tile to `out`. Writes the current state of the tile, even if samples
    /// are added while other tiles are written.
    pub fn write_tile(&self, tile: usize, out: &mut Vec<u8>) {
        self.lock(tile).write(&self.layout, out);
    }

    /// Replaces a tile by the output of [`Self::write_tile`] for a film of the same format. Returns
    /// false and leaves the tile unchanged if the bytes are invalid.
    pub fn read_tile(&mut self, tile: usize, bytes: &[u8]) -> bool {
        let pixels = self.frame.tile(tile).pixel_count();
        let max_samples = u32::MAX - self.first_sample;
        match Tile::read(&self.layout, pixels, max_samples, bytes) {
            Some(sums) => {
                *self.lock(tile) = sums;
                true
            }
            None => false,
        }
    }
}

impl Tile {
    fn write(&self, layout: &FilmLayout, out: &mut Vec<u8>) {
        match self.counts.iter().max() {
            None | Some(0) => return out.push(EMPTY),
            Some(count) if self.counts.iter().all(|other| other == count) => {
                out.push(UNIFORM);
                out.extend(count.to_le_bytes());
            }
            _ => {
                out.push(PER_PIXEL);
                out.extend(self.counts.iter().flat_map(|count| count.to_le_bytes()));
            }
        }
        out.push(u8::from(!self.non_finite_counts.is_empty()));
        out.extend(self.non_finite_counts.iter().flat_map(|count| count.to_le_bytes()));
        // A sum takes up to 16 bytes and a 2-byte header, and most take nearly all.
        out.reserve(self.sums.len() * 18 + self.sums_of_squares.len() * 26);
        for sum in &self.sums {
            write_number(sum.is_negative(), sum.unsigned_abs(), 0, out);
        }
        for U192([low, middle, high]) in &self.sums_of_squares {
            write_number(false, u128::from(*middle) << 64 | u128::from(*low), *high, out);
        }
        for rows in &self.coverage {
            out.extend((rows.len() as u32).to_le_bytes());
            out.extend(
                rows.iter().flat_map(|(row, count)| [*row, *count]).flat_map(u32::to_le_bytes),
            );
        }
        // An empty list stands for zeros; partial blocks of finished pixels are zero too.
        for pixel in (0..self.counts.len()).filter(|&pixel| self.counts[pixel] % BLOCK_SIZE != 0) {
            for plane in
                self.partial_blocks.chunks_exact(self.counts.len()).take(layout.sum_count())
            {
                out.extend(plane[pixel].to_bits().to_le_bytes());
            }
        }
    }

    fn read(layout: &FilmLayout, pixels: usize, max_samples: u32, bytes: &[u8]) -> Option<Self> {
        let mut reader = Reader(bytes);
        let mut tile = Self { counts: vec![0; pixels], ..Self::default() };
        match reader.byte()? {
            EMPTY => return reader.0.is_empty().then_some(tile),
            UNIFORM => tile.counts.fill(reader.u32()?),
            PER_PIXEL => tile.counts = reader.u32s(pixels)?,
            _ => return None,
        }
        match reader.byte()? {
            0 => {}
            1 => tile.non_finite_counts = reader.u32s(pixels)?,
            _ => return None,
        }
        let counts = tile.counts.iter();
        if counts.clone().any(|&count| count > max_samples)
            || counts.zip(&tile.non_finite_counts).any(|(count, non_finite)| non_finite > count)
        {
            return None;
        }
        // Every number takes at least one byte.
        if bytes.len() < pixels * (layout.sum_count() + layout.square_count()) {
            return None;
        }
        let blocks = |index: usize| u128::from(tile.counts[index % pixels] / BLOCK_SIZE);
        for index in 0..pixels * layout.sum_count() {
            let (is_negative, bytes) = reader.number::<16>()?;
            let magnitude = u128::from_le_bytes(bytes);
            // Blocks below the limit, so that later additions cannot overflow either.
            if magnitude > blocks(index) << <i128 as ExactSum>::BITS {
                return None;
            }
            let magnitude = magnitude as i128;
            tile.sums.push(if is_negative { -magnitude } else { magnitude });
        }
        for index in 0..pixels * layout.square_count() {
            let (is_negative, bytes) = reader.number::<24>()?;
            let (low, high) = bytes.split_at(16);
            let low = u128::from_le_bytes(low.try_into().ok()?);
            let high = u64::from_le_bytes(high.try_into().ok()?);
            let max_high = blocks(index) << (<U192 as ExactSum>::BITS - 128);
            if is_negative || u128::from(high) >= max_high && (low, high) != (0, 0) {
                return None;
            }
            tile.sums_of_squares.push(U192([low as u64, (low >> 64) as u64, high]));
        }
        if layout.layers.contains(&Layer::Coverage) {
            for pixel in 0..pixels {
                tile.coverage.push(reader.coverage(tile.counts[pixel])?);
            }
        }
        let unfinished: Vec<usize> =
            (0..pixels).filter(|&pixel| tile.counts[pixel] % BLOCK_SIZE != 0).collect();
        if !unfinished.is_empty() {
            tile.partial_blocks = vec![0.0; pixels * layout.sum_count()];
        }
        for pixel in unfinished {
            for plane in 0..layout.sum_count() {
                tile.partial_blocks[plane * pixels + pixel] = reader.f64()?;
            }
        }
        (reader.0.is_empty() && layout.fits(&tile.partial_blocks, pixels)).then_some(tile)
    }
}

/// Writes a number as its sign and its magnitude of up to 192 bits, lowest byte first: a byte with
/// the sign and the number of bytes kept, then, unless it is 0, the number of zero bits dropped
/// below them, then those bytes.
fn write_number(is_negative: bool, low: u128, high: u64, out: &mut Vec<u8>) {
    let (first, end) = match (low, high) {
        (0, 0) => return out.push(0),
        (0, high) => (16 + high.trailing_zeros() / 8, 24 - high.leading_zeros() / 8),
        (low, 0) => (low.trailing_zeros() / 8, 16 - low.leading_zeros() / 8),
        (low, high) => (low.trailing_zeros() / 8, 24 - high.leading_zeros() / 8),
    };
    let (first, kept) = (first as usize, (end - first) as usize);
    out.extend([kept as u8 | if is_negative { NEGATIVE } else { 0 }, first as u8]);
    let begin = out.len();
    // Write all bytes and truncate: faster than writing a variable number.
    if first < 16 {
        out.extend((low >> (8 * first)).to_le_bytes());
    }
    if end > 16 {
        out.truncate(begin + 16usize.saturating_sub(first));
        out.extend((high >> (8 * first.saturating_sub(16))).to_le_bytes());
    }
    out.truncate(begin + kept);
}

/// Takes bytes from the front; `None` if there are too few.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*first)
    }

    fn byte(&mut self) -> Option<u8> {
        self.take::<1>().map(|[byte]| byte)
    }

    fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    fn u32s(&mut self, count: usize) -> Option<Vec<u32>> {
        (0..count).map(|_| self.u32()).collect()
    }

    fn f64(&mut self) -> Option<f64> {
        self.take().map(|bytes| f64::from_bits(u64::from_le_bytes(bytes)))
    }

    /// Reads pairs of a row and the number of samples that see it, ordered by row. The numbers must
    /// add up to `samples`.
    fn coverage(&mut self, samples: u32) -> Option<Vec<(u32, u32)>> {
        let mut rows: Vec<(u32, u32)> = Vec::new();
        let mut remaining = samples;
        for _ in 0..self.u32()? {
            let (row, count) = (self.u32()?, self.u32()?);
            if count == 0 || rows.last().is_some_and(|(last, _)| *last >= row) {
                return None;
            }
            remaining = remaining.checked_sub(count)?;
            rows.push((row, count));
        }
        (remaining == 0).then_some(rows)
    }

    /// Reads the output of [`write_number`].
    fn number<const N: usize>(&mut self) -> Option<(bool, [u8; N])> {
        let mut magnitude = [0; N];
        let head = self.byte()?;
        let length = usize::from(head & LENGTH);
        if length > 0 {
            let first = usize::from(self.byte()?);
            let target = magnitude.get_mut(first..first + length)?;
            let (kept, rest) = self.0.split_at_checked(length)?;
            target.copy_from_slice(kept);
            self.0 = rest;
        }
        Some((head & NEGATIVE != 0, magnitude))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::StdRng};

    #[test]
    fn numbers_of_any_length_come_back() {
        let mut rng = StdRng::seed_from_u64(8);
        for round in 0..200_000 {
            let words: [u64; 3] = rng.random();
            let (mut low, mut high) = (u128::from(words[0]) << 64 | u128::from(words[1]), words[2]);
            // Any number of zeros at both ends.
            low = low >> rng.random_range(0..128) << rng.random_range(0..128);
            high = high >> rng.random_range(0..64) << rng.random_range(0..64);
            match round % 4 {
                0 => low = 0,
                1 => high = 0,
                _ => {}
            }
            let (is_negative, mut bytes) = (rng.random(), Vec::new());
            write_number(is_negative, low, high, &mut bytes);
            let mut reader = Reader(&bytes);
            let (sign, magnitude) = reader.number::<24>().unwrap();
            assert_eq!(magnitude[..16], low.to_le_bytes(), "{low:x} {high:x}");
            assert_eq!(magnitude[16..], high.to_le_bytes(), "{low:x} {high:x}");
            assert!(reader.0.is_empty() && (sign == is_negative || (low, high) == (0, 0)));
            // Only the bytes needed.
            if (low, high) != (0, 0) {
                assert!(bytes[2] != 0 && bytes[bytes.len() - 1] != 0, "{bytes:?}");
            }
        }
    }
}
