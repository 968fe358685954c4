//! What each of the paper's shortcuts costs: its bias, its variance and its time against the default.
//!
//! Figure 2, 8 x 6 pixels, 102400 samples per pixel in 32 independent seeds. Prints the table of
//! `docs/paper.md`:
//!
//!     cargo run --release --example bias

#![allow(clippy::print_stdout, reason = "a program that prints a table")]

use std::path::Path;
use std::time::Instant;

use photosphere::Result;
use photosphere::accel::{Backend, BuildOptions};
use photosphere::film::Picture;
use photosphere::render::{RenderOptions, render};
use photosphere::scene::{Override, Scene};
use photosphere::verify::statistics::{Estimate, student_t_quantile};

const SEEDS: u64 = 32;
const SAMPLES: u32 = 3200;

/// Each shortcut and the keys that ask for it. The first row is what the others are held against.
const ROWS: [(&str, &[&str]); 12] = [
    ("default: `path`", &["integrator=path"]),
    ("depth stop, direct light only", &["integrator=path", "max_depth=2"]),
    ("depth stop after one bounce", &["integrator=path", "max_depth=3"]),
    ("chance lights", &["integrator=paper"]),
    ("... and uniform directions", &["integrator=paper", "paper.hemisphere=uniform-solid-angle"]),
    ("... and uniform angles", &["integrator=paper", "paper.hemisphere=uniform-angle"]),
    ("... and depth stop", &["integrator=paper", "paper.stop=depth", "max_depth=4"]),
    (
        "... and threshold stop at 0.01",
        &["integrator=paper", "paper.stop=threshold", "paper.threshold=0.01"],
    ),
    (
        "... and threshold stop at 0.3",
        &["integrator=paper", "paper.stop=threshold", "paper.threshold=0.3"],
    ),
    ("... and redraw on a miss", &["integrator=paper", "paper.miss=redraw"]),
    ("... and fixed places in the sub-pixels", &["integrator=paper", "paper.jitter=0"]),
    ("clamped indirect light", &["integrator=path", "clamp_indirect=0.2"]),
];

/// What all seeds of a row say.
struct Row {
    /// The mean of the picture over all channels, one value for each seed.
    means: Vec<f64>,
    /// The variance of one sample, averaged over pixels and channels.
    variance: f64,
    /// Seconds of all seeds.
    seconds: f64,
}

fn main() -> Result<()> {
    println!("| estimator | keys in `[render]` | error of the mean | variance | time |");
    println!("|---|---|---|---|---|");
    let mut default: Option<Row> = None;
    for (name, keys) in ROWS {
        let row = measure(keys)?;
        let against = default.as_ref().unwrap_or(&row);
        let error = if default.is_none() { "reference".to_owned() } else { error(&row, against) };
        println!(
            "| {name} | {} | {error} | {:.3} | {:.2} |",
            keys.iter().map(|key| format!("`{key}`")).collect::<Vec<_>>().join(", "),
            row.variance / against.variance,
            row.seconds / against.seconds,
        );
        default = default.or(Some(row));
    }
    Ok(())
}

fn measure(keys: &[&str]) -> Result<Row> {
    let mut pictures = Vec::new();
    let began = Instant::now();
    for seed in 0..SEEDS {
        pictures.push(picture(keys, seed)?);
    }
    let seconds = began.elapsed().as_secs_f64();
    let mean = |picture: &Picture| picture.mean().to_array().iter().sum::<f64>() / 3.0;
    Ok(Row { means: pictures.iter().map(mean).collect(), variance: variance(&pictures), seconds })
}

/// The variance over the seeds of a pixel, times the samples behind it.
fn variance(pictures: &[Picture]) -> f64 {
    let pixels = pictures[0].len();
    let values = |pixel: usize, channel: usize| -> Vec<f64> {
        pictures.iter().map(|picture| f64::from(picture.beauty(pixel)[channel])).collect()
    };
    let of_mean = |i: usize| Estimate::of(&values(i / 3, i % 3)).standard_error.powi(2);
    let mean = (0..3 * pixels).map(of_mean).sum::<f64>() / (3 * pixels) as f64;
    mean * SEEDS as f64 * f64::from(SAMPLES)
}

/// How far the mean is from the default's, in per cent, with its 95 % interval.
fn error(row: &Row, default: &Row) -> String {
    let (ours, theirs) = (Estimate::of(&row.means), Estimate::of(&default.means));
    let error = 100.0 * (ours.mean / theirs.mean - 1.0);
    let spread = (ours.standard_error / theirs.mean)
        .hypot(ours.mean / theirs.mean * theirs.standard_error / theirs.mean);
    let margin = 100.0 * student_t_quantile(0.975, SEEDS as f64 - 1.0) * spread;
    format!("{error:+.2} +- {margin:.2} %")
}

/// Figure 2 with these keys of `[render]`, in 8 x 6 pixels with independent random numbers.
fn picture(keys: &[&str], seed: u64) -> Result<Picture> {
    let set = |pair: &str| {
        let (key, value) = pair.split_once('=').expect("key=value");
        Override { option: format!("--set {pair}"), key: key.into(), value: value.into() }
    };
    let mut overrides = vec![set("image.width=8"), set("image.height=6")];
    overrides.extend(keys.iter().map(|pair| set(&format!("render.{pair}"))));
    overrides.push(set("render.sampler=independent"));
    overrides.push(set(&format!("render.samples_per_pixel={SAMPLES}")));
    overrides.push(set(&format!("render.seed={seed}")));
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/paper/fig2.toml");
    let scene = Scene::load(&path, &overrides)?;
    let accel = Backend::BruteForce.build(scene.spheres(), &BuildOptions::default())?;
    let options = RenderOptions { cancel: Default::default(), progress: &|_| {} };
    Ok(render(&scene, &*accel, &options)?.picture)
}
