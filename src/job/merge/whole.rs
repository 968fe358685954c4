//! What parts make together, and what they lack.

use std::iter::Sum;
use std::ops::Range;

use crate::error::{Error, Result, Setting};
use crate::film::{Film, Format, Frame, Kind};
use crate::math::Rect;

use super::super::adaptive::error_so_far;
use super::super::checkpoint::{Header, Statistics, Status};
use super::super::metadata::{Metadata, RunRecord};
use super::super::noise::NoiseTarget;
use super::super::samples::{Samples, Share, Shares, TileCounts};
use super::cells::{are_from_first_on, cells, first_missing};
use super::piece::Piece;

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
        let format = &pieces[0].header.film;
        let around = around.unwrap_or(format.frame.window);
        let window = crop.unwrap_or(around);
        if window.common(&around) != Some(around) {
            let what = format!("the parts hold the pixels {around}, more than the crop {window}");
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
        for piece in pieces.iter().filter(|piece| piece.header.job.until.noise.is_some()) {
            let Rect { x, y, width, height } = piece.window();
            if [x, x + width].iter().any(|at| cuts(*at, whole.x, whole.width))
                || [y, y + height].iter().any(|at| cuts(*at, whole.y, whole.height))
            {
                let (path, window) = (piece.path.display(), piece.window());
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
            "samples {}..{} of the pixels {pixels} are missing",
            missing.start, missing.end,
        );
        let help = match (is_picture, must_be_whole) {
            (true, _) => "name the parts that hold them, or allow gaps",
            (false, true) => "name the parts that hold them",
            (false, false) => {
                "gaps are for pictures: a part cannot have any; name the parts that hold them, or leave \
                 the part out"
            }
        };
        let error = Error::input(what).with_help(help);
        Err(if is_picture { error.with_setting(Setting::AllowGaps, "") } else { error })
    }

    /// How the sum of the parts, of which each brings its share, was made.
    pub(super) fn metadata(
        &self,
        pieces: &[Piece],
        shares: Vec<Share>,
        sum: &Film,
        command: Option<String>,
    ) -> Metadata {
        let Frame { full_size, window } = self.format.frame;
        let is_whole = Frame::whole(full_size[0], full_size[1]).window == window;
        let mut metadata = pieces[0].header.metadata.clone();
        metadata.settings.image.crop = (!is_whole).then_some(window);
        let of_first = metadata.run.unwrap_or_default();
        metadata.run = Some(RunRecord {
            rays: total(pieces, |header| header.statistics.rays),
            seconds: total(pieces, |header| header.statistics.seconds),
            threads: 1,
            error: error_so_far(sum, NoiseTarget::CONFIDENCE),
            command,
            ..of_first
        });
        let start = self.samples.start;
        match TileCounts::of(sum).filter(|_| are_from_first_on(&shares, window, start)) {
            Some(counts) => {
                metadata.with_samples(Samples::of(sum, start), counts, Shares::default())
            }
            None => {
                let shares = Shares::of(shares);
                metadata.with_samples(shares.samples(), TileCounts::default(), shares)
            }
        }
    }

    /// What the sum, written as a part, says of itself.
    pub(super) fn header(
        &self,
        pieces: &[Piece],
        metadata: &Metadata,
        layers: &[Kind],
        is_ended: bool,
    ) -> Header {
        let first = &pieces[0].header;
        let mut job = first.job.clone();
        // A part of the samples is one still; the time of one part says nothing of all.
        let is_all = self.samples == (0..self.last_sample);
        job.samples = (!is_all).then(|| self.samples.clone());
        job.until.time = None;
        job.settings.image.crop = metadata.settings.image.crop;
        job.settings.render.samples_per_pixel = self.last_sample;
        job.layers = layers.to_vec();
        let missed = pieces.iter().flat_map(|piece| piece.missed().to_vec()).collect();
        Header {
            film: self.format.clone(),
            samples: self.samples.clone(),
            job,
            metadata: Metadata { layers: Some(layers.to_vec()), ..metadata.clone() },
            // As all its parts are.
            status: if is_ended { Status::Ended { missed } } else { Status::Unfinished },
            statistics: Statistics {
                rays: total(pieces, |header| header.statistics.rays),
                seconds: total(pieces, |header| header.statistics.seconds),
                media_overflows: total(pieces, |header| header.statistics.media_overflows),
                cut_off: total(pieces, |header| header.statistics.cut_off),
            },
            transparent: first.transparent,
            source: first.source.clone(),
            delivery: None,
        }
    }
}

/// A figure of the parts, added up.
fn total<N: Sum<N>>(pieces: &[Piece], of: impl Fn(&Header) -> N) -> N {
    pieces.iter().map(|piece| of(&piece.header)).sum()
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
