//! A render as a value, and everything that the library does with it.
//!
//! A [`Job`] says what to compute and until when; [`run`] renders it. Whoever wants to look at a render
//! while it runs, to stop, extend, save or resume it, opens a [`Session`]. Samples that were rendered are
//! a [`Checkpoint`]: [`Session::resume`] goes on with it, [`merge`] adds several up. What a picture's file
//! says of how it was made is [`Metadata`], of which [`reproduce`] renders it again.

mod adaptive;
mod aovs;
mod checkpoint;
mod cryptomatte;
pub mod difference;
mod film_format;
mod memory;
pub mod merge;
pub mod metadata;
mod monitor;
mod noise;
mod observer;
mod outcome;
pub mod pace;
mod passes;
mod render_state;
pub mod reproduce;
mod samples;
pub mod save;
mod save_request;
mod session;
mod spec;
mod squares;
mod start;
mod turns;

pub use adaptive::{FIRST_DECISION, Standing, error_so_far, half_widths, render_to};
pub use aovs::{needs_scene, picture, picture_of_sums};
pub use checkpoint::{
    Checkpoint, Delivery, FilePath, Header, Statistics, Status, is_checkpoint, write_checkpoint,
};
pub use film_format::format_of;
pub use memory::{MemoryPlan, Step};
pub use metadata::{COMMIT, Metadata, RunRecord, VERSION};
pub use noise::NoiseTarget;
pub use observer::{Observer, Progress};
pub use outcome::{End, NoiseStatus, Outcome, Reached, crop_of, warnings};
pub use passes::{Counters, Passes};
pub use samples::{Samples, Share, Shares, TileCounts};
pub use save_request::SaveRequest;
pub use session::{Opening, Session};
pub use spec::{ENDLESS, Job, Until};
pub use turns::Turns;

use crate::accel::Accel;
use crate::error::Result;
use crate::film::{Film, Kind};
use crate::image_io::Picture;
use crate::scene::{Scene, Shot};
use crate::task::Cancel;

/// Renders a job, and tells `observer` on this thread how far it is; `&()` does not look on.
///
/// # Errors
/// When the job makes no sense, the intersector cannot be built, there is no memory for the picture, or
/// a pixel is too bright for the film.
pub fn run(scene: &Scene, job: &Job, observer: &dyn Observer) -> Result<Outcome> {
    let session = Session::new(scene, job.clone(), Opening::default())?;
    let reached = session.run(observer)?;
    Ok(session.outcome(reached))
}

/// A picture that was rendered on the current thread pool.
#[derive(Debug)]
pub struct Rendered {
    /// The picture.
    pub picture: Picture,
    /// Samples rendered.
    pub samples: u64,
    /// Rays traced, shadow rays included.
    pub rays: u64,
    /// Whether all samples were rendered.
    pub complete: bool,
    /// What the user should know about the picture.
    pub warnings: Vec<String>,
}

/// Renders all samples of a shot on the current rayon thread pool, with an intersector that is there
/// already: for those who render many pictures of one scene. Cancelled, it gives the picture so far.
///
/// # Errors
/// When there is no memory for the picture, or a pixel is too bright for the film.
pub fn render(
    shot: &Shot,
    accel: &dyn Accel,
    layers: &[Kind],
    cancel: &Cancel,
) -> Result<Rendered> {
    let film = Film::new(&format_of(shot, layers))?;
    let samples = shot.render().samples_per_pixel;
    let counters = Counters::of(&film, film.frame().pixels() as u64 * u64::from(samples));
    let passes = Passes::new(shot, accel, &film, &counters, cancel);
    let complete = passes.advance(samples, &|_| true)?;
    Ok(Rendered {
        picture: picture(shot, accel, &film, layers),
        samples: counters.samples_done(),
        rays: counters.tally().rays,
        complete,
        warnings: warnings(shot, &counters.tally(), &film),
    })
}
