//! `photosphere verify` passes on this program, and would not pass on another.

#![cfg(unix)]

use std::process::{Command, Output};

use photosphere::accel::Cancel;
use photosphere::report;
use photosphere::verify::check::{
    Check, Effort, Finding, Group, Measured, run_all, share_significance,
};
use photosphere::verify::checks;

fn verify(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_photosphere"));
    command.arg("verify").args(arguments).output().expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn the_quick_suite_passes_and_its_report_contains_every_check() {
    let folder = tempfile::tempdir().expect("a folder for the test");
    let path = folder.path().join("report.html");
    let shown = path.display().to_string();
    let done = verify(&["--quick", "--quiet", "--report", &shown]);
    let table = text(&done.stdout);
    assert_eq!(done.status.code(), Some(0), "{table}{}", text(&done.stderr));
    let checks = checks(Effort::Quick);
    assert!(table.contains(&format!("{} checks passed", checks.len())), "{table}");
    let report = std::fs::read_to_string(&path).expect("the report is there");
    for check in &checks {
        assert!(report.contains(&check.name), "{} is not in the report", check.name);
    }
    for sign in ["<!doctype html>", "</html>", "data:image/png;base64,", "All "] {
        assert!(report.contains(sign), "{sign}");
    }
    assert!(!report.contains("http"), "the page needs nothing beside itself");
    let names = std::fs::read_dir(folder.path()).expect("a folder").count();
    assert_eq!(names, 1, "nothing else is left behind");
}

#[test]
fn a_check_is_called_alone_by_its_name_and_judges_alike_every_time() {
    let checks = checks(Effort::Quick);
    let check = checks.iter().find(|check| check.name.starts_with("furnace: path"));
    let check = check.expect("there is one");
    let [once, again] = [(); 2].map(|()| check.run(&Cancel::default()).expect("runs"));
    assert!(once.passed && once.is_random);
    assert_eq!(once.statistic, again.statistic);
    assert_eq!(once.detail, again.detail);
}

#[test]
fn a_failure_is_told_with_its_pictures_and_names() {
    let fails = |name: &str, p| {
        let name = name.to_owned();
        Check::new(Group::ChiSquare, name, move |_| Ok(Measured::new(Finding::PValue(p), "<why>")))
    };
    let mut checks = vec![fails("good & right", 0.5), fails("bad <wrong>", 1e-9)];
    share_significance(&mut checks);
    let outcomes = run_all(&checks, &Cancel::default(), &|_| ()).expect("runs");
    assert_eq!(outcomes.iter().map(|o| o.passed).collect::<Vec<_>>(), [true, false]);
    let judged: Vec<_> = checks.iter().zip(&outcomes).collect();
    let page = report::checks::page(&[("machine", "a & b".to_owned())], &judged);
    for sign in
        ["1 of 2 checks FAILED", "What failed", "bad &lt;wrong&gt;", "a &amp; b", "&lt;why&gt;"]
    {
        assert!(page.contains(sign), "{sign}");
    }
}

#[test]
fn what_cannot_be_done_is_said_before_any_work() {
    let nowhere = verify(&["--quick", "--report", "/nowhere/report.html"]);
    assert_eq!(nowhere.status.code(), Some(4), "{}", text(&nowhere.stderr));
    assert!(text(&nowhere.stderr).contains("does not exist"));
    let other = verify(&["--quick", "--report", "report.txt"]);
    assert_eq!(other.status.code(), Some(3), "{}", text(&other.stderr));
    assert!(text(&other.stderr).contains("`report.txt` does not end in .html"));
    let nothing = verify(&["--quick", "--only", "no such check"]);
    assert_eq!(nothing.status.code(), Some(3), "{}", text(&nothing.stderr));
    assert!(text(&nothing.stderr).contains("verify --list"), "{}", text(&nothing.stderr));
    let both = verify(&["--quick", "--full"]);
    assert_eq!(both.status.code(), Some(2), "{}", text(&both.stderr));
}

#[test]
fn a_list_has_the_names_that_are_asked_for_and_runs_nothing() {
    let list = verify(&["--full", "--list", "--only", "occluder"]);
    assert_eq!(list.status.code(), Some(0), "{}", text(&list.stderr));
    let lines = text(&list.stdout);
    assert!(lines.lines().count() >= 8, "{lines}");
    for line in lines.lines() {
        assert!(line.starts_with("closed forms  ") && line.contains("occluder: "), "{line}");
    }
    assert!(list.stderr.is_empty(), "{}", text(&list.stderr));
}

#[test]
fn json_has_every_check_that_was_asked_for() {
    let done = verify(&["--quick", "--json", "--quiet", "--only", "furnace:"]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let json: serde_json::Value = serde_json::from_slice(&done.stdout).expect("one JSON object");
    let checks = json["checks"].as_array().expect("a list");
    assert!(checks.len() >= 4);
    for check in checks {
        assert!(check["name"].as_str().is_some_and(|name| name.starts_with("furnace: ")));
        assert_eq!(check["passed"], true);
        assert!(check["limit"].as_f64().is_some_and(|limit| limit > 3.0));
    }
}
