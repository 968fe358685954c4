//! The extent of merged parts: their common window and samples, and any gaps.

use std::iter::Sum;
use std::ops::Range;

use crate::error::{Error, Result, Suggestion};
use crate::film::{Aov, Film, FilmFormat, FilmFrame};
use crate::math::Rect;

use super::super::adaptive::estimate_error;
use super::super::checkpoint::{CheckpointHeader, CumulativeStats, RenderStatus};
use super::super::metadata::{Metadata, RunRecord};
use super::super::noise::NoiseTarget;
use super::super::samples::{MergedSamples, SampleRange, TileSampleCounts, WindowSamples};
use super::cells::{cells, first_missing, is_contiguous_from};
use super::piece::MergeInput;

/// Side in pixels of a square that adaptive sampling decides on.
const ADAPTIVE_TILE: u32 = 16;

/// Common film format and sample range of the parts.
pub(super) struct MergedExtent {
    pub(super) format: FilmFormat,
    pub(super) samples: Range<u32>,
    samples_per_pixel: u32,
}

impl MergedExtent {
    /// The smallest window and sample range that hold all parts. `crop`, if given, replaces the
    /// window.
    ///
    /// # Errors
    /// If a part reaches beyond `crop`.
    pub(super) fn new(pieces: &[MergeInput], crop: Option<Rect>) -> Result<Self> {
        let around = pieces.iter().map(MergeInput::window).reduce(|a, b| {
            let (x, y) = (a.x.min(b.x), a.y.min(b.y));
            let width = (a.x + a.width).max(b.x + b.width) - x;
            let height = (a.y + a.height).max(b.y + b.height) - y;
            Rect { x, y, width, height }
        });
        let format = &pieces[0].header.film;
        let around = around.unwrap_or(format.frame.window);
        let window = crop.unwrap_or(around);
        if window.intersection(&around) != Some(around) {
            let what = format!("the parts hold the pixels {around}, more than the crop {window}");
            return Err(Error::input(what).with_help("name the parts of this window only"));
        }
        let start = pieces.iter().map(|piece| piece.samples().start).min().unwrap_or(0);
        let end = pieces.iter().map(|piece| piece.samples().end).max().unwrap_or(0);
        let frame = FilmFrame { window, ..format.frame };
        Ok(Self {
            format: FilmFormat { frame, first_sample: start, ..format.clone() },
            samples: start..end,
            samples_per_pixel: pieces
                .iter()
                .map(MergeInput::samples_per_pixel)
                .max()
                .unwrap_or(end),
        })
    }

    /// Rejects parts with a noise target whose window edges cut squares: each half would decide
    /// separately, unlike a square in a single render.
    ///
    /// # Errors
    /// Names the first such part.
    pub(super) fn check_tile_alignment(&self, pieces: &[MergeInput]) -> Result<()> {
        let whole = self.format.frame.window;
        let cuts = |at: u32, from: u32, length: u32| {
            at > from && at < from + length && at % ADAPTIVE_TILE != 0
        };
        for piece in pieces.iter().filter(|piece| piece.header.job.until.noise.is_some()) {
            let Rect { x, y, width, height } = piece.window();
            if [x, x + width].iter().any(|at| cuts(*at, whole.x, whole.width))
                || [y, y + height].iter().any(|at| cuts(*at, whole.y, whole.height))
            {
                let (path, window) = (piece.path.display(), piece.window());
                let what = format!(
                    "`{path}` has a noise target, and its window {window} cuts squares of {ADAPTIVE_TILE} pixels"
                );
                let help = format!("render crops whose sides are multiples of {ADAPTIVE_TILE}");
                return Err(Error::input(what).with_help(help));
            }
        }
        Ok(())
    }

    /// Rejects pixels or samples that no part holds. A picture that must be complete has stricter
    /// requirements than a checkpoint: parts of several windows must fill the whole picture or
    /// `crop`, and all samples that the scene asks for must be present. Parts of a single window
    /// make a picture of that window.
    ///
    /// # Errors
    /// Names the first gap.
    pub(super) fn check_gaps(
        &self,
        pieces: &[MergeInput],
        must_be_complete: bool,
        has_pictures: bool,
        crop: Option<Rect>,
    ) -> Result<()> {
        let is_picture = must_be_complete && has_pictures;
        let one_window = pieces.iter().all(|piece| piece.window() == pieces[0].window());
        let FilmFrame { full_size: [width, height], window } = self.format.frame;
        let window = match is_picture && !one_window && crop.is_none() {
            true => Rect { x: 0, y: 0, width, height },
            false => window,
        };
        let samples = match is_picture {
            true => 0..self.samples_per_pixel.max(self.samples.end),
            false => self.samples.clone(),
        };
        let Some((pixels, missing)) = first_gap(pieces, window, &samples) else { return Ok(()) };
        let what = format!(
            "samples {}..{} of the pixels {pixels} are missing",
            missing.start, missing.end,
        );
        let help = match (is_picture, must_be_complete) {
            (true, _) => "name the parts that hold them, or allow gaps",
            (false, true) => "name the parts that hold them",
            (false, false) => {
                "gaps are for pictures: a part cannot have any; name the parts that hold them, or leave \
                 the part out"
            }
        };
        let error = Error::input(what).with_help(help);
        Err(if is_picture { error.with_suggestion(Suggestion::AllowGaps, "") } else { error })
    }

    /// Metadata of the merged render. `shares` lists the samples that each part contributes.
    pub(super) fn metadata(
        &self,
        pieces: &[MergeInput],
        shares: Vec<WindowSamples>,
        sum: &Film,
        command: Option<String>,
    ) -> Metadata {
        let FilmFrame { full_size, window } = self.format.frame;
        let is_whole = FilmFrame::full(full_size[0], full_size[1]).window == window;
        let mut metadata = pieces[0].header.metadata.clone();
        metadata.settings.image.crop = (!is_whole).then_some(window);
        let of_first = metadata.run.unwrap_or_default();
        metadata.run = Some(RunRecord {
            rays: total(pieces, |header| header.statistics.rays),
            seconds: total(pieces, |header| header.statistics.seconds),
            threads: 1,
            error: estimate_error(sum, NoiseTarget::CONFIDENCE),
            command,
            ..of_first
        });
        let start = self.samples.start;
        match TileSampleCounts::from_film(sum)
            .filter(|_| is_contiguous_from(&shares, window, start))
        {
            Some(counts) => metadata.with_samples(
                SampleRange::from_film(sum, start),
                counts,
                MergedSamples::default(),
            ),
            None => {
                let shares = MergedSamples::new(shares);
                metadata.with_samples(shares.bounding_range(), TileSampleCounts::default(), shares)
            }
        }
    }

    /// Checkpoint header of the merged render.
    pub(super) fn header(
        &self,
        pieces: &[MergeInput],
        metadata: &Metadata,
        layers: &[Aov],
        is_ended: bool,
    ) -> CheckpointHeader {
        let first = &pieces[0].header;
        let mut job = first.job.clone();
        // If samples are missing, the result is still a part. The time limit of one part does not
        // apply to all.
        let is_all = self.samples == (0..self.samples_per_pixel);
        job.samples = (!is_all).then(|| self.samples.clone());
        job.until.clear_limits();
        job.settings.image.crop = metadata.settings.image.crop;
        job.settings.render.samples_per_pixel = self.samples_per_pixel;
        job.layers = layers.to_vec();
        let missed = pieces.iter().flat_map(|piece| piece.missed_targets().to_vec()).collect();
        CheckpointHeader {
            film: self.format.clone(),
            samples: self.samples.clone(),
            job,
            metadata: Metadata { layers: Some(layers.to_vec()), ..metadata.clone() },
            // All parts have the same status.
            status: if is_ended {
                RenderStatus::Ended { missed }
            } else {
                RenderStatus::Unfinished
            },
            statistics: CumulativeStats {
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

/// Sums a figure over the parts.
fn total<N: Sum<N>>(pieces: &[MergeInput], of: impl Fn(&CheckpointHeader) -> N) -> N {
    pieces.iter().map(|piece| of(&piece.header)).sum()
}

/// The first pixels and samples in a window that no part holds.
fn first_gap(
    pieces: &[MergeInput],
    window: Rect,
    samples: &Range<u32>,
) -> Option<(Rect, Range<u32>)> {
    let windows: Vec<Rect> = pieces.iter().map(MergeInput::window).collect();
    cells(&windows, window).into_iter().find_map(|cell| {
        let here = pieces.iter().filter(|piece| piece.window().intersection(&cell).is_some());
        let ranges = here.map(|piece| piece.samples().clone()).collect();
        Some((cell, first_missing(ranges, samples)?))
    })
}
