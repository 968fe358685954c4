//! Emitters of which a wall hides a part, and emitters with a far wall: light is sampled where it
//! can be seen, with the mean that it has when it is found by chance.

use photosphere::accel::Backend;
use photosphere::color::Rgb;
use photosphere::scene::description::{MaterialDescription, SurfaceModel};
use photosphere::scene::settings::Estimator;

use crate::kit::{Judged, Kit, SEEDS, diffuse, mirror};

/// Looks at a grey ball on the ground.
fn ball() -> Kit {
    let mut kit = Kit::new(8, 8, 64).depth(3);
    kit.scene.camera([0.0, 1.5, 4.0], [0.0, 0.5, 0.0]).field_of_view(40.0);
    kit.ball([0.0, -100.0, 0.0], 100.0, diffuse(0.6));
    kit.ball([-0.5, 0.4, 0.5], 0.4, diffuse(0.8));
    kit
}

fn translucent(kit: &mut Kit, center: [f64; 3], radius: f64, opacity: f64) {
    let surface = SurfaceModel::Diffuse { albedo: Rgb::ZERO, roughness: 0.0 };
    let emission = Rgb::splat(5.0);
    let emitter = kit.scene.material(MaterialDescription {
        surface,
        emission,
        opacity,
        ..Default::default()
    });
    kit.scene.sphere(emitter, center, radius);
}

type Change = (&'static str, fn(&mut Kit));

/// Below a ball, in rooms, in one another, and in an emissive wall.
const SCENES: [Change; 8] = [
    ("out of a ball", |kit| {
        kit.ball([0.0, 4.5, 0.0], 3.0, diffuse(0.5));
        kit.glowing_ball([0.0, 1.9, 0.0], 1.0, diffuse(0.3), 5.0);
    }),
    ("into a room", |kit| {
        kit.ball([0.0; 3], 6.0, mirror(0.5));
        kit.glowing_ball([0.0, 8.0, 1.0], 2.8, diffuse(0.3), 5.0);
    }),
    ("into a room that is smaller", |kit| {
        kit.ball([0.0; 3], 6.0, mirror(0.5));
        kit.glowing_ball([0.0, 14.0, 1.0], 8.6, diffuse(0.3), 5.0);
    }),
    ("around a part of a room", |kit| {
        kit.ball([0.0, 0.5, 2.0], 3.0, diffuse(0.5));
        kit.glowing_ball([0.0, 5.5, -1.0], 5.0, diffuse(0.3), 1.0);
        kit.glowing_ball([0.5, 1.0, 1.5], 0.1, diffuse(0.3), 50.0);
    }),
    ("in one another", |kit| {
        kit.glowing_ball([0.0, 2.0, 0.0], 0.7, diffuse(0.3), 5.0);
        kit.glowing_ball([0.0, 2.6, 0.0], 0.7, diffuse(0.3), 2.0);
    }),
    ("out of an emissive ball", |kit| {
        kit.glowing_ball([1.0, 3.5, 0.0], 2.0, diffuse(0.5), 0.5);
        kit.glowing_ball([0.5, 1.8, 0.0], 0.5, diffuse(0.3), 5.0);
    }),
    ("out of the ground", |kit| {
        kit.glowing_ball([0.6, -0.4, 0.4], 0.6, diffuse(0.3), 5.0);
    }),
    ("translucent, out of a ball", |kit| {
        kit.ball([0.0, 4.5, 0.0], 3.0, diffuse(0.5));
        translucent(kit, [0.0, 1.9, 0.0], 1.0, 0.4);
    }),
];

#[test]
fn the_exposed_part_shines_like_by_chance() {
    for (name, change) in SCENES {
        let kit = ball().with(change);
        let by = |estimator| {
            let samples = if estimator == Estimator::Bsdf { 512 } else { 64 };
            let kit = kit.clone().samples(samples);
            kit.with(|kit| kit.settings.render.estimator = estimator).mean()
        };
        let by_chance = by(Estimator::Bsdf);
        for estimator in [Estimator::Light, Estimator::Mis] {
            by(estimator).must_agree(by_chance, &format!("{name}, {estimator:?}"));
        }
    }
}

/// Variance of one sample of light at a point of the ground, relative to the squared mean.
fn relative_variance(change: fn(&mut Kit)) -> f64 {
    let samples = 16;
    let mut kit = Kit::new(1, 1, samples).depth(2);
    kit.scene.camera([0.0, 0.3, 1.0], [0.0; 3]).field_of_view(0.01);
    kit.ball([0.0, -1e5, 0.0], 1e5, diffuse(0.6));
    change(&mut kit);
    let mean = kit.estimate(Backend::BruteForce);
    let relative = mean.standard_error / mean.mean;
    relative * relative * SEEDS as f64 * f64::from(samples)
}

/// Sampled as a whole, nine tenths of the directions to these emitters would be occluded, and the
/// relative variance would be at least 9.
#[test]
fn hidden_parts_cost_no_samples() {
    let room: fn(&mut Kit) = |kit| {
        kit.ball([0.0, -1e5 + 8.0, 0.0], 1e5, diffuse(0.0));
        kit.glowing_ball([0.0, 607.7, 0.0], 600.0, diffuse(0.0), 5.0);
    };
    let shelf: fn(&mut Kit) = |kit| {
        kit.ball([0.0, 25.0, 0.0], 20.0, diffuse(0.0));
        kit.glowing_ball([0.0, 6.8, 0.0], 2.0, diffuse(0.0), 5.0);
    };
    let small_room: fn(&mut Kit) = |kit| {
        kit.ball([0.0, 4.0, 0.0], 6.0, diffuse(0.0));
        kit.glowing_ball([0.0, 609.7, 0.0], 600.0, diffuse(0.0), 5.0);
    };
    for (name, change) in [("room", room), ("shelf", shelf), ("small room", small_room)] {
        let variance = relative_variance(change);
        assert!(variance < 0.3, "{name}: {variance}");
    }
}

/// Two emitters of equal irradiance, one of which sticks out of the ceiling by a few millionths of
/// its radius. Chosen by the power of its whole surface, it would get nearly all samples, and the
/// relative variance would be about 3.
#[test]
fn a_cut_emitter_is_chosen_for_the_part_that_is_seen() {
    let variance = relative_variance(|kit| {
        kit.ball([0.0, -1e5 + 8.0, 0.0], 1e5, diffuse(0.0));
        kit.glowing_ball([0.0, 607.998, 0.0], 600.0, diffuse(0.0), 5.0);
        kit.glowing_ball([20.0, 6.0, 0.0], 1.0, diffuse(0.0), 300.0);
    });
    assert!(variance < 0.5, "{variance}");
}

/// Found by chance, the light of the far wall would have a relative variance of at least 4.
#[test]
fn the_far_wall_is_sampled() {
    let translucent: fn(&mut Kit) = |kit| translucent(kit, [0.0, 3.0, 0.0], 0.5, 0.5);
    let fog: fn(&mut Kit) = |kit| {
        let absorption = Rgb::splat(0.5);
        let surface =
            SurfaceModel::Dielectric { ior: 1.0, roughness: 0.0, priority: 0, absorption };
        kit.glowing_ball([0.0, 3.0, 0.0], 0.5, surface, 5.0);
    };
    for (name, change) in [("translucent", translucent), ("fog", fog)] {
        let variance = relative_variance(change);
        assert!(variance < 0.05, "{name}: {variance}");
    }
}

/// From the ground near an emitter that sticks out of it. Near the rim, `1 / t^2` of samples of the
/// cap's area has no bound; found by chance, the light has a relative variance of 4 to 43.
#[test]
#[allow(clippy::print_stdout, reason = "the figures are worth reading with --nocapture")]
fn the_variance_is_bounded_near_the_rim() {
    for (name, roughness) in [("Lambertian", 0.0), ("Oren-Nayar", 0.5)] {
        for distance in [1e-3, 1e-2, 0.1, 1.0] {
            let mut kit = Kit::new(1, 1, 16).depth(2);
            // The rim has the radius 0.6.
            let x = 0.6 + distance;
            kit.scene.camera([x, 0.3, 1.0], [x, 0.0, 0.0]).field_of_view(1e-6);
            let albedo = Rgb::splat(0.6);
            kit.ball([0.0, -1e5, 0.0], 1e5, SurfaceModel::Diffuse { albedo, roughness });
            kit.glowing_ball([0.0, -0.8, 0.0], 1.0, diffuse(0.0), 5.0);
            let mean = kit.estimate(Backend::BruteForce);
            let relative = mean.standard_error / mean.mean;
            let variance = relative * relative * SEEDS as f64 * 16.0;
            println!("{name}, {distance}: {variance:.2e}");
            let is_exact = roughness == 0.0 && distance < 1.0;
            assert!(variance < if is_exact { 1e-9 } else { 6.0 }, "{name}, {distance}: {variance}");
        }
    }
}

/// From a Lambertian surface under one emitter, every sample of unoccluded light is the same:
/// albedo times radiance times projected solid angle over pi. Above the horizon, through it, and
/// with the centre below it.
#[test]
fn light_from_one_emitter_has_no_variance() {
    for center in [[0.5, 3.0, 0.0], [4.0, 0.5, 0.0], [4.0, -0.4, 0.0]] {
        for roughness in [0.0, 0.5] {
            let mut kit = Kit::new(1, 1, 1).depth(2);
            kit.scene.camera([0.0, 0.3, 1.0], [0.0; 3]).field_of_view(1e-7);
            let albedo = Rgb::splat(0.6);
            // The lens is inside the emitter's half of space; only this sphere is seen.
            kit.ball([0.0, -0.1, 0.0], 0.1, SurfaceModel::Diffuse { albedo, roughness });
            kit.glowing_ball(center, 1.0, diffuse(0.0), 5.0);
            let mean = kit.mean();
            let relative = mean.standard_error / mean.mean;
            assert_eq!(relative < 1e-6, roughness == 0.0, "{center:?}: {relative}");
            assert!(mean.mean > 1e-3);
        }
    }
}
