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
pub fn table(entries: &[CheckEntry<'_>], seconds: f64) -> String {
    let mut text = row(COLUMNS, ["", "checks", "failed", "", "largest statistic"]);
    for group in CheckGroup::ALL {
        let group_entries: Vec<CheckEntry<'_>> =
            entries.iter().copied().filter(|(check, _)| check.group == group).collect();
        if group_entries.is_empty() {
            continue;
        }
        text += &line(group.name(), &group_entries);
        for form_entries in group_entries.chunk_by(|a, b| a.0.closed_form == b.0.closed_form) {
            if let Some(form) = form_entries[0].0.closed_form {
                text += &line(&format!("  {form}"), form_entries);
            }
        }
    }
    let mut notes = entries.iter().filter_map(|(_, result)| result.note.as_deref()).peekable();
    if notes.peek().is_some() {
        text += "not energy-conserving by design:\n";
    }
    notes.for_each(|note| text += &format!("  {note}\n"));
    text + &conclusion(entries, seconds)
}

fn line(name: &str, entries: &[CheckEntry<'_>]) -> String {
    let failed = entries.iter().filter(|(_, result)| !result.passed).count();
    let results = entries.iter().map(|(_, result)| *result);
    let largest = results.max_by(|a, b| a.statistic.total_cmp(&b.statistic)).map(statistic);
    let [checks, failed] = [entries.len(), failed].map(|count| count.to_string());
    row(COLUMNS, [name, &checks, &failed, "", &largest.unwrap_or_default()])
}

fn statistic(CheckResult { statistic, limit, is_random, .. }: &CheckResult) -> String {
    if *is_random {
        format!("{statistic:.2} of {limit:.2} sigma")
    } else {
        format!("{statistic:.0} errors")
    }
}

fn conclusion(entries: &[CheckEntry<'_>], seconds: f64) -> String {
    let mut text = String::new();
    let mut failed = 0;
    for (check, result) in entries.iter().filter(|(_, result)| !result.passed) {
        failed += 1;
        let (group, name) = (check.group.name(), &check.name);
        let (statistic_text, detail) = (statistic(result), &result.detail);
        text += &format!("FAILED {group}, {name}: {statistic_text}; {detail}\n");
    }
    let checks = count(entries.len(), "check");
    text + &match failed {
        0 => format!(
            "{checks} passed in {seconds:.0} s; a correct build fails by chance with probability at most \
             {FAMILY_SIGNIFICANCE}\n"
        ),
        _ => format!("{failed} of {checks} failed in {seconds:.0} s\n"),
    }
}

/// Reports all checks as JSON, with the facts in `about`.
pub fn json(entries: &[CheckEntry<'_>], about: &[(&str, String)], seconds: f64) -> Value {
    let check = |(check, result): &CheckEntry<'_>| {
        json!({
            "group": check.group.name(),
            "name": check.name,
            "passed": result.passed,
            "statistic": result.statistic,
            "limit": result.limit,
            "unit": if result.is_random { "sigma" } else { "errors" },
            "detail": result.detail,
            "note": result.note,
        })
    };
    let fact = |(name, value): &(&str, String)| ((*name).to_owned(), value.as_str().into());
    let facts: Map<String, Value> = about.iter().map(fact).collect();
    json!({
        "facts": facts,
        "family_significance": FAMILY_SIGNIFICANCE,
        "passed": entries.iter().all(|(_, result)| result.passed),
        "seconds": seconds,
        "checks": entries.iter().map(check).collect::<Vec<_>>(),
    })
}
