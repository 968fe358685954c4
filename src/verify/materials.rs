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
    Phong, Plastic, Principled, PrincipledParameters,
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
    /// Whether the chi-square table has rows of it.
    pub(super) is_tabled: bool,
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

use Promise::{All, AtMostAll, Neither};

impl Sample {
    /// A material that light does not come through.
    fn opaque(name: impl Into<String>, model: Model, promise: Promise) -> Self {
        Self { name: name.into(), material: model.into(), eta: 1.0, promise, is_tabled: true }
    }

    /// The material as it is met.
    pub(super) fn bsdf(&self) -> Bsdf<'_> {
        self.material.bsdf(None, self.eta, Hemisphere::Cosine)
    }

    /// The material met from its other side.
    fn behind(&self) -> Bsdf<'_> {
        self.material.bsdf(None, 1.0 / self.eta, Hemisphere::Cosine)
    }
}

/// One material of every model, over their roughness.
pub(super) fn samples() -> Vec<Sample> {
    [matt(), metals(), glass(), plastic(), principled(), phong()].into_iter().flatten().collect()
}

/// A colour that tells its channels apart.
const RED: Rgb = Rgb::new(0.9, 0.5, 0.1);

fn matt() -> Vec<Sample> {
    let white = Model::Diffuse(Diffuse { albedo: Rgb::ONE });
    let mut samples = vec![Sample::opaque("white diffuse", white, All)];
    for roughness in [0.3, 1.0] {
        for (color, albedo, promise) in [("white ", Rgb::ONE, All), ("", RED, AtMostAll)] {
            let name = format!("{color}rough diffuse {roughness}");
            let model = Model::OrenNayar(OrenNayar { albedo, roughness });
            samples.push(Sample::opaque(name, model, promise));
        }
    }
    samples
}

fn metals() -> Vec<Sample> {
    let mirror = Model::Mirror(Mirror { reflectance: Rgb::ONE });
    let mut samples = vec![Sample::opaque("mirror", mirror, All)];
    let lossless = Metal { ior: Rgb::ZERO, extinction: Rgb::ONE };
    for roughness in [0.0, 0.4, 1.0] {
        for (name, metal, promise) in [
            (Metal::NAMED[0].0, Conductor::new(Metal::NAMED[0].1, roughness), AtMostAll),
            ("lossless metal", Conductor::new(lossless, roughness), All),
            ("white metal", Conductor::of_color(Rgb::ONE, roughness), All),
            ("red metal", Conductor::of_color(RED, roughness), AtMostAll),
        ] {
            let name = format!("{name}, roughness {roughness}");
            samples.push(Sample::opaque(name, Model::Conductor(metal), promise));
        }
    }
    samples
}

/// From both sides. Lobes of little roughness are narrower than the cells of the chi-square table;
/// that has rows of its own for indices that are nearly the same.
fn glass() -> Vec<Sample> {
    let mut samples = Vec::new();
    for roughness in [0.0, 0.01, 0.1, 0.3, 0.6, 1.0] {
        for eta in [1.5, 1.0 / 1.5, 2.4, 1.05] {
            let glass = Dielectric::new(eta, 0, roughness, &[1.0]);
            let name = format!("glass, eta {eta:.2}, roughness {roughness}");
            let is_tabled = roughness > 0.1 && eta != 1.05 && (eta < 2.0 || roughness == 0.6);
            let model = Model::Dielectric(glass);
            samples.push(Sample { eta, is_tabled, ..Sample::opaque(name, model, All) });
        }
    }
    samples
}

fn plastic() -> Vec<Sample> {
    let mut samples = Vec::new();
    for roughness in [0.0, 0.3, 0.7, 1.0] {
        for (color, albedo, promise) in [("white", Rgb::ONE, All), ("red", RED, AtMostAll)] {
            let model = Model::Plastic(Plastic { albedo, coat: Coat::new(1.5, roughness) });
            let name = format!("{color} plastic, roughness {roughness}");
            samples.push(Sample::opaque(name, model, promise));
        }
    }
    samples
}

/// Mixtures, white and coloured, of all their parts, from both sides.
fn principled() -> Vec<Sample> {
    let plain = PrincipledParameters {
        base_color: Rgb::ONE,
        metallic: 0.0,
        roughness: 0.5,
        specular: 0.5,
        ior: 1.5,
        coat: 0.0,
        coat_roughness: 0.3,
        transmission: 0.0,
    };
    let mixed = PrincipledParameters { metallic: 0.3, transmission: 0.4, ..plain };
    let coated = PrincipledParameters { coat: 0.5, roughness: 0.9, specular: 1.0, ..mixed };
    let mut samples = Vec::new();
    for (name, eta, parameters) in [
        ("matt", 1.0, plain),
        ("mixture", 1.5, mixed),
        ("mixture from inside", 1.0 / 1.5, mixed),
        ("smooth mixture", 1.5, PrincipledParameters { roughness: 0.0, ..mixed }),
        ("matt, coated", 1.0, PrincipledParameters { coat: 1.0, ..plain }),
        ("metal, coated", 1.0, PrincipledParameters { coat: 1.0, metallic: 1.0, ..plain }),
        ("mixture, coated", 1.5, coated),
        ("mixture, coated, from inside", 1.0 / 1.5, coated),
    ] {
        for (color, base_color) in [("white", Rgb::ONE), ("red", RED)] {
            let is_lossless = color == "white" && parameters.coat == 0.0;
            let promise = if is_lossless { All } else { AtMostAll };
            let parameters = PrincipledParameters { base_color, ..parameters };
            let model = Model::Principled(Principled::new(parameters, &[1.0]));
            let sample = Sample::opaque(format!("principled {color} {name}"), model, promise);
            samples.push(Sample { eta, is_tabled: color == "red", ..sample });
        }
    }
    samples
}

fn phong() -> Vec<Sample> {
    let phong = |exponent, normalized| {
        let (albedo, specular) = (Rgb::splat(0.3), Rgb::splat(0.7));
        Model::Phong(Phong { albedo, specular, exponent, normalized })
    };
    let of = |exponent: f64| {
        Sample::opaque(format!("phong, exponent {exponent}"), phong(exponent, true), AtMostAll)
    };
    let classic = Sample::opaque("classic phong, exponent 3", phong(3.0, false), Neither);
    [of(3.0), of(30.0), of(300.0), classic].into()
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
fn mean_weights(bsdf: &Bsdf<'_>, wo: DVec3, directions: u32, name: &str) -> Vec<[f64; 3]> {
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
        let bright = Model::Diffuse(Diffuse { albedo: Rgb::splat(1.02) });
        let bright = Sample::opaque("too bright", bright, AtMostAll);
        let found = energy(&bright, 500, &Cancel::default()).expect("nobody cancels");
        assert!(matches!(found.finding, Finding::PValue(p) if p < 1e-9));
        let classic = samples().into_iter().find(|s| matches!(s.promise, Promise::Neither));
        let found = both_ways_alike(&classic.expect("classic phong"), 100);
        assert!(matches!(found.finding, Finding::Wrong(wrong) if wrong > 20));
    }
}
