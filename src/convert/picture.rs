//! The conversion of one file.

use std::path::Path;
use std::sync::Arc;

use crate::color::{Rgb, ViewTransform};
use crate::denoise::DENOISED;
use crate::error::{Error, Result};
use crate::image_io::{
    BEAUTY, ChannelValues, CropWindow, FileFormat, ImageChannel, OverlayImage, Picture, PngDepth,
    WriteOptions,
};
use crate::job::Metadata;
use crate::overlay::OverlaySpec;

use super::false_color;
use super::legend;
use super::options::{ConvertOptions, is_meant};
use super::record::record;
use super::shown::Shown;
use super::source::{ALPHA, LayerKind, Source, SourceLayer};

/// A converted picture, ready to be written.
#[derive(Clone, Debug)]
pub struct Converted {
    /// The pixels.
    pub picture: Picture,
    /// What is written beside them.
    pub options: WriteOptions,
    /// What was done, for the user; empty if the picture is only shown or stored anew.
    pub done: Vec<String>,
    /// True if the new file has finer steps than the old one, which they cannot show.
    pub is_finer_than_source: bool,
    /// False if the file says in a way that is not understood how it was made.
    pub is_record_understood: bool,
}

/// Converts a picture for a file of the format `to`.
///
/// # Errors
/// If the file cannot be read, has no such layer or pixels, or if an option suits the layer or the
/// format not.
pub fn convert(path: &Path, to: FileFormat, options: &ConvertOptions) -> Result<Converted> {
    let mut source = Source::read(path, FileFormat::from_path(path)?)?;
    refuse_second_look(path, &source, options)?;
    for name in &options.layers {
        if !source.layers.iter().any(|layer| is_meant(name, &layer.name)) {
            let message = format!("`{}` has no layer `{name}`", path.display());
            let help = format!("its layers are {}", source.layer_names());
            return Err(Error::input(message).with_help(help));
        }
    }
    // Before the crop, whose surroundings help.
    if let Some(denoiser) = &options.denoiser {
        refuse_no_light(path, &source)?;
        source.denoise(denoiser)?;
    }
    if let Some(crop) = options.crop {
        source.crop(crop)?;
    }
    let OneLayer { picture, overlay, done, is_false } = match to.has_layers() {
        true => OneLayer { picture: layered(&source, options), ..OneLayer::default() },
        false => one_layer(path, &source, to, options)?,
    };
    let mut metadata = record(&source, to, options, done.clone());
    if let Some(metadata) = metadata.as_mut().filter(|_| !shows_denoised(&source, to, options)) {
        metadata.unmark_denoised();
    }
    let is_drawn_anew = !to.has_layers() && (is_false || !source.format.is_display_referred());
    if let Some(metadata) = metadata.as_mut().filter(|_| is_drawn_anew) {
        metadata.overlay.clone_from(&overlay);
    }
    let is_whole = source.size == source.full_size && source.offset == [0; 2];
    // False colours have a bar that is as large as the file.
    let is_placed = !is_whole && !is_false;
    Ok(Converted {
        picture,
        options: WriteOptions {
            crop_window: is_placed
                .then_some(CropWindow { full_size: source.full_size, offset: source.offset }),
            view_transform: options.look,
            png_depth: options.png_depth,
            dpi: options.dpi,
            metadata: metadata.as_ref().map(Metadata::to_records).transpose()?.unwrap_or_default(),
            overlay: overlay.map(|overlay| Arc::new(drawn(&overlay, is_false))),
            fast: false,
        },
        is_finer_than_source: to == FileFormat::Png
            && source.png_depth == Some(PngDepth::Eight)
            && options.png_depth == PngDepth::Sixteen,
        is_record_understood: metadata.is_some() || !source.has_records,
        done,
    })
}

/// Refuses to expose a picture for the screen again: its light above white is lost.
fn refuse_second_look(path: &Path, source: &Source, options: &ConvertOptions) -> Result<()> {
    if !source.format.is_display_referred() || options.look == ViewTransform::default() {
        return Ok(());
    }
    let path = path.display();
    let message =
        format!("`{path}` has been through a view transform: it has no light above white any more");
    Err(Error::input(message).with_help("convert the .exr, .hdr or .pfm file that it came from"))
}

/// Refuses to denoise what has been rounded and clipped for the screen, or has no picture.
fn refuse_no_light(path: &Path, source: &Source) -> Result<()> {
    let path = path.display();
    if source.format.is_display_referred() {
        return Err(Error::input(format!("`{path}` holds values for the screen, not light"))
            .with_help("denoise the .exr, .hdr or .pfm file that it came from"));
    }
    if source.layer(BEAUTY).is_none() {
        let help = format!("its layers are {}", source.layer_names());
        return Err(Error::input(format!("`{path}` has no layer `{BEAUTY}`")).with_help(help));
    }
    Ok(())
}

/// Returns true if the denoised picture is in the new file.
fn shows_denoised(source: &Source, to: FileFormat, options: &ConvertOptions) -> bool {
    let is_there = source.layer(DENOISED).is_some();
    is_there
        && if to.has_layers() { options.keeps(DENOISED) } else { shown(options) == Some(DENOISED) }
}

/// The layer that a file with one layer shows; `None` if several are asked for.
fn shown(options: &ConvertOptions) -> Option<&str> {
    match &options.layers[..] {
        [] if options.denoiser.is_some() => Some(DENOISED),
        [] => Some(BEAUTY),
        [name] => Some(name),
        [_, ..] => None,
    }
}

/// The layers that are kept, as they are stored.
pub(super) fn layered(source: &Source, options: &ConvertOptions) -> Picture {
    let [width, height] = source.size;
    let mut picture = Picture { width, height, ..Picture::default() };
    picture.hidden_layers = vec!["direct", "indirect"];
    picture.direct = vec![Rgb::ZERO; width * height];
    picture.indirect = vec![Rgb::ZERO; width * height];
    picture.attributes.clone_from(&source.attributes);
    let is_kept = |layer: &&SourceLayer| options.keeps(&layer.name);
    match source.layer(BEAUTY).filter(is_kept) {
        Some(beauty) => picture.direct = premultiplied(source, beauty),
        None => picture.hidden_layers.push(BEAUTY),
    }
    for layer in source.layers.iter().filter(is_kept).filter(|layer| layer.name != BEAUTY) {
        for channel in &layer.channels {
            match (&*channel.name, opacity(channel)) {
                ("A", Some(alpha)) => picture.alpha = Some(alpha),
                _ => picture.channels.push(channel.clone()),
            }
        }
    }
    picture
}

/// What a file shows.
#[derive(Default)]
struct OneLayer {
    picture: Picture,
    /// What is drawn over it.
    overlay: Option<OverlaySpec>,
    /// What was done to it.
    done: Vec<String>,
    /// True for false colours.
    is_false: bool,
}

/// Draws an overlay; a bar of false colours is on a plate.
fn drawn(overlay: &OverlaySpec, is_false: bool) -> OverlayImage {
    match is_false {
        true => false_color::with_plate(overlay.draw(), (0.6 * overlay.font_pixels) as usize),
        false => overlay.draw(),
    }
}

fn one_layer(
    path: &Path,
    source: &Source,
    to: FileFormat,
    options: &ConvertOptions,
) -> Result<OneLayer> {
    let layer = the_layer(path, source, to, options)?;
    let [width, height] = source.size;
    let indirect = vec![Rgb::ZERO; width * height];
    let mut picture = Picture { width, height, indirect, ..Picture::default() };
    let (mut done, mut is_false) = (Vec::new(), false);
    // The record says of a denoised picture that it is one.
    let is_picture = layer.name == BEAUTY || layer.name == DENOISED;
    if !is_picture {
        done.push(format!("layer {}", layer.name));
    }
    if to.is_display_referred() {
        legend::refuse_unused(layer, options)?;
        legend::refuse_drawn(path, source, options.false_colors.map.is_some())?;
    }
    let overlay = match Shown::new(source, layer, to, options)? {
        Shown::Values(_) if layer.kind() == LayerKind::Light && layer.name != ALPHA => {
            picture.direct = premultiplied(source, layer);
            picture.alpha = alpha(source);
            legend::over_light(path, source, is_picture, options)?
        }
        Shown::Values(values) => {
            picture.direct = values;
            None
        }
        Shown::FalseColors(colors) => {
            let colors = *colors;
            (picture.direct, picture.alpha) = (colors.pixels, colors.alpha);
            is_false = true;
            done.push(colors.done);
            colors.overlay
        }
    };
    Ok(OneLayer { picture, overlay, done, is_false })
}

fn the_layer<'a>(
    path: &Path,
    source: &'a Source,
    to: FileFormat,
    options: &ConvertOptions,
) -> Result<&'a SourceLayer> {
    let path = path.display();
    let Some(name) = shown(options) else {
        let message = format!("a .{} file holds one layer", to.name());
        let first = &options.layers[0];
        let help = format!("name one, such as {first}, or write an .exr file");
        return Err(Error::input(message).with_help(help));
    };
    source.layer(name).ok_or_else(|| {
        let help = format!("name one of its layers: {}", source.layer_names());
        Error::input(format!("`{path}` has no layer `{name}` to show")).with_help(help)
    })
}

/// The colours of a layer, multiplied with the opacity: in files for the screen they are not.
fn premultiplied(source: &Source, layer: &SourceLayer) -> Vec<Rgb> {
    let mut pixels = layer.pixels();
    if let Some(alpha) = alpha(source).filter(|_| source.format.is_display_referred()) {
        pixels.iter_mut().zip(alpha).for_each(|(pixel, alpha)| *pixel *= alpha);
    }
    pixels
}

fn alpha(source: &Source) -> Option<Vec<f32>> {
    source.layer(ALPHA)?.channels.iter().find_map(opacity)
}

/// The opacities of a channel.
fn opacity(channel: &ImageChannel) -> Option<Vec<f32>> {
    match &channel.values {
        ChannelValues::Float(values) => Some(values.clone()),
        ChannelValues::Uint(_) => None,
    }
}
