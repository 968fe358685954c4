//! Recording of each sample's first visible surface, for AOVs.
//!
//! The record uses the hits and random decisions of the radiance estimate and does not affect it.

use crate::color::{Rgb, VisibleSurface};
use crate::geometry::SurfaceHit;
use crate::scene::Scene;

/// Records the first surface that a camera ray hits.
pub(super) fn record_surface(seen: &mut VisibleSurface, scene: &Scene, hit: &SurfaceHit) {
    let surface = scene.sphere_material(hit.id);
    *seen = VisibleSurface {
        emission: seen.emission,
        albedo: surface.material.base_color(surface.albedo),
        normal: hit.facing_normal().as_vec3(),
        // Adds to the length of the segments already passed straight through.
        distance: seen.distance + hit.t as f32,
        position: (hit.point + scene.spheres().origin()).as_vec3(),
        row: scene.spheres().row(hit.id),
    };
}

/// Adds directly visible emission.
pub(super) fn add_emission(seen: &mut VisibleSurface, light: Rgb) {
    seen.emission += light;
}
