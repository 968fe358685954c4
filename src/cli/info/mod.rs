//! `photosphere info`: what is in a scene, and how a picture was made.

mod picture;

use rayon::prelude::*;
use serde_json::{Value, json};

use crate::error::{Error, Result};
use crate::film::Kind;
use crate::geometry::{Sphere, SphereSet};
use crate::math::DVec3;
use crate::scene::description::Description;
use crate::scene::settings::{Integrator, Stop};
use crate::scene::{Scene, Settings, read_file};

use super::args::InfoArgs;
use super::exit::Exit;
use super::memory::Needs;
use super::{memory, on_threads, print, render};

/// # Errors
/// When the scene or the picture cannot be read, or the scene has mistakes.
pub(super) fn run(args: &InfoArgs) -> Result<Exit> {
    if picture::is_picture(&args.scene.path) {
        if let Some(option) = args.scene.overrides().first() {
            let message = format!(
                "`{}` changes scenes, but `{}` is a picture",
                option.option,
                args.scene.path.display()
            );
            return Err(Error::input(message).with_help("leave it out"));
        }
        picture::show(&args.scene.path, args.json)?;
        return Ok(Exit::Done);
    }
    on_threads(args.scene.threads(), || {
        let file = read_file(&args.scene.path, &args.scene.overrides())?;
        let plan = memory::in_json(&file);
        if !args.json {
            // Before anything is loaded: that may be what there is no memory for.
            print::result(&memory::in_words(&file))?;
        }
        let backends = [args.accel.choice.choose_for(file.sphere_count() as usize).backend];
        let needs = Needs { backends: &backends, kinds: &Kind::USUAL, besides: 0 };
        memory::check(&file, &needs, args.memory.limit)?;
        let (scene, settings) = file.build()?;
        render::about_spheres(scene.spheres()).iter().for_each(print::warning);
        if args.json {
            print::json(&in_json(&scene, &settings, plan))?
        } else {
            print::result(&in_words(&scene, &settings))?
        }
        Ok(Exit::Done)
    })
}

/// The box around all spheres, in the user's coordinates, and the range of their radii.
struct Bounds {
    low: DVec3,
    high: DVec3,
    smallest: f64,
    largest: f64,
}

impl Bounds {
    fn of(spheres: &SphereSet) -> Self {
        let nothing = || Self {
            low: DVec3::INFINITY,
            high: DVec3::NEG_INFINITY,
            smallest: f64::INFINITY,
            largest: 0.0,
        };
        let one = |id| {
            let Sphere { center, radius } = spheres.sphere(id);
            let center = center + spheres.origin();
            let (low, high) = (center - radius, center + radius);
            Self { low, high, smallest: radius, largest: radius }
        };
        let joined = |a: Self, b: Self| Self {
            low: a.low.min(b.low),
            high: a.high.max(b.high),
            smallest: a.smallest.min(b.smallest),
            largest: a.largest.max(b.largest),
        };
        (0..spheres.len() as u32).into_par_iter().map(one).reduce(nothing, joined)
    }
}

fn in_words(scene: &Scene, settings: &Settings) -> String {
    let (spheres, Settings { image, render }) = (scene.spheres(), settings);
    let Bounds { low, high, smallest, largest } = Bounds::of(spheres);
    let mut text = String::new();
    let mut row = |name: &str, value: String| text += &format!("{name:<12}{value}\n");
    row("spheres", spheres.len().to_string());
    row("tables", scene.description().tables.len().to_string());
    row("giants", format!("{} (kept in f64)", spheres.giants().len()));
    row("duplicates", format!("{} (left out)", spheres.duplicates()));
    row("coarse", format!("{} (moved by rounding by more than 1 %)", spheres.coarse()));
    row("lamps", scene.lamp_count().to_string());
    for (index, (name, kind)) in materials(scene.description()).into_iter().enumerate() {
        row(if index == 0 { "materials" } else { "" }, format!("{name} ({kind})"));
    }
    row("bounds", format!("{} to {}", triple(low), triple(high)));
    row("radii", format!("{} to {}", rounded(smallest), rounded(largest)));
    row("image", format!("{} x {} pixels", image.width, image.height));
    row("integrator", integrator(&render.integrator));
    row("samples", format!("{} per pixel", render.samples_per_pixel));
    let depth = render.max_depth.map_or_else(|| "no limit".to_owned(), |depth| depth.to_string());
    row("max_depth", depth);
    row("seed", render.seed.to_string());
    for (index, option) in render.biases().into_iter().enumerate() {
        row(if index == 0 { "biased by" } else { "" }, option);
    }
    for (index, (name, share)) in scene.description().makes_light().into_iter().enumerate() {
        let note = format!("{name} (reflects more than it receives: up to {share:.2} of it)");
        row(if index == 0 { "makes light" } else { "" }, note);
    }
    text
}

fn in_json(scene: &Scene, settings: &Settings, plan: Value) -> Value {
    let (spheres, Settings { image, render }) = (scene.spheres(), settings);
    let Bounds { low, high, smallest, largest } = Bounds::of(spheres);
    let materials = materials(scene.description());
    let materials: Vec<Value> =
        materials.into_iter().map(|(name, kind)| json!({ "name": name, "type": kind })).collect();
    let makes_light = scene.description().makes_light();
    let makes_light: Vec<Value> = makes_light
        .into_iter()
        .map(|(name, share)| json!({ "name": name, "up_to": share }))
        .collect();
    json!({
        "spheres": spheres.len(),
        "tables": scene.description().tables.len(),
        "giants": spheres.giants().len(),
        "duplicates": spheres.duplicates(),
        "coarse": spheres.coarse(),
        "lamps": scene.lamp_count(),
        "materials": materials,
        "bounds": { "low": low.to_array(), "high": high.to_array() },
        "radius": { "smallest": smallest, "largest": largest },
        "memory_plan": plan,
        "width": image.width,
        "height": image.height,
        "integrator": render.integrator.kind().name(),
        "samples_per_pixel": render.samples_per_pixel,
        "max_depth": render.max_depth,
        "seed": render.seed,
        "biased_by": render.biases(),
        "makes_light": makes_light,
    })
}

/// Name and kind of every material.
fn materials(description: &Description) -> Vec<(&str, &'static str)> {
    description.materials.iter().map(|m| (m.name.as_str(), m.surface.kind().name())).collect()
}

fn integrator(integrator: &Integrator) -> String {
    let name = integrator.kind().name();
    match integrator {
        Integrator::Path | Integrator::Direct | Integrator::Normals => name.to_owned(),
        Integrator::AmbientOcclusion { distance: None } => name.to_owned(),
        Integrator::AmbientOcclusion { distance: Some(distance) } => {
            format!("{name}, nearer than {distance}")
        }
        Integrator::Raycast { shadows: true } => format!("{name}, with shadows"),
        Integrator::Raycast { shadows: false } => format!("{name}, without shadows"),
        Integrator::Paper(paper) => {
            let hemisphere = paper.hemisphere.name();
            let stop = match paper.stop {
                Stop::Roulette | Stop::Depth => paper.stop.kind().name().to_owned(),
                Stop::Threshold(threshold) => format!("{} {threshold}", paper.stop.kind().name()),
            };
            let (k, n) = (paper.subpixels, paper.samples);
            format!("{name}, {k} x {k} sub-pixels of {n} samples, {hemisphere}, stop at {stop}")
        }
    }
}

fn triple(v: DVec3) -> String {
    format!("({}, {}, {})", rounded(v.x), rounded(v.y), rounded(v.z))
}

/// A number in at most seven significant digits, about those of f32.
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
