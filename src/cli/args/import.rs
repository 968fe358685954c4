//! The options of `photosphere import`.

use std::path::PathBuf;

use clap::Args;

use super::picture::PictureArgs;
use super::scene::SceneOptions;
use super::studio::StudioArgs;
use crate::scene::Override;

/// Write the scene that `render` makes of a particle file
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere import run.lammpstrj -o scene.toml
  photosphere import protein.pdb -o scene.toml --style clay --view -30,10
  photosphere import beads.csv -o scene.toml --color c_pe --colormap batlow

The scene is a text file (docs/scene-format.md) that can be edited and rendered. It refers to the
particle file, and says what was chosen automatically. What is drawn over a picture, such as a title
or a scale bar, is no part of a scene: give these options to render.")]
pub struct ImportArgs {
    /// The particle file
    #[arg(value_name = "FILE")]
    pub path: PathBuf,

    /// The scene to write; - is the standard output
    #[arg(short, long, value_name = "SCENE")]
    pub output: PathBuf,

    #[command(flatten)]
    pub picture: PictureArgs,

    #[command(flatten)]
    pub options: SceneOptions,

    #[command(flatten)]
    pub studio: StudioArgs,
}

impl ImportArgs {
    /// Returns the overrides of the scene.
    pub fn overrides(&self) -> Vec<Override> {
        self.picture.overrides_with(&self.options)
    }
}
