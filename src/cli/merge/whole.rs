//! What parts make together, and what they lack.

use std::iter::Sum;
use std::ops::Range;
use std::str::FromStr;

use crate::error::{Error, Result};
use crate::film::{Film, Format, Frame, Rect};
use crate::output::Record;
use crate::provenance::{Counts, INTERSECTOR_CHOICE, Made, Run, Samples, Share, Shares};
use crate::render::error_so_far;
use crate::scene::description::Window;

use crate::cli::goal::CONFIDENCE;
use crate::cli::render::MISSED;
use crate::cli::system;

use super::cells::{are_from_first_on, cells, first_missing};
use super::{Piece, corners};

/// Pixels along the side of a square that a noise target decides about.
const SQUARE: u32 = 16;

/// What the parts make together.
pub(super) struct Whole {
    pub(super) format: Format,
    pub(super) samples: Range<u32>,
    last_sample: u32,
}

impl Whole {
    /// The least rectangle and range that hold all the parts; or this window, of which they are parts.
    ///
    /// # Errors
    /// When they reach beyond it.
    pub(super) fn of(pieces: &[Piece], crop: Option<Rect>) -> Result<Self> {
        let around = pieces.iter().map(Piece::window).reduce(|a, b| {
            let (x, y) = (a.x.min(b.x), a.y.min(b.y));
            let width = (a.x + a.width).max(b.x + b.width) - x;
            let height = (a.y + a.height).max(b.y + b.height) - y;
            Rect { x, y, width, height }
        });
        let format = &pieces[0].head.format;
        let around = around.unwrap_or(format.frame.window);
        let window = crop.unwrap_or(around);
        if window.common(&around) != Some(around) {
            let (asked, held) = (corners(window), corners(around));
            let what = format!("the parts hold the pixels {held}, more than --crop {asked}");
            return Err(Error::input(what).with_help("name the parts of this window only"));
        }
        let start = pieces.iter().map(|piece| piece.samples().start).min().unwrap_or(0);
        let end = pieces.iter().map(|piece| piece.samples().end).max().unwrap_or(0);
        let frame = Frame { window, ..format.frame };
        Ok(Self {
            format: Format { frame, first_sample: start, ..format.clone() },
            samples: start..end,
            last_sample: pieces.iter().map(Piece::last_sample).max().unwrap_or(end),
        })
    }

    /// Refuses parts with a noise target whose sides cut squares: each half decided by itself, not as the
    /// square of one render does.
    ///
    /// # Errors
    /// With the first of them.
    pub(super) fn check_squares(&self, pieces: &[Piece]) -> Result<()> {
        let whole = self.format.frame.window;
        let cuts =
            |at: u32, from: u32, length: u32| at > from && at < from + length && at % SQUARE != 0;
        for piece in pieces.iter().filter(|piece| piece.record("noise").is_some()) {
            let Rect { x, y, width, height } = piece.window();
            if [x, x + width].iter().any(|at| cuts(*at, whole.x, whole.width))
                || [y, y + height].iter().any(|at| cuts(*at, whole.y, whole.height))
            {
                let (path, window) = (piece.path.display(), corners(piece.window()));
                let what = format!(
                    "`{path}` has a noise target, and its window {window} cuts squares of {SQUARE} pixels"
                );
                let help = format!("render crops whose sides are multiples of {SQUARE}");
                return Err(Error::input(what).with_help(help));
            }
        }
        Ok(())
    }

    /// Refuses pixels or samples that no part holds. A picture, where there is one that must be whole, needs
    /// more than a part. Parts of one window make a picture of that window,
    /// parts of several make one of the whole, or of `crop`; and a picture has all samples that the scene
    /// asks for.
    ///
    /// # Errors
    /// With the first of them.
    pub(super) fn check_gaps(
        &self,
        pieces: &[Piece],
        must_be_whole: bool,
        has_pictures: bool,
        crop: Option<Rect>,
    ) -> Result<()> {
        let is_picture = must_be_whole && has_pictures;
        let one_window = pieces.iter().all(|piece| piece.window() == pieces[0].window());
        let Frame { full_size: [width, height], window } = self.format.frame;
        let window = match is_picture && !one_window && crop.is_none() {
            true => Rect { x: 0, y: 0, width, height },
            false => window,
        };
        let samples = match is_picture {
            true => 0..self.last_sample.max(self.samples.end),
            false => self.samples.clone(),
        };
        let Some((pixels, missing)) = first_gap(pieces, window, &samples) else { return Ok(()) };
        let what = format!(
            "samples {}..{} of the pixels {} are missing",
            missing.start,
            missing.end,
            corners(pixels)
        );
        let help = match (is_picture, must_be_whole) {
            (true, _) => "name the parts that hold them, or add --allow-gaps",
            (false, true) => "name the parts that hold them",
            (false, false) => {
                "--allow-gaps is for pictures: a part cannot have gaps; name the parts that hold them, or \
                 leave the part out"
            }
        };
        Err(Error::input(what).with_help(help))
    }

    /// How the sum of the parts, of which each brings its share, was made.
    pub(super) fn made(&self, first: &Piece, shares: Vec<Share>, sum: &Film) -> Made {
        let Frame { full_size, window } = self.format.frame;
        let Rect { x, y, width, height } = window;
        let is_whole = Frame::whole(full_size[0], full_size[1]).window == window;
        let crop = (!is_whole).then_some(Window { x, y, width, height });
        let made = Made { crop, ..first.made.clone() };
        let start = self.samples.start;
        match Counts::of(sum).filter(|_| are_from_first_on(&shares, window, start)) {
            Some(counts) => {
                let (fewest, most) = sum.fewest_and_most();
                let samples = Samples { first: start, fewest, most };
                Made { samples, counts, shares: Shares::default(), ..made }
            }
            None => {
                let shares = Shares::of(shares);
                Made { samples: shares.samples(), counts: Counts::default(), shares, ..made }
            }
        }
    }

    /// The parts' work.
    pub(super) fn run(&self, pieces: &[Piece], sum: &Film) -> Run {
        Run {
            command: system::command_line(),
            scene_file: pieces[0].record("scene-file").unwrap_or_default().to_owned(),
            rays: total(pieces, "rays"),
            seconds: total(pieces, "seconds"),
            threads: 1,
            error: error_so_far(sum, CONFIDENCE),
            noise: pieces[0].record("noise").map(str::to_owned),
            intersector: pieces[0].record(INTERSECTOR_CHOICE).unwrap_or_default().to_owned(),
        }
    }

    /// What the sum, written as a part, says of itself.
    pub(super) fn records(&self, pieces: &[Piece], made: &Made, run: &Run) -> Vec<Record> {
        let mut records = made.records();
        records.extend(run.records());
        for name in ["media-overflows", "cut-off"] {
            records.push(Record::new(name, total::<u64>(pieces, name).to_string()));
        }
        records.push(Record::new("samples-per-pixel", self.last_sample.to_string()));
        let transparent = pieces[0].record("transparent").unwrap_or_default();
        records.push(Record::new("transparent", transparent));
        let missed: Vec<&str> = pieces.iter().filter_map(|piece| piece.record(MISSED)).collect();
        if !missed.is_empty() {
            records.push(Record::new(MISSED, missed.join("; ")));
        }
        records
    }
}

/// A figure that the parts tell, added up.
fn total<N: FromStr + Sum<N>>(pieces: &[Piece], name: &str) -> N {
    pieces.iter().filter_map(|piece| piece.record(name)?.parse().ok()).sum()
}

/// The first pixels and samples of a box that no piece holds.
fn first_gap(pieces: &[Piece], window: Rect, samples: &Range<u32>) -> Option<(Rect, Range<u32>)> {
    let windows: Vec<Rect> = pieces.iter().map(Piece::window).collect();
    cells(&windows, window).into_iter().find_map(|cell| {
        let here = pieces.iter().filter(|piece| piece.window().common(&cell).is_some());
        let ranges = here.map(|piece| piece.samples().clone()).collect();
        Some((cell, first_missing(ranges, samples)?))
    })
}
