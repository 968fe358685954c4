//! What evenly spread numbers are worth: the mean square error of each sampler beside that of
//! independent numbers, at equal samples.
//!
//! The error is the variance of a pixel over 16 seeds, mean over the pixels of a small picture:
//! every sampler is unbiased, so there is nothing else to it. Prints a table of `docs/sampling.md`:
//!
//!     cargo run --release --example sampling -- scenes/paper/fig2.toml 4 16 64 256

#![allow(clippy::print_stdout, reason = "a program that prints a table")]

use std::path::Path;

use photosphere::Result;
use photosphere::accel::{Backend, BuildOptions};
use photosphere::image_io::Picture;
use photosphere::job::render_with_accel;
use photosphere::scene::{Override, PreparedScene, read_file};

const SEEDS: usize = 16;

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let scene = arguments.next().unwrap_or("scenes/paper/fig2.toml".into());
    let mut counts: Vec<u32> = arguments.filter_map(|count| count.parse().ok()).collect();
    if counts.is_empty() {
        counts = vec![4, 16, 64];
    }
    println!("| samples per pixel | independent | stratified | sobol | gain of sobol |");
    println!("|---|---|---|---|---|");
    for samples in counts {
        let error = |sampler| mean_square_error(&scene, sampler, samples);
        let independent = error("independent")?;
        let stratified = error("stratified")?;
        let sobol = error("sobol")?;
        println!(
            "| {samples} | {independent:.3e} | {stratified:.3e} | {sobol:.3e} | {:.2} |",
            independent / sobol
        );
    }
    Ok(())
}

/// The variance of a pixel over the seeds, mean over pixels and channels.
fn mean_square_error(scene: &str, sampler: &str, samples: u32) -> Result<f64> {
    let pictures: Vec<Picture> =
        (0..SEEDS).map(|seed| picture(scene, sampler, samples, seed)).collect::<Result<_>>()?;
    let n = SEEDS as f64;
    let pixel = |i| {
        let values = pictures.iter().map(|picture| picture.beauty(i).as_dvec3());
        let mean = values.clone().sum::<photosphere::math::DVec3>() / n;
        values.map(|value| (value - mean).length_squared() / 3.0).sum::<f64>() / (n - 1.0)
    };
    let count = pictures[0].len();
    Ok((0..count).map(pixel).sum::<f64>() / count as f64)
}

fn picture(scene: &str, sampler: &str, samples: u32, seed: usize) -> Result<Picture> {
    let set = |key: &str, value: String| Override::new(key, value);
    let overrides = [
        set("image.width", "64".into()),
        set("image.height", "48".into()),
        set("render.sampler", sampler.into()),
        set("render.samples_per_pixel", samples.to_string()),
        set("render.seed", seed.to_string()),
    ];
    let (scene, settings) = read_file(Path::new(scene), &overrides)?.build()?;
    let accel = Backend::BruteForce.build(scene.spheres(), &BuildOptions::default())?;
    let prepared = PreparedScene::new(&scene, settings)?;
    Ok(render_with_accel(&prepared, &*accel, &[], &Default::default())?.picture)
}
