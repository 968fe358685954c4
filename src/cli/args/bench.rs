//! The options of `photosphere bench`.

use std::path::PathBuf;

use clap::Args;

use super::accel::{AccelsArg, BuildArg};
use super::memory::MemoryArg;
use super::scene::SceneOptions;
use super::values::count;

/// Measure how fast every intersector answers, builds and renders
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere bench scenes/paper/fig2.toml
  photosphere bench grains.toml --accel native --threads 1 --rounds 9 --json
  photosphere bench grains.toml --batch 1,16,64,512 --scaling --svg bars.svg
  photosphere bench grains.toml --render --set render.samples_per_pixel=16
  photosphere bench --suite speed.html --largest 1e6
  photosphere bench --record record.txt --rounds 9

Rays come from the camera, sixteen to a pixel, from one and from two diffuse bounces, and as shadow
rays from what the camera sees towards any sphere. Intersectors take turns, so that a busy machine hinders all alike;
a figure is the median over the rounds, `+-` the spread of the middle half of them. `ratio` compares
with the first intersector. `other ids` counts rays, of some thousands of each kind, that the first
intersector answers otherwise.

Ctrl-C ends a suite early: the page then holds the scenes that are finished.")]
pub struct BenchArgs {
    /// The scene file
    #[arg(value_name = "SCENE", required_unless_present_any = ["suite", "record"])]
    pub path: Option<PathBuf>,

    #[command(flatten)]
    pub scene: SceneOptions,

    #[command(flatten)]
    pub accels: AccelsArg,

    #[command(flatten)]
    pub memory: MemoryArg,

    #[command(flatten)]
    pub build: BuildArg,

    /// Rounds in which all take turns; each figure is the median over them
    #[arg(long, value_name = "N", default_value_t = 5)]
    #[arg(value_parser = clap::value_parser!(u16).range(1..))]
    pub rounds: u16,

    /// Builds of each intersector, in turns
    #[arg(long, value_name = "N", default_value_t = 1)]
    #[arg(value_parser = clap::value_parser!(u16).range(1..))]
    pub builds: u16,

    /// Rays in one call; an integrator has 256 to 1024. Several, as in 1,16,64,512, are compared on
    /// rays of the second bounce; the first is used for all else
    #[arg(long = "batch", value_name = "N[,N...]", default_value = "512", value_delimiter = ',')]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub batches: Vec<u32>,

    /// Compare 1, 2, 4 and so on up to all threads on rays of the second bounce, beside a loop of
    /// arithmetic that shows what this machine's threads are worth
    #[arg(long)]
    pub scaling: bool,

    /// Render the picture with every intersector as well; with brute force only up to 10000 spheres
    #[arg(long, conflicts_with = "suite")]
    pub render: bool,

    /// Print JSON instead of a table
    #[arg(long)]
    pub json: bool,

    /// Draw the figures as bars
    #[arg(long, value_name = "FILE.svg", conflicts_with = "suite")]
    pub svg: Option<PathBuf>,

    /// Measure the standard scenes in place of one, and write a page about them: gas, packed
    /// spheres, clusters and a lattice of 3, 100, 1000 spheres and so on, as far as memory allows
    #[arg(long, value_name = "FILE.html", conflicts_with_all = ["path", "set", "scaling"])]
    pub suite: Option<PathBuf>,

    /// Measure native against Embree, in place of a scene, and write the tables that
    /// benches/record/ keeps, with the ratios that we ask for: about a quarter of an hour
    #[arg(long, value_name = "FILE.txt")]
    #[arg(conflicts_with_all = [
        "path", "suite", "set", "scaling", "render", "svg", "chosen", "builds", "batches", "quality",
        "limit", "json",
    ])]
    pub record: Option<PathBuf>,

    /// The most spheres of the suite or of the record, as in 1e6 [default: 1e8, or 1e7 for the
    /// record]
    #[arg(long, value_name = "N", value_parser = count, conflicts_with = "path")]
    pub largest: Option<u64>,
}
