//! Describes what a path's events refer to, in the user's terms.

use crate::color::Rgb;
use crate::integrator::{Contribution, PathEvent};
use crate::light::LightSource;
use crate::light::specular::SpecularPath;
use crate::math::DVec3;
use crate::scene::Scene;

/// Name of a sphere in the scene, or its place there.
pub(super) fn name(scene: &Scene, id: u32) -> String {
    format!("`{}`", scene.name_of_row(scene.spheres().row(id)))
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

/// Result of the light sample (0) or connection with this `number` at event `index`: the
/// transmitted fraction and the contribution. `None` if no ray could be spawned.
pub(super) fn shadow_result(
    events: &[PathEvent],
    index: usize,
    number: u8,
) -> Option<(Rgb, Contribution)> {
    // Shadow rays are traced after the path has been scattered, before its next hit.
    let later = events[index + 1..].iter();
    let at_vertex = later.take_while(|event| !matches!(event, PathEvent::Hit { .. }));
    at_vertex.into_iter().find_map(|event| match event {
        PathEvent::ShadowRay { connection, visibility, contribution } if *connection == number => {
            Some((*visibility, *contribution))
        }
        _ => None,
    })
}

/// Describes the way of a connection over a ball.
pub(super) fn way_over_ball(kind: SpecularPath) -> &'static str {
    match kind {
        SpecularPath::Reflection => "reflected off",
        SpecularPath::Through => "through",
        SpecularPath::ThroughReflected => "through, with a reflection inside,",
        SpecularPath::Outward => "out of",
        SpecularPath::Inward => "into",
    }
}
