//! The record of what each sample sees first.
//!
//! It is written beside the estimate, from the same hits and the same random decisions, and changes
//! nothing of it.

use crate::color::{Rgb, VisibleSurface};
use crate::geometry::SurfaceHit;
use crate::scene::Scene;

/// Notes the surface that a camera ray meets first, from its start at the camera.
pub(super) fn record_surface(seen: &mut VisibleSurface, scene: &Scene, hit: &SurfaceHit) {
    let surface = scene.sphere_material(hit.id);
    *seen = VisibleSurface {
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
pub(super) fn add_emission(seen: &mut VisibleSurface, light: Rgb) {
    seen.emission += light;
}
