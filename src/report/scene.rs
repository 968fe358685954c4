//! Summarizes a scene and points out likely mistakes.

use std::fmt;

use rayon::prelude::*;
use serde::Serialize;
use serde_json::Value;

use crate::geometry::{Sphere, SphereSet};
use crate::math::DVec3;
use crate::scene::settings::{ImageSettings, IntegratorKind, IntegratorSettings, PathTermination};
use crate::scene::{CameraEnclosure, Scene, SceneDescription, Settings};

/// Contents of a scene and its render settings, as text and as the fields of a JSON object.
#[derive(Debug, Serialize)]
pub struct SceneSummary<'a> {
    spheres: usize,
    tables: usize,
    giants: usize,
    duplicates: usize,
    emitters: usize,
    camera_inside: Option<String>,
    materials: Vec<Material<'a>>,
    bounds: Bounds,
    /// Of what a fitted camera shows.
    subject_bounds: Bounds,
    /// The camera of the picture, as a scene file has it, if it is derived.
    fitted_camera: Option<Value>,
    radius: Radii,
    memory_plan: Value,
    width: u32,
    height: u32,
    integrator: IntegratorKind,
    samples_per_pixel: u32,
    max_depth: Option<u32>,
    seed: u64,
    biased_by: Vec<String>,
    creates_energy: Vec<EnergyCreatingMaterial<'a>>,
    #[serde(skip)]
    settings: &'a Settings,
}

#[derive(Debug, Serialize)]
struct Material<'a> {
    name: &'a str,
    r#type: &'static str,
}

/// Bounding box of all spheres, in the user's coordinates.
#[derive(Debug, Serialize)]
struct Bounds {
    low: DVec3,
    high: DVec3,
}

#[derive(Debug, Serialize)]
struct Radii {
    smallest: f64,
    largest: f64,
}

/// A material that reflects more light than it receives.
#[derive(Debug, Serialize)]
struct EnergyCreatingMaterial<'a> {
    name: &'a str,
    max_albedo: f32,
}

impl<'a> SceneSummary<'a> {
    /// Summarizes a scene with its settings.
    pub fn of(scene: &'a Scene, settings: &'a Settings) -> Self {
        let (description, spheres) = (scene.description(), scene.spheres());
        let Settings { image, render } = settings;
        let (bounds, radius) = extent(spheres);
        let [low, high] = scene.subject_bounds();
        let is_derived =
            description.camera.fit.is_some() || description.camera.focus_target.is_some();
        let materials = description.materials.iter();
        let creates_energy = description.energy_creating_materials().into_iter();
        Self {
            spheres: spheres.len(),
            tables: description.tables.len(),
            giants: spheres.giants().len(),
            duplicates: spheres.duplicates(),
            emitters: scene.emitter_count(),
            camera_inside: CameraEnclosure::find(scene, image)
                .map(|enclosure| scene.name_of_row(spheres.row(enclosure.sphere))),
            materials: materials
                .map(|m| Material { name: &m.name, r#type: m.surface.kind().name() })
                .collect(),
            bounds,
            subject_bounds: Bounds { low, high },
            fitted_camera: is_derived.then(|| fitted_camera(scene, image)).flatten(),
            radius,
            memory_plan: Value::Null,
            width: image.width,
            height: image.height,
            integrator: render.integrator.kind(),
            samples_per_pixel: render.samples_per_pixel,
            max_depth: render.max_depth,
            seed: render.seed,
            biased_by: render.biases(),
            creates_energy: creates_energy
                .map(|(name, max_albedo)| EnergyCreatingMaterial { name, max_albedo })
                .collect(),
            settings,
        }
    }

    /// Adds a memory plan to the JSON.
    #[must_use]
    pub fn with_memory_plan(self, memory_plan: Value) -> Self {
        Self { memory_plan, ..self }
    }
}

impl fmt::Display for SceneSummary<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut row = |name: &str, value: String| writeln!(f, "{name:<12}{value}");
        row("spheres", self.spheres.to_string())?;
        row("tables", self.tables.to_string())?;
        row("giants", format!("{} (traced in f64)", self.giants))?;
        row("duplicates", format!("{} (left out)", self.duplicates))?;
        row("emitters", self.emitters.to_string())?;
        if let Some(name) = &self.camera_inside {
            row("camera", format!("inside the opaque sphere `{name}`"))?;
        }
        let mut list = |name: &str, values: Vec<String>| {
            let names = std::iter::once(name).chain(std::iter::repeat(""));
            names.zip(values).try_for_each(|(name, value)| row(name, value))
        };
        let material = |Material { name, r#type }: &Material<'_>| format!("{name} ({})", r#type);
        list("materials", self.materials.iter().map(material).collect())?;
        let (Bounds { low, high }, Radii { smallest, largest }) = (&self.bounds, &self.radius);
        list("bounds", vec![format!("{} to {}", triple(*low), triple(*high))])?;
        let Bounds { low, high } = &self.subject_bounds;
        list("shown", vec![format!("{} to {}", triple(*low), triple(*high))])?;
        list("radii", vec![format!("{} to {}", rounded(*smallest), rounded(*largest))])?;
        list("image", vec![format!("{} x {} pixels", self.width, self.height)])?;
        list("integrator", vec![integrator(&self.settings.render.integrator)])?;
        list("samples", vec![format!("{} per pixel", self.samples_per_pixel)])?;
        let depth = self.max_depth.map_or("no limit".to_owned(), |depth| depth.to_string());
        list("max_depth", vec![depth])?;
        list("seed", vec![self.seed.to_string()])?;
        list("biased by", self.biased_by.clone())?;
        let note = |EnergyCreatingMaterial { name, max_albedo }: &EnergyCreatingMaterial<'_>| {
            format!("{name} (reflects more than it receives: up to {max_albedo:.2} of it)")
        };
        list("adds energy", self.creates_energy.iter().map(note).collect())?;
        match self.fitted_camera.as_ref().and_then(Value::as_object) {
            Some(keys) => {
                writeln!(f, "\nThe camera, to be pasted into the scene:\n\n[camera]")?;
                keys.iter().try_for_each(|(key, value)| writeln!(f, "{key} = {value}"))
            }
            None => Ok(()),
        }
    }
}

/// The keys of the camera with all that is derived for pictures of this size.
fn fitted_camera(scene: &Scene, image: &ImageSettings) -> Option<Value> {
    let camera = scene.camera(image).ok()?;
    let with_camera = SceneDescription { camera, ..SceneDescription::default() };
    Some(with_camera.to_keys()["camera"].take())
}

fn extent(spheres: &SphereSet) -> (Bounds, Radii) {
    let empty = || {
        let bounds = Bounds { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };
        (bounds, Radii { smallest: f64::INFINITY, largest: 0.0 })
    };
    let sphere_extent = |id| {
        let Sphere { center, radius } = spheres.sphere(id);
        let center = center + spheres.origin();
        let bounds = Bounds { low: center - radius, high: center + radius };
        (bounds, Radii { smallest: radius, largest: radius })
    };
    let union = |(a, r): (Bounds, Radii), (b, s): (Bounds, Radii)| {
        let bounds = Bounds { low: a.low.min(b.low), high: a.high.max(b.high) };
        let (smallest, largest) = (r.smallest.min(s.smallest), r.largest.max(s.largest));
        (bounds, Radii { smallest, largest })
    };
    (0..spheres.len() as u32).into_par_iter().map(sphere_extent).reduce(empty, union)
}

fn integrator(integrator: &IntegratorSettings) -> String {
    let name = integrator.kind().name();
    match integrator {
        IntegratorSettings::Path | IntegratorSettings::Direct | IntegratorSettings::Normals => {
            name.to_owned()
        }
        IntegratorSettings::AmbientOcclusion { distance: None } => name.to_owned(),
        IntegratorSettings::AmbientOcclusion { distance: Some(distance) } => {
            format!("{name}, nearer than {distance}")
        }
        IntegratorSettings::Raycast { shadows: true } => format!("{name}, with shadows"),
        IntegratorSettings::Raycast { shadows: false } => format!("{name}, without shadows"),
        IntegratorSettings::Paper(paper) => {
            let hemisphere = paper.hemisphere.name();
            let stop = match paper.stop {
                PathTermination::Roulette | PathTermination::Depth => {
                    paper.stop.kind().name().to_owned()
                }
                PathTermination::Threshold(threshold) => {
                    format!("{} {threshold}", paper.stop.kind().name())
                }
            };
            let (k, n) = (paper.subpixels, paper.samples);
            format!("{name}, {k} x {k} sub-pixels of {n} samples, {hemisphere}, stop at {stop}")
        }
    }
}

fn triple(v: DVec3) -> String {
    format!("({}, {}, {})", rounded(v.x), rounded(v.y), rounded(v.z))
}

/// Formats at most seven significant digits, about the precision of f32.
fn rounded(x: f64) -> String {
    // Adding 0 turns -0 into 0.
    let rounded = format!("{x:.6e}").parse().unwrap_or(x) + 0.0;
    format!("{rounded:?}").trim_end_matches(".0").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_to_what_f32_holds() {
        let shown = [0.1f32.into(), 250.0, -1e15, 1.0 / 3.0, 1e-15, -0.0, 999.999_99].map(rounded);
        assert_eq!(shown, ["0.1", "250", "-1000000000000000", "0.3333333", "1e-15", "0", "1000"]);
    }
}
