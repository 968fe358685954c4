//! What a check is, what comes of it, and how many of them are run as one suite.
//!
//! Every check is called by its name and answers alone, so a test can ask for one of them; its random
//! numbers are a function of that name. A check passes while its statistic stays within a limit: for
//! what is random the statistic is a p-value told in standard deviations of a normal distribution
//! ([`sigmas`]), and the limits of all such checks of a suite together keep one family-wise
//! significance; for what is exact it counts wrong answers, and the limit is 0.

use rayon::prelude::*;

use crate::draw::Cells;
use crate::error::Result;
use crate::task::CancelToken;

use super::statistics::{bonferroni, sigmas};

/// The probability that a right program fails any of the random checks of a suite.
pub const FAMILY_SIGNIFICANCE: f64 = 1e-3;

/// How much work a suite may do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Effort {
    /// Well below a minute on two cores.
    Quick,
    /// A few minutes.
    #[default]
    Normal,
    /// As long as it takes: every combination, and four times the samples.
    Full,
}

impl Effort {
    /// The choice among three values, in the order quick, normal, full.
    pub fn select<T: Copy>(self, values: [T; 3]) -> T {
        values[self as usize]
    }
}

/// What a check is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum CheckGroup {
    /// Intersectors against arithmetic of twice the digits.
    Crosscheck,
    /// Sampling routines against their densities.
    ChiSquare,
    /// Energy and reciprocity of the materials.
    Materials,
    /// Whole renders against answers known on paper.
    ClosedForms,
}

impl CheckGroup {
    /// Every group, in the order of a report.
    pub const ALL: [Self; 4] =
        [Self::Crosscheck, Self::ChiSquare, Self::Materials, Self::ClosedForms];

    /// What people call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Crosscheck => "crosscheck",
            Self::ChiSquare => "chi-square",
            Self::Materials => "materials",
            Self::ClosedForms => "closed forms",
        }
    }
}

/// How a check came by its result.
#[derive(Clone, Debug)]
pub enum TestStatistic {
    /// What happened would happen to a right program with this probability.
    PValue(f64),
    /// So many answers were wrong.
    ErrorCount(usize),
}

/// What a check found, before it is judged.
#[derive(Clone, Debug)]
pub struct CheckMeasurement {
    /// By which it is judged.
    pub statistic: TestStatistic,
    /// The figures in one line.
    pub detail: String,
    /// What there is to see.
    pub images: Vec<Cells>,
    /// What the user ought to know though the check passed.
    pub note: Option<String>,
}

/// The work of a check. It looks at the request to stop now and then.
pub type CheckFn = Box<dyn Fn(&CancelToken) -> Result<CheckMeasurement> + Send + Sync>;

/// One check.
pub struct Check {
    /// Its name, which no other check has.
    pub name: String,
    /// What it is about.
    pub group: CheckGroup,
    /// Measures; [`Self::run`] judges as well.
    pub measure: CheckFn,
    /// The probability with which a right program may fail this check; [`split_significance`] sets
    /// it. Exact checks do not heed it.
    pub significance: f64,
}

/// The judged result of a check.
#[derive(Clone, Debug)]
pub struct CheckResult {
    /// Whether the statistic is within the limit.
    pub passed: bool,
    /// Standard deviations for what is random, wrong answers for what is exact.
    pub statistic: f64,
    /// The largest statistic that passes.
    pub limit: f64,
    /// Whether chance has a part in it; then the statistic is in standard deviations.
    pub is_random: bool,
    /// The figures in one line.
    pub detail: String,
    /// What there is to see.
    pub images: Vec<Cells>,
    /// What the user ought to know though the check passed.
    pub note: Option<String>,
}

impl Check {
    /// A check of this name, to be judged alone.
    pub fn new(
        group: CheckGroup,
        name: impl Into<String>,
        work: impl Fn(&CancelToken) -> Result<CheckMeasurement> + Send + Sync + 'static,
    ) -> Self {
        let significance = FAMILY_SIGNIFICANCE;
        Self { name: name.into(), group, measure: Box::new(work), significance }
    }

    /// Does the check.
    ///
    /// # Errors
    /// On cancellation, and when the means to check are missing, as an intersector that cannot be
    /// built.
    pub fn run(&self, cancel: &CancelToken) -> Result<CheckResult> {
        cancel.check()?;
        let measured = (self.measure)(cancel)?;
        cancel.check()?;
        Ok(measured.judge(self.significance))
    }
}

impl CheckMeasurement {
    /// A result without pictures.
    pub fn new(finding: TestStatistic, detail: impl Into<String>) -> Self {
        Self { statistic: finding, detail: detail.into(), images: Vec::new(), note: None }
    }

    /// With something to see.
    #[must_use]
    pub fn with_images(self, pictures: Vec<Cells>) -> Self {
        Self { images: pictures, ..self }
    }

    /// With a remark.
    #[must_use]
    pub fn with_note(self, remark: impl Into<String>) -> Self {
        Self { note: Some(remark.into()), ..self }
    }

    fn judge(self, significance: f64) -> CheckResult {
        let Self { statistic: finding, detail, images: pictures, note: remark } = self;
        let (statistic, limit, is_random) = match finding {
            TestStatistic::PValue(p) => (sigmas(p), sigmas(significance), true),
            TestStatistic::ErrorCount(count) => (count as f64, 0.0, false),
        };
        let passed = statistic <= limit;
        CheckResult { passed, statistic, limit, is_random, detail, images: pictures, note: remark }
    }
}

/// Gives each check its share of the family-wise significance.
pub fn split_significance(checks: &mut [Check]) {
    let each = bonferroni(FAMILY_SIGNIFICANCE, checks.len());
    checks.iter_mut().for_each(|check| check.significance = each);
}

/// How far a suite is.
#[derive(Clone, Copy)]
pub struct SuiteProgress<'a> {
    /// Checks finished, this one included.
    pub done: usize,
    /// Checks in all.
    pub total: usize,
    /// The check that was just finished.
    pub check: &'a Check,
    /// What came of it.
    pub result: &'a CheckResult,
}

/// Runs all checks on the current rayon thread pool, several at once; the outcomes are in their
/// order and do not depend on the number of threads. `progress` is called from any thread.
///
/// # Errors
/// The first error of a check, and on cancellation.
pub fn run_all(
    checks: &[Check],
    cancel: &CancelToken,
    progress: &(dyn Fn(SuiteProgress<'_>) + Sync),
) -> Result<Vec<CheckResult>> {
    let done = std::sync::atomic::AtomicUsize::new(0);
    let run = |check: &Check| {
        let outcome = check.run(cancel)?;
        let done = 1 + done.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        progress(SuiteProgress { done, total: checks.len(), check, result: &outcome });
        Ok(outcome)
    };
    // One by one, so that a long check at the end of a thread's share is not waited for alone.
    checks.par_iter().with_max_len(1).map(run).collect()
}

/// A seed that depends on a check's name alone, and differs for each `index`: FNV-1a (Fowler, Noll,
/// Vo 1991), within the range that a scene takes.
pub fn seed(name: &str, index: u64) -> u64 {
    let mix = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    let hash = name.bytes().fold(0xcbf2_9ce4_8422_2325, mix);
    index.to_le_bytes().into_iter().fold(hash, mix) >> 1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(finding: TestStatistic) -> Check {
        Check::new(CheckGroup::ChiSquare, "a check", move |_| {
            Ok(CheckMeasurement::new(finding.clone(), ""))
        })
    }

    #[test]
    fn a_check_passes_up_to_its_limit() {
        let passes = |finding| check(finding).run(&CancelToken::default()).expect("runs").passed;
        assert!(passes(TestStatistic::PValue(1.0)) && passes(TestStatistic::PValue(0.01)));
        assert!(!passes(TestStatistic::PValue(0.0)) && !passes(TestStatistic::PValue(0.9e-3)));
        assert!(passes(TestStatistic::ErrorCount(0)) && !passes(TestStatistic::ErrorCount(1)));
    }

    #[test]
    fn a_family_of_checks_is_judged_more_gently() {
        let mut checks: Vec<_> = (0..100).map(|_| check(TestStatistic::PValue(1e-4))).collect();
        let passes = |checks: &[Check]| {
            let outcomes = run_all(checks, &CancelToken::default(), &|_| ()).expect("runs");
            outcomes.iter().filter(|outcome| outcome.passed).count()
        };
        assert_eq!(passes(&checks), 0);
        split_significance(&mut checks);
        assert_eq!(passes(&checks), 100);
    }

    #[test]
    fn a_request_to_stop_is_an_error_and_progress_counts_to_the_end() {
        let cancel = CancelToken::default();
        let checks: Vec<_> = (0..7).map(|_| check(TestStatistic::ErrorCount(0))).collect();
        let most = std::sync::Mutex::new(0);
        let count = |p: SuiteProgress<'_>| {
            let mut most = most.lock().expect("nobody panics");
            *most = p.done.max(*most);
        };
        assert_eq!(run_all(&checks, &cancel, &count).expect("runs").len(), 7);
        assert_eq!(*most.lock().expect("nobody panics"), 7);
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
