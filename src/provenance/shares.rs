//! Which samples of which pixels a picture holds, where one range of samples for all of them does not tell
//! it: where some are missing in between, or windows with different numbers of samples cut a tile.

use std::fmt;

use crate::scene::description::Window;

use super::{Counts, Samples};

/// The samples of one window.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Share {
    /// The pixels, in columns and rows of the whole picture.
    pub window: Window,
    /// Their samples.
    pub samples: Samples,
    /// How many of them in each tile of the window, where that differs.
    pub counts: Counts,
}

/// What a picture was merged from; no two have a sample in common. None where [`Samples`] and [`Counts`]
/// of the whole tell all.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Shares(pub Vec<Share>);

impl Share {
    fn is_uniform(&self) -> bool {
        self.samples.fewest == self.samples.most
    }

    /// Whether another is of the same window and goes on where this one ends.
    fn is_followed_by(&self, other: &Self) -> bool {
        let is_next = other.samples.first == self.samples.first + self.samples.most;
        self.window == other.window && self.is_uniform() && other.is_uniform() && is_next
    }
}

impl Shares {
    /// In the order of their windows and samples, with those that follow one another as one, and without
    /// those that hold nothing: so they do not depend on how the work was shared out.
    pub fn of(mut all: Vec<Share>) -> Self {
        all.retain(|share| share.samples.most > 0);
        all.sort_by_key(|Share { window: w, samples, .. }| {
            (w.y, w.x, w.height, w.width, samples.first)
        });
        let mut kept: Vec<Share> = Vec::new();
        for share in all {
            match kept.last_mut() {
                Some(last) if last.is_followed_by(&share) => {
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
    pub(super) fn are_all_of(&self, whole: &Window) -> bool {
        self.0.iter().all(|share| share.window == *whole && share.is_uniform())
    }

    /// The least range that has all the samples, and how many those pixels have at least.
    pub fn samples(&self) -> Samples {
        let ends = |share: &Share| share.samples.first + share.samples.most;
        let first = self.0.iter().map(|share| share.samples.first).min().unwrap_or(0);
        let end = self.0.iter().map(ends).max().unwrap_or(first);
        let fewest = self.0.iter().map(|share| share.samples.fewest).min().unwrap_or(0);
        Samples { first, fewest, most: end - first }
    }

    /// The indices of all samples that some pixel has: `0..16, 32..64`.
    pub(super) fn ranges(&self) -> String {
        let range = |share: &Share| {
            let Samples { first, most, .. } = share.samples;
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

    /// What [`Display`](fmt::Display) writes.
    pub(super) fn read(text: &str) -> Option<Self> {
        let share = |line: &str| {
            let mut fields = line.split(": ");
            let share = Share {
                window: read_window(fields.next()?)?,
                samples: Samples::read(fields.next()?)?,
                counts: fields.next().map_or(Some(Counts::default()), Counts::read)?,
            };
            fields.next().is_none().then_some(share)
        };
        text.lines().map(share).collect::<Option<_>>().map(Self)
    }
}

/// A line for each: `0,0,9,12: 0..16`, and with different counts `0,0,32,4: 0..64 to 128: 64 128`.
impl fmt::Display for Shares {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, Share { window, samples, counts }) in self.0.iter().enumerate() {
            let gap = if index > 0 { "\n" } else { "" };
            write!(f, "{gap}{}: {samples}", corners(window))?;
            if !counts.0.is_empty() {
                write!(f, ": {counts}")?;
            }
        }
        Ok(())
    }
}

/// As `--crop` has it.
pub(super) fn corners(&Window { x, y, width, height }: &Window) -> String {
    format!("{x},{y},{},{}", x + width, y + height)
}

/// What [`corners`] writes.
pub(super) fn read_window(text: &str) -> Option<Window> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|number| number.parse().ok()).collect();
    let [x, y, right, bottom] = numbers?.try_into().ok()?;
    Some(Window { x, y, width: right.checked_sub(x)?, height: bottom.checked_sub(y)? })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn share(x: u32, first: u32, count: u32) -> Share {
        let window = Window { x, y: 2, width: 9, height: 12 };
        let samples = Samples { first, fewest: count, most: count };
        Share { window, samples, counts: Counts::default() }
    }

    #[test]
    fn shares_that_follow_one_another_are_one_and_are_read_back() {
        let all = vec![share(9, 32, 32), share(0, 16, 16), share(0, 0, 16), share(0, 48, 0)];
        let mut shares = Shares::of(all);
        assert_eq!(shares.to_string(), "0,2,9,14: 0..32\n9,2,18,14: 32..64");
        assert_eq!(shares.ranges(), "0..64");
        assert_eq!(shares.samples(), Samples { first: 0, fewest: 32, most: 64 });
        shares.0[1].samples = Samples { first: 96, fewest: 16, most: 64 };
        shares.0[1].counts = Counts(vec![16, 64, 64]);
        assert_eq!(shares.ranges(), "0..32, 96..160");
        assert_eq!(Shares::read(&shares.to_string()), Some(shares));
        for wrong in ["x", "0,0,9: 0..16", "0,0,9,9", "0,0,9,9: 0..16: 3: 4", "9,0,1,9: 0..16"] {
            assert_eq!(Shares::read(wrong), None, "{wrong}");
        }
    }
}
