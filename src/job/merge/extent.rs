//! The extent of merged parts: their common window and samples, and any gaps.

use std::iter::Sum;
use std::ops::Range;

use crate::error::{Error, Result, Suggestion};
use crate::film::{Aov, Film, FilmFormat, FilmFrame};
use crate::math::Rect;

use super::super::adaptive::estimate_error;
use super::super::checkpoint::{CheckpointHeader, CumulativeStats, RenderStatus};
use super::super::metadata::{Metadata, RunRecord};
use super::super::samples::{MergedSamples, SampleRange, TileSampleCounts, WindowSamples};
use super::super::spec::StopCriteria;
use super::cells::{cells, first_missing, is_contiguous_from};
use super::input::MergeInput;

/// Side in pixels of a tile that adaptive sampling decides on.
const ADAPTIVE_TILE: u32 = 16;

/// Common film format and sample range of the parts.
pub(super) struct MergedExtent {
    pub(super) format: FilmFormat,
    pub(super) samples: Range<u32>,
    samples_per_pixel: u32,
}

impl MergedExtent {
    /// The smallest window and sample range that contain all parts. `crop`, if given, replaces the
    /// window.
    ///
    /// # Errors
    /// If a part reaches beyond `crop`.
    pub(super) fn new(inputs: &[MergeInput], crop: Option<Rect>) -> Result<Self> {
        let union = inputs.iter().map(MergeInput::window).reduce(|a, b| {
            let (x, y) = (a.x.min(b.x), a.y.min(b.y));
            let width = (a.x + a.width).max(b.x + b.width) - x;
            let height = (a.y + a.height).max(b.y + b.height) - y;
            Rect { x, y, width, height }
        });
        let format = &inputs[0].header.film;
        let union = union.unwrap_or(format.frame.window);
        let window = crop.unwrap_or(union);
        if window.intersection(&union) != Some(union) {
            let message = format!(
                "the parts cover the pixels {union}, which reach outside the crop {window}"
            );
            return Err(Error::input(message).with_help("name only parts inside the crop"));
        }
        let start = inputs.iter().map(|input| input.samples().start).min().unwrap_or(0);
        let end = inputs.iter().map(|input| input.samples().end).max().unwrap_or(0);
        let frame = FilmFrame { window, ..format.frame };
        Ok(Self {
            format: FilmFormat { frame, first_sample: start, ..format.clone() },
            samples: start..end,
            samples_per_pixel: inputs
                .iter()
                .map(MergeInput::samples_per_pixel)
                .max()
                .unwrap_or(end),
        })
    }

    /// Rejects parts with a noise target whose window edges cut adaptive tiles: each half would
    /// decide separately, unlike a tile in a single render.
    ///
    /// # Errors
    /// Names the first such part.
    pub(super) fn check_tile_alignment(&self, inputs: &[MergeInput]) -> Result<()> {
        let bounds = self.format.frame.window;
        let cuts = |edge: u32, start: u32, length: u32| {
            edge > start && edge < start + length && edge % ADAPTIVE_TILE != 0
        };
        for input in inputs.iter().filter(|input| input.header.job.until.noise.is_some()) {
            let Rect { x, y, width, height } = input.window();
            if [x, x + width].iter().any(|edge| cuts(*edge, bounds.x, bounds.width))
                || [y, y + height].iter().any(|edge| cuts(*edge, bounds.y, bounds.height))
            {
                let (path, window) = (input.path.display(), input.window());
                let message = format!(
                    "`{path}` has a noise target, and its window {window} cuts tiles of {ADAPTIVE_TILE} x {ADAPTIVE_TILE} pixels"
                );
                let help = format!("render crops whose sides are multiples of {ADAPTIVE_TILE}");
                return Err(Error::input(message).with_help(help));
            }
        }
        Ok(())
    }

    /// Rejects pixels or samples that are in no part. A picture that must be complete has stricter
    /// requirements than a checkpoint: parts of several windows must fill the whole picture or
    /// `crop`, and all samples that the scene asks for must be present. Parts of a single window
    /// make a picture of that window.
    ///
    /// # Errors
    /// Names the first gap.
    pub(super) fn check_gaps(
        &self,
        inputs: &[MergeInput],
        must_be_complete: bool,
        has_pictures: bool,
        crop: Option<Rect>,
    ) -> Result<()> {
        let is_picture = must_be_complete && has_pictures;
        let one_window = inputs.iter().all(|input| input.window() == inputs[0].window());
        let FilmFrame { full_size: [width, height], window } = self.format.frame;
        let window = match is_picture && !one_window && crop.is_none() {
            true => Rect { x: 0, y: 0, width, height },
            false => window,
        };
        let samples = match is_picture {
            true => 0..self.samples_per_pixel.max(self.samples.end),
            false => self.samples.clone(),
        };
        let Some((pixels, missing)) = first_gap(inputs, window, &samples) else { return Ok(()) };
        let message = format!(
            "samples {}..{} of the pixels {pixels} are missing",
            missing.start, missing.end,
        );
        let help = match (is_picture, must_be_complete) {
            (true, _) => "add the parts that have them, or allow gaps",
            (false, true) => "add the parts that have them",
            (false, false) => {
                "only pictures may have gaps: add the parts that have them, or write no part"
            }
        };
        let error = Error::input(message).with_help(help);
        Err(if is_picture { error.with_suggestion(Suggestion::AllowGaps, "") } else { error })
    }

    /// Metadata of the merged render. `window_samples` lists the samples that each part
    /// contributes.
    pub(super) fn metadata(
        &self,
        inputs: &[MergeInput],
        window_samples: Vec<WindowSamples>,
        sum: &Film,
        command: Option<String>,
    ) -> Metadata {
        let FilmFrame { full_size, window } = self.format.frame;
        let covers_picture = FilmFrame::full(full_size[0], full_size[1]).window == window;
        let mut metadata = inputs[0].header.metadata.clone();
        metadata.settings.image.crop = (!covers_picture).then_some(window);
        let first_run = metadata.run.unwrap_or_default();
        metadata.run = Some(RunRecord {
            rays: total(inputs, |header| header.statistics.rays),
            seconds: total(inputs, |header| header.statistics.seconds),
            threads: 1,
            error: estimate_error(sum, &StopCriteria::default().reported_target()),
            // Nobody has looked at the tiles of the sum.
            missed: None,
            command,
            ..first_run
        });
        let start = self.samples.start;
        match TileSampleCounts::from_film(sum)
            .filter(|_| is_contiguous_from(&window_samples, window, start))
        {
            Some(counts) => metadata.with_samples(
                SampleRange::from_film(sum, start),
                counts,
                MergedSamples::default(),
            ),
            None => {
                let window_samples = MergedSamples::new(window_samples);
                metadata.with_samples(
                    window_samples.bounding_range(),
                    TileSampleCounts::default(),
                    window_samples,
                )
            }
        }
    }

    /// Checkpoint header of the merged render.
    pub(super) fn header(
        &self,
        inputs: &[MergeInput],
        metadata: &Metadata,
        layers: &[Aov],
        is_ended: bool,
    ) -> CheckpointHeader {
        let first = &inputs[0].header;
        let mut job = first.job.clone();
        // If samples are missing, the result is still a part. The time limit of one part does not
        // apply to all.
        let is_complete = self.samples == (0..self.samples_per_pixel);
        job.samples = (!is_complete).then(|| self.samples.clone());
        job.until.clear_limits();
        job.settings.image.crop = metadata.settings.image.crop;
        job.settings.render.samples_per_pixel = self.samples_per_pixel;
        job.layers = layers.to_vec();
        let missed_targets =
            inputs.iter().flat_map(|input| input.missed_targets().to_vec()).collect();
        CheckpointHeader {
            film: self.format.clone(),
            samples: self.samples.clone(),
            job,
            metadata: Metadata { layers: Some(layers.to_vec()), ..metadata.clone() },
            // All parts have the same status.
            status: if is_ended {
                RenderStatus::Ended { missed_targets }
            } else {
                RenderStatus::Unfinished
            },
            statistics: CumulativeStats {
                rays: total(inputs, |header| header.statistics.rays),
                seconds: total(inputs, |header| header.statistics.seconds),
                truncated_paths: total(inputs, |header| header.statistics.truncated_paths),
            },
            transparent: first.transparent,
            source: first.source.clone(),
            output: None,
        }
    }
}

/// Sums a figure over the parts.
fn total<N: Sum<N>>(inputs: &[MergeInput], field: impl Fn(&CheckpointHeader) -> N) -> N {
    inputs.iter().map(|input| field(&input.header)).sum()
}

/// The first pixels and samples in a window that are in no part.
fn first_gap(
    inputs: &[MergeInput],
    window: Rect,
    samples: &Range<u32>,
) -> Option<(Rect, Range<u32>)> {
    let windows: Vec<Rect> = inputs.iter().map(MergeInput::window).collect();
    cells(&windows, window).into_iter().find_map(|cell| {
        let overlapping =
            inputs.iter().filter(|input| input.window().intersection(&cell).is_some());
        let ranges = overlapping.map(|input| input.samples().clone()).collect();
        Some((cell, first_missing(ranges, samples)?))
    })
}
