//! `photosphere verify`: every check of the program, on the user's machine and build.

use std::io::{IsTerminal, Write as _};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use crate::accel::{Backend, Cancel, embree_info};
use crate::error::{Error, Result};
use crate::output::WholeFile;
use crate::verify::check::{
    Check, Effort, FAMILY_SIGNIFICANCE, Group, Outcome, Progress, run_all, share_significance,
};
use crate::verify::checks_on;
use crate::verify::report::{self, Judged};

use super::args::VerifyArgs;
use super::exit::Exit;
use super::system::on_threads;
use super::{interrupt, print};

const BETWEEN_LINES: Duration = Duration::from_secs(5);
const BAR: &str = "{bar:32} {pos} of {len}  {elapsed}  {wide_msg}";

/// # Errors
/// When an intersector cannot be built, or the report not be written.
pub(super) fn run(args: &VerifyArgs) -> Result<Exit> {
    let html = |path| WholeFile::ending_in(path, "html");
    let report = args.report.as_deref().map(html).transpose()?;
    interrupt::listen();
    on_threads(args.threads, || verify(args, report))
}

fn verify(args: &VerifyArgs, report: Option<WholeFile>) -> Result<Exit> {
    let started = Instant::now();
    let checks = chosen(args)?;
    if args.list {
        let name = |check: &Check| format!("{:<13} {}\n", check.group.name(), check.name);
        print::result(&checks.iter().map(name).collect::<String>())?;
        return Ok(Exit::Done);
    }
    let shown = Shown::new(args.quiet);
    let outcomes = run_all(&checks, &Cancel::default(), &|progress| shown.show(&progress))?;
    shown.finish();
    let judged: Vec<Judged<'_>> = checks.iter().zip(&outcomes).collect();
    let seconds = started.elapsed().as_secs_f64();
    if let Some(report) = report {
        let page = report::page(&facts(args, seconds), &judged);
        report.write(|sink| sink.write_all(page.as_bytes()))?;
    }
    if args.json {
        print::json(&in_json(&judged, args, seconds))?;
    } else {
        print::result(&table(&judged, seconds))?;
    }
    if let (Some(path), false) = (&args.report, args.quiet) {
        print::remark(format_args!("wrote {}", path.display()));
    }
    let passed = outcomes.iter().all(|outcome| outcome.passed);
    Ok(if passed { Exit::Done } else { Exit::CheckFailed })
}

/// The checks that are asked for; fewer of them share the same significance.
fn chosen(args: &VerifyArgs) -> Result<Vec<Check>> {
    let mut checks = checks_on(args.effort(), args.accels.backends());
    let is_meant = |check: &Check, text: &String| {
        check.name.contains(text) || check.group.name().contains(text)
    };
    if !args.only.is_empty() {
        checks.retain(|check| args.only.iter().any(|text| is_meant(check, text)));
        share_significance(&mut checks);
    }
    if checks.is_empty() {
        return Err(Error::input("no check has a name that contains what --only asks for")
            .with_help(
                "`photosphere verify --list` prints the groups and the names of all checks",
            ));
    }
    Ok(checks)
}

/// What was checked, where and how.
fn facts(args: &VerifyArgs, seconds: f64) -> Vec<(&'static str, String)> {
    let mut facts = vec![
        ("version", format!("photosphere {}", env!("CARGO_PKG_VERSION"))),
        ("machine", machine()),
        ("intersectors", names(args.accels.backends())),
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
    facts.push(("effort", format!("{effort}: {seconds:.0} s on {threads} threads")));
    facts
}

fn machine() -> String {
    let (os, arch) = (std::env::consts::OS, std::env::consts::ARCH);
    format!("{os}, {arch}, {}", super::system::processor().unwrap_or_default())
        .trim_end_matches([',', ' '])
        .to_owned()
}

fn names(backends: &[Backend]) -> String {
    backends.iter().map(|backend| backend.name()).collect::<Vec<_>>().join(", ")
}

/// One line for each group and each closed form, and after them what failed.
fn table(judged: &[Judged<'_>], seconds: f64) -> String {
    let mut text = format!("{:<34}{:>8}{:>8}   {}\n", "", "checks", "failed", "largest statistic");
    for group in Group::ALL {
        let of_group: Vec<_> = judged.iter().filter(|(check, _)| check.group == group).collect();
        if of_group.is_empty() {
            continue;
        }
        text += &line(group.name(), &of_group);
        if group == Group::ClosedForms {
            for family in families(&of_group) {
                let prefix = format!("{family}: ");
                let of_form: Vec<_> = of_group
                    .iter()
                    .copied()
                    .filter(|(check, _)| check.name.starts_with(&prefix))
                    .collect();
                text += &line(&format!("  {family}"), &of_form);
            }
        }
    }
    let remarks = judged.iter().filter_map(|(_, outcome)| outcome.remark.as_deref());
    for (index, remark) in remarks.enumerate() {
        text +=
            if index == 0 { "not scaled to conserve energy, and there to show it:\n" } else { "" };
        text += &format!("  {remark}\n");
    }
    text + &conclusion(judged, seconds)
}

/// The words before the colon of the names, in order, each once.
fn families<'a>(judged: &[&Judged<'a>]) -> Vec<&'a str> {
    let mut families: Vec<&str> =
        judged.iter().filter_map(|(check, _)| Some(check.name.split_once(": ")?.0)).collect();
    families.dedup();
    families
}

fn line(name: &str, judged: &[&Judged<'_>]) -> String {
    let failed = judged.iter().filter(|(_, outcome)| !outcome.passed).count();
    let largest = judged
        .iter()
        .map(|(_, outcome)| *outcome)
        .max_by(|a, b| a.statistic.total_cmp(&b.statistic))
        .map_or(String::new(), statistic);
    format!("{name:<34}{:>8}{failed:>8}   {largest}\n", judged.len())
}

fn statistic(outcome: &Outcome) -> String {
    let Outcome { statistic, limit, .. } = outcome;
    if outcome.is_random {
        format!("{statistic:.2} of {limit:.2} sigma")
    } else {
        format!("{statistic:.0} wrong")
    }
}

fn conclusion(judged: &[Judged<'_>], seconds: f64) -> String {
    let failed: Vec<_> = judged.iter().filter(|(_, outcome)| !outcome.passed).collect();
    let mut text = String::new();
    for (check, outcome) in &failed {
        text += &format!(
            "FAILED {}, {}: {}; {}\n",
            check.group.name(),
            check.name,
            statistic(outcome),
            outcome.detail
        );
    }
    let checks = print::count(judged.len(), "check");
    if failed.is_empty() {
        text += &format!(
            "{checks} passed in {seconds:.0} s; chance alone fails a right program in at most \
             {FAMILY_SIGNIFICANCE} of all cases\n"
        );
    } else {
        text += &format!("{} of {checks} failed in {seconds:.0} s\n", failed.len());
    }
    text
}

fn in_json(judged: &[Judged<'_>], args: &VerifyArgs, seconds: f64) -> serde_json::Value {
    let check = |(check, outcome): &Judged<'_>| {
        json!({
            "group": check.group.name(),
            "name": check.name,
            "passed": outcome.passed,
            "statistic": outcome.statistic,
            "limit": outcome.limit,
            "unit": if outcome.is_random { "sigma" } else { "wrong answers" },
            "detail": outcome.detail,
            "remark": outcome.remark,
        })
    };
    let facts: serde_json::Map<_, _> = facts(args, seconds)
        .into_iter()
        .map(|(key, value)| (key.to_owned(), value.into()))
        .collect();
    json!({
        "facts": facts,
        "family_significance": FAMILY_SIGNIFICANCE,
        "passed": judged.iter().all(|(_, outcome)| outcome.passed),
        "seconds": seconds,
        "checks": judged.iter().map(check).collect::<Vec<_>>(),
    })
}

/// How far the suite is: a bar on a terminal, a line now and then elsewhere.
enum Shown {
    Quiet,
    Bar(ProgressBar),
    Lines(Mutex<Instant>),
}

impl Shown {
    fn new(quiet: bool) -> Self {
        if quiet {
            return Self::Quiet;
        }
        if !std::io::stderr().is_terminal() {
            return Self::Lines(Mutex::new(Instant::now()));
        }
        let style = ProgressStyle::with_template(BAR).expect("the template is a constant");
        let bar = ProgressBar::no_length().with_style(style);
        bar.enable_steady_tick(Duration::from_millis(200));
        Self::Bar(bar)
    }

    fn show(&self, progress: &Progress<'_>) {
        let Progress { done, total, check, outcome } = *progress;
        if !outcome.passed {
            self.say(format!("FAILED {}, {}", check.group.name(), check.name));
        }
        match self {
            Self::Quiet => {}
            Self::Bar(bar) => {
                bar.set_length(total as u64);
                bar.set_position(done as u64);
                bar.set_message(check.name.clone());
            }
            Self::Lines(last) => {
                let Ok(mut last) = last.try_lock() else { return };
                if last.elapsed() >= BETWEEN_LINES {
                    *last = Instant::now();
                    print::remark(format_args!("{done} of {total} checks done"));
                }
            }
        }
    }

    fn say(&self, text: String) {
        match self {
            Self::Quiet => {}
            Self::Bar(bar) => bar.println(text),
            Self::Lines(_) => print::remark(text),
        }
    }

    fn finish(&self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bar_template_is_valid() {
        assert!(ProgressStyle::with_template(BAR).is_ok());
    }
}
