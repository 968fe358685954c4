//! `photosphere converge`: error against samples and against time.

mod report;

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use crate::accel::{Accel, Backend, BuildOptions};
use crate::color::Rgb;
use crate::error::{Error, Result};
use crate::image_io::Picture;
use crate::image_io::{self, BEAUTY, WholeFile};
use crate::job;
use crate::scene::settings::{Integrator, IntegratorKind};
use crate::scene::{Override, Scene, Settings, Shot, read_file};
use crate::task::Cancel;
use crate::verify::converge::{Metric, Point, Reference, Series, plot};

use super::args::ConvergeArgs;
use super::compare::check_finite;
use super::exit::Exit;
use super::progress::{Progress, State};
use super::{interrupt, on_threads, print};

/// The seeds of the reference's halves are far from any that a user takes.
const REFERENCE_SEED: u64 = 1 << 40;

/// # Errors
/// Whatever stands between the scene and the plot, the place of the plot first.
pub(super) fn run(args: &ConvergeArgs) -> Result<Exit> {
    let file = WholeFile::ending_in(&args.output, "svg")?;
    interrupt::listen();
    on_threads(args.scene.threads(), || converge(args, file))
}

fn converge(args: &ConvergeArgs, file: WholeFile) -> Result<Exit> {
    let metric = Metric::from(args.metric);
    let study = Study::new(args)?;
    let progress = Progress::new(args.quiet);
    let (done, total, began) = (AtomicU64::new(0), study.total(), Instant::now());
    let bench = Bench { args, progress: &progress, done, total, began };
    let result = study.measure(&bench);
    progress.finish();
    let (reference, series) = result?;
    let about = study.about_reference(&reference, metric);
    let title = format!("{}, {}", study.scene_name(), study.size_in_words());
    if !series.iter().any(|one| one.has_error(metric)) {
        return Err(report::nothing_to_plot(&reference, metric));
    }
    let svg = plot::svg(&series, metric, &plot::Heading { title: &title, subtitle: &about })?;
    file.write(|to| std::io::Write::write_all(to, svg.as_bytes()))?;
    report::warn_of_noise(&reference, &series, metric);
    if args.json {
        print::json(&report::in_json(args, &study, &reference, &series))?;
    } else {
        print::result(&report::in_words(&title, &about, &series, metric))?;
    }
    if !args.quiet {
        print::remark(format_args!("wrote {}", args.output.display()));
    }
    Ok(Exit::Done)
}

/// One curve.
struct Variant {
    integrator: Option<String>,
    estimator: Option<String>,
    sampler: Option<String>,
    accel: Backend,
    /// Of each number of samples.
    settings: Vec<Settings>,
}

/// What is to be rendered; everything that the scene can object to has been tried.
struct Study<'a> {
    args: &'a ConvergeArgs,
    scene: Scene,
    /// As the file has them.
    own: Settings,
    variants: Vec<Variant>,
    /// Samples per pixel, rising.
    samples: Vec<u32>,
    reference_integrator: String,
    /// As the halves of the reference are rendered; `None` where it is a file.
    reference: Option<Settings>,
}

impl<'a> Study<'a> {
    fn new(args: &'a ConvergeArgs) -> Result<Self> {
        let mut variants = variants(args);
        let mut step = 1;
        for variant in &variants {
            step = step.max(subpixels(&settings_of(args, variant, None)?));
        }
        let samples = args.samples(step);
        for variant in &mut variants {
            let of = |&count: &u32| settings_of(args, variant, Some(count));
            variant.settings = samples.iter().map(of).collect::<Result<_>>()?;
        }
        let overrides = overrides_of(args, &variants[0], samples.first().copied());
        let (scene, own) = read_file(&args.scene.path, &overrides)?.build()?;
        let reference_integrator = reference_integrator(args, &own)?;
        let most = samples.last().copied().unwrap_or(1);
        let reference = match &args.reference {
            Some(_) => None,
            None => {
                let integrator = Some(reference_integrator.clone());
                let variant = Variant { integrator, ..Variant::of(variants[0].accel) };
                Some(settings_of(args, &variant, Some(args.reference_half(most)))?)
            }
        };
        Ok(Self { args, scene, own, variants, samples, reference_integrator, reference })
    }

    fn reference_half(&self) -> u32 {
        self.args.reference_half(self.samples.last().copied().unwrap_or(1))
    }

    fn pixels(&self) -> u64 {
        let image = self.own.image;
        u64::from(image.width) * u64::from(image.height)
    }

    /// Samples in all.
    fn total(&self) -> u64 {
        let points: u64 = self.samples.iter().copied().map(u64::from).sum();
        let curves = points * self.variants.len() as u64 * u64::from(self.args.seeds);
        let reference =
            if self.args.reference.is_some() { 0 } else { 2 * u64::from(self.reference_half()) };
        self.pixels() * (curves + reference)
    }

    fn measure(&self, bench: &Bench<'_>) -> Result<(Reference, Vec<Series>)> {
        let build = BuildOptions { threads: rayon::current_num_threads(), ..Default::default() };
        let accels: Vec<Box<dyn Accel>> = self
            .variants
            .iter()
            .map(|variant| variant.accel.build(self.scene.spheres(), &build))
            .collect::<Result<_>>()?;
        let reference = self.reference(bench, &*accels[0])?;
        let name = |variant: &Variant| self.name_of(variant);
        let empty = |variant: &Variant| Series { name: name(variant), points: Vec::new() };
        let mut series: Vec<Series> = self.variants.iter().map(empty).collect();
        for (at, &count) in self.samples.iter().enumerate() {
            let shot = |variant: &Variant| Shot::new(&self.scene, variant.settings[at]);
            let mut shots: Vec<Shot> = self.variants.iter().map(shot).collect::<Result<_>>()?;
            let mut runs = vec![Vec::new(); shots.len()];
            // The variants take turns, so that what else the machine does troubles all alike.
            for seed in self.args.seed..self.args.seed + u64::from(self.args.seeds) {
                for ((shot, accel), runs) in shots.iter_mut().zip(&accels).zip(&mut runs) {
                    shot.set_seed(seed);
                    let (pixels, seconds) = bench.render(shot, &**accel)?;
                    runs.push(reference.judge(&pixels, seconds));
                }
            }
            for (series, runs) in series.iter_mut().zip(runs) {
                series.points.push(Point { samples: count, runs });
            }
        }
        Ok((reference, series))
    }

    fn reference(&self, bench: &Bench<'_>, accel: &dyn Accel) -> Result<Reference> {
        let (None, Some(settings)) = (&self.args.reference, self.reference) else {
            return self.read_reference(self.args.reference.as_deref().unwrap_or(Path::new("")));
        };
        let mut shot = Shot::new(&self.scene, settings)?;
        let mut render = |seed| {
            shot.set_seed(seed);
            bench.render(&shot, accel).map(|(pixels, _)| pixels)
        };
        let (a, b) = (render(REFERENCE_SEED)?, render(REFERENCE_SEED + 1)?);
        Ok(Reference::of_halves(&a, &b))
    }

    fn read_reference(&self, path: &Path) -> Result<Reference> {
        let picture = image_io::read(path)?;
        check_finite(path, &picture, |name| name == BEAUTY)?;
        let image = self.own.image;
        let (width, height) = (image.width as usize, image.height as usize);
        if (picture.width, picture.height) != (width, height) {
            return Err(Error::input(format!(
                "the reference has {} x {} pixels and the scene {width} x {height}",
                picture.width, picture.height
            ))
            .with_help(format!("add --size {}x{}", picture.width, picture.height)));
        }
        let beauty = picture.layer(BEAUTY).ok_or_else(|| {
            Error::input(format!("`{}` has no layer for the whole picture", path.display()))
        })?;
        let variance = picture.layer("variance").map(|layer| layer.pixels.as_slice());
        Ok(Reference::of_picture(beauty.pixels.clone(), variance))
    }

    fn name_of(&self, variant: &Variant) -> String {
        let own = self.own.render.integrator.kind().name();
        let mut parts = vec![variant.integrator.as_deref().unwrap_or(own)];
        parts.extend(
            [&variant.estimator, &variant.sampler].into_iter().filter_map(Option::as_deref),
        );
        if !self.args.accels.is_empty() {
            parts.push(variant.accel.name());
        }
        parts.join(", ")
    }

    fn scene_name(&self) -> String {
        let path = &self.args.scene.path;
        path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
    }

    fn size_in_words(&self) -> String {
        let image = self.own.image;
        format!("{} x {} pixels, {} seeds", image.width, image.height, self.args.seeds)
    }

    fn about_reference(&self, reference: &Reference, metric: Metric) -> String {
        let what = match &self.args.reference {
            Some(path) => path.display().to_string(),
            None => format!(
                "{}, 2 x {} samples per pixel",
                self.reference_integrator,
                self.reference_half()
            ),
        };
        match reference.noise(metric) {
            Some(own) => {
                format!("reference: {what}; its own {} of {own:.3e} is taken away", metric.name())
            }
            None => format!("reference: {what}; its own error is not known and stays in"),
        }
    }
}

/// Renders, and shows how far all is.
struct Bench<'a> {
    args: &'a ConvergeArgs,
    progress: &'a Progress,
    done: AtomicU64,
    total: u64,
    began: Instant,
}

impl Bench<'_> {
    /// The beauty, and the seconds it took.
    fn render(&self, shot: &Shot, accel: &dyn Accel) -> Result<(Vec<Rgb>, f64)> {
        let began = Instant::now();
        let rendered = job::render(shot, accel, &[], &Cancel::default())?;
        let seconds = began.elapsed().as_secs_f64();
        let done = self.done.fetch_add(rendered.samples, Ordering::Relaxed) + rendered.samples;
        self.progress.show(&State::since(self.began, done, self.total));
        if !self.args.quiet && done == rendered.samples {
            rendered.warnings.iter().for_each(print::warning);
        }
        Ok((beauty(&rendered.picture), seconds))
    }
}

fn beauty(picture: &Picture) -> Vec<Rgb> {
    (0..picture.len()).map(|pixel| picture.beauty(pixel)).collect()
}

/// Without a reference of the user's choice, only integrators that converge to the same picture are
/// compared with one: `path` and `paper` do, each of the others shows something of its own.
fn must_share_a_mean(integrators: &[String], reference: &str) -> Result<()> {
    let shown = |name: &str| if name == "paper" { "path".to_owned() } else { name.to_owned() };
    match integrators.iter().find(|name| shown(name) != shown(reference)) {
        None => Ok(()),
        Some(other) => Err(Error::input(format!(
            "`{other}` and `{reference}` converge to different pictures: no reference serves both"
        ))
        .with_help(
            "compare them one by one, or say with --reference-integrator NAME or --reference FILE \
             which picture is right",
        )),
    }
}

/// What the samples of a pixel have to be a multiple of.
fn subpixels(settings: &Settings) -> u32 {
    match settings.render.integrator {
        Integrator::Paper(paper) => paper.subpixels.pow(2),
        _ => 1,
    }
}

impl Variant {
    /// What the scene says, with this intersector.
    fn of(accel: Backend) -> Self {
        Self { integrator: None, estimator: None, sampler: None, accel, settings: Vec::new() }
    }
}

/// Everything with everything.
fn variants(args: &ConvergeArgs) -> Vec<Variant> {
    let options = |names: &[String]| -> Vec<Option<String>> {
        if names.is_empty() { vec![None] } else { names.iter().cloned().map(Some).collect() }
    };
    let accels =
        if args.accels.is_empty() { vec![Backend::default()] } else { args.accels.clone() };
    let mut variants = Vec::new();
    for integrator in options(&args.integrators) {
        for estimator in options(&args.estimators) {
            for sampler in options(&args.samplers) {
                let of = |&accel: &Backend| Variant {
                    integrator: integrator.clone(),
                    estimator: estimator.clone(),
                    sampler: sampler.clone(),
                    ..Variant::of(accel)
                };
                variants.extend(accels.iter().map(of));
            }
        }
    }
    variants
}

/// The reference's integrator; `own` are the scene's settings.
fn reference_integrator(args: &ConvergeArgs, own: &Settings) -> Result<String> {
    let own = own.render.integrator.kind().name();
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

/// The settings of a variant; where the scene objects to them, it does so now and not after an hour.
fn settings_of(args: &ConvergeArgs, variant: &Variant, samples: Option<u32>) -> Result<Settings> {
    let overrides = overrides_of(args, variant, samples);
    Ok(read_file(&args.scene.path, &overrides)?.settings)
}

fn overrides_of(args: &ConvergeArgs, variant: &Variant, samples: Option<u32>) -> Vec<Override> {
    let mut overrides = Vec::new();
    let mut set = |option: String, key: &str, value: String| {
        overrides.push(Override { option, key: key.to_owned(), value });
    };
    let names = [
        ("integrator", &variant.integrator),
        ("estimator", &variant.estimator),
        ("sampler", &variant.sampler),
    ];
    for (key, name) in names {
        if let Some(name) = name {
            set(format!("--{key} {name}"), &format!("render.{key}"), name.clone());
        }
    }
    if let Some(size) = args.size {
        set(format!("--size {size}"), "image.width", size.width.to_string());
        set(format!("--size {size}"), "image.height", size.height.to_string());
    }
    if let Some(samples) = samples {
        set(format!("--spp {samples}"), "render.samples_per_pixel", samples.to_string());
    }
    overrides.extend(args.scene.overrides());
    overrides
}
