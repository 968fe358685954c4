//! Multiscatter energy compensation (Kulla-Conty): returns the energy that single scattering on a
//! microsurface loses.
//!
//! The single-scattering model drops light that one facet sends into another; at roughness 1 that
//! is more than half of it. Kulla and Conty (2017, "Revisiting Physically Based Shading at
//! Imageworks") return it in a second, broad and reciprocal lobe, from the missing energy
//! `1 - E(cos)` of each direction, E being the directional albedo of lossless facets.
//!
//! Here E is integrated for each material when a scene is built, so that nothing is interpolated
//! between materials; between the cosines of the table the error is below 5e-4, as a test shows.
//!
//! Sampling does not use the table: it samples a facet and, if the light does not escape directly,
//! the broad lobe. So the probability of the broad lobe is exactly the missing energy, and sample
//! weights are 1 except for colour: weights do not grow over hundreds of bounces.
//!
//! [`DielectricCompensation`] does this for rough glass, on both of its sides.

mod dielectric;
mod table;

pub use dielectric::{DielectricCompensation, DielectricCompensationSide};

use std::f64::consts::{FRAC_1_PI, TAU};

use crate::fault::fault;
use crate::math::DVec3;
use crate::sampling::sin_cos;

use super::Ggx;
use table::CosineTable;

/// Number of cosines in a table.
const NODES: usize = 64;
/// Number of bins of a broad lobe; each has equal energy.
const LOBE_BINS: usize = 64;
/// Quadrature over facets: rings of steepness, and sectors of half a turn.
const RINGS: usize = 96;
const SECTORS: usize = 24;
/// Steps of the quadrature over cosines.
const STEPS: usize = 1024;

/// Energy that single scattering loses, as a function of the cosine of the incoming direction.
#[derive(Clone, Copy, Debug)]
pub struct EnergyCompensation {
    table: CosineTable<NODES>,
    /// Cosine-weighted mean over the hemisphere.
    mean_missing: f32,
    /// Squared cosines that divide the lobe into bins of equal energy.
    bin_edges: [f32; LOBE_BINS + 1],
}

impl EnergyCompensation {
    /// Computes the energy that lossless reflection by a microsurface loses.
    pub fn for_reflection(ggx: Ggx) -> Self {
        // The loss changes fast at cosines below about alpha.
        Self::new([2.0 * ggx.alpha(); 2], |wo| {
            mean_over_visible_normals(ggx, wo, |m| {
                let wi = m * (2.0 * wo.dot(m)) - wo;
                if wi.z > 0.0 { ggx.shadowing(wo, wi) } else { 0.0 }
            })
        })
    }

    /// Tabulates the complement to 1 of a directional albedo. The nodes are dense at cosines below
    /// each of `knees`.
    pub(super) fn new(knees: [f64; 2], albedo: impl Fn(DVec3) -> f64) -> Self {
        let missing = |cos: f64| {
            let wo = DVec3::new(((1.0 - cos) * (1.0 + cos)).sqrt(), 0.0, cos);
            (1.0 - albedo(wo)).clamp(0.0, 1.0)
        };
        let mut table = Self {
            table: CosineTable::new(knees, missing),
            mean_missing: 0.0,
            bin_edges: [0.0; LOBE_BINS + 1],
        };
        // Integrates the interpolated table over cos = t^4; the square has the differential 8 t^7
        // dt.
        let middle = |i: usize| (i as f64 + 0.5) / STEPS as f64;
        let term = |t: f64| 8.0 * t.powi(7) * table.missing(t.powi(4)) / STEPS as f64;
        let terms: Vec<f64> = (0..STEPS).map(middle).map(term).collect();
        table.mean_missing = terms.iter().sum::<f64>() as f32;
        table.bin_edges = equal_energy_edges(&terms);
        table
    }

    /// Returns the missing fraction for a direction of cosine `cos` in `[0, 1]`; 0 if none is
    /// missing.
    pub fn missing(&self, cos: f64) -> f64 {
        self.table.eval(cos).clamp(0.0, 1.0)
    }

    /// Returns the cosine-weighted mean over the hemisphere.
    pub fn mean_missing(&self) -> f64 {
        f64::from(self.mean_missing)
    }

    /// Evaluates a reciprocal lobe that scatters the missing energy of each direction over the
    /// hemisphere: times the cosine it integrates to [`Self::missing`].
    pub fn eval(&self, cos_o: f64, cos_i: f64) -> f64 {
        self.eval_scaled(self.missing(cos_o), cos_i)
    }

    /// Samples the lobe in proportion to its value, up to the variation within each of 64 bins.
    pub fn sample(&self, u: [f64; 2]) -> DVec3 {
        let position = u[0] * LOBE_BINS as f64;
        let bin = (position as usize).min(LOBE_BINS - 1);
        let [low, high] = [bin, bin + 1].map(|i| f64::from(self.bin_edges[i]));
        let cos_squared = low + (high - low) * (position - bin as f64);
        let cos_squared = if fault!(MultiscatterSampledByCosine) { u[0] } else { cos_squared };
        let (sin_phi, cos_phi) = sin_cos(TAU * u[1]);
        let sin = (1.0 - cos_squared).max(0.0).sqrt();
        DVec3::new(sin * cos_phi, sin * sin_phi, cos_squared.sqrt())
    }

    /// Returns the pdf of [`Self::sample`] at a cosine, per solid angle.
    pub fn pdf(&self, cos: f64) -> f64 {
        let cos_squared = (cos * cos) as f32;
        let bin = self.bin_edges[1..LOBE_BINS].partition_point(|&edge| edge <= cos_squared);
        let [low, high] = [bin, bin + 1].map(|i| f64::from(self.bin_edges[i]));
        // Where the squared cosine is uniform, the density is cos / pi.
        if f64::from(cos_squared) > high {
            0.0
        } else {
            cos * FRAC_1_PI / (LOBE_BINS as f64 * (high - low))
        }
    }

    /// Evaluates a lobe of this shape that scatters `fraction` of the light over the hemisphere.
    fn eval_scaled(&self, fraction: f64, cos_i: f64) -> f64 {
        if self.mean_missing <= 0.0 {
            return 0.0;
        }
        fraction * self.missing(cos_i) * FRAC_1_PI / self.mean_missing()
    }
}

/// Returns the squared cosines that split the sum of `terms` into equal parts. The terms belong to
/// equal steps of the eighth root of the squared cosine.
fn equal_energy_edges(terms: &[f64]) -> [f32; LOBE_BINS + 1] {
    let total: f64 = terms.iter().sum();
    let mut edges = std::array::from_fn(|i| i as f32 / LOBE_BINS as f32);
    if total <= 0.0 {
        return edges;
    }
    let mut next = 1;
    let mut accumulated = 0.0;
    for (i, term) in terms.iter().enumerate() {
        while next <= LOBE_BINS && accumulated + term >= total * next as f64 / LOBE_BINS as f64 {
            let within = (total * next as f64 / LOBE_BINS as f64 - accumulated) / term;
            edges[next] = ((i as f64 + within.clamp(0.0, 1.0)) / terms.len() as f64).powi(8) as f32;
            next += 1;
        }
        accumulated += term;
    }
    // The last bin ends where the lobe becomes 0.
    let end = terms.iter().rposition(|&term| term > 0.0).map_or(terms.len(), |last| last + 1);
    edges[LOBE_BINS] = (end as f64 / terms.len() as f64).powi(8) as f32;
    edges
}

/// Mean of `f` over the facets visible from `wo`, which lies in the x-z plane; `f` must be
/// symmetric in y. Midpoint rule, denser towards the few steep facets.
pub(super) fn mean_over_visible_normals(ggx: Ggx, wo: DVec3, f: impl Fn(DVec3) -> f64) -> f64 {
    let middle = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
    let ring = |i: usize| {
        let t = middle(i, RINGS);
        let facet = |j: usize| {
            let u = [0.5 * middle(j, SECTORS), 1.0 - t.powi(3)];
            f(ggx.sample_visible_normal(wo, u))
        };
        3.0 * t * t * (0..SECTORS).map(facet).sum::<f64>()
    };
    (0..RINGS).map(ring).sum::<f64>() / (RINGS * SECTORS) as f64
}

/// Cosine-weighted mean over the hemisphere of a function of the cosine.
pub(super) fn hemispherical_mean(f: impl Fn(f64) -> f64) -> f64 {
    let middle = |i: usize| (i as f64 + 0.5) / STEPS as f64;
    let mean: f64 = (0..STEPS).map(middle).map(|cos| 2.0 * cos * f(cos)).sum();
    mean / STEPS as f64
}

/// Returns the fraction of multiply scattered light that lossy facets return, given their mean
/// reflectance and the mean albedo of lossless ones: the sum of all further bounces (Kulla and
/// Conty 2017).
pub(super) fn multiscatter_tint(reflectance: f64, missing: f64) -> f64 {
    let escape = 1.0 - missing;
    reflectance * reflectance * escape / (1.0 - reflectance * missing).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    /// The error bound stated in the documentation.
    const BOUND: f64 = 5e-4;

    #[test]
    fn straight_from_above_the_loss_is_known_in_closed_form() {
        // At normal incidence G2 = G1(wi) = 2 c / (c + s), with c = cos(2 theta_m); for alpha = 1,
        // s = 1 and E = integral of 2 (1 - 2u) / (2 - 2u) over u = sin^2(theta_m) up to 1/2 = 1 -
        // ln 2.
        let missing = EnergyCompensation::for_reflection(Ggx::new(1.0).expect("rough"));
        assert_abs_diff_eq!(missing.missing(1.0), std::f64::consts::LN_2, epsilon = 1e-4);
    }

    #[test]
    fn the_table_agrees_with_a_finer_integration() {
        for roughness in [0.01, 0.1, 0.3, 0.5, 0.8, 1.0] {
            let ggx = Ggx::new(roughness).expect("rough");
            let table = EnergyCompensation::for_reflection(ggx);
            for cos in [1e-3, 0.02, 0.07, 0.2, 0.45, 0.7, 0.93] {
                let wo = DVec3::new((1.0f64 - cos * cos).sqrt(), 0.0, cos);
                let n = 500;
                let share = |i: usize| {
                    let (ring, sector) = ((i / n) as f64 + 0.5, (i % n) as f64 + 0.5);
                    let t = ring / n as f64;
                    let u = [0.5 * sector / n as f64, 1.0 - t.powi(3)];
                    let wi = ggx.sample_reflection(wo, u);
                    wi.map_or(0.0, |(wi, _)| 3.0 * t * t * ggx.shadowing(wo, wi))
                };
                let albedo = (0..n * n).map(share).sum::<f64>() / (n * n) as f64;
                assert_abs_diff_eq!(table.missing(cos), 1.0 - albedo, epsilon = BOUND);
            }
        }
    }

    #[test]
    fn the_lobe_gives_back_just_what_is_missing() {
        for roughness in [0.05, 0.4, 1.0] {
            let missing = EnergyCompensation::for_reflection(Ggx::new(roughness).expect("rough"));
            for cos in [0.01, 0.3, 1.0] {
                let returned =
                    std::f64::consts::PI * hemispherical_mean(|cos_i| missing.eval(cos, cos_i));
                assert_abs_diff_eq!(returned, missing.missing(cos), epsilon = 1e-5);
            }
        }
    }
}
