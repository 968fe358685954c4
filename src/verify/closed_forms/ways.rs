//! The ways in which a closed form is rendered: estimator, sampler and intersector.

use crate::accel::Backend;
use crate::verify::check::Effort;

use super::{Form, Shows};

/// An estimator and a sampler, as keys of the scene.
#[derive(Clone, Debug)]
pub struct Way {
    estimator: &'static Choice,
    sampler: &'static Choice,
}

/// A choice by its name, and the keys that make it.
#[derive(Debug)]
struct Choice {
    name: &'static str,
    overrides: &'static [&'static str],
}

const fn choice(name: &'static str, overrides: &'static [&'static str]) -> Choice {
    Choice { name, overrides }
}

/// Every estimator. The default comes first.
static ESTIMATORS: [Choice; 9] = [
    choice("path", &["render.integrator=path", "render.estimator=mis"]),
    choice("path, aimed", &["render.integrator=path", "render.estimator=light"]),
    choice("path, by chance", &["render.integrator=path", "render.estimator=bsdf"]),
    choice("direct", &["render.integrator=direct", "render.estimator=mis"]),
    choice("direct, aimed", &["render.integrator=direct", "render.estimator=light"]),
    choice("direct, by chance", &["render.integrator=direct", "render.estimator=bsdf"]),
    choice("paper", &["render.integrator=paper"]),
    choice(
        "paper, uniform solid angle",
        &["render.integrator=paper", "render.paper.hemisphere=uniform-solid-angle"],
    ),
    choice(
        "paper, uniform angle",
        &["render.integrator=paper", "render.paper.hemisphere=uniform-angle"],
    ),
];

/// Those among them that leave indirect light out.
const DIRECT: std::ops::Range<usize> = 3..6;

/// Integrators that a scene names itself.
static NAMED: [Choice; 2] = [choice("ambient-occlusion", &[]), choice("normals", &[])];

/// The default comes first.
static SAMPLERS: [Choice; 3] = [
    choice("sobol", &["render.sampler=sobol"]),
    choice("independent", &["render.sampler=independent"]),
    choice("stratified", &["render.sampler=stratified"]),
];

impl Way {
    /// What people call it.
    pub fn name(&self) -> String {
        format!("{}, {}", self.estimator.name, self.sampler.name)
    }

    /// `key=value` for the scene.
    pub(super) fn overrides(&self) -> impl Iterator<Item = &str> {
        self.estimator.overrides.iter().chain(self.sampler.overrides).copied()
    }
}

/// The ways of a form. Full: every combination. Normal: every estimator with every sampler on one
/// intersector, and with one sampler on every intersector. Quick: one thing at a time.
pub(super) fn combinations(
    form: &Form,
    effort: Effort,
    backends: &[Backend],
) -> Vec<(Way, Backend)> {
    let mut all = Vec::new();
    for (b, &backend) in backends.iter().enumerate() {
        for (s, sampler) in SAMPLERS.iter().enumerate() {
            for (e, estimator) in estimators(form).enumerate() {
                let others = [b, s, e].iter().filter(|&&index| index > 0).count();
                let is_wanted = match effort {
                    Effort::Quick => others <= 1,
                    Effort::Normal => b == 0 || s == 0,
                    Effort::Full => true,
                };
                if is_wanted {
                    all.push((Way { estimator, sampler }, backend));
                }
            }
        }
    }
    all
}

fn estimators(form: &Form) -> impl Iterator<Item = &'static Choice> {
    let shows = form.shows;
    let finds_all = move |(index, _): &(usize, &Choice)| match shows {
        Shows::All => !DIRECT.contains(index),
        Shows::Direct => true,
        Shows::Named(_) => false,
    };
    let named = NAMED.iter().filter(move |choice| shows == Shows::Named(choice.name));
    let others = ESTIMATORS.iter().enumerate().filter(finds_all).map(|(_, estimator)| estimator);
    named.chain(others)
}
