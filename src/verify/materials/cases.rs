//! Materials under test, with the energy bound of each.

use crate::color::Rgb;
use crate::material::{
    Bsdf, Coat, Conductor, Dielectric, Diffuse, Material, Metal, Mirror, Model, NAMED_IORS,
    OrenNayar, Phong, Plastic, Principled, PrincipledParameters,
};
use crate::sampling::Hemisphere;

use super::super::check::Effort;

/// A material under test.
#[derive(Clone)]
pub(in crate::verify) struct MaterialCase {
    /// Name and parameters.
    pub(in crate::verify) name: String,
    pub(super) material: Material,
    /// Index of refraction beyond the surface over the one before it.
    pub(super) eta: f64,
    pub(super) energy_bound: EnergyBound,
    /// Documented tolerance of the energy, as sampled and as evaluated.
    pub(super) tolerance: Tolerance,
    /// Roughness of the microfacets, of the base and of the coat.
    pub(super) facet_roughnesses: Vec<f64>,
    /// True if the chi-square table has rows for this material.
    pub(in crate::verify) in_chi2_suite: bool,
}

/// Allowed deviation of an energy from its bound.
#[derive(Clone, Copy)]
pub(super) struct Tolerance {
    pub(super) sampled: f64,
    pub(super) evaluated: f64,
}

/// Energy bound stated by a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum EnergyBound {
    /// Scatters all light.
    Lossless,
    /// Scatters at most all light.
    Passive,
    /// Creates light and is not reciprocal; a model kept to demonstrate that.
    NonPhysical,
}

use EnergyBound::{Lossless, NonPhysical, Passive};

/// For formulas, or tables of functions so smooth that interpolation errors vanish in rounding.
const EXACT: Tolerance = Tolerance { sampled: 0.0, evaluated: 0.0 };
/// Coats read their transmittance from a table over the cosine. Interpolation, and the quadrature
/// behind the nodes, may be off by this.
const COATED: Tolerance = Tolerance { sampled: 5e-4, evaluated: 5e-4 };
/// Metals add the light scattered between facets from such a table. Sampling follows the facets and
/// does not use the table, except for its variation within a part of the broad lobe.
const METAL: Tolerance = Tolerance { sampled: 2e-4, ..COATED };
/// Rough glass has two tables, and total reflection bends the tabulated functions between nodes.
const GLASS: Tolerance = Tolerance { sampled: 2e-4, evaluated: 2e-3 };
/// A mixture samples with the energy that it evaluates.
const WITH_GLASS: Tolerance = Tolerance { sampled: 2e-3, ..GLASS };

impl MaterialCase {
    /// An opaque material.
    pub(super) fn opaque(name: impl Into<String>, model: Model, bound: EnergyBound) -> Self {
        Self {
            name: name.into(),
            material: model.into(),
            eta: 1.0,
            energy_bound: bound,
            tolerance: EXACT,
            facet_roughnesses: Vec::new(),
            in_chi2_suite: true,
        }
    }

    /// Adds microfacets of this roughness, which use tables unless they are smooth.
    fn with_roughness(self, roughness: f64, tolerance: Tolerance) -> Self {
        if roughness == 0.0 {
            return self;
        }
        Self {
            facet_roughnesses: [self.facet_roughnesses, vec![roughness]].concat(),
            tolerance,
            ..self
        }
    }

    fn without_chi2(self) -> Self {
        Self { in_chi2_suite: false, ..self }
    }

    /// Returns the BSDF seen from outside.
    pub(in crate::verify) fn bsdf(&self) -> Bsdf<'_> {
        self.material.bsdf(None, self.eta, Hemisphere::Cosine)
    }

    /// Returns the BSDF seen from the other side.
    pub(super) fn reversed_bsdf(&self) -> Bsdf<'_> {
        self.material.bsdf(None, 1.0 / self.eta, Hemisphere::Cosine)
    }
}

/// Returns materials of every model over their roughness. Full effort adds many more values of
/// roughness and index of refraction. Names are unique.
pub(in crate::verify) fn material_cases(effort: Effort) -> Vec<MaterialCase> {
    let mut all: Vec<MaterialCase> = [
        diffuse(),
        metals(&BASIC_ROUGHNESSES),
        glass(),
        plastic(1.5, &BASIC_ROUGHNESSES),
        plastic_of_many_indices(),
        principled(),
        phong(),
    ]
    .into_iter()
    .flatten()
    .collect();
    if effort == Effort::Full {
        all.extend(
            [
                metals(&EXTRA_ROUGHNESSES),
                named_glasses(),
                plastics(),
                glass_of_many_indices(&EXTRA_ROUGHNESSES),
            ]
            .concat(),
        );
    }
    all
}

const BASIC_ROUGHNESSES: [f64; 5] = [0.0, 0.1, 0.4, 0.7, 1.0];
/// Values between and beyond [`BASIC_ROUGHNESSES`].
const EXTRA_ROUGHNESSES: [f64; 10] = [0.01, 0.02, 0.03, 0.05, 0.2, 0.3, 0.5, 0.6, 0.8, 0.9];

/// A colour with three distinct channels.
const RED: Rgb = Rgb::new(0.9, 0.5, 0.1);

fn diffuse() -> Vec<MaterialCase> {
    let white = Model::Diffuse(Diffuse { albedo: Rgb::ONE });
    let mut cases = vec![MaterialCase::opaque("white diffuse", white, Lossless)];
    for roughness in [0.3, 1.0] {
        for (color, albedo, bound) in [("white ", Rgb::ONE, Lossless), ("", RED, Passive)] {
            let name = format!("{color}rough diffuse {roughness}");
            let model = Model::OrenNayar(OrenNayar { albedo, roughness });
            cases.push(MaterialCase::opaque(name, model, bound));
        }
    }
    let mirror = Model::Mirror(Mirror { reflectance: Rgb::ONE });
    cases.push(MaterialCase::opaque("mirror", mirror, Lossless));
    cases
}

/// All named metals, and others.
fn metals(roughness: &[f64]) -> Vec<MaterialCase> {
    let lossless = Metal { ior: Rgb::ZERO, extinction: Rgb::ONE };
    let mut cases = Vec::new();
    for &roughness in roughness {
        let metal = |name: &str, metal, bound| {
            let name = format!("{name}, roughness {roughness}");
            MaterialCase::opaque(name, Model::Conductor(metal), bound)
                .with_roughness(roughness, METAL)
        };
        let is_tabled = roughness == 0.4 || roughness == 1.0;
        for case in [
            metal("lossless metal", Conductor::new(lossless, roughness), Lossless),
            metal("white metal", Conductor::from_color(Rgb::ONE, roughness), Lossless),
            metal("red metal", Conductor::from_color(RED, roughness), Passive),
        ] {
            cases.push(MaterialCase { in_chi2_suite: is_tabled, ..case });
        }
        // Skip the other spelling of the same metal.
        for (name, constants) in Metal::NAMED.into_iter().filter(|(name, _)| *name != "aluminum") {
            let named = metal(name, Conductor::new(constants, roughness), Passive);
            cases.push(MaterialCase { in_chi2_suite: is_tabled && name == "gold", ..named });
        }
    }
    cases
}

/// Both sides of a boundary with relative index `eta`, sharing their tables.
fn from_both_sides(eta: f64, roughness: f64) -> [MaterialCase; 2] {
    let model = Model::Dielectric(Dielectric::new(eta, 0, roughness, &[1.0]));
    [eta, 1.0 / eta].map(|eta| {
        // Three digits where two would give two indices the same name.
        let eta_text = if eta < 0.2 { format!("{eta:.3}") } else { format!("{eta:.2}") };
        let name = format!("glass, eta {eta_text}, roughness {roughness}");
        let tolerance = GLASS;
        MaterialCase { eta, ..MaterialCase::opaque(name, model.clone(), Lossless) }
            .with_roughness(roughness, tolerance)
    })
}

/// Lobes of low roughness are narrower than the cells of the chi-square table, which has separate
/// rows for nearly equal indices.
fn glass() -> Vec<MaterialCase> {
    let mut cases = Vec::new();
    for roughness in [0.0, 0.01, 0.1, 0.3, 0.6, 1.0] {
        for eta in [1.5, 2.4, 1.05] {
            let is_tabled = roughness > 0.1 && eta != 1.05 && (eta < 2.0 || roughness == 0.6);
            cases.extend(
                from_both_sides(eta, roughness)
                    .map(|s| MaterialCase { in_chi2_suite: is_tabled, ..s }),
            );
        }
    }
    for (eta, roughness) in
        [(1.1, 0.4), (1.1, 1.0), (2.5, 0.2), (2.5, 1.0), (3.0, 1.0), (10.0, 1.0)]
    {
        let is_tabled = eta == 3.0;
        cases.extend(
            from_both_sides(eta, roughness).map(|s| MaterialCase { in_chi2_suite: is_tabled, ..s }),
        );
    }
    cases
}

fn glass_of_many_indices(roughness: &[f64]) -> Vec<MaterialCase> {
    let at_roughness = |&roughness: &f64| {
        [1.02, 1.1, 1.2, 1.33, 1.8, 2.0, 2.5, 3.0, 4.0, 6.0, 10.0]
            .into_iter()
            .filter(move |&eta| (eta, roughness) != (2.5, 0.2))
            .flat_map(move |eta| from_both_sides(eta, roughness).map(MaterialCase::without_chi2))
    };
    roughness.iter().flat_map(at_roughness).collect()
}

fn named_glasses() -> Vec<MaterialCase> {
    let case = |(name, ior): (&str, f64)| {
        [0.0, 0.25, 0.75].map(|roughness| {
            let model = Model::Dielectric(Dielectric::new(ior, 0, roughness, &[1.0]));
            let case =
                MaterialCase::opaque(format!("{name}, roughness {roughness}"), model, Lossless);
            // Air is too close to vacuum to have a rough boundary.
            let facets = if ior < 1.01 { 0.0 } else { roughness };
            MaterialCase { eta: ior, ..case }.with_roughness(facets, GLASS).without_chi2()
        })
    };
    NAMED_IORS.into_iter().flat_map(case).collect()
}

fn plastic(ior: f64, roughness: &[f64]) -> Vec<MaterialCase> {
    let mut cases = Vec::new();
    for &roughness in roughness {
        for (color, albedo, bound) in [("white", Rgb::ONE, Lossless), ("red", RED, Passive)] {
            let model = Model::Plastic(Plastic { albedo, coat: Coat::new(ior, roughness) });
            let of_index = if ior == 1.5 { String::new() } else { format!("of index {ior}, ") };
            let name = format!("{color} plastic, {of_index}roughness {roughness}");
            let case = MaterialCase::opaque(name, model, bound).with_roughness(roughness, COATED);
            let is_tabled = ior == 1.5 && roughness != 0.1;
            cases.push(MaterialCase { in_chi2_suite: is_tabled, ..case });
        }
    }
    cases
}

fn plastic_of_many_indices() -> Vec<MaterialCase> {
    [1.1, 2.5].into_iter().flat_map(|ior| plastic(ior, &[0.0, 0.4])).collect()
}

fn plastics() -> Vec<MaterialCase> {
    [1.02, 1.1, 1.33, 1.5, 2.0, 2.5, 4.0, 10.0]
        .into_iter()
        .flat_map(|ior| plastic(ior, &EXTRA_ROUGHNESSES))
        .map(MaterialCase::without_chi2)
        .collect()
}

/// Mixtures of all parts, white and coloured, from both sides.
fn principled() -> Vec<MaterialCase> {
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
    let mut cases = Vec::new();
    for (name, eta, parameters) in [
        ("diffuse", 1.0, plain),
        ("mixture", 1.5, mixed),
        ("mixture from inside", 1.0 / 1.5, mixed),
        ("dense mixture", 10.0, dense),
        ("dense mixture from inside", 0.1, dense),
        ("smooth mixture", 1.5, PrincipledParameters { roughness: 0.0, ..mixed }),
        ("diffuse, coated", 1.0, PrincipledParameters { coat: 1.0, ..plain }),
        ("metal, coated", 1.0, PrincipledParameters { coat: 1.0, metallic: 1.0, ..plain }),
        ("mixture, coated", 1.5, coated),
        ("mixture, coated, from inside", 1.0 / 1.5, coated),
    ] {
        for (color, base_color) in [("white", Rgb::ONE), ("red", RED)] {
            let is_lossless = color == "white" && parameters.coat == 0.0;
            let bound = if is_lossless { Lossless } else { Passive };
            let parameters = PrincipledParameters { base_color, ..parameters };
            let model = Model::Principled(Principled::new(parameters, &[1.0]));
            let case = MaterialCase::opaque(format!("principled {color} {name}"), model, bound);
            let case = MaterialCase { eta, in_chi2_suite: color == "red", ..case };
            let is_coated = parameters.coat > 0.0;
            let coat = if is_coated { parameters.coat_roughness } else { 0.0 };
            let is_glassy = parameters.transmission > 0.0;
            let tables = if is_glassy { WITH_GLASS } else { COATED };
            cases.push(
                case.with_roughness(coat, tables).with_roughness(parameters.roughness, tables),
            );
        }
    }
    cases
}

fn phong() -> Vec<MaterialCase> {
    let phong = |exponent, normalized| {
        let (albedo, specular) = (Rgb::splat(0.3), Rgb::splat(0.7));
        Model::Phong(Phong { albedo, specular, exponent, normalized })
    };
    let case = |exponent: f64| {
        MaterialCase::opaque(format!("phong, exponent {exponent}"), phong(exponent, true), Passive)
    };
    let classic = |exponent: f64| {
        MaterialCase::opaque(
            format!("classic phong, exponent {exponent}"),
            phong(exponent, false),
            NonPhysical,
        )
    };
    let without_table = |case: MaterialCase| case.without_chi2();
    let others = [classic(1.0), classic(30.0)].map(without_table);
    [vec![case(3.0), case(30.0), case(300.0), classic(3.0)], others.into()].concat()
}
