//! The options for what is drawn over a picture.

use clap::Args;

use crate::overlay::OverlayChoice;

use super::values::positive;

/// What is drawn over a picture of particles: into .png files, and as a layer of .exr files.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Over the picture")]
pub struct OverlayArgs {
    /// Draw no colour bar or legend
    #[arg(long)]
    no_legend: bool,

    /// The title of the colour bar or legend, such as "energy (eV)" [default: the column]
    #[arg(long, value_name = "TEXT", conflicts_with = "no_legend")]
    title: Option<String>,

    /// Draw a scale bar, true at the depth of the middle of the particles
    #[arg(long)]
    scale_bar: bool,

    /// The unit of length at the scale bar [default: that of the file]
    #[arg(long, value_name = "TEXT", requires = "scale_bar")]
    unit: Option<String>,

    /// Draw the axes
    #[arg(long)]
    axes: bool,

    /// The size of texts in points at the resolution of --dpi [default: 8]
    #[arg(long, value_name = "PT", value_parser = positive)]
    font_size: Option<f64>,
}

impl OverlayArgs {
    /// Returns the options as values.
    pub fn choice(&self) -> OverlayChoice {
        OverlayChoice {
            legend: !self.no_legend,
            title: self.title.clone(),
            scale_bar: self.scale_bar,
            unit: self.unit.clone(),
            tripod: self.axes,
            font_size: self.font_size,
        }
    }
}
