//! What is drawn over a converted picture.

use std::path::Path;

use crate::appearance::RangeChoice;
use crate::error::{Error, Result};
use crate::overlay::{LegendSpec, OverlaySpec, font_pixels};

use super::options::ConvertOptions;
use super::source::{LayerKind, Source, SourceLayer};

/// Returns what is drawn over a layer of light: what was over the picture, with the title and the
/// size of texts that are asked for. `is_picture` is false for other layers, which have nothing.
///
/// # Errors
/// If the options change something that is not there, or is part of the pixels.
pub(super) fn over_light(
    path: &Path,
    source: &Source,
    is_picture: bool,
    options: &ConvertOptions,
) -> Result<Option<OverlaySpec>> {
    let choice = &options.overlay;
    let mut recorded = recorded(source).filter(|_| is_picture).cloned();
    let has_text = choice.title.is_some() || choice.font_size.is_some();
    if has_text && recorded.is_none() {
        let message = format!("nothing is drawn over `{}`, so it has no texts", path.display());
        return Err(Error::input(message).with_help(
            "a title and the size of texts are for pictures with a colour bar or a legend, and for \
             numbers in false colours",
        ));
    }
    if source.format.is_display_referred() {
        refuse_drawn(path, source, has_text || !choice.legend)?;
        return Ok(None);
    }
    let Some(spec) = recorded.as_mut().filter(|_| choice.legend) else { return Ok(None) };
    if let Some(new) = &choice.title {
        match &mut spec.legend {
            LegendSpec::Bar { title, .. } | LegendSpec::Categories { title, .. } => {
                title.clone_from(new);
            }
            LegendSpec::Nothing => {
                let message = format!("`{}` has no colour bar and no legend", path.display());
                return Err(Error::input(message).with_help("leave the title out"));
            }
        }
    }
    if choice.font_size.is_some() {
        spec.font_pixels = font_pixels(choice, spec.size[1], options.dpi);
    }
    Ok(recorded)
}

/// Refuses to change what is drawn into the pixels of a picture; `is_changed` is true for that.
///
/// # Errors
/// If it is changed, and the record of the picture says that something is drawn.
pub(super) fn refuse_drawn(path: &Path, source: &Source, is_changed: bool) -> Result<()> {
    let is_drawn = source.format.is_display_referred() && recorded(source).is_some();
    if !is_changed || !is_drawn {
        return Ok(());
    }
    let message =
        format!("the colour bar or legend of `{}` is a part of its pixels", path.display());
    Err(Error::input(message)
        .with_help("convert the .exr file, which has it as a layer of its own, or render again"))
}

/// Refuses options of false colours that change nothing about a layer that is shown without, or
/// by colours that have no bar.
///
/// # Errors
/// Names the layer.
pub(super) fn refuse_unused(layer: &SourceLayer, options: &ConvertOptions) -> Result<()> {
    let colors = &options.false_colors;
    let (name, kind) = (&layer.name, layer.kind());
    let has_range = colors.range != RangeChoice::default() || colors.log;
    match kind {
        LayerKind::Light if colors.map.is_none() && has_range => {
            let message =
                format!("a range and a logarithm are for numbers, but the layer `{name}` is light");
            Err(Error::input(message)
                .with_help("choose a colour map, which shows its luminance, such as viridis"))
        }
        LayerKind::Id | LayerKind::Vector => {
            let choice = &options.overlay;
            let has_text = choice.title.is_some() || choice.font_size.is_some();
            if colors.map.is_none() && !has_range && !has_text {
                return Ok(());
            }
            let way = match kind {
                LayerKind::Id => "a colour for each id",
                _ => "coordinates as red, green and blue",
            };
            let message = format!("the layer `{name}` is shown by {way}, without a colour bar");
            Err(Error::input(message)
                .with_help("leave the colour map, its range, the title and the size of texts out"))
        }
        LayerKind::Light | LayerKind::Number => Ok(()),
    }
}

/// What the record says is drawn over the picture, unless the picture has another size.
fn recorded(source: &Source) -> Option<&OverlaySpec> {
    let overlay = source.metadata.as_ref()?.overlay.as_ref()?;
    (overlay.size == source.full_size.map(|length| length as u32)).then_some(overlay)
}
