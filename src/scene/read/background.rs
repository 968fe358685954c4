//! `[background]`.

use std::path::Path;

use crate::color::Rgb;
use crate::light::Orientation;
use crate::math::DVec3;
use crate::scene::description::{Background, Dome, Sun};
use crate::scene::document::Table;
use crate::scene::environment::{self, Pixels};
use crate::scene::values::{COORDINATES, Color, Flag, Limits, Number, Text};

use super::camera::unit;
use super::{BRIGHTEST, RADIANCE};

/// Colours between black and white.
const SHARE: Color = Color(Limits::FromTo(0.0, 1.0));

/// A factor on radiance.
const SCALE: Number = Number(Limits::FromTo(0.0, 1e6));

/// W/m^2 per channel.
const IRRADIANCE: Color = Color(Limits::FromTo(0.0, BRIGHTEST));

/// The range in which the sky was fitted.
const TURBIDITY: Number = Number(Limits::FromTo(2.0, 10.0));

/// The sun's angular diameter as seen from the Earth's mean distance.
const USUAL_DIAMETER: f64 = 0.533;

const ANGLE: Number = Number(Limits::FromTo(-360.0, 360.0));

/// The background, and the pixels of its image where it has one.
pub(super) fn read(table: &Table<'_>, folder: &Path) -> Option<(Background, Option<Pixels>)> {
    let up = table.optional("up", COORDINATES).unwrap_or(DVec3::Y);
    let Some(up) = unit(up) else {
        table.report().add(table.wrong("up", "`background.up` must not be [0, 0, 0]"));
        return None;
    };
    let radiance = table.optional("radiance", RADIANCE);
    let gradient = section(table, "gradient", read_gradient);
    let image = section(table, "image", |inner| read_image(inner, folder));
    let sky = section(table, "sky", read_sky);
    let sun = section(table, "sun", |inner| read_sun(inner, up));
    let transparent = table.optional("transparent", Flag).unwrap_or(false);
    let camera_visible = table.optional("camera_visible", Flag).unwrap_or(!transparent);
    demand_one_dome(table);
    if matches!(sky, Some(Some(_))) {
        demand_sun_for_sky(table, &sun, up);
    }
    if transparent && camera_visible {
        let message = "`background.camera_visible` is true, but `background.transparent` leaves the \
                       background out of the picture";
        table.report().add(table.wrong("camera_visible", message).help("leave one out".to_owned()));
    }
    let (dome, pixels) = match (gradient, image, sky) {
        (Some(gradient), ..) => (gradient?, None),
        (_, Some(image), _) => image.map(|(dome, pixels)| (dome, Some(pixels)))?,
        (.., Some(sky)) => (sky?, None),
        _ => (Dome::Constant { radiance: radiance.unwrap_or(Rgb::ZERO) }, None),
    };
    let sun = match sun {
        Some(sun) => Some(sun?),
        None => None,
    };
    Some((Background { dome, up, sun, camera_visible, transparent }, pixels))
}

/// A table that may be left out, unlike the keys in it; `Some(None)` where it is broken.
fn section<'d, T>(
    table: &Table<'d>,
    key: &'static str,
    read: impl FnOnce(&Table<'d>) -> Option<T>,
) -> Option<Option<T>> {
    match table.span_of(key) {
        Some(_) => Some(table.optional_section(key, read)),
        None => {
            // So that the key is known to messages.
            table.optional_section(key, |_| None::<T>);
            None
        }
    }
}

fn read_gradient(table: &Table<'_>) -> Option<Dome> {
    let zenith = table.required("zenith", RADIANCE);
    let horizon = table.required("horizon", RADIANCE);
    let nadir = table.optional("nadir", RADIANCE);
    let horizon = horizon?;
    Some(Dome::Gradient { zenith: zenith?, horizon, nadir: nadir.unwrap_or(horizon) })
}

fn read_image(table: &Table<'_>, folder: &Path) -> Option<(Dome, Pixels)> {
    let file = table.required("file", Text);
    let rotation_degrees = table.optional("rotation_degrees", ANGLE).unwrap_or(0.0);
    let scale = table.optional("scale", SCALE).unwrap_or(1.0);
    let file = folder.join(file?);
    match environment::read(&file) {
        Ok(pixels) => Some((Dome::Image { file, rotation_degrees, scale }, pixels)),
        Err(trouble) => {
            let message = format!("cannot use `{}` as background: {trouble}", file.display());
            table.report().add(table.wrong("file", message));
            None
        }
    }
}

fn read_sky(table: &Table<'_>) -> Option<Dome> {
    let turbidity = table.optional("turbidity", TURBIDITY).unwrap_or(3.0);
    let ground_albedo = table.optional("ground_albedo", SHARE).unwrap_or(Rgb::splat(0.2));
    let scale = table.optional("scale", SCALE).unwrap_or(1.0);
    Some(Dome::Sky { turbidity, ground_albedo, scale })
}

fn read_sun(table: &Table<'_>, up: DVec3) -> Option<Sun> {
    let direction = table.optional("direction", COORDINATES);
    let elevation = table.optional("elevation_degrees", Number(Limits::FromTo(-90.0, 90.0)));
    let azimuth = table.optional("azimuth_degrees", ANGLE);
    let diameter = table.optional("angular_diameter_degrees", Number(Limits::FromTo(1e-3, 180.0)));
    let irradiance = table.required("irradiance", IRRADIANCE);
    let given = |key| table.span_of(key).is_some();
    let by_angles = given("elevation_degrees") || given("azimuth_degrees");
    let direction = match (given("direction"), by_angles) {
        (true, false) => {
            let unit = unit(direction?);
            if unit.is_none() {
                let message = "`background.sun.direction` must not be [0, 0, 0]";
                table.report().add(table.wrong("direction", message));
            }
            unit
        }
        (false, true) => {
            let elevation = elevation.unwrap_or(0.0).to_radians();
            let azimuth = azimuth.unwrap_or(0.0).to_radians();
            Some(Orientation::new(up, 0.0).direction(elevation, azimuth))
        }
        (both, _) => {
            let message = match both {
                true => "`background.sun` has a direction and angles",
                false => "`background.sun` needs `direction`, or `elevation_degrees`",
            };
            let help = "give `direction` towards the sun, or `elevation_degrees` and \
                        `azimuth_degrees`";
            table.report().add(table.wrong("direction", message).help(help.to_owned()));
            None
        }
    };
    Some(Sun {
        direction: direction?,
        angular_diameter_degrees: diameter.unwrap_or(USUAL_DIAMETER),
        irradiance: irradiance?,
    })
}

/// Whether not two things want to be the dome.
fn demand_one_dome(table: &Table<'_>) {
    let given = ["radiance", "gradient", "image", "sky"].map(|key| (key, table.span_of(key)));
    let given: Vec<&str> = given.iter().filter(|(_, span)| span.is_some()).map(|g| g.0).collect();
    if let [first, second, ..] = given[..] {
        let message = format!("`background` has both `{first}` and `{second}`");
        let help = "keep one of `radiance`, `gradient`, `image` and `sky`".to_owned();
        table.report().add(table.wrong(second, message).help(help));
    }
}

fn demand_sun_for_sky(table: &Table<'_>, sun: &Option<Option<Sun>>, up: DVec3) {
    match sun {
        None => {
            let message = "`background.sky` needs `[background.sun]`, which says where the sun is";
            let help = "an irradiance of [0, 0, 0] leaves the sun itself out".to_owned();
            table.report().add(table.wrong("sky", message).help(help));
        }
        Some(Some(sun)) if sun.direction.dot(up) <= 0.0 => {
            let message = "`background.sky` needs a sun above the horizon";
            table.report().add(table.wrong("sun", message));
        }
        _ => {}
    }
}
