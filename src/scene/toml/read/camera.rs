//! `[camera]`.

use crate::appearance::ViewDirection;
use crate::names::did_you_mean;
use crate::scene::description::{
    CameraDescription, CameraFit, FocusTarget, LensDescription, ProjectionDescription,
    ProjectionKind, SphereDescription,
};
use crate::scene::keys::Key;
use crate::scene::keys::camera as keys;
use crate::scene::toml::document::Table;
use crate::scene::value_types::{InvalidValue, NonEmptyString, ParseValue, SpannedValue};

/// The vertical field of view where the scene gives none.
const USUAL_FOV_DEGREES: f64 = 36.0;

/// Half of the height of a film of 36 x 24 mm.
const HALF_FILM_METERS: f64 = 0.012;

/// The name of a sphere, or of a row of a table.
struct SphereName<'s> {
    spheres: &'s [SphereDescription],
    tables: &'s [String],
}

/// Reads the camera, which may focus on one of the spheres. `tables` are the names of the tables.
pub(super) fn read(
    table: &Table<'_>,
    spheres: &[SphereDescription],
    tables: &[String],
) -> CameraDescription {
    let usual = CameraDescription::default();
    let kind = table.get(&keys::TYPE).unwrap_or_default();
    let fit = read_fit(table);
    let position = read_unless_fitted(table, &keys::POSITION, fit.is_some());
    let look_at = read_unless_fitted(table, &keys::LOOK_AT, fit.is_some());
    let mut camera = CameraDescription {
        position: position.unwrap_or(usual.position),
        look_at: look_at.unwrap_or(usual.look_at),
        up: table.get(&keys::UP).unwrap_or(usual.up),
        near: table.get(&keys::NEAR).unwrap_or(usual.near),
        fit,
        ..usual
    };
    camera.projection = match kind {
        ProjectionKind::Perspective => {
            let fov = table.get(&keys::perspective::FOV).unwrap_or(USUAL_FOV_DEGREES);
            let is_placed = position.and(look_at).is_some();
            let lens = read_lens(table, &mut camera, fov, is_placed, spheres, tables);
            ProjectionDescription::Perspective { vertical_fov_degrees: fov, lens }
        }
        ProjectionKind::Orthographic => {
            let height = match camera.fit {
                Some(_) => read_unless_fitted(table, &keys::orthographic::HEIGHT, true),
                None => table.get(&keys::orthographic::HEIGHT),
            };
            let distance = camera.position.distance(camera.look_at);
            let usual = 2.0 * distance * libm::tan(0.5 * USUAL_FOV_DEGREES.to_radians());
            ProjectionDescription::Orthographic { height: height.unwrap_or(usual) }
        }
        ProjectionKind::Panoramic => ProjectionDescription::Panoramic {
            horizontal_degrees: table.get(&keys::panoramic::HORIZONTAL).unwrap_or(360.0),
            vertical_degrees: table.get(&keys::panoramic::VERTICAL).unwrap_or(180.0),
        },
    };
    camera
}

fn read_fit(table: &Table<'_>) -> Option<CameraFit> {
    let is_fitted = table.get(&keys::FIT).unwrap_or(false);
    let direction = table.get(&keys::DIRECTION);
    let margin = table.get(&keys::MARGIN);
    let right_margin = table.get(&keys::RIGHT_MARGIN);
    let given = [
        ("direction", direction.is_some()),
        ("margin", margin.is_some()),
        ("right_margin", right_margin.is_some()),
    ];
    for (key, _) in given.into_iter().filter(|(_, is_given)| *is_given && !is_fitted) {
        let message = format!("`camera.{key}` is of use only with `fit = true`");
        table.error_at(key, message, "add `fit = true`, or remove it".to_owned());
    }
    is_fitted.then_some(CameraFit {
        direction: direction.unwrap_or(ViewDirection::ISO),
        margin: margin.unwrap_or(0.05),
        right_margin,
    })
}

/// Reads a key that is required, unless the camera is fitted, which then gives its value.
fn read_unless_fitted<K: ParseValue>(
    table: &Table<'_>,
    key: &'static Key<K>,
    is_fitted: bool,
) -> Option<K::Output> {
    if !is_fitted {
        return table.required(key.name, &key.kind);
    }
    if table.optional(key.name, &key.kind).is_some() {
        let message = format!("`camera.{}` is given, but `fit = true` finds it", key.name);
        table.error_at(key.name, message, "remove one of them".to_owned());
    }
    None
}

/// Reads the lens; `None` is a pinhole, for which the other lens keys are ignored. Sets the
/// camera's focus target, if the focus distance follows only from the loaded spheres.
fn read_lens(
    table: &Table<'_>,
    camera: &mut CameraDescription,
    fov: f64,
    is_placed: bool,
    spheres: &[SphereDescription],
    tables: &[String],
) -> Option<LensDescription> {
    use keys::perspective as keys;
    let radius = read_radius(table, fov);
    let distance = table.get(&keys::FOCUS_DISTANCE);
    let target = table.optional(keys::FOCUS_ON.name, &SphereName { spheres, tables });
    let pixel = read_pixel(table);
    let blades = table.get(&keys::BLADES).unwrap_or(0);
    let rotation_degrees = table.get(&keys::ROTATION).unwrap_or(0.0);
    if let Some(message) = blades_error(blades) {
        table.error_at("blades", message, None);
    }
    let given = [
        ("focus_distance", distance.is_some()),
        ("focus_on", target.is_some()),
        ("focus_on_pixel", pixel.is_some()),
    ];
    let given: Vec<&str> =
        given.into_iter().filter_map(|(key, is_given)| is_given.then_some(key)).collect();
    if let [first, second, ..] = given[..] {
        let message =
            format!("`camera.{second}` and `camera.{first}` both set the focus; remove one");
        table.error_at(second, message, None);
    }
    let is_fitted = camera.fit.is_some();
    let usual = (is_fitted && distance.is_none()).then_some(FocusTarget::Middle);
    let mut focus_distance = distance.unwrap_or(camera.position.distance(camera.look_at));
    camera.focus_target = pixel.or(target).or(usual);
    match camera.focus_target {
        Some(FocusTarget::Sphere(index)) if !is_fitted => {
            camera.focus_target = None;
            focus_distance = camera.depth_of(&spheres[index as usize].sphere());
            if is_placed && (focus_distance.is_nan() || focus_distance <= 0.0) {
                let message = "the sphere of `camera.focus_on` is not in front of the camera";
                table.error_at("focus_on", message, None);
                table.mark_invalid("focus_distance");
            }
        }
        Some(_) => focus_distance = 1.0,
        None => {}
    }
    (is_placed || is_fitted)
        .then_some(LensDescription { radius, focus_distance, blades, rotation_degrees })
        .filter(|lens| lens.radius > 0.0)
}

/// The radius of the aperture, given directly or by an f-number.
fn read_radius(table: &Table<'_>, fov: f64) -> f64 {
    use keys::perspective as keys;
    let radius = table.get(&keys::APERTURE_RADIUS);
    let f_number = table.get(&keys::F_NUMBER);
    let unit = table.get(&keys::METERS_PER_UNIT);
    if radius.is_some() && f_number.is_some() {
        let message =
            "`camera.f_number` and `camera.aperture_radius` both set the aperture; remove one";
        table.error_at("f_number", message, None);
    }
    if unit.is_some() && f_number.is_none() {
        let message = "`camera.meters_per_unit` is of use only with `camera.f_number`";
        table.error_at("meters_per_unit", message, None);
    }
    let of_lens = |f_number: f64| {
        let focal_length = HALF_FILM_METERS / libm::tan(0.5 * fov.to_radians());
        0.5 * focal_length / f_number / unit.unwrap_or(1.0)
    };
    radius.or(f_number.map(of_lens)).unwrap_or(0.0)
}

fn read_pixel(table: &Table<'_>) -> Option<FocusTarget> {
    let pixel = table.get(&keys::perspective::FOCUS_ON_PIXEL)?;
    let [x, y] = pixel[..] else {
        let message = format!(
            "`camera.focus_on_pixel` must be [x, y], the column and the row of a pixel, not {} numbers",
            pixel.len()
        );
        table.error_at("focus_on_pixel", message, None);
        return None;
    };
    Some(FocusTarget::Pixel(x, y))
}

/// Message for an invalid blade count, checked even if the radius is 0 and there is no lens.
fn blades_error(blades: u32) -> Option<String> {
    let message = || format!("`camera.blades` must be 0 for a disk, or at least 3, not {blades}");
    matches!(blades, 1 | 2).then(message)
}

impl ParseValue for SphereName<'_> {
    type Output = FocusTarget;

    fn expects(&self) -> String {
        "the name of a sphere".into()
    }

    fn parse(&self, node: &SpannedValue<'_>) -> Result<FocusTarget, InvalidValue> {
        let name = NonEmptyString.parse(node)?;
        let is_named = |i: &usize| self.spheres[*i].name.as_deref() == Some(name.as_str());
        let mut named = (0..self.spheres.len()).filter(is_named);
        let unfit =
            |found, help| InvalidValue { span: node.span(), found, help, is_unknown_name: true };
        match (named.next(), named.next()) {
            (Some(index), None) => Ok(FocusTarget::Sphere(index as u32)),
            (Some(_), Some(_)) => {
                let help = "give them different names, or set `focus_distance`".to_owned();
                Err(unfit(format!("{name:?}, which several spheres have"), Some(help)))
            }
            (None, _) => self.row_of_table(&name).ok_or_else(|| {
                let names = self.spheres.iter().filter_map(|sphere| sphere.name.as_deref());
                let rows = self.tables.iter().map(|table| format!("{table}:0"));
                let rows: Vec<String> = rows.collect();
                let help = did_you_mean(&name, names.chain(rows.iter().map(String::as_str)));
                unfit(format!("{name:?}"), help)
            }),
        }
    }
}

impl SphereName<'_> {
    /// The sphere named by a table and a row, as in `grains.f32:17`.
    fn row_of_table(&self, name: &str) -> Option<FocusTarget> {
        let (table, row) = name.rsplit_once(':')?;
        let table = self.tables.iter().position(|known| known == table)?;
        Some(FocusTarget::TableRow(table as u32, row.parse().ok()?))
    }
}
