//! Adaptive sampling: renders each tile of 16 x 16 pixels until it meets the noise target.
//!
//! A tile decides when all of its pixels have 64, 128, 256, ... samples, from those samples alone.
//! The decision therefore does not depend on other tiles, on threads, on interruptions, or on the
//! crop window, as long as the window does not cut the tile.

use std::ops::Range;

use rayon::prelude::*;

use crate::error::Result;
use crate::film::Film;

use super::adaptive_tiles::AdaptiveTiles;
use super::display_scale::DisplayScale;
use super::noise::{self, NoiseTarget, TileNoise, error_quantile};
use super::progressive::ProgressiveRenderer;

/// Samples per pixel at the first decision: four blocks, the minimum for a useful variance
/// estimate.
pub const MIN_ADAPTIVE_SAMPLES: u32 = 64;

/// Relative uncertainty of the error of a tile estimated from `n` samples: this divided by the
/// square root of `n`. Two standard deviations of the measured spread (docs/stopping.md).
const ERROR_UNCERTAINTY: f64 = 1.2;

/// Approximate number of tiles used to estimate the error of the whole picture.
const PROBED_TILES: usize = 64;

/// Approximate number of pixels in those tiles whose errors are evaluated.
const PROBED_PIXELS: usize = 1024;

/// Progress of a render towards a noise target.
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseProgress {
    /// The noise target.
    pub target: NoiseTarget,
    /// Number of 16 x 16 pixel tiles in the picture.
    pub tiles: usize,
    /// Tiles that meet the target.
    pub tiles_converged: usize,
    /// The largest error of any tile, in the unit of the target; infinite while some tile has not
    /// decided yet.
    pub worst_error: f64,
    /// Lower and upper estimate of the total number of samples for the picture.
    pub expected_samples: Range<u64>,
}

/// Renders until every tile meets the target or has `max_samples` samples per pixel. Calls
/// `on_progress` at the start and after each round of decisions. Returns the progress, and true if
/// the render finished rather than being cancelled.
///
/// # Errors
/// If a pixel is too bright for the film.
pub fn render_adaptive(
    renderer: &ProgressiveRenderer<'_>,
    target: NoiseTarget,
    max_samples: u32,
    on_progress: &dyn Fn(&NoiseProgress),
) -> Result<(NoiseProgress, bool)> {
    let film = renderer.film();
    let tiles = AdaptiveTiles::new(film.frame());
    let scale = target.display_scale();
    let mut decisions = vec![Decision { samples: 0, error: f64::INFINITY }; tiles.len()];
    on_progress(&noise_progress(film, &tiles, &decisions, target, max_samples));
    let mut samples = MIN_ADAPTIVE_SAMPLES.min(max_samples);
    loop {
        let is_active =
            |film_tile: usize| decisions[tiles.containing(film_tile)].error > target.error;
        let complete = renderer.render_to_sample(samples, &is_active)?;
        decisions = update_decisions(film, &tiles, &decisions, samples, (target, scale.as_ref()));
        let progress = noise_progress(film, &tiles, &decisions, target, max_samples);
        renderer.counters().set_samples_total(progress.expected_samples.end);
        on_progress(&progress);
        if !complete || progress.tiles_converged == tiles.len() || samples >= max_samples {
            return Ok((progress, complete));
        }
        samples = next_decision(samples, max_samples);
    }
}

/// Updates the decisions of all tiles at `samples` samples per pixel. Converged tiles stay
/// converged. A tile that already has more samples, because the render was resumed, has not met the
/// target at this count, so its decision stays unchanged.
fn update_decisions(
    film: &Film,
    tiles: &AdaptiveTiles,
    decisions: &[Decision],
    samples: u32,
    (target, scale): (NoiseTarget, Option<&DisplayScale>),
) -> Vec<Decision> {
    let update = |(tile, previous): (usize, &Decision)| {
        let is_due = previous.error > target.error && tiles.has_samples(film, tile, samples);
        match is_due {
            true => Decision::new(&tiles.noise(film, tile, scale), samples, target),
            false => *previous,
        }
    };
    decisions.par_iter().enumerate().map(update).collect()
}

fn noise_progress(
    film: &Film,
    tiles: &AdaptiveTiles,
    decisions: &[Decision],
    target: NoiseTarget,
    max_samples: u32,
) -> NoiseProgress {
    let total = |sign: f64| -> u64 {
        let samples = decisions.iter().map(|decision| decision.forecast(sign, target, max_samples));
        samples.enumerate().map(|(tile, n)| u64::from(n) * tiles.pixels(film, tile)).sum()
    };
    NoiseProgress {
        target,
        tiles: tiles.len(),
        tiles_converged: decisions.iter().filter(|decision| decision.error <= target.error).count(),
        worst_error: decisions.iter().map(|decision| decision.error).fold(0.0, f64::max),
        expected_samples: total(-1.0)..total(1.0),
    }
}

/// Estimates the error, in the unit of the target, that its share of the values stays below, from
/// about a thousand pixels in tiles spread over the picture. Takes a few milliseconds. `None`
/// before something is known of each of those tiles.
pub fn estimate_error(film: &Film, target: &NoiseTarget) -> Option<f64> {
    let scale = target.display_scale();
    let tiles = AdaptiveTiles::new(film.frame());
    let step = tiles.len().div_ceil(PROBED_TILES).max(1);
    let sampled_tiles: Vec<_> =
        (0..tiles.len()).step_by(step).map(|tile| tiles.estimates(film, tile)).collect();
    let pixels: usize = sampled_tiles.iter().map(Vec::len).sum();
    // Odd, so that the samples do not fall into one column of each tile.
    let stride = (pixels / PROBED_PIXELS).max(1) | 1;
    let sampled_tiles: Vec<TileNoise> = sampled_tiles
        .iter()
        .map(|pixels| TileNoise::with_stride(pixels, scale.as_ref(), stride))
        .collect();
    error_quantile(&sampled_tiles, target.confidence)
}

/// Half-width of the confidence interval around each pixel's mean, per channel, in row order of the
/// crop window. Infinite where the error is unknown, including films without sums of squares.
pub fn confidence_half_widths(film: &Film, confidence: f64) -> Vec<[f64; 3]> {
    let window = film.frame().window;
    let mut half_widths = vec![[f64::INFINITY; 3]; film.frame().pixel_count()];
    let tiles = AdaptiveTiles::new(film.frame());
    for tile in 0..tiles.len() {
        let widths = noise::confidence_half_widths(&tiles.estimates(film, tile), confidence);
        for (widths, [x, y]) in widths.into_iter().zip(tiles.pixels_of(film, tile)) {
            half_widths[((y - window.y) * window.width + (x - window.x)) as usize] = widths;
        }
    }
    half_widths
}

/// The last decision of a tile: its sample count and error at that moment.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Decision {
    samples: u32,
    /// At most the target's error if the target is met.
    error: f64,
}

impl Decision {
    fn new(tile: &TileNoise, samples: u32, target: NoiseTarget) -> Self {
        let error = tile.error_quantile(target.confidence).unwrap_or(0.0);
        // The fraction of values above the target decides. The quantile comes from a bisection and
        // may be off in its last digit, so it is clamped to agree with the decision.
        let error = match tile.meets(target) {
            true => error.min(target.error),
            false => error.max(target.error * (1.0 + 1e-9)),
        };
        Self { samples, error }
    }

    /// Predicts the sample count at which the tile converges, assuming that the error falls with
    /// the square root of the sample count. `sign` is -1 for the lower and 1 for the upper bound of
    /// the uncertain error.
    fn forecast(self, sign: f64, target: NoiseTarget, max_samples: u32) -> u32 {
        if self.error <= target.error || self.samples == 0 {
            return self.samples.max(MIN_ADAPTIVE_SAMPLES.min(max_samples));
        }
        let factor = 1.0 + sign * ERROR_UNCERTAINTY / f64::from(self.samples).sqrt();
        let ratio = factor * self.error / target.error;
        let needed = f64::from(self.samples) * ratio * ratio;
        // The target is not met so far, so at least one more decision follows.
        let mut samples = next_decision(self.samples, max_samples);
        while f64::from(samples) < needed && samples < max_samples {
            samples = next_decision(samples, max_samples);
        }
        samples
    }
}

/// Returns the sample count of the next decision: 64, 128, 256, ... and finally `max_samples`.
fn next_decision(samples: u32, max_samples: u32) -> u32 {
    samples.saturating_mul(2).min(max_samples)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TARGET: NoiseTarget = NoiseTarget { error: 0.01, confidence: 0.95, display: None };

    #[test]
    fn decisions_double_and_end_at_the_most() {
        let counts = |max_samples: u32| {
            let mut samples = MIN_ADAPTIVE_SAMPLES.min(max_samples);
            let mut counts = vec![samples];
            while samples < max_samples {
                samples = next_decision(samples, max_samples);
                counts.push(samples);
            }
            counts
        };
        assert_eq!(counts(64), [64]);
        assert_eq!(counts(300), [64, 128, 256, 300]);
        assert_eq!(counts(u32::MAX).len(), 27);
    }

    #[test]
    fn the_forecast_follows_the_square_root_and_has_a_spread() {
        let at = |samples, error| Decision { samples, error };
        let forecast = |decision: Decision| {
            [-1.0, 0.0, 1.0].map(|sign| decision.forecast(sign, TARGET, 100_000))
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
