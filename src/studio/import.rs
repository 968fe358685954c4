//! Makes a scene of a particle file.

use std::path::Path;

use crate::appearance::{Framing, ViewDirection, frame};
use crate::color::Rgb;
use crate::error::{Diagnostic, Error, Result};
use crate::math::DVec3;
use crate::scene::description::SceneDescription;
use crate::scene::{Override, SceneFile, TableInput, read_text_reusing, read_text_with};

use super::compose::{Composition, toml_string};
use super::options::{Background, StudioOptions};
use super::style::StyleValues;

/// From the front, right and above.
const DEFAULT_VIEW: ViewDirection = ViewDirection::Angles { azimuth: -55.0, elevation: 25.0 };

/// Vertical field of view of a perspective: a short telephoto lens, which distorts little.
const VERTICAL_FOV_DEGREES: f64 = 30.0;

/// Pictures have this size unless an override says otherwise.
const DEFAULT_SIZE: [u32; 2] = [960, 720];

/// The key of the radius, and the beginning of that of its scale.
const RADIUS_KEY: &str = "particles.0.radius";

/// Beginnings of keys that decide what the scene is.
const DRAFT: [&str; 2] = ["particles", "image."];

/// Samples per pixel.
const SAMPLES: u32 = 64;

/// Radius of the ground in extents of the particles: flat to the eye.
const GROUND_RADIUS: f64 = 1e4;

/// Below this elevation of the camera, in degrees, a ground would hide the particles.
const MIN_GROUND_ELEVATION: f64 = 3.0;

/// A particle file as a scene.
#[derive(Debug)]
pub struct Import {
    /// The text of the scene.
    pub text: String,
    /// The scene, whose particles have been read.
    pub scene: SceneFile,
    /// The choices that were made automatically: names and values of options.
    pub choices: Vec<(&'static str, String)>,
    /// What the user should know of the file.
    pub notes: Vec<String>,
}

/// Reads a particle file and makes a scene of it. `overrides` set keys of the scene; those of
/// `particles.0` choose the look of the particles. `folder` is where relative paths of the scene
/// will start, and `path` is the file relative to it.
///
/// # Errors
/// If the file or an override is wrong.
pub fn import(
    name: &str,
    path: &Path,
    folder: &Path,
    options: &StudioOptions,
    overrides: &[Override],
) -> Result<Import> {
    import_with(name, path, folder, options, overrides, None)
}

/// Makes a scene of particles that a program has in memory, or of those of another scene that has
/// the same overrides of `particles.0` and the same style. `path` is the file that the scene names.
///
/// # Errors
/// If an override is wrong.
pub fn import_particles(
    name: &str,
    path: &Path,
    options: &StudioOptions,
    overrides: &[Override],
    particles: TableInput,
) -> Result<Import> {
    import_with(name, path, Path::new(""), options, overrides, Some(particles))
}

fn import_with(
    name: &str,
    path: &Path,
    folder: &Path,
    options: &StudioOptions,
    overrides: &[Override],
    mut given: Option<TableInput>,
) -> Result<Import> {
    let file = toml_string(&path.to_string_lossy());
    let values = options.style.values();
    // Points of a surface are closer to some neighbours than balls that cover it.
    let has_radius = overrides.iter().any(|given| given.key.starts_with(RADIUS_KEY));
    let radius_scale = if has_radius { 1.0 } else { values.radius_scale };
    // The other keys are those of the finished scene.
    let is_of_draft = |given: &&Override| DRAFT.iter().any(|table| given.key.starts_with(table));
    let of_draft: Vec<Override> = overrides.iter().filter(is_of_draft).cloned().collect();
    let read = |scale: f64, given: Option<TableInput>| {
        let draft = draft(&file, &values, scale);
        let inputs = given.into_iter().collect();
        let scene = read_text_with(name, &draft, folder, &of_draft, inputs);
        scene.map_err(|error| without_draft(error, name))
    };
    // Kept only where they may be needed again: they may be many.
    let kept = if radius_scale == 1.0 { None } else { given.clone() };
    let mut scene = read(radius_scale, given.take())?;
    if radius_scale != 1.0 && !has_radius_of_distances(&scene) {
        scene = read(1.0, kept)?;
    }
    let size = size_of(&scene);
    let particles = scene.particles().next().ok_or_else(|| Error::input("no particles"))?;
    let [left, right, top, bottom] = options.margins;
    let framing = Framing {
        view: options.view.unwrap_or(DEFAULT_VIEW),
        up: options.up,
        vertical_fov_degrees: (!options.orthographic).then_some(VERTICAL_FOV_DEGREES),
        zoom: options.zoom,
        aspect: f64::from(size[0]) / f64::from(size[1]),
        margins: [left, right + particles.look.legend.room(), top, bottom],
    };
    let count = particles.len() + particles.look.hidden.len();
    let sphere = particles.spheres();
    let Some(camera) = frame(&framing, count, &sphere) else {
        return Err(Error::input(format!("`{name}` has positions that are not finite"))
            .with_help("leave them out with a condition"));
    };
    let towards = (camera.position - camera.look_at).normalize();
    let elevation = towards.dot(options.up).asin().to_degrees();
    let backdrop = match options.background {
        Some(Background::Transparent) => None,
        Some(Background::Color(color)) => Some(color),
        None => Some(Rgb::splat(values.backdrop as f32)),
    };
    // A ground would fill a transparent background, unless it is asked for: then as a shadow.
    let usual = values.ground && elevation > MIN_GROUND_ELEVATION && backdrop.is_some();
    let has_ground = options.ground.unwrap_or(usual);
    let ground = has_ground.then(|| ground(count, &sphere, options.up));
    let is_above = |(center, radius): &(DVec3, f64)| camera.position.distance(*center) > *radius;
    let ground = ground.filter(is_above);
    refuse_ground_keys(ground.is_some(), overrides)?;
    let chosen = &particles.look.choices;
    let material = options.material.as_deref().unwrap_or(values.material);
    let composition = Composition {
        size,
        camera,
        up: options.up,
        key_direction: key_direction(towards, options.up, &values),
        style: values,
        backdrop,
        ground,
        material,
        particles: particle_keys(&scene.description, &file, chosen),
        samples: samples(overrides),
    };
    let text = composition.text();
    let mut choices = Vec::new();
    if options.view.is_none() {
        choices.push(("view", "-55,25".to_owned()));
    }
    choices.extend(chosen.iter().cloned());
    let mut notes = particles.look.notes.clone();
    if options.ground == Some(true) && ground.is_none() {
        notes.push("there is no ground, because the camera would be below it".to_owned());
    }
    drop(sphere);
    let scene = read_text_reusing(name, &text, folder, overrides, scene)?;
    Ok(Import { text, scene, choices, notes })
}

/// Refuses keys of a ground that is not there.
fn refuse_ground_keys(has_ground: bool, overrides: &[Override]) -> Result<()> {
    let is_of_ground = |given: &&Override| given.key.starts_with("spheres.ground.");
    let Some(given) = overrides.iter().find(is_of_ground).filter(|_| !has_ground) else {
        return Ok(());
    };
    let message = format!("there is no ground, whose key `{}` is set", given.key);
    Err(Error::input(message)
        .with_help("ask for a ground, which is there unless the camera would be below it"))
}

/// The samples per pixel that an override asks for, or the usual number.
fn samples(overrides: &[Override]) -> u32 {
    let mut given = overrides.iter().rev().filter(|given| given.key == "render.samples_per_pixel");
    given.next().and_then(|given| given.value.parse().ok()).unwrap_or(SAMPLES)
}

/// Returns true if the radius was chosen from distances, rather than found in the file.
fn has_radius_of_distances(scene: &SceneFile) -> bool {
    let mut choices = scene.particles().flat_map(|particles| &particles.look.choices);
    choices.any(|(key, value)| *key == "radius" && value.parse::<f64>().is_ok())
}

/// Errors in the draft have no place that a user knows; those in overrides keep theirs.
fn without_draft(error: Error, name: &str) -> Error {
    if error.diagnostics().is_empty() {
        return error;
    }
    let located = |diagnostic: &Diagnostic| {
        let mut diagnostic = diagnostic.clone();
        diagnostic.location = diagnostic.location.filter(|place| place.source.name != name);
        diagnostic
    };
    Error::from_diagnostics(error.diagnostics().iter().map(located).collect())
}

/// A scene with the particles alone, which lets overrides be read and checked.
fn draft(file: &str, values: &StyleValues, radius_scale: f64) -> String {
    let [width, height] = DEFAULT_SIZE;
    let StyleValues { glow, shade, plain, .. } = values;
    format!(
        "format = 1\n\n[image]\nwidth = {width}\nheight = {height}\n\n[camera]\n\
         position = [0, 0, 1]\nlook_at = [0, 0, 0]\n\n[materials.particles]\ntype = \"diffuse\"\n\
         albedo = [0.5, 0.5, 0.5]\n\n[materials.ground]\ntype = \"diffuse\"\n\
         albedo = [0.5, 0.5, 0.5]\n\n[[particles]]\nfile = {file}\nmaterial = \"particles\"\n\
         glow = {glow:?}\nshade = {shade:?}\ncolor = \"auto:{plain}\"\n\
         radius_scale = {radius_scale:?}\n"
    )
}

fn size_of(scene: &SceneFile) -> [u32; 2] {
    [scene.settings.image.width, scene.settings.image.height]
}

/// The ground that touches the lowest sphere, as a huge sphere.
fn ground(count: usize, sphere: impl Fn(usize) -> (DVec3, f64), up: DVec3) -> (DVec3, f64) {
    let mut lowest = f64::INFINITY;
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for (center, radius) in (0..count).map(sphere) {
        lowest = lowest.min(center.dot(up) - radius);
        low = low.min(center - radius);
        high = high.max(center + radius);
    }
    let radius = GROUND_RADIUS * (high - low).max_element();
    let middle = 0.5 * (low + high);
    (middle + up * (lowest - middle.dot(up) - radius), radius)
}

/// Unit vector towards the key light, which turns with the camera.
fn key_direction(towards: DVec3, up: DVec3, values: &StyleValues) -> DVec3 {
    let level = towards - up * towards.dot(up);
    let level = level.try_normalize().unwrap_or_else(|| up.any_orthonormal_vector());
    let right = up.cross(level);
    let (sin_a, cos_a) = libm::sincos(values.key_azimuth.to_radians());
    let (sin_e, cos_e) = libm::sincos(values.key_elevation.to_radians());
    (level * cos_a + right * sin_a) * cos_e + up * sin_e
}

/// The keys of the particles: those that are not the default, with automatic choices fixed.
fn particle_keys(
    description: &SceneDescription,
    file: &str,
    chosen: &[(&'static str, String)],
) -> Vec<(String, String)> {
    let mut keys = vec![("file".to_owned(), file.to_owned())];
    let is_chosen = |key: &str| chosen.iter().any(|(name, _)| *name == key);
    keys.extend(description.particle_keys(0).into_iter().filter(|(key, _)| !is_chosen(key)));
    keys.extend(chosen.iter().map(|(key, value)| ((*key).to_owned(), toml_string(value))));
    keys
}
