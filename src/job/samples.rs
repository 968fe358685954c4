//! Describes which samples of which pixels a picture holds: one range if it fits all pixels; counts
//! per tile if a noise target, a time limit or a signal ended the render; and the merged parts if
//! samples are missing in between.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::film::Film;
use crate::math::Rect;

/// The sample indices in a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SampleRange {
    /// First sample index of every pixel.
    pub first: u32,
    /// Minimum number of samples over all pixels.
    pub min_count: u32,
    /// Maximum number of samples over all pixels.
    pub max_count: u32,
}

/// Samples per pixel in each film tile, in tile order; empty if all tiles have the same.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "Vec<(u32, u32)>", into = "Vec<(u32, u32)>")]
pub struct TileSampleCounts(pub Vec<u32>);

/// The samples of one window.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WindowSamples {
    /// The window in pixels of the full picture.
    pub window: Rect,
    /// The samples of the window's pixels.
    pub samples: SampleRange,
    /// Samples per film tile of the window, if they differ.
    #[serde(default, skip_serializing_if = "TileSampleCounts::is_uniform")]
    pub counts: TileSampleCounts,
}

/// The parts of a merged picture; no two share a sample. Empty if [`SampleRange`] and
/// [`TileSampleCounts`] describe the whole picture.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct MergedSamples(pub Vec<WindowSamples>);

impl SampleRange {
    /// The first `count` samples of every pixel.
    pub fn first_n(count: u32) -> Self {
        Self { first: 0, min_count: count, max_count: count }
    }

    /// The samples of a film, starting at `first`.
    pub fn from_film(film: &Film, first: u32) -> Self {
        let (min_count, max_count) = film.sample_count_range();
        Self { first, min_count, max_count }
    }
}

/// `0..64`, or `0..64 to 512` if pixels have from 64 to 512 samples.
impl fmt::Display for SampleRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { first, min_count, max_count } = self;
        write!(f, "{first}..{}", first + min_count)?;
        if max_count > min_count { write!(f, " to {}", first + max_count) } else { Ok(()) }
    }
}

impl TileSampleCounts {
    /// The counts of a film; `None` if pixels within a tile differ, as windows that cut tiles can
    /// cause.
    pub fn from_film(film: &Film) -> Option<Self> {
        let counts: Vec<u32> = (0..film.frame().tile_count())
            .map(|tile| film.uniform_tile_samples(tile))
            .collect::<Option<_>>()?;
        let differ = counts.iter().any(|count| *count != counts[0]);
        Some(Self(if differ { counts } else { Vec::new() }))
    }

    /// Returns true if all tiles have the same number of samples.
    pub fn is_uniform(&self) -> bool {
        self.0.is_empty()
    }
}

/// Run-length encoding for files: numbers of tiles with their sample counts.
impl From<TileSampleCounts> for Vec<(u32, u32)> {
    fn from(counts: TileSampleCounts) -> Self {
        counts.0.chunk_by(|a, b| a == b).map(|run| (run.len() as u32, run[0])).collect()
    }
}

impl From<Vec<(u32, u32)>> for TileSampleCounts {
    fn from(runs: Vec<(u32, u32)>) -> Self {
        // A picture has at most 2^32 pixels, 64 per tile. Larger totals are rejected.
        let tiles: u64 = runs.iter().map(|(tiles, _)| u64::from(*tiles)).sum();
        let runs = if tiles <= 1 << 26 { runs } else { Vec::new() };
        Self(
            runs.into_iter()
                .flat_map(|(n, samples)| std::iter::repeat_n(samples, n as usize))
                .collect(),
        )
    }
}

/// As in `64 12x128 64`.
impl fmt::Display for TileSampleCounts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, run) in self.0.chunk_by(|a, b| a == b).enumerate() {
            let separator = if index > 0 { " " } else { "" };
            match run.len() {
                1 => write!(f, "{separator}{}", run[0])?,
                tiles => write!(f, "{separator}{tiles}x{}", run[0])?,
            }
        }
        Ok(())
    }
}

impl WindowSamples {
    fn is_uniform(&self) -> bool {
        self.samples.min_count == self.samples.max_count
    }

    /// Returns true if `other` has the same window and continues where this range ends.
    fn is_continued_by(&self, other: &Self) -> bool {
        let is_next = other.samples.first == self.samples.first + self.samples.max_count;
        self.window == other.window && self.is_uniform() && other.is_uniform() && is_next
    }
}

impl MergedSamples {
    /// Sorts parts by window and samples, joins consecutive ones, and drops empty ones, so that the
    /// result does not depend on how the work was divided.
    pub fn new(mut all: Vec<WindowSamples>) -> Self {
        all.retain(|part| part.samples.max_count > 0);
        all.sort_by_key(|WindowSamples { window: w, samples, .. }| {
            (w.y, w.x, w.height, w.width, samples.first)
        });
        let mut kept: Vec<WindowSamples> = Vec::new();
        for part in all {
            match kept.last_mut() {
                Some(last) if last.is_continued_by(&part) => {
                    last.samples.min_count += part.samples.max_count;
                    last.samples.max_count += part.samples.max_count;
                }
                _ => kept.push(part),
            }
        }
        Self(kept)
    }

    /// Returns true if the picture is described without parts.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns true if every part covers the window `whole` with a uniform number of samples.
    pub(super) fn all_cover(&self, whole: &Rect) -> bool {
        self.0.iter().all(|part| part.window == *whole && part.is_uniform())
    }

    /// The smallest range that holds all samples. `min_count` is the minimum over the parts.
    pub fn bounding_range(&self) -> SampleRange {
        let ends = |part: &WindowSamples| part.samples.first + part.samples.max_count;
        let first = self.0.iter().map(|part| part.samples.first).min().unwrap_or(0);
        let end = self.0.iter().map(ends).max().unwrap_or(first);
        let min_count = self.0.iter().map(|part| part.samples.min_count).min().unwrap_or(0);
        SampleRange { first, min_count, max_count: end - first }
    }

    /// The indices of all samples that some pixel has, as in `0..16, 32..64`.
    pub(super) fn ranges_to_string(&self) -> String {
        let range = |part: &WindowSamples| {
            let SampleRange { first, max_count, .. } = part.samples;
            first..first + max_count
        };
        let mut ranges: Vec<_> = self.0.iter().map(range).collect();
        ranges.sort_by_key(|range| range.start);
        let mut joined: Vec<std::ops::Range<u32>> = Vec::new();
        for range in ranges {
            match joined.last_mut() {
                Some(last) if range.start <= last.end => last.end = last.end.max(range.end),
                _ => joined.push(range),
            }
        }
        let texts: Vec<String> =
            joined.iter().map(|range| format!("{}..{}", range.start, range.end)).collect();
        texts.join(", ")
    }
}

/// One line per part: `0,0,9,12: 0..16`, or `0,0,32,4: 0..64 to 128: 64 128` if counts differ.
impl fmt::Display for MergedSamples {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, WindowSamples { window, samples, counts }) in self.0.iter().enumerate() {
            let separator = if index > 0 { "\n" } else { "" };
            write!(f, "{separator}{window}: {samples}")?;
            if !counts.is_uniform() {
                write!(f, ": {counts}")?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(x: u32, first: u32, count: u32) -> WindowSamples {
        let window = Rect { x, y: 2, width: 9, height: 12 };
        let samples = SampleRange { first, min_count: count, max_count: count };
        WindowSamples { window, samples, counts: TileSampleCounts::default() }
    }

    #[test]
    fn counts_are_short_and_read_back() {
        let counts = TileSampleCounts([vec![64], vec![128; 12], vec![64], vec![256; 2]].concat());
        assert_eq!(counts.to_string(), "64 12x128 64 2x256");
        let text = serde_json::to_string(&counts).unwrap();
        assert_eq!(text, "[[1,64],[12,128],[1,64],[2,256]]");
        assert_eq!(serde_json::from_str::<TileSampleCounts>(&text).unwrap(), counts);
        let huge = serde_json::from_str::<TileSampleCounts>("[[4000000000,64]]").unwrap();
        assert!(huge.is_uniform(), "nobody's memory is taken");
    }

    #[test]
    fn shares_that_follow_one_another_are_one_and_are_read_back() {
        let all = vec![part(9, 32, 32), part(0, 16, 16), part(0, 0, 16), part(0, 48, 0)];
        let mut parts = MergedSamples::new(all);
        assert_eq!(parts.to_string(), "0,2,9,14: 0..32\n9,2,18,14: 32..64");
        assert_eq!(parts.ranges_to_string(), "0..64");
        assert_eq!(parts.bounding_range(), SampleRange { first: 0, min_count: 32, max_count: 64 });
        parts.0[1].samples = SampleRange { first: 96, min_count: 16, max_count: 64 };
        parts.0[1].counts = TileSampleCounts(vec![16, 64, 64]);
        assert_eq!(parts.ranges_to_string(), "0..32, 96..160");
        let text = serde_json::to_string(&parts).unwrap();
        assert_eq!(serde_json::from_str::<MergedSamples>(&text).unwrap(), parts);
    }
}
