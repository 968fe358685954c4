//! Recording of each sample's first visible surface, for AOVs.
//!
//! The record uses the hits and random decisions of the radiance estimate and does not affect it.

use crate::color::{Rgb, VisibleSurface};
use crate::geometry::SurfaceHit;
use crate::scene::Scene;

/// Records the first surface that a camera ray hits.
pub(super) fn record_surface(record: &mut VisibleSurface, scene: &Scene, hit: &SurfaceHit) {
    let surface = scene.sphere_material(hit.id);
    *record = VisibleSurface {
        emission: record.emission,
        albedo: surface.material.base_color(surface.albedo),
        normal: hit.facing_normal().as_vec3(),
        // Includes the segments in front of surfaces that the ray passed straight through.
        distance: record.distance + hit.t as f32,
        position: (hit.point + scene.spheres().origin()).as_vec3(),
        row: scene.spheres().row(hit.id),
    };
}

/// Adds directly visible emission.
pub(super) fn add_emission(record: &mut VisibleSurface, light: Rgb) {
    record.emission += light;
}
