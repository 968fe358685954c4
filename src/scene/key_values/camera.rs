//! The keys of a camera.

use crate::appearance::ViewDirection;
use crate::scene::description::{
    CameraDescription, CameraFit, FocusTarget, LensDescription, ProjectionDescription,
    SceneDescription,
};
use crate::scene::keys::camera as keys;

use super::section::Section;

/// The keys of the camera of `scene`.
pub(super) fn of_camera(camera: &CameraDescription, scene: &SceneDescription) -> Section {
    let CameraDescription { position, look_at, up, near, projection, fit, focus_target } = camera;
    let mut section = Section::default();
    section.set(&keys::TYPE, projection.kind());
    match fit {
        Some(fit) => set_fit(fit, &mut section),
        None => {
            section.set(&keys::POSITION, position);
            section.set(&keys::LOOK_AT, look_at);
        }
    }
    section.set(&keys::UP, up);
    section.set(&keys::NEAR, near);
    match projection {
        ProjectionDescription::Perspective { vertical_fov_degrees, lens } => {
            section.set(&keys::perspective::FOV, vertical_fov_degrees);
            if let Some(LensDescription { radius, focus_distance, blades, rotation_degrees }) = lens
            {
                section.set(&keys::perspective::APERTURE_RADIUS, radius);
                match focus_target {
                    None => section.set(&keys::perspective::FOCUS_DISTANCE, focus_distance),
                    Some(target) => set_focus(target, scene, &mut section),
                }
                section.set(&keys::perspective::BLADES, blades);
                section.set(&keys::perspective::ROTATION, rotation_degrees);
            }
        }
        ProjectionDescription::Orthographic { height } => {
            section.set_if_given(&keys::orthographic::HEIGHT, fit.is_none().then_some(height));
        }
        ProjectionDescription::Panoramic { horizontal_degrees, vertical_degrees } => {
            section.set(&keys::panoramic::HORIZONTAL, horizontal_degrees);
            section.set(&keys::panoramic::VERTICAL, vertical_degrees);
        }
    }
    section
}

fn set_fit(fit: &CameraFit, section: &mut Section) {
    let CameraFit { direction, margin, right_margin } = fit;
    section.set(&keys::FIT, true);
    match direction {
        ViewDirection::Towards(vector) => section.set(&keys::DIRECTION, vector),
        named => section.set(&keys::DIRECTION, named.to_string()),
    }
    section.set(&keys::MARGIN, margin);
    section.set_if_given(&keys::RIGHT_MARGIN, right_margin.as_ref());
}

fn set_focus(target: &FocusTarget, scene: &SceneDescription, section: &mut Section) {
    use keys::perspective as keys;
    match *target {
        FocusTarget::Middle => {}
        FocusTarget::Pixel(x, y) => section.set(&keys::FOCUS_ON_PIXEL, [x, y]),
        FocusTarget::Sphere(index) => {
            let sphere = scene.spheres.get(index as usize);
            section.set_if_given(&keys::FOCUS_ON, sphere.and_then(|sphere| sphere.name.as_ref()));
        }
        FocusTarget::TableRow(table, row) => {
            let name = scene.name_of_table(table as usize);
            section.set(&keys::FOCUS_ON, format!("{name}:{row}"));
        }
    }
}
