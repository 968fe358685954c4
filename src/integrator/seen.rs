//! The record of what each sample sees first.
//!
//! It is written beside the estimate, from the same hits and the same random decisions, and changes
//! nothing of it.

use crate::color::{Rgb, Seen};
use crate::geometry::SurfaceHit;
use crate::scene::Scene;

/// Notes the surface that a camera ray meets first, from its start at the camera.
pub(super) fn note(seen: &mut Seen, scene: &Scene, hit: &SurfaceHit) {
    let surface = scene.surface(hit.id);
    *seen = Seen {
        emission: seen.emission,
        albedo: surface.material.base_color(surface.albedo),
        normal: hit.facing_normal().as_vec3(),
        // After what it went straight through.
        distance: seen.distance + hit.t as f32,
        position: (hit.point + scene.spheres().origin()).as_vec3(),
        row: scene.spheres().row(hit.id),
    };
}

/// Notes light that the camera sees straight.
pub(super) fn add_emission(seen: &mut Seen, light: Rgb) {
    seen.emission += light;
}
