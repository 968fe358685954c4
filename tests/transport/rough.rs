//! Rough metal and glass in whole pictures: furnaces, and agreement between ways of finding light.
//!
//! Means are over 32 independent seeds, judged as `common/kit.rs` says.

use photosphere::accel::Backend;
use photosphere::color::Rgb;
use photosphere::material::{Metal, NAMED_IORS, PrincipledParameters};
use photosphere::scene::description::{EnvironmentDescription, SurfaceModel};
use photosphere::scene::settings::{PaperSettings, SamplerKind};

use crate::kit::{Judged, Kit, MeanEstimate, diffuse, mirror, phong, rough_glass};

/// What the tables of lost energy may be off.
const TABLES: f64 = 5e-4;

/// A ball alone in a field of radiance 1.
fn field(surface: SurfaceModel) -> Kit {
    let mut kit = Kit::new(6, 6, 16);
    kit.scene.camera([0.0, 0.0, 4.0], [0.0; 3]).field_of_view(24.0).background([1.0; 3]);
    kit.ball([0.0; 3], 1.0, surface);
    kit
}

fn metal(name: &str, roughness: f64) -> SurfaceModel {
    let (_, metal) = Metal::NAMED.iter().find(|(known, _)| *known == name).expect("a metal");
    SurfaceModel::Conductor { metal: *metal, roughness }
}

/// A ball that is partly metal, diffuse and glass, under a coat.
const MIXTURE: PrincipledParameters = PrincipledParameters {
    base_color: Rgb::splat(0.8),
    metallic: 0.2,
    roughness: 0.5,
    specular: 0.5,
    ior: 1.5,
    coat: 0.5,
    coat_roughness: 0.0,
    transmission: 0.6,
};

fn mixture(roughness: f64) -> SurfaceModel {
    SurfaceModel::Principled(PrincipledParameters { roughness, ..MIXTURE })
}

fn must_be_near(estimate: MeanEstimate, expected: f64, what: &str) {
    let off = (estimate.mean - expected).abs();
    let allowed = 4.0 * estimate.standard_error + TABLES * expected;
    assert!(off <= allowed, "{what}: {estimate:?} is not {expected}");
}

/// The field must be seen through the ball as if it were not there, and without glaring pixels.
fn must_vanish(surface: SurfaceModel) {
    let estimate = field(surface).mean();
    assert!(estimate.standard_error < 3e-3, "{surface:?}: {estimate:?}");
    must_be_near(estimate, 1.0, &format!("{surface:?}"));
}

#[test]
fn a_lossless_metal_vanishes_in_a_uniform_field_at_every_roughness() {
    let metal = Metal { ior: Rgb::ZERO, extinction: Rgb::ONE };
    for roughness in [0.0, 0.1, 0.5, 1.0] {
        let estimate = field(SurfaceModel::Conductor { metal, roughness }).mean();
        must_be_near(estimate, 1.0, &format!("roughness {roughness}"));
    }
}

/// From inside a ball of index 10 a path is reflected about a hundred times: weights that are only
/// right on average made it dark, but for rare glaring pixels.
#[test]
fn the_densest_and_roughest_glass_vanishes_in_a_uniform_field() {
    for ior in [0.1, 1.1, 3.0, 10.0] {
        for roughness in [0.3, 1.0] {
            must_vanish(rough_glass(ior, roughness));
        }
    }
}

/// Balls that are partly diffuse vanish, too: their gloss and what is beneath it throw light back
/// as often.
#[test]
fn dense_mixtures_vanish_in_a_uniform_field() {
    let white = PrincipledParameters { base_color: Rgb::ONE, coat: 0.0, ..MIXTURE };
    for (ior, metallic, roughness) in
        [(10.0, 0.0, 0.5), (10.0, 0.0, 1.0), (3.0, 0.3, 0.8), (10.0, 0.2, 0.0)]
    {
        let told = PrincipledParameters { ior, metallic, roughness, ..white };
        must_vanish(SurfaceModel::Principled(told));
    }
}

/// At roughness 1 more than half of the light is drawn by a second pair of numbers, where a facet
/// sends none out.
#[test]
fn evenly_spread_numbers_are_worth_it_on_the_roughest_metal() {
    let mut kit = field(metal("gold", 1.0)).samples(256);
    kit.scene.field_of_view(10.0);
    kit.scene.description.background.dome = EnvironmentDescription::Gradient {
        zenith: Rgb::splat(2.0),
        horizon: Rgb::splat(0.5),
        nadir: Rgb::splat(0.1),
    };
    let mut mean_variance = |sampler: SamplerKind| {
        kit.settings.render.sampler = sampler;
        let pictures: Vec<_> = kit.pictures(Backend::BruteForce).take(16).collect();
        let variance = |pixel| {
            let values: Vec<f64> =
                pictures.iter().map(|picture| f64::from(picture.beauty(pixel).y)).collect();
            MeanEstimate::from_values(&values).standard_error.powi(2)
        };
        (0..36).map(variance).sum::<f64>()
    };
    // Each variance is known within 6 % (540 degrees of freedom). The gain is 6.6; with independent
    // numbers for the second pair it was 2.9.
    let gain = mean_variance(SamplerKind::Independent) / mean_variance(SamplerKind::Sobol);
    assert!(gain > 4.5, "{gain}");
}

/// A ball in the dark.
fn in_the_dark(surface: SurfaceModel) -> Kit {
    field(surface).with(|kit| {
        kit.scene.background([0.0; 3]);
    })
}

/// A ball that only an emitter lights.
fn beside_an_emitter(center: [f64; 3], radius: f64, surface: SurfaceModel) -> Kit {
    in_the_dark(surface).with(|kit| {
        kit.glowing_ball(center, radius, diffuse(0.0), 9.0);
    })
}

#[test]
fn light_found_by_chance_and_light_aimed_at_agree_on_rough_surfaces() {
    for roughness in [0.2, 0.6, 1.0] {
        for surface in [metal("gold", roughness), rough_glass(1.5, roughness), mixture(roughness)] {
            // One emitter is so near that it reaches below the ball's horizon.
            let mut kit = beside_an_emitter([1.5, 2.0, 1.5], 1.2, surface);
            kit.glowing_ball([-3.0, 0.0, 3.0], 0.3, diffuse(0.0), 9.0);
            both_ways_agree(&kit);
        }
    }
}

#[test]
fn they_agree_where_the_emitter_is_behind_rough_glass_or_in_it() {
    both_ways_agree(&beside_an_emitter([0.0, 0.0, -4.0], 1.5, rough_glass(1.5, 0.4)));
    let inside = |roughness| beside_an_emitter([0.1, 0.2, 0.0], 0.3, rough_glass(1.5, roughness));
    both_ways_agree(&inside(0.4));
    both_ways_agree(inside(0.7).ball([0.0; 3], 2.0, mixture(0.5)));
}

/// Fails unless pictures of a rough ball agree by light sampling and by chance.
fn both_ways_agree(kit: &Kit) {
    let aimed = kit.clone().samples(64).mean();
    let by_chance = kit.clone().paper(PaperSettings::default()).samples(256).mean();
    aimed.must_agree(by_chance, &format!("{:?}", kit.scene.description.materials[0].surface));
}

/// The index of a glass.
fn index(name: &str) -> f64 {
    NAMED_IORS.iter().find(|(known, _)| *known == name).expect("a glass").1
}

#[test]
fn every_material_may_glow() {
    let black = PrincipledParameters { base_color: Rgb::ZERO, ..Default::default() };
    let clear =
        PrincipledParameters { base_color: Rgb::ONE, transmission: 1.0, ..Default::default() };
    for (surface, is_opaque) in [
        (diffuse(0.0), true),
        (SurfaceModel::Diffuse { albedo: Rgb::ZERO, roughness: 0.5 }, true),
        (mirror(0.0), true),
        (metal("iron", 0.5), true),
        (rough_glass(index("diamond"), 0.0), false),
        (rough_glass(1.5, 0.3), false),
        (SurfaceModel::Plastic { albedo: Rgb::ZERO, ior: 1.5, roughness: 0.0 }, true),
        (SurfaceModel::Principled(black), true),
        (SurfaceModel::Principled(clear), false),
        (phong([0.0, 0.0], 1.0, true), true),
    ] {
        // In the dark a ball sends its emission and, where light can run through it, more.
        let mut kit = in_the_dark(surface);
        kit.scene.field_of_view(10.0);
        kit.material(0).emission = Rgb::splat(0.5);
        let estimate = kit.mean();
        if is_opaque {
            must_be_near(estimate, 0.5, &format!("{surface:?}"));
        } else {
            // Le at the front, and through it, over the squared index, what glows behind.
            assert!(estimate.mean > 0.52, "{surface:?}: {estimate:?}");
        }
    }
}
