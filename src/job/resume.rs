//! Validates a checkpoint against a job and loads its film.

use std::ops::Range;

use crate::error::{Error, Result};
use crate::film::{Film, FilmFormat};

use super::adaptive::MIN_ADAPTIVE_SAMPLES;
use super::checkpoint::{Checkpoint, CumulativeStats};
use super::metadata::Metadata;
use super::noise::NoiseTarget;
use super::spec::Job;

/// Loads the film and statistics of a checkpoint.
///
/// # Errors
/// If the checkpoint belongs to another render or is damaged.
pub(super) fn load_film(
    checkpoint: Checkpoint,
    metadata: &Metadata,
    format: &FilmFormat,
    samples: &Range<u32>,
    job: &Job,
) -> Result<(Film, CumulativeStats)> {
    let path = checkpoint.path().map(|path| format!("`{}`", path.display()));
    let error = |reason: String| match &path {
        Some(path) => Error::input(format!("cannot resume {path}: {reason}"))
            .with_help("name another file, or remove this one to start over"),
        None => Error::input(format!("cannot resume the checkpoint: {reason}")),
    };
    let header = checkpoint.header().clone();
    check_matches((&header.metadata, &header.film), (metadata, format)).map_err(error)?;
    let film = checkpoint.into_film()?;
    check_can_continue(&film, header.job.until.noise, samples, job).map_err(error)?;
    Ok((film, header.statistics))
}

/// Rejects a job that asks for less than the film holds. `recorded_target` is the film's noise
/// target.
///
/// # Errors
/// Describes what the job lacks.
pub(super) fn check_can_continue(
    film: &Film,
    recorded_target: Option<NoiseTarget>,
    samples: &Range<u32>,
    job: &Job,
) -> std::result::Result<(), String> {
    let max_count = film.sample_count_range().1;
    let target = job.until.noise;
    if target.is_some_and(|target| {
        max_count > MIN_ADAPTIVE_SAMPLES && !is_at_least_as_strict(target, recorded_target)
    }) {
        let describe = |noise: Option<NoiseTarget>| {
            noise.map_or("none".to_owned(), |target| target.to_string())
        };
        let (recorded_target, target) = (describe(recorded_target), describe(target));
        return Err(format!(
            "its noise target was {recorded_target}, and some tiles already have more samples than {target} needs"
        ));
    }
    if max_count > samples.len() as u32 {
        let (end, requested) = (samples.start + max_count, samples.end);
        return Err(format!(
            "it has samples up to {end}, more than the {requested} that are requested"
        ));
    }
    Ok(())
}

/// Returns true if `target` is at least as strict as `recorded_target`. Every decision to continue
/// under `recorded_target` is then also valid under `target`.
fn is_at_least_as_strict(target: NoiseTarget, recorded_target: Option<NoiseTarget>) -> bool {
    recorded_target.is_some_and(|recorded_target| {
        (target.confidence, target.display) == (recorded_target.confidence, recorded_target.display)
            && target.error <= recorded_target.error
    })
}

/// Rejects samples of another render.
///
/// # Errors
/// Describes the difference.
pub(super) fn check_matches(
    (recorded, recorded_film): (&Metadata, &FilmFormat),
    (requested, film): (&Metadata, &FilmFormat),
) -> std::result::Result<(), String> {
    if (recorded.scene_identity, recorded.job_identity)
        != (requested.scene_identity, requested.job_identity)
    {
        return Err(format!(
            "it belongs to another render: {}",
            recorded.describe_difference(requested)
        ));
    }
    if recorded_film.frame != film.frame {
        let (recorded_crop, crop) = (recorded_film.frame.window, film.frame.window);
        return Err(format!("its crop is {recorded_crop}, not {crop}"));
    }
    if recorded_film.first_sample != film.first_sample {
        return Err(format!(
            "its samples start at {}, not at {}",
            recorded_film.first_sample, film.first_sample
        ));
    }
    (recorded_film == film).then_some(()).ok_or_else(|| "it has different layers".to_owned())
}
