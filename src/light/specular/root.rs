//! The roots of a [`Deflection`].

use super::deflection::{Deflection, Evaluation};
use super::phase::Phase;

/// Steps of Newton's method that a root may take before each second one is a bisection, and in
/// all. Of 1.5 million roots over all scales, the mean is 3.4 and the maximum 12.
const MAX_NEWTON: usize = 16;
pub(super) const MAX_STEPS: usize = 80;

/// An interval of `w` in which `psi` is monotone, with half of `psi` at its ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Branch {
    pub(super) ends: [f64; 2],
    pub(super) halves: [Phase; 2],
}

/// The search for the root of `psi = target` in a branch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Search {
    pub(super) ends: [f64; 2],
    /// Half of the target, negative.
    pub(super) half_target: Phase,
    pub(super) is_rising: bool,
    /// A bracket of the root.
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) w: f64,
    pub(super) is_found: bool,
}

impl Deflection {
    /// Splits `[0, 1]` into the intervals in which `psi` is monotone: one, or two (the second
    /// absent if empty).
    #[inline(always)]
    pub(super) fn branches(&self) -> [Option<Branch>; 2] {
        let fold = self.stationary().map(|w| (w, self.eval(w).half));
        branches_of(self.eval(1.0).half, fold)
    }

    /// Returns the root of `psi = target` in a branch; `half_target` is half of the target,
    /// negative. The difference of `psi` and the target must stay within 2 pi.
    #[inline(always)]
    pub(super) fn root(&self, branch: &Branch, half_target: Phase) -> Option<Evaluation> {
        let mut search = branch.search(half_target)?;
        for step in 0..MAX_STEPS {
            self.advance(&mut search, step);
            if search.is_found {
                break;
            }
        }
        Some(self.eval(search.w))
    }

    /// Takes a step of Newton's method within the bracket.
    #[inline(always)]
    pub(super) fn advance(&self, search: &mut Search, step: usize) {
        let Search { ends, half_target, is_rising, w, .. } = *search;
        let fold = match ends {
            [low, _] if low > 0.0 => low,
            [_, high] if high < 1.0 => high,
            _ => f64::INFINITY,
        };
        let found = self.eval(w);
        let difference = found.half * half_target;
        let is_below = (difference.im < 0.0) == is_rising;
        let low = if is_below { w } else { search.low };
        let high = if is_below { search.high } else { w };
        let per_slope = 0.5 * (1.0 + w * w) / found.slope;
        let change = -2.0 * difference.approximate_angle() * per_slope;
        let next = w + change;
        // Newton's error is about the square of the step over the distance to the fold.
        let scale = f64::min(w, (w - fold).abs());
        let is_found = (change * change <= 1e-16 * w * scale) | (high - low <= f64::EPSILON * high);
        let is_slow = step > MAX_NEWTON && step % 2 == 1;
        let is_inside = (next > low) & (next < high) & !is_slow;
        let last = next.max(ends[0]).min(ends[1]);
        let inner = if is_inside { next } else { 0.5 * (low + high) };
        search.w = if is_found { last } else { inner };
        (search.low, search.high, search.is_found) = (low, high, is_found);
    }
}

impl Branch {
    /// Returns the search for a root in this branch, if it has one.
    #[inline(always)]
    pub(super) fn search(&self, half_target: Phase) -> Option<Search> {
        let halves = self.halves.map(|half| half * half_target);
        if !is_between(halves) {
            return None;
        }
        let [low, high] = self.ends;
        Some(Search {
            ends: self.ends,
            half_target,
            is_rising: halves[0].im < 0.0,
            low,
            high,
            w: guess(self.ends, halves),
            is_found: false,
        })
    }
}

/// Returns the branches, given half of `psi` at the end, and `w` and half of `psi` at the fold, if
/// there is one.
#[inline(always)]
pub(super) fn branches_of(end: Phase, fold: Option<(f64, Phase)>) -> [Option<Branch>; 2] {
    let start = Phase::of(1.0, 0.0);
    match fold {
        None => [Some(Branch { ends: [0.0, 1.0], halves: [start, end] }), None],
        Some((w, at_fold)) => [
            Some(Branch { ends: [0.0, w], halves: [start, at_fold] }),
            Some(Branch { ends: [w, 1.0], halves: [at_fold, end] }),
        ],
    }
}

/// Returns true if `psi` reaches the target between two ends, given the halves of its differences.
#[inline(always)]
pub(super) fn is_between([low, high]: [Phase; 2]) -> bool {
    (low.im < 0.0) != (high.im < 0.0)
}

/// Returns where a parabola with its vertex at the fold would have its root.
#[inline(always)]
pub(super) fn guess([low, high]: [f64; 2], halves: [Phase; 2]) -> f64 {
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
