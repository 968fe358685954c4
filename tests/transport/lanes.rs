//! What is computed for many paths at a time has the bits of what is computed for one, with every
//! set of vector instructions that this processor has.

use photosphere::accel::Backend;
use photosphere::color::PathRadiance;
use photosphere::integrator::{RenderContext, RenderStats, SampleAddress, Workspace, create};
use photosphere::math::Isa;
use photosphere::scene::description::{MaterialDescription, SurfaceModel};
use photosphere::scene::settings::{
    Estimator, FilterKind, ImageSettings, IntegratorSettings, LightSamplerKind, SamplerKind,
};
use photosphere::scene::{MaterialHandle, PreparedScene};
use photosphere::task::CancelToken;

use crate::kit::{Kit, built, glass};

fn diffuse(albedo: [f32; 3], roughness: f64) -> SurfaceModel {
    SurfaceModel::Diffuse { albedo: albedo.into(), roughness }
}

fn emitter(kit: &mut Kit, albedo: [f32; 3], emission: [f32; 3]) -> MaterialHandle {
    let (surface, emission) = (diffuse(albedo, 0.0), emission.into());
    kit.scene.material(MaterialDescription { surface, emission, ..Default::default() })
}

/// A few emitters, one of them around the camera and all, over diffuse and other surfaces; and
/// small emitters before them.
fn emitters(small: impl Iterator<Item = [f64; 3]>) -> Kit {
    let mut kit = Kit::new(40, 30, 4);
    kit.scene.camera([0.0, 2.0, 9.0], [0.0, 1.0, 0.0]).field_of_view(50.0);
    let even = kit.scene.diffuse([0.7, 0.8, 0.6]);
    let rough = kit.scene.surface(diffuse([0.5, 0.8, 0.6], 0.4));
    let mirror = kit.scene.mirror([0.9; 3]);
    let glow = emitter(&mut kit, [0.3, 0.2, 0.1], [5.0, 4.0, 3.0]);
    let room = emitter(&mut kit, [0.5; 3], [0.1, 0.1, 0.2]);
    for center in small {
        kit.scene.sphere(glow, center, 0.05);
    }
    kit.scene
        .sphere(even, [0.0, -100.0, 0.0], 100.0)
        .sphere(even, [-2.0, 1.0, 0.0], 1.0)
        .sphere(mirror, [0.0, 1.0, 0.0], 1.0)
        .sphere(rough, [2.0, 1.0, 0.0], 1.0)
        .sphere(glow, [-1.0, 2.5, 0.0], 0.5)
        .sphere(glow, [1.0, 2.5, 1.0], 0.1)
        .sphere(room, [0.0; 3], 300.0);
    kit
}

/// The picture's samples, each of them followed by itself.
fn one_by_one(context: RenderContext<'_>, samples: &[SampleAddress]) -> (Vec<PathRadiance>, u64) {
    let integrator = create(context.prepared);
    let trace = |&address| integrator.trace_path(context, address).expect("it follows paths");
    let traces: Vec<_> = samples.iter().map(trace).collect();
    let rays = traces.iter().map(|trace| trace.stats.rays).sum();
    (traces.into_iter().map(|trace| trace.radiance).collect(), rays)
}

/// The picture's samples, followed in batches.
fn in_batches(
    context: RenderContext<'_>,
    samples: &[SampleAddress],
    size: usize,
    isa: Isa,
) -> (Vec<PathRadiance>, u64) {
    let integrator = create(context.prepared);
    let mut workspace = Workspace::with_isa(isa);
    let mut radiance = vec![PathRadiance::default(); samples.len()];
    let mut stats = RenderStats::default();
    for (samples, radiance) in samples.chunks(size).zip(radiance.chunks_mut(size)) {
        stats = stats + integrator.estimate(context, samples, radiance, &mut workspace);
    }
    (radiance, stats.rays)
}

fn samples(prepared: &PreparedScene) -> Vec<SampleAddress> {
    let window = prepared.image_settings().pixel_bounds();
    let mut samples = Vec::new();
    for y in window.y..window.y + window.height {
        for x in window.x..window.x + window.width {
            samples.extend((0..2).map(|sample| SampleAddress { x, y, sample }));
        }
    }
    samples
}

fn must_agree(name: &str, kit: &Kit) {
    let prepared = kit.prepared();
    let accel = built(&prepared, Backend::BruteForce);
    let cancel = CancelToken::default();
    let context = RenderContext::new(&prepared, &*accel, &cancel);
    let samples = samples(&prepared);
    let (alone, rays) = one_by_one(context, &samples);
    let bits = |radiance: &PathRadiance| {
        let PathRadiance { direct, indirect, alpha } = *radiance;
        (
            direct.to_array().map(f32::to_bits),
            indirect.to_array().map(f32::to_bits),
            alpha.to_bits(),
        )
    };
    assert!(alone.iter().any(|radiance| radiance.direct.max_element() > 0.0), "{name} is dark");
    for isa in Isa::available() {
        for size in [1, 7, 31, 1000] {
            let (together, rays_together) = in_batches(context, &samples, size, isa);
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
    for name in [
        "paper/fig2.toml",
        "paper/fig5.toml",
        "cornell-spheres.toml",
        "sky.toml",
        "furnace.toml",
        "materials.toml",
        "phong.toml",
        "bench/mixed-balls.toml",
        "bench/small-lamp.toml",
        "caustics/two-balls.toml",
        "verify/lamp-over-a-mirror.toml",
        "verify/lamp-out-of-glass.toml",
        "verify/lamp-in-glass.toml",
        "verify/translucent-lamp.toml",
        "verify/fog.toml",
        "verify/lens.toml",
        "verify/orthographic.toml",
    ] {
        must_agree(name, &Kit::of_file(name, &small));
    }
}

/// Something to be asked for, and its name.
type Change = (&'static str, fn(&mut Kit));

#[test]
fn all_that_an_integrator_can_be_asked_for_has_the_same_bits() {
    let changes: [Change; 11] = [
        ("as they are", |_| {}),
        ("aimed at", |kit| kit.settings.render.estimator = Estimator::Light),
        ("met by chance", |kit| kit.settings.render.estimator = Estimator::Bsdf),
        ("short paths", |kit| kit.settings.render.max_depth = Some(3)),
        ("clamped", |kit| kit.settings.render.clamp_indirect = Some(0.5)),
        ("independent", |kit| kit.settings.render.sampler = SamplerKind::Independent),
        ("direct", |kit| kit.settings.render.integrator = IntegratorSettings::Direct),
        ("by power", |kit| kit.settings.render.light_choice = LightSamplerKind::Power),
        ("in shells that let light through", |kit| {
            kit.ball([-1.0, 2.5, 0.0], 0.7, glass(1.0)).ball([-2.0, 1.0, 0.0], 1.2, glass(1.0));
        }),
        ("cut open", |kit| kit.scene.description.camera.near = 5.5),
        ("blurred", |kit| {
            let filter = FilterKind::Gaussian;
            let filter_radius = ImageSettings::default_filter_radius(filter);
            kit.settings.image = ImageSettings { filter, filter_radius, ..kit.settings.image };
        }),
    ];
    for (name, change) in changes {
        must_agree(&format!("lamps, {name}"), &emitters([].into_iter()).with(change));
    }
}

#[test]
fn many_emitters_have_the_same_bits() {
    let center = |i: u32| {
        let angle = f64::from(i) * 2.4;
        [angle.cos() * f64::from(i) * 0.1, 3.0, angle.sin() * f64::from(i) * 0.1]
    };
    must_agree("many lamps", &emitters((0..40).map(center)));
}
