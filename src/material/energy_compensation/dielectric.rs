//! Energy compensation for a rough interface between two transparent media.
//!
//! Seen from either side, single scattering loses a fraction M(cos) of the light. As for metals,
//! Kulla and Conty (2017) return it in broad lobes, on both sides of the interface:
//!
//! ```text
//! r M(o) M(i) / (pi m)          reflected to the side of wo,
//! t M(o) M'(i) / (pi m')        transmitted to the other side (times cos: the fraction of light),
//! ```
//!
//! where m is the cosine-weighted mean of M, M' and m' are those of the other side, and
//! `r + t = 1`, so that no light is lost. Reciprocity requires `t m = eta^2 t' m'`; with the mean
//! transmittance T of a smooth interface, `T = eta^2 T'`, it is satisfied by `t = T m' / (m + m')`.

use crate::fault::fault;
use crate::math::DVec3;

use super::super::fresnel::{fresnel, refract};
use super::super::ggx::Ggx;
use super::{EnergyCompensation, hemispherical_mean};

/// Two consecutive Fibonacci numbers; the second is the number of facets.
const FIBONACCI: [usize; 2] = [6765, 10946];

/// Energy lost by a rough interface on both sides, and where compensation sends it.
#[derive(Clone, Copy, Debug)]
pub struct DielectricCompensation {
    /// The energy lost on the side that `eta` refers to, and beyond.
    missing: [EnergyCompensation; 2],
    /// The fraction of it that is transmitted to the other side.
    transmitted_fraction: [f64; 2],
}

/// Energy compensation as seen from one side of the interface.
#[derive(Clone, Copy, Debug)]
pub struct DielectricCompensationSide<'a> {
    both_sides: &'a DielectricCompensation,
    side: usize,
}

impl DielectricCompensation {
    /// Computes the compensation of a microsurface for `eta`, the index of refraction beyond over
    /// that on the near side.
    pub fn new(ggx: Ggx, eta: f64) -> Self {
        let missing = [eta, 1.0 / eta].map(|eta| missing_energy(ggx, eta));
        // From the side of the lower index Fresnel's equations are smooth.
        let dense = eta.max(1.0 / eta);
        let into = hemispherical_mean(|cos| 1.0 - fresnel(cos, dense).reflectance);
        let out_of = into / (dense * dense);
        let smooth = if eta > 1.0 { [into, out_of] } else { [out_of, into] };
        let [near, far] = missing.map(|missing| missing.mean_missing());
        let sum = (near + far).max(f64::MIN_POSITIVE);
        Self { missing, transmitted_fraction: [smooth[0] * far / sum, smooth[1] * near / sum] }
    }

    /// Returns the compensation seen from the side that `eta` refers to.
    pub fn near_side(&self) -> DielectricCompensationSide<'_> {
        DielectricCompensationSide { both_sides: self, side: 0 }
    }

    /// Returns the compensation seen from the other side.
    pub fn far_side(&self) -> DielectricCompensationSide<'_> {
        DielectricCompensationSide { both_sides: self, side: 1 }
    }
}

impl DielectricCompensationSide<'_> {
    /// Returns the fraction of light from `wo` that goes into the compensation lobes.
    pub fn missing(&self, wo: DVec3) -> f64 {
        self.both_sides.missing[self.side].missing(wo.z)
    }

    /// Returns the fraction of [`Self::missing`] that is transmitted.
    pub fn transmitted_fraction(&self) -> f64 {
        self.both_sides.transmitted_fraction[self.side]
    }

    /// Evaluates the compensation lobes, without the change of radiance between media. The sign of
    /// `wi.z` gives the side.
    pub fn eval(&self, wo: DVec3, wi: DVec3) -> f64 {
        let near = &self.both_sides.missing[self.side];
        let far = &self.both_sides.missing[1 - self.side];
        if wi.z > 0.0 {
            (1.0 - self.transmitted_fraction()) * near.eval(wo.z, wi.z)
        } else {
            let lobe = if fault!(MultiscatterWrongSide) { near } else { far };
            self.transmitted_fraction() * lobe.eval_scaled(near.missing(wo.z), -wi.z)
        }
    }

    /// Samples a direction of the compensation lobes, from three numbers in `[0, 1)`.
    pub fn sample(&self, side: f64, u: [f64; 2]) -> DVec3 {
        if side < self.transmitted_fraction() {
            self.both_sides.missing[1 - self.side].sample(u) * DVec3::new(1.0, 1.0, -1.0)
        } else {
            self.both_sides.missing[self.side].sample(u)
        }
    }

    /// Returns the pdf of [`Self::sample`], per solid angle.
    pub fn pdf(&self, wi: DVec3) -> f64 {
        if wi.z > 0.0 {
            (1.0 - self.transmitted_fraction()) * self.both_sides.missing[self.side].pdf(wi.z)
        } else {
            self.transmitted_fraction() * self.both_sides.missing[1 - self.side].pdf(-wi.z)
        }
    }
}

/// Tabulates the energy lost on one side. Total internal reflection bends the curve where no other
/// loss does, so half of the nodes are placed there, and a lattice replaces the grid.
fn missing_energy(ggx: Ggx, eta: f64) -> EnergyCompensation {
    EnergyCompensation::new([2.0 * ggx.alpha(), 4.0], |wo| {
        mean_over_lattice(|u| {
            let m = ggx.sample_visible_normal(wo, u);
            let (reflected, transmitted) = (m * (2.0 * wo.dot(m)) - wo, refract(wo, m, eta));
            let reflectance = fresnel(wo.dot(m).clamp(0.0, 1.0), eta).reflectance;
            let reflected_fraction =
                if reflected.z > 0.0 { ggx.shadowing(wo, reflected) } else { 0.0 };
            let transmitted =
                transmitted.filter(|w| w.z < 0.0).map_or(0.0, |w| ggx.shadowing(wo, w));
            reflectance * reflected_fraction + (1.0 - reflectance) * transmitted
        })
    })
}

/// Mean over the unit square by a Fibonacci lattice, denser towards 1 in the second coordinate,
/// where the few steep facets are.
fn mean_over_lattice(f: impl Fn([f64; 2]) -> f64) -> f64 {
    let [before, count] = FIBONACCI;
    let term = |i: usize| {
        let t = (i as f64 + 0.5) / count as f64;
        3.0 * t * t * f([(i * before % count) as f64 / count as f64, 1.0 - t.powi(3)])
    };
    (0..count).map(term).sum::<f64>() / count as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::{assert_abs_diff_eq, assert_relative_eq};

    /// The error bound stated in the documentation of dielectrics.
    const BOUND: f64 = 2e-3;

    fn direction(cos: f64) -> DVec3 {
        DVec3::new(((1.0 - cos) * (1.0 + cos)).sqrt(), 0.0, cos)
    }

    #[test]
    fn the_table_agrees_with_a_finer_integration() {
        for (roughness, eta) in [(0.01, 1.5), (0.1, 1.1), (0.2, 2.4), (0.5, 1.5), (1.0, 1.5)] {
            let ggx = Ggx::new(roughness).expect("rough");
            let energy = DielectricCompensation::new(ggx, eta);
            let sides = [(energy.near_side(), eta), (energy.far_side(), 1.0 / eta)];
            for (energy, eta) in sides {
                for cos in [1e-3, 0.02, 0.2, 0.45, 0.72, 0.76, 0.93, 0.97] {
                    let (wo, n) = (direction(cos), 300);
                    let term = |i: usize| {
                        let (t, u) = (((i / n) as f64 + 0.5) / n as f64, (i % n) as f64 / n as f64);
                        let m = ggx.sample_visible_normal(wo, [u, 1.0 - t.powi(3)]);
                        let f = fresnel(wo.dot(m), eta).reflectance;
                        let wi = (m * (2.0 * wo.dot(m)) - wo, refract(wo, m, eta));
                        let reflected_fraction =
                            if wi.0.z > 0.0 { f * ggx.shadowing(wo, wi.0) } else { 0.0 };
                        let transmitted = wi.1.filter(|wi| wi.z < 0.0);
                        let transmitted =
                            transmitted.map_or(0.0, |wi| (1.0 - f) * ggx.shadowing(wo, wi));
                        3.0 * t * t * (reflected_fraction + transmitted)
                    };
                    let albedo = (0..n * n).map(term).sum::<f64>() / (n * n) as f64;
                    assert_abs_diff_eq!(energy.missing(wo), 1.0 - albedo, epsilon = BOUND);
                }
            }
        }
    }

    #[test]
    fn the_lobes_give_back_just_what_is_missing_and_go_both_ways() {
        let eta = 1.5;
        let compensation = DielectricCompensation::new(Ggx::new(0.8).expect("rough"), eta);
        let energy = compensation.near_side();
        for cos in [0.01, 0.3, 1.0] {
            let wo = direction(cos);
            let share = |sign: f64| {
                let lobe = |cos: f64| energy.eval(wo, direction(cos) * DVec3::new(1.0, 1.0, sign));
                std::f64::consts::PI * hemispherical_mean(lobe)
            };
            assert_abs_diff_eq!(share(1.0) + share(-1.0), energy.missing(wo), epsilon = 1e-5);
            let wi = direction(0.6);
            let reflected_fraction = compensation.far_side().eval(wi, -wo);
            assert_relative_eq!(
                energy.eval(wo, -wi),
                eta * eta * reflected_fraction,
                max_relative = 1e-4
            );
        }
    }
}
