//! What each of the paper's shortcuts costs: its bias, its variance, its rays and its time against
//! the default; and its bias against the paper's estimator without any, whose noise it shares.
//!
//! Figure 2, 8 x 6 pixels, 32 independent seeds of 25600 samples per pixel or as many as are named,
//! an eighth of that for the row that is drawn again on a miss. 6400 samples take some minutes of
//! two idle cores. Prints the table of `docs/paper.md`:
//!
//!     cargo run --release --example bias -- 6400

#![allow(clippy::print_stdout, reason = "a program that prints a table")]

use std::cmp::Ordering;
use std::path::Path;
use std::time::Instant;

use photosphere::Result;
use photosphere::accel::{Backend, BuildOptions};
use photosphere::image_io::Picture;
use photosphere::job::{RenderedImage, render_with_accel};
use photosphere::scene::{Override, PreparedScene, read_file};
use photosphere::verify::statistics::MeanEstimate;

const SEEDS: u64 = 32;
/// Samples of a pixel and seed, if the command line names none.
const SAMPLES: u32 = 25600;

/// How many times fewer samples the row gets whose every sample is a thousand in an empty pixel.
const FEWER: u32 = 8;
const REDRAWS: &str = "paper.miss=redraw";

/// The row of lights found by chance, each path followed until it leaves the scene: what the rows
/// of the paper are held against, too.
const CHANCE: usize = 3;

/// Each shortcut and the keys that ask for it. The first row is what all others are held against.
const ROWS: [(&str, &[&str]); 14] = [
    ("default: `path`", &["integrator=path"]),
    ("depth stop, direct light only", &["integrator=path", "max_depth=2"]),
    ("depth stop after one bounce", &["integrator=path", "max_depth=3"]),
    ("chance lights, no shortcut", &["integrator=paper", "paper.stop=depth", "max_depth=100"]),
    ("... and roulette", &["integrator=paper"]),
    ("... and uniform directions", &["integrator=paper", "paper.hemisphere=uniform-solid-angle"]),
    ("... and uniform angles", &["integrator=paper", "paper.hemisphere=uniform-angle"]),
    ("... and depth stop", &["integrator=paper", "paper.stop=depth", "max_depth=4"]),
    (
        "... and threshold stop at 0.01",
        &["integrator=paper", "paper.stop=threshold", "paper.threshold=0.01"],
    ),
    (
        "... and threshold stop at 0.1",
        &["integrator=paper", "paper.stop=threshold", "paper.threshold=0.1"],
    ),
    (
        "... and threshold stop at 0.3",
        &["integrator=paper", "paper.stop=threshold", "paper.threshold=0.3"],
    ),
    ("... and redraw on a miss", &["integrator=paper", REDRAWS]),
    ("... and fixed places in the sub-pixels", &["integrator=paper", "paper.jitter=0"]),
    ("clamped indirect light", &["integrator=path", "clamp_indirect=0.02"]),
];

/// What the seeds of a row say, one value for each where it is a list.
struct Row {
    name: &'static str,
    keys: &'static [&'static str],
    /// Samples of a pixel and seed.
    samples: u32,
    pictures: Vec<Picture>,
    rays: u64,
    seconds: Vec<f64>,
}

fn main() -> Result<()> {
    let named = std::env::args().nth(1).map(|text| text.parse().expect("a number of samples"));
    let samples: u32 = named.unwrap_or(SAMPLES).max(FEWER);
    let empty = |&(name, keys): &(&'static str, &'static [&'static str])| Row {
        name,
        keys,
        samples: if keys.contains(&REDRAWS) { samples / FEWER } else { samples },
        pictures: Vec::new(),
        rays: 0,
        seconds: Vec::new(),
    };
    let mut rows: Vec<Row> = ROWS.iter().map(empty).collect();
    // Row by row within a seed, so that what else the machine does slows all of them alike.
    for seed in 0..SEEDS {
        for row in &mut rows {
            let began = Instant::now();
            let RenderedImage { picture, rays, .. } = outcome(row.keys, row.samples, seed)?;
            row.seconds.push(began.elapsed().as_secs_f64());
            row.pictures.push(picture);
            row.rays += rays;
        }
    }
    println!(
        "| estimator | keys in `[render]` | error against `path` | against chance lights | variance | \
         rays | time |"
    );
    println!("|---|---|---|---|---|---|---|");
    let (default, chance) = (&rows[0], &rows[CHANCE]);
    for (index, row) in rows.iter().enumerate() {
        println!(
            "| {} | {} | {} | {} | {:.3} | {:.2} | {:.2} |",
            row.name,
            row.keys.iter().map(|key| format!("`{key}`")).collect::<Vec<_>>().join(", "),
            if index == 0 { "reference".to_owned() } else { row.error(default) },
            match index.cmp(&CHANCE) {
                Ordering::Equal => "reference".to_owned(),
                Ordering::Greater if row.keys[0] == chance.keys[0] => row.error(chance),
                _ => String::new(),
            },
            row.variance() / default.variance(),
            row.per_sample(row.rays as f64) / default.per_sample(default.rays as f64),
            row.time(default),
        );
    }
    Ok(())
}

impl Row {
    /// The mean of each picture over all pixels and channels.
    fn means(&self) -> impl Iterator<Item = f64> + '_ {
        self.pictures.iter().map(|picture| picture.mean().to_array().iter().sum::<f64>() / 3.0)
    }

    /// How far the mean is from another's, in per cent, with its 95 % interval. A seed gives both
    /// the same random numbers, so their differences are judged.
    fn error(&self, other: &Self) -> String {
        let differences: Vec<f64> =
            self.means().zip(other.means()).map(|(ours, theirs)| ours - theirs).collect();
        let difference = MeanEstimate::from_values(&differences);
        let percent = 100.0 / MeanEstimate::from_values(&other.means().collect::<Vec<_>>()).mean;
        let margin = percent * difference.confidence_half_width(0.95);
        // Two digits of the interval, and as many of the error.
        let digits = (1.0 - libm::log10(margin).floor()).clamp(2.0, 9.0) as usize;
        format!("{:+.digits$} +- {margin:.digits$} %", percent * difference.mean)
    }

    fn per_sample(&self, figure: f64) -> f64 {
        figure / f64::from(self.samples)
    }

    /// The variance of one sample, averaged over pixels and channels.
    fn variance(&self) -> f64 {
        let values = |i: usize| -> Vec<f64> {
            self.pictures.iter().map(|p| f64::from(p.beauty(i / 3)[i % 3])).collect()
        };
        let count = 3 * self.pictures[0].len();
        let of_mean = |i: usize| MeanEstimate::from_values(&values(i)).standard_error.powi(2);
        let mean = (0..count).map(of_mean).sum::<f64>() / count as f64;
        mean * SEEDS as f64 * f64::from(self.samples)
    }

    /// The median over the seeds of the time over the default's, for equal samples.
    fn time(&self, default: &Self) -> f64 {
        let ratio = |(&a, &b)| self.per_sample(a) / default.per_sample(b);
        let mut ratios: Vec<f64> = self.seconds.iter().zip(&default.seconds).map(ratio).collect();
        ratios.sort_by(f64::total_cmp);
        ratios[ratios.len() / 2]
    }
}

/// Figure 2 with these keys of `[render]`, in 8 x 6 pixels with independent random numbers.
fn outcome(keys: &[&str], samples: u32, seed: u64) -> Result<RenderedImage> {
    let set = |pair: &str| {
        let (key, value) = pair.split_once('=').expect("key=value");
        Override::new(key, value)
    };
    let mut overrides = vec![set("image.width=8"), set("image.height=6")];
    overrides.extend(keys.iter().map(|pair| set(&format!("render.{pair}"))));
    overrides.push(set("render.sampler=independent"));
    overrides.push(set(&format!("render.samples_per_pixel={samples}")));
    overrides.push(set(&format!("render.seed={seed}")));
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/paper/fig2.toml");
    let (scene, settings) = read_file(&path, &overrides)?.build()?;
    let accel = Backend::BruteForce.build(scene.spheres(), &BuildOptions::default())?;
    render_with_accel(&PreparedScene::new(&scene, settings)?, &*accel, &[], &Default::default())
}
