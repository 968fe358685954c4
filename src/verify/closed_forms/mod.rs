//! Whole renders against answers known on paper: one scene file for each in `scenes/verify/`, its
//! answer derived in the file's head and computed here, for every estimator, sampler and
//! intersector that applies.
//!
//! The scenes are part of the program, so that an installed one can be checked. An answer is a value
//! for each pixel; pixels that hold an edge between two surfaces have none. How a
//! picture is judged says `judge.rs`.

mod field;
mod forms;
mod judge;
mod lamp;
mod ways;

pub use forms::{FORMS, Form, Shows};
pub use ways::Way;

use crate::accel::Backend;

use super::check::{Check, Effort, Group};

/// A check for every form, and every combination of the others that the effort allows.
pub fn checks(effort: Effort, backends: &[Backend]) -> Vec<Check> {
    let of_form = |form: &'static Form| {
        let ways = ways::combinations(form, effort, backends);
        ways.into_iter().map(move |(way, backend)| check(form, &way, backend, effort))
    };
    FORMS.iter().flat_map(of_form).collect()
}

/// The check of one form in one way.
pub fn check(form: &'static Form, way: &Way, backend: Backend, effort: Effort) -> Check {
    let name = format!("{}: {}, {}", form.name, way.name(), backend.name());
    let (seed_of, way) = (name.clone(), way.clone());
    Check::new(Group::ClosedForms, name, move |cancel| {
        judge::measure(form, &way, backend, effort, &seed_of, cancel)
    })
}
