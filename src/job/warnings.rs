//! What a user should know: likely mistakes in a scene before the render, and flaws of a picture
//! after it.

use rayon::prelude::*;

use crate::color::Rgb;
use crate::film::Film;
use crate::integrator::RenderStats;
use crate::scene::settings::IntegratorSettings;
use crate::scene::{CameraEnclosure, PreparedScene, Scene, Settings};

/// Warnings about a scene that is to be rendered with these settings.
pub fn scene_warnings(scene: &Scene, settings: &Settings) -> Vec<String> {
    let spheres = scene.spheres();
    let mut warnings = Vec::new();
    if nothing_shines(scene, settings) {
        warnings.push(
            "nothing shines, so that all spheres will be black: add `[light]` with `preset = \"softbox\"`, \
             a radiance to `[background]`, or emission to a material"
                .to_owned(),
        );
    }
    // A sphere with others inside is a room.
    let enclosure = CameraEnclosure::find(scene, &settings.image);
    if let Some(enclosure) = enclosure.filter(|enclosure| enclosure.is_empty) {
        warnings.push(format!(
            "the camera is inside the opaque sphere `{}` and sees nothing else",
            scene.name_of_row(spheres.row(enclosure.sphere)),
        ));
    } else if sees_nothing(scene, settings) {
        let [low, high] = scene.subject_bounds();
        warnings.push(format!(
            "no sphere is in view: they lie from {low:.4} to {high:.4}; `[camera]` with `fit = true` \
             shows them"
        ));
    }
    if spheres.duplicates() > 0 {
        let (count, plural) =
            (spheres.duplicates(), if spheres.duplicates() == 1 { "" } else { "s" });
        warnings
            .push(format!("{count} sphere{plural} left out: an earlier row is the same sphere"));
    }
    warnings
}

/// Returns true if there is no light in a scene whose picture shows light.
fn nothing_shines(scene: &Scene, settings: &Settings) -> bool {
    let shows_light = !matches!(
        settings.render.integrator,
        IntegratorSettings::AmbientOcclusion { .. }
            | IntegratorSettings::Normals
            | IntegratorSettings::Raycast { .. }
    );
    shows_light && !scene.has_light()
}

/// Returns true if certainly no sphere reaches into the view.
fn sees_nothing(scene: &Scene, settings: &Settings) -> bool {
    let Ok(camera) = scene.built_camera(&settings.image) else { return false };
    let margin = settings.image.filter_radius;
    let spheres = scene.spheres();
    !(0..spheres.len() as u32).into_par_iter().any(|id| camera.may_see(&spheres.sphere(id), margin))
}

/// Warnings about a film of the prepared scene.
pub fn render_warnings(prepared: &PreparedScene, stats: &RenderStats, film: &Film) -> Vec<String> {
    let mut warnings = Vec::new();
    let biases = prepared.render_settings().biases();
    if biases.iter().any(|bias| bias.starts_with("clamp_indirect")) {
        let options = biases.join(", ");
        warnings.push(format!("the picture is biased by {options}"));
    }
    if let Some((count, [x, y])) = film.non_finite_samples() {
        warnings.push(format!(
            "{count} samples were infinite or not a number and were left out, such as in column {x}, \
             row {y}: please report this"
        ));
    }
    if stats.truncated_paths > 0 {
        let count = stats.truncated_paths;
        warnings.push(format!("{count} paths were cut off after 10000 edges, which loses light"));
    }
    warnings.extend(one_color(film));
    warnings
}

/// A warning if all pixels have the same colour, and the film is not too small to tell.
fn one_color(film: &Film) -> Option<String> {
    let picture = film.picture();
    let mut pixels = picture.direct.iter().zip(&picture.indirect).map(|(a, b)| *a + *b);
    let first = pixels.next()?;
    if picture.direct.len() < 64 || !pixels.all(|pixel| pixel == first) {
        return None;
    }
    Some(match first == Rgb::ZERO {
        true => "the picture is black".to_owned(),
        false => format!("the picture has one colour everywhere: {:?}", first.to_array()),
    })
}
