//! The command line, as clap reads it; the comments here are what `--help` says.
//!
//! What clap can judge alone (an unknown option, a word where a number belongs) is its to refuse.
//! Values that mean something to a scene become [`Override`]s and are judged where the scene is, so
//! that `--spp 0` is refused in the same words as `samples_per_pixel = 0`.

mod accel;
mod bench;
mod compare;
mod converge;
mod generate;
mod help;
mod keep;
mod memory;
mod output;
mod picture;
mod plan;
mod reproduce;
mod stop;
mod trace;
mod verify;

use std::path::PathBuf;

use clap::builder::TypedValueParser;
use clap::{Args, Parser, Subcommand};

use crate::scene::Override;

use super::exit::EXIT_CODES;

use accel::backends;
pub(super) use accel::{AccelArg, AccelsArg, BuildArg};
pub(super) use bench::BenchArgs;
pub(super) use compare::{CompareArgs, Mapped, Metric};
pub(super) use converge::ConvergeArgs;
pub(super) use generate::GenerateArgs;
pub(super) use help::program;
pub(super) use keep::{KeepArgs, MergeArgs, ResumeArgs};
pub(super) use memory::MemoryArg;
pub(super) use output::OutputArgs;
pub(super) use picture::PictureArgs;
pub(super) use plan::{Division, Format, PlanArgs};
pub(super) use reproduce::ReproduceArgs;
pub(super) use stop::{StopArgs, WatchArgs};
pub(super) use trace::TraceArgs;
pub(super) use verify::VerifyArgs;

const EXAMPLES: &str = "\
Examples:
  photosphere render scenes/paper/fig2.toml -o fig2.png
  photosphere render scenes/paper/fig2.toml -o fig2.exr --spp 1024
  photosphere info scenes/cornell-spheres.toml
  photosphere plan scenes/paper/fig2.toml --shards 4 --spp 4096 -o fig2.exr
  photosphere generate gas -n 1e6 -o gas.f32 --scene gas.toml
  photosphere doctor";

/// Renders scenes made of spheres by Monte Carlo path tracing.
///
/// A scene is a TOML file (docs/scene-format.md), beside it perhaps tables of many spheres. Each
/// command explains itself: photosphere render --help.
#[derive(Debug, Parser)]
#[command(name = "photosphere", version, max_term_width = 100)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{EXIT_CODES}"))]
pub(super) struct Cli {
    #[command(subcommand)]
    pub(super) command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    Render(Box<RenderArgs>),
    Resume(ResumeArgs),
    Merge(MergeArgs),
    Plan(Box<PlanArgs>),
    Crosscheck(CrosscheckArgs),
    Bench(BenchArgs),
    Compare(CompareArgs),
    Converge(ConvergeArgs),
    Reproduce(ReproduceArgs),
    Trace(TraceArgs),
    Verify(VerifyArgs),
    Generate(GenerateArgs),
    Info(InfoArgs),
    /// Say what this build and this machine can do, and what is missing
    #[command(after_help = "\
Examples:
  photosphere doctor

Prints the version of Embree at compile time and at run time and the instruction set it uses, or
why there is none and which packages to install; then traces one ray with every intersector.")]
    Doctor,
    /// Print the JSON schema of scene files, which editors complete and check them by
    #[command(after_help = "\
Examples:
  photosphere schema > photosphere.schema.json

An editor with taplo, such as VS Code with Even Better TOML, takes it from the first line of a scene:
#:schema ./photosphere.schema.json")]
    Schema,
    /// Print the completion script for a shell
    #[command(after_help = "\
Examples:
  photosphere completions bash > photosphere-completion.bash
  photosphere completions fish > ~/.config/fish/completions/photosphere.fish")]
    Completions {
        shell: clap_complete::Shell,
    },
    /// Print the manual page of the program or of one command
    #[command(after_help = "\
Examples:
  photosphere man | man -l -
  photosphere man render > photosphere-render.1")]
    Man {
        /// The command; left out, the page is that of the whole program
        command: Option<String>,
    },
}

/// Which scene, and how much of the machine.
#[derive(Args, Debug)]
pub(super) struct SceneArgs {
    /// The scene file
    #[arg(value_name = "SCENE")]
    pub(super) path: PathBuf,

    #[command(flatten)]
    options: SceneOptions,
}

/// What is changed in the scene, and how much of the machine is used.
#[derive(Args, Debug)]
pub(super) struct SceneOptions {
    /// Set any key of the scene, as in --set materials.grass.albedo=[0.1,0.5,0.1]; may be repeated
    #[arg(long, value_name = "KEY=VALUE", value_parser = setting)]
    set: Vec<Setting>,

    /// Threads to use; all cores by default. The picture does not depend on it
    #[arg(long, value_name = "T", value_parser = threads(), allow_negative_numbers = true)]
    threads: Option<usize>,
}

/// Render a scene to a picture
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere render fig2.toml -o fig2.png
  photosphere render fig2.toml -o quick.png --size 320x240 --spp 4
  photosphere render fig2.toml -o fig2.exr --estimator light --spp 1024 --seed 7
  photosphere render fig2.toml -o red.png --set materials.grass.albedo=[0.6,0,0]
  photosphere render fig2.toml -o fig2.exr -o fig2.png --tone agx --exposure 1
  photosphere render fig2.toml -o fig2.exr --layers direct,albedo,normal,depth
  photosphere render fig2.toml -o fig2.pfm --quiet --json | jq .samples_per_s
  photosphere render fig2.toml -o fig2.exr --spp 65536 --checkpoint fig2.state
  photosphere render fig2.toml -o b.part --samples 0..64 --crop 320,0,640,480
  photosphere render fig2.toml -o fig2.exr --noise 2% --preview so-far.png

Ctrl-C stops and writes the samples done so far; a second one, or one before the first sample,
stops at once and writes nothing. With --checkpoint FILE, `photosphere resume FILE` goes on, and so
does the same command.")]
pub(super) struct RenderArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,

    #[command(flatten)]
    pub(super) output: OutputArgs,

    #[command(flatten)]
    pub(super) accel: AccelArg,

    #[command(flatten)]
    pub(super) memory: MemoryArg,

    #[command(flatten)]
    pub(super) picture: PictureArgs,

    /// Render these samples of each pixel only, as in 0..64; a range starts on a multiple of 16, and
    /// ends on one unless it is the last
    #[arg(long, value_name = "A..B", value_parser = keep::samples, conflicts_with = "noise")]
    pub(super) samples: Option<std::ops::Range<u32>>,

    #[command(flatten)]
    pub(super) keep: KeepArgs,

    #[command(flatten)]
    pub(super) stop: StopArgs,

    #[command(flatten)]
    pub(super) watch: WatchArgs,

    /// Say nothing but warnings and errors
    #[arg(short, long)]
    pub(super) quiet: bool,

    /// Print one JSON object with the figures of the render on the standard output
    #[arg(long)]
    pub(super) json: bool,
}

/// Check every intersector against exact arithmetic, on rays of the scene
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere crosscheck scenes/cornell-spheres.toml
  photosphere crosscheck grains.toml --rays 3000 --dump wrong-rays.txt

A third each are rays of the camera, their bounces, and random rays at difficult places. `equal` and
`ambiguous` (within the rounding that the intersector states for itself) are right; anything else
makes the exit code 1: another sphere (wrong), none (lost) or one where there is none (ghosts), and a
wrong distance, side of the sphere or occlusion. More than 1 % of ambiguous answers to the rays of the
camera and their bounces is worth a warning: spheres are then too small for how far away they are.")]
pub(super) struct CrosscheckArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,

    #[command(flatten)]
    pub(super) accels: AccelsArg,

    /// Rays to trace, from 3 to 10 million; each is compared with every sphere of the scene
    #[arg(long, value_name = "N", default_value_t = 30_000)]
    #[arg(allow_negative_numbers = true)]
    #[arg(value_parser = clap::value_parser!(u32).range(3..=10_000_000))]
    pub(super) rays: u32,

    /// Chooses the random rays
    #[arg(long, value_name = "S", default_value_t = 0, allow_negative_numbers = true)]
    #[arg(value_parser = seed())]
    pub(super) seed: u64,

    /// Write the rays that were answered wrongly to a file
    #[arg(long, value_name = "FILE")]
    pub(super) dump: Option<PathBuf>,
}

/// Say what is in a scene and what of it deserves attention, or how a picture was made
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere info scenes/cornell-spheres.toml
  photosphere info fig2.png
  photosphere info grains.toml --json | jq .spheres
  photosphere info grains.toml --memory-limit 8GiB

What comes first is the memory that a render will take with each intersector: from the lengths of the
tables and the scene alone, before anything is loaded.")]
pub(super) struct InfoArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,

    #[command(flatten)]
    pub(super) accel: AccelArg,

    #[command(flatten)]
    pub(super) memory: MemoryArg,

    /// Print one JSON object
    #[arg(long)]
    pub(super) json: bool,
}

/// `KEY=VALUE`.
#[derive(Clone, Debug, PartialEq)]
struct Setting {
    key: String,
    value: String,
}

/// `WxH`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Size {
    pub(super) width: u32,
    pub(super) height: u32,
}

impl std::fmt::Display for Size {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

impl SceneArgs {
    /// Threads asked for.
    pub(super) fn threads(&self) -> Option<usize> {
        self.options.threads()
    }

    /// What `--set` says.
    pub(super) fn overrides(&self) -> Vec<Override> {
        self.options.overrides()
    }
}

impl SceneOptions {
    /// Threads asked for.
    pub(super) fn threads(&self) -> Option<usize> {
        self.threads
    }

    /// What `--set` says.
    pub(super) fn overrides(&self) -> Vec<Override> {
        let setting = |Setting { key, value }: &Setting| Override {
            option: format!("--set {key}={value}"),
            key: key.clone(),
            value: value.clone(),
        };
        self.set.iter().map(setting).collect()
    }
}

impl RenderArgs {
    /// What the options change in the scene.
    pub(super) fn overrides(&self) -> Vec<Override> {
        let most = self.stop.overrides(self.picture.has_samples());
        most.into_iter().chain(self.picture.overrides(&self.scene)).collect()
    }
}

fn setting(text: &str) -> Result<Setting, String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() => {
            Ok(Setting { key: key.trim().to_owned(), value: value.trim().to_owned() })
        }
        _ => Err("it must be KEY=VALUE, as in render.seed=7".to_owned()),
    }
}

/// Any whole number: the scene knows which are allowed, and says so.
fn whole(text: &str) -> Result<i128, String> {
    text.parse().map_err(|_| "it must be a whole number".to_owned())
}

fn size(text: &str) -> Result<Size, String> {
    let read = || {
        let (width, height) = text.split_once(['x', 'X'])?;
        Some(Size { width: width.parse().ok()?, height: height.parse().ok()? })
    };
    read().ok_or_else(|| "it must be WIDTHxHEIGHT, as in 640x480".to_owned())
}

/// More threads than any machine has cores are a typing error, and would not start.
fn threads() -> impl TypedValueParser<Value = usize> {
    clap::value_parser!(u16).range(1..=4096).map(usize::from)
}

/// As wide as that of a scene.
fn seed() -> impl TypedValueParser<Value = u64> {
    clap::value_parser!(i64).range(0..=i64::MAX).map(i64::unsigned_abs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{Backend, Choice, Quality};
    use clap::CommandFactory;

    fn render(words: &str) -> RenderArgs {
        let words = ["photosphere", "render"].into_iter().chain(words.split_whitespace());
        match Cli::try_parse_from(words).unwrap().command {
            Command::Render(args) => *args,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn clap_finds_no_fault_in_the_definition() {
        Cli::command().debug_assert();
    }

    #[test]
    fn options_become_overrides_and_set_comes_last() {
        let args = render(
            "a.toml -o a.png --set render.seed=3 --spp 16 --size 64x48 --integrator paper \
             --sampler sobol --set materials.m.albedo=[0.1,0.2,0.3] --max-depth 5",
        );
        let overrides = args.overrides();
        let shown: Vec<_> = overrides
            .iter()
            .map(|o| (o.option.as_str(), o.key.as_str(), o.value.as_str()))
            .collect();
        let expected = [
            ("--size 64x48", "image.width", "64"),
            ("--size 64x48", "image.height", "48"),
            ("--integrator paper", "render.integrator", "paper"),
            ("--sampler sobol", "render.sampler", "sobol"),
            ("--spp 16", "render.samples_per_pixel", "16"),
            ("--max-depth 5", "render.max_depth", "5"),
            ("--set render.seed=3", "render.seed", "3"),
            ("--set materials.m.albedo=[0.1,0.2,0.3]", "materials.m.albedo", "[0.1,0.2,0.3]"),
        ];
        assert_eq!(shown, expected);
    }

    #[test]
    fn every_backend_can_be_named_and_the_choice_is_automatic_by_default() {
        assert_eq!(render("a.toml -o a.png").accel.choice, Choice::Auto);
        for backend in Backend::ALL {
            let args = render(&format!("a.toml -o a.png --accel {}", backend.name()));
            assert_eq!(args.accel.choice, Choice::Only(*backend));
        }
    }

    #[test]
    fn a_build_can_be_fast() {
        assert_eq!(render("a.toml -o a.png").accel.build.quality, Quality::Best);
        assert_eq!(render("a.toml -o a.png --build fast").accel.build.quality, Quality::Fast);
    }
}
