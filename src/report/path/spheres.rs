//! What a path's steps refer to, in the user's terms.

use crate::integrator::{Contribution, PathEvent};
use crate::light::LightSource;
use crate::math::DVec3;
use crate::scene::Scene;

/// What the scene calls a sphere, or its row.
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

/// A point in the coordinates that the user wrote.
pub(super) fn place(scene: &Scene, point: DVec3) -> DVec3 {
    point + scene.spheres().origin()
}

/// The answer to the light sample that is step number `aim`: the share that passes, and the light.
/// `None` where no ray could be sent.
pub(super) fn answer(steps: &[PathEvent], aim: usize) -> Option<(f32, Contribution)> {
    let after = &steps[aim + 1..];
    let until_next = after.iter().take_while(|step| !matches!(step, PathEvent::LightSample { .. }));
    until_next.into_iter().find_map(|step| match step {
        PathEvent::ShadowRay { visibility: passed, contribution: added } => Some((*passed, *added)),
        _ => None,
    })
}
