//! Reports check results as a table, as JSON, and as an HTML page with images.

mod entry;
mod page;

use serde_json::{Map, Value, json};

use crate::draw::text::{count, row};
use crate::verify::check::{CheckGroup, CheckResult, FAMILY_SIGNIFICANCE};

pub use entry::CheckEntry;
pub use page::page;

/// Column widths of the table: name, checks, failed, largest statistic.
const COLUMNS: [i32; 5] = [-34, 8, 8, 3, -1];

/// Formats one line per group and closed form, followed by the failed checks.
pub fn table(judged: &[CheckEntry<'_>], seconds: f64) -> String {
    let mut text = row(COLUMNS, ["", "checks", "failed", "", "largest statistic"]);
    for group in CheckGroup::ALL {
        let of_group: Vec<CheckEntry<'_>> =
            judged.iter().copied().filter(|(check, _)| check.group == group).collect();
        if of_group.is_empty() {
            continue;
        }
        text += &line(group.name(), &of_group);
        for of_form in of_group.chunk_by(|a, b| a.0.closed_form == b.0.closed_form) {
            if let Some(form) = of_form[0].0.closed_form {
                text += &line(&format!("  {form}"), of_form);
            }
        }
    }
    let mut remarks = judged.iter().filter_map(|(_, outcome)| outcome.note.as_deref()).peekable();
    if remarks.peek().is_some() {
        text += "not scaled to conserve energy, and there to show it:\n";
    }
    remarks.for_each(|remark| text += &format!("  {remark}\n"));
    text + &conclusion(judged, seconds)
}

fn line(name: &str, judged: &[CheckEntry<'_>]) -> String {
    let failed = judged.iter().filter(|(_, outcome)| !outcome.passed).count();
    let outcomes = judged.iter().map(|(_, outcome)| *outcome);
    let largest = outcomes.max_by(|a, b| a.statistic.total_cmp(&b.statistic)).map(statistic);
    let [checks, failed] = [judged.len(), failed].map(|count| count.to_string());
    row(COLUMNS, [name, &checks, &failed, "", &largest.unwrap_or_default()])
}

fn statistic(CheckResult { statistic, limit, is_random, .. }: &CheckResult) -> String {
    if *is_random {
        format!("{statistic:.2} of {limit:.2} sigma")
    } else {
        format!("{statistic:.0} wrong")
    }
}

fn conclusion(judged: &[CheckEntry<'_>], seconds: f64) -> String {
    let mut text = String::new();
    let mut failed = 0;
    for (check, outcome) in judged.iter().filter(|(_, outcome)| !outcome.passed) {
        failed += 1;
        let (group, name) = (check.group.name(), &check.name);
        let (found, detail) = (statistic(outcome), &outcome.detail);
        text += &format!("FAILED {group}, {name}: {found}; {detail}\n");
    }
    let checks = count(judged.len(), "check");
    text + &match failed {
        0 => format!(
            "{checks} passed in {seconds:.0} s; chance alone fails a right program in at most \
             {FAMILY_SIGNIFICANCE} of all cases\n"
        ),
        _ => format!("{failed} of {checks} failed in {seconds:.0} s\n"),
    }
}

/// Reports all checks as JSON, with the facts in `about`.
pub fn json(judged: &[CheckEntry<'_>], about: &[(&str, String)], seconds: f64) -> Value {
    let check = |(check, outcome): &CheckEntry<'_>| {
        json!({
            "group": check.group.name(),
            "name": check.name,
            "passed": outcome.passed,
            "statistic": outcome.statistic,
            "limit": outcome.limit,
            "unit": if outcome.is_random { "sigma" } else { "wrong answers" },
            "detail": outcome.detail,
            "remark": outcome.note,
        })
    };
    let fact = |(name, value): &(&str, String)| ((*name).to_owned(), value.as_str().into());
    let facts: Map<String, Value> = about.iter().map(fact).collect();
    json!({
        "facts": facts,
        "family_significance": FAMILY_SIGNIFICANCE,
        "passed": judged.iter().all(|(_, outcome)| outcome.passed),
        "seconds": seconds,
        "checks": judged.iter().map(check).collect::<Vec<_>>(),
    })
}
