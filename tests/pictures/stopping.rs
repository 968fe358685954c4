//! Renders that end when the picture is good enough: what the decision depends on, that it does not
//! bias the picture, and that the stated interval holds the truth as often as it says.

use std::sync::atomic::{AtomicUsize, Ordering};

use photosphere::accel::{Accel, Backend, ErrorBound};
use photosphere::color::{Rgb, ToneCurve, ViewTransform};
use photosphere::film::Film;
use photosphere::geometry::{PathRays, SphereSet};
use photosphere::job::{
    Counters, NoiseProgress, NoiseTarget, ProgressiveRenderer, Quality, confidence_half_widths,
    format_for_scene, render_adaptive,
};
use photosphere::math::{DVec3, Hit, Ray, Rect};
use photosphere::sampling::SamplerKind;
use photosphere::scene::description::{
    BackgroundDescription, CameraDescription, EnvironmentDescription, MaterialDescription,
    ProjectionDescription, SphereDescription, SurfaceModel,
};
use photosphere::scene::settings::{ImageSettings, RenderSettings};
use photosphere::scene::{PreparedScene, Scene, SceneDescription, Settings};
use photosphere::task::CancelToken;
use photosphere::verify::statistics::MeanEstimate;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use rayon::prelude::*;

use crate::kit::built;

/// Seeds of the proof.
const SEEDS: u64 = 200;
/// Coarse enough for a test, fine enough for squares to stop at different numbers of samples.
const TARGET: NoiseTarget = NoiseTarget { error: 0.04, confidence: 0.95, display: None };
/// More than any square takes.
const MOST: u32 = 4096;

fn diffuse(name: &str, albedo: [f32; 3], emission: [f32; 3]) -> MaterialDescription {
    let surface = SurfaceModel::Diffuse { albedo: Rgb::from(albedo), roughness: 0.0 };
    MaterialDescription { name: name.to_owned(), surface, emission: emission.into(), opacity: 1.0 }
}

fn ball(center: [f64; 3], radius: f64, material: usize) -> SphereDescription {
    let center = DVec3::from(center);
    SphereDescription { center, radius, material, ..SphereDescription::default() }
}

/// Balls on diffuse ground in the open, and an emitter beside the picture. The left one of its two
/// squares is near the emitter, the right one has more shade, and both have edges of light.
fn small_scene() -> Scene {
    let camera = CameraDescription {
        position: DVec3::new(0.0, 3.0, 6.0),
        look_at: DVec3::new(0.3, 0.3, 0.0),
        projection: ProjectionDescription::Perspective { vertical_fov_degrees: 22.0, lens: None },
        ..CameraDescription::default()
    };
    let dome = EnvironmentDescription::Constant { radiance: Rgb::new(0.2, 0.25, 0.3) };
    let [ground, white, emitter] = [0, 1, 2];
    let description = SceneDescription {
        camera,
        background: BackgroundDescription { dome, ..BackgroundDescription::default() },
        materials: vec![
            diffuse("ground", [0.6, 0.5, 0.4], [0.0; 3]),
            diffuse("white", [0.8; 3], [0.0; 3]),
            diffuse("lamp", [0.0; 3], [20.0, 18.0, 15.0]),
        ],
        spheres: vec![
            ball([0.0, -100.0, 0.0], 100.0, ground),
            ball([1.2, 0.6, 0.0], 0.6, white),
            ball([-0.6, 0.35, 0.4], 0.35, ground),
            ball([-2.5, 2.5, 0.5], 0.4, emitter),
        ],
        tables: Vec::new(),
    };
    Scene::build(description).expect("a scene without mistakes")
}

fn settings() -> Settings {
    let image = ImageSettings { width: 32, height: 16, ..ImageSettings::default() };
    let render =
        RenderSettings { samples_per_pixel: MOST, max_depth: Some(5), ..RenderSettings::default() };
    Settings { image, render }
}

/// The small scene, ready to be rendered.
fn prepared(settings: Settings) -> PreparedScene {
    PreparedScene::new(&small_scene(), settings).expect("settings that make sense")
}

fn accel(prepared: &PreparedScene) -> Box<dyn Accel> {
    built(prepared, Backend::Native)
}

fn empty_film(prepared: &PreparedScene) -> Film {
    Film::new(&format_for_scene(prepared, &[])).expect("a small film")
}

/// Fills a film of the shot until it meets the target or is cancelled; the second says whether it
/// got to its end.
fn fill_with(
    accel: &dyn Accel,
    prepared: &PreparedScene,
    film: &Film,
    target: NoiseTarget,
    most: u32,
    cancel: &CancelToken,
) -> (NoiseProgress, bool) {
    let counters = Counters::new(film, 0);
    let passes = ProgressiveRenderer::new(prepared, accel, film, &counters, cancel);
    render_adaptive(&passes, target, most, &|_| {}).expect("no light so bright")
}

/// Adds samples to the film until they meet the target; nobody cancels it.
fn fill(prepared: &PreparedScene, film: &Film, target: NoiseTarget, most: u32) -> NoiseProgress {
    let accel = accel(prepared);
    let (standing, complete) =
        fill_with(&*accel, prepared, film, target, most, &CancelToken::default());
    assert!(complete);
    standing
}

/// A film of the shot that is filled until it meets the target.
fn stopped(prepared: &PreparedScene, target: NoiseTarget) -> (Film, NoiseProgress) {
    let film = empty_film(prepared);
    let standing = fill(prepared, &film, target, MOST);
    (film, standing)
}

/// The beauty of every pixel, channel by channel.
fn values(film: &Film) -> Vec<f64> {
    let picture = film.picture();
    (0..picture.len()).flat_map(|i| picture.beauty(i).to_array().map(f64::from)).collect()
}

/// One stopped picture, judged.
struct Run {
    values: Vec<f64>,
    /// The share of the values whose interval holds the truth.
    covered: f64,
    /// The share of the values that are as near to it as was asked for.
    near: f64,
    samples: f64,
}

/// A film of the scene with very many samples.
fn long_reference() -> Film {
    let mut settings = settings();
    settings.render.seed = 1000;
    settings.render.samples_per_pixel = 16384;
    let prepared = prepared(settings);
    let (film, accel, cancel) = (empty_film(&prepared), accel(&prepared), CancelToken::default());
    let counters = Counters::new(&film, 0);
    let passes = ProgressiveRenderer::new(&prepared, &*accel, &film, &counters, &cancel);
    assert!(passes.render_to_sample(16384, &|_| true).expect("no light so bright"));
    film
}

fn run(sampler: SamplerKind, seed: u64, truth: &[f64], target: NoiseTarget) -> Run {
    let mut settings = settings();
    (settings.render.sampler, settings.render.seed) = (sampler, seed);
    let (film, standing) = stopped(&prepared(settings), target);
    assert_eq!(standing.tiles_converged, standing.tiles);
    let values = values(&film);
    let widths: Vec<f64> = confidence_half_widths(&film, target.confidence).concat();
    let brightness: Vec<f64> = truth.chunks(3).map(|rgb| rgb.iter().sum::<f64>() / 3.0).collect();
    let off = |i: usize| (values[i] - truth[i]).abs();
    let share = |is: &dyn Fn(usize) -> bool| {
        (0..values.len()).filter(|&i| is(i)).count() as f64 / values.len() as f64
    };
    let covered = share(&|i| off(i) <= widths[i]);
    let near = share(&|i| match target.display {
        None => off(i) <= target.error * brightness[i / 3],
        Some(view) => (shown(view, &values, i) - shown(view, truth, i)).abs() <= target.error,
    });
    Run { covered, near, samples: film.sample_count() as f64, values }
}

/// A value as it is displayed.
fn shown(view: ViewTransform, values: &[f64], index: usize) -> f64 {
    let pixel = &values[index - index % 3..][..3];
    let light = Rgb::new(pixel[0] as f32, pixel[1] as f32, pixel[2] as f32);
    f64::from(view.to_display(light)[index % 3])
}

/// The middle 99 % of the means of the numbers drawn again with repetition: with which mean other
/// seeds might have been met.
fn bootstrap(numbers: &[f64]) -> [f64; 2] {
    let mut random = StdRng::seed_from_u64(1);
    let mut means: Vec<f64> = (0..2000)
        .map(|_| {
            let drawn = numbers.iter().map(|_| numbers[random.random_range(0..numbers.len())]);
            drawn.sum::<f64>() / numbers.len() as f64
        })
        .collect();
    means.sort_by(f64::total_cmp);
    [means[10], means[1989]]
}

#[test]
#[allow(clippy::print_stdout, reason = "the figures are worth reading with --nocapture")]
fn stopping_does_not_bias_and_the_interval_holds_the_truth() {
    let reference = long_reference();
    let truth = values(&reference);
    for (kind, most) in [(SamplerKind::Independent, 0.97), (SamplerKind::Sobol, 1.0)] {
        let sampler = kind.name();
        let runs: Vec<Run> =
            (0..SEEDS).into_par_iter().map(|seed| run(kind, seed, &truth, TARGET)).collect();
        let covered: Vec<f64> = runs.iter().map(|run| run.covered).collect();
        let [low, high] = bootstrap(&covered);
        let near: f64 = runs.iter().map(|run| run.near).sum::<f64>() / SEEDS as f64;
        let samples: f64 = runs.iter().map(|run| run.samples).sum::<f64>() / SEEDS as f64 / 512.0;
        println!(
            "{sampler}: {samples:.0} samples per pixel, coverage {low:.4} to {high:.4}, \
             nearer than the target {near:.4}"
        );
        assert!(low >= 0.93 && high <= most, "{sampler}: {low} to {high}");
        assert!(near >= TARGET.confidence, "{sampler}: {near}");
        must_not_be_biased(sampler, &runs, &reference);
    }
}

#[test]
#[allow(clippy::print_stdout, reason = "the figures are worth reading with --nocapture")]
fn displayed_values_are_as_near_as_the_quality_says() {
    let reference = long_reference();
    let truth = values(&reference);
    let filmic = ViewTransform { tone: ToneCurve::Filmic, exposure: 1.0, dither: false };
    let cases = [(Quality::Good, ViewTransform::default()), (Quality::Preview, filmic)];
    for ((quality, view), kind) in cases
        .iter()
        .flat_map(|case| [SamplerKind::Independent, SamplerKind::Sobol].map(|k| (case, k)))
    {
        let target = quality.target(*view);
        let what = format!("{} {}", quality.name(), kind.name());
        let runs: Vec<Run> =
            (0..SEEDS).into_par_iter().map(|seed| run(kind, seed, &truth, target)).collect();
        let near: f64 = runs.iter().map(|run| run.near).sum::<f64>() / SEEDS as f64;
        let samples: f64 = runs.iter().map(|run| run.samples).sum::<f64>() / SEEDS as f64 / 512.0;
        println!("{what}: {samples:.0} samples per pixel, nearer than the target {near:.4}");
        assert!(near >= target.confidence, "{what}: {near}");
        must_not_be_biased(&what, &runs, &reference);
    }
}

/// Standard errors that a mean over the seeds may be off: 18 comparisons fail a right program with
/// a probability of 0.2 %.
const ALLOWED: f64 = 4.0;
/// A bias that nobody minds, relative.
const ALLOWANCE: f64 = 1e-5;

/// Compares the means over all seeds with the reference, for the whole and for each square.
#[allow(clippy::print_stdout, reason = "the figures are worth reading with --nocapture")]
fn must_not_be_biased(sampler: &str, runs: &[Run], reference: &Film) {
    let (truth, variance) = (values(reference), reference.variance().expect("squares are summed"));
    let variance: Vec<f64> = variance.concat().into_iter().map(f64::from).collect();
    let parts = [("all", 0..32), ("left", 0..16), ("right", 16..32)];
    for ((part, columns), channel) in parts.iter().flat_map(|part| (0..3).map(move |c| (part, c))) {
        let sum = |values: &[f64]| -> f64 {
            let inside = |i: &usize| i % 3 == channel && columns.contains(&(i / 3 % 32));
            (0..values.len()).filter(inside).map(|i| values[i]).sum()
        };
        let expected = sum(&truth);
        let of_reference = sum(&variance).sqrt() / expected;
        let ratios: Vec<f64> = runs.iter().map(|run| sum(&run.values) / expected).collect();
        let MeanEstimate { mean, standard_error, .. } = MeanEstimate::from_values(&ratios);
        let error = standard_error.hypot(of_reference);
        println!("{sampler}, {part}, channel {channel}: {mean:.5} +- {error:.5} of the reference");
        let most = ALLOWED * error + ALLOWANCE;
        assert!((mean - 1.0).abs() <= most, "{sampler}, {part}, {channel}: {mean}");
        // What could hide there is far below the noise that the target leaves to a pixel.
        assert!(ALLOWED * error < TARGET.error / 10.0, "{error}");
    }
}

#[test]
fn threads_stops_and_windows_change_no_bit() {
    let target = TARGET;
    let whole = prepared(settings());
    let (film, standing) = stopped(&whole, target);
    let counts = film.counts();
    assert!(
        counts.iter().any(|&n| n > counts[0]) && standing.tiles_converged == standing.tiles,
        "{counts:?}"
    );
    let bits = |film: &Film| {
        (values(film).into_iter().map(f64::to_bits).collect::<Vec<_>>(), film.counts())
    };

    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    assert_eq!(bits(&pool.install(|| stopped(&whole, target).0)), bits(&film));
    assert_eq!(bits(&stopped_and_resumed(&whole, target)), bits(&film));
    for left in [0, 16] {
        let mut settings = settings();
        settings.image.crop = Some(Rect { x: left, y: 0, width: 16, height: 16 });
        let part = stopped(&prepared(settings), target).0;
        let left = left as usize;
        let places = |row: usize| row * 32 + left..row * 32 + left + 16;
        let expected: Vec<u32> = (0..16).flat_map(|row| counts[places(row)].to_vec()).collect();
        assert_eq!(part.counts(), expected);
        let all = values(&film);
        let expected: Vec<f64> = (0..16)
            .flat_map(|row| all[3 * places(row).start..3 * places(row).end].to_vec())
            .collect();
        assert_eq!(values(&part), expected);
    }
}

/// A film that meets the target, filled in many pieces: each is cancelled after some more rays.
fn stopped_and_resumed(prepared: &PreparedScene, target: NoiseTarget) -> Film {
    let film = empty_film(prepared);
    let mut pieces = 1;
    loop {
        let cancel = CancelToken::default();
        let tiring = Tiring::new(accel(prepared), &cancel);
        if fill_with(&tiring, prepared, &film, target, MOST, &cancel).1 {
            assert!(pieces > 3, "it was to be stopped more often");
            return film;
        }
        pieces += 1;
    }
}

/// An intersector that has the work cancelled after a number of rays.
struct Tiring<'a> {
    accel: Box<dyn Accel>,
    left: AtomicUsize,
    cancel: &'a CancelToken,
}

impl<'a> Tiring<'a> {
    fn new(accel: Box<dyn Accel>, cancel: &'a CancelToken) -> Self {
        Self { accel, left: AtomicUsize::new(4_000), cancel }
    }

    fn tire(&self, rays: usize) {
        if self.left.fetch_sub(rays, Ordering::Relaxed) <= rays {
            self.cancel.cancel();
        }
    }
}

impl Accel for Tiring<'_> {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.accel.closest(rays, hits);
        self.tire(rays.len());
    }

    fn occluded(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.accel.occluded(rays, occluded);
    }

    fn closest_path_rays(
        &self,
        spheres: &SphereSet,
        rays: &PathRays,
        asked: &mut Vec<Ray>,
        hits: &mut [Hit],
    ) {
        self.accel.closest_path_rays(spheres, rays, asked, hits);
        self.tire(hits.len());
    }

    fn occluded_path_rays(
        &self,
        spheres: &SphereSet,
        rays: &PathRays,
        asked: &mut Vec<Ray>,
        occluded: &mut [bool],
    ) {
        self.accel.occluded_path_rays(spheres, rays, asked, occluded);
    }

    fn error_bound(&self) -> ErrorBound {
        self.accel.error_bound()
    }

    fn bytes(&self) -> usize {
        self.accel.bytes()
    }
}

#[test]
fn what_cannot_be_met_ends_at_the_most_samples_and_says_so() {
    let prepared = prepared(settings());
    let film = empty_film(&prepared);
    let target = NoiseTarget::new(1e-4);
    let standing = fill(&prepared, &film, target, 100);
    assert!(film.counts().iter().all(|&count| count == 100));
    assert_eq!((standing.tiles_converged, standing.tiles), (0, 2));
    assert!(standing.worst_error > 0.01 && standing.worst_error < 10.0, "{standing:?}");
}
