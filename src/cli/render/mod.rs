//! `photosphere render`: a scene walks in, a picture walks out.

mod job;
mod report;
mod save;
mod start;

use std::ops::Range;
use std::path::Path;
use std::time::Instant;

use crate::accel::{BuildOptions, Chosen};
use crate::error::{Error, Result};
use crate::film::{BLOCK, Format, Kind, Layer};
use crate::geometry::SphereSet;
use crate::provenance::{Made, Samples};
use crate::render::{RenderOptions, Session, format_with};
use crate::scene::{Scene, open_file};

use super::args::RenderArgs;
use super::exit::Exit;
use super::goal::Goal;
use super::interrupt::Interrupt;
use super::keeper::{self, Orders};
use super::memory::Needs;
use super::outputs::{self, Outputs, is_part};
use super::progress::{self, Progress};
use super::watch::{Shows, Told, Watch};
use super::{exit_of, interrupt, memory, on_threads, print};

pub(super) use job::{ENDED, MISSED, RESUME};

use job::Job;
use report::{AccelFigures, Figures};
use start::{Keep, Start};

/// # Errors
/// Whatever stands between the scene and the picture, the place of the picture first.
pub(super) fn run(args: &RenderArgs) -> Result<Exit> {
    outputs::refuse_same_places(&places(args))?;
    let outputs = Outputs::new(&args.output, args.watch.preview.is_some())?;
    let keep = Keep::new(args, &outputs)?;
    let name = outputs::in_words(&args.output.files);
    let shows = Shows::new(&args.watch, args.output.look(), name, args.resumed.is_some())?;
    let interrupt = interrupt::listen();
    on_threads(args.scene.threads(), || render(args, &outputs, keep.as_ref(), shows, &interrupt))
}

fn render(
    args: &RenderArgs,
    outputs: &Outputs,
    keep: Option<&Keep>,
    shows: Shows,
    interrupt: &Interrupt,
) -> Result<Exit> {
    let mut clock = Clock(Instant::now());
    let opened = open_file(&args.scene.path, &args.overrides())?;
    // Before spheres that are there twice are left out.
    let chosen = args.accel.choice.choose_for(opened.sphere_count() as usize);
    let needs = Needs { backends: &[chosen.backend], kinds: outputs.kinds(), besides: 0 };
    memory::check(&opened, &needs, args.memory.limit)?;
    let scene = Scene::new(opened.read()?)?;
    let mut figures = Figures { load_s: clock.lap(), ..Figures::default() };
    let samples = samples_of(args, &scene)?;
    let goal = Goal::new(&args.stop, &scene, samples.end)?;
    let format = Format { first_sample: samples.start, ..format_with(&scene, outputs.kinds()) };
    let about_spheres = about_spheres(scene.spheres());
    about_spheres.iter().for_each(print::warning);
    let Chosen { backend, reason } = args.accel.choice.choose(scene.spheres());
    let made = Made::new(&scene, backend, Samples::all(0));
    let noise = goal.noise_in_words();
    let Start { film, before } =
        start::of(keep, &made, &format, &samples, noise.as_deref(), args.quiet)?;

    let threads = rayon::current_num_threads();
    let build = BuildOptions {
        threads,
        quality: args.accel.build.quality,
        progress: progress::of_a_build(args.quiet),
        cancel: interrupt.cancel(),
        ..Default::default()
    };
    let accel = backend.build(scene.spheres(), &build)?;
    figures.build_s = clock.lap();
    figures.accel = AccelFigures::of(backend, reason, &*accel);

    let progress = Progress::new(args.quiet);
    let told = Told::default();
    interrupt.save_from_now_on();
    let options =
        RenderOptions { cancel: interrupt.cancel(), progress: &|state| told.progress(state) };
    let session = Session::new(&scene, accel.as_ref(), &film, &options);
    session.expect_samples(film.frame().pixels() as u64 * samples.len() as u64);
    let job = Job {
        args,
        scene: &scene,
        accel: accel.as_ref(),
        session: &session,
        samples: samples.clone(),
        outputs,
        keep,
        goal: &goal,
        told: &told,
        interrupt,
        progress: &progress,
        made,
        figures,
        about_spheres,
        before,
        samples_before: film.samples(),
        began: Instant::now(),
    };
    let deadline = goal.deadline(&film, before.seconds, interrupt.cancel());
    let watch = Watch {
        film: &film,
        told: &told,
        progress: &progress,
        shows,
        threads,
        deadline,
        interrupt,
        has_alpha: outputs.kinds().contains(&Kind::Mean(Layer::Alpha))
            || scene.description().background.transparent,
    };
    watch.during(|last_look| {
        let orders = Orders {
            chores: job.chores(),
            cancel: &options.cancel,
            warn: &|text| progress.say(|| print::warning(&text)),
            // The threads that render are stuck, so others must help.
            give_up: &|| {
                let reached = goal.reached_so_far(&film, &told);
                let closed = on_threads(args.scene.threads(), || job.close(&reached, last_look));
                std::process::exit(i32::from(exit_of(closed) as u8));
            },
        };
        let reached = keeper::beside(orders, || goal.reach(&session, &told))?;
        job.close(&reached, last_look)
    })
}

/// What is to be written, and where; `-o FILE.part` may be named as the checkpoint, too.
fn places(args: &RenderArgs) -> Vec<(&'static str, &Path)> {
    let files = args.output.files.iter().map(|file| ("-o", file.as_path()));
    let checkpoint = args.keep.checkpoint.as_deref().map(|file| ("--checkpoint", file));
    let is_part = |file: &&Path| args.output.files.iter().any(|part| part == file && is_part(part));
    let checkpoint = checkpoint.filter(|(_, file)| !is_part(file));
    let preview = args.watch.preview.as_deref().map(|file| ("--preview", file));
    files.chain(checkpoint).chain(preview).collect()
}

/// The samples that are asked for.
fn samples_of(args: &RenderArgs, scene: &Scene) -> Result<Range<u32>> {
    let last = scene.description().render.samples_per_pixel;
    let Some(samples) = args.samples.clone() else { return Ok(0..last) };
    let Range { start, end } = samples;
    let extended = args.resumed.as_ref().and_then(|resumed| resumed.extended_to);
    let end = extended.unwrap_or(end);
    let refused = |message: String, help: String| Err(Error::input(message).with_help(help));
    if start % BLOCK != 0 {
        let near = start / BLOCK * BLOCK;
        return refused(
            format!("`--samples {start}..{end}` must start on a multiple of {BLOCK}"),
            format!("samples are summed in blocks of {BLOCK}; try {near}..{end}"),
        );
    }
    if end > last {
        return refused(
            format!("`--samples {start}..{end}` ends behind the last sample, of {last} per pixel"),
            format!("ask for more samples per pixel, as in --spp {end}"),
        );
    }
    if end % BLOCK != 0 && end != last {
        let near = end.next_multiple_of(BLOCK).min(last);
        return refused(
            format!(
                "`--samples {start}..{end}` must end on a multiple of {BLOCK}, or at the last \
                 sample, {last}"
            ),
            format!("samples are summed in blocks of {BLOCK}; try {start}..{near}"),
        );
    }
    Ok(start..end)
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

/// Seconds since it was last asked.
struct Clock(Instant);

impl Clock {
    fn lap(&mut self) -> f64 {
        let last = std::mem::replace(&mut self.0, Instant::now());
        (self.0 - last).as_secs_f64()
    }
}
