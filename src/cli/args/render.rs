//! The options of `photosphere render`.

use std::ops::Range;
use std::path::PathBuf;

use clap::Args;

use crate::scene::Override;

use super::accel::AccelArg;
use super::keep::CheckpointArgs;
use super::memory::MemoryArg;
use super::output::{OutputArgs, StdoutArgs};
use super::overlay::OverlayArgs;
use super::picture::PictureArgs;
use super::scene::SceneArgs;
use super::stop::{StopArgs, WatchArgs};
use super::studio::StudioArgs;
use super::values::samples;

/// Render a scene or a particle file to a picture
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere render fig2.toml -o fig2.png
  photosphere render run.lammpstrj -o run.png --color c_pe --view iso
  photosphere render cloud.ply -o cloud.png --style paper
  photosphere render frames/*.xyz -o pictures/
  photosphere render fig2.toml -o quick.png --size 320x240 --spp 4
  photosphere render fig2.toml -o fig2.exr --estimator light --spp 1024 --seed 7
  photosphere render fig2.toml -o red.png --set materials.grass.albedo=[0.6,0,0]
  photosphere render fig2.toml -o fig2.exr -o fig2.png --tone agx --exposure 1
  photosphere render fig2.toml -o fig2.exr --layers direct,albedo,normal,depth
  photosphere render fig2.toml -o fig2.pfm --quiet --json | jq .samples_per_s
  photosphere render fig2.toml -o fig2.exr --spp 65536 --checkpoint fig2.state
  photosphere render fig2.toml -o b.part --samples 0..64 --crop 320,0,640,480
  photosphere render fig2.toml -o fig2.exr --noise 2% --preview so-far.png
  photosphere render fig2.toml -o fig2.exr -o fig2.png --spp 16 --denoise
  sed s/0.2/0.3/ fig2.toml | photosphere render - -o - > fig3.png

Ctrl-C stops the render and writes the samples so far. A second Ctrl-C, or one before
rendering starts, exits at once and writes nothing. To resume a render with --checkpoint FILE, use
`photosphere resume FILE` or repeat the command.")]
pub struct RenderArgs {
    #[command(flatten)]
    pub scene: SceneArgs,

    /// More scenes or particle files, for -o DIR/
    #[arg(value_name = "MORE")]
    pub more: Vec<PathBuf>,

    #[command(flatten)]
    pub output: OutputArgs,

    #[command(flatten)]
    pub stdout: StdoutArgs,

    #[command(flatten)]
    pub accel: AccelArg,

    #[command(flatten)]
    pub memory: MemoryArg,

    #[command(flatten)]
    pub picture: PictureArgs,

    /// Render only these samples of each pixel, such as 0..64; a range starts on a multiple of 16
    /// and, unless it is the last, ends on one
    #[arg(long, value_name = "A..B", value_parser = samples, conflicts_with = "target")]
    pub samples: Option<Range<u32>>,

    #[command(flatten)]
    pub keep: CheckpointArgs,

    #[command(flatten)]
    pub stop: StopArgs,

    #[command(flatten)]
    pub watch: WatchArgs,

    /// Denoise the picture with Intel Open Image Denoise, which must be installed: .exr files get
    /// the layer `denoised`, others show it. The picture is then biased
    #[arg(long)]
    pub denoise: bool,

    /// Print only warnings and errors
    #[arg(short, long)]
    pub quiet: bool,

    /// Print the statistics of the render as one JSON object on the standard output
    #[arg(long)]
    pub json: bool,

    // Last, because their headings hold for all options behind them.
    #[command(flatten)]
    pub studio: StudioArgs,

    #[command(flatten)]
    pub overlay: OverlayArgs,
}

impl RenderArgs {
    /// Returns the overrides of the scene.
    pub fn overrides(&self) -> Vec<Override> {
        let most = self.stop.overrides(self.picture.has_samples());
        most.into_iter().chain(self.picture.overrides(&self.scene)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{Backend, BackendChoice, BuildQuality};
    use crate::cli::args::{Cli, Command};
    use clap::Parser;

    fn render(words: &str) -> RenderArgs {
        let words = ["photosphere", "render"].into_iter().chain(words.split_whitespace());
        match Cli::try_parse_from(words).unwrap().command {
            Command::Render(args) => *args,
            other => panic!("{other:?}"),
        }
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
            .map(|o| (o.option().join(" "), o.key.as_str(), o.value.as_str()))
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
        assert_eq!(shown, expected.map(|(option, key, value)| (option.to_owned(), key, value)));
        assert_eq!(overrides[0].option(), ["--size", "64x48"]);
    }

    #[test]
    fn every_backend_can_be_named_and_the_choice_is_automatic_by_default() {
        assert_eq!(render("a.toml -o a.png").accel.choice, BackendChoice::Auto);
        for backend in Backend::ALL {
            let args = render(&format!("a.toml -o a.png --accel {}", backend.name()));
            assert_eq!(args.accel.choice, BackendChoice::Only(*backend));
        }
    }

    #[test]
    fn a_build_can_be_fast() {
        assert_eq!(render("a.toml -o a.png").accel.build.quality, BuildQuality::Best);
        assert_eq!(render("a.toml -o a.png --build fast").accel.build.quality, BuildQuality::Fast);
    }
}
