//! The integrators and their ways to find light against each other, and paths told step by step.
//!
//! Means are judged over 32 seeds at a significance of 4e-4 each, see `common/kit.rs`.

use photosphere::accel::Backend;
use photosphere::color::Rgb;
use photosphere::integrator::{
    PathEvent, PathTrace, RenderContext, Rival, SampleAddress, Termination, create,
};
use photosphere::math::DVec3;
use photosphere::scene::PreparedScene;
use photosphere::scene::description::MaterialDescription;
use photosphere::scene::settings::{
    Estimator, IntegratorSettings, MissPolicy, PaperSettings, PathTermination,
};
use photosphere::task::CancelToken;

use crate::kit::{Judged, Kit, built, diffuse, glass, mirror, phong};

/// A diffuse and a glossy ball, a mirror and a glass ball on a diffuse ground under two emitters
/// and a sky.
fn still_life() -> Kit {
    let mut kit = Kit::new(12, 8, 16);
    kit.scene.camera([0.0, 1.5, 7.0], [0.0, 0.8, 0.0]).field_of_view(40.0);
    kit.scene.background([0.2, 0.3, 0.4]);
    kit.ball([0.0, -100.0, 0.0], 100.0, diffuse(0.6));
    kit.ball([-2.2, 1.0, 0.0], 1.0, phong([0.3, 0.5], 40.0, true));
    kit.ball([0.0, 1.0, -0.5], 1.0, mirror(0.9));
    kit.ball([2.2, 1.0, 0.0], 1.0, glass(1.5));
    let emission = Rgb::new(4.0, 3.0, 2.0);
    let surface = diffuse(0.5);
    let emitter =
        kit.scene.material(MaterialDescription { surface, emission, ..Default::default() });
    kit.scene.sphere(emitter, [-1.0, 5.0, 2.0], 1.5).sphere(emitter, [1.0, 0.3, 2.0], 0.3);
    kit
}

fn estimator(mut kit: Kit, estimator: Estimator) -> Kit {
    kit.settings.render.estimator = estimator;
    kit
}

fn clamped(mut kit: Kit, limit: f64) -> Kit {
    kit.settings.render.clamp_indirect = Some(limit);
    kit
}

#[test]
fn all_ways_to_find_light_have_the_same_mean() {
    for integrator in [IntegratorSettings::Path, IntegratorSettings::Direct] {
        let mean = |way: Estimator, samples: u32| {
            estimator(still_life(), way).integrator(integrator).samples(samples).mean()
        };
        let combined = mean(Estimator::Mis, 32);
        for (other, samples) in [(Estimator::Light, 32), (Estimator::Bsdf, 128)] {
            mean(other, samples).must_agree(combined, &format!("{integrator:?}, {other:?}"));
        }
    }
}

#[test]
fn each_way_to_find_light_does_what_its_name_says() {
    // Seen by nothing but diffuse surfaces, an emitter met by chance brings nothing to `light`, and
    // nothing is aimed at by `bsdf`: in a trace there are only shadow rays, or none.
    let count = |way: Estimator, chosen: &dyn Fn(&PathEvent) -> bool| {
        let prepared = estimator(still_life(), way).prepared();
        traces(&prepared).iter().flat_map(|trace| &trace.events).filter(|step| chosen(step)).count()
    };
    let by_chance = |step: &PathEvent| {
        matches!(step, PathEvent::Emission { pdf: Some(_), rival: Rival::LightSample(pdf), contribution, .. }
        if *pdf > 0.0 && contribution.radiance != Rgb::ZERO)
    };
    let aimed = |step: &PathEvent| matches!(step, PathEvent::LightSample { .. });
    assert_eq!(count(Estimator::Light, &by_chance), 0);
    assert_eq!(count(Estimator::Bsdf, &aimed), 0);
    assert!(count(Estimator::Mis, &by_chance) > 0 && count(Estimator::Mis, &aimed) > 0);
    assert!(count(Estimator::Light, &aimed) > 0);
}

#[test]
fn direct_light_is_the_direct_layer_of_all_light() {
    for mut kit in [still_life(), Kit::of_file("paper/fig4.toml", &[])] {
        (kit.settings.image.width, kit.settings.image.height) = (24, 18);
        for way in [Estimator::Mis, Estimator::Light, Estimator::Bsdf] {
            let kit = estimator(kit.clone(), way).samples(16);
            let all = kit.clone().integrator(IntegratorSettings::Path).picture();
            let direct = kit.integrator(IntegratorSettings::Direct).picture();
            assert_eq!(direct.direct, all.direct, "{way:?}");
            assert!(direct.indirect.iter().all(|&light| light == Rgb::ZERO));
            assert!(all.indirect.iter().any(|&light| light != Rgb::ZERO));
        }
    }
}

#[test]
fn normals_are_exact_and_have_no_noise() {
    let mut kit = Kit::new(3, 3, 1).integrator(IntegratorSettings::Normals);
    kit.settings.render.seed = 9;
    kit.scene.camera([0.0, 0.0, 5.0], [0.0; 3]).field_of_view(30.0);
    kit.ball([0.0; 3], 1.0, mirror(1.0));
    let normals = kit.picture();
    assert_eq!(normals.direct[4], Rgb::new(0.5, 0.5, 1.0));
    assert_eq!(normals.direct[0], Rgb::ZERO, "beside the ball");
    // The ray through the middle of the right column's middle pixel: its height over the axis at
    // distance 1 is 2/3 tan 15 deg, and it meets the ball at the smaller root.
    let slope = 2.0 / 3.0 * 15f64.to_radians().tan();
    let (a, b, c) = (1.0 + slope * slope, -5.0, 24.0);
    let t = (-b - (b * b - a * c).sqrt()) / a;
    let expected = Rgb::new((0.5 + 0.5 * slope * t) as f32, 0.5, (0.5 + 0.5 * (5.0 - t)) as f32);
    assert!((normals.direct[5] - expected).abs().max_element() < 1e-6, "{}", normals.direct[5]);
    kit.settings.render.seed = 10;
    assert_eq!(normals.direct, kit.picture().direct);
}

/// Two balls, their centres 4 apart as seen at the point between them.
fn two_balls() -> Kit {
    let mut kit =
        Kit::new(1, 1, 256).integrator(IntegratorSettings::AmbientOcclusion { distance: None });
    kit.scene.camera([0.0, 6.0, 0.0], [0.0; 3]).up(DVec3::X).field_of_view(1e-6);
    kit.glowing_ball([0.0; 3], 1.0, diffuse(0.1), 3.0);
    kit.glowing_ball([4.0, 1.0, 0.0], 2.0, diffuse(0.1), 3.0);
    kit
}

#[test]
fn ambient_occlusion_is_one_less_the_covered_share() {
    // From the point (0, 1, 0) with normal +y the other ball's centre lies on the horizon, at the
    // distance 4. Its cone has sin^2 = 1/4; half of it is above the horizon. The share of the
    // cosine-weighted hemisphere that half a cone on the horizon covers is (a - sin a cos a) / pi,
    // with sin a = 1/2 the cone's half angle (Siegel and Howell, configuration factors).
    let a = (0.5f64).asin();
    let covered = (a - a.sin() * a.cos()) / std::f64::consts::PI;
    two_balls().mean().must_be(1.0 - covered, "openness");
    // Its nearest point is 2 away.
    let within = |distance: f64| IntegratorSettings::AmbientOcclusion { distance: Some(distance) };
    two_balls().integrator(within(1.99)).mean().must_be(1.0, "nothing is that near");
    let a_little = two_balls().integrator(within(2.5)).mean();
    assert!(a_little.mean > 1.0 - covered && a_little.mean < 1.0, "{a_little:?}");
    // Inside a ball nothing is open; where nothing is met, all is.
    let mut inside = two_balls();
    inside.scene.camera([0.0, 2.5, 0.0], [0.0; 3]);
    inside.scene.description.spheres[1].center = DVec3::Y;
    inside.mean().must_be(0.0, "inside");
    let mut away = two_balls();
    away.scene.camera([0.0, 6.0, 0.0], [0.0, 7.0, 0.0]);
    away.mean().must_be(1.0, "nothing met");
}

#[test]
fn ambient_occlusion_is_a_white_scene_under_a_white_sky() {
    let mut white = still_life().integrator(IntegratorSettings::Direct);
    white.scene.background([1.0; 3]);
    for material in &mut white.scene.description.materials {
        (material.surface, material.emission) = (diffuse(1.0), Rgb::ZERO);
    }
    let openness = still_life().integrator(IntegratorSettings::AmbientOcclusion { distance: None });
    openness.mean().must_agree(white.mean(), "white sky");
}

/// The traces of some samples of every pixel.
fn traces(prepared: &PreparedScene) -> Vec<PathTrace> {
    let accel = built(prepared, Backend::BruteForce);
    let cancel = CancelToken::default();
    let context = RenderContext::new(prepared, &*accel, &cancel);
    let integrator = create(prepared);
    let image = prepared.image_settings();
    let mut traces = Vec::new();
    for y in 0..image.height {
        for x in 0..image.width {
            for sample in 0..4 {
                let address = SampleAddress { x, y, sample };
                traces.push(integrator.trace_path(context, address).expect("it follows paths"));
            }
        }
    }
    traces
}

#[test]
fn a_trace_adds_up_to_its_sample_bit_by_bit() {
    for kit in [
        still_life(),
        clamped(still_life(), 0.5).depth(5),
        estimator(still_life(), Estimator::Light).integrator(IntegratorSettings::Direct),
        still_life().paper(PaperSettings { miss: MissPolicy::Redraw, ..PaperSettings::default() }),
        still_life().paper(PaperSettings {
            stop: PathTermination::Threshold(0.01),
            ..PaperSettings::default()
        }),
    ] {
        let how = kit.how();
        let prepared = kit.prepared();
        let accel = built(&prepared, Backend::BruteForce);
        let cancel = CancelToken::default();
        let context = RenderContext::new(&prepared, &*accel, &cancel);
        let traces = traces(&prepared);
        // The renderer's own way: all samples in one batch.
        let samples: Vec<SampleAddress> = traces.iter().map(|trace| trace.address).collect();
        let mut radiance = vec![Default::default(); samples.len()];
        let stats =
            create(&prepared).estimate(context, &samples, &mut radiance, &mut Default::default());
        assert_eq!(stats.rays, traces.iter().map(|trace| trace.stats.rays).sum::<u64>());
        let mut lit = 0;
        for (trace, radiance) in traces.iter().zip(radiance) {
            for sum in [trace.sum(), trace.radiance] {
                assert_eq!(sum.direct, radiance.direct, "{how}");
                assert_eq!(sum.indirect, radiance.indirect, "{how}");
            }
            lit += usize::from(radiance.indirect != Rgb::ZERO);
            let ends = trace.events.iter().filter(|step| matches!(step, PathEvent::End(_))).count();
            assert_eq!(ends, 1, "a path ends once");
        }
        assert!(lit > 0 || kit.settings.render.integrator == IntegratorSettings::Direct);
    }
}

#[test]
fn integrators_without_paths_have_nothing_to_tell() {
    for integrator in [
        IntegratorSettings::Normals,
        IntegratorSettings::AmbientOcclusion { distance: None },
        IntegratorSettings::Raycast { shadows: false },
    ] {
        let prepared = still_life().integrator(integrator).prepared();
        let accel = built(&prepared, Backend::BruteForce);
        let cancel = CancelToken::default();
        let context = RenderContext::new(&prepared, &*accel, &cancel);
        let address = SampleAddress { x: 0, y: 0, sample: 0 };
        assert!(create(&prepared).trace_path(context, address).is_none(), "{integrator:?}");
    }
}

/// Inside a sphere of albedo 0.99 that glows: the longest chains there are.
fn bright_room(size: u32) -> Kit {
    let mut kit = estimator(Kit::new(size, size, 4), Estimator::Bsdf);
    kit.scene.camera([0.0, 0.0, 0.5], [0.0; 3]);
    kit.glowing_ball([0.0; 3], 1.0, diffuse(0.99), 0.01);
    kit
}

#[test]
fn roulette_keeps_weights_and_their_variance_bounded() {
    // Every vertex adds 0.01 times the weight, which roulette holds at 1: the number of vertices is
    // geometric with mean 100 at most, so the radiance 1 has a standard deviation of at most 1 (a
    // geometric number's is below its mean). Ending long paths with 5 % whatever they weigh would
    // make the variance infinite here: each edge would multiply the second moment by 0.99^2 / 0.95.
    let traces = traces(&bright_room(32).prepared());
    let samples: Vec<f64> = traces
        .iter()
        .map(|trace| f64::from(trace.sum().direct.y + trace.sum().indirect.y))
        .collect();
    let n = samples.len() as f64;
    let mean = samples.iter().sum::<f64>() / n;
    let variance = samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    assert!(variance < 1.5, "{variance}");
    for step in traces.iter().flat_map(|trace| &trace.events) {
        if let PathEvent::Roulette { throughput, .. } = step {
            assert!(throughput.max_element() <= 1.0 + 1e-6, "{step:?}");
        }
    }
    bright_room(4).mean().must_be(1.0, "bright room");
}

#[test]
fn a_path_of_heavy_weight_survives_and_a_light_one_comes_to_weigh_one() {
    let mut seen = [0; 2];
    for trace in traces(&still_life().prepared()) {
        let mut before = 1.0f32;
        let mut index_squared = 1.0f64;
        for step in &trace.events {
            match *step {
                PathEvent::BsdfSample { throughput, eta, .. } => {
                    before = throughput.max_element();
                    index_squared *= eta * eta;
                }
                PathEvent::Roulette { survival, survives, throughput } if survives => {
                    let after = throughput.max_element() * index_squared as f32;
                    assert!(after <= 1.0f32.max(before * index_squared as f32) + 1e-5);
                    assert!((after - 1.0).abs() < 1e-5 || survival == 1.0);
                    seen[usize::from(survival == 1.0)] += 1;
                }
                _ => {}
            }
        }
        assert!(
            trace
                .events
                .iter()
                .all(|step| !matches!(step, PathEvent::End(Termination::LengthLimit)))
        );
    }
    assert!(seen[0] > 0, "{seen:?}");
}

#[test]
fn clamping_takes_light_away_from_the_indirect_layer_only() {
    let free = still_life().picture();
    let strongly = clamped(still_life(), 0.1).picture();
    assert_eq!(strongly.direct, free.direct);
    assert!(strongly.indirect.iter().zip(&free.indirect).all(|(a, b)| a.cmple(*b + 1e-6).all()));
    assert!(strongly.mean().y < free.mean().y);
    let barely = clamped(still_life(), 1e9).picture();
    assert_eq!(barely.indirect, free.indirect);
}

#[test]
fn options_that_bias_are_named() {
    let biases = |kit: Kit| kit.prepared().render_settings().biases();
    assert!(biases(still_life()).is_empty());
    assert!(biases(still_life().paper(PaperSettings::default())).is_empty());
    assert!(biases(still_life().integrator(IntegratorSettings::Normals).depth(3)).is_empty());
    assert_eq!(biases(clamped(still_life(), 10.0)), ["clamp_indirect = 10"]);
    let paper = PaperSettings {
        stop: PathTermination::Depth,
        miss: MissPolicy::Redraw,
        ..PaperSettings::default()
    };
    assert_eq!(
        biases(still_life().paper(paper).depth(5)),
        ["max_depth = 5", "paper.stop = \"depth\"", "paper.miss = \"redraw\""]
    );
}
