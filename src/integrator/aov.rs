//! Recording of each sample's first visible surface, for AOVs.
//!
//! The record uses the hits and random decisions of the radiance estimate and does not affect it.

use crate::color::{Rgb, VisibleSurface};
use crate::geometry::SurfaceHit;
use crate::math::Vec3;
use crate::scene::Scene;

/// Records the first surface that a camera ray hits.
pub(super) fn record_surface(record: &mut VisibleSurface, scene: &Scene, hit: &SurfaceHit) {
    let (albedo, normal) = color_and_normal(scene, hit);
    *record = VisibleSurface {
        emission: record.emission,
        albedo,
        normal,
        // Includes the segments in front of surfaces that the ray passed straight through.
        distance: record.distance + hit.t as f32,
        position: (hit.point + scene.spheres().origin()).as_vec3(),
        row: scene.spheres().row(hit.id),
        denoising_albedo: albedo,
        denoising_normal: normal,
        sees_through: false,
    };
}

/// Records a surface that is seen in mirrors or through glass, which take a part of its colour.
pub(super) fn record_surface_behind(
    record: &mut VisibleSurface,
    scene: &Scene,
    hit: &SurfaceHit,
    throughput: Rgb,
) {
    let (albedo, normal) = color_and_normal(scene, hit);
    record.denoising_albedo = (throughput * albedo).clamp(Rgb::ZERO, Rgb::ONE);
    record.denoising_normal = normal;
}

fn color_and_normal(scene: &Scene, hit: &SurfaceHit) -> (Rgb, Vec3) {
    let surface = scene.sphere_material(hit.id);
    (surface.material.base_color(surface.albedo), hit.facing_normal().as_vec3())
}

/// Adds directly visible emission.
pub(super) fn add_emission(record: &mut VisibleSurface, light: Rgb) {
    record.emission += light;
}
