use std::f64::consts::{FRAC_PI_2, PI, TAU};

use approx::assert_relative_eq;

use super::*;
use crate::sampling::Sampler;

const PINHOLE: CameraModel = CameraModel::Perspective { vertical_fov: FRAC_PI_2, lens: None };

fn camera(model: CameraModel, near: f64) -> Camera {
    let pose = CameraPose {
        position: DVec3::new(0.0, 0.0, 5.0),
        view_direction: DVec3::new(0.0, 0.0, -2.0),
        up: DVec3::Y,
        near,
        resolution: [200, 100],
    };
    Camera::new(&pose, model)
}

fn thin_lens(radius: f64, focus_distance: f64) -> CameraModel {
    let aperture = Aperture { radius, blades: 0, rotation: 0.0 };
    let lens = Some(ThinLens { aperture, focus_distance });
    CameraModel::Perspective { vertical_fov: FRAC_PI_2, lens }
}

const EVERY: [CameraModel; 4] = [
    PINHOLE,
    CameraModel::Orthographic { height: 3.0 },
    CameraModel::Panoramic { horizontal: TAU, vertical: PI },
    CameraModel::Perspective {
        vertical_fov: 1.0,
        lens: Some(ThinLens {
            aperture: Aperture { radius: 0.5, blades: 5, rotation: 0.1 },
            focus_distance: 3.0,
        }),
    },
];

#[test]
fn the_middle_of_the_picture_is_the_view_axis_and_the_corners_are_symmetric() {
    let pinhole = camera(PINHOLE, 0.0);
    assert_eq!(pinhole.generate_ray(100.0, 50.0, [0.9; 2]).direction, -DVec3::Z);
    let corner = pinhole.generate_ray(200.0, 0.0, [0.0; 2]).direction;
    assert_relative_eq!(corner.x / -corner.z, 2.0, max_relative = 1e-12);
    assert_relative_eq!(corner.y / -corner.z, 1.0, max_relative = 1e-12);
}

#[test]
fn near_is_a_depth_along_the_axis_and_no_start_is_farther_than_stated() {
    for model in EVERY {
        for near in [0.0, 2.0] {
            let camera = camera(model, near);
            let margin = 3.0;
            let reach = camera.max_start_distance(margin) * (1.0 + 1e-12);
            for i in 0..1000 {
                let sampler = Sampler::independent(1, i, 0);
                let x = -3.0 + 206.0 * sampler.get(0);
                let y = -3.0 + 106.0 * sampler.get(1);
                let ray = camera.generate_ray(x, y, sampler.get_2d(2));
                let from = ray.at(ray.t_min) - camera.position();
                let depth = match model {
                    CameraModel::Panoramic { .. } => from.length(),
                    _ => -from.z,
                };
                assert_relative_eq!(depth, near, epsilon = 1e-12);
                assert_relative_eq!(ray.direction.length(), 1.0, max_relative = 1e-15);
                assert!(from.length() <= reach && ray.t_min <= reach);
                let origin = (ray.origin - camera.position()).length();
                assert!(origin <= camera.max_origin_distance(margin) * (1.0 + 1e-12));
                // Small spheres around the ray's start are among those that it may start inside.
                let sphere = Sphere { center: ray.at(ray.t_min), radius: 1e-9 };
                assert!(camera.may_start_inside(&sphere, margin));
            }
            let far = Sphere { center: DVec3::new(0.0, 0.0, -90.0), radius: 1.0 };
            assert!(!camera.may_start_inside(&far, margin));
        }
    }
}

#[test]
fn a_sphere_in_which_all_rays_must_start_contains_the_start_of_each() {
    let margin = 3.0;
    for model in EVERY {
        for near in [0.0, 2.0] {
            let camera = camera(model, near);
            let starts: Vec<DVec3> = (0..1000)
                .map(|i| {
                    let sampler = Sampler::independent(1, i, 0);
                    // Also at the corners.
                    let place = |u: f64| (1.2 * u - 0.1).clamp(0.0, 1.0);
                    let x = -3.0 + 206.0 * place(sampler.get(0));
                    let y = -3.0 + 106.0 * place(sampler.get(1));
                    let ray = camera.generate_ray(x, y, sampler.get_2d(2));
                    ray.at(ray.t_min)
                })
                .collect();
            for center in [DVec3::new(0.0, 0.0, 4.0), DVec3::new(-40.0, 7.0, 1.0)] {
                let farthest =
                    starts.iter().map(|start| start.distance(center)).fold(0.0, f64::max);
                let holds = |radius| camera.must_start_inside(&Sphere { center, radius }, margin);
                assert!(!holds(farthest * (1.0 - 1e-9)), "{model:?} {near}");
                // A lens and a panorama are bounded by a ball around each start.
                assert!(holds(farthest + 1.2), "{model:?} {near}");
                let is_exact =
                    model == PINHOLE || matches!(model, CameraModel::Orthographic { .. });
                assert!(!is_exact || holds(farthest * (1.0 + 1e-9) + 1e-9), "{model:?} {near}");
            }
        }
    }
}

#[test]
fn rays_through_a_lens_meet_where_it_is_focused() {
    let (sharp, pinhole) = (camera(thin_lens(0.7, 4.0), 0.0), camera(PINHOLE, 0.0));
    for (x, y) in [(100.0, 50.0), (0.0, 0.0), (13.0, 87.0)] {
        let axis = pinhole.generate_ray(x, y, [0.0; 2]);
        let focus = axis.at(4.0 / -axis.direction.z);
        for lens in [[0.1, 0.2], [0.5, 0.5], [0.99, 0.3]] {
            let ray = sharp.generate_ray(x, y, lens);
            let at = ray.at(4.0 / -ray.direction.z);
            assert!((at - focus).length() < 1e-12, "{at} {focus}");
            assert_eq!(ray.origin.z, 5.0);
        }
    }
    // The centre of the aperture is the pinhole.
    assert_eq!(
        sharp.generate_ray(13.0, 87.0, [0.5; 2]).direction,
        pinhole.generate_ray(13.0, 87.0, [0.0; 2]).direction
    );
}

#[test]
fn a_lens_that_closes_becomes_the_pinhole() {
    let pinhole = camera(PINHOLE, 0.5).generate_ray(31.0, 77.0, [0.0; 2]);
    for radius in [1e-3, 1e-6, 1e-9] {
        let ray = camera(thin_lens(radius, 2.0), 0.5).generate_ray(31.0, 77.0, [0.93, 0.12]);
        assert!((ray.direction - pinhole.direction).length() < radius);
        assert!((ray.origin - pinhole.origin).length() <= radius);
    }
}

#[test]
fn parallel_rays_keep_their_distance() {
    let camera = camera(CameraModel::Orthographic { height: 4.0 }, 1.0);
    let ray = camera.generate_ray(200.0, 0.0, [0.3; 2]);
    assert_eq!((ray.origin, ray.direction), (DVec3::new(4.0, 2.0, 5.0), -DVec3::Z));
    assert_eq!(ray.t_min, 1.0);
}

#[test]
fn a_panorama_looks_everywhere() {
    let whole = camera(CameraModel::Panoramic { horizontal: TAU, vertical: PI }, 0.0);
    let direction = |x, y| whole.generate_ray(x, y, [0.0; 2]).direction;
    for (x, y, expected) in [
        (100.0, 50.0, -DVec3::Z),
        (150.0, 50.0, DVec3::X),
        (50.0, 50.0, -DVec3::X),
        (0.0, 50.0, DVec3::Z),
        (200.0, 50.0, DVec3::Z),
        (77.0, 0.0, DVec3::Y),
        (77.0, 100.0, -DVec3::Y),
    ] {
        assert!((direction(x, y) - expected).length() < 1e-15, "{x} {y}");
    }
    // Past the pole the picture continues on the other side.
    let over = direction(60.0, -7.0) - direction(160.0, 7.0);
    assert!(over.length() < 1e-14, "{over}");
}
