//! Connections over polished balls: the mean is that of paths which find the same light by chance.
//!
//! Emitters are wide, so that chance is a good judge.

use photosphere::accel::Backend;
use photosphere::color::Rgb;
use photosphere::integrator::{
    PathEvent, RenderContext, RenderStats, Rival, SampleAddress, Workspace, create,
};
use photosphere::light::specular::SpecularPath;
use photosphere::material::Metal;
use photosphere::scene::SphereArrays;
use photosphere::scene::description::{MaterialDescription, SurfaceModel};
use photosphere::scene::settings::{Caustics, Estimator, IntegratorSettings, PaperSettings};

use crate::kit::{Judged, Kit, built, diffuse, glass, mirror, rendered, rough_glass};

type Change = (&'static str, fn(&mut Kit));

/// Looks down at a grey ground near a place for a ball of radius 1 above it.
fn ground() -> Kit {
    let mut kit = Kit::new(6, 6, 64);
    kit.scene.camera([0.0, 4.0, 7.0], [0.0, 0.3, 0.0]).field_of_view(40.0);
    kit.ball([0.0, -100.0, 0.0], 100.0, diffuse(0.6));
    kit
}

fn lamp(kit: &mut Kit) -> &mut Kit {
    kit.glowing_ball([-3.0, 5.0, 1.0], 1.8, diffuse(0.0), 8.0)
}

fn sun(kit: &mut Kit) {
    kit.scene.sun([0.5, 1.0, 0.3], 40.0, [3.0, 2.0, 1.0]);
    kit.scene.background([0.05, 0.1, 0.2]);
}

const BALL: [f64; 3] = [0.0, 1.2, 0.0];

fn absorbing(ior: f64) -> SurfaceModel {
    SurfaceModel::Dielectric { ior, roughness: 0.0, priority: 0, absorption: Rgb::splat(0.4) }
}

fn veil(kit: &mut Kit, center: [f64; 3], radius: f64) {
    let material = kit.scene.material(MaterialDescription {
        surface: diffuse(0.5),
        opacity: 0.6,
        ..MaterialDescription::default()
    });
    kit.scene.sphere(material, center, radius);
}

/// Spheres of a table whose ids are not its rows.
fn table(
    kit: &mut Kit,
    centers: [[f64; 3]; 2],
    radii: [f64; 2],
    surface: SurfaceModel,
    emission: f32,
) {
    let emission = Rgb::splat(emission);
    let material = MaterialDescription { surface, emission, ..MaterialDescription::default() };
    let material = kit.scene.material(material);
    let arrays = SphereArrays::from_centers::<f64>(centers.to_vec(), radii.to_vec());
    kit.scene.spheres(material, arrays.with_ids(vec![70u32, 3]));
}

const SCENES: [Change; 30] = [
    ("a mirror", |kit| _ = lamp(kit).ball(BALL, 1.0, mirror(0.9))),
    ("gold", |kit| {
        lamp(kit);
        let gold = kit.scene.metal(Metal::NAMED[0].1, 0.0);
        kit.scene.sphere(gold, BALL, 1.0);
    }),
    ("glass", |kit| _ = lamp(kit).ball(BALL, 1.0, glass(1.5))),
    ("low light", |kit| {
        kit.ball(BALL, 1.0, glass(1.5)).glowing_ball([-5.0, 1.0, 3.0], 1.8, diffuse(0.0), 8.0);
    }),
    ("dense glass near the ground", |kit| _ = lamp(kit).ball([0.0, 1.01, 0.0], 1.0, glass(2.2))),
    ("an air bubble without water", |kit| _ = lamp(kit).ball(BALL, 1.0, glass(0.7))),
    ("tinted glass", |kit| _ = lamp(kit).ball(BALL, 1.0, absorbing(1.4))),
    ("an emitter in glass", |kit| {
        kit.ball(BALL, 1.0, absorbing(1.5)).glowing_ball([0.3, 1.3, 0.1], 0.4, diffuse(0.0), 9.0);
    }),
    ("an emitter in a bubble", |kit| {
        kit.ball(BALL, 1.0, glass(0.8)).glowing_ball([0.3, 1.3, 0.1], 0.4, diffuse(0.0), 9.0);
    }),
    ("a ball in glass", |kit| {
        lamp(kit).ball(BALL, 1.0, glass(1.5)).ball([-0.3, 1.3, 0.1], 0.5, diffuse(0.7));
    }),
    ("a ball in a bubble", |kit| {
        lamp(kit).ball(BALL, 1.0, glass(0.8)).ball([-0.3, 1.3, 0.1], 0.5, diffuse(0.7));
    }),
    ("a ball through glass", |kit| {
        lamp(kit).ball(BALL, 1.0, absorbing(1.5)).ball([-0.6, 1.0, 0.4], 0.7, diffuse(0.7));
    }),
    ("a bubble in glass", |kit| {
        lamp(kit).ball(BALL, 1.0, glass(1.5)).ball([-0.2, 1.4, 0.1], 0.4, absorbing(1.2));
    }),
    ("an emitter that cuts glass", |kit| {
        kit.ball(BALL, 1.0, glass(1.5)).glowing_ball([0.9, 1.5, 0.0], 0.5, diffuse(0.0), 9.0);
    }),
    ("glass that shines", |kit| {
        lamp(kit).glowing_ball(BALL, 1.0, glass(1.5), 1.0);
    }),
    ("the sun over a mirror", |kit| {
        sun(kit);
        kit.ball(BALL, 1.0, mirror(0.9));
    }),
    ("the sun through glass", |kit| {
        sun(kit);
        kit.ball(BALL, 1.0, absorbing(1.5)).ball([-0.3, 1.3, 0.1], 0.4, diffuse(0.7));
    }),
    ("a veil in the way", |kit| {
        lamp(kit).ball(BALL, 1.0, absorbing(1.5));
        veil(kit, [-1.6, 3.2, 0.6], 0.8);
        veil(kit, [0.2, 1.1, 0.1], 0.4);
    }),
    ("fog in the way", |kit| {
        lamp(kit).ball(BALL, 1.0, absorbing(1.5)).ball([-1.6, 3.2, 0.6], 0.8, absorbing(1.0));
        kit.ball([1.5, 0.6, 0.5], 0.9, absorbing(1.0));
        kit.ball([0.2, 1.1, 0.1], 0.4, absorbing(1.5));
    }),
    ("balls next to each other", |kit| {
        lamp(kit).ball(BALL, 0.9, glass(1.5)).ball([2.0, 1.0, 0.5], 0.9, mirror(0.8));
        kit.ball([-2.0, 0.8, 0.2], 0.7, rough_glass(1.5, 0.3));
    }),
    ("a few choices", |kit| {
        for x in [-2.0, 0.0, 2.0] {
            kit.ball([x, 0.9, 0.0], 0.8, glass(1.5)).ball([x, 0.6, 2.0], 0.5, mirror(0.8));
            kit.glowing_ball([x - 1.0, 4.0, x], 0.7, diffuse(0.0), 5.0);
        }
    }),
    ("many choices", |kit| {
        sun(kit);
        for i in 0..12 {
            let (x, z) = (f64::from(i % 4) * 1.4 - 2.1, f64::from(i / 4) * 1.6 - 1.6);
            let surface = if i % 3 == 0 { mirror(0.8) } else { glass(1.4) };
            kit.ball([x, 0.7, z], 0.6, surface);
            kit.glowing_ball([x - 1.0, 4.0, z], 0.4, diffuse(0.0), 5.0);
        }
    }),
    ("a camera in glass", |kit| {
        lamp(kit).ball([0.0, 3.0, 4.0], 4.5, glass(1.4)).ball([0.5, 1.6, 3.0], 0.6, diffuse(0.7));
    }),
    ("as many pairs as are evaluated one by one", |kit| {
        for i in 0..8 {
            let (x, z) = (f64::from(i % 4) * 1.4 - 2.1, f64::from(i / 4) * 2.0 - 0.5);
            kit.ball([x, 0.7, z], 0.6, if i % 3 == 0 { mirror(0.8) } else { glass(1.4) });
            kit.glowing_ball([x - 1.0, 4.0, z], 0.5, diffuse(0.0), 5.0);
        }
    }),
    ("vertices of many materials", |kit| {
        lamp(kit).ball(BALL, 1.0, glass(1.5));
        let (metal, albedo) = (Metal::NAMED[0].1, Rgb::splat(0.7));
        let plastic = SurfaceModel::Plastic { albedo, ior: 1.5, roughness: 0.4 };
        kit.ball([-1.9, 0.7, 0.9], 0.7, plastic);
        kit.ball([1.9, 0.7, 0.9], 0.7, SurfaceModel::Conductor { metal, roughness: 0.6 });
        kit.ball([0.0, 0.5, 2.2], 0.5, SurfaceModel::Diffuse { albedo, roughness: 0.8 });
        kit.ball([1.4, 0.3, 2.4], 0.3, rough_glass(1.5, 0.5));
    }),
    ("dense glass in low light", |kit| {
        kit.ball([0.0, 1.6, 0.0], 1.0, glass(1.8));
        kit.glowing_ball([-6.0, 4.5, 2.0], 2.5, diffuse(0.0), 8.0);
        kit.ball([-1.6, 2.6, 0.6], 0.7, diffuse(0.5));
    }),
    ("spheres of a table", |kit| {
        kit.ball([0.0, 0.3, 2.4], 0.3, diffuse(0.5));
        table(kit, [[-1.8, 0.9, 0.3], [0.2, 0.9, -0.6]], [0.8, 0.9], glass(1.5), 0.0);
        table(kit, [[2.0, 0.9, 0.2], [2.2, 0.4, 1.9]], [0.9, 0.4], mirror(0.8), 0.0);
        table(kit, [[-3.0, 5.0, 1.0], [3.0, 5.5, 1.0]], [1.5, 1.0], diffuse(0.0), 8.0);
    }),
    ("short paths", |kit| {
        lamp(kit).ball(BALL, 1.0, glass(1.5)).settings.render.max_depth = Some(4);
    }),
    ("shorter paths", |kit| {
        lamp(kit).ball(BALL, 1.0, glass(1.5)).settings.render.max_depth = Some(3);
    }),
    ("direct light", |kit| {
        lamp(kit).ball(BALL, 1.0, glass(1.5)).settings.render.integrator =
            IntegratorSettings::Direct;
    }),
];

const ONE_KIND: [&str; 4] = ["a mirror", "glass", "an emitter in glass", "a ball in glass"];

fn by_chance(kit: Kit) -> Kit {
    kit.with(|kit| kit.settings.render.caustics = Caustics::Chance)
}

#[test]
fn connections_have_the_mean_of_chance() {
    for (name, change) in SCENES {
        let kit = ground().with(change);
        // A million samples in all where there is one kind of connection.
        let samples = if ONE_KIND.contains(&name) { 1024 } else { 256 };
        let chance = by_chance(kit.clone()).samples(samples).mean();
        for estimator in [Estimator::Mis, Estimator::Light] {
            let kit = kit.clone().with(|kit| kit.settings.render.estimator = estimator);
            kit.mean().must_agree(chance, &format!("{name}, {estimator:?}"));
        }
    }
}

/// What a few samples of each pixel count, and its events.
fn stats_of(kit: &Kit) -> (RenderStats, Vec<PathEvent>) {
    let prepared = kit.prepared();
    let accel = built(&prepared, Backend::BruteForce);
    let cancel = Default::default();
    let context = RenderContext::new(&prepared, &*accel, &cancel);
    let address = |i: u32| SampleAddress { x: i % 6, y: i / 6 % 6, sample: i / 36 };
    let samples: Vec<_> = (0..36 * 256).map(address).collect();
    let integrator = create(&prepared);
    let mut radiance = vec![Default::default(); samples.len()];
    let stats = integrator.estimate(context, &samples, &mut radiance, &mut Workspace::default());
    let traces = samples.iter().filter_map(|&at| integrator.trace_path(context, at));
    (stats, traces.flat_map(|trace| trace.events).collect())
}

#[test]
fn only_scenes_with_polished_balls_connect() {
    let with = |surface| ground().with(|kit| _ = lamp(kit).ball(BALL, 1.0, surface));
    assert!(stats_of(&with(mirror(0.5))).0.connections > 0);
    let by_hand = |change: fn(&mut Kit)| stats_of(&with(glass(1.5)).with(change)).0.connections;
    assert!(by_hand(|_| {}) > 0);
    let without: [fn(&mut Kit); 4] = [
        |kit| kit.settings.render.caustics = Caustics::Chance,
        |kit| kit.settings.render.estimator = Estimator::Bsdf,
        |kit| *kit = kit.clone().paper(PaperSettings::default()),
        |kit| kit.material(2).opacity = 0.5,
    ];
    assert_eq!(without.map(by_hand), [0; 4]);
    for surface in [diffuse(0.5), rough_glass(1.5, 0.2), glass(1.0), mirror(0.0)] {
        assert_eq!(stats_of(&with(surface)).0.connections, 0, "{surface:?}");
    }
}

#[test]
fn every_kind_is_connected_and_found_by_chance() {
    let kinds = |kit: &Kit| {
        let events = stats_of(&kit.clone().depth(8)).1;
        let kind = |event: &PathEvent| match event {
            PathEvent::Connection { kind, .. } => Some(*kind),
            _ => None,
        };
        let by_chance = |event: &PathEvent| matches!(event, PathEvent::Emission { rival: Rival::Connection(pdf), .. } if *pdf > 0.0);
        assert!(events.iter().any(by_chance));
        events.iter().filter_map(kind).collect::<Vec<_>>()
    };
    let scene = |name| SCENES.iter().find(|(other, _)| *other == name).expect("a scene").1;
    // Low light comes back from inside the ball.
    let glass = kinds(&ground().with(scene("low light")));
    for kind in SpecularPath::OVER_DIELECTRIC {
        assert!(glass.contains(&kind), "{kind:?}");
    }
    let inside = kinds(&ground().with(scene("a ball in glass")));
    assert!(inside.contains(&SpecularPath::Outward));
    let emitter = kinds(&ground().with(scene("an emitter in glass")));
    assert!(!emitter.is_empty(), "none");
    assert!(emitter.iter().all(|&kind| kind == SpecularPath::Inward));
}

#[test]
fn every_backend_connects_alike() {
    for name in ["a ball through glass", "a veil in the way", "many choices"] {
        let change = SCENES.iter().find(|(other, _)| *other == name).expect("a scene").1;
        let prepared = ground().with(change).samples(16).prepared();
        let expected = rendered(&prepared, Backend::BruteForce).picture;
        for backend in Backend::AVAILABLE.iter().copied() {
            assert_eq!(rendered(&prepared, backend).picture, expected, "{name}, {backend:?}");
        }
    }
}

/// Variance of a sample's green channel in all pixels and seeds.
fn variance(kit: &Kit) -> f64 {
    let samples = f64::from(kit.settings.render.samples_per_pixel);
    let pictures = kit.pictures(Backend::BruteForce);
    let values: Vec<f64> = pictures
        .flat_map(|picture| {
            (0..picture.len()).map(|i| f64::from(picture.beauty(i).y)).collect::<Vec<_>>()
        })
        .collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
    squares / (values.len() - 1) as f64 * samples
}

/// A lamp of one degree over a mirror ball, and out of a glass ball.
#[test]
#[allow(clippy::print_stdout, reason = "the figures are worth reading with --nocapture")]
fn a_small_lamp_has_a_three_hundredth_of_the_variance() {
    for name in ["verify/lamp-over-a-mirror.toml", "verify/lamp-out-of-glass.toml"] {
        // Chance finds the lamp about once in 1e5 samples.
        let chance = by_chance(Kit::of_file(name, &["image.width=16", "image.height=16"]));
        let connected = Kit::of_file(name, &[]).samples(64);
        let (chance, connected) = (variance(&chance.samples(4096)), variance(&connected));
        println!("{name}: {:.0} times less", chance / connected);
        assert!(connected * 300.0 <= chance, "{name}: {connected:.2e} of {chance:.2e}");
    }
}
