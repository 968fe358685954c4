//! `[camera]`.

use crate::math::{DVec3, MAX_COORDINATE};
use crate::scene::description::{Camera, Lens, Projection, SphereRow};
use crate::scene::document::Table;
use crate::scene::report::did_you_mean;
use crate::scene::values::{COORDINATES, Choice, Limits, Node, Number, Read, Text, Unfit, Whole};

/// The sine of the angle between `up` and the view below which they count as parallel.
const PARALLEL: f64 = 1e-6;

/// A positive length.
const LENGTH: Number = Number(Limits::AboveTo(0.0, MAX_COORDINATE));

#[derive(Clone, Copy)]
enum Type {
    Perspective,
    Orthographic,
    Panoramic,
}

const TYPES: Choice<Type> = Choice(&[
    ("perspective", Type::Perspective),
    ("orthographic", Type::Orthographic),
    ("panoramic", Type::Panoramic),
]);

/// The name of one sphere; becomes its index.
struct SphereName<'s>(&'s [SphereRow]);

/// Reads the camera; it may be focused on one of the spheres.
pub(super) fn read(table: &Table<'_>, spheres: &[SphereRow]) -> Option<Camera> {
    let kind = table.optional("type", TYPES).unwrap_or(Type::Perspective);
    let position = table.required("position", COORDINATES);
    let look_at = table.required("look_at", COORDINATES);
    let up = table.optional("up", COORDINATES).unwrap_or(DVec3::Y);
    let near =
        table.optional("near", Number(Limits::FromTo(0.0, MAX_COORDINATE))).unwrap_or_default();
    let view = position.zip(look_at).map(|(position, look_at)| View { position, look_at });
    let projection = match kind {
        Type::Perspective => {
            let fov = table.optional("vertical_fov_degrees", Number(Limits::Between(0.0, 180.0)));
            let lens = read_lens(table, view.as_ref(), spheres);
            Some(Projection::Perspective { vertical_fov_degrees: fov.unwrap_or(36.0), lens })
        }
        Type::Orthographic => {
            table.required("height", LENGTH).map(|height| Projection::Orthographic { height })
        }
        Type::Panoramic => {
            let extent =
                |key, most| table.optional(key, Number(Limits::AboveTo(0.0, most))).unwrap_or(most);
            let horizontal_degrees = extent("horizontal_extent_degrees", 360.0);
            let vertical_degrees = extent("vertical_extent_degrees", 180.0);
            Some(Projection::Panoramic { horizontal_degrees, vertical_degrees })
        }
    };
    let View { position, look_at } = view?;
    let camera = Camera { position, look_at, up, near, projection: projection? };
    check_axes(table, &camera);
    Some(camera)
}

/// The view axis.
struct View {
    position: DVec3,
    look_at: DVec3,
}

/// The lens; `None` is a pinhole, to which what is said of a lens means nothing yet.
fn read_lens(table: &Table<'_>, view: Option<&View>, spheres: &[SphereRow]) -> Option<Lens> {
    let radius = Number(Limits::FromTo(0.0, MAX_COORDINATE));
    let radius = table.optional("aperture_radius", radius).unwrap_or(0.0);
    let distance = table.optional("focus_distance", LENGTH);
    let sphere = table.optional("focus_on", SphereName(spheres));
    let blades = table.optional("blades", Whole(0..=64)).unwrap_or(0);
    let rotation_degrees =
        table.optional("rotation_degrees", Number(Limits::FromTo(-360.0, 360.0))).unwrap_or(0.0);
    if matches!(blades, 1 | 2) {
        let message = format!("`camera.blades` must be 0 for a disk, or at least 3, not {blades}");
        table.report().add(table.wrong("blades", message));
    }
    if distance.is_some() && sphere.is_some() {
        let message = "`camera.focus_on` and `camera.focus_distance` say the same; leave one out";
        table.report().add(table.wrong("focus_on", message));
    }
    let view = view?;
    let on_sphere = sphere.map(|index| {
        let depth = depth_of(view, &spheres[index]);
        if depth.is_nan() || depth <= 0.0 {
            let message = "the sphere of `camera.focus_on` is not in front of the camera";
            table.report().add(table.wrong("focus_on", message));
        }
        depth
    });
    let usual = view.position.distance(view.look_at);
    let focus_distance = on_sphere.or(distance).unwrap_or(usual);
    (radius > 0.0).then_some(Lens { radius, focus_distance, blades, rotation_degrees })
}

/// How far along the view axis the point of a sphere is that is nearest to the camera.
fn depth_of(view: &View, sphere: &SphereRow) -> f64 {
    let axis = (view.look_at - view.position).normalize_or_zero();
    let to_center = sphere.center - view.position;
    let distance = to_center.length();
    to_center.dot(axis) * (1.0 - sphere.radius / distance)
}

impl Read for SphereName<'_> {
    type Output = usize;

    fn expects(&self) -> String {
        "the name of a sphere".into()
    }

    fn read(&self, node: &Node<'_>) -> Result<usize, Unfit> {
        let name = Text.read(node)?;
        let mut named =
            (0..self.0.len()).filter(|&i| self.0[i].name.as_deref() == Some(name.as_str()));
        let unfit = |found, help| Unfit { span: node.span(), found, help, names_nothing: true };
        match (named.next(), named.next()) {
            (Some(index), None) => Ok(index),
            (Some(_), Some(_)) => {
                let help = "give them different names, or say `focus_distance`".to_owned();
                Err(unfit(format!("{name:?}, which several have"), Some(help)))
            }
            (None, _) => {
                let names = self.0.iter().filter_map(|sphere| sphere.name.as_deref());
                Err(unfit(format!("{name:?}"), did_you_mean(&name, names)))
            }
        }
    }
}

/// Whether the camera looks anywhere, and knows how to hold its head.
fn check_axes(table: &Table<'_>, camera: &Camera) {
    let view = unit(camera.look_at - camera.position);
    let up = unit(camera.up);
    let wrong = match (view, up) {
        (None, _) => table.wrong("look_at", "`camera.look_at` must not be `camera.position`"),
        (_, None) => table.wrong("up", "`camera.up` must not be [0, 0, 0]"),
        (Some(view), Some(up)) if view.cross(up).length() < PARALLEL => {
            let other = if view.y.abs() < 0.5 { "[0, 1, 0]" } else { "[0, 0, 1]" };
            let key = if table.span_of("up").is_some() { "up" } else { "look_at" };
            table
                .wrong(key, "`camera.up` must not be parallel to the view")
                .help(format!("any other direction will do, as in `up = {other}`"))
        }
        _ => return,
    };
    table.report().add(wrong);
}

/// The direction of a vector however long or short, if it has one.
pub(super) fn unit(v: DVec3) -> Option<DVec3> {
    (v / v.abs().max_element()).try_normalize()
}
