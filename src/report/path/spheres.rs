//! Describes what a path's events refer to, in the user's terms.

use crate::color::Rgb;
use crate::integrator::{Contribution, PathEvent};
use crate::light::LightSource;
use crate::math::DVec3;
use crate::scene::Scene;

/// Name of a sphere in the scene, or its row.
pub(super) fn name(scene: &Scene, id: u32) -> String {
    match scene.name(id) {
        Some(name) => format!("`{name}`"),
        None => format!("sphere {}", scene.spheres().row(id)),
    }
}

pub(super) fn source_name(scene: &Scene, source: LightSource) -> String {
    match source {
        LightSource::Emitter(id) => name(scene, id),
        LightSource::FarWall(id) => format!("the far wall of {}", name(scene, id)),
        LightSource::Environment => "the background".to_owned(),
    }
}

/// Converts a point to the coordinates of the scene file.
pub(super) fn to_scene(scene: &Scene, point: DVec3) -> DVec3 {
    point + scene.spheres().origin()
}

/// Result of the light sample at event `light_sample`: the transmitted fraction and the
/// contribution. `None` if no ray could be spawned.
pub(super) fn shadow_result(
    events: &[PathEvent],
    light_sample: usize,
) -> Option<(Rgb, Contribution)> {
    let later = &events[light_sample + 1..];
    let before_next =
        later.iter().take_while(|event| !matches!(event, PathEvent::LightSample { .. }));
    before_next.into_iter().find_map(|event| match event {
        PathEvent::ShadowRay { visibility, contribution } => Some((*visibility, *contribution)),
        _ => None,
    })
}
