//! Chooses the film format for a job.

use crate::film::{Aov, FilmFormat, FilmFrame, Layer, RadianceScale, required_layers};
use crate::math::Rect;
use crate::scene::{PreparedScene, Settings};

/// Film format for a picture of the prepared scene with these AOVs, starting at sample 0.
pub fn format_for_scene(prepared: &PreparedScene, layers: &[Aov]) -> FilmFormat {
    let transparent = prepared.scene().description().background.transparent;
    format_for_settings(
        prepared.settings(),
        transparent,
        RadianceScale::from_max_radiance(prepared.max_radiance()),
        layers,
    )
}

/// Film format from the settings, before the scene's emitters are known.
pub(super) fn format_for_settings(
    settings: &Settings,
    transparent: bool,
    scale: RadianceScale,
    layers: &[Aov],
) -> FilmFormat {
    let mut layers = required_layers(layers);
    if transparent && !layers.contains(&Layer::Alpha) {
        layers.push(Layer::Alpha);
    }
    let Rect { x, y, width, height } = settings.image.pixel_bounds();
    FilmFormat {
        frame: FilmFrame {
            full_size: [settings.image.width, settings.image.height],
            window: Rect { x, y, width, height },
        },
        first_sample: 0,
        scale,
        layers,
        sums_squares: true,
    }
}
