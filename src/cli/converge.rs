//! `photosphere converge`: plots error against samples and against time.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use crate::accel::Backend;
use crate::error::{Error, Result};
use crate::image_io::{self, AtomicFile, BEAUTY};
use crate::report::convergence::{ConvergenceReport, ReferenceOrigin};
use crate::scene::settings::{ImageSettings, IntegratorKind, IntegratorSettings};
use crate::scene::{Override, SceneFile, Settings};
use crate::verify::converge::{
    Concentration, ErrorMetric, Reference, ReferenceSource, Series, Study, Variant,
};

use super::args::ConvergeArgs;
use super::compare::check_finite;
use super::exit::Exit;
use super::particle_file::{ParticleFile, read_scene};
use super::progress::{ProgressDisplay, ProgressState};
use super::system::on_threads;
use super::{interrupt, print, scene_file};

/// Runs the command.
///
/// # Errors
/// Any error between the scene and the plot. The path of the plot is checked first.
pub(super) fn run(args: &ConvergeArgs) -> Result<Exit> {
    let file = AtomicFile::with_extension(&args.output, "svg")?;
    interrupt::listen();
    on_threads(args.scene.threads(), || converge(args, file))
}

fn converge(args: &ConvergeArgs, file: AtomicFile) -> Result<Exit> {
    let metric = args.metric;
    let (study, reference_integrator) = study(args)?;
    let progress = ProgressDisplay::new(args.quiet);
    let (done, total, began) = (AtomicU64::new(0), study.total_samples(), Instant::now());
    let result = study.measure(&|rendered| {
        let before = done.fetch_add(rendered.samples, Ordering::Relaxed);
        progress.show(&ProgressState::since(began, before + rendered.samples, total));
        if !args.quiet && before == 0 {
            rendered.warnings.iter().for_each(print::warning);
        }
    });
    progress.finish();
    let (reference, series) = result?;
    if !series.iter().any(|one| one.has_error(metric)) {
        return Err(nothing_to_plot(&reference, metric));
    }
    let half = args.reference_half(study.samples.last().copied().unwrap_or(1));
    let report = ConvergenceReport {
        scene: &args.scene.path,
        image: study.variants[0].settings[0].image,
        seeds: args.seeds,
        metric,
        reference: &reference,
        origin: match &args.reference {
            Some(path) => ReferenceOrigin::File(path),
            None => ReferenceOrigin::Halves(&reference_integrator, half),
        },
        series: &series,
    };
    let svg = report.svg()?;
    file.write(|to| std::io::Write::write_all(to, svg.as_bytes()))?;
    if is_too_noisy(&reference, &series, metric) {
        print::warning("the reference is nearly as noisy as the best point; raise --reference-spp");
    }
    series
        .iter()
        .filter_map(|one| few_pixels(one, metric, report.image.width))
        .for_each(print::warning);
    match args.json {
        true => print::json(&report.json(&args.output))?,
        false => print::result(&report.to_string())?,
    }
    if !args.quiet {
        print::note(format_args!("wrote {}", args.output.display()));
    }
    Ok(Exit::Done)
}

/// Returns the error that explains why there is nothing to plot.
fn nothing_to_plot(reference: &Reference, metric: ErrorMetric) -> Error {
    match reference.noise(metric) {
        Some(0.0) | None => {
            Error::input("every picture equals the reference: there is no error to plot")
                .with_help("every sample of this scene has the same value; try another scene")
        }
        Some(_) => Error::input("there is no error above the reference's own noise to plot")
            .with_help("raise --reference-spp"),
    }
}

/// Returns true if the reference is nearly as noisy as the renders compared with it.
fn is_too_noisy(reference: &Reference, series: &[Series], metric: ErrorMetric) -> bool {
    let points = series.iter().flat_map(|one| &one.points);
    // `min` ignores errors that are NaN.
    let least = points.map(|point| point.error(metric).mean).fold(f64::INFINITY, f64::min);
    reference.noise(metric).is_some_and(|own| own > 0.0 && own >= 0.5 * least)
}

/// A warning if a few pixels carry the error of a curve, at the most samples.
fn few_pixels(series: &Series, metric: ErrorMetric, width: u32) -> Option<String> {
    let last = series.points.last()?;
    let Concentration { pixels, worst, of } =
        Some(last.concentration(metric)).filter(Concentration::is_high)?;
    let (x, y) = (worst as u32 % width, worst as u32 / width);
    Some(format!(
        "half of the squared error of `{}` is in {pixels} of {of} pixels, the worst in column {x}, \
         row {y}: what few samples find there, all {} renders may miss and the reference may \
         overrate, of which the intervals say nothing; raise --spp and --reference-spp",
        series.name,
        last.runs.len()
    ))
}

/// Returns the study to run and the integrator of the reference. Errors in the scene and its
/// settings show up here, and not after an hour of rendering.
fn study(args: &ConvergeArgs) -> Result<(Study, String)> {
    let choices = choices(args);
    let (mut step, mut told) = (1, BTreeSet::new());
    for choice in &choices {
        let file = read(args, &overrides(args, &choice.overrides, None))?;
        step = step.max(subpixels(&file.settings));
        told.extend(file.notes.into_iter().map(|note| (false, note)));
        told.extend(file.warnings.into_iter().map(|warning| (true, warning)));
    }
    for (is_warning, text) in told {
        if is_warning { print::warning(text) } else { print::note(text) }
    }
    let samples = args.samples(step);
    let overrides = overrides(args, &choices[0].overrides, samples.first().copied());
    let (scene, own) = read(args, &overrides)?.build()?;
    let own_integrator = own.render.integrator.kind().name();
    let variant = |choice: Choice| {
        let of = |&count: &u32| settings(args, &choice.overrides, Some(count));
        let names = args.integrators.is_empty().then_some(own_integrator).into_iter();
        let names: Vec<&str> = names.chain(choice.names.iter().map(String::as_str)).collect();
        let settings = samples.iter().map(of).collect::<Result<_>>()?;
        Ok(Variant { name: names.join(", "), accel: choice.accel, settings })
    };
    let variants = choices.into_iter().map(variant).collect::<Result<_>>()?;
    let integrator = reference_integrator(args, own_integrator)?;
    let reference = match &args.reference {
        Some(path) => ReferenceSource::Picture(read_reference(path, &own.image)?),
        None => {
            let most = samples.last().copied().unwrap_or(1);
            let choice = [chosen("integrator", &integrator)];
            let half = Some(args.reference_half(most));
            ReferenceSource::Halves(settings(args, &choice, half)?)
        }
    };
    let seeds = args.seed..args.seed + u64::from(args.seeds);
    Ok((Study { scene, variants, samples, seeds, reference }, integrator))
}

fn read_reference(path: &Path, image: &ImageSettings) -> Result<Reference> {
    let picture = image_io::read_image(path)?;
    check_finite(path, &picture, |name| name == BEAUTY)?;
    let (width, height) = (image.width as usize, image.height as usize);
    if (picture.width, picture.height) != (width, height) {
        return Err(Error::input(format!(
            "the reference has {} x {} pixels and the scene {width} x {height}",
            picture.width, picture.height
        ))
        .with_help(format!("add --size {}x{}", picture.width, picture.height)));
    }
    let beauty = picture.layer(BEAUTY).ok_or_else(|| {
        Error::input(format!("`{}` has no beauty layer (channels R, G, B)", path.display()))
    })?;
    let variance = picture.layer("variance").map(|layer| layer.pixels.as_slice());
    Ok(Reference::from_picture(beauty.pixels.clone(), variance))
}

/// The settings of one curve.
#[derive(Clone)]
struct Choice {
    names: Vec<String>,
    overrides: Vec<Override>,
    accel: Backend,
}

/// Returns all combinations of the settings to compare.
fn choices(args: &ConvergeArgs) -> Vec<Choice> {
    let accel = args.accels.first().copied().unwrap_or_default();
    let mut choices = vec![Choice { names: Vec::new(), overrides: Vec::new(), accel }];
    let lists = [
        ("integrator", &args.integrators),
        ("estimator", &args.estimators),
        ("caustics", &args.caustics),
        ("sampler", &args.samplers),
    ];
    let named = lists.into_iter().map(|(key, names)| {
        names.iter().map(|name| (name.clone(), chosen(key, name))).collect::<Vec<_>>()
    });
    let compared = args.compare.iter().map(|comparison| comparison.choices());
    for alternatives in named.chain(compared).filter(|alternatives| !alternatives.is_empty()) {
        let with = |choice: &Choice, (name, given): &(String, Override)| {
            let mut choice = choice.clone();
            choice.names.push(name.clone());
            choice.overrides.push(given.clone());
            choice
        };
        let of =
            |choice: &Choice| alternatives.iter().map(|one| with(choice, one)).collect::<Vec<_>>();
        choices = choices.iter().flat_map(of).collect();
    }
    if args.accels.is_empty() {
        return choices;
    }
    let with = |choice: &Choice, accel: Backend| {
        let mut choice = Choice { accel, ..choice.clone() };
        choice.names.push(accel.name().to_owned());
        choice
    };
    let of = |choice| args.accels.iter().map(move |&accel| with(choice, accel));
    choices.iter().flat_map(of).collect()
}

fn chosen(key: &str, name: &str) -> Override {
    Override::new(format!("render.{key}"), name).with_option([&format!("--{key}"), name])
}

fn settings(args: &ConvergeArgs, chosen: &[Override], samples: Option<u32>) -> Result<Settings> {
    Ok(read(args, &overrides(args, chosen, samples))?.settings)
}

/// Reads the scene, as often as there are settings to compare.
fn read(args: &ConvergeArgs, overrides: &[Override]) -> Result<SceneFile> {
    let path = &args.scene.path;
    match ParticleFile::is_one(path, overrides) {
        true => read_scene(path, overrides, None),
        false => scene_file::read_silently(path, overrides),
    }
}

/// Returns the overrides of the scene. `--set` comes last and wins.
fn overrides(args: &ConvergeArgs, chosen: &[Override], samples: Option<u32>) -> Vec<Override> {
    let samples = samples.map(|samples| samples.to_string()).map(|samples| {
        Override::new("render.samples_per_pixel", &samples).with_option(["--spp", &samples])
    });
    let size = args.size.into_iter().flat_map(|size| size.overrides());
    chosen.iter().cloned().chain(size).chain(samples).chain(args.scene.overrides()).collect()
}

/// Returns the divisor that every number of samples per pixel must have.
fn subpixels(settings: &Settings) -> u32 {
    match settings.render.integrator {
        IntegratorSettings::Paper(paper) => paper.subpixels.pow(2),
        _ => 1,
    }
}

/// Returns the name of the reference's integrator. `own` is the integrator of the scene.
fn reference_integrator(args: &ConvergeArgs, own: &str) -> Result<String> {
    let is_compared = |kind: IntegratorKind| match args.integrators.as_slice() {
        [] => own == kind.name(),
        names => names.iter().any(|one| one == kind.name()),
    };
    let any = [IntegratorKind::Path, IntegratorKind::Paper].into_iter().any(is_compared);
    let found = match &args.reference_integrator {
        Some(name) => name.clone(),
        None if any => IntegratorKind::Path.name().to_owned(),
        None => args.integrators.first().map_or(own, String::as_str).to_owned(),
    };
    if args.reference_integrator.is_none() && args.reference.is_none() {
        must_share_a_mean(&args.integrators, &found)?;
    }
    Ok(found)
}

/// Without a reference picture, refuses integrators that do not converge to the picture of the
/// reference. Only `path` and `paper` share one. The other integrators each show something else.
fn must_share_a_mean(integrators: &[String], reference: &str) -> Result<()> {
    let shown = |name: &str| if name == "paper" { "path".to_owned() } else { name.to_owned() };
    match integrators.iter().find(|name| shown(name) != shown(reference)) {
        None => Ok(()),
        Some(other) => Err(Error::input(format!(
            "`{other}` and `{reference}` converge to different pictures: no reference serves both"
        ))
        .with_help(
            "compare them one by one, or choose the correct picture with --reference-integrator NAME \
             or --reference FILE",
        )),
    }
}
