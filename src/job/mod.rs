//! Render jobs: describe a render as a value, run it, save it, merge it and reproduce it.
//!
//! A [`Job`] says what to compute and when to stop; [`run`] renders it. To monitor, stop, extend,
//! save or resume a render, open a [`Session`]. Rendered samples are stored in a [`Checkpoint`]:
//! [`Session::resume`] continues one, [`merge`] adds several. [`Metadata`] is the record in a
//! picture's file of how it was made; [`reproduce`] renders the picture again from it.

mod adaptive;
mod adaptive_tiles;
mod aovs;
mod budgeted_timer;
mod checkpoint;
mod cryptomatte;
mod denoised_record;
pub mod diff;
mod display_scale;
pub mod eta;
mod film_format;
mod memory;
pub mod merge;
pub mod metadata;
mod monitor;
mod noise;
mod noise_status;
mod observer;
mod outcome;
mod pick;
mod picture_record;
mod progressive;
mod quality;
mod recorded;
mod render_state;
pub mod reproduce;
mod resume;
mod samples;
pub mod save;
mod save_request;
mod session;
mod shown_colors;
mod spec;
mod warnings;

pub use adaptive::{
    MIN_ADAPTIVE_SAMPLES, NoiseProgress, confidence_half_widths, estimate_error, render_adaptive,
};
pub use aovs::{develop, develop_without_scene, needs_scene};
pub use budgeted_timer::BudgetedTimer;
pub use checkpoint::{
    Checkpoint, CheckpointHeader, CumulativeStats, FilePath, OutputSpec, RenderStatus,
    encode_checkpoint, is_checkpoint, write_checkpoint,
};
pub use film_format::format_for_scene;
pub use memory::{MemoryPhase, MemoryPlan};
pub use metadata::{COMMIT, Metadata, RunRecord, VERSION};
pub use noise::NoiseTarget;
pub use noise_status::NoiseStatus;
pub use observer::{FirstEstimate, Observer, RenderProgress};
pub use outcome::{RenderResult, RunOutcome, StopReason, frame_crop};
pub use pick::{Pick, pick, pick_in_scene};
pub use picture_record::PictureRecord;
pub use progressive::{Counters, ProgressiveRenderer};
pub use quality::Quality;
pub use samples::{MergedSamples, SampleRange, TileSampleCounts, WindowSamples};
pub use save_request::SaveRequest;
pub use session::{Session, SessionOptions};
pub use shown_colors::ColorDifference;
pub use spec::{Job, StopCriteria, UNLIMITED_SAMPLES};
pub use warnings::{render_warnings, scene_warnings};

use crate::accel::Accel;
use crate::error::Result;
use crate::film::{Aov, Film};
use crate::image_io::Picture;
use crate::scene::{PreparedScene, Scene};
use crate::task::CancelToken;

/// Renders a job and reports progress to `observer` on the calling thread, which may stop the
/// render; the result then has the samples so far. Pass `&()` for no reports.
///
/// # Errors
/// If the job is invalid, the intersector cannot be built, the picture does not fit into memory, or
/// a pixel is too bright for the film.
pub fn run(scene: &Scene, job: &Job, observer: &dyn Observer) -> Result<RenderResult> {
    let session = Session::new(scene, job.clone(), SessionOptions::default())?;
    let outcome = session.run(observer)?;
    Ok(session.result(outcome))
}

/// A picture rendered by [`render_with_accel`].
#[derive(Debug)]
pub struct RenderedImage {
    /// The picture.
    pub picture: Picture,
    /// Samples rendered.
    pub samples: u64,
    /// Rays traced, shadow rays included.
    pub rays: u64,
    /// True if all samples were rendered.
    pub complete: bool,
    /// Warnings for the user about the picture.
    pub warnings: Vec<String>,
}

/// Renders all samples of a prepared scene on the current rayon thread pool with an existing
/// intersector. Use this to render many pictures of one scene. If cancelled, returns the picture so
/// far.
///
/// # Errors
/// If the picture does not fit into memory, or a pixel is too bright for the film.
pub fn render_with_accel(
    prepared: &PreparedScene,
    accel: &dyn Accel,
    aovs: &[Aov],
    cancel: &CancelToken,
) -> Result<RenderedImage> {
    let film = Film::new(&format_for_scene(prepared, aovs))?;
    let samples = prepared.render_settings().samples_per_pixel;
    let counters = Counters::new(&film, film.frame().pixel_count() as u64 * u64::from(samples));
    let renderer = ProgressiveRenderer::new(prepared, accel, &film, &counters, cancel);
    let complete = renderer.render_to_sample(samples, &|_| true)?;
    Ok(RenderedImage {
        picture: develop(prepared, accel, &film, aovs),
        samples: counters.samples_done(),
        rays: counters.stats().rays,
        complete,
        warnings: render_warnings(prepared, &counters.stats(), &film),
    })
}
