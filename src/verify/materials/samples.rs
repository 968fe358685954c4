//! The materials that are checked, and what each of them promises.

use crate::color::Rgb;
use crate::material::{
    Bsdf, Coat, Conductor, Dielectric, Diffuse, GLASSES, Material, Metal, Mirror, Model, OrenNayar,
    Phong, Plastic, Principled, PrincipledParameters,
};
use crate::sampling::Hemisphere;

use super::super::check::Effort;

/// A material to be checked.
#[derive(Clone)]
pub(in crate::verify) struct Sample {
    /// Its name and parameters.
    pub(in crate::verify) name: String,
    pub(super) material: Material,
    /// The index of refraction beyond the surface over the one before.
    pub(super) eta: f64,
    pub(super) promise: Promise,
    /// How far what it does with light may be off its promise, as its documentation says: as it is
    /// drawn, and as it is evaluated.
    pub(super) tolerance: Tolerance,
    /// The roughness of its microfacets: those of its base, and of its coat.
    pub(super) facets: Vec<f64>,
    /// Whether the chi-square table has rows of it.
    pub(in crate::verify) is_tabled: bool,
}

/// How far an energy may be off what is promised.
#[derive(Clone, Copy)]
pub(super) struct Tolerance {
    pub(super) drawn: f64,
    pub(super) evaluated: f64,
}

/// What a model says of its energy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Promise {
    /// All light is sent on.
    All,
    /// No more than all.
    AtMostAll,
    /// It creates light and is not reciprocal, and is there to show that.
    Neither,
}

use Promise::{All, AtMostAll, Neither};

/// Formulas without tables, or tables of smooth functions that rounding hides: what is off is rounding.
const EXACT: Tolerance = Tolerance { drawn: 0.0, evaluated: 0.0 };
/// Coats tell by a table over the cosine what they let through. What is interpolated, and the rule that
/// integrates the nodes, may be off by this.
const COATED: Tolerance = Tolerance { drawn: 5e-4, evaluated: 5e-4 };
/// Metals give back the light between their facets by such a table. Drawn is what facets do, without
/// it, but for how it changes within a part of the broad lobe.
const METAL: Tolerance = Tolerance { drawn: 2e-4, ..COATED };
/// Rough glass has two tables, and total reflection bends them between their nodes.
const GLASS: Tolerance = Tolerance { drawn: 2e-4, evaluated: 2e-3 };
/// What is drawn by a mixture is what is evaluated.
const WITH_GLASS: Tolerance = Tolerance { drawn: 2e-3, ..GLASS };

impl Sample {
    /// A material that light does not come through.
    pub(super) fn opaque(name: impl Into<String>, model: Model, promise: Promise) -> Self {
        Self {
            name: name.into(),
            material: model.into(),
            eta: 1.0,
            promise,
            tolerance: EXACT,
            facets: Vec::new(),
            is_tabled: true,
        }
    }

    /// With microfacets of a roughness, which have tables where they are not smooth.
    fn rough(self, roughness: f64, tolerance: Tolerance) -> Self {
        if roughness == 0.0 {
            return self;
        }
        Self { facets: [self.facets, vec![roughness]].concat(), tolerance, ..self }
    }

    fn untabled(self) -> Self {
        Self { is_tabled: false, ..self }
    }

    /// The material as it is met.
    pub(in crate::verify) fn bsdf(&self) -> Bsdf<'_> {
        self.material.bsdf(None, self.eta, Hemisphere::Cosine)
    }

    /// The material met from its other side.
    pub(super) fn behind(&self) -> Bsdf<'_> {
        self.material.bsdf(None, 1.0 / self.eta, Hemisphere::Cosine)
    }
}

/// One material of every model, over their roughness; with full effort over many more of them, and
/// of indices of refraction. Their names differ.
pub(in crate::verify) fn samples(effort: Effort) -> Vec<Sample> {
    let mut all: Vec<Sample> = [
        matt(),
        metals(&FEW),
        glass(),
        plastic(1.5, &FEW),
        plastic_of_any_index(),
        principled(),
        phong(),
    ]
    .into_iter()
    .flatten()
    .collect();
    if effort == Effort::Full {
        all.extend([metals(&MANY), named_glasses(), plastics(), of_any_index(&MANY)].concat());
    }
    all
}

const FEW: [f64; 5] = [0.0, 0.1, 0.4, 0.7, 1.0];
/// Between and beyond [`FEW`].
const MANY: [f64; 10] = [0.01, 0.02, 0.03, 0.05, 0.2, 0.3, 0.5, 0.6, 0.8, 0.9];

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
    let mirror = Model::Mirror(Mirror { reflectance: Rgb::ONE });
    samples.push(Sample::opaque("mirror", mirror, All));
    samples
}

/// All of those that have names, and others.
fn metals(roughness: &[f64]) -> Vec<Sample> {
    let lossless = Metal { ior: Rgb::ZERO, extinction: Rgb::ONE };
    let mut samples = Vec::new();
    for &roughness in roughness {
        let metal = |name: &str, metal, promise| {
            let name = format!("{name}, roughness {roughness}");
            Sample::opaque(name, Model::Conductor(metal), promise).rough(roughness, METAL)
        };
        let is_tabled = roughness == 0.4 || roughness == 1.0;
        for sample in [
            metal("lossless metal", Conductor::new(lossless, roughness), All),
            metal("white metal", Conductor::of_color(Rgb::ONE, roughness), All),
            metal("red metal", Conductor::of_color(RED, roughness), AtMostAll),
        ] {
            samples.push(Sample { is_tabled, ..sample });
        }
        // The other spelling of a name is the same metal.
        for (name, constants) in Metal::NAMED.into_iter().filter(|(name, _)| *name != "aluminum") {
            let named = metal(name, Conductor::new(constants, roughness), AtMostAll);
            samples.push(Sample { is_tabled: is_tabled && name == "gold", ..named });
        }
    }
    samples
}

/// From both sides of a boundary between indices of the ratio `eta`; both share their tables.
fn both_sides(eta: f64, roughness: f64) -> [Sample; 2] {
    let model = Model::Dielectric(Dielectric::new(eta, 0, roughness, &[1.0]));
    [eta, 1.0 / eta].map(|eta| {
        // Three digits where two would give two indices the same name.
        let told = if eta < 0.2 { format!("{eta:.3}") } else { format!("{eta:.2}") };
        let name = format!("glass, eta {told}, roughness {roughness}");
        let tolerance = GLASS;
        Sample { eta, ..Sample::opaque(name, model.clone(), All) }.rough(roughness, tolerance)
    })
}

/// Lobes of little roughness are narrower than the cells of the chi-square table; that has rows of
/// its own for indices that are nearly the same.
fn glass() -> Vec<Sample> {
    let mut samples = Vec::new();
    for roughness in [0.0, 0.01, 0.1, 0.3, 0.6, 1.0] {
        for eta in [1.5, 2.4, 1.05] {
            let is_tabled = roughness > 0.1 && eta != 1.05 && (eta < 2.0 || roughness == 0.6);
            samples.extend(both_sides(eta, roughness).map(|s| Sample { is_tabled, ..s }));
        }
    }
    for (eta, roughness) in
        [(1.1, 0.4), (1.1, 1.0), (2.5, 0.2), (2.5, 1.0), (3.0, 1.0), (10.0, 1.0)]
    {
        let is_tabled = eta == 3.0;
        samples.extend(both_sides(eta, roughness).map(|s| Sample { is_tabled, ..s }));
    }
    samples
}

fn of_any_index(roughness: &[f64]) -> Vec<Sample> {
    let each = |&roughness: &f64| {
        [1.02, 1.1, 1.2, 1.33, 1.8, 2.0, 2.5, 3.0, 4.0, 6.0, 10.0]
            .into_iter()
            .filter(move |&eta| (eta, roughness) != (2.5, 0.2))
            .flat_map(move |eta| both_sides(eta, roughness).map(Sample::untabled))
    };
    roughness.iter().flat_map(each).collect()
}

fn named_glasses() -> Vec<Sample> {
    let of = |(name, ior): (&str, f64)| {
        [0.0, 0.25, 0.75].map(|roughness| {
            let model = Model::Dielectric(Dielectric::new(ior, 0, roughness, &[1.0]));
            let sample = Sample::opaque(format!("{name}, roughness {roughness}"), model, All);
            // Air is too near to vacuum to have a rough boundary.
            let facets = if ior < 1.01 { 0.0 } else { roughness };
            Sample { eta: ior, ..sample }.rough(facets, GLASS).untabled()
        })
    };
    GLASSES.into_iter().flat_map(of).collect()
}

fn plastic(ior: f64, roughness: &[f64]) -> Vec<Sample> {
    let mut samples = Vec::new();
    for &roughness in roughness {
        for (color, albedo, promise) in [("white", Rgb::ONE, All), ("red", RED, AtMostAll)] {
            let model = Model::Plastic(Plastic { albedo, coat: Coat::new(ior, roughness) });
            let of_index = if ior == 1.5 { String::new() } else { format!("of index {ior}, ") };
            let name = format!("{color} plastic, {of_index}roughness {roughness}");
            let sample = Sample::opaque(name, model, promise).rough(roughness, COATED);
            let is_tabled = ior == 1.5 && roughness != 0.1;
            samples.push(Sample { is_tabled, ..sample });
        }
    }
    samples
}

fn plastic_of_any_index() -> Vec<Sample> {
    [1.1, 2.5].into_iter().flat_map(|ior| plastic(ior, &[0.0, 0.4])).collect()
}

fn plastics() -> Vec<Sample> {
    [1.02, 1.1, 1.33, 1.5, 2.0, 2.5, 4.0, 10.0]
        .into_iter()
        .flat_map(|ior| plastic(ior, &MANY))
        .map(Sample::untabled)
        .collect()
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
    let dense = PrincipledParameters { roughness: 1.0, ior: 10.0, transmission: 0.5, ..plain };
    let coated = PrincipledParameters { coat: 0.5, roughness: 0.9, specular: 1.0, ..mixed };
    let mut samples = Vec::new();
    for (name, eta, parameters) in [
        ("matt", 1.0, plain),
        ("mixture", 1.5, mixed),
        ("mixture from inside", 1.0 / 1.5, mixed),
        ("dense mixture", 10.0, dense),
        ("dense mixture from inside", 0.1, dense),
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
            let sample = Sample { eta, is_tabled: color == "red", ..sample };
            let is_coated = parameters.coat > 0.0;
            let coat = if is_coated { parameters.coat_roughness } else { 0.0 };
            let is_glassy = parameters.transmission > 0.0;
            let tables = if is_glassy { WITH_GLASS } else { COATED };
            samples.push(sample.rough(coat, tables).rough(parameters.roughness, tables));
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
    let classic = |exponent: f64| {
        Sample::opaque(
            format!("classic phong, exponent {exponent}"),
            phong(exponent, false),
            Neither,
        )
    };
    let untabled = |sample: Sample| sample.untabled();
    let others = [classic(1.0), classic(30.0)].map(untabled);
    [vec![of(3.0), of(30.0), of(300.0), classic(3.0)], others.into()].concat()
}
