//! How far the colours of particles in a picture are from those of the colour bar.

use crate::accel::Accel;
use crate::color::{Rgb, ViewTransform, ciede2000, linear_from_srgb};
use crate::film::FilmFrame;
use crate::image_io::Picture;
use crate::math::Hit;
use crate::scene::data::SphereData;
use crate::scene::{PreparedScene, Scene};

/// Pixels that are looked at, at most.
const MAX_PIXELS: usize = 10_000;

/// How far the colours of particles in a picture are from those of the colour bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorDifference {
    /// Median CIEDE2000 between pixels of a picture as shown on a screen and the colours of the
    /// particles in their centres. About 1 is just noticeable.
    pub median: f64,
    /// True if most of these particles are smaller than a pixel, which then mixes the colours of
    /// several.
    pub is_of_mixtures: bool,
}

/// The difference; `None` if none of the pixels that are looked at shows a particle of a file.
pub(super) fn median_difference(
    prepared: &PreparedScene,
    accel: &dyn Accel,
    frame: &FilmFrame,
    picture: &Picture,
    look: &ViewTransform,
) -> Option<ColorDifference> {
    let window = frame.window;
    // A prime step visits all columns and rows.
    let step = (window.pixel_count() / MAX_PIXELS) | 1;
    let difference = |pixel: usize| {
        let (x, y) = (pixel as u32 % window.width, pixel as u32 / window.width);
        let (id, pixels) = first_sphere(prepared, accel, [window.x + x, window.y + y])?;
        let meant = bar_color(prepared.scene(), id)?;
        let shown = look.to_display(picture.finite_beauty(pixel)).map(linear_from_srgb);
        Some((ciede2000(Rgb::from_array(shown), meant), pixels < 1.0))
    };
    let (mut all, are_small): (Vec<f64>, Vec<bool>) =
        (0..window.pixel_count()).step_by(step).filter_map(difference).unzip();
    all.sort_by(f64::total_cmp);
    let small = are_small.iter().filter(|is_small| **is_small).count();
    let median = all.get(all.len() / 2).copied()?;
    Some(ColorDifference { median, is_of_mixtures: 2 * small > all.len() })
}

/// The sphere in the centre of a pixel, and its diameter in pixels.
fn first_sphere(
    prepared: &PreparedScene,
    accel: &dyn Accel,
    pixel: [u32; 2],
) -> Option<(u32, f64)> {
    let [x, y] = pixel.map(|pixel| f64::from(pixel) + 0.5);
    let ray = prepared.camera().generate_ray(x, y, [0.5; 2]);
    let spheres = prepared.scene().spheres();
    let mut hit = [Hit::MISS];
    accel.closest(&[spheres.to_query(&ray)], &mut hit);
    let hit = spheres.resolve_hit(&ray, hit[0])?;
    let next = prepared.camera().generate_ray(x + 1.0, y, [0.5; 2]);
    let pixel = (next.origin - ray.origin + hit.t * (next.direction - ray.direction)).length();
    Some((hit.id, 2.0 * hit.radius / pixel))
}

/// The colour that a colour bar shows for a sphere; `None` if it is no particle.
fn bar_color(scene: &Scene, id: u32) -> Option<Rgb> {
    let (table, _) = scene.table_and_row(scene.spheres().row(id))?;
    let SphereData::Particles(particles) = &scene.description().tables[table].data else {
        return None;
    };
    let look = &particles.appearance;
    let sphere = scene.sphere_material(id);
    match look.shade > 0.0 {
        true => Some(sphere.albedo? / look.shade as f32),
        false => Some(sphere.material.emission / look.glow as f32),
    }
}
