//! The command-line definition for clap. The doc comments of its types and fields are the `--help`
//! text.
//!
//! clap rejects what it can judge alone: unknown options, or text in place of a number. Values of
//! scene keys become [`Override`]s and are checked with the scene, so that `--spp 0` gives the same
//! error message as `samples_per_pixel = 0`.

mod accel;
mod bench;
mod cite;
mod compare;
mod comparison;
mod converge;
mod convert;
mod crosscheck;
mod denoise;
mod generate;
pub mod help;
mod import;
mod info;
mod keep;
mod memory;
mod output;
mod overlay;
mod pick;
mod picture;
mod plan;
mod render;
mod reproduce;
mod scene;
mod stop;
mod studio;
mod trace;
mod values;
mod verify;

use clap::{Parser, Subcommand};

use super::exit::EXIT_CODES;

pub use bench::BenchArgs;
pub use cite::CiteArgs;
pub use compare::CompareArgs;
pub use converge::ConvergeArgs;
pub use convert::ConvertArgs;
pub use crosscheck::CrosscheckArgs;
pub use denoise::DenoiseArgs;
pub use generate::GenerateArgs;
pub use import::ImportArgs;
pub use info::InfoArgs;
pub use keep::{MergeArgs, ResumeArgs};
pub use output::OutputArgs;
pub use overlay::OverlayArgs;
pub use pick::PickArgs;
pub use plan::{Division, PlanArgs, PlanFormat};
pub use render::RenderArgs;
pub use reproduce::ReproduceArgs;
pub use stop::StopArgs;
pub use studio::StudioArgs;
pub use trace::TraceArgs;
pub use verify::VerifyArgs;

const EXAMPLES: &str = "\
Examples:
  photosphere render scenes/paper/fig2.toml -o fig2.png
  photosphere render scenes/paper/fig2.toml -o fig2.exr --spp 1024
  photosphere convert fig2.exr -o fig2.png --tone agx
  photosphere info scenes/cornell-spheres.toml
  photosphere plan scenes/paper/fig2.toml --shards 4 --spp 4096 -o fig2.exr
  photosphere generate gas -n 1e6 -o gas.f32 --scene gas.toml
  photosphere doctor";

/// Renders scenes made of spheres by Monte Carlo path tracing.
///
/// A scene is a TOML file (docs/scene-format.md), with binary tables for very many spheres. Every
/// command has a help page with examples: photosphere render --help.
#[derive(Debug, Parser)]
#[command(name = "photosphere", version, max_term_width = 100)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{EXIT_CODES}"))]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    Render(Box<RenderArgs>),
    Resume(ResumeArgs),
    Merge(MergeArgs),
    Plan(Box<PlanArgs>),
    Crosscheck(CrosscheckArgs),
    Bench(BenchArgs),
    Compare(CompareArgs),
    Converge(ConvergeArgs),
    Convert(Box<ConvertArgs>),
    Denoise(DenoiseArgs),
    Reproduce(ReproduceArgs),
    Trace(TraceArgs),
    Verify(VerifyArgs),
    Generate(GenerateArgs),
    Import(Box<ImportArgs>),
    Pick(PickArgs),
    Info(InfoArgs),
    Cite(CiteArgs),
    /// Report the Embree version, the instruction set, and what is missing
    #[command(after_help = "\
Examples:
  photosphere doctor

Prints Embree's versions (at compile time and at run time) and instruction set, or how to install
Embree. Then tests every intersector with two rays.")]
    Doctor,
    /// Print the JSON schema of scene files, for completion and checks in an editor
    #[command(after_help = "\
Examples:
  photosphere schema > photosphere.schema.json

Editors with taplo, such as VS Code with Even Better TOML, find the schema by the first line of a
scene:
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
        /// The command [default: the whole program]
        command: Option<String>,
    },
}

impl Command {
    /// Returns true if the result is to be printed as JSON.
    pub fn json(&self) -> bool {
        match self {
            Self::Render(args) => args.json,
            Self::Resume(args) => args.json,
            Self::Bench(args) => args.json,
            Self::Compare(args) => args.json,
            Self::Converge(args) => args.json,
            Self::Trace(args) => args.json,
            Self::Verify(args) => args.json,
            Self::Info(args) => args.json,
            Self::Pick(args) => args.json,
            Self::Merge(_)
            | Self::Plan(_)
            | Self::Cite(_)
            | Self::Convert(_)
            | Self::Crosscheck(_)
            | Self::Denoise(_)
            | Self::Reproduce(_)
            | Self::Generate(_)
            | Self::Import(_)
            | Self::Doctor
            | Self::Schema
            | Self::Completions { .. }
            | Self::Man { .. } => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn clap_finds_no_fault_in_the_definition() {
        Cli::command().debug_assert();
    }
}
