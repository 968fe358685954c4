//! `photosphere verify`: runs every check of the program on the user's machine and build.

use std::io::Write as _;
use std::time::{Duration, Instant};

use crate::accel::embree_info;
use crate::error::{Error, Result};
use crate::image_io::AtomicFile;
use crate::job::Observer;
use crate::report::checks::{self, CheckEntry};
use crate::task::CancelToken;
use crate::verify::all_checks_on;
use crate::verify::check::{self, Check, Effort, run_all, split_significance};

use super::args::VerifyArgs;
use super::exit::Exit;
use super::progress::ProgressDisplay;
use super::system::on_threads;
use super::{interrupt, print, system};

const BETWEEN_LINES: Duration = Duration::from_secs(5);
const BAR: &str = "{bar:32} {pos} of {len}  {elapsed}  {wide_msg}";

/// Runs the command.
///
/// # Errors
/// If an intersector cannot be built, or the report cannot be written.
pub(super) fn run(args: &VerifyArgs) -> Result<Exit> {
    let html = |path| AtomicFile::with_extension(path, "html");
    let report = args.report.as_deref().map(html).transpose()?;
    interrupt::listen();
    on_threads(args.threads, || verify(args, report))
}

fn verify(args: &VerifyArgs, report: Option<AtomicFile>) -> Result<Exit> {
    let started = Instant::now();
    let checks = chosen(args)?;
    if args.list {
        let name = |check: &Check| format!("{:<13} {}\n", check.group.name(), check.name);
        print::result(&checks.iter().map(name).collect::<String>())?;
        return Ok(Exit::Done);
    }
    let shown = ProgressDisplay::with(args.quiet, BAR, BETWEEN_LINES);
    let outcomes = run_all(&checks, &CancelToken::default(), &|progress| show(&shown, &progress))?;
    shown.finish();
    let judged: Vec<CheckEntry<'_>> = checks.iter().zip(&outcomes).collect();
    let seconds = started.elapsed().as_secs_f64();
    if let Some(report) = report {
        let page = checks::page(&facts(args, seconds), &judged);
        report.write(|sink| sink.write_all(page.as_bytes()))?;
    }
    if args.json {
        print::json(&checks::json(&judged, &facts(args, seconds), seconds))?;
    } else {
        print::result(&checks::table(&judged, seconds))?;
    }
    if let (Some(path), false) = (&args.report, args.quiet) {
        print::note(format_args!("wrote {}", path.display()));
    }
    let passed = outcomes.iter().all(|outcome| outcome.passed);
    Ok(if passed { Exit::Done } else { Exit::CheckFailed })
}

/// Displays how many checks are done and which failed.
fn show(shown: &ProgressDisplay, progress: &check::SuiteProgress<'_>) {
    let check::SuiteProgress { done, total, check, result: outcome } = *progress;
    if !outcome.passed && shown.wants_progress() {
        let (group, name) = (check.group.name(), &check.name);
        shown.suspend(|| print::note(format_args!("FAILED {group}, {name}")));
    }
    let line = || format!("{done} of {total} checks done");
    shown.grow(done as u64, total as u64, || check.name.clone(), line);
}

/// Returns the requested checks. The total significance level is divided among them.
fn chosen(args: &VerifyArgs) -> Result<Vec<Check>> {
    let mut checks = all_checks_on(args.effort(), args.accels.backends());
    let is_meant = |check: &Check, text: &String| {
        check.name.contains(text) || check.group.name().contains(text)
    };
    if !args.only.is_empty() {
        checks.retain(|check| args.only.iter().any(|text| is_meant(check, text)));
        split_significance(&mut checks);
    }
    if checks.is_empty() {
        return Err(Error::input("no check matches --only").with_help(
            "`photosphere verify --list` prints the groups and the names of all checks",
        ));
    }
    Ok(checks)
}

/// Returns what was checked, where and how.
fn facts(args: &VerifyArgs, seconds: f64) -> Vec<(&'static str, String)> {
    let (os, arch) = (std::env::consts::OS, std::env::consts::ARCH);
    let processor = system::processor().map_or(String::new(), |name| format!(", {name}"));
    let machine = format!("{os}, {arch}{processor}");
    let backends = args.accels.backends().iter().map(|backend| backend.name());
    let mut facts = vec![
        ("version", format!("photosphere {}", env!("CARGO_PKG_VERSION"))),
        ("machine", machine),
        ("intersectors", backends.collect::<Vec<_>>().join(", ")),
    ];
    if let Some(Ok(embree)) = embree_info() {
        let isa = &embree.instruction_set;
        facts.push(("Embree", format!("{}, instruction set {isa}", embree.runtime_version)));
    }
    let effort = match args.effort() {
        Effort::Quick => "quick",
        Effort::Normal => "normal",
        Effort::Full => "full",
    };
    let threads = rayon::current_num_threads();
    facts.push((
        "effort",
        format!("{effort}: {seconds:.0} s on {}", print::count(threads, "thread")),
    ));
    facts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bar_template_is_valid() {
        assert!(indicatif::ProgressStyle::with_template(BAR).is_ok());
    }
}
