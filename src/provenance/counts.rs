//! How many samples each tile of a picture has, where they differ: what `--noise` and `--time` came to.

use std::fmt;

use crate::film::Film;

/// The samples of every pixel of each tile, tile after tile; none where all have the same.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Counts(pub Vec<u32>);

impl Counts {
    /// Those of a film; `None` where the pixels of some tile differ, as windows that cut it can have it.
    pub fn of(film: &Film) -> Option<Self> {
        let counts: Vec<u32> = (0..film.frame().tiles())
            .map(|tile| film.samples_of_tile(tile))
            .collect::<Option<_>>()?;
        let differ = counts.iter().any(|count| *count != counts[0]);
        Some(Self(if differ { counts } else { Vec::new() }))
    }

    /// What [`Display`](fmt::Display) writes.
    pub(super) fn read(text: &str) -> Option<Self> {
        let run = |run: &str| -> Option<(usize, u32)> {
            let (tiles, samples) = run.split_once('x').unwrap_or(("1", run));
            Some((tiles.parse().ok()?, samples.parse().ok()?))
        };
        let runs: Vec<(usize, u32)> = text.split(' ').map(run).collect::<Option<_>>()?;
        let tiles = runs.iter().try_fold(0usize, |sum, (tiles, _)| sum.checked_add(*tiles))?;
        // A picture has at most 2^32 pixels of 64 to a tile.
        (tiles <= 1 << 26).then_some(())?;
        Some(Self(
            runs.into_iter().flat_map(|(n, samples)| std::iter::repeat_n(samples, n)).collect(),
        ))
    }
}

/// Runs of tiles, along their rows: `64 12x128 64`.
impl fmt::Display for Counts {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_short_and_read_back() {
        let counts = Counts([vec![64], vec![128; 12], vec![64], vec![256; 2]].concat());
        assert_eq!(counts.to_string(), "64 12x128 64 2x256");
        assert_eq!(Counts::read(&counts.to_string()), Some(counts));
        for wrong in ["", "x", "3x", "x64", "64,64", "99999999999x64", "-1x3"] {
            assert_eq!(Counts::read(wrong), None, "{wrong}");
        }
    }
}
