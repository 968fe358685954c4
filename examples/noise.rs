//! The noise of figures 5 to 7 in numbers: error against samples, for the paper's estimator and for
//! `path`, with the slope of the line through them in log-log.
//!
//! Each error is the root mean square over the pixels of one small picture against a long render;
//! means and standard errors are over 32 seeds. Prints the table of `docs/paper.md`:
//!
//!     cargo run --release --example noise

#![allow(clippy::print_stdout, reason = "a program that prints a table")]

use std::path::Path;
use std::time::Instant;

use photosphere::Result;
use photosphere::accel::{Backend, BuildOptions};
use photosphere::film::Picture;
use photosphere::render::{RenderOptions, render};
use photosphere::scene::{Override, Scene};

const SEEDS: u64 = 32;
const SAMPLES_PER_SUBPIXEL: [u32; 3] = [1, 10, 100];
const REFERENCE_SAMPLES: u32 = 16384;

fn main() -> Result<()> {
    let (reference, _) = picture("path", REFERENCE_SAMPLES, 1000)?;
    println!("| estimator | samples per pixel | RMSE | seconds | MSE x seconds |");
    println!("|---|---|---|---|---|");
    for integrator in ["paper", "path"] {
        let mut errors = Vec::new();
        for samples in SAMPLES_PER_SUBPIXEL.map(|n| 4 * n) {
            let runs: Vec<(f64, f64)> = (0..SEEDS)
                .map(|seed| {
                    let (picture, seconds) = picture(integrator, samples, seed)?;
                    Ok((mean_square_error(&picture, &reference), seconds))
                })
                .collect::<Result<_>>()?;
            let (error, uncertain) = mean(runs.iter().map(|run| run.0.sqrt()));
            let (seconds, _) = mean(runs.iter().map(|run| run.1));
            let (product, spread) = mean(runs.iter().map(|run| run.0 * run.1));
            println!(
                "| {integrator} | {samples} | {error:.4} +- {uncertain:.4} | {seconds:.4} | \
                 {product:.2e} +- {spread:.0e} |"
            );
            errors.push(runs.iter().map(|run| run.0.sqrt().log10()).collect::<Vec<_>>());
        }
        let (slope, uncertain) = mean((0..SEEDS as usize).map(|seed| slope(&errors, seed)));
        println!("\n`{integrator}`: slope {slope:.3} +- {uncertain:.3}\n");
    }
    Ok(())
}

/// Figure 2 at 80 x 60 pixels, and the seconds it took.
fn picture(integrator: &str, samples: u32, seed: u64) -> Result<(Picture, f64)> {
    let set = |key: &str, value: String| Override {
        option: format!("--set {key}={value}"),
        key: key.into(),
        value,
    };
    let overrides = [
        set("image.width", "80".into()),
        set("image.height", "60".into()),
        set("render.integrator", integrator.into()),
        set("render.samples_per_pixel", samples.to_string()),
        set("render.seed", seed.to_string()),
    ];
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/paper/fig2.toml");
    let scene = Scene::load(&path, &overrides)?;
    let accel = Backend::BruteForce.build(scene.spheres(), &BuildOptions::default())?;
    let began = Instant::now();
    let options = RenderOptions { cancel: Default::default(), progress: &|_| {} };
    let picture = render(&scene, &*accel, &options)?.picture;
    Ok((picture, began.elapsed().as_secs_f64()))
}

fn mean_square_error(picture: &Picture, reference: &Picture) -> f64 {
    let square = |i| (picture.beauty(i) - reference.beauty(i)).as_dvec3().length_squared() / 3.0;
    (0..picture.len()).map(square).sum::<f64>() / picture.len() as f64
}

/// The mean of independent values, and its standard error.
fn mean(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let n = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / n;
    let variance = values.map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// The least-squares slope of log error over log samples, whose three places are one decade apart.
fn slope(errors: &[Vec<f64>], seed: usize) -> f64 {
    (errors[2][seed] - errors[0][seed]) / 2.0
}
