//! The report that a render prints at its end.

use std::fmt::Write;
use std::path::Path;
use std::time::Duration;

use serde_json::{Value, json};

use crate::error::Result;
use crate::film::BLOCK_SIZE;
use crate::job::eta::format_time_range;
use crate::job::{ColorDifference, NoiseStatus, RunOutcome, Session, StopReason};

use super::super::recorded_outputs::resume_command;
use super::super::{outputs, print, scene_file, system};
use super::request::RenderRequest;

/// Times of the steps before rendering, in seconds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Times {
    pub(super) load_s: f64,
    pub(super) build_s: f64,
}

/// The data of the report.
pub(super) struct Report<'a> {
    pub(super) request: &'a RenderRequest,
    pub(super) session: &'a Session,
    pub(super) reached: &'a RunOutcome,
    /// The checkpoint file.
    pub(super) kept: Option<&'a Path>,
    /// Samples traced in this run.
    pub(super) samples: u64,
    /// Rays traced in this run.
    pub(super) rays: u64,
    pub(super) times: Times,
    pub(super) render_s: f64,
    /// How far the colours of particles are from those of the legend.
    pub(super) color_difference: Option<ColorDifference>,
    pub(super) warnings: Vec<String>,
}

impl Report<'_> {
    /// Prints the report.
    ///
    /// # Errors
    /// If the standard output cannot be written.
    pub(super) fn print(&self) -> Result<()> {
        if !self.request.quiet {
            print::note(self.in_words());
        }
        if self.request.json { print::json(&self.in_json()) } else { Ok(()) }
    }

    fn is_complete(&self) -> bool {
        !matches!(self.reached.stop_reason, StopReason::Stopped | StopReason::Failed)
    }

    /// Describes what was written and, if the render is unfinished, how to resume it.
    fn ending(&self) -> String {
        let film = self.session.film();
        let mut text = format!("wrote {}", self.outputs());
        if !self.is_complete() {
            let per_pixel = film.sample_count() as f64 / film.frame().pixel_count() as f64;
            text += &format!(", stopped after {per_pixel:.1} samples per pixel");
            if let Some(kept) = self.kept {
                let command = resume_command(&self.request.delivery, kept);
                // A scene that was in no file is in one by then.
                let scene = match scene_file::is_stdin(&self.request.scene) {
                    true => " --scene FILE",
                    false => "",
                };
                text += &format!("\nresume it with: {command}{scene}");
            }
        }
        text
    }

    /// Says why the render took longer than its time.
    fn told_of_time(&self) -> Option<String> {
        let limit = self.session.job().until.time?;
        let is_limited = self.reached.stop_reason == StopReason::TimeLimit;
        let (least, _) = self.session.film().sample_count_range();
        is_limited.then(|| overrun(limit, self.render_s, least)).flatten()
    }

    fn outputs(&self) -> String {
        outputs::in_words(&outputs::paths(&self.request.delivery.files))
    }

    fn in_words(&self) -> String {
        let Times { load_s, build_s } = self.times;
        let render_s = self.render_s;
        let mut text = String::new();
        let mut line = |words: std::fmt::Arguments<'_>| {
            text.write_fmt(words).expect("a string takes all that is written to it");
        };
        line(format_args!("intersector {}\n", self.session.accel_summary()));
        line(format_args!("load {load_s:.3} s, build {build_s:.3} s, render {render_s:.3} s\n"));
        line(format_args!(
            "{}samples/s, {}rays/s",
            print::si(self.samples as f64 / render_s),
            print::si(self.rays as f64 / render_s)
        ));
        if let Some(error) = self.reached.error {
            line(format_args!(", error {}", print::percent(error)));
        }
        if let Some(peak) = system::peak_memory() {
            line(format_args!(", peak memory {}", print::bytes(peak)));
        }
        if let Some(difference) = self.color_difference {
            line(format_args!(
                "\ncolours differ from the legend by {:.1} (median CIEDE2000)",
                difference.median
            ));
            if difference.is_of_mixtures {
                line(format_args!(
                    ": most particles are smaller than a pixel, which mixes their colours"
                ));
            }
        }
        if let Some(told) = self.told_of_time() {
            line(format_args!("\n{told}"));
        }
        line(format_args!("\n{}", self.ending()));
        text
    }

    fn in_json(&self) -> Value {
        let Times { load_s, build_s } = self.times;
        let session = self.session;
        let picture = session.film().picture();
        let chosen = session.job().accel.select(session.prepared().scene().spheres());
        json!({
            "output": self.outputs(),
            "complete": self.is_complete(),
            "accel": chosen.backend.name(),
            "accel_reason": chosen.reason,
            "accel_details": session.accel().details(),
            "accel_bytes": session.accel().bytes(),
            "spheres": session.prepared().scene().spheres().len(),
            "width": picture.width,
            "height": picture.height,
            "threads": session.threads(),
            "load_s": load_s,
            "build_s": build_s,
            "render_s": self.render_s,
            "samples": self.samples,
            "samples_in_all": session.film().sample_count(),
            "rays": self.rays,
            "error": self.reached.error,
            "color_difference": self.color_difference.map(|difference| difference.median),
            "noise": self.reached.noise.map(noise_in_json),
            "samples_per_s": self.samples as f64 / self.render_s,
            "rays_per_s": self.rays as f64 / self.render_s,
            "peak_rss_bytes": system::peak_memory(),
            "mean_rgb": picture.mean().to_array(),
            "non_finite_pixels": picture.non_finite(),
            "warnings": self.warnings,
        })
    }
}

/// Says that a time was too short for the least number of samples, `least` of each pixel.
fn overrun(limit: Duration, taken_s: f64, least: u32) -> Option<String> {
    // Of more samples, the last may have begun when the time was not yet up.
    let is_over = least <= BLOCK_SIZE && taken_s > 1.1 * limit.as_secs_f64() + 0.5;
    is_over.then(|| {
        let limit = format_time_range(&(limit..limit));
        format!(
            "the {limit} of --time were up before each pixel had {least} samples, the least that \
             is rendered: a smaller --size takes less"
        )
    })
}

fn noise_in_json(noise: NoiseStatus) -> Value {
    json!({
        "target": noise.target.error,
        "confidence": noise.target.confidence,
        "display": noise.target.display,
        "tiles": noise.tiles,
        "tiles_converged": noise.tiles_converged,
        "worst_error": noise.worst_error,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_that_was_too_short_is_explained() {
        let minute = Duration::from_secs(60);
        let told = overrun(minute, 200.0, 16).unwrap();
        assert!(told.starts_with("the 60 s of --time were up before each pixel had 16 "), "{told}");
        for (taken_s, least) in [(61.0, 16), (70.0, 32), (59.0, 8)] {
            assert_eq!(overrun(minute, taken_s, least), None);
        }
    }
}
