//! The angle by which a ball deflects a ray, as a function of where the ray meets it, and its
//! roots.
//!
//! For every kind of connection this angle is `psi = sum w_j asin(m_j s)`, where `s` in `[0, 1]` is
//! proportional to the ray's distance `h` from the centre, the ratios `m_j` are at most 1, and one
//! of them is 1. With `s = sin v` and `w = tan(v / 2)` as the variable, `psi` is smooth on
//! `[0, 1]`: neither a grazing ray nor total reflection is a singularity. The arcsines are never
//! computed: half of `psi` is the argument of a product of complex numbers ([`Phase`]).

use super::phase::Phase;

/// Number of angles in the sum.
const TERMS: usize = 4;
/// Steps of Newton's method that a root may take before each second one is a bisection, and in
/// all. Of 1.5 million roots over all scales, the mean is 3.4 and the maximum 12.
const MAX_NEWTON: usize = 16;
const MAX_STEPS: usize = 80;
/// Steps to the stationary point, of which random configurations need at most 13.
const MAX_STATIONARY_STEPS: usize = 24;

/// `sin v` up to which a ray is on the axis: there, `theta` and the angle at x are proportional up
/// to the square of this, and both are too small for a direction to tell.
pub(super) const ON_AXIS: f64 = 1e-7;

/// The angles at the sphere, in the order of [`Deflection`]'s terms.
#[derive(Clone, Copy, Debug)]
pub(super) enum Angle {
    /// `i`, between the normal and the ray outside.
    Outside,
    /// `alpha` or `tau`, between the axis through x and the ray at x.
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

impl Evaluation {
    pub(super) fn sin(&self, angle: Angle) -> f64 {
        self.sines[angle as usize]
    }

    pub(super) fn cos(&self, angle: Angle) -> f64 {
        self.cosines[angle as usize]
    }
}

/// An interval of `w` in which `psi` is monotone, with half of `psi` at its ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Branch {
    ends: [f64; 2],
    halves: [Phase; 2],
}

impl Branch {
    /// Half of `psi` at both ends.
    pub(super) fn halves(&self) -> [Phase; 2] {
        self.halves
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
        let (mut sines, mut cosines) = ([0.0; TERMS], [1.0; TERMS]);
        let (mut half, mut slope) = (Phase::of(1.0, 0.0), 0.0);
        for j in 0..TERMS {
            if self.weights[j] == 0 {
                continue;
            }
            // cos^2 = 1 - m^2 s^2 = cos^2 v + (1 - m^2) s^2, without cancellation.
            let sin = self.ratios[j] * sin_v;
            let cos = (cos_v * cos_v + self.rests[j] * sin_v * sin_v).sqrt();
            (sines[j], cosines[j]) = (sin, cos);
            let weight = self.weights[j];
            let per_cos = if cos > 0.0 { cos_v / cos } else { 1.0 };
            slope += f64::from(weight) * self.ratios[j] * per_cos;
            half = half * half_term(weight, cos, sin);
        }
        Evaluation { half, slope, sin_v, cos_v, sines, cosines }
    }

    /// Evaluates the sum where the sine of one of its angles is known.
    #[inline(always)]
    pub(super) fn eval_at(&self, angle: Angle, sin: f64) -> Evaluation {
        let s = (sin / self.ratio(angle)).clamp(0.0, 1.0);
        self.eval(s / (1.0 + ((1.0 - s) * (1.0 + s)).sqrt()))
    }

    /// Splits `[0, 1]` into the intervals in which `psi` is monotone: one, or two (the second
    /// absent if empty).
    #[inline(always)]
    pub(super) fn branches(&self) -> [Option<Branch>; 2] {
        let [start, end] = [Phase::of(1.0, 0.0), self.eval(1.0).half];
        match self.stationary() {
            None => [Some(Branch { ends: [0.0, 1.0], halves: [start, end] }), None],
            Some(w) => {
                let fold = self.eval(w).half;
                [
                    Some(Branch { ends: [0.0, w], halves: [start, fold] }),
                    Some(Branch { ends: [w, 1.0], halves: [fold, end] }),
                ]
            }
        }
    }

    /// Returns the `w` in `(0, 1)` where `psi` is stationary, if there is one.
    ///
    /// With `u = cos v`, `d psi / d v = w_0 + sum w_j m_j g_j(u)` over the terms with `m_j < 1`,
    /// where `g_j = u / sqrt(m_j^2 u^2 + 1 - m_j^2)` grows from 0 to 1 and is concave. Wherever it
    /// has a zero, `w_0` is positive and all other weights are negative: it is convex and falls, so
    /// it has at most one, which Newton's method approaches from smaller `u` without overshooting.
    #[inline(always)]
    fn stationary(&self) -> Option<f64> {
        let at_zero: f64 = (0..TERMS).map(|j| f64::from(self.weights[j]) * self.ratios[j]).sum();
        let largest: f64 =
            (0..TERMS).filter(|&j| self.rests[j] == 0.0).map(|j| f64::from(self.weights[j])).sum();
        if at_zero >= 0.0 || largest <= 0.0 {
            return None;
        }
        // Because g_j <= u / sqrt(1 - m_j^2), this is below the root.
        let steepest: f64 = (0..TERMS)
            .filter(|&j| self.rests[j] > 0.0)
            .map(|j| -f64::from(self.weights[j]) * self.ratios[j] / self.rests[j].sqrt())
            .sum();
        let mut u = (largest / steepest).min(1.0);
        for _ in 0..MAX_STATIONARY_STEPS {
            let (mut value, mut derivative) = (largest, 0.0);
            for j in 0..TERMS {
                if self.rests[j] > 0.0 {
                    let (m, rest) = (self.ratios[j], self.rests[j]);
                    let per_square = 1.0 / (m * m * u * u + rest);
                    let per_root = per_square.sqrt();
                    let factor = f64::from(self.weights[j]) * m * per_root;
                    value += factor * u;
                    derivative += factor * rest * per_square;
                }
            }
            let step = value / derivative;
            u = (u - step).min(1.0);
            if step.abs() <= 1e-13 * u {
                break;
            }
        }
        let w = ((1.0 - u) / (1.0 + u)).max(0.0).sqrt();
        (w > 0.0 && w < 1.0).then_some(w)
    }

    /// Returns the root of `psi = target` in a branch; `half_target` is half of the target,
    /// negative. The difference of `psi` and the target must stay within 2 pi.
    #[inline(always)]
    pub(super) fn root(&self, branch: &Branch, half_target: Phase) -> Option<Evaluation> {
        let [low, high] = branch.halves.map(|half| half * half_target);
        if (low.im < 0.0) == (high.im < 0.0) {
            return None;
        }
        Some(self.find(branch.ends, [low, high], half_target))
    }

    /// Newton's method within a shrinking bracket, from where a parabola with its vertex at the
    /// fold would have its root.
    #[inline(always)]
    fn find(&self, ends: [f64; 2], halves: [Phase; 2], half_target: Phase) -> Evaluation {
        let [mut low, mut high] = ends;
        let fold = if low > 0.0 {
            low
        } else if high < 1.0 {
            high
        } else {
            f64::INFINITY
        };
        let is_rising = halves[0].im < 0.0;
        let mut w = self.guess(ends, halves);
        for step in 0..MAX_STEPS {
            let found = self.eval(w);
            let difference = found.half * half_target;
            if (difference.im < 0.0) == is_rising {
                low = w
            } else {
                high = w
            }
            let per_slope = 0.5 * (1.0 + w * w) / found.slope;
            let change = -2.0 * difference.approximate_angle() * per_slope;
            let next = w + change;
            // Newton's error is about the square of the step over the distance to the fold.
            let scale = f64::min(w, (w - fold).abs());
            if change * change <= 1e-16 * w * scale || high - low <= f64::EPSILON * high {
                w = next.clamp(ends[0], ends[1]);
                break;
            }
            let is_slow = step > MAX_NEWTON && step % 2 == 1;
            w = if next > low && next < high && !is_slow { next } else { 0.5 * (low + high) };
        }
        self.eval(w)
    }

    #[inline(always)]
    fn guess(&self, [low, high]: [f64; 2], halves: [Phase; 2]) -> f64 {
        let [at_low, at_high] = halves.map(|half| half.approximate_angle().abs());
        let total = (at_low + at_high).max(f64::MIN_POSITIVE);
        let share = if low > 0.0 {
            (at_low / total).sqrt()
        } else if high < 1.0 {
            1.0 - (at_high / total).sqrt()
        } else {
            at_low / total
        };
        low + share * (high - low)
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
