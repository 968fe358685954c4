//! `[background]`.

use std::path::Path;

use crate::color::Rgb;
use crate::light::Orientation;
use crate::math::{DVec3, normalize_robust};
use crate::scene::description::{
    BackgroundDescription, EnvironmentDescription, LightPreset, SunDescription,
};
use crate::scene::keys::{background as keys, light};
use crate::scene::toml::document::Table;

/// The sun's angular diameter at the Earth's mean distance, in degrees.
const DEFAULT_SUN_DIAMETER: f64 = 0.533;

pub(super) fn read(table: &Table<'_>, folder: &Path) -> BackgroundDescription {
    let up = table.get(&keys::UP).unwrap_or(DVec3::Y);
    let up = normalize_robust(up).unwrap_or_else(|| {
        table.error_at("up", "`background.up` must not be [0, 0, 0]", None);
        DVec3::Y
    });
    let radiance = table.get(&keys::RADIANCE_EVERYWHERE);
    let gradient = table.section_if_present("gradient", read_gradient);
    let image = table.section_if_present("image", |inner| read_image(inner, folder));
    let sky = table.section_if_present("sky", read_sky);
    let sun = table.section_if_present("sun", |inner| read_sun(inner, up));
    let transparent = table.get(&keys::TRANSPARENT).unwrap_or(false);
    let camera_visible = table.get(&keys::CAMERA_VISIBLE).unwrap_or(!transparent);
    require_single_environment(table);
    let constant = || EnvironmentDescription::Constant { radiance: radiance.unwrap_or(Rgb::ZERO) };
    let dome = gradient.or(image).or(sky).unwrap_or_else(constant);
    let backdrop = table.get(&keys::BACKDROP);
    if backdrop.is_some() && transparent {
        let message = "`background.backdrop` is never seen, because `background.transparent` leaves \
                       it out of the picture";
        table.error_at("backdrop", message, "remove one of them".to_owned());
    }
    BackgroundDescription { dome, up, sun, camera_visible, transparent, backdrop }
}

/// Reads `[light]`, which takes the place of the light in `[background]`.
pub(super) fn read_light(table: &Table<'_>, root: &Table<'_>) -> Option<(LightPreset, f64)> {
    let preset = table.get(&light::PRESET);
    let strength = table.get(&light::STRENGTH).unwrap_or(1.0);
    let lights = ["radiance", "gradient", "image", "sky", "sun"];
    if let Some(light_key) = lights.iter().find(|key| root.has_entry("background", key)) {
        let message = format!("`light.preset` and `background.{light_key}` both light the scene");
        table.error_at("preset", message, "remove one of them".to_owned());
    }
    Some((preset?, strength))
}

fn read_gradient(table: &Table<'_>) -> EnvironmentDescription {
    let zenith = table.get(&keys::gradient::ZENITH).unwrap_or_default();
    let horizon = table.get(&keys::gradient::HORIZON).unwrap_or_default();
    let nadir = table.get(&keys::gradient::NADIR).unwrap_or(horizon);
    EnvironmentDescription::Gradient { zenith, horizon, nadir }
}

fn read_image(table: &Table<'_>, folder: &Path) -> EnvironmentDescription {
    let file = table.get(&keys::image::FILE);
    let rotation_degrees = table.get(&keys::image::ROTATION).unwrap_or(0.0);
    let scale = table.get(&keys::image::FACTOR).unwrap_or(1.0);
    EnvironmentDescription::Image {
        file: folder.join(file.unwrap_or_default()),
        rotation_degrees,
        scale,
    }
}

fn read_sky(table: &Table<'_>) -> EnvironmentDescription {
    let turbidity = table.get(&keys::sky::TURBIDITY).unwrap_or(3.0);
    let ground_albedo = table.get(&keys::sky::GROUND_ALBEDO).unwrap_or(Rgb::splat(0.2));
    let scale = table.get(&keys::sky::FACTOR).unwrap_or(1.0);
    EnvironmentDescription::Sky { turbidity, ground_albedo, scale }
}

fn read_sun(table: &Table<'_>, up: DVec3) -> SunDescription {
    let direction = table.get(&keys::sun::DIRECTION);
    let elevation = table.get(&keys::sun::ELEVATION);
    let azimuth = table.get(&keys::sun::AZIMUTH);
    let diameter = table.get(&keys::sun::DIAMETER);
    let irradiance = table.get(&keys::sun::IRRADIANCE);
    let given = |key| table.span_of(key).is_some();
    let by_angles = given("elevation_degrees") || given("azimuth_degrees");
    let direction = match (given("direction"), by_angles) {
        (true, false) => direction.map(|direction| {
            normalize_robust(direction).unwrap_or_else(|| {
                let message = "`background.sun.direction` must not be [0, 0, 0]";
                table.error_at("direction", message, None);
                up
            })
        }),
        (false, true) => {
            let elevation = elevation.unwrap_or(0.0).to_radians();
            let azimuth = azimuth.unwrap_or(0.0).to_radians();
            Some(Orientation::new(up, 0.0).direction(elevation, azimuth))
        }
        (both, _) => {
            let message = match both {
                true => "`background.sun` has both a direction and angles",
                false => "`background.sun` needs `direction`, or `elevation_degrees`",
            };
            let help = "set either `direction`, towards the sun, or `elevation_degrees` and \
                        `azimuth_degrees`";
            table.error_at("direction", message, help.to_owned());
            None
        }
    };
    SunDescription {
        direction: direction.unwrap_or(up),
        angular_diameter_degrees: diameter.unwrap_or(DEFAULT_SUN_DIAMETER),
        irradiance: irradiance.unwrap_or_default(),
    }
}

/// Checks that at most one environment map is given.
fn require_single_environment(table: &Table<'_>) {
    let given = ["radiance", "gradient", "image", "sky"].map(|key| (key, table.span_of(key)));
    let given: Vec<&str> = given.iter().filter(|(_, span)| span.is_some()).map(|g| g.0).collect();
    if let [first, second, ..] = given[..] {
        let message = format!("`background` has both `{first}` and `{second}`");
        let help = "keep one of `radiance`, `gradient`, `image` and `sky`".to_owned();
        table.error_at(second, message, help);
    }
}
