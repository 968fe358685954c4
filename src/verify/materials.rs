//! Every material against the two laws that surfaces obey: light may go both ways (Helmholtz), and
//! none is made. One list of materials serves these checks and the chi-square table.
//!
//! The energy is the mean weight of sampled directions, the refracted ones freed of the change of
//! radiance between media: the share of light that a surface in a white furnace sends back. The
//! weights are held against `f cos / p`, so that what is checked is also what is evaluated.

use crate::accel::Cancel;
use crate::color::Rgb;
use crate::error::Result;
use crate::material::{
    Bsdf, Coat, Conductor, Dielectric, Diffuse, Lobe, Material, Metal, Mirror, Model, OrenNayar,
    Phong, Plastic,
};
use crate::math::DVec3;
use crate::sampling::{Hemisphere, Sampler, sin_cos};

use super::check::{Check, Effort, Finding, Group, Measured, seed};
use super::statistics::Estimate;

/// Angles of `wo` from the normal, in degrees, at which the energy is measured.
const DEGREES: [f64; 6] = [0.0, 30.0, 60.0, 75.0, 85.0, 89.0];
/// Independent means behind each energy, and directions behind each mean.
const SEEDS: u64 = 32;
const DIRECTIONS: [u32; 3] = [500, 2000, 8000];
/// Pairs of directions that must be worth the same both ways.
const PAIRS: [u32; 3] = [2000, 10_000, 40_000];
/// What f32 may make of a value, as a share of it.
const ROUNDING: f32 = 1e-4;
/// What tables of lost energy may be off next to the horizon, as their documentation says.
const TABLES: f64 = 3e-3;

/// A material to be checked.
pub(super) struct Sample {
    /// Its name and parameters.
    pub(super) name: String,
    material: Material,
    /// The index of refraction beyond the surface over the one before.
    eta: f64,
    promise: Promise,
}

/// What a model says of its energy.
#[derive(Clone, Copy)]
enum Promise {
    /// All light is sent on.
    All,
    /// No more than all.
    AtMostAll,
    /// It creates light and is not reciprocal, and is there to show that.
    Neither,
}

impl Sample {
    /// The material as it is met.
    pub(super) fn bsdf(&self) -> Bsdf {
        self.material.bsdf(None, self.eta, Hemisphere::Cosine)
    }

    /// The material met from its other side.
    fn behind(&self) -> Bsdf {
        self.material.bsdf(None, 1.0 / self.eta, Hemisphere::Cosine)
    }
}

/// One material of every model, over their roughness.
pub(super) fn samples() -> Vec<Sample> {
    use Promise::{All, AtMostAll, Neither};
    let mut samples = Vec::new();
    let mut add = |name: &str, model: Model, eta: f64, promise| {
        samples.push(Sample { name: name.to_owned(), material: model.into(), eta, promise });
    };
    let grey = Rgb::new(0.9, 0.5, 0.1);
    add("white diffuse", Model::Diffuse(Diffuse { albedo: Rgb::ONE }), 1.0, All);
    for roughness in [0.3, 1.0] {
        let white = OrenNayar { albedo: Rgb::ONE, roughness };
        add(&format!("white rough diffuse {roughness}"), Model::OrenNayar(white), 1.0, All);
        let coloured = OrenNayar { albedo: grey, roughness };
        add(&format!("rough diffuse {roughness}"), Model::OrenNayar(coloured), 1.0, AtMostAll);
    }
    add("mirror", Model::Mirror(Mirror { reflectance: Rgb::ONE }), 1.0, All);
    for roughness in [0.0, 0.4, 1.0] {
        let gold = Conductor::new(Metal::NAMED[0].1, roughness);
        let name = format!("{}, roughness {roughness}", Metal::NAMED[0].0);
        add(&name, Model::Conductor(gold), 1.0, AtMostAll);
        let lossless = Metal { ior: Rgb::ZERO, extinction: Rgb::ONE };
        let lossless = Model::Conductor(Conductor::new(lossless, roughness));
        add(&format!("lossless metal, roughness {roughness}"), lossless, 1.0, All);
    }
    for eta in [1.5, 1.0 / 1.5, 2.4] {
        let glass = Dielectric { ior: eta, priority: 0 };
        add(&format!("glass, eta {eta:.2}"), Model::Dielectric(glass), eta, All);
    }
    for roughness in [0.0, 0.3, 0.7, 1.0] {
        for (colour, albedo, promise) in [("white", Rgb::ONE, All), ("red", grey, AtMostAll)] {
            let plastic = Plastic { albedo, coat: Coat::new(1.5, roughness) };
            let name = format!("{colour} plastic, roughness {roughness}");
            add(&name, Model::Plastic(plastic), 1.0, promise);
        }
    }
    let phong = |exponent, normalized| {
        let (albedo, specular) = (Rgb::splat(0.3), Rgb::splat(0.7));
        Model::Phong(Phong { albedo, specular, exponent, normalized })
    };
    for exponent in [3.0, 30.0, 300.0] {
        add(&format!("phong, exponent {exponent}"), phong(exponent, true), 1.0, AtMostAll);
    }
    add("classic phong, exponent 3", phong(3.0, false), 1.0, Neither);
    samples
}

/// Two checks for each material: energy, and reciprocity together with the weights.
pub(super) fn checks(effort: Effort) -> Vec<Check> {
    let (directions, pairs) = (effort.choose(DIRECTIONS), effort.choose(PAIRS));
    let energy = samples().into_iter().map(move |sample| {
        let name = format!("energy of {}", sample.name);
        Check::new(Group::Materials, name, move |cancel| energy(&sample, directions, cancel))
    });
    let both_ways = samples().into_iter().filter(|s| !matches!(s.promise, Promise::Neither));
    let both_ways = both_ways.map(move |sample| {
        let name = format!("both ways through {}", sample.name);
        Check::new(Group::Materials, name, move |_| Ok(both_ways_alike(&sample, pairs)))
    });
    energy.chain(both_ways).collect()
}

fn energy(sample: &Sample, directions: u32, cancel: &Cancel) -> Result<Measured> {
    let bsdf = sample.bsdf();
    let mut worst = 1.0f64;
    let (mut least, mut most) = (f64::INFINITY, 0.0f64);
    for degrees in DEGREES {
        cancel.check()?;
        let means = mean_weights(&bsdf, direction(degrees), directions, &sample.name);
        for channel in 0..3 {
            let values: Vec<f64> = means.iter().map(|mean| mean[channel]).collect();
            let energy = Estimate::of(&values);
            (least, most) = (least.min(energy.mean), most.max(energy.mean));
            worst = worst.min(p_value(energy, sample.promise));
        }
    }
    let detail = format!("from {least:.4} to {most:.4} of the light over {} angles", DEGREES.len());
    if let Promise::Neither = sample.promise {
        let is_shown = most > 1.1;
        let detail = format!("{detail}: creates light, as it is known to");
        return Ok(Measured::new(Finding::Wrong(usize::from(!is_shown)), detail));
    }
    // Each of the comparisons has its share of the significance (Bonferroni).
    let comparisons = 3.0 * DEGREES.len() as f64;
    Ok(Measured::new(Finding::PValue((worst * comparisons).min(1.0)), detail))
}

/// The probability of this energy if the promise is kept.
fn p_value(energy: Estimate, promise: Promise) -> f64 {
    let nearest = match promise {
        Promise::All => energy.mean.clamp(1.0 - TABLES, 1.0 + TABLES),
        _ => energy.mean.min(1.0 + TABLES),
    };
    energy.p_value(nearest)
}

/// The mean weights of directions drawn, one for each seed.
fn mean_weights(bsdf: &Bsdf, wo: DVec3, directions: u32, name: &str) -> Vec<[f64; 3]> {
    let weight = |seed: u64, i: u32| {
        let u = Sampler::new(seed, 0, i);
        let drawn = bsdf.sample(wo, u.get(2), u.get_2d(0));
        drawn.map_or(DVec3::ZERO, |s| s.weight.as_dvec3() * (s.eta * s.eta))
    };
    let mean = |index: u64| {
        let seed = seed(name, index);
        let sum: DVec3 = (0..directions).map(|i| weight(seed, i)).sum();
        (sum / f64::from(directions)).to_array()
    };
    (0..SEEDS).map(mean).collect()
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
        let Some(drawn) = bsdf.sample(wo, u.get(2), u.get_2d(8)) else { continue };
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

    /// A surface that sends back two percent too much, and one that is not reciprocal.
    #[test]
    fn a_broken_promise_is_found() {
        let bright = Sample {
            name: "too bright".to_owned(),
            material: Model::Diffuse(Diffuse { albedo: Rgb::splat(1.02) }).into(),
            eta: 1.0,
            promise: Promise::AtMostAll,
        };
        let found = energy(&bright, 500, &Cancel::default()).expect("nobody cancels");
        assert!(matches!(found.finding, Finding::PValue(p) if p < 1e-9));
        let classic = samples().into_iter().find(|s| matches!(s.promise, Promise::Neither));
        let found = both_ways_alike(&classic.expect("classic phong"), 100);
        assert!(matches!(found.finding, Finding::Wrong(wrong) if wrong > 20));
    }
}
