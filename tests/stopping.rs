//! Renders that end when the picture is good enough: what the decision depends on, that it does not
//! bias the picture, and that the stated interval holds the truth as often as it says.

#[path = "common/render.rs"]
mod common;

use rayon::prelude::*;

use photosphere::accel::{Accel, Backend, BuildOptions, Cancel};
use photosphere::film::Film;
use photosphere::render::{
    RenderOptions, Session, Standing, Target, format_of, half_widths, render_to,
};
use photosphere::scene::Scene;
use photosphere::verify::statistics::Estimate;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};

use common::scene;

/// Seeds of the proof.
const SEEDS: u64 = 200;
/// Coarse enough for a test, fine enough for squares to stop at different numbers of samples.
const TARGET: Target = Target { error: 0.04, confidence: 0.95 };
/// More than any square takes.
const MOST: u32 = 4096;

/// Balls on matt ground in the open, and a lamp beside the picture. The left one of its two squares is
/// near the lamp, the right one has more shade, and both have edges of light.
const SCENE: &str = r#"
format = 1

[image]
width = 32
height = 16

[camera]
position = [0.0, 3.0, 6.0]
look_at = [0.3, 0.3, 0.0]
vertical_fov_degrees = 22.0

[background]
radiance = [0.2, 0.25, 0.3]

[materials.ground]
type = "diffuse"
albedo = [0.6, 0.5, 0.4]

[materials.white]
type = "diffuse"
albedo = [0.8, 0.8, 0.8]

[materials.lamp]
type = "diffuse"
albedo = [0.0, 0.0, 0.0]
emission = [20.0, 18.0, 15.0]

[[spheres]]
center = [0.0, -100.0, 0.0]
radius = 100.0
material = "ground"

[[spheres]]
center = [1.2, 0.6, 0.0]
radius = 0.6
material = "white"

[[spheres]]
center = [-0.6, 0.35, 0.4]
radius = 0.35
material = "ground"

[[spheres]]
center = [-2.5, 2.5, 0.5]
radius = 0.4
material = "lamp"

[render]
integrator = "path"
max_depth = 5
"#;

fn small_scene(overrides: &[&str]) -> Scene {
    let most = format!("render.samples_per_pixel={MOST}");
    let overrides: Vec<&str> =
        [most.as_str()].into_iter().chain(overrides.iter().copied()).collect();
    scene(SCENE, &overrides)
}

fn accel(scene: &Scene) -> Box<dyn Accel> {
    Backend::Native.build(scene.spheres(), &BuildOptions::default()).expect("builds")
}

/// A film of the scene that is filled until it meets the target.
fn stopped(scene: &Scene, target: Target) -> (Film, Standing) {
    let film = Film::new(&format_of(scene)).expect("a small film");
    let accel = accel(scene);
    let options = RenderOptions { cancel: Cancel::default(), progress: &|_| {} };
    let session = Session::new(scene, &*accel, &film, &options);
    let (standing, complete) =
        render_to(&session, target, MOST, &|_| {}).expect("no light so bright");
    assert!(complete);
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

/// The same scene with very many samples.
fn long_reference() -> Film {
    let scene = small_scene(&["render.seed=1000", "render.samples_per_pixel=16384"]);
    let film = Film::new(&format_of(&scene)).expect("a small film");
    let accel = accel(&scene);
    let options = RenderOptions { cancel: Cancel::default(), progress: &|_| {} };
    let session = Session::new(&scene, &*accel, &film, &options);
    assert!(session.advance(16384, &|_| true).expect("no light so bright"));
    film
}

fn run(sampler: &str, seed: u64, truth: &[f64]) -> Run {
    let (sampler, seed) = (format!("render.sampler={sampler}"), format!("render.seed={seed}"));
    let (film, standing) = stopped(&small_scene(&[&sampler, &seed]), TARGET);
    assert_eq!(standing.done, standing.squares);
    let values = values(&film);
    let widths: Vec<f64> = half_widths(&film, TARGET.confidence).concat();
    let brightness: Vec<f64> = truth.chunks(3).map(|rgb| rgb.iter().sum::<f64>() / 3.0).collect();
    let off = |i: usize| (values[i] - truth[i]).abs();
    let share = |is: &dyn Fn(usize) -> bool| {
        (0..values.len()).filter(|&i| is(i)).count() as f64 / values.len() as f64
    };
    let covered = share(&|i| off(i) <= widths[i]);
    let near = share(&|i| off(i) <= TARGET.error * brightness[i / 3]);
    Run { covered, near, samples: film.samples() as f64, values }
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
    for (sampler, most) in [("independent", 0.97), ("sobol", 1.0)] {
        let runs: Vec<Run> =
            (0..SEEDS).into_par_iter().map(|seed| run(sampler, seed, &truth)).collect();
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

/// Standard errors that a mean over the seeds may be off: 18 comparisons fail a right program with a
/// probability of 0.2 %.
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
        let Estimate { mean, standard_error, .. } = Estimate::of(&ratios);
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
    let whole = small_scene(&[]);
    let (film, standing) = stopped(&whole, target);
    let counts = film.counts();
    assert!(
        counts.iter().any(|&n| n > counts[0]) && standing.done == standing.squares,
        "{counts:?}"
    );
    let bits = |film: &Film| {
        (values(film).into_iter().map(f64::to_bits).collect::<Vec<_>>(), film.counts())
    };

    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    assert_eq!(bits(&pool.install(|| stopped(&whole, target).0)), bits(&film));
    assert_eq!(bits(&stopped_and_resumed(&whole, target)), bits(&film));
    for (left, window) in [(0, "[0,0,16,16]"), (16, "[16,0,32,16]")] {
        let part = stopped(&small_scene(&[&format!("image.crop={window}")]), target).0;
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

/// The same, in many pieces: each is cancelled after some more samples.
fn stopped_and_resumed(scene: &Scene, target: Target) -> Film {
    let film = Film::new(&format_of(scene)).expect("a small film");
    let accel = accel(scene);
    for piece in 1.. {
        let cancel = Cancel::default();
        let stop_at = piece * 5000;
        let progress = |now: photosphere::render::Progress| {
            if now.samples_done > stop_at {
                cancel.cancel();
            }
        };
        let options = RenderOptions { cancel: cancel.clone(), progress: &progress };
        let session = Session::new(scene, &*accel, &film, &options);
        if render_to(&session, target, MOST, &|_| {}).expect("no light so bright").1 {
            assert!(piece > 3, "it was to be stopped more often");
            break;
        }
    }
    film
}

#[test]
fn what_cannot_be_met_ends_at_the_most_samples_and_says_so() {
    let scene = small_scene(&[]);
    let film = Film::new(&format_of(&scene)).expect("a small film");
    let accel = accel(&scene);
    let options = RenderOptions { cancel: Cancel::default(), progress: &|_| {} };
    let session = Session::new(&scene, &*accel, &film, &options);
    let target = Target { error: 1e-4, confidence: 0.95 };
    let (standing, complete) =
        render_to(&session, target, 100, &|_| {}).expect("no light so bright");
    assert!(complete && film.counts().iter().all(|&count| count == 100));
    assert_eq!((standing.done, standing.squares), (0, 2));
    assert!(standing.worst > 0.01 && standing.worst < 10.0, "{standing:?}");
}
