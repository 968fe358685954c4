//! Warnings about options of a render that change nothing.

use crate::accel::{Backend, BuildQuality};
use crate::cli::outputs::Outputs;
use crate::job::OutputSpec;
use crate::overlay::OverlayChoice;
use crate::scene::Scene;

use super::request::RenderRequest;

/// Returns a warning for each option that has no effect on this render. `has_checkpoint` is true if
/// it writes a checkpoint or a part.
pub(super) fn idle_options(
    request: &RenderRequest,
    scene: &Scene,
    outputs: &Outputs,
    has_checkpoint: bool,
) -> Vec<String> {
    let mut warnings = Vec::from_iter(idle_build(request, scene));
    if !has_checkpoint {
        warnings.extend(idle_save_interval(&request.delivery));
        // Samples that are kept can still become a picture with texts.
        warnings.extend(undrawn_overlay(&request.delivery, outputs));
    }
    warnings
}

/// A warning if the option `--build` changes nothing.
fn idle_build(request: &RenderRequest, scene: &Scene) -> Option<String> {
    let quality = request.job.quality;
    let backend = request.job.accel.select(scene.spheres()).backend;
    let is_idle = quality != BuildQuality::default() && backend != Backend::Native;
    is_idle.then(|| {
        let (build, name) = (quality.name(), backend.name());
        format!("`--build {build}` has no effect: the intersector is `{name}`")
    })
}

/// A warning if the option `--checkpoint-every` was given to a render without a checkpoint.
fn idle_save_interval(delivery: &OutputSpec) -> Option<String> {
    let every = delivery.save_every;
    (every != OutputSpec::default().save_every).then(|| {
        let seconds = every.as_secs_f64();
        format!(
            "`--checkpoint-every {seconds}s` has no effect: nothing is saved while the render runs; \
             add --checkpoint FILE"
        )
    })
}

/// A warning if something is to be drawn over pictures none of which has a place for it.
fn undrawn_overlay(delivery: &OutputSpec, outputs: &Outputs) -> Option<String> {
    let pictures = outputs.pictures();
    let has_place = delivery.preview.is_some() || pictures.iter().any(|file| file.holds_overlay());
    if has_place || pictures.is_empty() {
        return None;
    }
    let option = first_drawn(&delivery.overlay)?;
    Some(format!(
        "`{option}` has no effect: only .png files and the layers of .exr files have texts; add one: \
         -o a.png"
    ))
}

/// The first option that asks for something over the picture.
fn first_drawn(overlay: &OverlayChoice) -> Option<&'static str> {
    let given = [
        ("--title", overlay.title.is_some()),
        ("--scale-bar", overlay.scale_bar),
        ("--axes", overlay.tripod),
        ("--font-size", overlay.font_size.is_some()),
    ];
    given.into_iter().find_map(|(option, given)| given.then_some(option))
}
