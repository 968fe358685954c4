//! Validates the camera.

use crate::math::{DVec3, normalize_robust};
use crate::scene::description::{
    CameraDescription, CameraFit, FocusTarget, LensDescription, ProjectionDescription,
    SceneDescription,
};
use crate::scene::keys;
use crate::scene::validation_errors::{KeyPath, ValidationErrors};

/// Minimum sine of the angle between `up` and the view direction; below it they count as parallel.
const MIN_VIEW_UP_SINE: f64 = 1e-6;

/// Checks the camera of `scene`.
pub(super) fn check_camera(scene: &SceneDescription, problems: &mut ValidationErrors) {
    use keys::camera as keys;
    let camera = &scene.camera;
    let CameraDescription { position, look_at, up, near, projection, fit, focus_target } = camera;
    let at = KeyPath::root("camera");
    problems.check(&at, &keys::POSITION, position);
    problems.check(&at, &keys::LOOK_AT, look_at);
    problems.check(&at, &keys::UP, up);
    problems.check(&at, &keys::NEAR, near);
    match projection {
        ProjectionDescription::Perspective { vertical_fov_degrees, lens } => {
            problems.check(&at, &keys::perspective::FOV, vertical_fov_degrees);
            if let Some(lens) = lens {
                check_lens(&at, lens, problems);
            }
        }
        ProjectionDescription::Orthographic { height } => {
            problems.check(&at, &keys::orthographic::HEIGHT, height);
        }
        ProjectionDescription::Panoramic { horizontal_degrees, vertical_degrees } => {
            problems.check(&at, &keys::panoramic::HORIZONTAL, horizontal_degrees);
            problems.check(&at, &keys::panoramic::VERTICAL, vertical_degrees);
        }
    }
    if let Some(CameraFit { direction, margin, right_margin }) = fit {
        problems.check(&at, &keys::DIRECTION, direction);
        problems.check(&at, &keys::MARGIN, margin);
        if let Some(margin) = right_margin {
            problems.check(&at, &keys::RIGHT_MARGIN, margin);
        }
    }
    check_axes(&at, camera, problems);
    if let Some(target) = focus_target {
        check_focus(&at, *target, scene, problems);
    }
}

/// Checks that what the lens focuses on may be there.
fn check_focus(
    at: &KeyPath,
    target: FocusTarget,
    scene: &SceneDescription,
    problems: &mut ValidationErrors,
) {
    let (index, count, what) = match target {
        FocusTarget::Middle | FocusTarget::Pixel(..) => return,
        FocusTarget::Sphere(index) => (index, scene.spheres.len(), "spheres"),
        FocusTarget::TableRow(index, _) => (index, scene.tables.len(), "tables"),
    };
    if index as usize >= count {
        let key = at.key("focus_on");
        let message = format!("`{key}` is one of {count} {what}, but has the index {index}");
        problems.add(key, message);
    }
}

fn check_lens(at: &KeyPath, lens: &LensDescription, problems: &mut ValidationErrors) {
    use keys::camera::perspective as keys;
    let LensDescription { radius, focus_distance, blades, rotation_degrees } = lens;
    problems.check(at, &keys::APERTURE_RADIUS, radius);
    problems.check(at, &keys::FOCUS_DISTANCE, focus_distance);
    let focus = problems.0.last_mut().filter(|last| last.path == at.key("focus_distance"));
    focus.map(|problem| {
        problem
            .with_related(at.key("focus_on"))
            .with_related(at.key("look_at"))
            .with_related(at.key("position"))
    });
    problems.check(at, &keys::BLADES, blades);
    problems.check(at, &keys::ROTATION, rotation_degrees);
    if matches!(blades, 1 | 2) {
        let message = format!("`camera.blades` must be 0 for a disk, or at least 3, not {blades}");
        problems.add(at.key("blades"), message);
    }
}

/// Checks that the view direction and `up` are defined and not parallel.
fn check_axes(at: &KeyPath, camera: &CameraDescription, problems: &mut ValidationErrors) {
    // A fitted camera that looks along `up` takes another direction for it.
    let view = match camera.fit {
        Some(_) => {
            Some(normalize_robust(camera.up).map_or(DVec3::X, DVec3::any_orthonormal_vector))
        }
        None => normalize_robust(camera.look_at - camera.position),
    };
    let up = normalize_robust(camera.up);
    let problem = match (view, up) {
        (None, _) => {
            problems.add(at.key("look_at"), "`camera.look_at` must not be `camera.position`")
        }
        (_, None) => problems.add(at.key("up"), "`camera.up` must not be [0, 0, 0]"),
        (Some(view), Some(up)) if view.cross(up).length() < MIN_VIEW_UP_SINE => {
            let other = if view.y.abs() < 0.5 { "[0, 1, 0]" } else { "[0, 0, 1]" };
            let key = if camera.up == CameraDescription::default().up { "look_at" } else { "up" };
            problems
                .add(at.key(key), "`camera.up` must not be parallel to the view")
                .with_help(format!("use another direction, such as `up = {other}`"))
        }
        _ => return,
    };
    ["position", "look_at", "up"].into_iter().for_each(|key| {
        problem.with_related(at.key(key));
    });
}
