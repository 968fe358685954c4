//! Cells: the rectangles into which the windows of the parts divide a picture.

use std::ops::Range;

use super::super::samples::WindowSamples;
use crate::math::Rect;

/// Divides `within` into rectangles, each of which lies completely inside or outside every window.
pub(super) fn cells(windows: &[Rect], within: Rect) -> Vec<Rect> {
    let cuts = |from: u32, to: u32, of: &dyn Fn(&Rect) -> [u32; 2]| {
        let mut cuts: Vec<u32> = windows.iter().flat_map(of).collect();
        cuts.extend([from, to]);
        cuts.retain(|cut| (from..=to).contains(cut));
        cuts.sort_unstable();
        cuts.dedup();
        cuts
    };
    let Rect { x, y, width, height } = within;
    let columns = cuts(x, x + width, &|window| [window.x, window.x + window.width]);
    let rows = cuts(y, y + height, &|window| [window.y, window.y + window.height]);
    let cell = |row: &[u32], column: &[u32]| Rect {
        x: column[0],
        y: row[0],
        width: column[1] - column[0],
        height: row[1] - row[0],
    };
    let of_row = |row| columns.windows(2).map(move |column| cell(row, column));
    rows.windows(2).flat_map(of_row).collect()
}

/// The first samples of `all` that none of the ranges holds.
pub(super) fn first_missing(mut ranges: Vec<Range<u32>>, all: &Range<u32>) -> Option<Range<u32>> {
    ranges.retain(|range| !range.is_empty());
    ranges.sort_by_key(|range| range.start);
    let mut next = all.start;
    for Range { start, end } in ranges {
        if start > next {
            return (next < all.end).then(|| next..start.min(all.end));
        }
        next = next.max(end);
    }
    (next < all.end).then_some(next..all.end)
}

/// Returns true if the samples of every pixel start at `first` and have no gap. The number of
/// samples then identifies them.
pub(super) fn is_contiguous_from(shares: &[WindowSamples], within: Rect, first: u32) -> bool {
    let windows: Vec<Rect> = shares.iter().map(|share| share.window).collect();
    cells(&windows, within).iter().all(|cell| {
        let here =
            shares.iter().zip(&windows).filter(|(_, window)| window.intersection(cell).is_some());
        let mut samples: Vec<_> = here.map(|(share, _)| share.samples).collect();
        samples.retain(|samples| samples.most > 0);
        samples.sort_by_key(|samples| samples.first);
        let mut next = Some(first);
        samples.into_iter().all(|samples| {
            let follows = next == Some(samples.first);
            // Nothing can follow pixels with different sample counts.
            let end = samples.first + samples.most;
            next = (samples.fewest == samples.most).then_some(end);
            follows
        })
    })
}

#[cfg(test)]
mod tests {
    use super::super::super::samples::{SampleRange, TileSampleCounts};
    use super::*;

    const WHOLE: Rect = Rect { x: 0, y: 0, width: 16, height: 12 };

    fn share(x: u32, width: u32, first: u32, fewest: u32, most: u32) -> WindowSamples {
        let window = Rect { x, y: 0, width, height: 12 };
        WindowSamples {
            window,
            samples: SampleRange { first, fewest, most },
            counts: TileSampleCounts::default(),
        }
    }

    #[test]
    fn cells_make_up_the_whole_and_are_cut_by_no_window() {
        let windows =
            [Rect { x: 0, y: 0, width: 9, height: 5 }, Rect { x: 4, y: 3, width: 40, height: 40 }];
        let cells = cells(&windows, WHOLE);
        assert_eq!(cells.iter().map(Rect::pixel_count).sum::<usize>(), WHOLE.pixel_count());
        for (cell, window) in cells.iter().flat_map(|cell| windows.map(|window| (cell, window))) {
            assert!(window.intersection(cell).is_none_or(|common| common == *cell), "{cell:?}");
        }
    }

    #[test]
    fn the_first_gap_is_found_wherever_it_is() {
        let found = |ranges: &[Range<u32>]| first_missing(ranges.to_vec(), &(0..48));
        assert_eq!(found(&[16..48, 0..16]), None);
        assert_eq!(found(&[0..0, 16..32]), Some(0..16));
        assert_eq!(found(&[0..16, 32..64]), Some(16..32));
        assert_eq!(found(&[0..16, 16..32]), Some(32..48));
        assert_eq!(found(&[0..0, 64..80]), Some(0..48));
    }

    #[test]
    fn gaps_and_early_ends_are_told_from_a_plain_range() {
        let plain = |shares: &[WindowSamples]| is_contiguous_from(shares, WHOLE, 0);
        assert!(plain(&[share(0, 16, 16, 16, 16), share(0, 16, 0, 16, 16)]));
        assert!(plain(&[share(0, 9, 0, 16, 16), share(9, 7, 0, 32, 48)]));
        assert!(plain(&[share(0, 9, 0, 16, 16)]));
        assert!(!plain(&[share(0, 9, 0, 16, 16), share(9, 7, 16, 16, 16)]));
        assert!(!plain(&[share(0, 16, 0, 16, 16), share(0, 16, 32, 16, 16)]));
        assert!(!plain(&[share(0, 16, 0, 0, 16), share(0, 16, 16, 16, 16)]));
    }
}
