//! Whole renders against answers known on paper: one scene file for each in `scenes/verify/`, its
//! answer derived in the file's head and computed here, for every estimator, sampler and
//! intersector that applies.
//!
//! The scenes are part of the program, so that an installed one can be checked. An answer is a value
//! for each pixel; pixels that hold an edge between two surfaces have none. How a
//! picture is judged says `judge.rs`.

mod comparison;
mod forms;
mod reference_image;
mod sphere_light;
mod variants;

pub use forms::{CLOSED_FORMS, ClosedForm, LightTransport};
pub use variants::RenderVariant;

use crate::accel::Backend;

use super::check::{Check, CheckGroup, Effort};

/// A check for every form, and every combination of the others that the effort allows.
pub fn checks(effort: Effort, backends: &[Backend]) -> Vec<Check> {
    let of_form = |form: &'static ClosedForm| {
        let ways = variants::combinations(form, effort, backends);
        ways.into_iter().map(move |(way, backend)| check(form, &way, backend, effort))
    };
    CLOSED_FORMS.iter().flat_map(of_form).collect()
}

/// The check of one form in one way.
pub fn check(
    form: &'static ClosedForm,
    way: &RenderVariant,
    backend: Backend,
    effort: Effort,
) -> Check {
    let name = format!("{}: {}, {}", form.name, way.name(), backend.name());
    let (seed_of, way) = (name.clone(), way.clone());
    Check::new(CheckGroup::ClosedForms, name, move |cancel| {
        comparison::measure(form, &way, backend, effort, &seed_of, cancel)
    })
}
