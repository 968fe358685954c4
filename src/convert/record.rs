//! What the new file records of how its pixels were made.

use crate::film::{Aov, FilmFrame, Layer, TILE_SIZE};
use crate::image_io::{BEAUTY, FileFormat, PngDepth};
use crate::job::{Metadata, TileSampleCounts};
use crate::math::Rect;

use super::options::ConvertOptions;
use super::source::Source;

/// The record of the new file, of its format. `done` says what was done to the pixels other than
/// showing them; what the record cannot express otherwise is added to it.
pub(super) fn record(
    source: &Source,
    to: FileFormat,
    options: &ConvertOptions,
    done: Vec<String>,
) -> Option<Metadata> {
    let mut metadata = source.metadata.clone()?;
    crop(&mut metadata, source.window());
    metadata.converted.extend(done);
    let was_shown = source.format.is_display_referred();
    let from = source.png_depth.unwrap_or_default();
    let is_requantized = match to {
        FileFormat::Png => from != options.png_depth,
        FileFormat::Exr | FileFormat::Hdr | FileFormat::Pfm => true,
    };
    if was_shown && is_requantized {
        metadata.converted.push(format!("from {} bits for the screen", from.name()));
    }
    if to.is_display_referred() {
        metadata.bits = (options.png_depth != PngDepth::default()).then_some(options.png_depth);
        (metadata.layers, metadata.column_layers) = (None, Vec::new());
        if !was_shown {
            metadata.look = (options.look != Default::default()).then_some(options.look);
        }
    } else {
        metadata.bits = None;
        if was_shown {
            // It is a part of the pixels, and no layer of its own.
            metadata.overlay = None;
        }
        keep_layers(&mut metadata, source, options);
    }
    Some(metadata)
}

/// Records which layers a file with layers still has.
fn keep_layers(metadata: &mut Metadata, source: &Source, options: &ConvertOptions) {
    let is_kept = |name: &str| options.keeps(name);
    let is_aov_kept = |aov: &Aov| match aov {
        Aov::Beauty => true,
        Aov::Mean(Layer::Alpha) => is_kept(super::source::ALPHA),
        aov => is_kept(aov.info().name),
    };
    if let Some(layers) = &mut metadata.layers {
        layers.retain(is_aov_kept);
    }
    metadata.column_layers.retain(|name| is_kept(name));
    if !is_kept("overlay") {
        metadata.overlay = None;
    }
    if !is_kept(BEAUTY) && source.layer(BEAUTY).is_some() {
        metadata.converted.push(format!("without the layer {BEAUTY}"));
    }
}

/// Records that only these pixels of the full picture are left. Each of them has the samples that
/// it had, so a render of the crop gives the same.
fn crop(metadata: &mut Metadata, window: Rect) {
    let image = &mut metadata.settings.image;
    let (before, full_size) = (image.pixel_bounds(), [image.width, image.height]);
    if before == window {
        return;
    }
    if before.intersection(&window) != Some(window) || !metadata.parts.is_empty() {
        metadata.converted.push(format!("crop {window}"));
        return;
    }
    image.crop = Some(window);
    let counts = &metadata.counts.0;
    let old = FilmFrame { full_size, window: before };
    if counts.len() != old.tile_count() {
        return;
    }
    let new = FilmFrame { full_size, window };
    let [first, first_row] =
        [(window.x / TILE_SIZE[0]) * TILE_SIZE[0], (window.y / TILE_SIZE[1]) * TILE_SIZE[1]];
    let across = new.tiles_across();
    let corner = |tile: usize| {
        let x = first + (tile % across) as u32 * TILE_SIZE[0];
        let y = first_row + (tile / across) as u32 * TILE_SIZE[1];
        [x.max(window.x), y.max(window.y)]
    };
    let count = |tile: usize| counts[old.tile_containing(corner(tile)).unwrap_or_default()];
    let counts: Vec<u32> = (0..new.tile_count()).map(count).collect();
    let ends = (counts.iter().min().copied(), counts.iter().max().copied());
    if let (Some(min), Some(max)) = ends {
        (metadata.samples.min_count, metadata.samples.max_count) = (min, max);
        let is_uniform = min == max;
        metadata.counts = TileSampleCounts(if is_uniform { Vec::new() } else { counts });
    }
}
