//! A ball under many emitters, read from the sphere table next to the scene.

use std::f64::consts::PI;

use crate::geometry::Sphere;
use crate::math::DVec3;
use crate::scene::PreparedScene;
use crate::verify::closed_forms::reference_image::{normal, pixel_means, rays, spheres};
use crate::verify::closed_forms::sphere_light::SubtendedCap;

use super::{albedo, emission};

/// Sphere table with rows of x, y, z and radius.
pub(super) const LIGHT_TABLE: &[u8] = include_bytes!("../../../../scenes/verify/many-lamps.f32");

pub(super) fn many_lights(prepared: &PreparedScene, nodes: usize) -> Vec<Option<f64>> {
    let ball = spheres(prepared)[0];
    let emitters = emitters();
    let scale = albedo(prepared, "ball") * emission(prepared, "lamp") / PI;
    pixel_means(prepared, nodes, rays(prepared), |ray| {
        let point = ray.at(ray.hit_distance(&ball)?);
        let n = normal(&ball, point);
        let irradiance: f64 =
            emitters.iter().map(|emitter| SubtendedCap::new(emitter, point, n).irradiance()).sum();
        Some((0, scale * irradiance))
    })
}

fn emitters() -> Vec<Sphere> {
    let number = |bytes: &[u8]| {
        f64::from(f32::from_le_bytes(bytes.try_into().expect("the table has whole numbers")))
    };
    let emitter = |row: &[u8]| {
        let [x, y, z, radius] = [0, 4, 8, 12].map(|at| number(&row[at..at + 4]));
        Sphere { center: DVec3::new(x, y, z), radius }
    };
    LIGHT_TABLE.chunks_exact(16).map(emitter).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_what_the_scene_says_and_no_emitter_hides_another() {
        let emitters = emitters();
        assert_eq!(emitters.len(), 3000);
        for (i, emitter) in emitters.iter().enumerate() {
            let y = 1.0 - (2.0 * i as f64 + 1.0) / 3000.0;
            let angle = i as f64 * PI * (3.0 - 5f64.sqrt());
            let (x, z) = (angle.cos() * (1.0 - y * y).sqrt(), angle.sin() * (1.0 - y * y).sqrt());
            let expected = DVec3::new(x, y, z) * 10.0;
            assert!(emitter.center.distance(expected) < 1e-5);
            assert!((emitter.radius - (0.05 + 0.0375 * (1.0 + x) * (1.0 + y))).abs() < 1e-6);
        }
        // From anywhere on the ball, the directions to two emitters differ by more than their
        // angular radii: they are at least 9 away, and moving the viewpoint by 1 turns neighbours
        // alike.
        for (i, a) in emitters.iter().enumerate() {
            for b in &emitters[..i] {
                let apart = a.center.distance(b.center);
                assert!(apart > 1.3 * (a.radius + b.radius), "{apart} {} {}", a.radius, b.radius);
            }
        }
    }
}
