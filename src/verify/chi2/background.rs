//! Sampling of the environment, and selection between it and many emitters.

use std::sync::Arc;

use crate::color::Rgb;
use crate::geometry::{Cone, Side, Sphere, SphereRows, SphereSet, SurfaceHit};
use crate::light::{
    Emitter, Environment, EnvironmentMap, LightSampleContext, LightSource, Lights, Orientation,
    Sky, SunLight,
};
use crate::math::{DVec3, Frame};
use crate::sampling::{Sampler, sin_cos};

use super::SamplingTest;

pub(super) fn tests() -> Vec<SamplingTest> {
    let mut tests = vec![
        environment_test("gradient", EnvironmentMap::gradient(grey(4.0), grey(1.0), grey(0.0))),
        environment_test("image", image()),
        environment_test("sky", sky().environment_map()),
        sun_test("sun", 0.533),
        sun_test("wide sun", 120.0),
        background_test("sky and sun beside emitters", false),
        background_test("sky and sun beside emitters, both sides", true),
    ];
    for (name, point, is_two_sided) in [
        ("among them", DVec3::splat(0.4), false),
        ("among them, both sides", DVec3::new(0.1, 0.7, 0.4), true),
        ("far from them", DVec3::new(3.0, -8.0, 1.0), false),
    ] {
        let context = context(point, is_two_sided);
        tests.push(selection_test(
            &format!("choice of 40 emitters, {name}"),
            Environment::default(),
            context,
        ));
        tests.push(selection_test(
            &format!("choice of 40 emitters and a sky, {name}"),
            sky_and_sun(),
            context,
        ));
    }
    tests
}

fn grey(radiance: f32) -> Rgb {
    Rgb::splat(radiance)
}

/// Irregular radiance, with dark areas and one pixel far brighter than the rest.
fn image() -> EnvironmentMap {
    let (width, height) = (14, 7);
    let pixel = |i: usize| match i {
        40 => Rgb::new(300.0, 200.0, 100.0),
        _ => grey(((i * 31) % 19).saturating_sub(6) as f32),
    };
    EnvironmentMap::from_image(width, height, &(0..width * height).map(pixel).collect::<Vec<_>>())
}

fn sky() -> Sky {
    let (sin, cos) = sin_cos(0.5);
    let sun = DVec3::new(0.6 * cos, sin, 0.8 * cos);
    Sky { turbidity: 3.0, sun, sun_irradiance: grey(300.0), ground: grey(0.3), scale: 1.0 }
}

/// Tilted off the vertical, so that nothing is axis-aligned.
fn sky_and_sun() -> Environment {
    let orientation = Orientation::new(DVec3::new(0.0, 0.8, 0.6), 0.3);
    let sun = orientation.direction(0.5, 1.0);
    Environment::new(
        EnvironmentMap::gradient(grey(5.0), grey(1.0), grey(0.5)),
        orientation,
        Some(SunLight::new(sun, 0.8, grey(4.0))),
    )
}

/// The environment map's zenith is the pole of the cells.
fn environment_test(name: &str, map: EnvironmentMap) -> SamplingTest {
    let map = Arc::new(map);
    let pdf_map = map.clone();
    SamplingTest::over_sphere(
        format!("background: {name}"),
        move |u| {
            let direction = map.sample([u[0], u[1]])?.direction;
            Some(DVec3::new(direction.x, -direction.z, direction.y))
        },
        move |w| pdf_map.pdf(DVec3::new(w.x, w.z, -w.y)),
    )
}

fn sun_test(name: &str, diameter_degrees: f64) -> SamplingTest {
    let diameter = diameter_degrees.to_radians();
    let direction = DVec3::new(0.48, 0.6, -0.64);
    let sun = SunLight::new(direction, diameter, Rgb::ONE);
    let frame = Frame::from_z(direction);
    SamplingTest::over_cap(
        format!("background: {name}"),
        0.5 * diameter,
        move |u| Some(frame.to_local(sun.sample([u[0], u[1]]))),
        move |w| sun.pdf(frame.to_world(w).normalize()),
    )
}

fn context(point: DVec3, is_two_sided: bool) -> LightSampleContext {
    let normal = DVec3::new(0.36, 0.8, 0.48);
    let hit = SurfaceHit { id: u32::MAX, t: 1.0, point, normal, radius: 1.0, side: Side::Outside };
    LightSampleContext { hit, is_two_sided, is_lambertian: false }
}

/// Emitters of many sizes and distances, none touching a shading point.
fn emitters(environment: Environment) -> (SphereSet, Lights) {
    let sphere = |i: u64| {
        let u: [f64; 4] = std::array::from_fn(|d| Sampler::independent(7, i, 0).get(d as u32));
        let center = DVec3::new(u[0], u[1], u[2]) * 2.0 - 0.5;
        Sphere { center, radius: 1e-3 + 0.05 * u[3] * u[3] }
    };
    let exact = (0..40).map(sphere).collect();
    let spheres = SphereSet::new(SphereRows { exact, table: Vec::new() }).expect("few spheres");
    let emission = |id| grey(1.0 + spheres.row(id) as f32);
    let emitter = |id: u32| Emitter::opaque(id, emission(id));
    let lights = Lights::new((0..40).map(emitter).collect(), &spheres, environment);
    (spheres, lights)
}

/// Sampling of a whole environment among emitters. Samples of the emitters are discarded.
fn background_test(name: &str, is_two_sided: bool) -> SamplingTest {
    let lit = Arc::new(emitters(sky_and_sun()));
    let pdf_lit = lit.clone();
    let context = context(DVec3::splat(0.4), is_two_sided);
    let frame = Frame::from_z(context.hit.normal);
    SamplingTest::over_sphere(
        format!("background: {name}"),
        move |u| {
            let sample = lit.1.sample(&lit.0, &context, u[2], [u[0], u[1]])?;
            (sample.source == LightSource::Environment).then(|| frame.to_local(sample.direction))
        },
        move |w| {
            let direction = frame.to_world(w).normalize();
            pdf_lit.1.pdf(&pdf_lit.0, &context, LightSource::Environment, direction)
        },
    )
}

/// Selection probability of each emitter, computed as `pdf` over the pdf of its cone. The last
/// index is the environment.
fn selection_test(
    name: &str,
    environment: Environment,
    context: LightSampleContext,
) -> SamplingTest {
    let (spheres, lights) = emitters(environment);
    // The sphere set has moved its origin.
    let mut context = context;
    context.hit.point -= spheres.origin();
    let selection_pmf = |id: u32| {
        let cone = Cone::subtending(context.hit.point, &spheres.sphere(id)).expect("from outside");
        lights.pdf(&spheres, &context, LightSource::Emitter(id), DVec3::X) / cone.pdf()
    };
    let mut probabilities: Vec<f64> = (0..40).map(selection_pmf).collect();
    probabilities.push(lights.environment_probability(&context));
    SamplingTest::over_indices(name, probabilities, move |u| {
        let sample = lights.sample(&spheres, &context, u[2], [u[0], u[1]])?;
        Some(match sample.source {
            LightSource::Emitter(id) | LightSource::FarWall(id) => id as usize,
            LightSource::Environment => 40,
        })
    })
}
