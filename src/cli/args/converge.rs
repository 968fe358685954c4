//! The options of `photosphere converge`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::TypedValueParser;

use crate::accel::Backend;
use crate::verify::converge::ErrorMetric;

use super::accel::backends;
use super::comparison::{Comparison, comparison};
use super::scene::SceneArgs;
use super::values::{Size, one_of, seed, size};

/// How many numbers of samples are compared where none are asked for.
const USUAL_POINTS: u32 = 7;

/// Plot error against samples and against time
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere converge scenes/paper/fig2.toml --size 80x60 -o noise.svg
  photosphere converge fig2.toml --integrator paper,path -o noise.svg
  photosphere converge fig2.toml --estimator mis,light,bsdf -o estimators.svg
  photosphere converge fig2.toml --sampler sobol,independent -o samplers.svg
  photosphere converge fig4.toml --caustics chance,connect -o caustics.svg
  photosphere converge fig2.toml --compare render.max_depth=2,3,8 -o depth.svg
  photosphere converge fig2.toml --reference best.exr -o noise.svg --json
  photosphere converge fig2.toml --accel native,embree -o speed.svg

Every combination of --integrator, --estimator, --caustics, --sampler, --compare and --accel is one
curve; the scene decides what is not given. Each point is the mean over --seeds renders with its 95 % interval (Student's t).
So is each slope, which is fitted to every seed by least squares in log-log. Independent samples have
the slope -0.5 (RMSE) or -1 (relMSE, the mean of ((A - B) / (|B| + 0.01))^2). `cost` is squared error
(MSE or relMSE) times seconds, which does not depend on the number of samples if they are independent.

The reference is rendered in two halves with other seeds. Half their difference estimates its own
error, which is printed and subtracted from every point. The error of a --reference FILE is known only
if the file has a layer `variance`; otherwise it stays in every point, and curves flatten when they
reach it.

Seconds depend on what else the machine does: close other programs, or compare only ratios. The
integrator `paper` needs sample counts that are multiples of its k x k sub-pixels: --spp 4,40,400.")]
pub struct ConvergeArgs {
    #[command(flatten)]
    pub scene: SceneArgs,

    /// The plot, an .svg file
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,

    /// Samples per pixel, one point each [default: 1,2,4,8,16,32,64, times the number of sub-pixels
    /// if `paper` is compared]
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    #[arg(value_parser = clap::value_parser!(u32).range(1..))]
    spp: Vec<u32>,

    /// Integrators to compare
    #[arg(long = "integrator", value_name = "LIST", value_delimiter = ',')]
    pub integrators: Vec<String>,

    /// Estimators to compare
    #[arg(long = "estimator", value_name = "LIST", value_delimiter = ',')]
    pub estimators: Vec<String>,

    /// Ways to find light over polished balls to compare
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub caustics: Vec<String>,

    /// Samplers to compare
    #[arg(long = "sampler", value_name = "LIST", value_delimiter = ',')]
    pub samplers: Vec<String>,

    /// Intersectors to compare
    #[arg(long = "accel", value_name = "LIST", value_delimiter = ',', value_parser = backends())]
    pub accels: Vec<Backend>,

    /// Values of a key of [render] to compare, such as render.max_depth=2,3,8; may be repeated. The
    /// reference has the scene's own value
    #[arg(long, value_name = "KEY=LIST", value_parser = comparison)]
    pub compare: Vec<Comparison>,

    /// The error metric
    #[arg(long, value_name = "NAME", value_parser = metrics(), default_value = "rmse")]
    pub metric: ErrorMetric,

    /// Independent renders per point
    #[arg(long, value_name = "K", default_value_t = 8)]
    #[arg(value_parser = clap::value_parser!(u32).range(2..=100_000))]
    pub seeds: u32,

    /// The first seed; the renders use this one and those that follow
    #[arg(long, value_name = "S", default_value_t = 0)]
    #[arg(value_parser = seed())]
    pub seed: u64,

    /// Compare with this picture instead of rendering a reference
    #[arg(long, value_name = "FILE", conflicts_with_all = ["reference_spp", "reference_integrator"])]
    pub reference: Option<PathBuf>,

    /// Samples per pixel of the reference, both halves together [default: 16 times the largest
    /// --spp]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..))]
    reference_spp: Option<u32>,

    /// The integrator of the reference [default: `path` if `path` or `paper` is compared, otherwise
    /// the integrator that is compared]. Only these two converge to the same picture; to compare
    /// others with each other, set this or --reference
    #[arg(long, value_name = "NAME")]
    pub reference_integrator: Option<String>,

    /// The size of the pictures, such as 80x60; small ones suffice to measure noise
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<Size>,

    /// Print only warnings and errors
    #[arg(short, long)]
    pub quiet: bool,

    /// Print JSON instead of a table
    #[arg(long)]
    pub json: bool,
}

impl ConvergeArgs {
    /// Returns the samples per pixel of the points, ascending and without duplicates. By default
    /// they are multiples of `step`.
    pub fn samples(&self, step: u32) -> Vec<u32> {
        if self.spp.is_empty() {
            return (0..USUAL_POINTS).map(|point| step << point).collect();
        }
        let mut samples = self.spp.clone();
        samples.sort_unstable();
        samples.dedup();
        samples
    }

    /// Returns the samples per pixel of each half of the reference. `most` is the largest number of
    /// samples per pixel compared with it.
    pub fn reference_half(&self, most: u32) -> u32 {
        self.reference_spp.unwrap_or(most.saturating_mul(16)) / 2
    }
}

fn metrics() -> impl TypedValueParser<Value = ErrorMetric> {
    one_of([("rmse".into(), ErrorMetric::Rmse), ("relmse".into(), ErrorMetric::Relmse)])
}
