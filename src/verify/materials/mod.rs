//! Checks every material for reciprocity (Helmholtz) and energy conservation. One list of materials
//! serves these checks and the chi-square table.
//!
//! The energy is the fraction of light that a surface in a white furnace scatters back, as sampled
//! and as evaluated (`energy.rs`). Each model has its own tolerance in addition to the confidence
//! interval: none for a formula, and the documented one for a model that reads tables (`cases.rs`).

mod cases;
mod energy;

use std::sync::Arc;

use crate::color::Rgb;
use crate::error::Result;
use crate::material::Lobe;
use crate::math::DVec3;
use crate::sampling::{Hemisphere, Sampler, sin_cos};
use crate::task::CancelToken;

use super::check::{Check, CheckGroup, CheckMeasurement, Effort, TestStatistic, seed};
use super::statistics::MeanEstimate;

use cases::{EnergyBound, Tolerance};
pub(super) use cases::{MaterialCase, material_cases};

/// Angles of `wo` from the normal, in degrees, at which the energy is measured.
const DEGREES: [f64; 6] = [0.0, 30.0, 60.0, 75.0, 85.0, 89.0];
/// Angles in degrees for full effort.
const MORE_DEGREES: [f64; 18] = [
    0.0, 10.0, 20.0, 30.0, 40.0, 45.0, 50.0, 55.0, 60.0, 65.0, 70.0, 75.0, 80.0, 85.0, 87.0, 89.0,
    89.7, 89.95,
];
/// Directions per mean.
const DIRECTIONS: [u32; 3] = [512, 2048, 2048];
/// Pairs of directions tested for reciprocity.
const PAIRS: [u32; 3] = [2000, 10_000, 40_000];
/// Relative error of f32 rounding.
const ROUNDING: f32 = 1e-4;

/// Returns two checks per material: one for energy, one for reciprocity and sample weights.
pub(super) fn checks(effort: Effort) -> Vec<Check> {
    let (directions, pairs) = (effort.select(DIRECTIONS), effort.select(PAIRS));
    let degrees: &[f64] = if effort == Effort::Full { &MORE_DEGREES } else { &DEGREES };
    let case_checks = |case: MaterialCase| {
        let case = Arc::new(case);
        let is_physical = case.energy_bound != EnergyBound::NonPhysical;
        let (name, energy_case) = (case.name.clone(), case.clone());
        let energy =
            Check::new(CheckGroup::Materials, format!("energy of {name}"), move |cancel| {
                check_energy(&energy_case, degrees, directions, cancel)
            });
        let reciprocity = is_physical.then(|| {
            let name = format!("both ways through {name}");
            Check::new(CheckGroup::Materials, name, move |_| Ok(check_reciprocity(&case, pairs)))
        });
        [Some(energy), reciprocity]
    };
    material_cases(effort).into_iter().flat_map(case_checks).flatten().collect()
}

fn check_energy(
    case: &MaterialCase,
    degrees: &[f64],
    directions: u32,
    cancel: &CancelToken,
) -> Result<CheckMeasurement> {
    let mut worst = 1.0f64;
    let (mut sampled, mut evaluated) = (MinMax::NOTHING, MinMax::NOTHING);
    for &degrees in degrees {
        cancel.check()?;
        let energy = energy::energy(case, direction(degrees), directions);
        energy.sampled.iter().for_each(|energy| sampled.include(energy.mean));
        energy.evaluated.iter().for_each(|energy| evaluated.include(energy.mean));
        let Tolerance { sampled: sampled_tolerance, evaluated: evaluated_tolerance } =
            case.tolerance;
        for (energies, tolerance) in
            [(energy.sampled, sampled_tolerance), (energy.evaluated, evaluated_tolerance)]
        {
            let each =
                energies.into_iter().map(|energy| p_value(energy, case.energy_bound, tolerance));
            worst = each.fold(worst, f64::min);
        }
    }
    let angles = degrees.len();
    if case.energy_bound == EnergyBound::NonPhysical {
        let MinMax { min, max } = evaluated;
        let text = format!("{}: albedo {min:.2} to {max:.2}", case.name);
        // The maximum of the formula, reached at normal incidence.
        let expected = case.material.max_albedo();
        let wrong = usize::from((max - f64::from(expected.max_element())).abs() > 0.01);
        let detail = format!("{text} over {angles} angles, as expected");
        return Ok(CheckMeasurement::new(TestStatistic::ErrorCount(wrong), detail).with_note(text));
    }
    let detail = format!(
        "albedo {sampled} sampled (tolerance {:.0e}), {evaluated} evaluated (tolerance {:.0e}) over \
         {angles} angles",
        case.tolerance.sampled, case.tolerance.evaluated
    );
    // Each comparison gets its share of the significance (Bonferroni).
    let comparisons = 6.0 * angles as f64;
    Ok(CheckMeasurement::new(TestStatistic::PValue((worst * comparisons).min(1.0)), detail))
}

/// Range of the measured values.
struct MinMax {
    min: f64,
    max: f64,
}

impl MinMax {
    const NOTHING: Self = Self { min: f64::INFINITY, max: f64::NEG_INFINITY };

    fn include(&mut self, value: f64) {
        *self = Self { min: self.min.min(value), max: self.max.max(value) };
    }
}

impl std::fmt::Display for MinMax {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:.5} to {:.5}", self.min, self.max)
    }
}

/// The p-value of an energy under the bound, widened by the tolerance.
fn p_value(energy: MeanEstimate, bound: EnergyBound, tolerance: f64) -> f64 {
    let nearest = match bound {
        EnergyBound::Lossless => energy.mean.clamp(1.0 - tolerance, 1.0 + tolerance),
        _ => energy.mean.min(1.0 + tolerance),
    };
    energy.p_value(nearest)
}

/// Tests random pairs of directions both ways, and sampled directions with their weights.
fn check_reciprocity(case: &MaterialCase, pairs: u32) -> CheckMeasurement {
    let (bsdf, reversed) = (case.bsdf(), case.reversed_bsdf());
    let seed = seed(&case.name, 0);
    let mut wrong = 0;
    for i in 0..pairs {
        let u = Sampler::independent(seed, 1, i);
        let wo = Hemisphere::Cosine.sample(u.get_2d(0));
        let wi = Hemisphere::UniformAngle.sample(u.get_2d(4));
        wrong += usize::from(!is_near(bsdf.eval(wo, wi), bsdf.eval(wi, wo)));
        if bsdf.is_rough_transmissive() {
            // From behind, both directions are upside down, and radiance is scaled by the squared
            // index.
            let flip = |w: DVec3| DVec3::new(w.x, w.y, -w.z);
            let forward = bsdf.eval(wo, flip(wi)) * (case.eta * case.eta) as f32;
            wrong += usize::from(!is_near(forward, reversed.eval(wi, flip(wo))));
        }
        let sampled = bsdf.sample(wo, u.get(2), u.get_2d(8), &|| u.get_2d(12));
        let Some(sampled) = sampled else { continue };
        if sampled.lobe != Lobe::Delta {
            let cos = sampled.wi.z.abs();
            let weight = bsdf.eval(wo, sampled.wi) * (cos / bsdf.pdf(wo, sampled.wi)) as f32;
            wrong += usize::from(!is_near(weight, sampled.weight));
        }
    }
    CheckMeasurement::new(
        TestStatistic::ErrorCount(wrong),
        format!("{wrong} of {pairs} pairs differ"),
    )
}

fn is_near(a: Rgb, b: Rgb) -> bool {
    let tolerance = a.abs().max(b.abs()) * ROUNDING + Rgb::splat(1e-12);
    (a - b).abs().cmple(tolerance).all()
}

/// A direction at this angle from the normal.
fn direction(degrees: f64) -> DVec3 {
    let (sin, cos) = sin_cos(degrees.to_radians());
    DVec3::new(sin, 0.0, cos)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Diffuse, Model};
    use crate::verify::check::{run_all, split_significance};

    #[test]
    fn every_material_keeps_its_promise() {
        let mut checks = checks(Effort::Quick);
        split_significance(&mut checks);
        let results = run_all(&checks, &CancelToken::default(), &|_| ()).expect("nobody cancels");
        let failed: Vec<String> = checks
            .iter()
            .zip(&results)
            .filter(|(_, result)| !result.passed)
            .map(|(check, result)| format!("{}: {}", check.name, result.detail))
            .collect();
        assert!(failed.is_empty(), "{failed:#?}");
    }

    /// A surface that scatters a ten-thousandth too much, and one that is not reciprocal.
    #[test]
    fn a_broken_promise_is_found() {
        let bright = Model::Diffuse(Diffuse { albedo: Rgb::splat(1.0001) });
        let bright = MaterialCase::opaque("too bright", bright, EnergyBound::Passive);
        let found = check_energy(&bright, &DEGREES, 512, &CancelToken::default());
        let found = found.expect("nobody cancels").statistic;
        assert!(matches!(found, TestStatistic::PValue(p) if p < 1e-9));
        let classic = material_cases(Effort::Quick)
            .into_iter()
            .find(|s| s.energy_bound == EnergyBound::NonPhysical);
        let found = check_reciprocity(&classic.expect("classic phong"), 100);
        assert!(matches!(found.statistic, TestStatistic::ErrorCount(wrong) if wrong > 20));
    }
}
