//! A render as a value, and everything that the library does with it.
//!
//! A [`Job`] says what to compute and until when; [`run`] renders it. Whoever wants to look at a render
//! while it runs, to stop, extend, save or resume it, opens a [`Session`]. Samples that were rendered are
//! a [`Checkpoint`]: [`Session::resume`] goes on with it, [`merge`] adds several up. What a picture's file
//! says of how it was made is [`Metadata`], of which [`reproduce`] renders it again.

mod adaptive;
mod adaptive_tiles;
mod aovs;
mod budgeted_timer;
mod checkpoint;
mod cryptomatte;
pub mod diff;
pub mod eta;
mod film_format;
mod memory;
pub mod merge;
pub mod metadata;
mod monitor;
mod noise;
mod observer;
mod outcome;
mod progressive;
mod render_state;
pub mod reproduce;
mod resume;
mod samples;
pub mod save;
mod save_request;
mod session;
mod spec;

pub use adaptive::{
    MIN_ADAPTIVE_SAMPLES, NoiseProgress, confidence_half_widths, estimate_error, render_adaptive,
};
pub use aovs::{develop, develop_without_scene, needs_scene};
pub use budgeted_timer::BudgetedTimer;
pub use checkpoint::{
    Checkpoint, CheckpointHeader, CumulativeStats, FilePath, OutputSpec, RenderStatus,
    is_checkpoint, write_checkpoint,
};
pub use film_format::format_for_scene;
pub use memory::{MemoryPhase, MemoryPlan};
pub use metadata::{COMMIT, Metadata, RunRecord, VERSION};
pub use noise::NoiseTarget;
pub use observer::{Observer, RenderProgress};
pub use outcome::{NoiseStatus, RenderResult, RunOutcome, StopReason, frame_crop, render_warnings};
pub use progressive::{Counters, ProgressiveRenderer};
pub use samples::{MergedSamples, SampleRange, TileSampleCounts, WindowSamples};
pub use save_request::SaveRequest;
pub use session::{Session, SessionOptions};
pub use spec::{Job, StopCriteria, UNLIMITED_SAMPLES};

use crate::accel::Accel;
use crate::error::Result;
use crate::film::{Aov, Film};
use crate::image_io::Picture;
use crate::scene::{PreparedScene, Scene};
use crate::task::CancelToken;

/// Renders a job, and tells `observer` on this thread how far it is; `&()` does not look on.
///
/// # Errors
/// When the job makes no sense, the intersector cannot be built, there is no memory for the picture, or
/// a pixel is too bright for the film.
pub fn run(scene: &Scene, job: &Job, observer: &dyn Observer) -> Result<RenderResult> {
    let session = Session::new(scene, job.clone(), SessionOptions::default())?;
    let reached = session.run(observer)?;
    Ok(session.result(reached))
}

/// A picture that was rendered on the current thread pool.
#[derive(Debug)]
pub struct RenderedImage {
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
pub fn render_with_accel(
    shot: &PreparedScene,
    accel: &dyn Accel,
    aovs: &[Aov],
    cancel: &CancelToken,
) -> Result<RenderedImage> {
    let film = Film::new(&format_for_scene(shot, aovs))?;
    let samples = shot.render_settings().samples_per_pixel;
    let counters = Counters::new(&film, film.frame().pixel_count() as u64 * u64::from(samples));
    let passes = ProgressiveRenderer::new(shot, accel, &film, &counters, cancel);
    let complete = passes.render_to_sample(samples, &|_| true)?;
    Ok(RenderedImage {
        picture: develop(shot, accel, &film, aovs),
        samples: counters.samples_done(),
        rays: counters.stats().rays,
        complete,
        warnings: render_warnings(shot, &counters.stats(), &film),
    })
}
