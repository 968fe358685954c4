//! What a report on checks lists.

use crate::verify::check::{Check, CheckResult};

/// A check and its result.
pub type CheckEntry<'a> = (&'a Check, &'a CheckResult);
