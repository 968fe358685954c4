//! How far the stated standard error of a picture is from the true one: figure 2, 32 x 32 pixels,
//! with Sobol's samples, whose blocks of 16 are well distributed. Prints a table of
//! `docs/stopping.md`:
//!
//!     cargo run --release --example stated_error

#![allow(clippy::print_stdout, reason = "a program that prints a table")]

use std::path::Path;

use photosphere::Result;
use photosphere::accel::{Backend, BuildOptions};
use photosphere::film::Aov;
use photosphere::image_io::{ChannelValues, Picture};
use photosphere::job::render_with_accel;
use photosphere::scene::{Override, PreparedScene, read_file};

const SEEDS: u64 = 64;

fn main() -> Result<()> {
    println!("| samples per pixel | from samples | from blocks |");
    println!("|---|---|---|");
    for samples in [64, 256, 1024] {
        let pictures = |sampler| -> Result<Vec<Picture>> {
            (0..SEEDS).map(|seed| picture(sampler, samples, seed)).collect()
        };
        let (sobol, independent) = (pictures("sobol")?, pictures("independent")?);
        let truth = true_variance(&sobol);
        // What a sum of squares over single samples says is what independent samples have.
        let [of_samples, of_blocks] = [&independent, &sobol].map(|all| stated_variance(all));
        let ratio = |stated: f64| (stated / truth).sqrt();
        println!("| {samples} | {:.2} | {:.2} |", ratio(of_samples), ratio(of_blocks));
    }
    Ok(())
}

/// The variance of the values over the seeds, summed over all values.
fn true_variance(pictures: &[Picture]) -> f64 {
    let values: Vec<Vec<f64>> = pictures.iter().map(values).collect();
    let n = values.len() as f64;
    let of_value = |index: usize| {
        let mean = values.iter().map(|all| all[index]).sum::<f64>() / n;
        values.iter().map(|all| (all[index] - mean).powi(2)).sum::<f64>() / (n - 1.0)
    };
    (0..values[0].len()).map(of_value).sum()
}

fn values(picture: &Picture) -> Vec<f64> {
    let beauty = (0..picture.len()).map(|pixel| picture.beauty(pixel).to_array());
    beauty.flatten().map(f64::from).collect()
}

/// The mean over the seeds of what the layer `variance` says, summed over all values.
fn stated_variance(pictures: &[Picture]) -> f64 {
    let sum = |picture: &Picture| -> f64 {
        let channels = picture.channels.iter().map(|channel| &channel.values);
        channels
            .map(|values| match values {
                ChannelValues::Float(values) => values.iter().map(|v| f64::from(*v)).sum(),
                ChannelValues::Uint(_) => 0.0,
            })
            .sum()
    };
    pictures.iter().map(sum).sum::<f64>() / pictures.len() as f64
}

/// Figure 2 in 32 x 32 pixels, with the layer `variance`.
fn picture(sampler: &str, samples: u32, seed: u64) -> Result<Picture> {
    let overrides = [
        ("image.width", "32".to_owned()),
        ("image.height", "32".to_owned()),
        ("render.sampler", sampler.to_owned()),
        ("render.samples_per_pixel", samples.to_string()),
        ("render.seed", seed.to_string()),
    ];
    let overrides = overrides.map(|(key, value)| Override::new(key, value));
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/paper/fig2.toml");
    let (scene, settings) = read_file(&path, &overrides)?.build()?;
    let accel = Backend::BruteForce.build(scene.spheres(), &BuildOptions::default())?;
    let prepared = PreparedScene::new(&scene, settings)?;
    Ok(render_with_accel(&prepared, &*accel, &[Aov::Variance], &Default::default())?.picture)
}
