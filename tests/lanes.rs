//! What is computed for many paths at a time has the bits of what is computed for one, with every
//! set of vector instructions that this processor has.

#[path = "common/render.rs"]
mod common;

use common::{scene, scene_file};
use photosphere::accel::{Accel, Backend, Cancel};
use photosphere::color::Radiance;
use photosphere::integrator::{SampleAddress, Tally, Workspace, World, of_scene};
use photosphere::math::Isa;
use photosphere::scene::Scene;

/// A few lamps, one of them around the camera and all, over matt and other surfaces.
const LAMPS: &str = r#"
format = 1
image = { width = 40, height = 30 }
camera = { position = [0, 2, 9], look_at = [0, 1, 0], vertical_fov_degrees = 50 }
render = { integrator = "path", samples_per_pixel = 4 }
materials.matt = { type = "diffuse", albedo = [0.7, 0.8, 0.6] }
materials.rough = { type = "diffuse", albedo = [0.5, 0.8, 0.6], roughness = 0.4 }
materials.mirror = { type = "mirror", reflectance = [0.9, 0.9, 0.9] }
materials.lamp = { type = "diffuse", albedo = [0.3, 0.2, 0.1], emission = [5, 4, 3] }
materials.room = { type = "diffuse", albedo = [0.5, 0.5, 0.5], emission = [0.1, 0.1, 0.2] }
spheres = [
    { center = [0, -100, 0], radius = 100, material = "matt" },
    { center = [-2, 1, 0], radius = 1, material = "matt" },
    { center = [0, 1, 0], radius = 1, material = "mirror" },
    { center = [2, 1, 0], radius = 1, material = "rough" },
    { center = [-1, 2.5, 0], radius = 0.5, material = "lamp" },
    { center = [1, 2.5, 1], radius = 0.1, material = "lamp" },
    { center = [0, 0, 0], radius = 300, material = "room" },
]
"#;

/// The picture's samples, each of them followed by itself.
fn one_by_one(world: World<'_>, samples: &[SampleAddress]) -> (Vec<Radiance>, u64) {
    let integrator = of_scene(world.scene);
    let trace = |&address| integrator.trace(world, address).expect("it follows paths");
    let traces: Vec<_> = samples.iter().map(trace).collect();
    let rays = traces.iter().map(|trace| trace.tally.rays).sum();
    (traces.into_iter().map(|trace| trace.radiance).collect(), rays)
}

/// The same, in batches.
fn in_batches(
    world: World<'_>,
    samples: &[SampleAddress],
    size: usize,
    isa: Isa,
) -> (Vec<Radiance>, u64) {
    let integrator = of_scene(world.scene);
    let mut workspace = Workspace::with(isa);
    let mut radiance = vec![Radiance::default(); samples.len()];
    let mut tally = Tally::default();
    for (samples, radiance) in samples.chunks(size).zip(radiance.chunks_mut(size)) {
        tally = tally + integrator.estimate(world, samples, radiance, &mut workspace);
    }
    (radiance, tally.rays)
}

fn samples(scene: &Scene) -> Vec<SampleAddress> {
    let window = scene.description().image.window();
    let mut samples = Vec::new();
    for y in window.y..window.y + window.height {
        for x in window.x..window.x + window.width {
            samples.extend((0..2).map(|sample| SampleAddress { x, y, sample }));
        }
    }
    samples
}

fn must_agree(name: &str, scene: &Scene) {
    let accel: Box<dyn Accel> =
        Backend::BruteForce.build(scene.spheres(), &Default::default()).expect("builds");
    let cancel = Cancel::default();
    let world = World { scene, accel: &*accel, cancel: &cancel };
    let samples = samples(scene);
    let (alone, rays) = one_by_one(world, &samples);
    let bits = |radiance: &Radiance| {
        let Radiance { direct, indirect, alpha } = *radiance;
        (
            direct.to_array().map(f32::to_bits),
            indirect.to_array().map(f32::to_bits),
            alpha.to_bits(),
        )
    };
    assert!(alone.iter().any(|radiance| radiance.direct.max_element() > 0.0), "{name} is dark");
    for isa in Isa::all() {
        for size in [1, 7, 31, 1000] {
            let (together, rays_together) = in_batches(world, &samples, size, isa);
            let isa = isa.name();
            assert_eq!(rays, rays_together, "{name}, {isa}, batches of {size}");
            for (at, (a, b)) in samples.iter().zip(alone.iter().zip(&together)) {
                assert_eq!(bits(a), bits(b), "{name}, {isa}, batches of {size}, {at:?}");
            }
        }
    }
}

#[test]
fn the_repositorys_scenes_have_the_same_bits_for_any_instructions_and_batches() {
    let small = ["image.width=24", "image.height=18"];
    let names = ["paper/fig2.toml", "paper/fig5.toml", "cornell-spheres.toml", "sky.toml"];
    for name in names.into_iter().chain(["furnace.toml", "verify/lamp-in-glass.toml"]) {
        must_agree(name, &scene(&scene_file(name), &small));
    }
}

#[test]
fn all_that_an_integrator_can_be_asked_for_has_the_same_bits() {
    for options in [
        &[][..],
        &["render.estimator=light"],
        &["render.estimator=bsdf"],
        &["render.max_depth=3"],
        &["render.clamp_indirect=0.5"],
        &["render.sampler=independent"],
        &["render.integrator=direct"],
        &["render.light_choice=power"],
        &["camera.near=5.5"],
        &["image.filter=gaussian"],
    ] {
        must_agree(&format!("lamps, {options:?}"), &scene(LAMPS, options));
    }
}

#[test]
fn many_lamps_have_the_same_bits() {
    let lamp = |i: u32| {
        let angle = f64::from(i) * 2.4;
        let (x, z) = (angle.cos() * f64::from(i) * 0.1, angle.sin() * f64::from(i) * 0.1);
        format!("{{ center = [{x}, 3, {z}], radius = 0.05, material = \"lamp\" }},")
    };
    let more: String = (0..40).map(lamp).collect();
    must_agree(
        "many lamps",
        &scene(&LAMPS.replace("spheres = [", &format!("spheres = [{more}")), &[]),
    );
}
