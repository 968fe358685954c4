//! Probabilities of sampling emitters, the environment map or the sun from a shading point, based
//! on the expected irradiance of each. Occlusion is unknown, so a fixed share is split evenly.

use super::context::LightSampleContext;
use super::environment::Environment;
use super::light_sampler::LightSampler;

/// Fraction of samples split evenly among all categories that may illuminate the point.
const UNIFORM_FRACTION: f64 = 0.2;

/// A category of lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LightCategory {
    Emitters,
    EnvironmentMap,
    Sun,
}

/// The probability of each category, in the order of the enum.
pub(super) struct CategoryPmf {
    probabilities: [f64; 3],
}

impl CategoryPmf {
    /// `None` if no light can be sampled.
    pub(super) fn new(
        choice: &LightSampler,
        has_emitters: bool,
        background: &Environment,
        from: &LightSampleContext,
    ) -> Option<Self> {
        if !background.is_sampled() {
            return has_emitters.then_some(Self { probabilities: [1.0, 0.0, 0.0] });
        }
        let sun = background.sun().map_or(0.0, |sun| sun.importance(from));
        let dome = background.importance(from);
        // Scenes with emitters only are the common case and need no importance there.
        let emitters = match sun > 0.0 || dome > 0.0 {
            true => choice.importance(from),
            false => f64::from(u8::from(has_emitters)),
        };
        let importance = [emitters, dome, sun];
        let total: f64 = importance.iter().sum();
        let count = importance.iter().filter(|&&importance| importance > 0.0).count() as f64;
        let share = |importance| match importance > 0.0 {
            true => UNIFORM_FRACTION / count + (1.0 - UNIFORM_FRACTION) * importance / total,
            false => 0.0,
        };
        (total > 0.0).then(|| Self { probabilities: importance.map(share) })
    }

    /// Returns the probability of a category.
    pub(super) fn pmf(&self, kind: LightCategory) -> f64 {
        self.probabilities[kind as usize]
    }

    /// Returns the category selected by `u` in `[0, 1)`, its probability, and `u` remapped to
    /// `[0, 1)`.
    pub(super) fn sample(&self, mut u: f64) -> (LightCategory, f64, f64) {
        let mut last = (LightCategory::Emitters, self.probabilities[0], u);
        for kind in [LightCategory::Emitters, LightCategory::EnvironmentMap, LightCategory::Sun] {
            let share = self.pmf(kind);
            if share > 0.0 {
                last = (kind, share, (u / share).min(1.0 - f64::EPSILON));
                if u < share {
                    break;
                }
                u -= share;
            }
        }
        last
    }
}
