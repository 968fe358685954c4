//! Every material against the two laws that surfaces obey: light may go both ways (Helmholtz), and
//! none is made. One list of materials serves these checks and the chi-square table.
//!
//! The energy is the share of light that a surface in a white furnace sends back, as it is drawn and
//! as it is evaluated (`energy.rs`). Each model has its own tolerance beside the interval of
//! confidence: none where it has a formula, and what its documentation says where it reads tables
//! (`samples.rs`).

mod energy;
mod samples;

use std::sync::Arc;

use crate::color::Rgb;
use crate::error::Result;
use crate::material::Lobe;
use crate::math::DVec3;
use crate::sampling::{Hemisphere, Sampler, sin_cos};
use crate::task::Cancel;

use super::check::{Check, Effort, Finding, Group, Measured, seed};
use super::statistics::Estimate;

use samples::{Promise, Tolerance};
pub(super) use samples::{Sample, samples};

/// Angles of `wo` from the normal, in degrees, at which the energy is measured.
const DEGREES: [f64; 6] = [0.0, 30.0, 60.0, 75.0, 85.0, 89.0];
/// The same with full effort.
const MORE_DEGREES: [f64; 18] = [
    0.0, 10.0, 20.0, 30.0, 40.0, 45.0, 50.0, 55.0, 60.0, 65.0, 70.0, 75.0, 80.0, 85.0, 87.0, 89.0,
    89.7, 89.95,
];
/// Directions behind each mean.
const DIRECTIONS: [u32; 3] = [512, 2048, 2048];
/// Pairs of directions that must be worth the same both ways.
const PAIRS: [u32; 3] = [2000, 10_000, 40_000];
/// What f32 may make of a value, as a share of it.
const ROUNDING: f32 = 1e-4;

/// Two checks for each material: energy, and reciprocity together with the weights.
pub(super) fn checks(effort: Effort) -> Vec<Check> {
    let (directions, pairs) = (effort.choose(DIRECTIONS), effort.choose(PAIRS));
    let degrees: &[f64] = if effort == Effort::Full { &MORE_DEGREES } else { &DEGREES };
    let of_sample = |sample: Sample| {
        let sample = Arc::new(sample);
        let is_fair = sample.promise != Promise::Neither;
        let (name, of_energy) = (sample.name.clone(), sample.clone());
        let energy = Check::new(Group::Materials, format!("energy of {name}"), move |cancel| {
            keeps_its_promise(&of_energy, degrees, directions, cancel)
        });
        let both_ways = is_fair.then(|| {
            let name = format!("both ways through {name}");
            Check::new(Group::Materials, name, move |_| Ok(both_ways_alike(&sample, pairs)))
        });
        [Some(energy), both_ways]
    };
    samples(effort).into_iter().flat_map(of_sample).flatten().collect()
}

fn keeps_its_promise(
    sample: &Sample,
    degrees: &[f64],
    directions: u32,
    cancel: &Cancel,
) -> Result<Measured> {
    let mut worst = 1.0f64;
    let (mut drawn, mut evaluated) = (Range::NOTHING, Range::NOTHING);
    for &degrees in degrees {
        cancel.check()?;
        let energy = energy::energy(sample, direction(degrees), directions);
        energy.drawn.iter().for_each(|energy| drawn.include(energy.mean));
        energy.evaluated.iter().for_each(|energy| evaluated.include(energy.mean));
        let Tolerance { drawn: of_drawn, evaluated: of_evaluated } = sample.tolerance;
        for (energies, tolerance) in [(energy.drawn, of_drawn), (energy.evaluated, of_evaluated)] {
            let each =
                energies.into_iter().map(|energy| p_value(energy, sample.promise, tolerance));
            worst = each.fold(worst, f64::min);
        }
    }
    let angles = degrees.len();
    if sample.promise == Promise::Neither {
        let Range { least, most } = evaluated;
        let told = format!("{}: sends back {least:.2} to {most:.2} of the light", sample.name);
        // What the formula says, which holds straight from above and is the most.
        let expected = sample.material.most_energy();
        let wrong = usize::from((most - f64::from(expected.max_element())).abs() > 0.01);
        let detail = format!("{told} over {angles} angles, as it is known to");
        return Ok(Measured::new(Finding::Wrong(wrong), detail).with_remark(told));
    }
    let detail = format!(
        "drawn {drawn} (beside {:.0e}), evaluated {evaluated} (beside {:.0e}) of the light over \
         {angles} angles",
        sample.tolerance.drawn, sample.tolerance.evaluated
    );
    // Each of the comparisons has its share of the significance (Bonferroni).
    let comparisons = 6.0 * angles as f64;
    Ok(Measured::new(Finding::PValue((worst * comparisons).min(1.0)), detail))
}

/// From the least to the most that was measured.
struct Range {
    least: f64,
    most: f64,
}

impl Range {
    const NOTHING: Self = Self { least: f64::INFINITY, most: f64::NEG_INFINITY };

    fn include(&mut self, value: f64) {
        *self = Self { least: self.least.min(value), most: self.most.max(value) };
    }
}

impl std::fmt::Display for Range {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:.5} to {:.5}", self.least, self.most)
    }
}

/// The probability of this energy if the promise is kept but for a tolerance.
fn p_value(energy: Estimate, promise: Promise, tolerance: f64) -> f64 {
    let nearest = match promise {
        Promise::All => energy.mean.clamp(1.0 - tolerance, 1.0 + tolerance),
        _ => energy.mean.min(1.0 + tolerance),
    };
    energy.p_value(nearest)
}

/// Random pairs of directions both ways, and sampled directions with their weights.
fn both_ways_alike(sample: &Sample, pairs: u32) -> Measured {
    let (bsdf, behind) = (sample.bsdf(), sample.behind());
    let seed = seed(&sample.name, 0);
    let mut wrong = 0;
    for i in 0..pairs {
        let u = Sampler::new(seed, 1, i);
        let wo = Hemisphere::Cosine.sample(u.get_2d(0));
        let wi = Hemisphere::UniformAngle.sample(u.get_2d(4));
        wrong += usize::from(!is_near(bsdf.eval(wo, wi), bsdf.eval(wi, wo)));
        if bsdf.transmits() {
            // From behind both directions are seen upside down, and radiance is compressed.
            let flip = |w: DVec3| DVec3::new(w.x, w.y, -w.z);
            let there = bsdf.eval(wo, flip(wi)) * (sample.eta * sample.eta) as f32;
            wrong += usize::from(!is_near(there, behind.eval(wi, flip(wo))));
        }
        let drawn = bsdf.sample(wo, u.get(2), u.get_2d(8), &|| u.get_2d(12));
        let Some(drawn) = drawn else { continue };
        if drawn.lobe != Lobe::Delta {
            let cos = drawn.wi.z.abs();
            let weight = bsdf.eval(wo, drawn.wi) * (cos / bsdf.pdf(wo, drawn.wi)) as f32;
            wrong += usize::from(!is_near(weight, drawn.weight));
        }
    }
    Measured::new(Finding::Wrong(wrong), format!("{wrong} of {pairs} pairs differ"))
}

fn is_near(a: Rgb, b: Rgb) -> bool {
    let allowed = a.abs().max(b.abs()) * ROUNDING + Rgb::splat(1e-12);
    (a - b).abs().cmple(allowed).all()
}

/// A direction at an angle from the normal.
fn direction(degrees: f64) -> DVec3 {
    let (sin, cos) = sin_cos(degrees.to_radians());
    DVec3::new(sin, 0.0, cos)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Diffuse, Model};
    use crate::verify::check::{run_all, share_significance};

    #[test]
    fn every_material_keeps_its_promise() {
        let mut checks = checks(Effort::Quick);
        share_significance(&mut checks);
        let outcomes = run_all(&checks, &Cancel::default(), &|_| ()).expect("nobody cancels");
        let failed: Vec<String> = checks
            .iter()
            .zip(&outcomes)
            .filter(|(_, outcome)| !outcome.passed)
            .map(|(check, outcome)| format!("{}: {}", check.name, outcome.detail))
            .collect();
        assert!(failed.is_empty(), "{failed:#?}");
    }

    /// A surface that sends back a ten thousandth too much, and one that is not reciprocal.
    #[test]
    fn a_broken_promise_is_found() {
        let bright = Model::Diffuse(Diffuse { albedo: Rgb::splat(1.0001) });
        let bright = Sample::opaque("too bright", bright, Promise::AtMostAll);
        let found = keeps_its_promise(&bright, &DEGREES, 512, &Cancel::default());
        let found = found.expect("nobody cancels").finding;
        assert!(matches!(found, Finding::PValue(p) if p < 1e-9));
        let classic = samples(Effort::Quick).into_iter().find(|s| s.promise == Promise::Neither);
        let found = both_ways_alike(&classic.expect("classic phong"), 100);
        assert!(matches!(found.finding, Finding::Wrong(wrong) if wrong > 20));
    }
}
