//! The angle by which a ball deflects a ray, as a function of where the ray meets it.
//!
//! For every kind of connection this angle is `psi = sum w_j asin(m_j s)`, where `s` in `[0, 1]` is
//! proportional to the ray's distance `h` from the centre, the ratios `m_j` are at most 1, and one
//! of them is 1. With `s = sin v` and `w = tan(v / 2)` as the variable, `psi` is smooth on
//! `[0, 1]`: neither a grazing ray nor total reflection is a singularity. The arcsines are never
//! computed: half of `psi` is the argument of a product of complex numbers ([`Phase`]).

use super::phase::Phase;

/// Number of angles in the sum.
const TERMS: usize = 4;
/// Steps to the stationary point, of which random configurations need at most 13.
pub(super) const MAX_STATIONARY_STEPS: usize = 24;

/// The angles at the sphere, in the order of [`Deflection`]'s terms.
#[derive(Clone, Copy, Debug)]
pub(super) enum Angle {
    /// `i`, between the normal and the ray outside.
    Outside,
    /// `alpha` or `gamma`, between the axis through x and the ray at x.
    AtX,
    /// `beta`, between the axis through y and the ray at y.
    AtY,
    /// `t`, between the normal and the ray inside.
    Inside,
}

/// `psi` as a function of `w`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Deflection {
    /// `w_j`: -4, -2, -1, 0, 1 or 2.
    weights: [i8; TERMS],
    /// `m_j`.
    ratios: [f64; TERMS],
    /// `1 - m_j^2`.
    rests: [f64; TERMS],
}

/// `psi` and the angles at one `w`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Evaluation {
    /// Half of `psi`.
    pub(super) half: Phase,
    /// `d psi / d v`.
    pub(super) slope: f64,
    /// `s = sin v`.
    pub(super) sin_v: f64,
    /// `cos v`.
    pub(super) cos_v: f64,
    sines: [f64; TERMS],
    cosines: [f64; TERMS],
}

/// A term of the sum at one `w`.
#[derive(Clone, Copy)]
struct Term {
    sin: f64,
    cos: f64,
    /// Part of `d psi / d v`.
    slope: f64,
    /// Half of its angle.
    half: Phase,
}

/// The search for the stationary point.
#[derive(Clone, Copy, Debug)]
pub(super) struct StationaryPoint {
    /// `cos v`.
    pub(super) u: f64,
    /// Sum of the weights of the terms with `m_j = 1`.
    pub(super) largest: f64,
    pub(super) is_found: bool,
}

impl Evaluation {
    pub(super) fn sin(&self, angle: Angle) -> f64 {
        self.sines[angle as usize]
    }

    pub(super) fn cos(&self, angle: Angle) -> f64 {
        self.cosines[angle as usize]
    }
}

impl Deflection {
    /// Creates the sum with these weights and ratios, of which the largest is 1.
    #[inline(always)]
    pub(super) fn new(weights: [i8; TERMS], ratios: [f64; TERMS]) -> Self {
        Self { weights, ratios, rests: ratios.map(|m| (1.0 - m) * (1.0 + m)) }
    }

    /// Returns `m_j`.
    #[inline(always)]
    pub(super) fn ratio(&self, angle: Angle) -> f64 {
        self.ratios[angle as usize]
    }

    /// Returns `d psi` per radian of the angle at x, of which `sin = m sin v`.
    #[inline(always)]
    pub(super) fn slope_at_x(&self, at: &Evaluation) -> f64 {
        let index = Angle::AtX as usize;
        // There, the angle is v itself.
        if self.rests[index] == 0.0 {
            return at.slope.abs();
        }
        at.slope.abs() * at.cosines[index] / (self.ratios[index] * at.cos_v)
    }

    /// Evaluates the sum at `w` in `[0, 1]`.
    #[inline(always)]
    pub(super) fn eval(&self, w: f64) -> Evaluation {
        let per_square = 1.0 / (1.0 + w * w);
        let sin_v = 2.0 * w * per_square;
        let cos_v = (1.0 - w) * (1.0 + w) * per_square;
        // Written out, since loops over the terms would not become vector instructions.
        let terms = [
            self.term(0, sin_v, cos_v),
            self.term(1, sin_v, cos_v),
            self.term(2, sin_v, cos_v),
            self.term(3, sin_v, cos_v),
        ];
        let first = terms[0].half * terms[1].half * terms[2].half;
        Evaluation {
            half: if self.weights[3] == 0 { first } else { first * terms[3].half },
            slope: terms[0].slope + terms[1].slope + terms[2].slope + terms[3].slope,
            sin_v,
            cos_v,
            sines: terms.map(|term| term.sin),
            cosines: terms.map(|term| term.cos),
        }
    }

    #[inline(always)]
    fn term(&self, j: usize, sin_v: f64, cos_v: f64) -> Term {
        let (weight, m) = (self.weights[j], self.ratios[j]);
        if weight == 0 {
            return Term { sin: 0.0, cos: 1.0, slope: 0.0, half: Phase::of(1.0, 0.0) };
        }
        // cos^2 = 1 - m^2 s^2 = cos^2 v + (1 - m^2) s^2, without cancellation.
        let sin = m * sin_v;
        let cos = (cos_v * cos_v + self.rests[j] * sin_v * sin_v).sqrt();
        let per_cos = if cos > 0.0 { cos_v / cos } else { 1.0 };
        let slope = f64::from(weight) * m * per_cos;
        Term { sin, cos, slope, half: half_term(weight, cos, sin) }
    }

    /// Evaluates the sum where the sine of one of its angles is known.
    #[inline(always)]
    pub(super) fn eval_at(&self, angle: Angle, sin: f64) -> Evaluation {
        let s = (sin / self.ratio(angle)).clamp(0.0, 1.0);
        self.eval(s / (1.0 + ((1.0 - s) * (1.0 + s)).sqrt()))
    }

    /// Returns the `w` in `(0, 1)` where `psi` is stationary, if there is one.
    #[inline(always)]
    pub(super) fn stationary(&self) -> Option<f64> {
        let mut point = self.start_stationary()?;
        for _ in 0..MAX_STATIONARY_STEPS {
            self.step_to_stationary(&mut point);
            if point.is_found {
                break;
            }
        }
        let w = point.w();
        (w > 0.0 && w < 1.0).then_some(w)
    }

    /// Returns where the search for the stationary point starts; `None` if there is none.
    ///
    /// With `u = cos v`, `d psi / d v = w_0 + sum w_j m_j g_j(u)` over the terms with `m_j < 1`,
    /// where `g_j = u / sqrt(m_j^2 u^2 + 1 - m_j^2)` grows from 0 to 1 and is concave. Wherever it
    /// has a zero, `w_0` is positive and all other weights are negative: it is convex and falls, so
    /// it has at most one, which Newton's method approaches from smaller `u` without overshooting.
    #[inline(always)]
    pub(super) fn start_stationary(&self) -> Option<StationaryPoint> {
        let at_zero = self.sum(|weight, m, _| weight * m);
        let largest = self.sum(|weight, _, rest| if rest == 0.0 { weight } else { 0.0 });
        // Because g_j <= u / sqrt(1 - m_j^2), the quotient below is smaller than the root.
        let steepest = |weight: f64, m: f64, rest: f64| -weight * m / rest.sqrt();
        let steepest = self.sum(|w, m, rest| if rest > 0.0 { steepest(w, m, rest) } else { 0.0 });
        let u = (largest / steepest).min(1.0);
        let exists = (at_zero < 0.0) & (largest > 0.0);
        exists.then_some(StationaryPoint { u, largest, is_found: false })
    }

    /// Sums up a function of `w_j`, `m_j` and `1 - m_j^2` over the terms with a weight.
    #[inline(always)]
    fn sum(&self, f: impl Fn(f64, f64, f64) -> f64) -> f64 {
        let of = |j: usize| f(f64::from(self.weights[j]), self.ratios[j], self.rests[j]);
        let first = of(0) + of(1) + of(2);
        if self.weights[3] == 0 { first } else { first + of(3) }
    }

    /// Takes a step of Newton's method.
    #[inline(always)]
    pub(super) fn step_to_stationary(&self, point: &mut StationaryPoint) {
        let u = point.u;
        let per_square = |m: f64, rest: f64| 1.0 / (m * m * u * u + rest);
        let factor = |weight: f64, m: f64, rest: f64| {
            if rest > 0.0 { weight * m * per_square(m, rest).sqrt() } else { 0.0 }
        };
        let value = point.largest + self.sum(|weight, m, rest| factor(weight, m, rest) * u);
        let derivative =
            self.sum(|weight, m, rest| factor(weight, m, rest) * rest * per_square(m, rest));
        let step = value / derivative;
        point.u = (u - step).min(1.0);
        point.is_found = step.abs() <= 1e-13 * point.u;
    }
}

impl StationaryPoint {
    /// No point: `w` is 0.
    pub(super) const NONE: Self = Self { u: 1.0, largest: 0.0, is_found: true };

    /// Returns `w` there.
    #[inline(always)]
    pub(super) fn w(&self) -> f64 {
        ((1.0 - self.u) / (1.0 + self.u)).max(0.0).sqrt()
    }
}

/// Half of `weight` times the angle.
#[inline(always)]
fn half_term(weight: i8, cos: f64, sin: f64) -> Phase {
    match weight {
        1 => Phase::of(1.0 + cos, sin),
        -1 => Phase::of(1.0 + cos, -sin),
        2 => Phase::of(cos, sin),
        -2 => Phase::of(cos, -sin),
        -4 => Phase::of(cos, -sin) * Phase::of(cos, -sin),
        _ => Phase::of(1.0, 0.0),
    }
}
