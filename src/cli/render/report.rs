//! What a render says of itself at its end.

use std::fmt::Write;
use std::path::Path;

use serde_json::json;

use crate::accel::{Accel, Backend};
use crate::error::Result;
use crate::film::{Film, Picture};
use crate::scene::Scene;

use super::super::args::RenderArgs;
use super::super::goal::Reached;
use super::super::{outputs, print, system};

/// What this run took, in seconds, and what found the hits.
#[derive(Clone, Debug, Default)]
pub(super) struct Figures {
    pub(super) load_s: f64,
    pub(super) build_s: f64,
    pub(super) render_s: f64,
    pub(super) accel: AccelFigures,
}

/// The intersector, why it, and what it is like.
#[derive(Clone, Debug, Default)]
pub(super) struct AccelFigures {
    name: &'static str,
    reason: String,
    details: String,
    bytes: usize,
}

impl AccelFigures {
    pub(super) fn of(backend: Backend, reason: String, accel: &dyn Accel) -> Self {
        Self { name: backend.name(), reason, details: accel.details(), bytes: accel.bytes() }
    }

    /// As in "native (fastest on processors with AVX2; ...)".
    pub(super) fn in_words(&self) -> String {
        let details = if self.details.is_empty() { "" } else { "; " };
        format!("{} ({}{details}{})", self.name, self.reason, self.details)
    }
}

/// All that there is to be told.
pub(super) struct Report<'a> {
    pub(super) args: &'a RenderArgs,
    pub(super) scene: &'a Scene,
    pub(super) picture: Picture,
    pub(super) reached: &'a Reached,
    /// Of this run.
    pub(super) samples: u64,
    /// And of those before it.
    pub(super) samples_in_all: u64,
    /// Of this run.
    pub(super) rays: u64,
    /// What was written.
    pub(super) ending: String,
    pub(super) figures: Figures,
    pub(super) warnings: Vec<String>,
}

/// What was written, and how to go on where that is not all.
pub(super) fn ending(
    args: &RenderArgs,
    film: &Film,
    is_complete: bool,
    kept: Option<&Path>,
) -> String {
    let mut text = format!("wrote {}", outputs::in_words(&args.output.files));
    if !is_complete {
        let per_pixel = film.samples() as f64 / film.frame().pixels() as f64;
        text += &format!(", stopped after {per_pixel:.1} samples per pixel");
        if let Some(kept) = kept {
            text += &format!("\ngo on with: photosphere resume '{}'", kept.display());
        }
    }
    text
}

impl Report<'_> {
    /// # Errors
    /// When the standard output is closed.
    pub(super) fn print(&self) -> Result<()> {
        if !self.args.quiet {
            print::remark(self.in_words());
        }
        if self.args.json { print::json(&self.in_json()) } else { Ok(()) }
    }

    fn in_words(&self) -> String {
        let Figures { load_s, build_s, render_s, accel } = &self.figures;
        let mut text = String::new();
        let mut line = |words: std::fmt::Arguments<'_>| {
            text.write_fmt(words).expect("a string takes all that is written to it");
        };
        line(format_args!("intersector {}\n", accel.in_words()));
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
        line(format_args!("\n{}", self.ending));
        text
    }

    fn in_json(&self) -> serde_json::Value {
        let Figures { load_s, build_s, render_s, accel } = &self.figures;
        json!({
            "output": outputs::in_words(&self.args.output.files),
            "complete": self.reached.is_complete,
            "accel": accel.name,
            "accel_reason": accel.reason,
            "accel_details": accel.details,
            "accel_bytes": accel.bytes,
            "spheres": self.scene.spheres().len(),
            "width": self.picture.width,
            "height": self.picture.height,
            "threads": rayon::current_num_threads(),
            "load_s": load_s,
            "build_s": build_s,
            "render_s": render_s,
            "samples": self.samples,
            "samples_in_all": self.samples_in_all,
            "rays": self.rays,
            "error": self.reached.error,
            "noise": self.reached.in_json(),
            "samples_per_s": self.samples as f64 / render_s,
            "rays_per_s": self.rays as f64 / render_s,
            "peak_rss_bytes": system::peak_memory(),
            "mean_rgb": self.picture.mean().to_array(),
            "non_finite_pixels": self.picture.non_finite(),
            "warnings": self.warnings,
        })
    }
}
