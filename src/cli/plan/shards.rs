//! Divides a render into shards.

use std::fmt;
use std::ops::Range;

use crate::error::{Error, Result};
use crate::film::BLOCK_SIZE;
use crate::math::Rect;

/// Side of the tiles that crops consist of, in pixels, on the grid of the full picture.
const TILE_SIDE: u32 = 16;

/// The part of the render that one command takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Shard {
    /// A range of the samples of every pixel.
    Samples(Range<u32>),
    /// All samples of these columns and rows of the full picture.
    Crop { columns: Range<u32>, rows: Range<u32> },
}

/// Formats the shard as an option value of `render`.
impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Samples(Range { start, end }) => write!(f, "{start}..{end}"),
            Self::Crop { columns, rows } => {
                write!(f, "{},{},{},{}", columns.start, rows.start, columns.end, rows.end)
            }
        }
    }
}

/// Divides the samples into nearly equal ranges that start at whole blocks.
///
/// # Errors
/// If there are fewer blocks than shards.
pub(super) fn by_samples(samples: u32, shards: u32) -> Result<Vec<Shard>> {
    let blocks = samples.div_ceil(BLOCK_SIZE);
    if blocks < shards {
        return Err(Error::input(format!(
            "{samples} samples per pixel are {blocks} blocks of {BLOCK_SIZE}, too few for {shards} shards"
        ))
        .with_help("use fewer shards, more samples (--spp), or divide the pixels with --by crop"));
    }
    // The end of the last block may be beyond u32.
    let first = |block: u32| block.saturating_mul(BLOCK_SIZE).min(samples);
    let ranges = parts(0..blocks, shards).map(|part| first(part.start)..first(part.end));
    Ok(ranges.map(Shard::Samples).collect())
}

/// Divides the window into rectangles whose inner edges lie on the tile grid: bands or, if there
/// are more shards than rows of tiles, pieces of bands.
///
/// # Errors
/// If there are fewer tiles than shards.
pub(super) fn by_crop(window: Rect, shards: u32) -> Result<Vec<Shard>> {
    let columns = window.x..window.x + window.width;
    let rows = window.y..window.y + window.height;
    let (across, down) = (tile_range(&columns), tile_range(&rows));
    let bands = shards.min(down.end - down.start);
    let pieces = |band: &Range<u32>| band.end - band.start;
    let all: Vec<_> = parts(down, bands).zip(parts(0..shards, bands)).collect();
    if all.iter().any(|(_, share)| pieces(share) > across.end - across.start) {
        let most = u64::from(bands) * u64::from(across.end - across.start);
        return Err(Error::input(format!(
            "the picture has {most} tiles of {TILE_SIDE} x {TILE_SIDE} pixels, too few for {shards} shards"
        ))
        .with_help("use fewer shards, or divide the samples with --by samples"));
    }
    let pixels = |part: Range<u32>, within: &Range<u32>| {
        (part.start * TILE_SIDE).max(within.start)..(part.end * TILE_SIDE).min(within.end)
    };
    let of_band = |(band, share): (Range<u32>, Range<u32>)| {
        let rows = pixels(band, &rows);
        let piece = |part| Shard::Crop { columns: pixels(part, &columns), rows: rows.clone() };
        parts(across.clone(), pieces(&share)).map(piece).collect::<Vec<_>>()
    };
    Ok(all.into_iter().flat_map(of_band).collect())
}

/// Returns the tiles that overlap the pixels.
fn tile_range(pixels: &Range<u32>) -> Range<u32> {
    pixels.start / TILE_SIDE..pixels.end.div_ceil(TILE_SIDE)
}

/// Divides the range into `count` nearly equal parts, in order.
fn parts(range: Range<u32>, count: u32) -> impl Iterator<Item = Range<u32>> {
    let length = u64::from(range.end - range.start);
    let at = move |i: u32| range.start + (u64::from(i) * length / u64::from(count)) as u32;
    (0..count).map(move |i| at(i)..at(i + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(shards: &[Shard]) -> Vec<String> {
        shards.iter().map(Shard::to_string).collect()
    }

    #[test]
    fn ranges_of_samples_begin_at_blocks_and_cover_all() {
        assert_eq!(shown(&by_samples(100, 3).unwrap()), ["0..32", "32..64", "64..100"]);
        assert_eq!(shown(&by_samples(5, 1).unwrap()), ["0..5"]);
        let most = by_samples(u32::MAX, 2).unwrap();
        assert_eq!(shown(&most), ["0..2147483648", "2147483648..4294967295"]);
        let error = by_samples(64, 5).unwrap_err().to_string();
        assert_eq!(error, "64 samples per pixel are 4 blocks of 16, too few for 5 shards");
    }

    #[test]
    fn crops_meet_on_the_grid_and_cover_each_pixel_once() {
        let window = Rect { x: 10, y: 20, width: 90, height: 61 };
        for shards in [1, 2, 4, 5, 7, 11, 29, 35] {
            let crops = by_crop(window, shards).unwrap();
            assert_eq!(crops.len(), shards as usize);
            let mut seen = vec![0; 200 * 200];
            for crop in &crops {
                let Shard::Crop { columns, rows } = crop else { panic!("{crop}") };
                for (edge, outer) in [(columns.start, 10), (rows.start, 20)] {
                    assert!(edge % TILE_SIDE == 0 || edge == outer, "{crop}");
                }
                for y in rows.clone() {
                    columns.clone().for_each(|x| seen[(y * 200 + x) as usize] += 1);
                }
            }
            let inside = |i: u32| (10..100).contains(&(i % 200)) && (20..81).contains(&(i / 200));
            let right = (0..200 * 200).all(|i| seen[i as usize] == i32::from(inside(i)));
            assert!(right, "{shards} shards");
        }
        let error = by_crop(window, 36).unwrap_err().to_string();
        assert_eq!(error, "the picture has 35 tiles of 16 x 16 pixels, too few for 36 shards");
    }
}
