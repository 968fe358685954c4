//! `photosphere render`: a scene walks in, a picture walks out.

use std::fmt::Write;
use std::time::Instant;

use serde_json::json;

use crate::accel::BuildOptions;
use crate::error::{Error, Result};
use crate::geometry::SphereSet;
use crate::provenance::{Made, Run, Samples};
use crate::render::{self, Outcome, RenderOptions};
use crate::scene::{Scene, open_file};

use super::args::RenderArgs;
use super::exit::Exit;
use super::interrupt::Interrupt;
use super::memory::Needs;
use super::outputs::{self, Outputs};
use super::progress::Progress;
use super::{interrupt, memory, on_threads, print, system};

/// What a render took, in seconds.
struct Figures {
    load_s: f64,
    build_s: f64,
    render_s: f64,
}

/// # Errors
/// Whatever stands between the scene and the picture, the place of the picture first.
pub(super) fn run(args: &RenderArgs) -> Result<Exit> {
    let outputs = Outputs::new(&args.output)?;
    let interrupt = interrupt::listen(outputs.temporaries());
    on_threads(args.scene.threads(), || render(args, outputs, &interrupt))
}

fn render(args: &RenderArgs, outputs: Outputs, interrupt: &Interrupt) -> Result<Exit> {
    let mut clock = Clock(Instant::now());
    let opened = open_file(&args.scene.path, &args.overrides())?;
    let needs = Needs { backends: &[args.accel.backend], kinds: outputs.kinds(), besides: 0 };
    memory::check(&opened, &needs, args.memory.limit)?;
    let scene = Scene::new(opened.read()?)?;
    let load_s = clock.lap();
    let about_spheres = about_spheres(scene.spheres());
    about_spheres.iter().for_each(print::warning);
    let threads = rayon::current_num_threads();
    let build = BuildOptions { threads, cancel: interrupt.cancel(), ..Default::default() };
    let accel = args.accel.backend.build(scene.spheres(), &build)?;
    let build_s = clock.lap();

    let progress = Progress::new(args.quiet);
    interrupt.save_from_now_on();
    let options =
        RenderOptions { cancel: interrupt.cancel(), progress: &|state| progress.show(state) };
    let outcome = render::render_layers(&scene, accel.as_ref(), outputs.kinds(), &options);
    progress.finish();
    let mut outcome = outcome?;
    let figures = Figures { load_s, build_s, render_s: clock.lap() };

    if outcome.samples == 0 {
        return Err(
            Error::cancelled().with_help("no sample was finished, so no picture was written")
        );
    }
    let made = Made::new(&scene, args.accel.backend, samples(&outcome));
    let run = Run {
        command: system::command_line(),
        scene_file: system::full_path(&args.scene.path),
        rays: outcome.rays,
        seconds: figures.render_s,
        threads,
    };
    outputs.write(&outcome.picture, &scene, &made, &run)?;
    outcome.warnings.iter().for_each(print::warning);
    outcome.warnings.splice(..0, about_spheres);
    report(args, &scene, &outcome, &figures)?;
    Ok(if outcome.complete { Exit::Done } else { Exit::Stopped })
}

/// Which samples the picture has: those of stopped renders are spread over the pixels in whole blocks.
fn samples(outcome: &Outcome) -> Samples {
    let pixels = outcome.picture.len() as u64;
    let (fewest, most) = (outcome.samples / pixels, outcome.samples.div_ceil(pixels));
    Samples { first: 0, fewest: fewest as u32, most: most as u32 }
}

/// What the user should know of spheres that are there twice, and of those that f32 cannot hold well.
pub(super) fn about_spheres(spheres: &SphereSet) -> Vec<String> {
    let mut warnings = Vec::new();
    if spheres.duplicates() > 0 {
        warnings.push(format!(
            "{} left out: an earlier row is the same sphere after rounding to f32",
            print::count(spheres.duplicates(), "sphere"),
        ));
    }
    if spheres.coarse() > 0 {
        warnings.push(format!(
            "rounding to f32 moved {} by more than 1 % of the radius; they are small and far from \
             most others",
            print::count(spheres.coarse(), "sphere"),
        ));
    }
    warnings
}

fn report(args: &RenderArgs, scene: &Scene, outcome: &Outcome, figures: &Figures) -> Result<()> {
    if !args.quiet {
        print::remark(in_words(args, outcome, figures));
    }
    if args.json { print::json(&in_json(args, scene, outcome, figures)) } else { Ok(()) }
}

fn in_words(args: &RenderArgs, outcome: &Outcome, figures: &Figures) -> String {
    let Figures { load_s, build_s, render_s } = figures;
    let mut text = String::new();
    let per_pixel = outcome.samples as f64 / outcome.picture.len() as f64;
    let stopped = match outcome.complete {
        true => String::new(),
        false => format!(", stopped after {per_pixel:.1} samples per pixel"),
    };
    let mut line = |words: std::fmt::Arguments<'_>| {
        text.write_fmt(words).expect("a string takes all that is written to it");
    };
    line(format_args!("load {load_s:.3} s, build {build_s:.3} s, render {render_s:.3} s\n"));
    line(format_args!(
        "{}samples/s, {}rays/s",
        print::si(outcome.samples as f64 / render_s),
        print::si(outcome.rays as f64 / render_s)
    ));
    if let Some(peak) = system::peak_memory() {
        line(format_args!(", peak memory {}", print::bytes(peak)));
    }
    line(format_args!("\nwrote {}{stopped}", outputs::in_words(&args.output.files)));
    text
}

fn in_json(
    args: &RenderArgs,
    scene: &Scene,
    outcome: &Outcome,
    figures: &Figures,
) -> serde_json::Value {
    json!({
        "output": outputs::in_words(&args.output.files),
        "complete": outcome.complete,
        "accel": args.accel.backend.name(),
        "spheres": scene.spheres().len(),
        "width": outcome.picture.width,
        "height": outcome.picture.height,
        "threads": rayon::current_num_threads(),
        "load_s": figures.load_s,
        "build_s": figures.build_s,
        "render_s": figures.render_s,
        "samples": outcome.samples,
        "rays": outcome.rays,
        "samples_per_s": outcome.samples as f64 / figures.render_s,
        "rays_per_s": outcome.rays as f64 / figures.render_s,
        "peak_rss_bytes": system::peak_memory(),
        "mean_rgb": outcome.picture.mean().to_array(),
        "non_finite_pixels": outcome.picture.non_finite(),
        "warnings": outcome.warnings,
    })
}

/// Seconds since it was last asked.
struct Clock(Instant);

impl Clock {
    fn lap(&mut self) -> f64 {
        let last = std::mem::replace(&mut self.0, Instant::now());
        (self.0 - last).as_secs_f64()
    }
}
