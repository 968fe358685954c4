//! Where a render starts: at nothing, or where its checkpoint is.

use std::ops::Range;
use std::path::PathBuf;
use std::time::Duration;

use crate::error::{Error, Result};
use crate::film::{Film, Format};
use crate::output::{PartFile, PartHead, Record, WholeFile};
use crate::provenance::Made;
use crate::render::FIRST_DECISION;

use super::super::args::RenderArgs;
use super::super::goal::ENDLESS;
use super::super::outputs::Outputs;
use super::super::print;

/// The file that keeps the samples so far.
pub(super) struct Keep {
    pub(super) path: PathBuf,
    pub(super) file: WholeFile,
    pub(super) every: Duration,
}

/// What there is before the first sample of this run.
pub(super) struct Start {
    pub(super) film: Film,
    pub(super) before: Before,
}

/// What earlier runs took.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Before {
    pub(super) rays: u64,
    pub(super) seconds: f64,
    pub(super) media_overflows: u64,
    pub(super) cut_off: u64,
}

impl Keep {
    /// The checkpoint, or the part that is asked for, if either is.
    ///
    /// # Errors
    /// When both are, or it cannot be written.
    pub(super) fn new(args: &RenderArgs, outputs: &Outputs) -> Result<Option<Self>> {
        let path = match (&args.keep.checkpoint, outputs.part()) {
            (Some(checkpoint), Some(part)) if checkpoint != part => {
                let message = format!(
                    "`{}` is kept as a checkpoint already, so there is no need of `{}`",
                    part.display(),
                    checkpoint.display()
                );
                return Err(Error::input(message).with_help("leave out --checkpoint"));
            }
            (Some(path), _) => path.clone(),
            (None, Some(path)) => path.to_path_buf(),
            (None, None) => return Ok(None),
        };
        let file = WholeFile::new(&path)?;
        Ok(Some(Self { path, file, every: args.keep.checkpoint_every }))
    }
}

/// Goes on with the file that keeps the samples, where there is one, or starts with nothing.
///
/// # Errors
/// When that file is of another render, or damaged; when there is no memory.
pub(super) fn of(
    keep: Option<&Keep>,
    made: &Made,
    format: &Format,
    samples: &Range<u32>,
    noise: Option<&str>,
    quiet: bool,
) -> Result<Start> {
    let Some(keep) = keep.filter(|keep| keep.path.exists()) else {
        return Ok(Start { film: Film::new(format)?, before: Before::default() });
    };
    let part = PartFile::open(&keep.path)?;
    let then = Made::read(&keep.path, &part.head().records)?;
    let foreign = difference(&then, made, part.head(), format);
    if let Some(what) = foreign {
        return Err(refused(keep, &what));
    }
    let before = Before::of(&part.head().records);
    let noise_then = part.head().records.iter().find(|record| record.name == "noise");
    let noise_then = noise_then.map(|record| record.text.clone());
    let noise_then = noise_then.as_deref();
    let film = part.film()?;
    let most = film.fewest_and_most().1;
    if noise.is_some_and(|noise| most > FIRST_DECISION && !is_at_most(noise, noise_then)) {
        let words = |noise: Option<&str>| noise.unwrap_or("none").to_owned();
        let (then, now) = (words(noise_then), words(noise));
        let what =
            format!("its noise target was {then}, and some squares are beyond {now} already");
        return Err(refused(keep, &what));
    }
    if most > samples.len() as u32 {
        let (has, asked) = (samples.start + most, samples.end);
        let what = format!("it has samples up to {has}, more than the {asked} that are asked for");
        return Err(refused(keep, &what));
    }
    if !quiet {
        let each = film.samples() as f64 / film.frame().pixels() as f64;
        let all = match samples.end {
            ENDLESS => String::new(),
            _ => format!(" of {}", samples.len()),
        };
        let path = keep.path.display();
        print::remark(format_args!("going on with `{path}`: {each:.1}{all} samples per pixel"));
    }
    Ok(Start { film, before })
}

/// Whether a noise target, in words, asks for no more noise than another: then every decision of that
/// one to go on is one of this one too.
fn is_at_most(noise: &str, other: Option<&str>) -> bool {
    let parts = |text: &str| -> Option<(f64, String)> {
        let (error, share) = text.split_once(' ')?;
        Some((error.parse().ok()?, share.to_owned()))
    };
    match (parts(noise), other.and_then(parts)) {
        (Some((now, share)), Some((then, same))) => share == same && now <= then,
        _ => false,
    }
}

fn refused(keep: &Keep, what: &str) -> Error {
    Error::input(format!("cannot go on with `{}`: {what}", keep.path.display()))
        .with_help("name another file, or remove this one to start anew")
}

/// What differs between the render that a part is of and the one that is asked for.
fn difference(then: &Made, now: &Made, head: &PartHead, format: &Format) -> Option<String> {
    if then.identity != now.identity {
        return Some(format!("it is of another render: {}", then.difference(now)));
    }
    let (ours, theirs) = (format, &head.format);
    let rect = |format: &Format| {
        let window = format.frame.window;
        let (right, bottom) = (window.x + window.width, window.y + window.height);
        format!("{},{},{right},{bottom}", window.x, window.y)
    };
    if theirs.frame != ours.frame {
        return Some(format!("it is of the crop {}, not {}", rect(theirs), rect(ours)));
    }
    if theirs.first_sample != ours.first_sample {
        return Some(format!(
            "its samples start at {}, not at {}",
            theirs.first_sample, ours.first_sample
        ));
    }
    (theirs != ours).then(|| "it keeps other layers".to_owned())
}

impl Before {
    fn of(records: &[Record]) -> Self {
        let text = |name: &str| records.iter().find(|record| record.name == name);
        let whole = |name: &str| text(name).and_then(|record| record.text.parse().ok());
        Self {
            rays: whole("rays").unwrap_or(0),
            seconds: text("seconds").and_then(|record| record.text.parse().ok()).unwrap_or(0.0),
            media_overflows: whole("media-overflows").unwrap_or(0),
            cut_off: whole("cut-off").unwrap_or(0),
        }
    }
}
