//! The choice of pairs.

use crate::color::Rgb;
use crate::geometry::{Side, Sphere, SphereRows, SphereSet, SurfaceHit};
use crate::light::{Emitter, LightSampleContext};
use crate::math::DVec3;
use crate::sampling::Sampler;

use super::super::worth::is_accepted;
use super::super::{Caster, CasterSurface, Casters, ConnectedLight, PairSampler};

/// Balls and emitters in a unit box.
fn sampler(balls: u32, emitters: u32, sun: Option<(DVec3, f64, f64)>) -> PairSampler {
    let sphere = |i: u64| {
        let sampler = Sampler::independent(8, i, 0);
        let center = DVec3::new(sampler.get(0), sampler.get(1), sampler.get(2));
        Sphere { center, radius: 0.05 * sampler.get(3) + 1e-3 }
    };
    let exact: Vec<_> = (0..u64::from(balls + emitters)).map(sphere).collect();
    let spheres = SphereSet::new(SphereRows { exact, table: Vec::new() }).expect("few spheres");
    let surface = |id: u32| match id % 2 {
        0 => CasterSurface::Opaque(0.8),
        _ => CasterSurface::Dielectric(1.5),
    };
    let caster = |id| Caster { id, ball: spheres.sphere(id), surface: surface(id) };
    let casters: Vec<_> = (0..balls).map(caster).collect();
    let emitter = |id| Emitter::opaque(id, Rgb::splat(1.0 + id as f32));
    let emitters: Vec<_> = (balls..balls + emitters).map(emitter).collect();
    PairSampler::new(Casters::find(&casters, &[], &spheres), &emitters, sun, &spheres, false)
}

fn contexts() -> impl Iterator<Item = LightSampleContext> {
    (0..20u64).map(|i| {
        let u: [f64; 6] = std::array::from_fn(|d| Sampler::independent(9, i, 0).get(d as u32));
        let normal = (DVec3::new(u[0], u[1], u[2]) - 0.5).normalize();
        let point = (DVec3::new(u[3], u[4], u[5]) - 0.5) * 2.0;
        let hit = SurfaceHit { id: 99, t: 1.0, point, normal, radius: 1.0, side: Side::Outside };
        LightSampleContext { hit, is_two_sided: i % 2 == 0, is_lambertian: false }
    })
}

const SUN: Option<(DVec3, f64, f64)> = Some((DVec3::Y, 3.0, 0.1));

fn all_pairs(balls: u32, emitters: u32, has_sun: bool) -> Vec<(u32, ConnectedLight)> {
    let lights = (0..emitters).map(ConnectedLight::Emitter);
    let lights: Vec<_> = lights.chain(has_sun.then_some(ConnectedLight::Sun)).collect();
    (0..balls).flat_map(|ball| lights.iter().map(move |&light| (ball, light))).collect()
}

#[test]
fn a_few_pairs_are_all_tried_where_they_are_worth_it() {
    let sampler = sampler(3, 1, SUN);
    let mut accepted = 0;
    for ctx in contexts() {
        for inside in [None, Some(1)] {
            let chosen: Vec<_> = sampler.sample(&ctx, inside, [0.9, 0.3]).iter().collect();
            accepted += chosen.len();
            for (n, pair) in (0..).zip(all_pairs(3, 1, true)) {
                let is_chosen = chosen.iter().any(|chosen| (chosen.caster, chosen.light) == pair);
                let pmf = sampler.pmf(&ctx, inside, pair);
                assert_eq!(is_chosen, is_accepted(0.3, n, pmf), "{pair:?} {inside:?} {pmf}");
            }
        }
    }
    assert!((50..150).contains(&accepted), "{accepted}");
}

#[test]
fn probabilities_add_up_to_one_and_are_those_of_the_samples() {
    for (balls, emitters, sun) in [(9, 1, None), (5, 4, SUN), (40, 3, SUN), (300, 50, None)] {
        let sampler = sampler(balls, emitters, sun);
        let pairs = all_pairs(balls, emitters, sun.is_some());
        for ctx in contexts() {
            for inside in [None, Some(2)] {
                let choice = |&pair| sampler.choice_pmf(&ctx, inside, pair);
                let sum: f64 = pairs.iter().map(choice).sum();
                // A tree may end at balls that are all below the horizon.
                assert!(sum <= 1.0 + 1e-9, "{balls} {sum}");
                // Inside of an opaque ball, or one that no light is apart from, there are none.
                let has_any = inside.is_none() || sum > 0.0;
                if has_any && (ctx.is_two_sided || inside.is_some()) {
                    assert!((sum - 1.0).abs() < 1e-9, "{balls} {inside:?} {sum}");
                }
                for i in 0..200u32 {
                    let numbers = Sampler::independent(3, i.into(), 0);
                    let u = [numbers.get(0), numbers.get(1)];
                    for pair in sampler.sample(&ctx, inside, u).iter() {
                        let pmf = sampler.pmf(&ctx, inside, (pair.caster, pair.light));
                        assert!((pair.pmf - pmf).abs() <= 1e-12 * pmf);
                    }
                }
            }
        }
    }
}

/// The frequency of each pair, against its probability.
#[test]
fn pairs_are_chosen_as_often_as_they_say() {
    for (balls, emitters, sun) in [(3, 1, SUN), (5, 4, SUN), (40, 3, SUN)] {
        let sampler = sampler(balls, emitters, sun);
        let pairs = all_pairs(balls, emitters, sun.is_some());
        let ctx = contexts().next().expect("some");
        let count = 200_000u32;
        let mut found = vec![0.0; pairs.len()];
        for i in 0..count {
            let numbers = Sampler::independent(4, i.into(), 0);
            for pair in sampler.sample(&ctx, None, [numbers.get(0), numbers.get(1)]).iter() {
                let is_it = |other: &&(u32, ConnectedLight)| **other == (pair.caster, pair.light);
                let index = pairs.iter().position(|other| is_it(&other)).expect("listed");
                found[index] += 1.0;
            }
        }
        for (pair, found) in pairs.iter().zip(found) {
            let pmf = sampler.pmf(&ctx, None, *pair);
            let expected = f64::from(count) * pmf;
            // 5 standard deviations: 6e-7 for each of at most 160 pairs.
            let deviation = (expected * (1.0 - pmf)).sqrt();
            let off: f64 = found - expected;
            assert!(off.abs() <= 5.0 * deviation + 5.0, "{pair:?}: {found}, not {expected}");
        }
    }
}
