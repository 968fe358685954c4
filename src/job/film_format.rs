//! Which film a job needs.

use crate::film::{Format, Frame, Kind, Layer, Scale, summed_for};
use crate::math::Rect;
use crate::scene::{Settings, Shot};

/// The film of a shot's picture with these layers, from the first sample on.
pub fn format_of(shot: &Shot, layers: &[Kind]) -> Format {
    let transparent = shot.scene().description().background.transparent;
    format_with(shot.settings(), transparent, Scale::of_brightest(shot.brightest()), layers)
}

/// The same, before the scene's emitters are known.
pub(super) fn format_with(
    settings: &Settings,
    transparent: bool,
    scale: Scale,
    layers: &[Kind],
) -> Format {
    let mut layers = summed_for(layers);
    if transparent && !layers.contains(&Layer::Alpha) {
        layers.push(Layer::Alpha);
    }
    let Rect { x, y, width, height } = settings.image.window();
    Format {
        frame: Frame {
            full_size: [settings.image.width, settings.image.height],
            window: Rect { x, y, width, height },
        },
        first_sample: 0,
        scale,
        layers,
        squares: true,
    }
}
