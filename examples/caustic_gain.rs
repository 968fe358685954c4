//! How much less noise connections leave than chance: in whole pictures, and in the pixels that see
//! a diffuse surface first.
//!
//!     cargo run --release --example caustic_gain -- [--samples N] [SCENE ...]
//!
//! Prints ratios of the variance over 8 seeds of pictures of 160 x 120 pixels, the ratio of the
//! time of one thread, and the gain at equal time.

use std::time::Instant;

use photosphere::accel::{Accel, Backend, BuildOptions};
use photosphere::error::Result;
use photosphere::film::Aov;
use photosphere::integrator::{PathEvent, RenderContext, SampleAddress, create};
use photosphere::job::render_with_accel;
use photosphere::material::Lobe;
use photosphere::scene::settings::Caustics;
use photosphere::scene::{Override, PreparedScene, Scene, read_file};
use photosphere::task::CancelToken;

const SEEDS: u64 = 8;
const SIZE: (u32, u32) = (160, 120);
const SCENES: [&str; 4] = [
    "scenes/caustics/mirror-ball.toml",
    "scenes/caustics/glass-ball.toml",
    "scenes/caustics/two-balls.toml",
    "scenes/paper/fig4.toml",
];

/// What 8 pictures of a scene took and show.
struct Noise {
    seconds: f64,
    /// Mean variance of a pixel's green: of all pixels, and of those that see a diffuse surface.
    variances: [f64; 2],
}

fn measure(prepared: &mut PreparedScene) -> Result<Noise> {
    let cancel = CancelToken::default();
    let build = BuildOptions { threads: 1, ..BuildOptions::default() };
    let accel = Backend::Native.build(prepared.scene().spheres(), &build)?;
    let diffuse = diffuse_pixels(prepared, &*accel, &cancel);
    let began = Instant::now();
    let mut pictures = Vec::new();
    for seed in 0..SEEDS {
        prepared.set_seed(seed);
        pictures.push(render_with_accel(prepared, &*accel, &Aov::DEFAULT, &cancel)?.picture);
    }
    let seconds = began.elapsed().as_secs_f64();
    let variance = |pixel: usize| {
        let values: Vec<f64> = pictures.iter().map(|p| f64::from(p.beauty(pixel).y)).collect();
        let mean = values.iter().sum::<f64>() / SEEDS as f64;
        values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (SEEDS - 1) as f64
    };
    let mean = |pixels: &mut dyn Iterator<Item = usize>| {
        let (sum, count) = pixels.fold((0.0, 0), |(sum, n), pixel| (sum + variance(pixel), n + 1));
        sum / f64::from(count.max(1))
    };
    let all = mean(&mut (0..diffuse.len()));
    let some = mean(&mut (0..diffuse.len()).filter(|&pixel| diffuse[pixel]));
    Ok(Noise { seconds, variances: [all, some] })
}

/// Finds the pixels whose first sample is scattered by a diffuse surface at once.
fn diffuse_pixels(prepared: &PreparedScene, accel: &dyn Accel, cancel: &CancelToken) -> Vec<bool> {
    let context = RenderContext::new(prepared, accel, cancel);
    let integrator = create(prepared);
    let is_diffuse = |pixel: u32| {
        let address = SampleAddress { x: pixel % SIZE.0, y: pixel / SIZE.0, sample: 0 };
        let trace = integrator.trace_path(context, address);
        let lobe = trace.iter().flat_map(|trace| &trace.events).find_map(|event| match event {
            PathEvent::BsdfSample { lobe, .. } => Some(*lobe),
            _ => None,
        });
        lobe == Some(Lobe::Diffuse)
    };
    (0..SIZE.0 * SIZE.1).map(is_diffuse).collect()
}

#[allow(clippy::print_stdout, reason = "its purpose")]
fn report(file: &str, samples: &str) -> Result<()> {
    let (width, height) = (SIZE.0.to_string(), SIZE.1.to_string());
    let overrides = [
        ("image.width", &*width),
        ("image.height", &height),
        ("render.samples_per_pixel", samples),
        ("render.integrator", "path"),
    ];
    let overrides = overrides.map(|(key, value)| Override::new(key, value));
    let described = read_file(file.as_ref(), &overrides)?;
    let mut settings = described.settings;
    let scene = Scene::build(described.description)?;
    let mut of = |caustics| {
        settings.render.caustics = caustics;
        measure(&mut PreparedScene::new(&scene, settings)?)
    };
    let [chance, connect] = [of(Caustics::Chance)?, of(Caustics::Connect)?];
    let [whole, diffuse] = [0, 1].map(|i| chance.variances[i] / connect.variances[i]);
    let time = connect.seconds / chance.seconds;
    println!("{file:<34}{whole:>15.1}{diffuse:>16.1}{time:>8.2}{:>24.1}", diffuse / time);
    Ok(())
}

#[allow(clippy::print_stdout, reason = "its purpose")]
fn main() -> Result<()> {
    let mut words: Vec<String> = std::env::args().skip(1).collect();
    let mut samples = "128".to_owned();
    if words.first().is_some_and(|word| word == "--samples") && words.len() > 1 {
        samples = words.drain(..2).next_back().unwrap_or(samples);
    }
    if words.is_empty() {
        words = SCENES.map(str::to_owned).to_vec();
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    println!(
        "{:<34}{:>15}{:>16}{:>8}{:>24}",
        "scene", "whole picture", "diffuse pixels", "time", "diffuse, at equal time"
    );
    let run = || words.iter().try_for_each(|file| report(file, &samples));
    pool.map_or_else(|_| run(), |pool| pool.install(run))
}
