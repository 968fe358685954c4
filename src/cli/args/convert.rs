//! The options of `photosphere convert`.

use std::path::PathBuf;

use clap::Args;

use crate::appearance::{ColorMap, RangeChoice};
use crate::convert::{ConvertOptions, FalseColors};
use crate::image_io::{PICTURE_FORMATS, PngDepth};
use crate::math::Rect;
use crate::overlay::OverlayChoice;

use super::output::LookArgs;
use super::values::{named, one_of, positive, window};

/// Show a picture in another way: format, tone, crop, one of its layers, numbers as colours
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere convert fig2.exr -o fig2.png --tone agx --exposure 1
  photosphere convert fig2.exr -o fig2.png --bits 16
  photosphere convert fig2.exr -o depth.png --layer depth --range p0,p95
  photosphere convert fig2.exr -o cost.png --layer sample_count --colormap magma
  photosphere convert fig2.exr -o light.exr --layer beauty,direct
  photosphere convert fig2.exr -o corner.png --crop 0,0,320,240

IN may be .exr, .png, .hdr or .pfm, from photosphere or any other program. Without --layer, an .exr
file keeps all its layers, and other formats show the picture itself, the layer `beauty`.

In a .png file, layers of light go through --exposure and --tone. Layers of one number, such as depth,
sample_count or a column of a particle file, are drawn in the colours of --colormap with a colour bar;
ids get a colour each; coordinates become red, green and blue. Where nothing is seen, the picture is
transparent. --colormap also shows the luminance of a layer of light. The linear formats keep the
numbers as they are.

What the file records of how it was made is kept as far as it stays true. A picture that only went
through another view transform or was cropped can still be reproduced; others record what was done.")]
pub struct ConvertArgs {
    /// The picture to convert
    #[arg(value_name = "IN")]
    pub input: PathBuf,

    /// The new picture.
    #[arg(short = 'o', long = "output", value_name = "OUT", help = output_help())]
    pub output: PathBuf,

    /// The layers to keep, such as direct,albedo; one, unless OUT is an .exr file [default: all
    /// that OUT can hold]
    #[arg(long = "layer", value_name = "LIST", value_delimiter = ',')]
    layers: Vec<String>,

    /// Keep only the pixels in this rectangle, with the columns X0 to X1 - 1 and the rows Y0 to
    /// Y1 - 1 of the full picture
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = window)]
    crop: Option<Rect>,

    #[command(flatten)]
    pub look: LookArgs,

    /// Bits per channel of .png files: 8 or 16
    #[arg(long, value_name = "N", value_parser = one_of(named::<PngDepth>()))]
    pub bits: Option<PngDepth>,

    /// The colour map for numbers [default: viridis for layers of numbers]
    #[arg(long, value_name = "NAME", value_parser = one_of(named::<ColorMap>()))]
    pub colormap: Option<ColorMap>,

    /// The numbers at the ends of the map, each a number or a percentile such as p1 [default:
    /// p0,p100]
    #[arg(long, value_name = "LO,HI", value_parser = range, allow_hyphen_values = true)]
    pub range: Option<RangeChoice>,

    /// Map the logarithm of the numbers
    #[arg(long)]
    pub log: bool,

    /// Draw no colour bar, and nothing that an .exr file has as its overlay
    #[arg(long)]
    no_legend: bool,

    /// The title of the colour bar, such as "depth (nm)" [default: the layer]
    #[arg(long, value_name = "TEXT", conflicts_with = "no_legend")]
    title: Option<String>,

    /// The size of texts in points at the resolution of --dpi [default: 8]
    #[arg(long, value_name = "PT", value_parser = positive)]
    font_size: Option<f64>,

    /// Print only warnings and errors
    #[arg(short, long)]
    pub quiet: bool,
}

impl ConvertArgs {
    /// Returns the options as values.
    pub fn options(&self) -> ConvertOptions {
        ConvertOptions {
            layers: self.layers.clone(),
            denoiser: None,
            crop: self.crop,
            look: self.look.look(),
            png_depth: self.bits.unwrap_or_default(),
            dpi: self.look.dpi,
            false_colors: FalseColors {
                map: self.colormap,
                range: self.range.unwrap_or_default(),
                log: self.log,
            },
            overlay: OverlayChoice {
                legend: !self.no_legend,
                title: self.title.clone(),
                font_size: self.font_size,
                ..OverlayChoice::default()
            },
        }
    }

    /// Returns the options that apply only to files for the screen; true if they are given.
    pub fn given(&self) -> impl Iterator<Item = (&'static str, bool)> {
        let own = [
            ("--bits", self.bits.is_some()),
            ("--colormap", self.colormap.is_some()),
            ("--range", self.range.is_some()),
            ("--log", self.log),
            ("--no-legend", self.no_legend),
            ("--title", self.title.is_some()),
            ("--font-size", self.font_size.is_some()),
        ];
        self.look.given().into_iter().chain(own)
    }
}

fn output_help() -> String {
    format!("The new picture; its extension chooses the format: {PICTURE_FORMATS}")
}

fn range(text: &str) -> Result<RangeChoice, String> {
    RangeChoice::parse(text)
        .ok_or_else(|| "expected LO,HI, each a number or a percentile, such as 0,p99".to_owned())
}
