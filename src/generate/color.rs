//! Harmonious colors: a smooth function of position, with a small random variation per sphere.

use crate::math::DVec3;

use super::arrangement::Arrangement;
use super::placement::PlacedSphere;
use super::rng::IndexedRng;

/// Linear albedo in `[0.02, 0.87]`.
pub(super) fn albedo(
    arrangement: Arrangement,
    placed: &PlacedSphere,
    numbers: &mut IndexedRng,
) -> [f32; 3] {
    let jitter = numbers.uniform_in(-0.5, 0.5);
    let color = match arrangement {
        Arrangement::Gas => {
            palette(0.42 + 0.4 * placed.center.dot(DVec3::new(0.5, 0.9, 0.3)) + 0.12 * jitter)
        }
        Arrangement::Packed => palette(0.45 + 0.22 * gyroid(placed.center * 9.0) + 0.15 * jitter),
        Arrangement::Clusters => palette(placed.hue + 0.1 * jitter),
        // The cube of colours, pale, so that the eye finds rest.
        Arrangement::Lattice => (placed.center + 0.5).lerp(DVec3::new(0.62, 0.6, 0.56), 0.55),
    };
    (0.02 + 0.85 * color.clamp(DVec3::ZERO, DVec3::ONE)).as_vec3().to_array()
}

/// Night, sea, sand, ember and wine, as linear albedo. The palette is cyclic.
const PALETTE: [[f64; 3]; 5] = [
    [0.015, 0.05, 0.18],
    [0.03, 0.3, 0.38],
    [0.82, 0.66, 0.36],
    [0.85, 0.26, 0.08],
    [0.32, 0.03, 0.09],
];

/// Interpolates the cyclic palette; `t` has period 1.
fn palette(t: f64) -> DVec3 {
    let at = (t - t.floor()) * PALETTE.len() as f64;
    let color = |i: usize| DVec3::from_array(PALETTE[i % PALETTE.len()]);
    color(at as usize).lerp(color(at as usize + 1), at.fract())
}

/// A gyroid: a smooth function in [-1.5, 1.5] whose zero set is close to a minimal surface.
fn gyroid(at: DVec3) -> f64 {
    let ([sx, cx], [sy, cy], [sz, cz]) = (wave(at.x), wave(at.y), wave(at.z));
    sx * cy + sy * cz + sz * cx
}

fn wave(angle: f64) -> [f64; 2] {
    [libm::sin(angle), libm::cos(angle)]
}
