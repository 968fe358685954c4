//! Probabilities of sampling emitters, the environment map or the sun from a shading point, based
//! on the expected irradiance of each. Occlusion is unknown, so a fixed fraction is split evenly.

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

/// The probability of each category of lights (emitters, environment map, sun), in this order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CategoryPmf {
    probabilities: [f64; 3],
}

impl CategoryPmf {
    /// No light can be sampled.
    pub const NONE: Self = Self { probabilities: [0.0; 3] };
    /// Only emitters can be sampled.
    pub const EMITTERS: Self = Self { probabilities: [1.0, 0.0, 0.0] };

    /// The probabilities at a shading point.
    pub(super) fn new(
        light_sampler: &LightSampler,
        has_emitters: bool,
        environment: &Environment,
        ctx: &LightSampleContext,
    ) -> Self {
        if !environment.is_sampled() {
            return if has_emitters { Self::EMITTERS } else { Self::NONE };
        }
        let sun = environment.sun().map_or(0.0, |sun| sun.importance(ctx));
        let environment_map = environment.importance(ctx);
        // Scenes with emitters only are the common case and need no importance there.
        let emitters = match sun > 0.0 || environment_map > 0.0 {
            true => light_sampler.importance(ctx),
            false => f64::from(u8::from(has_emitters)),
        };
        let importance = [emitters, environment_map, sun];
        let total: f64 = importance.iter().sum();
        let count: u32 = importance.iter().map(|&importance| u32::from(importance > 0.0)).sum();
        let uniform = UNIFORM_FRACTION / f64::from(count);
        let per_importance = (1.0 - UNIFORM_FRACTION) / total;
        let probability = |importance| match importance > 0.0 {
            true => uniform + per_importance * importance,
            false => 0.0,
        };
        if total > 0.0 { Self { probabilities: importance.map(probability) } } else { Self::NONE }
    }

    /// Returns true if no light can be sampled.
    pub(super) fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// Returns the probability of a category.
    pub(super) fn pmf(&self, category: LightCategory) -> f64 {
        self.probabilities[category as usize]
    }

    /// Returns the category selected by `u` in `[0, 1)`, its probability, and `u` remapped to
    /// `[0, 1)`.
    pub(super) fn sample(&self, mut u: f64) -> (LightCategory, f64, f64) {
        let mut last = (LightCategory::Emitters, self.probabilities[0], u);
        for category in [LightCategory::Emitters, LightCategory::EnvironmentMap, LightCategory::Sun]
        {
            let probability = self.pmf(category);
            if probability > 0.0 {
                last = (category, probability, (u / probability).min(1.0 - f64::EPSILON));
                if u < probability {
                    break;
                }
                u -= probability;
            }
        }
        last
    }
}
