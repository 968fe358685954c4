//! The options of `photosphere bench`.

use std::path::PathBuf;

use clap::Args;

use super::accel::{AccelsArg, BuildArg};
use super::memory::MemoryArg;
use super::scene::SceneOptions;
use super::values::count;

/// Measure ray rates, build times, memory and whole renders for every intersector
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere bench scenes/paper/fig2.toml
  photosphere bench grains.toml --accel native --threads 1 --rounds 9 --json
  photosphere bench grains.toml --batch 1,16,64,512 --scaling --svg bars.svg
  photosphere bench grains.toml --render --stages --threads 1
  photosphere bench --suite speed.html --largest 1e6
  photosphere bench --record record.txt --rounds 9

The rays are camera rays (sixteen per pixel), first and second diffuse bounces, and shadow rays from
visible surfaces to random spheres. Intersectors take turns, so that other load slows all of them
alike. Each figure is the median over the rounds, followed by half the interquartile range (`+-`).
`ratio` compares with the first intersector. `other ids` counts the rays, out of some thousands of
each kind, for which an intersector disagrees with the first one.

Ctrl-C ends a suite early; the page then holds the finished scenes.")]
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

    /// Rounds; each figure is their median
    #[arg(long, value_name = "N", default_value_t = 5)]
    #[arg(value_parser = clap::value_parser!(u16).range(1..))]
    pub rounds: u16,

    /// Builds of each intersector
    #[arg(long, value_name = "N", default_value_t = 1)]
    #[arg(value_parser = clap::value_parser!(u16).range(1..))]
    pub builds: u16,

    /// Rays per call; integrators use 256 to 1024. A list, such as 1,16,64,512, is compared on rays
    /// of the second bounce; its first number is used for everything else
    #[arg(long = "batch", value_name = "N[,N...]", default_value = "512", value_delimiter = ',')]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub batches: Vec<u32>,

    /// Measure rays of the second bounce with 1, 2, 4, ... threads, beside a loop of arithmetic
    /// that shows how well the threads of this machine scale
    #[arg(long)]
    pub scaling: bool,

    /// Also render the picture with every intersector (brute force: up to 10000 spheres only)
    #[arg(long, conflicts_with = "suite")]
    pub render: bool,

    /// Also measure each stage of the render, in nanoseconds per vertex of a path, on one thread
    #[arg(long, requires = "render")]
    pub stages: bool,

    /// Print JSON instead of a table
    #[arg(long)]
    pub json: bool,

    /// Draw the figures as a bar chart
    #[arg(long, value_name = "FILE.svg", conflicts_with = "suite")]
    pub svg: Option<PathBuf>,

    /// Measure standard scenes instead of SCENE and write an HTML page: gas, packed, clusters and
    /// lattice, with 3, 100, 1000, ... spheres, as far as memory allows
    #[arg(long, value_name = "FILE.html", conflicts_with_all = ["path", "set", "scaling"])]
    pub suite: Option<PathBuf>,

    /// Measure native against Embree instead of SCENE and write the tables that benches/record/
    /// keeps, with our targets: about a quarter of an hour
    #[arg(long, value_name = "FILE.txt")]
    #[arg(conflicts_with_all = [
        "path", "suite", "set", "scaling", "render", "stages", "svg", "chosen", "builds", "batches", "build",
        "limit", "json",
    ])]
    pub record: Option<PathBuf>,

    /// The largest number of spheres in the suite or the record, such as 1e6 [default: 1e8 for the
    /// suite, 1e7 for the record]
    #[arg(long, value_name = "N", value_parser = count, conflicts_with = "path")]
    pub largest: Option<u64>,
}
