//! When a render ends: at a number of samples, at a target of noise, or when its time is up.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::accel::Cancel;
use crate::error::{Error, Result};
use crate::film::{BLOCK, Film};
use crate::render::{self, Session, Standing, Target};
use crate::sampling::SamplerKind;
use crate::scene::description::{Integrator, Render};
use crate::scene::{Override, Scene};

use super::args::StopArgs;
use super::print;
use super::watch::{Deadline, Told};

/// Samples per pixel of a render that only its time ends: more than anybody has time for, in whole
/// blocks, and a multiple of all usual numbers of sub-pixels.
pub(super) const ENDLESS: u32 = 74_565 * 60 * 60 * BLOCK;

/// Of an error that nobody asked for.
pub(super) const CONFIDENCE: f64 = 0.95;

/// What a render is to reach.
pub(super) struct Goal {
    noise: Option<Target>,
    most: u32,
    time: Option<Duration>,
    is_time_up: AtomicBool,
}

/// What it reached.
pub(super) struct Reached {
    /// Whether it came to its end, be that the end of its time.
    pub(super) is_complete: bool,
    /// How far the target of noise is met, where there is one.
    pub(super) standing: Option<Standing>,
    /// The error that a share of the picture's values stay below, 95 % where no other is asked for;
    /// `None` where nothing is known.
    pub(super) error: Option<f64>,
}

impl Goal {
    /// `most` samples, where the options say nothing else.
    ///
    /// # Errors
    /// Where the options need numbers of samples that nobody knows before, and the scene's sampler has
    /// to know them.
    pub(super) fn new(args: &StopArgs, scene: &Scene, most: u32) -> Result<Self> {
        let render = &scene.description().render;
        let option = match (args.noise, args.time) {
            (Some(_), _) => Some("--noise"),
            (None, Some(_)) => Some("--time"),
            (None, None) => None,
        };
        if let Some(option) = option {
            refuse_counted_samples(option, render)?;
        }
        let noise = args.noise.map(|error| Target { error, confidence: args.confidence });
        Ok(Self { noise, most, time: args.time, is_time_up: AtomicBool::new(false) })
    }

    /// What the options change in the scene: the most samples that there can be.
    pub(super) fn overrides(args: &StopArgs, given_spp: bool) -> Option<Override> {
        let (option, most) = match (args.noise, args.time) {
            (Some(_), _) => (format!("--max-spp {}", args.max_spp), args.max_spp),
            (None, Some(_)) if !given_spp => ("--time".to_owned(), ENDLESS),
            _ => return None,
        };
        Some(Override {
            option,
            key: "render.samples_per_pixel".to_owned(),
            value: most.to_string(),
        })
    }

    /// The end of the time, counted from now, but for the seconds that runs before this one took. Where
    /// those were all of it, nothing more is to be done: it is up at once.
    pub(super) fn deadline(&self, film: &Film, spent: f64, cancel: Cancel) -> Option<Deadline<'_>> {
        let at_least = film.frame().pixels() as u64 * u64::from(BLOCK.min(self.most));
        let is_up = &self.is_time_up;
        let left =
            self.time?.saturating_sub(Duration::try_from_secs_f64(spent).unwrap_or_default());
        let deadline = Deadline { at: Instant::now() + left, cancel, at_least, is_up };
        deadline.mind(film.samples());
        Some(deadline)
    }

    /// The error of a film by the measure of the target.
    pub(super) fn error(&self, film: &Film) -> Option<f64> {
        render::error_so_far(film, self.confidence())
    }

    /// The noise that is asked for.
    pub(super) fn noise_in_words(&self) -> Option<String> {
        self.noise.map(|target| format!("{} for {} of the values", target.error, target.confidence))
    }

    /// Whether the render is ended by its time.
    pub(super) fn is_time_up(&self) -> bool {
        self.is_time_up.load(Ordering::Relaxed)
    }

    fn confidence(&self) -> f64 {
        self.noise.map_or(CONFIDENCE, |target| target.confidence)
    }

    /// Renders until it is reached, or cancelled.
    ///
    /// # Errors
    /// When a pixel is too bright for the film.
    pub(super) fn reach(&self, session: &Session<'_>, told: &Told) -> Result<Reached> {
        let (standing, ended) = match self.noise {
            Some(target) => {
                let tell = |standing: &Standing| told.standing(standing.clone());
                let (standing, ended) = render::render_to(session, target, self.most, &tell)?;
                (Some(standing), ended)
            }
            None => (None, session.advance(self.most, &|_| true)?),
        };
        let is_complete = ended || self.is_time_up();
        let error = self.error(session.film());
        Ok(Reached { is_complete, standing, error })
    }

    /// What is reached where the threads that render are left behind, as far as they have told.
    pub(super) fn reached_so_far(&self, film: &Film, told: &Told) -> Reached {
        let (standing, error) = (told.last_standing(), self.error(film));
        Reached { is_complete: self.is_time_up(), standing, error }
    }
}

/// Refuses what spreads its samples over a number that must be known before.
///
/// # Errors
/// With what it is, and what to use in its place.
pub(super) fn refuse_counted_samples(option: &str, render: &Render) -> Result<()> {
    let refuse = |what: &str, help: &str| {
        let message = format!("{option} decides when to stop, but {what}");
        Err(Error::input(message).with_help(help))
    };
    if render.sampler == SamplerKind::Stratified {
        let what = "stratified samples are spread over a number that is known before";
        return refuse(what, "choose `--sampler sobol` or `--sampler independent`");
    }
    if let Integrator::Paper(paper) = render.integrator {
        let cells = paper.subpixels.pow(2);
        if BLOCK % cells != 0 {
            let k = paper.subpixels;
            let what =
                format!("{k} x {k} sub-pixels do not fit into its blocks of {BLOCK} samples");
            return refuse(&what, "use 1, 2 or 4 sub-pixels along each side");
        }
    }
    Ok(())
}

impl Reached {
    /// Whether the picture is what was asked for.
    pub(super) fn is_good_enough(&self) -> bool {
        self.standing.as_ref().is_none_or(|standing| standing.done == standing.squares)
    }

    /// What to tell where it is not.
    pub(super) fn complaint(&self) -> Option<String> {
        let Standing { target, squares, done, worst, .. } = self.standing.as_ref()?;
        let open = squares - done;
        (open > 0).then(|| {
            let error = match worst.is_finite() {
                true => format!("the worst has an error of {}", print::percent(*worst)),
                false => "their errors are not known yet".to_owned(),
            };
            let target = print::percent(target.error);
            format!(
                "the noise target of {target} is not met in {open} of {squares} squares; {error}"
            )
        })
    }

    pub(super) fn in_json(&self) -> Value {
        self.standing.as_ref().map_or(Value::Null, |standing| {
            json!({
                "target": standing.target.error,
                "confidence": standing.target.confidence,
                "squares": standing.squares,
                "squares_done": standing.done,
                "worst": standing.worst.is_finite().then_some(standing.worst),
            })
        })
    }
}
