//! Renders until the picture is good enough: square by square, for as long as each needs.
//!
//! A square decides when all of its pixels have 64, 128, 256, ... samples, by those samples alone. So
//! what it decides does not depend on other squares, on threads, on how often the render was stopped
//! between, nor on the window of the picture, as long as that does not cut the square.

use std::ops::Range;

use rayon::prelude::*;

use crate::error::Result;
use crate::film::Film;

use super::adaptive_tiles::AdaptiveTiles;
use super::noise::{self, NoiseTarget, TileNoise, error_quantile};
use super::progressive::ProgressiveRenderer;

/// Samples per pixel at the first decision: four blocks, the fewest that say anything of their spread.
pub const MIN_ADAPTIVE_SAMPLES: u32 = 64;

/// How far the error of a square, estimated from `n` samples, may be off, as a share of it: this over
/// the square root of `n`. It is two standard deviations of what was measured (docs/stopping.md).
const ERROR_UNCERTAINTY: f64 = 1.2;

/// Squares that an estimate of the whole picture's error looks at.
const PROBED_TILES: usize = 64;

/// About how many of their pixels it asks how far off they are.
const PROBED_PIXELS: usize = 1024;

/// How far a render to a target is.
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseProgress {
    /// What is asked for.
    pub target: NoiseTarget,
    /// Squares of the picture.
    pub tiles: usize,
    /// Squares that meet the target.
    pub tiles_converged: usize,
    /// The error of the square that is worst, by the same measure as the target; infinite where one has
    /// not decided yet.
    pub worst_error: f64,
    /// The least and the most samples that the whole picture is likely to take.
    pub expected_samples: Range<u64>,
}

/// Renders until every square meets the target, or has `most` samples per pixel. `on_progress` is called
/// at once and after each round of decisions. Returns how far it got, and whether it got to the end: otherwise it
/// was cancelled.
///
/// # Errors
/// When a pixel is too bright for the film.
pub fn render_adaptive(
    passes: &ProgressiveRenderer<'_>,
    target: NoiseTarget,
    max_samples: u32,
    on_progress: &dyn Fn(&NoiseProgress),
) -> Result<(NoiseProgress, bool)> {
    let film = passes.film();
    let squares = AdaptiveTiles::new(film.frame());
    // The error of each square at its last decision, and at how many samples that was.
    let mut last = vec![Decision { samples: 0, error: f64::INFINITY }; squares.len()];
    on_progress(&noise_progress(film, &squares, &last, target, max_samples));
    let mut samples = MIN_ADAPTIVE_SAMPLES.min(max_samples);
    loop {
        let wanted = |tile: usize| last[squares.containing(tile)].error > target.error;
        let complete = passes.render_to_sample(samples, &wanted)?;
        last = update_decisions(film, &squares, &last, samples, target);
        let standing = noise_progress(film, &squares, &last, target, max_samples);
        passes.counters().set_samples_total(standing.expected_samples.end);
        on_progress(&standing);
        if !complete || standing.tiles_converged == squares.len() || samples >= max_samples {
            return Ok((standing, complete));
        }
        samples = next_decision(samples, max_samples);
    }
}

/// The decisions of all squares at so many samples. Those that are done stay done; one that has gone on
/// from here already, before a stop, has not been good enough here.
fn update_decisions(
    film: &Film,
    squares: &AdaptiveTiles,
    last: &[Decision],
    samples: u32,
    target: NoiseTarget,
) -> Vec<Decision> {
    let one = |(square, before): (usize, &Decision)| {
        let is_due = before.error > target.error && squares.has_samples(film, square, samples);
        if is_due { Decision::new(&squares.noise(film, square), samples, target) } else { *before }
    };
    last.par_iter().enumerate().map(one).collect()
}

fn noise_progress(
    film: &Film,
    squares: &AdaptiveTiles,
    last: &[Decision],
    target: NoiseTarget,
    most: u32,
) -> NoiseProgress {
    let total = |side: f64| -> u64 {
        let samples = last.iter().map(|decision| decision.forecast(side, target, most));
        samples.enumerate().map(|(square, n)| u64::from(n) * squares.pixels(film, square)).sum()
    };
    NoiseProgress {
        target,
        tiles: squares.len(),
        tiles_converged: last.iter().filter(|decision| decision.error <= target.error).count(),
        worst_error: last.iter().map(|decision| decision.error).fold(0.0, f64::max),
        expected_samples: total(-1.0)..total(1.0),
    }
}

/// The error that 19 of 20 values (for a confidence of 0.95) stay below, estimated from about a thousand
/// pixels of some squares all over the picture: a few milliseconds. `None` before anything is known.
pub fn estimate_error(film: &Film, confidence: f64) -> Option<f64> {
    let squares = AdaptiveTiles::new(film.frame());
    let step = squares.len().div_ceil(PROBED_TILES).max(1);
    let probed: Vec<_> =
        (0..squares.len()).step_by(step).map(|square| squares.estimates(film, square)).collect();
    let pixels: usize = probed.iter().map(Vec::len).sum();
    // Odd, so that they do not lie in one column of each square.
    let every = (pixels / PROBED_PIXELS).max(1) | 1;
    let probed: Vec<TileNoise> =
        probed.iter().map(|pixels| TileNoise::with_stride(pixels, every)).collect();
    error_quantile(&probed, confidence)
}

/// How far the truth may be from the mean of each pixel, per channel, with this confidence: half the
/// width of the interval, along the rows of the window. Infinite where nothing is known, also where
/// squares are not summed.
pub fn confidence_half_widths(film: &Film, confidence: f64) -> Vec<[f64; 3]> {
    let window = film.frame().window;
    let mut all = vec![[f64::INFINITY; 3]; film.frame().pixel_count()];
    let squares = AdaptiveTiles::new(film.frame());
    for square in 0..squares.len() {
        let widths = noise::confidence_half_widths(&squares.estimates(film, square), confidence);
        for (widths, [x, y]) in widths.into_iter().zip(squares.pixels_of(film, square)) {
            all[((y - window.y) * window.width + (x - window.x)) as usize] = widths;
        }
    }
    all
}

/// A square's last decision.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Decision {
    samples: u32,
    /// At most the target's where it is met.
    error: f64,
}

impl Decision {
    fn new(square: &TileNoise, samples: u32, target: NoiseTarget) -> Self {
        let error = square.error_quantile(target.confidence).unwrap_or(0.0);
        // The share is what decides; the error is found by steps, and may be off in its last digit.
        let error = match square.meets(target) {
            true => error.min(target.error),
            false => error.max(target.error * (1.0 + 1e-9)),
        };
        Self { samples, error }
    }

    /// The samples at which the square will be done, if the error falls with the square root of their
    /// number. `side`: -1 if it is as much smaller than estimated as it may be, 1 if it is larger.
    fn forecast(self, sign: f64, target: NoiseTarget, max_samples: u32) -> u32 {
        if self.error <= target.error || self.samples == 0 {
            return self.samples.max(MIN_ADAPTIVE_SAMPLES.min(max_samples));
        }
        let factor = 1.0 + sign * ERROR_UNCERTAINTY / f64::from(self.samples).sqrt();
        let ratio = factor * self.error / target.error;
        let needed = f64::from(self.samples) * ratio * ratio;
        // Not met so far, so it will be decided again, whatever the factor.
        let mut samples = next_decision(self.samples, max_samples);
        while f64::from(samples) < needed && samples < max_samples {
            samples = next_decision(samples, max_samples);
        }
        samples
    }
}

/// Squares decide at 64, 128, 256, ... samples, and for the last time at `most`.
fn next_decision(samples: u32, most: u32) -> u32 {
    samples.saturating_mul(2).min(most)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TARGET: NoiseTarget = NoiseTarget { error: 0.01, confidence: 0.95 };

    #[test]
    fn decisions_double_and_end_at_the_most() {
        let all = |most: u32| {
            let mut samples = MIN_ADAPTIVE_SAMPLES.min(most);
            let mut all = vec![samples];
            while samples < most {
                samples = next_decision(samples, most);
                all.push(samples);
            }
            all
        };
        assert_eq!(all(64), [64]);
        assert_eq!(all(300), [64, 128, 256, 300]);
        assert_eq!(all(u32::MAX).len(), 27);
    }

    #[test]
    fn the_forecast_follows_the_square_root_and_has_a_spread() {
        let at = |samples, error| Decision { samples, error };
        let forecast = |decision: Decision| {
            [-1.0, 0.0, 1.0].map(|side| decision.forecast(side, TARGET, 100_000))
        };
        // Four times the error needs sixteen times the samples.
        assert_eq!(forecast(at(1024, 0.0399)), [16384, 16384, 32768]);
        assert_eq!(forecast(at(64, 0.0399)), [1024, 1024, 2048]);
        // Nearly done, and done.
        assert_eq!(forecast(at(1024, 0.010001)), [2048; 3]);
        assert_eq!(forecast(at(1024, 0.01)), [1024; 3]);
        // Out of reach, and unknown.
        assert_eq!(forecast(at(64, 5.0)), [100_000; 3]);
        assert_eq!(forecast(at(0, f64::INFINITY)), [64; 3]);
    }
}
