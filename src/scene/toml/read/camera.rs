//! `[camera]`.

use crate::math::DVec3;
use crate::names::did_you_mean;
use crate::scene::description::{
    CameraDescription, LensDescription, ProjectionDescription, ProjectionKind, SphereDescription,
};
use crate::scene::keys::camera as keys;
use crate::scene::toml::document::Table;
use crate::scene::value_types::{InvalidValue, NonEmptyString, ParseValue, SpannedValue};

/// The name of a sphere; parsed to its index.
struct SphereName<'s>(&'s [SphereDescription]);

/// Reads the camera, which may focus on one of the spheres.
pub(super) fn read(table: &Table<'_>, spheres: &[SphereDescription]) -> CameraDescription {
    let usual = CameraDescription::default();
    let kind = table.get(&keys::TYPE).unwrap_or_default();
    let position = table.get(&keys::POSITION);
    let look_at = table.get(&keys::LOOK_AT);
    let up = table.get(&keys::UP).unwrap_or(usual.up);
    let near = table.get(&keys::NEAR).unwrap_or(usual.near);
    let view = position.zip(look_at).map(|(position, look_at)| ViewAxis { position, look_at });
    let projection = match kind {
        ProjectionKind::Perspective => {
            let fov = table.get(&keys::perspective::FOV);
            let lens = read_lens(table, view.as_ref(), spheres);
            ProjectionDescription::Perspective { vertical_fov_degrees: fov.unwrap_or(36.0), lens }
        }
        ProjectionKind::Orthographic => {
            let height = table.get(&keys::orthographic::HEIGHT);
            ProjectionDescription::Orthographic { height: height.unwrap_or(1.0) }
        }
        ProjectionKind::Panoramic => ProjectionDescription::Panoramic {
            horizontal_degrees: table.get(&keys::panoramic::HORIZONTAL).unwrap_or(360.0),
            vertical_degrees: table.get(&keys::panoramic::VERTICAL).unwrap_or(180.0),
        },
    };
    let [position, look_at] = [(position, usual.position), (look_at, usual.look_at)]
        .map(|(read, usual)| read.unwrap_or(usual));
    CameraDescription { position, look_at, up, near, projection }
}

/// The view axis.
struct ViewAxis {
    position: DVec3,
    look_at: DVec3,
}

/// Reads the lens; `None` is a pinhole, for which the other lens keys are ignored.
fn read_lens(
    table: &Table<'_>,
    view: Option<&ViewAxis>,
    spheres: &[SphereDescription],
) -> Option<LensDescription> {
    use keys::perspective as keys;
    let radius = table.get(&keys::APERTURE_RADIUS).unwrap_or(0.0);
    let distance = table.get(&keys::FOCUS_DISTANCE);
    let sphere = table.optional(keys::FOCUS_ON.name, &SphereName(spheres));
    let blades = table.get(&keys::BLADES).unwrap_or(0);
    let rotation_degrees = table.get(&keys::ROTATION).unwrap_or(0.0);
    if let Some(message) = blades_error(blades) {
        table.error_at("blades", message, None);
    }
    if distance.is_some() && sphere.is_some() {
        let message =
            "`camera.focus_on` and `camera.focus_distance` both set the focus; remove one";
        table.error_at("focus_on", message, None);
    }
    let view = view?;
    let on_sphere = sphere.map(|index| {
        let depth = focus_depth(view, &spheres[index]);
        if depth.is_nan() || depth <= 0.0 {
            let message = "the sphere of `camera.focus_on` is not in front of the camera";
            table.error_at("focus_on", message, None);
            table.mark_invalid("focus_distance");
        }
        depth
    });
    let usual = view.position.distance(view.look_at);
    let focus_distance = on_sphere.or(distance).unwrap_or(usual);
    (radius > 0.0).then_some(LensDescription { radius, focus_distance, blades, rotation_degrees })
}

/// Message for an invalid blade count, checked even if the radius is 0 and there is no lens.
fn blades_error(blades: u32) -> Option<String> {
    let message = || format!("`camera.blades` must be 0 for a disk, or at least 3, not {blades}");
    matches!(blades, 1 | 2).then(message)
}

/// Depth along the view axis of the sphere's nearest point to the camera.
fn focus_depth(view: &ViewAxis, sphere: &SphereDescription) -> f64 {
    let axis = (view.look_at - view.position).normalize_or_zero();
    let to_center = sphere.center - view.position;
    let distance = to_center.length();
    to_center.dot(axis) * (1.0 - sphere.radius / distance)
}

impl ParseValue for SphereName<'_> {
    type Output = usize;

    fn expects(&self) -> String {
        "the name of a sphere".into()
    }

    fn parse(&self, node: &SpannedValue<'_>) -> Result<usize, InvalidValue> {
        let name = NonEmptyString.parse(node)?;
        let mut named =
            (0..self.0.len()).filter(|&i| self.0[i].name.as_deref() == Some(name.as_str()));
        let unfit =
            |found, help| InvalidValue { span: node.span(), found, help, is_unknown_name: true };
        match (named.next(), named.next()) {
            (Some(index), None) => Ok(index),
            (Some(_), Some(_)) => {
                let help = "give them different names, or set `focus_distance`".to_owned();
                Err(unfit(format!("{name:?}, which several spheres have"), Some(help)))
            }
            (None, _) => {
                let names = self.0.iter().filter_map(|sphere| sphere.name.as_deref());
                Err(unfit(format!("{name:?}"), did_you_mean(&name, names)))
            }
        }
    }
}
