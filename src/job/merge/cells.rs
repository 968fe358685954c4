//! Cells: the rectangles into which the windows of the parts divide a picture.

use std::ops::Range;

use super::super::samples::WindowSamples;
use crate::math::Rect;

/// Divides `bounds` into rectangles, each completely inside or outside every window.
pub(super) fn cells(windows: &[Rect], bounds: Rect) -> Vec<Rect> {
    let cuts = |start: u32, end: u32, edges: &dyn Fn(&Rect) -> [u32; 2]| {
        let mut cuts: Vec<u32> = windows.iter().flat_map(edges).collect();
        cuts.extend([start, end]);
        cuts.retain(|cut| (start..=end).contains(cut));
        cuts.sort_unstable();
        cuts.dedup();
        cuts
    };
    let Rect { x, y, width, height } = bounds;
    let columns = cuts(x, x + width, &|window| [window.x, window.x + window.width]);
    let rows = cuts(y, y + height, &|window| [window.y, window.y + window.height]);
    let cell = |row: &[u32], column: &[u32]| Rect {
        x: column[0],
        y: row[0],
        width: column[1] - column[0],
        height: row[1] - row[0],
    };
    let row_cells = |row| columns.windows(2).map(move |column| cell(row, column));
    rows.windows(2).flat_map(row_cells).collect()
}

/// The first samples of `all` that no range contains.
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
pub(super) fn is_contiguous_from(parts: &[WindowSamples], bounds: Rect, first: u32) -> bool {
    let windows: Vec<Rect> = parts.iter().map(|part| part.window).collect();
    cells(&windows, bounds).iter().all(|cell| {
        let overlapping =
            parts.iter().zip(&windows).filter(|(_, window)| window.intersection(cell).is_some());
        let mut samples: Vec<_> = overlapping.map(|(part, _)| part.samples).collect();
        samples.retain(|samples| samples.max_count > 0);
        samples.sort_by_key(|samples| samples.first);
        let mut next = Some(first);
        samples.into_iter().all(|samples| {
            let follows = next == Some(samples.first);
            // Nothing can follow pixels with different sample counts.
            let end = samples.first + samples.max_count;
            next = (samples.min_count == samples.max_count).then_some(end);
            follows
        })
    })
}

#[cfg(test)]
mod tests {
    use super::super::super::samples::{SampleRange, TileSampleCounts};
    use super::*;

    const WHOLE: Rect = Rect { x: 0, y: 0, width: 16, height: 12 };

    fn part(x: u32, width: u32, first: u32, min_count: u32, max_count: u32) -> WindowSamples {
        let window = Rect { x, y: 0, width, height: 12 };
        WindowSamples {
            window,
            samples: SampleRange { first, min_count, max_count },
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
        let plain = |parts: &[WindowSamples]| is_contiguous_from(parts, WHOLE, 0);
        assert!(plain(&[part(0, 16, 16, 16, 16), part(0, 16, 0, 16, 16)]));
        assert!(plain(&[part(0, 9, 0, 16, 16), part(9, 7, 0, 32, 48)]));
        assert!(plain(&[part(0, 9, 0, 16, 16)]));
        assert!(!plain(&[part(0, 9, 0, 16, 16), part(9, 7, 16, 16, 16)]));
        assert!(!plain(&[part(0, 16, 0, 16, 16), part(0, 16, 32, 16, 16)]));
        assert!(!plain(&[part(0, 16, 0, 0, 16), part(0, 16, 16, 16, 16)]));
    }
}
