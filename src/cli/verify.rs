//! `photosphere verify`: every check of the program, on the user's machine and build.

use std::io::Write as _;
use std::time::{Duration, Instant};

use serde_json::{Map, Value, json};

use crate::accel::{Cancel, embree_info};
use crate::error::{Error, Result};
use crate::job::Observer;
use crate::output::WholeFile;
use crate::verify::check::{
    self, Check, Effort, FAMILY_SIGNIFICANCE, Group, Outcome, run_all, share_significance,
};
use crate::verify::checks_on;
use crate::verify::report::{self, Judged};

use super::args::VerifyArgs;
use super::exit::Exit;
use super::print::{self, row};
use super::progress::Progress;
use super::system::on_threads;
use super::{interrupt, system};

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
    let shown = Progress::with(args.quiet, BAR, BETWEEN_LINES);
    let outcomes = run_all(&checks, &Cancel::default(), &|progress| show(&shown, &progress))?;
    shown.finish();
    let judged: Vec<Judged<'_>> = checks.iter().zip(&outcomes).collect();
    let seconds = started.elapsed().as_secs_f64();
    if let Some(report) = report {
        let page = report::page(&facts(args, seconds), &judged);
        report.write(|sink| sink.write_all(page.as_bytes()))?;
    }
    if args.json {
        print::json(&json(&judged, args, seconds))?;
    } else {
        print::result(&table(&judged, seconds))?;
    }
    if let (Some(path), false) = (&args.report, args.quiet) {
        print::remark(format_args!("wrote {}", path.display()));
    }
    let passed = outcomes.iter().all(|outcome| outcome.passed);
    Ok(if passed { Exit::Done } else { Exit::CheckFailed })
}

/// Shows how many checks are done, and which failed.
fn show(shown: &Progress, progress: &check::Progress<'_>) {
    let check::Progress { done, total, check, outcome } = *progress;
    if !outcome.passed && shown.wants_progress() {
        let (group, name) = (check.group.name(), &check.name);
        shown.say(|| print::remark(format_args!("FAILED {group}, {name}")));
    }
    let line = || format!("{done} of {total} checks done");
    shown.grow(done as u64, total as u64, || check.name.clone(), line);
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
    facts.push(("effort", format!("{effort}: {seconds:.0} s on {threads} threads")));
    facts
}

/// The columns of the table: name, checks, failed, largest statistic.
const COLUMNS: [i32; 5] = [-34, 8, 8, 3, -1];

/// One line for each group and each closed form, and after them what failed.
fn table(judged: &[Judged<'_>], seconds: f64) -> String {
    let mut text = row(COLUMNS, ["", "checks", "failed", "", "largest statistic"]);
    for group in Group::ALL {
        let of_group: Vec<Judged<'_>> =
            judged.iter().copied().filter(|(check, _)| check.group == group).collect();
        if of_group.is_empty() {
            continue;
        }
        text += &line(group.name(), &of_group);
        if group == Group::ClosedForms {
            for of_form in of_group.chunk_by(|a, b| family(a.0) == family(b.0)) {
                text += &line(&format!("  {}", family(of_form[0].0)), of_form);
            }
        }
    }
    let mut remarks = judged.iter().filter_map(|(_, outcome)| outcome.remark.as_deref()).peekable();
    if remarks.peek().is_some() {
        text += "not scaled to conserve energy, and there to show it:\n";
    }
    remarks.for_each(|remark| text += &format!("  {remark}\n"));
    text + &conclusion(judged, seconds)
}

/// The words before the colon of a check's name.
fn family(check: &Check) -> &str {
    check.name.split(": ").next().unwrap_or_default()
}

fn line(name: &str, judged: &[Judged<'_>]) -> String {
    let failed = judged.iter().filter(|(_, outcome)| !outcome.passed).count();
    let outcomes = judged.iter().map(|(_, outcome)| *outcome);
    let largest = outcomes.max_by(|a, b| a.statistic.total_cmp(&b.statistic)).map(statistic);
    let [checks, failed] = [judged.len(), failed].map(|count| count.to_string());
    row(COLUMNS, [name, &checks, &failed, "", &largest.unwrap_or_default()])
}

fn statistic(Outcome { statistic, limit, is_random, .. }: &Outcome) -> String {
    if *is_random {
        format!("{statistic:.2} of {limit:.2} sigma")
    } else {
        format!("{statistic:.0} wrong")
    }
}

fn conclusion(judged: &[Judged<'_>], seconds: f64) -> String {
    let mut text = String::new();
    let mut failed = 0;
    for (check, outcome) in judged.iter().filter(|(_, outcome)| !outcome.passed) {
        failed += 1;
        let (group, name) = (check.group.name(), &check.name);
        let (found, detail) = (statistic(outcome), &outcome.detail);
        text += &format!("FAILED {group}, {name}: {found}; {detail}\n");
    }
    let checks = print::count(judged.len(), "check");
    text + &match failed {
        0 => format!(
            "{checks} passed in {seconds:.0} s; chance alone fails a right program in at most \
             {FAMILY_SIGNIFICANCE} of all cases\n"
        ),
        _ => format!("{failed} of {checks} failed in {seconds:.0} s\n"),
    }
}

fn json(judged: &[Judged<'_>], args: &VerifyArgs, seconds: f64) -> Value {
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
    let facts: Map<_, _> = facts(args, seconds)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bar_template_is_valid() {
        assert!(indicatif::ProgressStyle::with_template(BAR).is_ok());
    }
}
