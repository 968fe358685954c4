//! The choice of pairs.

use crate::color::Rgb;
use crate::geometry::{Side, Sphere, SphereRows, SphereSet, SurfaceHit};
use crate::light::{Emitter, LightSampleContext};
use crate::math::DVec3;
use crate::sampling::{Sampler, SamplerKind};

use super::super::worth::is_accepted;
use super::super::{Caster, CasterSurface, Casters, ConnectedLight, PairSampler};

/// Balls and emitters in a unit box.
fn sampler(balls: u32, emitters: u32, sun: Option<(DVec3, f64, f64)>) -> PairSampler {
    sampler_of(balls, &(balls..balls + emitters).map(|id| 1.0 + id as f32).collect::<Vec<_>>(), sun)
}

/// Balls and emitters of these radiances.
fn sampler_of(balls: u32, radiances: &[f32], sun: Option<(DVec3, f64, f64)>) -> PairSampler {
    let emitters = radiances.len() as u32;
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
    let emitter = |(id, radiance): (u32, &f32)| Emitter::opaque(id, Rgb::splat(*radiance));
    let emitters: Vec<_> = (balls..).zip(radiances).map(emitter).collect();
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
            let chosen: Vec<_> = sampler.sample(&ctx, inside, [0.9, 0.3], || 0.4).iter().collect();
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
                    for pair in sampler.sample(&ctx, inside, u, || numbers.get(2)).iter() {
                        let pmf = sampler.pmf(&ctx, inside, (pair.caster, pair.light));
                        assert!((pair.pmf - pmf).abs() <= 1e-12 * pmf);
                    }
                }
            }
        }
    }
}

/// The frequency of each pair, against its probability, also with numbers of 32 bits.
#[test]
fn pairs_are_chosen_as_often_as_they_say() {
    let many = sampler(300, 50, None);
    let weak = sampler_of(71, &[1.0, 0.003], None);
    let few = [(3, 1), (5, 4), (40, 3)].map(|(balls, emitters)| sampler(balls, emitters, SUN));
    for sampler in few.iter().chain([&many, &weak]) {
        for kind in [SamplerKind::Independent, SamplerKind::Sobol, SamplerKind::Stratified] {
            compare_frequencies(sampler, kind);
        }
    }
}

fn compare_frequencies(sampler: &PairSampler, kind: SamplerKind) {
    let ctx = contexts().next().expect("some");
    let pairs: Vec<_> = sampler.pairs(None).collect();
    let count = 200_000u32;
    let mut found = vec![0.0; pairs.len()];
    for i in 0..count {
        let numbers = Sampler::with_kind(kind, 4, 0, i, count);
        let u = numbers.get_2d(2);
        for pair in sampler.sample(&ctx, None, u, || numbers.get(4)).iter() {
            found[sampler.index_of(pair.caster, pair.light)] += 1.0;
        }
    }
    for (pair, found) in pairs.iter().zip(found) {
        let pmf = sampler.pmf(&ctx, None, *pair);
        let expected = f64::from(count) * pmf;
        // 5 standard deviations of independent numbers, to which a few cannot be added.
        let deviation = (expected * (1.0 - pmf)).sqrt();
        let off: f64 = found - expected;
        let is_near = off.abs() <= 5.0 * deviation + 5.0;
        assert!(is_near, "{kind:?}, {pair:?}: {found}, not {expected}");
    }
}
