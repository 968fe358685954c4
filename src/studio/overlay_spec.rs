//! What is drawn over a picture of a scene.

use crate::appearance::Legend;
use crate::color::{Rgb, luminance, srgb8_from_linear};
use crate::math::DVec3;
use crate::overlay::{LegendSpec, OverlayChoice, OverlaySpec, ScaleBarSpec, font_pixels};
use crate::scene::SceneFile;
use crate::scene::description::{
    BackgroundDescription, CameraDescription, EnvironmentDescription, ProjectionDescription,
};

/// Backgrounds darker than this luminance take light ink.
const DARK: f32 = 0.18;

/// Describes the overlay of a scene's picture; `None` if nothing is to be drawn. `dpi` is the
/// resolution for print, in pixels per inch.
pub fn overlay_spec(
    choice: &OverlayChoice,
    scene: &SceneFile,
    dpi: Option<u32>,
) -> Option<OverlaySpec> {
    let image = &scene.settings.image;
    let size = [image.width, image.height];
    let height = f64::from(image.height);
    let look = scene.particles().next().map(|particles| particles.look);
    let legend = match look.filter(|_| choice.legend) {
        Some(look) => legend_spec(&look.legend, choice.title.as_deref()),
        None => LegendSpec::Nothing,
    };
    let camera = &scene.description.camera;
    let unit = || look.and_then(|look| look.unit).unwrap_or_default().to_owned();
    let scale_bar = pixels_per_unit(camera, height).filter(|_| choice.scale_bar);
    let scale_bar = scale_bar.map(|pixels_per_unit| ScaleBarSpec {
        pixels_per_unit,
        unit: choice.unit.clone().unwrap_or_else(unit),
    });
    let spec = OverlaySpec {
        size,
        font_pixels: font_pixels(choice, image.height, dpi),
        light_ink: is_dark(&scene.description.background),
        legend,
        scale_bar,
        tripod: choice.tripod.then(|| axes_in_picture(camera)),
    };
    (!spec.is_empty()).then_some(spec)
}

/// Says which of the choices leave nothing to see in a picture of this scene.
pub fn overlay_warnings(choice: &OverlayChoice, scene: &SceneFile) -> Vec<String> {
    let legend = scene.particles().next().map(|particles| &particles.look.legend);
    let has_legend = legend.is_some_and(|legend| legend_spec(legend, None) != LegendSpec::Nothing);
    let mut warnings = Vec::new();
    if choice.title.is_some() && !has_legend {
        warnings.push(
            "the title is drawn nowhere: there is no colour bar or legend, because no numbers or \
             kinds of particles are coloured: `color` names a column"
                .to_owned(),
        );
    }
    match legend {
        Some(Legend::Range { title, .. }) if title.parse::<f64>().is_ok() => {
            warnings.push(format!(
                "all particles have one colour: `color` is the number {title}, not a column, which \
                 `info` lists"
            ));
        }
        _ => {}
    }
    let is_panorama =
        matches!(scene.description.camera.projection, ProjectionDescription::Panoramic { .. });
    if choice.scale_bar && is_panorama {
        warnings.push("there is no scale bar: a panorama has no scale".to_owned());
    }
    warnings
}

/// A legend with few entries more than nothing; one category says nothing.
fn legend_spec(legend: &Legend, given_title: Option<&str>) -> LegendSpec {
    let title = |own: &str| given_title.unwrap_or(own).to_owned();
    match legend {
        Legend::Range { title: own, map, range, exceeded } => LegendSpec::Bar {
            title: title(own),
            map: *map,
            ends: [range.low, range.high],
            log: range.log,
            exceeded: *exceeded,
        },
        Legend::Categories { title: own, entries } if entries.len() > 1 => {
            let srgb = |color: &Rgb| color.to_array().map(srgb8_from_linear);
            let entries = entries.iter().map(|(name, color)| (name.clone(), srgb(color)));
            LegendSpec::Categories { title: title(own), entries: entries.collect() }
        }
        Legend::Categories { .. } | Legend::Nothing => LegendSpec::Nothing,
    }
}

/// Pixels of a unit of length at the point that the camera looks at.
fn pixels_per_unit(camera: &CameraDescription, height: f64) -> Option<f64> {
    match camera.projection {
        ProjectionDescription::Perspective { vertical_fov_degrees, .. } => {
            let distance = camera.look_at.distance(camera.position);
            let tan = libm::tan(0.5 * vertical_fov_degrees.to_radians());
            Some(height / (2.0 * tan * distance))
        }
        ProjectionDescription::Orthographic { height: view } => Some(height / view),
        ProjectionDescription::Panoramic { .. } => None,
    }
}

fn axes_in_picture(camera: &CameraDescription) -> [[f64; 2]; 3] {
    let forward = (camera.look_at - camera.position).normalize_or_zero();
    let right = forward.cross(camera.up).normalize_or_zero();
    let up = right.cross(forward);
    DVec3::AXES.map(|axis| [axis.dot(right), axis.dot(up)])
}

fn is_dark(background: &BackgroundDescription) -> bool {
    let color = match &background.dome {
        EnvironmentDescription::Constant { radiance } => *radiance,
        EnvironmentDescription::Gradient { horizon, .. } => *horizon,
        EnvironmentDescription::Image { .. } | EnvironmentDescription::Sky { .. } => Rgb::ONE,
    };
    !background.transparent && luminance(color) < DARK
}
