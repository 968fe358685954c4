//! Describes what a path's events refer to, in the user's terms.

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
        LightSource::Environment => "the background".to_owned(),
    }
}

/// Converts a point to the coordinates of the scene file.
pub(super) fn place(scene: &Scene, point: DVec3) -> DVec3 {
    point + scene.spheres().origin()
}

/// Result of the light sample at event `light`: the unoccluded fraction and the contribution.
/// `None` if no ray could be spawned.
pub(super) fn answer(steps: &[PathEvent], light: usize) -> Option<(f32, Contribution)> {
    let after = &steps[light + 1..];
    let until_next = after.iter().take_while(|step| !matches!(step, PathEvent::LightSample { .. }));
    until_next.into_iter().find_map(|step| match step {
        PathEvent::ShadowRay { visibility: passed, contribution: added } => Some((*passed, *added)),
        _ => None,
    })
}
