//! All checks, in the order of a report.

use crate::accel::Backend;

use super::check::{Check, Effort, split_significance};
use super::{chi2_checks, closed_forms, connections, intersector_checks, materials};

/// Returns every check on every intersector of this build.
pub fn all_checks(effort: Effort) -> Vec<Check> {
    all_checks_on(effort, Backend::AVAILABLE)
}

/// Returns every check, on these intersectors where one is used. The first is used most.
pub fn all_checks_on(effort: Effort, backends: &[Backend]) -> Vec<Check> {
    let mut checks = intersector_checks::checks(effort, backends);
    checks.extend(chi2_checks::checks(effort));
    checks.extend(materials::checks(effort));
    checks.extend(connections::checks(effort, backends));
    checks.extend(closed_forms::checks(effort, backends));
    split_significance(&mut checks);
    checks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_differ_and_more_effort_loses_no_check() {
        let names = |effort| {
            let mut names: Vec<_> =
                all_checks(effort).into_iter().map(|check| check.name).collect();
            let count = names.len();
            names.sort();
            names.dedup();
            assert_eq!(names.len(), count, "every name is one check's");
            names
        };
        let [quick, normal, full] = [Effort::Quick, Effort::Normal, Effort::Full].map(names);
        assert!(quick.iter().all(|name| normal.binary_search(name).is_ok()));
        assert!(normal.iter().all(|name| full.binary_search(name).is_ok()));
    }
}
