//! The principled material: one material for most surfaces, with the parameters used by other
//! renderers (Burley 2012 and 2015, "Physically Based Shading at Disney"). A mixture of the other
//! models.
//!
//! With the fractions `metal = metallic`, `glass = (1 - metallic) transmission` and `base`, the
//! rest,
//!
//! ```text
//! f = c coat + t (metal conductor + glass dielectric + base gloss) + base diffuse
//! ```
//!
//! - conductor: GGX of `roughness`, with `base_color` as its reflectance at normal incidence;
//! - dielectric: glass of `ior` and `roughness`; transmitted light is multiplied by the square root
//!   of `base_color`, so that light refracted in and out has that colour;
//! - gloss: a [`Coat`] of `roughness`, with the index that reflects `2 specular` times as much as
//!   `ior`; E is the fraction that it reflects;
//! - diffuse: seen through the gloss and the coat as by [`Coat::eval_base`], with the colour
//!   `base_color` itself, not the deeper colour of [`super::Plastic`];
//! - coat: a [`Coat`] of index 1.5 and `coat_roughness`, weighted by `c = coat`. It reflects the
//!   fraction C, so that `1 - c C` reaches the layers below; `t`, the smaller of this in both
//!   directions, keeps the model energy-conserving and reciprocal.
//!
//! Energy is conserved; with a `base_color` of 1 and no coat, all light is scattered.

use std::f64::consts::FRAC_1_PI;

use serde::{Deserialize, Serialize};

use crate::color::{Rgb, luminance};
use crate::fault::fault;
use crate::math::DVec3;

use super::dielectric::DielectricBsdf;
use super::energy_compensation::hemispherical_mean;
use super::{BsdfSample, Coat, Conductor, ConductorBsdf, Dielectric, ExtraUniforms, Lobe};

/// The index of refraction of the coat.
const COAT_IOR: f64 = 1.5;
/// Maximum reflectance of the gloss at normal incidence.
const MAX_GLOSS: f64 = 0.65;

/// The parameters of a principled material, named as in scene files. All but the colour and the
/// index of refraction are in `[0, 1]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PrincipledParameters {
    /// The colour of the diffuse and metal parts and of light behind glass; each channel in
    /// `[0, 1]`.
    pub base_color: Rgb,
    /// The fraction that is metal.
    pub metallic: f64,
    /// Roughness of everything below the coat.
    pub roughness: f64,
    /// Strength of the gloss on the diffuse part; 0.5 matches `ior`.
    pub specular: f64,
    /// Index of refraction, at least 1.
    pub ior: f64,
    /// Weight of the coat.
    pub coat: f64,
    /// Roughness of the coat.
    pub coat_roughness: f64,
    /// The fraction of the non-metal part that is glass.
    pub transmission: f64,
}

impl Default for PrincipledParameters {
    /// Returns grey satin of index 1.5, without metal, glass and coat.
    fn default() -> Self {
        Self {
            base_color: Rgb::splat(0.5),
            metallic: 0.0,
            roughness: 0.5,
            specular: 0.5,
            ior: 1.5,
            coat: 0.0,
            coat_roughness: 0.0,
            transmission: 0.0,
        }
    }
}

/// A surface of metal, glass and diffuse parts under a coat. Parts with weight 0 are `None`.
#[derive(Clone, Debug)]
pub struct Principled {
    base_color: Rgb,
    conductor: Option<(f64, Conductor)>,
    dielectric: Option<(f64, Dielectric)>,
    layers: Box<PrincipledLayers>,
}

/// The layers that depend neither on a sphere's own colour nor on the medium behind the surface.
#[derive(Clone, Debug)]
struct PrincipledLayers {
    coat: Option<(f64, Coat)>,
    diffuse: Option<DiffuseBase>,
}

/// A principled surface at a point.
#[derive(Clone, Copy, Debug)]
pub struct PrincipledBsdf<'a> {
    base_color: Rgb,
    conductor: Option<(f64, ConductorBsdf<'a>)>,
    dielectric: Option<(f64, DielectricBsdf<'a>)>,
    layers: &'a PrincipledLayers,
}

/// A diffuse base under a gloss.
#[derive(Clone, Debug)]
struct DiffuseBase {
    weight: f64,
    gloss: Coat,
    /// Cosine-weighted mean of the fraction that gloss and coat transmit.
    mean_transmittance: f64,
}

/// A component to sample.
#[derive(Clone, Copy, PartialEq)]
enum Component {
    Coat,
    Conductor,
    /// Only the gloss.
    Gloss,
    /// The diffuse base and, if it is rough, the gloss over it, sampled as if the base were white.
    Diffuse,
    Dielectric,
}

const COMPONENTS: [Component; 5] = [
    Component::Coat,
    Component::Conductor,
    Component::Gloss,
    Component::Diffuse,
    Component::Dielectric,
];

impl Principled {
    /// Creates the surface; `adjacent_iors` are the indices of the media that it may border on, as
    /// for [`Dielectric::new`].
    pub fn new(parameters: PrincipledParameters, adjacent_iors: &[f64]) -> Self {
        let PrincipledParameters { base_color, metallic, roughness, ior, .. } = parameters;
        let transmission = parameters.transmission;
        let glass = (1.0 - metallic) * transmission;
        let diffuse = (1.0 - metallic) * (1.0 - transmission);
        let coat = weighted(parameters.coat, || Coat::new(COAT_IOR, parameters.coat_roughness));
        let gloss = || Coat::new(gloss_ior(ior, parameters.specular), roughness);
        let diffuse = weighted(diffuse, gloss).map(|(weight, gloss)| {
            let transmittance =
                |cos| gloss.transmittance(cos) * coat_transmittance(coat.as_ref(), cos);
            let mean_transmittance = hemispherical_mean(transmittance);
            DiffuseBase { weight, gloss, mean_transmittance }
        });
        let metal = weighted(metallic, || Conductor::from_color(base_color, roughness));
        let glass = weighted(glass, || Dielectric::new(ior, 0, roughness, adjacent_iors));
        Self {
            base_color,
            conductor: metal,
            dielectric: glass,
            layers: Box::new(PrincipledLayers { coat, diffuse }),
        }
    }

    /// Returns the base colour.
    pub fn base_color(&self) -> Rgb {
        self.base_color
    }

    /// Returns the glass part, if any.
    pub fn dielectric(&self) -> Option<&Dielectric> {
        self.dielectric.as_ref().map(|(_, glass)| glass)
    }

    /// Returns the BSDF at a point; `color` replaces the base colour with the sphere's own, if it
    /// has one. `eta` is the index of refraction beyond over that on this side.
    pub(super) fn bsdf(&self, color: Option<Rgb>, eta: f64) -> PrincipledBsdf<'_> {
        PrincipledBsdf {
            base_color: color.unwrap_or(self.base_color),
            conductor: self.conductor.as_ref().map(|(weight, metal)| (*weight, metal.bsdf(color))),
            dielectric: self.dielectric.as_ref().map(|(weight, glass)| (*weight, glass.bsdf(eta))),
            layers: &self.layers,
        }
    }
}

/// Returns a part with its weight, unless the weight is 0.
fn weighted<T>(weight: f64, make: impl FnOnce() -> T) -> Option<(f64, T)> {
    (weight > 0.0).then(|| (weight, make()))
}

/// Returns the index that reflects `2 specular` times as much at normal incidence as `ior` does.
fn gloss_ior(ior: f64, specular: f64) -> f64 {
    let amplitude = (ior - 1.0) / (ior + 1.0);
    let amplitude = (2.0 * specular * amplitude * amplitude).min(MAX_GLOSS).sqrt();
    (1.0 + amplitude) / (1.0 - amplitude)
}

/// Returns the fraction of light that a coat transmits for a direction of this cosine.
fn coat_transmittance(coat: Option<&(f64, Coat)>, cos: f64) -> f64 {
    if fault!(CoatWithoutBaseAttenuation) {
        return 1.0;
    }
    coat.map_or(1.0, |(weight, coat)| 1.0 - weight * (1.0 - coat.transmittance(cos)))
}

impl PrincipledBsdf<'_> {
    pub(super) fn is_delta(&self) -> bool {
        let PrincipledLayers { coat, diffuse } = self.layers;
        diffuse.is_none()
            && coat.as_ref().is_none_or(|(_, coat)| coat.is_delta())
            && self.conductor.is_none_or(|(_, metal)| metal.is_delta())
            && self.dielectric.is_none_or(|(_, glass)| glass.is_delta())
    }

    /// Returns true if light is transmitted in a non-delta lobe.
    pub(super) fn is_rough_transmissive(&self) -> bool {
        self.dielectric.is_some_and(|(_, glass)| !glass.is_delta())
    }

    /// Returns the attenuation of the base by the coat in both directions.
    fn base_attenuation(&self, cos_o: f64, cos_i: f64) -> f64 {
        let coat = self.layers.coat.as_ref();
        coat_transmittance(coat, cos_o).min(coat_transmittance(coat, cos_i))
    }

    /// Returns the colour of light transmitted through glass.
    fn transmission_tint(&self) -> Rgb {
        Rgb::from_array(self.base_color.to_array().map(f32::sqrt))
    }

    pub(super) fn eval(&self, wo: DVec3, wi: DVec3) -> Rgb {
        let attenuation = self.base_attenuation(wo.z, wi.z.abs());
        let glass = self
            .dielectric
            .map_or(0.0, |(weight, glass)| weight * attenuation * glass.eval(wo, wi));
        if wi.z <= 0.0 {
            return self.transmission_tint() * glass as f32;
        }
        let PrincipledLayers { coat, diffuse } = self.layers;
        let mut white = glass;
        let mut f = Rgb::ZERO;
        if let Some((weight, coat)) = coat {
            white += weight * coat.eval(wo, wi);
        }
        if let Some((weight, metal)) = &self.conductor {
            f += metal.eval(wo, wi) * (weight * attenuation) as f32;
        }
        if let Some(DiffuseBase { weight, gloss, mean_transmittance }) = diffuse {
            white += weight * attenuation * gloss.eval(wo, wi);
            let transmittance =
                |cos| gloss.transmittance(cos) * coat_transmittance(coat.as_ref(), cos);
            let diffuse =
                weight * transmittance(wo.z) * transmittance(wi.z) * FRAC_1_PI / mean_transmittance;
            f += self.base_color * diffuse as f32;
        }
        f + Rgb::splat(white as f32)
    }

    /// Returns the probability of sampling each of [`COMPONENTS`], roughly in proportion to its
    /// contribution.
    ///
    /// Without a coat the components of a white surface are sampled exactly in proportion to their
    /// contribution, so that every weight is 1: a path is reflected hundreds of times inside a
    /// sphere of high index, and the product of weights that are 1 only on average would be
    /// unbounded (see [`super::Dielectric`]). A darker base reflects less, and the difference goes
    /// to the gloss component.
    fn component_probabilities(&self, wo: DVec3) -> [f64; 5] {
        let PrincipledLayers { coat, diffuse } = self.layers;
        let attenuation = coat_transmittance(coat.as_ref(), wo.z);
        let coat_energy =
            coat.as_ref().map_or(0.0, |(weight, coat)| weight * (1.0 - coat.transmittance(wo.z)));
        let metal_energy = self.conductor.map_or(0.0, |(weight, metal)| {
            weight * attenuation * f64::from(luminance(metal.mean_reflectance()))
        });
        let [gloss_energy, diffuse_energy] =
            diffuse.as_ref().map_or([0.0; 2], |DiffuseBase { weight, gloss, .. }| {
                let transmittance = gloss.transmittance(wo.z);
                let color = f64::from(luminance(self.base_color));
                let [gloss_only, both] = if gloss.is_delta() {
                    [1.0 - transmittance, transmittance * color]
                } else {
                    [(1.0 - transmittance) * (1.0 - color), color]
                };
                [weight * attenuation * gloss_only, weight * attenuation * both]
            });
        let glass_energy = self.dielectric.map_or(0.0, |(weight, _)| weight * attenuation);
        let energies = [coat_energy, metal_energy, gloss_energy, diffuse_energy, glass_energy];
        let sum: f64 = energies.iter().sum();
        energies.map(|energy| if sum > 0.0 { energy / sum } else { 0.0 })
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        let probabilities = self.component_probabilities(wo);
        let of = |(component, probability): (Component, f64)| {
            if probability > 0.0 {
                probability * self.component_pdf(component, wo, wi)
            } else {
                0.0
            }
        };
        COMPONENTS.into_iter().zip(probabilities).map(of).sum()
    }

    fn component_pdf(&self, component: Component, wo: DVec3, wi: DVec3) -> f64 {
        let PrincipledLayers { coat, diffuse } = self.layers;
        let pdf = match component {
            Component::Dielectric => {
                return self.dielectric.map_or(0.0, |(_, glass)| glass.pdf(wo, wi));
            }
            _ if wi.z <= 0.0 => return 0.0,
            Component::Coat => coat.as_ref().map(|(_, coat)| coat.pdf(wo, wi)),
            Component::Conductor => self.conductor.map(|(_, metal)| metal.pdf(wo, wi)),
            Component::Gloss => diffuse.as_ref().map(|diffuse| diffuse.gloss.pdf(wo, wi)),
            Component::Diffuse => {
                diffuse.as_ref().map(|diffuse| diffuse.gloss.pdf_with_base(wo, wi))
            }
        };
        pdf.unwrap_or(0.0)
    }

    /// Samples a direction from one of the components.
    pub(super) fn sample(
        &self,
        wo: DVec3,
        u_lobe: f64,
        u: [f64; 2],
        extra: ExtraUniforms<'_>,
    ) -> Option<BsdfSample> {
        let probabilities = self.component_probabilities(wo);
        let mut rest = u_lobe;
        let mut selected = None;
        for (component, probability) in
            COMPONENTS.into_iter().zip(probabilities).filter(|(_, probability)| *probability > 0.0)
        {
            rest -= selected.map_or(0.0, |(_, previous): (Component, f64)| previous);
            selected = Some((component, probability));
            if rest < probability {
                break;
            }
        }
        let (component, probability) = selected?;
        let u_component = (rest / probability).clamp(0.0, 1.0 - f64::EPSILON);
        let (sample, scale) = self.sample_component(component, wo, u_component, u, extra)?;
        if sample.lobe == Lobe::Delta {
            let attenuation = self.base_attenuation(wo.z, sample.wi.z.abs());
            let scale = if component == Component::Coat { scale } else { scale * attenuation };
            let tint = if sample.wi.z < 0.0 { self.transmission_tint() } else { Rgb::ONE };
            let weight = sample.weight * tint * (scale / probability) as f32;
            return Some(BsdfSample { weight, pdf: probability * sample.pdf, ..sample });
        }
        let pdf = self.pdf(wo, sample.wi);
        let weight = self.eval(wo, sample.wi) * (sample.wi.z.abs() / pdf) as f32;
        (pdf > 0.0).then_some(BsdfSample { weight, pdf, ..sample })
    }

    /// Samples a component as if it were the only one; also returns the component's weight.
    fn sample_component(
        &self,
        component: Component,
        wo: DVec3,
        u_lobe: f64,
        u: [f64; 2],
        extra: ExtraUniforms<'_>,
    ) -> Option<(BsdfSample, f64)> {
        let PrincipledLayers { coat, diffuse } = self.layers;
        match component {
            Component::Coat => {
                coat.as_ref().and_then(|(weight, coat)| Some((coat.sample(wo, u)?, *weight)))
            }
            Component::Conductor => self
                .conductor
                .and_then(|(weight, metal)| Some((metal.sample(wo, u_lobe, u, extra)?, weight))),
            Component::Gloss => diffuse
                .as_ref()
                .and_then(|diffuse| Some((diffuse.gloss.sample(wo, u)?, diffuse.weight))),
            // The first pair goes to the base, which contributes most of the light.
            Component::Diffuse => diffuse.as_ref().map(|diffuse| {
                let (wi, lobe) = diffuse.gloss.sample_with_base(wo, u_lobe, extra, u);
                let sample = BsdfSample { wi, weight: Rgb::ONE, pdf: 1.0, lobe, eta: 1.0 };
                (sample, diffuse.weight)
            }),
            Component::Dielectric => self
                .dielectric
                .and_then(|(weight, glass)| Some((glass.sample(wo, u_lobe, u, extra)?, weight))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Sampler;
    use approx::assert_relative_eq;

    const PLAIN: PrincipledParameters = PrincipledParameters {
        base_color: Rgb::new(0.8, 0.4, 0.2),
        metallic: 0.0,
        roughness: 0.4,
        specular: 0.5,
        ior: 1.5,
        coat: 0.0,
        coat_roughness: 0.0,
        transmission: 0.0,
    };

    fn eval(parameters: PrincipledParameters, wi: DVec3) -> Rgb {
        Principled::new(parameters, &[1.0]).bsdf(None, parameters.ior).eval(WO, wi)
    }

    const WO: DVec3 = DVec3::new(0.6, 0.0, 0.8);
    const WI: DVec3 = DVec3::new(-0.28, 0.0, 0.96);

    #[test]
    fn its_ends_are_the_models_that_it_is_made_of() {
        let PrincipledParameters { base_color, roughness, .. } = PLAIN;
        let metal = eval(PrincipledParameters { metallic: 1.0, ..PLAIN }, WI);
        let expected = Conductor::from_color(base_color, roughness);
        assert_eq!(metal, expected.bsdf(None).eval(WO, WI));
        let glass = PrincipledParameters { transmission: 1.0, ..PLAIN };
        let expected = Dielectric::new(1.5, 0, roughness, &[1.0]);
        let expected = expected.bsdf(1.5);
        assert_relative_eq!(eval(glass, WI).x, expected.eval(WO, WI) as f32);
        let transmittance = eval(glass, -WI).x / expected.eval(WO, -WI) as f32;
        assert_relative_eq!(transmittance * transmittance, base_color.x, max_relative = 1e-6);
    }

    /// Otherwise the product of the weights along a path inside a dense ball would diverge.
    #[test]
    fn what_is_drawn_from_a_white_mixture_weighs_about_one() {
        for (roughness, ior) in [(0.0, 10.0), (0.3, 1.5), (0.5, 10.0), (1.0, 1.5), (1.0, 10.0)] {
            let mixed = PrincipledParameters { metallic: 0.2, transmission: 0.5, ..PLAIN };
            let white = PrincipledParameters { base_color: Rgb::ONE, roughness, ior, ..mixed };
            let white = Principled::new(white, &[1.0]);
            for (eta, cos) in [(ior, 1.0), (ior, 0.2), (1.0 / ior, 0.7), (1.0 / ior, 0.02)] {
                let wo = DVec3::new(f64::sqrt(1.0 - cos * cos), 0.0, cos);
                let n = 4000;
                let square = |i: u32| {
                    let (u, surface) = (Sampler::independent(3, 0, i), white.bsdf(None, eta));
                    let sample = surface.sample(wo, u.get(2), u.get_2d(0), &|| u.get_2d(4));
                    let weight = sample.map_or(0.0, |s| f64::from(s.weight.x) * s.eta * s.eta);
                    (weight - 1.0) * (weight - 1.0)
                };
                let variance = (0..n).map(square).sum::<f64>() / f64::from(n);
                assert!(variance < 1e-3, "{roughness}, {eta}, {cos}: {variance}");
            }
        }
    }

    #[test]
    fn half_of_specular_is_what_the_index_says() {
        assert_relative_eq!(gloss_ior(1.33, 0.5), 1.33, max_relative = 1e-12);
        assert_eq!(gloss_ior(1.33, 0.0), 1.0);
        // Burley's 0.08 specular, for an index of 1.5.
        let amplitude = (gloss_ior(1.5, 1.0) - 1.0) / (gloss_ior(1.5, 1.0) + 1.0);
        assert_relative_eq!(amplitude * amplitude, 0.08, max_relative = 1e-12);
    }

    #[test]
    fn a_spheres_own_colour_is_the_base_colour() {
        for (metallic, transmission) in [(0.0, 0.0), (1.0, 0.0), (0.3, 0.6)] {
            let parameters = PrincipledParameters { metallic, transmission, coat: 0.7, ..PLAIN };
            let grey = PrincipledParameters { base_color: Rgb::splat(0.5), ..parameters };
            let grey = Principled::new(grey, &[1.0]);
            let own = grey.bsdf(Some(parameters.base_color), 1.5);
            for wi in [WI, -WI] {
                assert_relative_eq!(own.eval(WO, wi).x, eval(parameters, wi).x);
            }
        }
    }
}
