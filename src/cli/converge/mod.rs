//! `photosphere converge`: error against samples and against time.

mod report;

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use crate::accel::{Accel, Backend, BuildOptions};
use crate::color::Rgb;
use crate::error::{Error, Result};
use crate::film::Picture;
use crate::output::{self, BEAUTY, WholeFile};
use crate::render::{self, RenderOptions};
use crate::scene::description::Integrator;
use crate::scene::{Override, Scene};
use crate::verify::converge::{Metric, Point, Reference, Series, plot};

use super::args::ConvergeArgs;
use super::compare::check_finite;
use super::exit::Exit;
use super::info::name_of;
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
}

/// What is to be rendered; everything that the scene can object to has been tried.
struct Study<'a> {
    args: &'a ConvergeArgs,
    /// Any of the scenes: all have the same spheres.
    scene: Scene,
    variants: Vec<Variant>,
    /// Samples per pixel, rising.
    samples: Vec<u32>,
    reference_integrator: String,
}

impl<'a> Study<'a> {
    fn new(args: &'a ConvergeArgs) -> Result<Self> {
        let options = |names: &[String]| -> Vec<Option<String>> {
            if names.is_empty() { vec![None] } else { names.iter().cloned().map(Some).collect() }
        };
        let accels =
            if args.accels.is_empty() { vec![Backend::default()] } else { args.accels.clone() };
        let mut variants = Vec::new();
        for integrator in options(&args.integrators) {
            for estimator in options(&args.estimators) {
                for sampler in options(&args.samplers) {
                    let [integrator, estimator, sampler] =
                        [&integrator, &estimator, &sampler].map(Clone::clone);
                    let of = |&accel: &Backend| Variant {
                        integrator: integrator.clone(),
                        estimator: estimator.clone(),
                        sampler: sampler.clone(),
                        accel,
                    };
                    variants.extend(accels.iter().map(of));
                }
            }
        }
        let mut step = 1;
        for variant in &variants {
            step = step.max(subpixels(&load(args, variant, None)?));
        }
        let samples = args.samples(step);
        let scene = load(args, &variants[0], Some(samples[0]))?;
        let own = name_of(&scene.description().render.integrator);
        let is_compared = |name: &str| match args.integrators.as_slice() {
            [] => own == name,
            names => names.iter().any(|one| one == name),
        };
        let reference_integrator = match &args.reference_integrator {
            Some(name) => name.clone(),
            None if is_compared("path") || is_compared("paper") => "path".to_owned(),
            None => args.integrators.first().map_or(own, String::as_str).to_owned(),
        };
        if args.reference_integrator.is_none() && args.reference.is_none() {
            must_share_a_mean(&args.integrators, &reference_integrator)?;
        }
        let study = Self { args, scene, variants, samples, reference_integrator };
        study.try_all()?;
        Ok(study)
    }

    /// Lets the scene object now and not after an hour.
    fn try_all(&self) -> Result<()> {
        for variant in &self.variants {
            for &count in &self.samples {
                load(self.args, variant, Some(count))?;
            }
        }
        match &self.args.reference {
            Some(_) => Ok(()),
            None => self.load_reference().map(drop),
        }
    }

    /// The scene as the halves of the reference render it.
    fn load_reference(&self) -> Result<Scene> {
        let integrator = Some(self.reference_integrator.clone());
        let accel = self.variants[0].accel;
        let variant = Variant { integrator, estimator: None, sampler: None, accel };
        load(self.args, &variant, Some(self.reference_half()))
    }

    fn reference_half(&self) -> u32 {
        self.args.reference_half(self.samples.last().copied().unwrap_or(1))
    }

    fn pixels(&self) -> u64 {
        let image = self.scene.description().image;
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
        for &count in &self.samples {
            let mut scenes: Vec<Scene> = self
                .variants
                .iter()
                .map(|variant| load(self.args, variant, Some(count)))
                .collect::<Result<_>>()?;
            let mut runs = vec![Vec::new(); scenes.len()];
            // The variants take turns, so that what else the machine does troubles all alike.
            for seed in self.args.seed..self.args.seed + u64::from(self.args.seeds) {
                for ((scene, accel), runs) in scenes.iter_mut().zip(&accels).zip(&mut runs) {
                    scene.set_seed(seed);
                    let (pixels, seconds) = bench.render(scene, &**accel)?;
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
        if let Some(path) = &self.args.reference {
            return self.read_reference(path);
        }
        let mut scene = self.load_reference()?;
        let mut render = |seed| {
            scene.set_seed(seed);
            bench.render(&scene, accel).map(|(pixels, _)| pixels)
        };
        let (a, b) = (render(REFERENCE_SEED)?, render(REFERENCE_SEED + 1)?);
        Ok(Reference::of_halves(&a, &b))
    }

    fn read_reference(&self, path: &Path) -> Result<Reference> {
        let picture = output::read(path)?;
        check_finite(path, &picture, |name| name == BEAUTY)?;
        let image = self.scene.description().image;
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
        let own = name_of(&self.scene.description().render.integrator);
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
        let image = self.scene.description().image;
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
    fn render(&self, scene: &Scene, accel: &dyn Accel) -> Result<(Vec<Rgb>, f64)> {
        let before = self.done.load(Ordering::Relaxed);
        let show = |state: render::Progress| {
            let samples_done = before + state.samples_done;
            self.progress.show(&State::since(self.began, samples_done, self.total));
        };
        let options = RenderOptions { cancel: Default::default(), progress: &show };
        let began = Instant::now();
        let outcome = render::render(scene, accel, &options)?;
        let seconds = began.elapsed().as_secs_f64();
        self.done.fetch_add(outcome.samples, Ordering::Relaxed);
        if !self.args.quiet && self.done.load(Ordering::Relaxed) == outcome.samples {
            outcome.warnings.iter().for_each(print::warning);
        }
        Ok((beauty(&outcome.picture), seconds))
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
fn subpixels(scene: &Scene) -> u32 {
    match scene.description().render.integrator {
        Integrator::Paper(paper) => paper.subpixels.pow(2),
        _ => 1,
    }
}

/// The scene as a variant renders it.
fn load(args: &ConvergeArgs, variant: &Variant, samples: Option<u32>) -> Result<Scene> {
    let mut overrides = Vec::new();
    let mut set = |option: String, key: &str, value: String| {
        overrides.push(Override { option, key: key.to_owned(), value });
    };
    if let Some(name) = &variant.integrator {
        set(format!("--integrator {name}"), "render.integrator", name.clone());
    }
    if let Some(name) = &variant.estimator {
        set(format!("--estimator {name}"), "render.estimator", name.clone());
    }
    if let Some(name) = &variant.sampler {
        set(format!("--sampler {name}"), "render.sampler", name.clone());
    }
    if let Some(size) = args.size {
        set(format!("--size {size}"), "image.width", size.width.to_string());
        set(format!("--size {size}"), "image.height", size.height.to_string());
    }
    if let Some(samples) = samples {
        set(format!("--spp {samples}"), "render.samples_per_pixel", samples.to_string());
    }
    overrides.extend(args.scene.overrides());
    Scene::load(&args.scene.path, &overrides)
}
