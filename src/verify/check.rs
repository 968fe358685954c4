//! Checks, their results, and how a suite of them is run.
//!
//! A check is identified by its name and runs on its own, so a test can run a single one; its
//! random numbers depend only on that name. A check passes if its statistic is within a limit. For
//! random checks the statistic is a p-value expressed in standard deviations of a normal
//! distribution ([`sigmas`]), and the limits of all random checks of a suite together keep one
//! family-wise significance. For exact checks it counts wrong answers, and the limit is 0.

use rayon::prelude::*;

use crate::draw::Cells;
use crate::error::Result;
use crate::task::CancelToken;

use super::statistics::{bonferroni, sigmas};

/// Probability that a correct program fails any random check of a suite.
pub const FAMILY_SIGNIFICANCE: f64 = 1e-3;

/// How much work a suite may do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Effort {
    /// Well under a minute on two cores.
    Quick,
    /// A few minutes.
    #[default]
    Normal,
    /// No time limit: every combination, and four times the samples.
    Full,
}

impl Effort {
    /// Selects one of three values, ordered quick, normal, full.
    pub fn select<T: Copy>(self, values: [T; 3]) -> T {
        values[self as usize]
    }
}

/// Group that a check belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum CheckGroup {
    /// Intersectors against arithmetic of twice the precision.
    Crosscheck,
    /// Sampling routines against their pdfs.
    ChiSquare,
    /// Energy conservation and reciprocity of the materials.
    Materials,
    /// Connections over polished balls against paths that find the same light by chance.
    Connections,
    /// Whole renders against closed-form solutions.
    ClosedForms,
}

impl CheckGroup {
    /// All groups, in the order of a report.
    pub const ALL: [Self; 5] =
        [Self::Crosscheck, Self::ChiSquare, Self::Materials, Self::Connections, Self::ClosedForms];

    /// Returns the name shown to users.
    pub fn name(self) -> &'static str {
        match self {
            Self::Crosscheck => "crosscheck",
            Self::ChiSquare => "chi-square",
            Self::Materials => "materials",
            Self::Connections => "connections",
            Self::ClosedForms => "closed forms",
        }
    }
}

/// Test statistic of a check.
#[derive(Clone, Debug)]
pub enum TestStatistic {
    /// Probability that a correct program gives a result at least this extreme.
    PValue(f64),
    /// Number of wrong answers.
    ErrorCount(usize),
}

/// Raw result of a check, before it is compared with a limit.
#[derive(Clone, Debug)]
pub struct CheckMeasurement {
    /// The statistic that decides the check.
    pub statistic: TestStatistic,
    /// Figures, in one line.
    pub detail: String,
    /// Images to show with the result.
    pub images: Vec<Cells>,
    /// Remark for the user, even if the check passed.
    pub note: Option<String>,
}

/// Body of a check. Polls the token to honour cancellation.
pub type CheckFn = Box<dyn Fn(&CancelToken) -> Result<CheckMeasurement> + Send + Sync>;

/// A single check.
pub struct Check {
    /// Unique name.
    pub name: String,
    /// Name of the closed form that the check renders in one of several variants, if any.
    pub closed_form: Option<&'static str>,
    /// Group that the check belongs to.
    pub group: CheckGroup,
    /// Measures without judging; [`Self::run`] does both.
    pub measure: CheckFn,
    /// Probability with which a correct program may fail this check, set by [`split_significance`].
    /// Ignored by exact checks.
    pub significance: f64,
}

/// Result of a check, compared with its limit.
#[derive(Clone, Debug)]
pub struct CheckResult {
    /// True if the statistic is within the limit.
    pub passed: bool,
    /// Standard deviations for a random check, number of wrong answers for an exact one.
    pub statistic: f64,
    /// Largest statistic that passes.
    pub limit: f64,
    /// True for a random check; the statistic is then in standard deviations.
    pub is_random: bool,
    /// Figures, in one line.
    pub detail: String,
    /// Images to show with the result.
    pub images: Vec<Cells>,
    /// Remark for the user, even if the check passed.
    pub note: Option<String>,
}

impl Check {
    /// Creates a check with the full family significance, to be run on its own.
    pub fn new(
        group: CheckGroup,
        name: impl Into<String>,
        work: impl Fn(&CancelToken) -> Result<CheckMeasurement> + Send + Sync + 'static,
    ) -> Self {
        let significance = FAMILY_SIGNIFICANCE;
        let name = name.into();
        Self { name, closed_form: None, group, measure: Box::new(work), significance }
    }

    /// Names the closed form that the check renders.
    #[must_use]
    pub fn of_closed_form(self, name: &'static str) -> Self {
        Self { closed_form: Some(name), ..self }
    }

    /// Runs the check and compares its statistic with the limit.
    ///
    /// # Errors
    /// On cancellation, or if a prerequisite is missing, such as an intersector that cannot be
    /// built.
    pub fn run(&self, cancel: &CancelToken) -> Result<CheckResult> {
        cancel.check()?;
        let measurement = (self.measure)(cancel)?;
        cancel.check()?;
        Ok(measurement.judge(self.significance))
    }
}

impl CheckMeasurement {
    /// Creates a result without images.
    pub fn new(statistic: TestStatistic, detail: impl Into<String>) -> Self {
        Self { statistic, detail: detail.into(), images: Vec::new(), note: None }
    }

    /// Adds images.
    #[must_use]
    pub fn with_images(self, images: Vec<Cells>) -> Self {
        Self { images, ..self }
    }

    /// Adds a remark.
    #[must_use]
    pub fn with_note(self, note: impl Into<String>) -> Self {
        Self { note: Some(note.into()), ..self }
    }

    fn judge(self, significance: f64) -> CheckResult {
        let Self { statistic, detail, images, note } = self;
        let (statistic, limit, is_random) = match statistic {
            TestStatistic::PValue(p) => (sigmas(p), sigmas(significance), true),
            TestStatistic::ErrorCount(count) => (count as f64, 0.0, false),
        };
        let passed = statistic <= limit;
        CheckResult { passed, statistic, limit, is_random, detail, images, note }
    }
}

/// Gives each check its share of the family-wise significance.
pub fn split_significance(checks: &mut [Check]) {
    let significance = bonferroni(FAMILY_SIGNIFICANCE, checks.len());
    checks.iter_mut().for_each(|check| check.significance = significance);
}

/// Progress of a running suite.
#[derive(Clone, Copy)]
pub struct SuiteProgress<'a> {
    /// Checks finished, including this one.
    pub done: usize,
    /// Total number of checks.
    pub total: usize,
    /// Check that just finished.
    pub check: &'a Check,
    /// Result of that check.
    pub result: &'a CheckResult,
}

/// Runs all checks concurrently on the current rayon pool. Results are in the order of the checks
/// and do not depend on the number of threads. `progress` may be called from any thread.
///
/// # Errors
/// The first error of a check, or on cancellation.
pub fn run_all(
    checks: &[Check],
    cancel: &CancelToken,
    progress: &(dyn Fn(SuiteProgress<'_>) + Sync),
) -> Result<Vec<CheckResult>> {
    let done = std::sync::atomic::AtomicUsize::new(0);
    let run = |check: &Check| {
        let result = check.run(cancel)?;
        let done = 1 + done.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        progress(SuiteProgress { done, total: checks.len(), check, result: &result });
        Ok(result)
    };
    // No batching, so that a long check at the end of one thread's share does not delay the rest.
    checks.par_iter().with_max_len(1).map(run).collect()
}

/// Derives a seed from a check's name and `index`: FNV-1a (Fowler, Noll, Vo 1991), reduced to the
/// range of scene seeds.
pub fn seed(name: &str, index: u64) -> u64 {
    let mix = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    let hash = name.bytes().fold(0xcbf2_9ce4_8422_2325, mix);
    index.to_le_bytes().into_iter().fold(hash, mix) >> 1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(statistic: TestStatistic) -> Check {
        Check::new(CheckGroup::ChiSquare, "a check", move |_| {
            Ok(CheckMeasurement::new(statistic.clone(), ""))
        })
    }

    #[test]
    fn a_check_passes_up_to_its_limit() {
        let passes =
            |statistic| check(statistic).run(&CancelToken::default()).expect("runs").passed;
        assert!(passes(TestStatistic::PValue(1.0)) && passes(TestStatistic::PValue(0.01)));
        assert!(!passes(TestStatistic::PValue(0.0)) && !passes(TestStatistic::PValue(0.9e-3)));
        assert!(passes(TestStatistic::ErrorCount(0)) && !passes(TestStatistic::ErrorCount(1)));
    }

    #[test]
    fn a_family_of_checks_is_judged_more_gently() {
        let mut checks: Vec<_> = (0..100).map(|_| check(TestStatistic::PValue(1e-4))).collect();
        let passes = |checks: &[Check]| {
            let results = run_all(checks, &CancelToken::default(), &|_| ()).expect("runs");
            results.iter().filter(|result| result.passed).count()
        };
        assert_eq!(passes(&checks), 0);
        split_significance(&mut checks);
        assert_eq!(passes(&checks), 100);
    }

    #[test]
    fn a_request_to_stop_is_an_error_and_progress_counts_to_the_end() {
        let cancel = CancelToken::default();
        let checks: Vec<_> = (0..7).map(|_| check(TestStatistic::ErrorCount(0))).collect();
        let max_done = std::sync::Mutex::new(0);
        let count = |p: SuiteProgress<'_>| {
            let mut max_done = max_done.lock().expect("nobody panics");
            *max_done = p.done.max(*max_done);
        };
        assert_eq!(run_all(&checks, &cancel, &count).expect("runs").len(), 7);
        assert_eq!(*max_done.lock().expect("nobody panics"), 7);
        cancel.cancel();
        assert!(run_all(&checks, &cancel, &|_| ()).is_err());
    }

    #[test]
    fn seeds_differ_by_name_and_index() {
        let mut seeds: Vec<_> =
            ["a", "b"].iter().flat_map(|name| (0..50).map(|i| seed(name, i))).collect();
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len(), 100);
    }
}
