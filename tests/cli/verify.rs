//! `photosphere verify` passes on this program, and would not pass on another.

use photosphere::report;
use photosphere::task::CancelToken;
use photosphere::verify::all_checks;
use photosphere::verify::check::{
    Check, CheckGroup, CheckMeasurement, Effort, TestStatistic, run_all, split_significance,
};

use crate::desk::{Desk, Outcome, outcome};

fn verify(arguments: &[&str]) -> Outcome {
    outcome(Desk::empty().command("verify").args(arguments))
}

#[test]
fn the_quick_suite_passes_and_its_report_contains_every_check() {
    let desk = Desk::empty();
    let done = desk.run("verify --quick --quiet --report report.html");
    let table = done.stdout;
    assert_eq!(done.code, Some(0), "{table}{}", done.stderr);
    let checks = all_checks(Effort::Quick);
    assert!(table.contains(&format!("{} checks passed", checks.len())), "{table}");
    let report = String::from_utf8(desk.read("report.html")).expect("text");
    for check in &checks {
        assert!(report.contains(&check.name), "{} is not in the report", check.name);
    }
    for sign in ["<!doctype html>", "</html>", "data:image/png;base64,", "All "] {
        assert!(report.contains(sign), "{sign}");
    }
    let raw = ["exact 0.168836: t = ", "; the largest |t| of 13 groups "];
    assert!(raw.iter().all(|text| report.contains(text)), "{raw:?}");
    assert!(!report.contains("http"), "the page needs nothing beside itself");
    assert_eq!(desk.names(), ["report.html"], "nothing else is left behind");
}

#[test]
fn a_check_is_called_alone_by_its_name_and_judges_alike_every_time() {
    let checks = all_checks(Effort::Quick);
    let check = checks.iter().find(|check| check.name.starts_with("furnace: path"));
    let check = check.expect("there is one");
    let [once, again] = [(); 2].map(|()| check.run(&CancelToken::default()).expect("runs"));
    assert!(once.passed && once.is_random);
    assert_eq!(once.statistic, again.statistic);
    assert_eq!(once.detail, again.detail);
}

#[test]
fn a_failure_is_told_with_its_pictures_and_names() {
    let fails = |name: &str, p| {
        let name = name.to_owned();
        Check::new(CheckGroup::ChiSquare, name, move |_| {
            Ok(CheckMeasurement::new(TestStatistic::PValue(p), "<why>"))
        })
    };
    let mut checks = vec![fails("good & right", 0.5), fails("bad <wrong>", 1e-9)];
    split_significance(&mut checks);
    let outcomes = run_all(&checks, &CancelToken::default(), &|_| ()).expect("runs");
    assert_eq!(outcomes.iter().map(|o| o.passed).collect::<Vec<_>>(), [true, false]);
    let judged: Vec<_> = checks.iter().zip(&outcomes).collect();
    let page = report::checks::page(&[("machine", "a & b".to_owned())], &judged);
    for sign in
        ["1 of 2 checks FAILED", "Failed checks", "bad &lt;wrong&gt;", "a &amp; b", "&lt;why&gt;"]
    {
        assert!(page.contains(sign), "{sign}");
    }
}

#[test]
fn checks_of_a_closed_form_are_listed_under_it_whatever_they_are_called() {
    let check = |name: &str| {
        let nothing = || CheckMeasurement::new(TestStatistic::ErrorCount(0), "");
        Check::new(CheckGroup::ClosedForms, name, move |_| Ok(nothing()))
    };
    let of_form = |name| check(name).of_closed_form("furnace");
    let checks = [of_form("one way"), of_form("sun: another"), check("furnace: of none")];
    let outcomes = run_all(&checks, &CancelToken::default(), &|_| ()).expect("runs");
    let judged: Vec<_> = checks.iter().zip(&outcomes).collect();
    let table = report::checks::table(&judged, 1.0);
    let forms: Vec<&str> = table.lines().filter(|line| line.starts_with("  ")).skip(1).collect();
    let [furnace] = forms[..] else { panic!("{table}") };
    let words: Vec<&str> = furnace.split_whitespace().collect();
    assert_eq!(words[..3], ["furnace", "2", "0"], "{table}");
    assert!(report::checks::page(&[], &judged).contains("2 of 2 variants"));
}

#[test]
fn what_cannot_be_done_is_said_before_any_work() {
    let nowhere = verify(&["--quick", "--report", "/nowhere/report.html"]);
    assert_eq!(nowhere.code, Some(4), "{}", nowhere.stderr);
    assert!(nowhere.stderr.contains("does not exist"));
    let other = verify(&["--quick", "--report", "report.txt"]);
    assert_eq!(other.code, Some(3), "{}", other.stderr);
    assert!(other.stderr.contains("`report.txt` does not end in .html"));
    let nothing = verify(&["--quick", "--only", "no such check"]);
    assert_eq!(nothing.code, Some(3), "{}", nothing.stderr);
    assert!(nothing.stderr.contains("verify --list"), "{}", nothing.stderr);
    let both = verify(&["--quick", "--full"]);
    assert_eq!(both.code, Some(2), "{}", both.stderr);
}

#[test]
fn a_list_has_the_names_that_are_asked_for_and_runs_nothing() {
    let list = verify(&["--full", "--list", "--only", "occluder"]);
    assert_eq!(list.code, Some(0), "{}", list.stderr);
    let lines = &list.stdout;
    assert!(lines.lines().count() >= 8, "{lines}");
    for line in lines.lines() {
        assert!(line.starts_with("closed forms  ") && line.contains("occluder: "), "{line}");
    }
    assert!(list.stderr.is_empty(), "{}", list.stderr);
}

#[test]
fn json_has_every_check_that_was_asked_for() {
    let done = verify(&["--quick", "--json", "--quiet", "--only", "furnace:"]);
    assert_eq!(done.code, Some(0), "{}", done.stderr);
    let json = done.json();
    let checks = json["checks"].as_array().expect("a list");
    assert!(checks.len() >= 4);
    for check in checks {
        assert!(check["name"].as_str().is_some_and(|name| name.starts_with("furnace: ")));
        assert_eq!(check["passed"], true);
        assert!(check["limit"].as_f64().is_some_and(|limit| limit > 3.0));
    }
}
