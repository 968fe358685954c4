//! Variants in which a closed form is rendered: estimator, sampler and intersector.

use crate::accel::Backend;
use crate::verify::check::Effort;

use super::{ClosedForm, LightTransport};

/// An estimator and a sampler, as keys of the scene.
#[derive(Clone, Debug)]
pub struct RenderVariant {
    estimator: &'static NamedOverrides,
    sampler: &'static NamedOverrides,
}

/// A named option and the keys that select it.
#[derive(Debug)]
struct NamedOverrides {
    name: &'static str,
    overrides: &'static [&'static str],
}

const fn named_overrides(name: &'static str, overrides: &'static [&'static str]) -> NamedOverrides {
    NamedOverrides { name, overrides }
}

/// All estimators, the default first.
static ESTIMATORS: [NamedOverrides; 9] = [
    named_overrides("path", &["render.integrator=path", "render.estimator=mis"]),
    named_overrides("path, aimed", &["render.integrator=path", "render.estimator=light"]),
    named_overrides("path, by chance", &["render.integrator=path", "render.estimator=bsdf"]),
    named_overrides("direct", &["render.integrator=direct", "render.estimator=mis"]),
    named_overrides("direct, aimed", &["render.integrator=direct", "render.estimator=light"]),
    named_overrides("direct, by chance", &["render.integrator=direct", "render.estimator=bsdf"]),
    named_overrides("paper", &["render.integrator=paper"]),
    named_overrides(
        "paper, uniform solid angle",
        &["render.integrator=paper", "render.paper.hemisphere=uniform-solid-angle"],
    ),
    named_overrides(
        "paper, uniform angle",
        &["render.integrator=paper", "render.paper.hemisphere=uniform-angle"],
    ),
];

/// Estimators for direct light only, as a range of [`ESTIMATORS`].
const DIRECT: std::ops::Range<usize> = 3..6;

/// Estimators that find a caustic by light sampling alone, of [`ESTIMATORS`].
const AIMED: [usize; 2] = [1, 4];

/// Estimators that connect, of [`ESTIMATORS`].
const CONNECTED: [usize; 4] = [0, 1, 3, 4];

/// Integrators that a scene selects itself.
static SCENE_INTEGRATORS: [NamedOverrides; 2] =
    [named_overrides("ambient-occlusion", &[]), named_overrides("normals", &[])];

/// All samplers, the default first.
static SAMPLERS: [NamedOverrides; 3] = [
    named_overrides("sobol", &["render.sampler=sobol"]),
    named_overrides("independent", &["render.sampler=independent"]),
    named_overrides("stratified", &["render.sampler=stratified"]),
];

impl RenderVariant {
    /// Returns the name shown to users.
    pub fn name(&self) -> String {
        format!("{}, {}", self.estimator.name, self.sampler.name)
    }

    /// Overrides of scene keys, as `key=value`.
    pub(super) fn overrides(&self) -> impl Iterator<Item = &str> {
        self.estimator.overrides.iter().chain(self.sampler.overrides).copied()
    }
}

/// Variants of a closed form. Full: every combination. Normal: every estimator with every sampler
/// on the first intersector, and with the default sampler on every intersector. Quick: at most one
/// option differs from the defaults.
pub(super) fn combinations(
    form: &ClosedForm,
    effort: Effort,
    backends: &[Backend],
) -> Vec<(RenderVariant, Backend)> {
    let mut variants = Vec::new();
    for (b, &backend) in backends.iter().enumerate() {
        for (s, sampler) in SAMPLERS.iter().enumerate() {
            for (e, estimator) in estimators(form).enumerate() {
                let non_default = [b, s, e].iter().filter(|&&index| index > 0).count();
                let is_included = match effort {
                    Effort::Quick => non_default <= 1,
                    Effort::Normal => b == 0 || s == 0,
                    Effort::Full => true,
                };
                if is_included {
                    variants.push((RenderVariant { estimator, sampler }, backend));
                }
            }
        }
    }
    variants
}

fn estimators(form: &ClosedForm) -> impl Iterator<Item = &'static NamedOverrides> {
    let transport = form.transport;
    let is_applicable = move |(index, _): &(usize, &NamedOverrides)| match transport {
        LightTransport::Global => !DIRECT.contains(index),
        LightTransport::Direct => true,
        LightTransport::Caustic => !AIMED.contains(index),
        LightTransport::Connected => CONNECTED.contains(index),
        LightTransport::Integrator(_) => false,
    };
    let named = SCENE_INTEGRATORS
        .iter()
        .filter(move |integrator| transport == LightTransport::Integrator(integrator.name));
    let estimators =
        ESTIMATORS.iter().enumerate().filter(is_applicable).map(|(_, estimator)| estimator);
    named.chain(estimators)
}
