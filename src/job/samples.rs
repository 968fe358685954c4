//! Which samples of which pixels a picture holds: one range for all of them where that tells it; how
//! many each tile has, where a noise target, a time or a signal ended the render; and the parts that it
//! was merged from, where some samples are missing in between.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::film::Film;
use crate::math::Rect;

/// The indices of the samples that a picture holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SampleRange {
    /// The first of every pixel.
    pub first: u32,
    /// The number of samples of the pixel that has the fewest.
    pub fewest: u32,
    /// The number of samples of the pixel that has the most.
    pub most: u32,
}

/// How many samples every pixel of each tile has, tile after tile; none where all have the same.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "Vec<(u32, u32)>", into = "Vec<(u32, u32)>")]
pub struct TileSampleCounts(pub Vec<u32>);

/// The samples of one window.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WindowSamples {
    /// The pixels, in columns and rows of the whole picture.
    pub window: Rect,
    /// Their samples.
    pub samples: SampleRange,
    /// How many of them in each tile of the window, where that differs.
    #[serde(default, skip_serializing_if = "TileSampleCounts::is_uniform")]
    pub counts: TileSampleCounts,
}

/// What a picture was merged from; no two have a sample in common. None where [`SampleRange`] and [`TileSampleCounts`]
/// of the whole tell all.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct MergedSamples(pub Vec<WindowSamples>);

impl SampleRange {
    /// All samples of the whole picture up to this number.
    pub fn first_n(count: u32) -> Self {
        Self { first: 0, fewest: count, most: count }
    }

    /// Those of a film, from `first` on.
    pub fn from_film(film: &Film, first: u32) -> Self {
        let (fewest, most) = film.sample_count_range();
        Self { first, fewest, most }
    }
}

/// `0..64`, and `0..64 to 512` where pixels have from 64 to 512 samples.
impl fmt::Display for SampleRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { first, fewest, most } = self;
        write!(f, "{first}..{}", first + fewest)?;
        if most > fewest { write!(f, " to {}", first + most) } else { Ok(()) }
    }
}

impl TileSampleCounts {
    /// Those of a film; `None` where the pixels of some tile differ, as windows that cut it can have it.
    pub fn from_film(film: &Film) -> Option<Self> {
        let counts: Vec<u32> = (0..film.frame().tile_count())
            .map(|tile| film.uniform_tile_samples(tile))
            .collect::<Option<_>>()?;
        let differ = counts.iter().any(|count| *count != counts[0]);
        Some(Self(if differ { counts } else { Vec::new() }))
    }

    /// Whether all tiles have the same.
    pub fn is_uniform(&self) -> bool {
        self.0.is_empty()
    }
}

/// Tiles in a row with the samples that they have, as files hold them.
impl From<TileSampleCounts> for Vec<(u32, u32)> {
    fn from(counts: TileSampleCounts) -> Self {
        counts.0.chunk_by(|a, b| a == b).map(|run| (run.len() as u32, run[0])).collect()
    }
}

impl From<Vec<(u32, u32)>> for TileSampleCounts {
    fn from(runs: Vec<(u32, u32)>) -> Self {
        // A picture has at most 2^32 pixels of 64 to a tile; more than that is nobody's picture.
        let tiles: u64 = runs.iter().map(|(tiles, _)| u64::from(*tiles)).sum();
        let runs = if tiles <= 1 << 26 { runs } else { Vec::new() };
        Self(
            runs.into_iter()
                .flat_map(|(n, samples)| std::iter::repeat_n(samples, n as usize))
                .collect(),
        )
    }
}

/// `64 12x128 64`.
impl fmt::Display for TileSampleCounts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, run) in self.0.chunk_by(|a, b| a == b).enumerate() {
            let gap = if index > 0 { " " } else { "" };
            match run.len() {
                1 => write!(f, "{gap}{}", run[0])?,
                tiles => write!(f, "{gap}{tiles}x{}", run[0])?,
            }
        }
        Ok(())
    }
}

impl WindowSamples {
    fn is_uniform(&self) -> bool {
        self.samples.fewest == self.samples.most
    }

    /// Whether another is of the same window and goes on where this one ends.
    fn is_continued_by(&self, other: &Self) -> bool {
        let is_next = other.samples.first == self.samples.first + self.samples.most;
        self.window == other.window && self.is_uniform() && other.is_uniform() && is_next
    }
}

impl MergedSamples {
    /// In the order of their windows and samples, with those that follow one another as one, and without
    /// those that hold nothing: so they do not depend on how the work was shared out.
    pub fn new(mut all: Vec<WindowSamples>) -> Self {
        all.retain(|share| share.samples.most > 0);
        all.sort_by_key(|WindowSamples { window: w, samples, .. }| {
            (w.y, w.x, w.height, w.width, samples.first)
        });
        let mut kept: Vec<WindowSamples> = Vec::new();
        for share in all {
            match kept.last_mut() {
                Some(last) if last.is_continued_by(&share) => {
                    last.samples.fewest += share.samples.most;
                    last.samples.most += share.samples.most;
                }
                _ => kept.push(share),
            }
        }
        Self(kept)
    }

    /// Whether the picture is told without them.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether each is of the whole window, with as many samples everywhere.
    pub(super) fn all_cover(&self, whole: &Rect) -> bool {
        self.0.iter().all(|share| share.window == *whole && share.is_uniform())
    }

    /// The least range that has all the samples, and how many those pixels have at least.
    pub fn bounding_range(&self) -> SampleRange {
        let ends = |share: &WindowSamples| share.samples.first + share.samples.most;
        let first = self.0.iter().map(|share| share.samples.first).min().unwrap_or(0);
        let end = self.0.iter().map(ends).max().unwrap_or(first);
        let fewest = self.0.iter().map(|share| share.samples.fewest).min().unwrap_or(0);
        SampleRange { first, fewest, most: end - first }
    }

    /// The indices of all samples that some pixel has: `0..16, 32..64`.
    pub(super) fn ranges_to_string(&self) -> String {
        let range = |share: &WindowSamples| {
            let SampleRange { first, most, .. } = share.samples;
            first..first + most
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
        let words: Vec<String> =
            joined.iter().map(|range| format!("{}..{}", range.start, range.end)).collect();
        words.join(", ")
    }
}

/// A line for each: `0,0,9,12: 0..16`, and with different counts `0,0,32,4: 0..64 to 128: 64 128`.
impl fmt::Display for MergedSamples {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, WindowSamples { window, samples, counts }) in self.0.iter().enumerate() {
            let gap = if index > 0 { "\n" } else { "" };
            write!(f, "{gap}{window}: {samples}")?;
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

    fn share(x: u32, first: u32, count: u32) -> WindowSamples {
        let window = Rect { x, y: 2, width: 9, height: 12 };
        let samples = SampleRange { first, fewest: count, most: count };
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
        let all = vec![share(9, 32, 32), share(0, 16, 16), share(0, 0, 16), share(0, 48, 0)];
        let mut shares = MergedSamples::new(all);
        assert_eq!(shares.to_string(), "0,2,9,14: 0..32\n9,2,18,14: 32..64");
        assert_eq!(shares.ranges_to_string(), "0..64");
        assert_eq!(shares.bounding_range(), SampleRange { first: 0, fewest: 32, most: 64 });
        shares.0[1].samples = SampleRange { first: 96, fewest: 16, most: 64 };
        shares.0[1].counts = TileSampleCounts(vec![16, 64, 64]);
        assert_eq!(shares.ranges_to_string(), "0..32, 96..160");
        let text = serde_json::to_string(&shares).unwrap();
        assert_eq!(serde_json::from_str::<MergedSamples>(&text).unwrap(), shares);
    }
}
