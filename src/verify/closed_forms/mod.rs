//! Whole renders against closed-form solutions, for every applicable estimator, sampler and
//! intersector. Each scene is a file in `scenes/verify/`; the solution is derived in the file's
//! header and computed here.
//!
//! The scenes are embedded in the program, so an installed copy can be checked. A solution is one
//! value per pixel; pixels with an edge between two surfaces have none. `comparison.rs` explains
//! how an image is judged.

mod comparison;
mod forms;
mod reference_image;
mod sphere_light;
mod variants;

pub use forms::{CLOSED_FORMS, ClosedForm, LightTransport};
pub use variants::RenderVariant;

use crate::accel::Backend;

use super::check::{Check, CheckGroup, Effort};

/// Returns a check for every closed form and every combination of variants that the effort allows.
pub fn checks(effort: Effort, backends: &[Backend]) -> Vec<Check> {
    let form_checks = |form: &'static ClosedForm| {
        let variants = variants::combinations(form, effort, backends);
        variants.into_iter().map(move |(variant, backend)| check(form, &variant, backend, effort))
    };
    CLOSED_FORMS.iter().flat_map(form_checks).collect()
}

/// Returns the check of one closed form in one variant.
pub fn check(
    form: &'static ClosedForm,
    variant: &RenderVariant,
    backend: Backend,
    effort: Effort,
) -> Check {
    let name = format!("{}: {}, {}", form.name, variant.name(), backend.name());
    let (seed_name, variant) = (name.clone(), variant.clone());
    Check::new(CheckGroup::ClosedForms, name, move |cancel| {
        comparison::measure(form, &variant, backend, effort, &seed_name, cancel)
    })
    .of_closed_form(form.name)
}
