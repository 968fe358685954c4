//! Where a resumed render starts: at the samples of its checkpoint, if that is of the same render.

use std::ops::Range;

use crate::error::{Error, Result};
use crate::film::{Film, Format};

use super::adaptive::FIRST_DECISION;
use super::checkpoint::{Checkpoint, Header, Statistics};
use super::metadata::Metadata;
use super::noise::NoiseTarget;
use super::spec::Job;

/// The film of a checkpoint, and what it took.
///
/// # Errors
/// When it is of another render, or damaged.
pub(super) fn of(
    checkpoint: Checkpoint,
    metadata: &Metadata,
    format: &Format,
    samples: &Range<u32>,
    job: &Job,
) -> Result<(Film, Statistics)> {
    let path = checkpoint.path().to_path_buf();
    let refused = |what: String| {
        Error::input(format!("cannot resume `{}`: {what}", path.display()))
            .with_help("name another file, or remove this one to start anew")
    };
    let header = checkpoint.header().clone();
    if let Some(what) = difference(&header, metadata, format) {
        return Err(refused(what));
    }
    let film = checkpoint.film()?;
    let most = film.fewest_and_most().1;
    let (then, now) = (header.job.until.noise, job.until.noise);
    if now.is_some_and(|now| most > FIRST_DECISION && !asks_no_less(now, then)) {
        let words = |noise: Option<NoiseTarget>| {
            noise.map_or("none".to_owned(), |target| target.to_string())
        };
        let (then, now) = (words(then), words(now));
        return Err(refused(format!(
            "its noise target was {then}, and some squares are beyond {now} already"
        )));
    }
    if most > samples.len() as u32 {
        let (has, asked) = (samples.start + most, samples.end);
        return Err(refused(format!(
            "it has samples up to {has}, more than the {asked} that are asked for"
        )));
    }
    Ok((film, header.statistics))
}

/// Whether a noise target asks for no more noise than another: then every decision of that one to go on
/// is one of this one too.
fn asks_no_less(now: NoiseTarget, then: Option<NoiseTarget>) -> bool {
    then.is_some_and(|then| now.confidence == then.confidence && now.error <= then.error)
}

/// What differs between the render that a checkpoint is of and the one that is asked for.
fn difference(header: &Header, now: &Metadata, format: &Format) -> Option<String> {
    let then = &header.metadata;
    if (then.scene_identity, then.job_identity) != (now.scene_identity, now.job_identity) {
        return Some(format!("it is of another render: {}", then.difference(now)));
    }
    let (ours, theirs) = (format, &header.film);
    if theirs.frame != ours.frame {
        let (theirs, ours) = (theirs.frame.window, ours.frame.window);
        return Some(format!("it is of the crop {theirs}, not {ours}"));
    }
    if theirs.first_sample != ours.first_sample {
        return Some(format!(
            "its samples start at {}, not at {}",
            theirs.first_sample, ours.first_sample
        ));
    }
    (theirs != ours).then(|| "it keeps other layers".to_owned())
}
