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
    let refused = |what: String| match &path {
        Some(path) => Error::input(format!("cannot resume {path}: {what}"))
            .with_help("name another file, or remove this one to start anew"),
        None => Error::input(format!("cannot resume the checkpoint: {what}")),
    };
    let header = checkpoint.header().clone();
    check_matches((&header.metadata, &header.film), (metadata, format)).map_err(refused)?;
    let film = checkpoint.into_film()?;
    check_can_continue(&film, header.job.until.noise, samples, job).map_err(refused)?;
    Ok((film, header.statistics))
}

/// Rejects a job that asks for less than the film holds. `then` is the film's noise target.
///
/// # Errors
/// Describes what the job lacks.
pub(super) fn check_can_continue(
    film: &Film,
    then: Option<NoiseTarget>,
    samples: &Range<u32>,
    job: &Job,
) -> std::result::Result<(), String> {
    let most = film.sample_count_range().1;
    let now = job.until.noise;
    if now.is_some_and(|now| most > MIN_ADAPTIVE_SAMPLES && !is_at_least_as_strict(now, then)) {
        let words = |noise: Option<NoiseTarget>| {
            noise.map_or("none".to_owned(), |target| target.to_string())
        };
        let (then, now) = (words(then), words(now));
        return Err(format!(
            "its noise target was {then}, and some squares are beyond {now} already"
        ));
    }
    if most > samples.len() as u32 {
        let (has, asked) = (samples.start + most, samples.end);
        return Err(format!(
            "it has samples up to {has}, more than the {asked} that are asked for"
        ));
    }
    Ok(())
}

/// Returns true if `now` is at least as strict as `then`. Every decision to continue under `then`
/// is then also valid under `now`.
fn is_at_least_as_strict(now: NoiseTarget, then: Option<NoiseTarget>) -> bool {
    then.is_some_and(|then| now.confidence == then.confidence && now.error <= then.error)
}

/// Rejects samples of another render.
///
/// # Errors
/// Describes the difference.
pub(super) fn check_matches(
    (then, their_film): (&Metadata, &FilmFormat),
    (now, our_film): (&Metadata, &FilmFormat),
) -> std::result::Result<(), String> {
    if (then.scene_identity, then.job_identity) != (now.scene_identity, now.job_identity) {
        return Err(format!("it is of another render: {}", then.describe_difference(now)));
    }
    if their_film.frame != our_film.frame {
        let (theirs, ours) = (their_film.frame.window, our_film.frame.window);
        return Err(format!("it is of the crop {theirs}, not {ours}"));
    }
    if their_film.first_sample != our_film.first_sample {
        return Err(format!(
            "its samples start at {}, not at {}",
            their_film.first_sample, our_film.first_sample
        ));
    }
    (their_film == our_film).then_some(()).ok_or_else(|| "it keeps other layers".to_owned())
}
